"""Layout of a system's mounts inside a MuJoCo model, so that one callback serves every model and thread.

The last actuator of a system's model is its state actuator: `dyntype="user"`, one activation per internal state of every
mount axis, no force of its own. Its `dynprm` says where the rest is:

    dynprm = MAGIC, layout, parameters, userdata, activation        addresses into numeric_data, userdata and act

The layout (in `numeric_data`) holds a header and tables of integers, the parameters those of the laws, in the order of
the axes table. `userdata` holds what the callbacks exchange within and between steps. Nothing lives outside mjModel and mjData.
"""

from dataclasses import dataclass, field

from wirerope_mj.foundation.arrays import Array

MAGIC = 2004.28  # marks a state actuator: the number of the thesis' report (DCT 2004/28)
STATE_ACTUATOR = "wirerope/states"
LAYOUT = "wirerope/layout"
PARAMETERS = "wirerope/parameters"

# entries of `dynprm`
PRM_MAGIC, PRM_LAYOUT, PRM_PARAMETERS, PRM_USERDATA, PRM_ACTIVATION = range(5)

# header of the layout
N_MOUNTS, N_DRIVEN, N_BODIES, N_POINTS, N_TREE, N_STATES, N_CHANNELS = range(7)
MOUNTS, AXES, DRIVEN, BODIES, POINTS, TREE, CHANNELS, SENSOR, N_SLIPPING, N_CONTACTS, N_STOPS = range(7, 18)
USER_MOUNTS, USER_RATES, USER_ACCELERATIONS, USER_CHANNELS, USER_CONTACTS, USER_STOPS = range(18, 24)  # see `UserData`
N_FORCES, FORCES, USER_FORCES, N_PAIRS, PAIRS, USER_TRAVELS, N_MODES, MODES, STOPS, USER_CLOSINGS = range(24, 34)
# where the turning accelerations stand in userdata, and the base's orientation as modelled in the layout (0: it never turns)
USER_TURNS, BASE_MODELLED = 34, 35
HEADER = 36

# columns of the tables
MOUNT_COLUMNS = 22
PAYLOAD_SITE, BASE_SITE, PAYLOAD, BASE, PAYLOAD_ROOT, BASE_ROOT = range(6)  # ids of sites, bodies and their trees' roots
MOVED = 6  # whether the base takes the reaction
COUPLING = 7  # index of the parameters of coupled axes (-1: none)
TURNING, MODELLED = 8, 11  # rotational stiffnesses about the base site's axes (3); orientation as modelled (4)
PARTNER = 15  # axis that roll is coupled to: 1 shear, 2 axial
TRAVEL = 16  # one over the square of the rated travel along roll, shear, in compression, in tension (4); 0: not rated
# where the shapes at the payload's and at the base's site stand, from the layout's begin on; here and elsewhere 0 of what is
# on no flexible part
SHAPES = 20
# law number (-1: none, `WITH_ANOTHER`: on brackets with the axis that it is coupled to), first parameter, first state, number
# of states; three rows per mount
LAW, FIRST_PARAMETER, FIRST_STATE, LAW_STATES, AXIS_COLUMNS = range(5)
# dof, effective inertia, rows of the maps from the base's acceleration to a slide's, from roll'', pitch'', yaw'' to a hinge's
DRIVEN_COLUMNS = 8
BODY_COLUMNS = 2  # body, root
# site, body, root, base body, point from the base body's centre of mass as modelled (3), shapes
POINT_BASE, POINT_MODELLED, POINT_SHAPES, POINT_COLUMNS = 3, 4, 7, 8
TREE_COLUMNS = 3  # parent, first dof, number of dofs; one row per body of the model
# site, body, shapes; a row for every site at which a force may act
FORCE_SITE, FORCE_BODY, FORCE_SHAPES, FORCE_COLUMNS = range(4)
# mount, axis, first parameter, first state (-1: its force has no memory); a row for every stop among the laws
STOP_MOUNT, STOP_AXIS, STOP_PARAMETER, STOP_STATE, STOP_COLUMNS = range(5)
PAIR_COLUMNS = 2  # the two geoms; a row for every pair that the model declares
MODE_COLUMNS = 4  # dof, participation [sqrt(kg)] along the world's axes (3); a row for every mode of a flexible part
# shapes at a site: number of modes, then of each dof, coordinate in qpos, and shape in the site's axes [1/sqrt(kg)] (3)
SHAPE_COLUMNS, SHAPE = 5, 2
CHANNEL_COLUMNS = 1  # index of a 3-vector among the system's sensor values

# userdata, relative to the system's first entry
STAGE_POINTS, STAGE_START, STAGE_RATE, EVENT, HISTORY, TIME_1, TIME_2, OBSERVING = range(8)
STAGES = 8
# steps that one stage table serves: long enough that Python between tables costs nothing, short enough to copy
MAX_STEPS = 64

SMOOTH, CORNER, JUMP = 0.0, 1.0, 2.0  # values of userdata[EVENT] at the first step of a stage table

# sensor values
KINEMATICS = 19  # position 3, orientation 4, velocity 3, angular velocity 3, acceleration 3, angular acceleration 3
ACCELERATION = 13  # index of the acceleration among them
POINT_VALUES = 22  # kinematics, displacement relative to the base 3
RELATIVE = 19  # index of the relative displacement among them
MOUNT_VALUES = 6  # deflection 3, force 3; the axis' internal states follow

