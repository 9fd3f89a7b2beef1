"""The equations of a system, read from its compiled model: structure, numbers that variants share, numbers of one variant."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.control.mounts import AXIAL
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.bodies import HERE, Bodies, Writer, inertia_of, modelled_pose, pair_rows
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.engine.system.tables import Tables
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws.friction import ELEMENTS
from wirerope_mj.mounts.laws.plane_kernels import RATE_NUMBERS
from wirerope_mj.mounts.laws.registry import HEAD, MASING, ON_BRACKET, OWN, PARALLEL, SMOOTHED, STOP, TABULATED
from wirerope_mj.mounts.laws.stop_kernels import N_POINTS

# places of a table's number of knots among its parameters, and of a loop's energy among those of coupled axes
KNOTS = 4
Integers = npt.NDArray[np.int64]
_FREE, _SLIDE = mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_SLIDE
_ENABLED = mujoco.mjtEnableBit.mjENBL_ENERGY | mujoco.mjtEnableBit.mjENBL_FWDINV


@dataclass(frozen=True, kw_only=True)
class Equations:
    """Equations of one system, as `wirerope_mj.engine.kernel.layout` describes them."""

    lay: Integers  # structure, (n_lay,)
    fix: Array  # numbers that systems of one structure must share to be computed side by side, (n_fix,)
    num: Array  # numbers of the system, (n_num,)
    # the links' rows of working memory that no step changes: axes of what never turns, (n_rows,) from KIN on
    rest: Array
    # integers among the parameters, of which all lanes have the same: elements, knots, laws in parallel
    counts: tuple[int, ...] = ()
    loaded: tuple[str, ...] = ()  # sites at which forces may act

    def rows(self, table: int, columns: int, count: int) -> Integers:
        """Return a table of the structure, whose address stands in the header's entry `table`, a view, (count, columns)."""
        return self.lay[self.lay[table] :][: columns * count].reshape(count, columns)

    @property
    def n_values(self) -> int:
        return int(self.lay[at.N_VALUES])

    @property
    def key(self) -> bytes:
        """Bytes that are equal for systems whose equations differ in numbers only, so that they can be stepped side by side."""
        return self.lay.tobytes() + self.fix.tobytes() + self.rest.tobytes() + repr((self.counts, self.loaded)).encode()


