"""Layout of a system's equations: integers of their structure, numbers that all variants share, and numbers of each variant.

`lay` (int64) begins with a header; its tables follow. Rows refer to entries of `fix` (float64, shared: frames, axes, armatures)
and of `num` (one lane for each variant: masses, centres, inertias, points of mounts, parameters of laws). A link is a body that
moves, with everything welded to it; behind the last stands the world. Frames of links are those of their bodies; a vector "in
the link" is in these axes from this origin.
"""

# header: counts, addresses of the tables, addresses of the sections of the working memory, in rows
N_LINKS, N_TREES, NQ, NV, N_STATES, N_MOUNTS, N_FRAMES, N_CHANNELS, N_STOPS, N_SLIPPING, N_DRIVEN = range(11)
N_VALUES, N_RUNS, N_PAIRS, N_MODES, N_FORCES, N_WORK = range(11, 17)
LINKS, TREES, DOFS, RUNS, MOUNTS, AXES, FRAMES, CHANNELS, STOPS, PAIRS, MODES, FORCES = range(17, 29)
DRIVEN, GRAVITY, PARAMETERS = 29, 30, 31  # addresses in `fix`, and that of the laws' parameters in `num`
KIN, WRENCH, SUB, MASS, RHS, RATES, COMPOSITE, START, SLOPE, SUM, RECORD, VALUES, RECENT, MEMORY = range(32, 46)
TOUCHED, TRAVELS, CLOSINGS, FAILED, LOADS = range(46, 51)  # the last: of now, of a step's middle, of its end
ROTATES = 51  # where the base's axes as modelled stand in `fix`, row by row, if it has hinges that are driven, else -1
HEADER = 52

# parent (-1: the world), first dof, number of dofs, kind, tree, frame in the parent link in `fix` (position 3, quaternion 4),
# inertia in `num`
LINK_COLUMNS = 7
PARENT, FIRST_DOF, DOFS_OF, KIND, TREE, FRAME, INERTIA = range(7)
STRAIGHT, FREE, TURNING, MODAL = range(4)  # never turns; floats; all others; is nowhere, the coordinate of a mode

# of `num`: mass, centre of mass (3), inertia about it xx, yy, zz, xy, xz, yz, its inverse alike
MASS_OF, CENTRE, ABOUT, INVERSE, INERTIA_SIZE = 0, 1, 4, 10, 16

# kind, first dof, number of dofs, first link, number of links, a sliding link's inverse mass matrix in `num`
TREE_COLUMNS = 6
TREE_KIND, TREE_DOF, TREE_DOFS, TREE_LINK, TREE_LINKS, TREE_INVERSE = range(6)
DRIVEN_TREE, FREE_TREE, SLIDING_TREE, ANY_TREE, MODAL_TREE = range(5)  # all but ANY_TREE have one link

# link, kind, qpos, parent dof (-1), place among the driven (-1), constants in `fix`, spring and damper in `num`
DOF_COLUMNS = 7
DOF_LINK, DOF_KIND, DOF_QPOS, DOF_PARENT, DOF_DRIVEN, DOF_FIX, DOF_NUM = range(7)
SLIDE, HINGE, FLOATING, ALONG = 0, 1, 2, 3  # of a floating link's six dofs the first, and those that come with it
# of `fix`: axis (3), anchor (3), armature, origin, limits (2)
AXIS, ANCHOR, ARMATURE, ORIGIN, LOWEST, HIGHEST = 0, 3, 6, 7, 8, 9
DAMPING, STIFFNESS, REFERENCE = 0, 1, 2  # of `num`; the last is where the spring is at rest
# of a driven dof in `fix`: maps from the base's acceleration (3) and from that of roll, pitch, yaw (3), inertia of the drive
DRIVEN_COLUMNS, INERTIA_OF_DRIVE = 7, 6
# dof and participation in `fix` (3) of a mode of a flexible part, whose link is a unit mass on a slide
MODE_COLUMNS = 2
# of a site on a flexible part: number of modes, then of each dof, qpos, and shape in `fix` (3), in the axes that its point has
SHAPE_COLUMNS, SHAPE = 3, 2

# links that carry geoms which may touch, and in `fix` how they stand to each other as modelled: place and axes of the second in
# the first (3, 9), clearance, reach of the second's geoms from its origin
PAIR_COLUMNS = 3

# values of FAILED, other than 0: the state is none, a joint stands at its limit, geoms may touch
WILD, LIMITED, TOUCHING = 1.0, 2.0, 3.0

# link, point in `num` (3), axes of the site in `fix` (3, 3), shapes (0: on no flexible part); as points and axes of mounts are
FORCE_COLUMNS = 4
FORCE_LINK, FORCE_POINT, FORCE_AXES, FORCE_SHAPES = range(4)

# payload link, base link, number of mounts between them that follow each other
RUN_PAYLOAD, RUN_BASE, RUN_MOUNTS, RUN_COLUMNS = range(4)

# base takes the reaction, points in `num` (payload 3, base 3, turning 3, rated travel 4), frames in `fix`, coupling among the
# parameters (-1), partner, resists turning, axes are those of its base's link, shapes at the payload's and at the base's site
# (0: on no flexible part); points and axes are in the world's where a link never turns
MOUNT_COLUMNS = 9
MOVED, POINTS, AXES_IN, COUPLING, PARTNER, RESISTS, ALIGNED, BENT, BENT_BASE = range(9)
ON_BASE, RESISTING, RATED = 3, 6, 9  # among the points, behind the payload's
# of `fix`: axes of the base site (3, 3), orientation of base and payload site in their links (4, 4), as modelled (4)
BASE_TURN, PAYLOAD_TURN, AS_MODELLED = 9, 13, 17
# of the memory: deflection, force, rate of the deflection, arm (3 each)
FORCE, RATE, ARM, RECORD_SIZE = 3, 6, 9, 12

# law number as in the callback's, first parameter in `num`, first state, number of states; three rows a mount
LAW, FIRST_PARAMETER, FIRST_STATE, LAW_STATES, AXIS_COLUMNS = range(5)

# link, point in the link in `num` (3), orientation in the link in `fix` (4), whether it is a point, base's link and its point
# in `num` (3), displacement from there as modelled in `fix` (3), whether its peaks are tracked, shapes (0: on no flexible part)
FRAME_COLUMNS = 9
FRAME_LINK, FRAME_POINT, FRAME_TURN, IS_POINT, BASE_LINK, BASE_POINT, BASE_APART, IS_TRACKED, FRAME_SHAPES = range(9)

# of a stop: record of its deflection, first parameter in `num`, first state (-1: its force has no memory)
STOP_RECORD, STOP_PARAMETER, STOP_STATE, STOP_COLUMNS = range(4)

RECENT_SIZE = 12  # of a channel: its last three vectors with their norms, in turn

# of the motion of a link: origin, axes, quaternion, angular velocity, velocity, angular acceleration and acceleration without
# those of the coordinates, the same with them
KIN_O, KIN_R, KIN_Q, KIN_W, KIN_V, KIN_A0, KIN_L0, KIN_A, KIN_L, KIN_SIZE = 0, 3, 12, 16, 19, 22, 25, 28, 31, 34

# of a link with all that hangs on it, about its tree's first origin: mass, first moments (3), inertia (6), forces of mounts
# (6), of inertia and weight (6)
COM_M, COM_H, COM_I, COM_E, COM_B, COM_SIZE = 0, 1, 4, 10, 16, 22