# memory of one channel of the peak tracker
BEFORE, LAST = 0, 3  # the vectors one and two steps ago
LOW, LOW_TIME, HIGH, HIGH_TIME = 6, 9, 12, 15  # extremes of the components
PEAK, PEAK_TIME, PEAK_VECTOR = 18, 19, 20  # of the norm
CHANNEL_MEMORY = 23

# memory of a mount's travel along all axes at once, as the square of its utilisation: of the last two steps, whether the last
# was judged, the largest and its instant, the largest that is judged and its instant
TRAVEL_BEFORE, TRAVEL_LAST, WAS_JUDGED, FARTHEST, FARTHEST_TIME, JUDGED, JUDGED_TIME = range(7)
TRAVEL_MEMORY = 7

# memory of the speed at which a stop closes: of the last step, and the largest while it is closed, with its instant
LAST_SPEED, CLOSING, CLOSING_TIME, CLOSING_MEMORY = range(4)

# memory of the contacts of one pair of geoms, and of one stop among the mounts' laws (which has no geoms)
GEOMS, WORK, TOUCHES, FROM_START, FIRST_TOUCH, LAST_TOUCH, TOUCHED_FOR, FORCE_NOW = range(8)
FORCE_PEAK, FORCE_TIME, DEPTH, DEPTH_TIME = 8, 9, 10, 11
CONTACT_MEMORY = 12
SEVERAL = -2.0  # instead of geoms: the row is shared by all pairs for which there was none left
FREE = -3.0  # instead of geoms: nothing has the row yet
MOST_GEOMS = 1 << 24  # by which the number of a pair is that of its first geom and of its second


@dataclass(frozen=True, kw_only=True)
class UserData:
    """Addresses inside the system's part of userdata, relative to its first entry; the layout's header holds them, too."""

    n_mounts: int
    n_states: int
    n_tree: int
    n_channels: int
    n_contacts: int
    n_stops: int = 0
    n_forces: int = 0
    rotates: bool = False  # whether the base has hinges that are driven
    mounts: int = field(init=False)  # deflection and force of every mount, (n_mounts, 6)
    rates: int = field(init=False)  # rates of the internal states, (n_states,)
    # spatial accelerations of the bodies about their tree's centre of mass, (n_tree, 6)
    accelerations: int = field(init=False)
    channels: int = field(init=False)  # memory of the peak tracker, (n_channels, CHANNEL_MEMORY)
    contacts: int = field(init=False)  # memory of contacts, (n_contacts, CONTACT_MEMORY)
    stops: int = field(init=False)  # memory of the stops among the mounts' laws, (n_stops, CONTACT_MEMORY)
    # forces and moments on the payload at the half steps of a segment, (2 MAX_STEPS + 1, n_forces, 6)
    forces: int = field(init=False)
    travels: int = field(init=False)  # memory of the mounts' travel along all axes at once, (n_mounts, TRAVEL_MEMORY)
    closings: int = field(init=False)  # memory of the speeds at which stops close, (n_stops, CLOSING_MEMORY)
    turns: int = field(init=False)  # second derivatives of roll, pitch and yaw at the half steps, (2 MAX_STEPS + 1, 3), or none
    size: int = field(init=False)  # number of entries

    def __post_init__(self) -> None:
        half_steps, address = 2 * MAX_STEPS + 1, 0
        sizes = {
            "mounts": STAGES + 3 * half_steps, "rates": 6 * self.n_mounts, "accelerations": self.n_states,
            "channels": 6 * self.n_tree, "contacts": CHANNEL_MEMORY * self.n_channels,
            "stops": CONTACT_MEMORY * self.n_contacts, "forces": CONTACT_MEMORY * self.n_stops,
            "travels": 6 * self.n_forces * half_steps, "closings": TRAVEL_MEMORY * self.n_mounts,
            "turns": CLOSING_MEMORY * self.n_stops, "size": 3 * half_steps if self.rotates else 0,
        }  # fmt: skip
        for part, before in sizes.items():  # what stands between this part's address and the last one's
            address += before
            object.__setattr__(self, part, address)

    def mount_rows(self, user: Array) -> Array:
        """View deflection and force of every mount in the system's userdata, (..., n_mounts, 2, 3)."""
        return user[..., self.mounts : self.rates].reshape(*user.shape[:-1], self.n_mounts, 2, 3)

    def channel_rows(self, user: Array) -> Array:
        """Return the memory of the peak tracker from the system's userdata, a view, (n_channels, CHANNEL_MEMORY)."""
        return user[self.channels : self.contacts].reshape(self.n_channels, CHANNEL_MEMORY)

    def contact_rows(self, user: Array) -> Array:
        """Return the memory of contacts from the system's userdata, a view, (n_contacts, CONTACT_MEMORY)."""
        return user[self.contacts : self.stops].reshape(self.n_contacts, CONTACT_MEMORY)

    def stop_rows(self, user: Array) -> Array:
        """Return the memory of the mounts' stops from the system's userdata, a view, (n_stops, CONTACT_MEMORY)."""
        return user[self.stops : self.forces].reshape(self.n_stops, CONTACT_MEMORY)

    def travel_rows(self, user: Array) -> Array:
        """Return the memory of the mounts' travel from the system's userdata, a view, (n_mounts, TRAVEL_MEMORY)."""
        return user[self.travels : self.closings].reshape(self.n_mounts, TRAVEL_MEMORY)

    def closing_rows(self, user: Array) -> Array:
        """Return the memory of the stops' closing speeds from the system's userdata, a view, (n_stops, CLOSING_MEMORY)."""
        return user[self.closings : self.turns].reshape(self.n_stops, CLOSING_MEMORY)