def equations_of(system: System) -> Equations:
    """Build the equations of a system in which `not_held` finds nothing."""
    model, assembly, bodies = system.model, system.assembly, Bodies(system.model)
    tables, subjects = assembly.tables, assembly.subjects
    fix, num, lay = Writer([]), Writer([]), np.zeros(at.HEADER, dtype=np.int64)
    links, kinds = _links(bodies, {mode.body for mode in subjects.modes}, fix, num)
    dofs = _dofs(system, bodies, kinds, fix, num)
    shapes, places = _shapes(system, bodies, kinds, fix)
    mounts, runs = _mounts(system, bodies, kinds, places, fix, num)
    frames = _frames(system, bodies, places, fix, num)
    weightless = model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
    lay[at.GRAVITY] = fix.put(np.zeros(3) if weightless else model.opt.gravity)
    masses = tables.rows(control.DRIVEN, control.DRIVEN_COLUMNS, len(tables.drive))[:, 1]  # as the callback has them
    lay[at.DRIVEN] = fix.put(
        [[*row, *turn, mass] for row, turn, mass in zip(tables.drive, tables.turning, masses, strict=True)]
    )
    lay[at.ROTATES] = fix.put(bodies.on_parent(subjects.base)[1].axes) if tables.rotates else -1
    lay[at.PARAMETERS] = num.put(tables.parameters)
    axes = tables.rows(control.AXES, control.AXIS_COLUMNS, 3 * tables.user.n_mounts).astype(np.int64).tolist()
    stops = [
        [at.RECORD_SIZE * mount + axis, first, state]
        for mount, axis, first, state in tables.rows(
            control.STOPS, control.STOP_COLUMNS, int(tables.layout[control.N_STOPS])
        ).astype(np.int64).tolist()
    ]  # fmt: skip
    trees, pairs = _trees(bodies, kinds, dofs, num), pair_rows(model, bodies, fix)
    forces = []
    for site in subjects.forces:
        link, pose = bodies.site(site)
        to = to_equation_axes(bodies, kinds, link)
        forces.append([link, num.put(to @ pose.origin), fix.put((to @ pose.axes).T), places.get(site, 0)])
    parts: dict[int, object] = {
        at.LINKS: links, at.TREES: trees, at.DOFS: dofs, at.RUNS: runs, at.MOUNTS: mounts, at.AXES: axes, at.FRAMES: frames,
        at.CHANNELS: tables.channels[tables.tracked], at.STOPS: stops, at.PAIRS: pairs,
        at.MODES: [[mode.dof, fix.put(mode.participation)] for mode in subjects.modes], at.FORCES: forces,
    }  # fmt: skip
    flat = [lay, np.array(shapes, dtype=np.int64)]
    for table, rows in parts.items():
        lay[table] = sum(part.size for part in flat)
        flat.append(np.asarray(rows, dtype=np.int64).ravel())
    n_values = int(sum(control.POINT_VALUES if row[at.IS_POINT] else control.KINEMATICS for row in frames))
    n_values += control.MOUNT_VALUES * len(mounts) + tables.user.n_states
    n_values += int(tables.layout[control.N_PAIRS])  # no pair of geoms touches here, and their forces stay zero
    counts = {
        at.N_LINKS: len(bodies.links), at.N_TREES: len(trees), at.NQ: model.nq, at.NV: model.nv,
        at.N_STATES: tables.user.n_states, at.N_MOUNTS: len(mounts), at.N_FRAMES: len(frames),
        at.N_CHANNELS: tables.tracked.size, at.N_STOPS: len(stops), at.N_SLIPPING: tables.layout[control.N_SLIPPING],
        at.N_DRIVEN: len(tables.drive), at.N_VALUES: n_values, at.N_RUNS: len(runs), at.N_PAIRS: len(pairs),
        at.N_MODES: len(subjects.modes), at.N_FORCES: len(forces),
    }  # fmt: skip
    lay[list(counts)] = list(counts.values())
    _sections(lay, largest=max((row[at.TREE_DOFS] for row in trees), default=0))
    rest = np.zeros((len(kinds) + 1, at.KIN_SIZE))
    for number, kind in enumerate([*kinds, at.STRAIGHT]):
        if kind == at.STRAIGHT:
            pose = HERE if number == len(kinds) else modelled_pose(bodies, number)
            rest[number, at.KIN_R : at.KIN_R + 9], rest[number, at.KIN_Q : at.KIN_Q + 4] = pose.axes.ravel(), pose.quaternion
    return Equations(
        lay=np.concatenate(flat), fix=np.array(fix.numbers), num=np.array(num.numbers), rest=rest.ravel(),
        counts=_counts(tables, axes), loaded=subjects.force_names,
    )  # fmt: skip


def _sections(lay: Integers, *, largest: int) -> None:
    """Write into the header where the sections of the kernel's working memory begin, and its size."""
    tangents, states = 2 * lay[at.NV] + lay[at.N_STATES], lay[at.NQ] + lay[at.NV] + lay[at.N_STATES]
    sizes = {
        at.KIN: at.KIN_SIZE * (lay[at.N_LINKS] + 1), at.WRENCH: 6 * (lay[at.N_LINKS] + 1), at.SUB: 6 * lay[at.NV],
        at.MASS: largest**2, at.RHS: lay[at.NV], at.RATES: lay[at.N_STATES], at.COMPOSITE: at.COM_SIZE * lay[at.N_LINKS],
        at.START: states, at.SLOPE: tangents, at.SUM: tangents, at.RECORD: at.RECORD_SIZE * lay[at.N_MOUNTS],
        at.VALUES: lay[at.N_VALUES], at.RECENT: at.RECENT_SIZE * lay[at.N_CHANNELS],
        at.MEMORY: control.CHANNEL_MEMORY * lay[at.N_CHANNELS], at.TOUCHED: control.CONTACT_MEMORY * lay[at.N_STOPS],
        at.TRAVELS: control.TRAVEL_MEMORY * lay[at.N_MOUNTS], at.CLOSINGS: control.CLOSING_MEMORY * lay[at.N_STOPS],
        at.FAILED: 1, at.LOADS: 18 * lay[at.N_FORCES],
    }  # fmt: skip
    total = 0
    for section, size in sizes.items():
        lay[section] = total
        total += int(size)
    lay[at.N_WORK] = total


def _links(bodies: Bodies, modal: set[int], fix: Writer, num: Writer) -> tuple[list[list[int]], list[int]]:
    """Return the table of the links, row by row, the world's last, and the kind of each link."""
    model = bodies.model
    rows: list[list[int]] = []
    kinds: list[int] = []
    for number, body in enumerate(bodies.links):
        joints = range(int(model.body_jntadr[body]), int(model.body_jntadr[body] + model.body_jntnum[body]))
        parent, pose = bodies.on_parent(body)
        parent = parent if parent < len(bodies.links) else -1
        if body in modal:
            kind = at.MODAL
        elif any(model.jnt_type[j] == _FREE for j in joints):
            kind = at.FREE
        elif all(model.jnt_type[j] == _SLIDE for j in joints) and (parent < 0 or kinds[parent] == at.STRAIGHT):
            kind = at.STRAIGHT
        else:
            kind = at.TURNING
        origin = pose.origin
        if kind == at.STRAIGHT and parent >= 0:
            origin = modelled_pose(bodies, parent).axes @ origin
        kinds.append(kind)
        first, n_dofs, tree = int(model.body_dofadr[body]), int(model.body_dofnum[body]), int(model.body_treeid[body])
        frame, inertia = fix.put(origin, pose.quaternion), num.put(inertia_of(bodies, number))
        rows.append([parent, first, n_dofs, kind, tree, frame, inertia])
    rows.append([-1, 0, 0, at.STRAIGHT, -1, 0, 0])
    return rows, kinds


def _dofs(system: System, bodies: Bodies, kinds: list[int], fix: Writer, num: Writer) -> list[list[int]]:
    """Return the table of the velocity coordinates, row by row; constants go to `fix`, springs to `num`."""
    model, driven = system.model, system.assembly.driven_dofs
    rows = []
    for dof in range(model.nv):
        joint, link = int(model.dof_jntid[dof]), bodies.link[int(model.dof_bodyid[dof])]
        q, along = int(model.jnt_qposadr[joint]), dof - int(model.jnt_dofadr[joint])
        free, slide = model.jnt_type[joint] == _FREE, model.jnt_type[joint] == _SLIDE
        kind = (at.ALONG if along else at.FLOATING) if free else at.SLIDE if slide else at.HINGE
        axis = model.jnt_axis[joint]
        if kinds[link] == at.STRAIGHT:
            axis = modelled_pose(bodies, link).axes @ axis
        limits = np.zeros(2)  # between which a joint's limits do not act; none has equal ones
        if model.jnt_limited[joint] and not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_LIMIT:
            limits = model.jnt_range[joint] + model.jnt_margin[joint] * np.array([1.0, -1.0])
        constants = fix.put(axis, model.jnt_pos[joint], model.dof_armature[dof], model.qpos0[q], limits)
        spring = num.put(spring_of(model, dof))
        number = driven.index(dof) if dof in driven else -1
        rows.append([link, kind, q, int(model.dof_parentid[dof]), number, constants, spring])
    return rows


def spring_of(model: mujoco.MjModel, dof: int) -> tuple[float, float, float]:
    """Return damping and stiffness of a joint's coordinate, and where its spring is at rest."""
    joint = int(model.dof_jntid[dof])
    reference = model.qpos_spring[int(model.jnt_qposadr[joint])]
    return float(model.dof_damping[dof]), float(model.jnt_stiffness[joint]), float(reference)


def _trees(bodies: Bodies, kinds: list[int], dofs: list[list[int]], num: Writer) -> list[list[int]]:
    """Return the table of the kinematic trees, row by row; a tree's kind says how its equations are solved."""
    model = bodies.model
    trees = model.body_treeid[bodies.links]
    rows = []
    for tree in range(model.ntree):
        links, of_tree = np.flatnonzero(trees == tree), np.flatnonzero(model.dof_treeid == tree)
        plain = not (model.dof_armature[of_tree].any() or model.dof_damping[of_tree].any())
        if all(dofs[dof][at.DOF_DRIVEN] >= 0 for dof in of_tree):
            kind = at.DRIVEN_TREE
        elif kinds[links[0]] == at.MODAL:
            kind = at.MODAL_TREE
        elif len(links) == 1 and kinds[links[0]] == at.FREE and plain:
            kind = at.FREE_TREE
        elif len(links) == 1 and kinds[links[0]] == at.STRAIGHT and not any(dofs[dof][at.DOF_DRIVEN] >= 0 for dof in of_tree):
            kind = at.SLIDING_TREE
        else:
            kind = at.ANY_TREE
        inverse = num.put(inverse_mass(bodies, int(links[0]), of_tree)) if kind == at.SLIDING_TREE else 0
        rows.append([kind, int(of_tree[0]), of_tree.size, int(links[0]), links.size, inverse])
    return rows


def inverse_mass(bodies: Bodies, link: int, dofs: Integers) -> Array:
    """Return the inverse of the mass matrix of a link that only slides, (n, n)."""
    model = bodies.model
    axes = model.jnt_axis[model.dof_jntid[dofs]]
    mass = inertia_of(bodies, link)[at.MASS_OF] * axes @ axes.T + np.diag(model.dof_armature[dofs])
    return np.linalg.inv(mass)


def _mounts(
    system: System, bodies: Bodies, kinds: list[int], places: dict[int, int], fix: Writer, num: Writer
) -> tuple[list[list[int]], list[list[int]]]:
    """Return the tables of the mounts and of their runs: successive mounts between the same two links."""
    tables = system.assembly.tables
    rows: list[list[int]] = []
    runs: list[list[int]] = []
    for row in tables.rows(control.MOUNTS, control.MOUNT_COLUMNS, tables.user.n_mounts):
        (payload, site), (base, base_site) = (bodies.site(int(row[c])) for c in (0, 1))
        turning, rated = row[control.TURNING : control.TURNING + 3], row[control.TRAVEL : control.TRAVEL + 4]
        of_payload, of_base = (to_equation_axes(bodies, kinds, link) for link in (payload, base))
        points = num.put(of_payload @ site.origin, of_base @ base_site.origin, turning, rated)
        axes = of_base @ base_site.axes
        frame = fix.put(axes.T, base_site.quaternion, site.quaternion, row[control.MODELLED : control.MODELLED + 4])
        coupling, aligned = (int(row[control.COUPLING]), int(row[control.PARTNER])), np.array_equal(axes, np.eye(3))
        bends = (places.get(int(row[c]), 0) for c in (0, 1))
        rows.append([int(row[6]), points, frame, *coupling, int(turning.any()), int(aligned), *bends])
        if runs and runs[-1][: at.RUN_MOUNTS] == [payload, base]:
            runs[-1][at.RUN_MOUNTS] += 1
        else:
            runs.append([payload, base, 1])
    return rows, runs


def _shapes(system: System, bodies: Bodies, kinds: list[int], fix: Writer) -> tuple[list[int], dict[int, int]]:
    """Return the table of mode shapes at sites of flexible parts, which stands behind the header, and each site's row."""
    model, table, places = system.model, list[int](), {}
    for site, modes in system.assembly.subjects.shapes.items():
        link, pose = bodies.site(site)
        of_point = site in system.assembly.subjects.points  # whose place is in the link's own axes
        to_link = pose.axes if of_point else to_equation_axes(bodies, kinds, link) @ pose.axes
        places[site] = at.HEADER + len(table)
        table.append(len(modes))
        for dof, shape in modes:
            table += [dof, int(model.jnt_qposadr[model.dof_jntid[dof]]), fix.put(to_link @ shape)]
    return table, places


def to_equation_axes(bodies: Bodies, kinds: list[int], link: int) -> Array:
    """Return the rotation from a link's axes to those in which the equations state its vectors, (3, 3)."""
    return modelled_pose(bodies, link).axes if link < len(kinds) and kinds[link] == at.STRAIGHT else np.eye(3)


def _counts(tables: Tables, axes: list[list[int]]) -> tuple[int, ...]:
    """Return the integers among the laws' parameters, on which the meaning of the numbers behind them depends."""
    par = tables.parameters
    counts: list[int] = []

    def law_counts(law: int, p: int) -> None:
        where = {MASING: p + ELEMENTS, SMOOTHED: p + 1, TABULATED: p + KNOTS, STOP: p + N_POINTS, PARALLEL: p}
        if law in where:
            counts.append(int(par[where[law]]))
        if law == SMOOTHED:
            law_counts(int(par[p + 1]), p + 2)
        if law == ON_BRACKET:
            counts.append(int(par[p + 1]))
            law_counts(PARALLEL, p + HEAD)
        for part in range(int(par[p]) if law == PARALLEL else 0):
            kind, first, state = (int(number) for number in par[p + 1 + 3 * part : p + 4 + 3 * part])
            counts.extend([kind, first, state])
            law_counts(kind, p + first)

    for law, first, _, _ in axes:
        law_counts(law, first)
    for mount, row in enumerate(tables.rows(control.MOUNTS, control.MOUNT_COLUMNS, tables.user.n_mounts)):
        if row[control.COUPLING] >= 0.0 and row[control.PARTNER] == AXIAL:  # the grid of a loop's energy
            first = int(row[control.COUPLING]) + RATE_NUMBERS * axes[3 * mount][3]
            counts.extend(int(par[first + entry]) for entry in (4, 5))
    return tuple(counts)


def _frames(system: System, bodies: Bodies, places: dict[int, int], fix: Writer, num: Writer) -> list[list[int]]:
    """Return the table of the observed bodies and points, row by row."""
    model, assembly = system.model, system.assembly
    tables, rows = assembly.tables, []
    base = assembly.subjects.base
    base_centre = bodies.pose[base].then(model.body_ipos[base], model.body_iquat[base]).origin
    tracked = set(tables.tracked.tolist())
    for number, body in enumerate(assembly.subjects.bodies):
        pose = bodies.pose[body]
        centre = pose.then(model.body_ipos[body], model.body_iquat[body]).origin
        rows.append([bodies.link[body], num.put(centre), fix.put(pose.quaternion), 0, 0, 0, 0, int(number in tracked), 0])
    points = assembly.subjects.points
    for site, row in zip(points, tables.rows(control.POINTS, control.POINT_COLUMNS, len(points)), strict=True):
        link, pose = bodies.site(site)
        base_row = [bodies.link[base], num.put(base_centre), fix.put(row[4:7])]
        rows.append([link, num.put(pose.origin), fix.put(pose.quaternion), 1, *base_row, 1, places.get(site, 0)])
    return rows


@once_per_system
def equations(system: System) -> Equations:
    return equations_of(system)


@once_per_system
def not_held(system: System) -> str:
    """Return the element of a model that the kernel's equations cannot represent, "" if there is none."""
    model, assembly = system.model, system.assembly
    counts = {
        "equality constraints": model.neq, "tendons": model.ntendon, "actuators of its own": model.nu - 1,
        "plugins": model.nplugin, "flexible bodies": model.nflex, "mocap bodies": model.nmocap,
        "gravity compensation": model.ngravcomp, "springs that yield": model.nplastic,
        "activations of its own": model.na - assembly.tables.user.n_states,
        "laws that a program brings along": sum(
            part.kernel == OWN
            for mount in system.mounts.values()
            for law in mount.isolator.axes.values()
            for part in (law.components if law else ())
        ),
    }  # fmt: skip
    kinds, free = model.jnt_type, mujoco.mjtJoint.mjJNT_FREE
    allowed = {
        "ball joints": kinds == mujoco.mjtJoint.mjJNT_BALL, "dry friction in joints": model.dof_frictionloss > 0.0,
        "springs of floating bodies": (kinds == free) & (model.jnt_stiffness != 0.0),
        "springs or dampers that are not linear": [model.jnt_stiffnesspoly.any(), model.dof_dampingpoly.any()],
        "a medium around it": [model.opt.density, model.opt.viscosity],
        "options of MuJoCo's that change its steps": [model.opt.enableflags & ~_ENABLED],
    }  # fmt: skip
    parts = [name for name, number in counts.items() if number > 0]
    parts += [name for name, values in allowed.items() if np.any(values)]
    return f"the model has {', '.join(parts)}" if parts else ""
