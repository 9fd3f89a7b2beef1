"""The tables that the callback reads: mounts, axes, drive, bodies, points, the tree, pairs of geoms, and what has peaks."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.response.peaks import ContactPeak
from wirerope_mj.engine.system.declared import DeclaredMount
from wirerope_mj.engine.system.modal import DeclaredMode
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws.plane_kernels import WITH_ANOTHER
from wirerope_mj.mounts.laws.registry import MASING, PARALLEL, STOP
from wirerope_mj.mounts.laws.stop_kernels import LOSS

MOST_CONTACTS = 32  # rows for contacts that no `pair` declares: more seldom touch in one run, and each row is part of a state
# inertia of a driven slide [kg]: what pushes back on the base, say 1 MN, changes its acceleration by 1e-4 m/s^2
DRIVE_ARMATURE = 1e10
# the same of a base that rotates [kg, kg m^2]: the inertia of what turns with it, say 1e4 kg m^2, couples its slides and
# hinges, and changes their accelerations by 1e-10
ROTATING_ARMATURE = 1e14
TURNS = ("base/roll", "base/pitch", "base/yaw")  # names of the hinges by which a base rotates


def contact_capacity(model: mujoco.MjModel) -> int:
    """Return the size of the memory of contacts: the declared pairs, and up to `MOST_CONTACTS` others."""
    if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT:
        return 0
    if model.nflex:
        return int(model.npair) + MOST_CONTACTS
    # pairs of geoms that MuJoCo may let touch by their contact types, those declared as `pair` besides
    meet = (model.geom_contype[:, np.newaxis] & model.geom_conaffinity) != 0
    bodies = model.body_weldid[model.geom_bodyid]
    meet = (meet | meet.T) & (bodies[:, np.newaxis] != bodies)
    return int(model.npair) + min(int(np.count_nonzero(np.triu(meet, 1))), MOST_CONTACTS)


def declared_pairs(model: mujoco.MjModel) -> list[tuple[int, int]]:
    """Return the geoms of the model's declared pairs, in its order; none where contacts are disabled."""
    pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    return list(pairs)[: contact_capacity(model)]


def declared_contacts(model: mujoco.MjModel, base: int) -> dict[str, ContactPeak]:
    """Return the declared pairs by name, as contacts that have not touched; ModelError if a pair is declared twice."""
    pairs = [payload_first(model, base, pair) for pair in declared_pairs(model)]
    for number, pair in enumerate(pairs):
        if set(pair) in map(set, pairs[:number]):
            raise ModelError(
                f"the <pair> of geoms {geom_name(model, pair[0])!r} and {geom_name(model, pair[1])!r} stands there twice, and "
                "their forces would be doubled. Remove one, or give it geoms of its own."
            )
    return {contact_name(model, pair): untouched_contact(model, pair) for pair in pairs}


def untouched_contact(model: mujoco.MjModel, pair: tuple[int, int]) -> ContactPeak:
    """Return the contact record of two geoms that have not touched."""
    bodies = [model.body(model.geom_bodyid[geom]).name if geom >= 0 else "" for geom in pair]
    return ContactPeak(geoms=(geom_name(model, pair[0]), geom_name(model, pair[1])), bodies=(bodies[0], bodies[1]))


def contact_name(model: mujoco.MjModel, geoms: tuple[int, int]) -> str:
    """Name a pair of geoms, "stop_1 on pad_1"."""
    return " on ".join(geom_name(model, geom) for geom in geoms)


def geom_name(model: mujoco.MjModel, geom: int) -> str:
    """Return a geom's name, or its number and the body that it belongs to."""
    if geom < 0:
        return "a flexible body"
    return model.geom(geom).name or f"geom {geom} of {model.body(model.geom_bodyid[geom]).name or 'the world'}"


def payload_first(model: mujoco.MjModel, base: int, pair: tuple[int, int]) -> tuple[int, int]:
    """Order a pair of geoms, a geom fixed to the base or the world last; MuJoCo orders them by shape."""
    fixed = [geom < 0 or model.body_weldid[model.geom_bodyid[geom]] in (0, base) for geom in pair]
    return (pair[1], pair[0]) if fixed[0] and not fixed[1] else pair


@dataclass(frozen=True, kw_only=True)
class Subjects:
    """Ids, in a compiled model, of the base (0: the world), its driven slides, observed bodies and points, flexible modes.

    A point's name is what follows `point/` in that of its site, prefixes of an attached model included; so with the sites at
    which forces may act, which are called `force/NAME`.
    """

    base: int
    driven: tuple[int, ...]
    bodies: tuple[int, ...]
    points: tuple[int, ...]
    body_names: tuple[str, ...]
    point_names: tuple[str, ...]
    forces: tuple[int, ...] = ()
    force_names: tuple[str, ...] = ()
    modes: tuple[DeclaredMode, ...] = ()  # of all flexible parts

    @cached_property
    def shapes(self) -> dict[int, list[tuple[int, Array]]]:
        """Velocity coordinate and shape in the site's axes of every mode, by the sites of flexible parts."""
        sites: dict[int, list[tuple[int, Array]]] = {}
        for mode in self.modes:
            for site, shape in mode.shapes.items():
                sites.setdefault(site, []).append((mode.dof, shape))
        return sites


@dataclass(frozen=True, kw_only=True)
class Tables:
    """The callback's tables as numbers, and the addresses and sizes by which the library reads its results."""

    layout: Array  # header and tables, as `wirerope_mj.engine.control.layout` describes them, (n,)
    parameters: Array  # parameters of all laws, (n_p,)
    user: at.UserData  # addresses in userdata
    drive: Array  # slide accelerations from base acceleration, (n_driven, 3); 0 of hinges
    turning: Array  # hinge accelerations from those of roll, pitch and yaw, (n_driven, 3); 0 of slides
    channels: Integers  # indices of the tracked 3-vectors among the system's sensor values, (n_channels,)
    base_channels: tuple[int, ...]  # numbers of the channels with the acceleration of what is fixed to the driven base
    tracked: Integers  # numbers of the others, of all where the base rotates, (n_tracked,)
    # per mount where the states of roll, shear and axial stand among the internal states
    states: dict[str, tuple[slice, slice, slice]]

    @property
    def rotates(self) -> bool:
        """True if the base has driven hinges."""
        return bool(self.turning.any())

    def rows(self, table: int, columns: int, count: int) -> Array:
        """Return a table of the layout, whose address stands in the header's entry `table`, a view, (count, columns)."""
        first = int(self.layout[table])
        return self.layout[first : first + columns * count].reshape(count, columns)

    @property
    def sites(self) -> Integers:
        """Ids of the payload's and the base's site of every mount, (n_mounts, 2)."""
        return self.rows(at.MOUNTS, at.MOUNT_COLUMNS, self.user.n_mounts)[:, :2].astype(np.int64)


def make_tables(
    model: mujoco.MjModel, data: mujoco.MjData, declared: list[DeclaredMount], on: Subjects, *, sensor: int,
    nominal: Tables | None = None,
) -> Tables:  # fmt: skip
    """Build the callback's tables for a model whose modelled geometry is computed in `data`.

    `sensor` is the address of the system's first sensor value; of a variant, drive and rows for stops are those of `nominal`.
    """
    isolators = {mount.name: mount.isolator for mount in declared}
    mujoco.mj_kinematics(model, data)
    if nominal is not None:
        drive, turning, n_stops = nominal.drive, nominal.turning, nominal.user.n_stops
    else:  # the slides' axes are independent: `check_joints`
        hinges = [joint for joint in on.driven if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE]
        slides = [joint for joint in on.driven if joint not in hinges]
        drive, turning = np.linalg.pinv(data.xaxis[slides]).T if slides else np.zeros((0, 3)), np.zeros((len(slides), 3))
        if hinges:
            about = [[float(model.joint(joint).name.endswith(name)) for name in TURNS] for joint in hinges]
            drive, turning = np.vstack([drive, np.zeros((len(hinges), 3))]), np.vstack([turning, about])
        n_stops = sum(len(isolator.conditioned.stops) for isolator in isolators.values())
    # body accelerations, point accelerations and displacements, mount deflections and forces
    channels = [at.KINEMATICS * i + at.ACCELERATION for i in range(len(on.bodies))]
    first = at.KINEMATICS * len(on.bodies)
    for i in range(len(on.points)):
        channels += [first + at.POINT_VALUES * i + part for part in (at.ACCELERATION, at.RELATIVE)]
    first += at.POINT_VALUES * len(on.points)
    for mount in declared:
        channels += [first, first + 3]
        first += at.MOUNT_VALUES + mount.isolator.n_states
    n_states = sum(isolator.n_states for isolator in isolators.values())
    # What pushes back on the world, or on a base whose only freedom is the drive, moves nothing.
    still = {0, on.base} if on.base and model.body_dofnum[on.base] == len(on.driven) else {0}
    mounts, modelled, inverse = np.zeros((len(declared), at.MOUNT_COLUMNS)), np.empty(4), np.empty(4)
    bodies, roots = model.site_bodyid, model.body_rootid
    shapes = {}  # at each site of flexible parts
    for site, modes in on.shapes.items():
        shapes[site] = [float(len(modes))]
        for dof, shape in modes:
            shapes[site] += [dof, float(model.jnt_qposadr[model.dof_jntid[dof]]), *shape]
    for row, mount in zip(mounts, declared, strict=True):
        both = [mount.payload_site, mount.base_site]
        mujoco.mju_negQuat(inverse, data.site_xquat[mount.base_site])
        mujoco.mju_mulQuat(modelled, inverse, data.site_xquat[mount.payload_site])
        row[: at.MOVED] = *both, *bodies[both], *roots[bodies[both]]
        row[at.MOVED], row[at.MODELLED : at.PARTNER] = model.body_weldid[bodies[mount.base_site]] not in still, modelled
    rotates = bool(turning.any())
    inertia = (ROTATING_ARMATURE if rotates else DRIVE_ARMATURE) + model.body_subtreemass[on.base]
    parts = [
        mounts,
        np.zeros((3 * len(declared), at.AXIS_COLUMNS)),
        [[model.jnt_dofadr[joint], inertia, *row, *turn] for joint, row, turn in zip(on.driven, drive, turning, strict=True)],
        [[body, roots[body]] for body in on.bodies],
        [
            [site, bodies[site], roots[bodies[site]], on.base, *(data.site_xpos[site] - data.xipos[on.base]), 0]
            for site in on.points
        ],
        list(zip(model.body_parentid, model.body_dofadr, model.body_dofnum, strict=True)),
        channels,
        [[site, bodies[site], 0] for site in on.forces],
        declared_pairs(model),
        [[mode.dof, *mode.participation] for mode in on.modes],
        [number for rows in shapes.values() for number in rows],
        np.zeros((n_stops, at.STOP_COLUMNS)),
        data.xquat[on.base] if rotates else [],
    ]
    flat = [np.array(part, dtype=np.float64).ravel() for part in parts]
    starts = at.HEADER + np.concatenate([[0], np.cumsum([part.size for part in flat])]).astype(int)
    header = np.zeros(at.HEADER)
    counts = (len(declared), len(on.driven), len(on.bodies), len(on.points), model.nbody, n_states, len(channels))
    header[: len(counts)] = counts
    header[at.MOUNTS : at.CHANNELS + 1], header[at.N_MODES] = starts[:7], len(on.modes)
    header[at.FORCES], header[at.PAIRS], header[at.MODES], first, header[at.STOPS] = starts[7:12]
    header[at.BASE_MODELLED] = starts[12] if rotates else 0
    places = dict(zip(shapes, first + np.cumsum([0, *map(len, shapes.values())]), strict=False))
    ends = [[mount.payload_site, mount.base_site] for mount in declared]
    flat[0].reshape(-1, at.MOUNT_COLUMNS)[:, at.SHAPES :] = [[places.get(site, 0) for site in pair] for pair in ends]
    for part, columns, sites in ((4, at.POINT_COLUMNS, on.points), (7, at.FORCE_COLUMNS, on.forces)):
        flat[part].reshape(-1, columns)[:, -1] = [places.get(site, 0) for site in sites]
    header[at.N_FORCES], header[at.N_PAIRS], header[at.SENSOR] = len(on.forces), len(declared_pairs(model)), sensor
    header[at.N_CONTACTS] = n_contacts = contact_capacity(model)
    user = at.UserData(
        n_mounts=len(declared), n_states=n_states, n_tree=int(model.nbody), n_channels=len(channels),
        n_contacts=n_contacts, n_stops=n_stops, n_forces=len(on.forces), rotates=rotates,
    )  # fmt: skip
    addresses = user.mounts, user.rates, user.accelerations, user.channels, user.contacts, user.stops
    header[at.USER_MOUNTS : at.USER_STOPS + 1] = addresses
    header[at.USER_FORCES], header[at.USER_TRAVELS], header[at.USER_CLOSINGS] = user.forces, user.travels, user.closings
    header[at.USER_TURNS] = user.turns if rotates else 0
    base_channels: tuple[int, ...] = ()
    if on.base:
        fixed = [i for i, body in enumerate(on.bodies) if model.body_weldid[body] == on.base]
        rigid = [(i, site) for i, site in enumerate(on.points) if site not in on.shapes]
        fixed += [len(on.bodies) + 2 * i for i, site in rigid if model.body_weldid[model.site_bodyid[site]] == on.base]
        base_channels = tuple(fixed)
    tables = Tables(
        layout=np.concatenate([header, *flat]), parameters=np.zeros(0), user=user, drive=drive, turning=turning,
        channels=np.array(channels, dtype=np.int64), base_channels=base_channels,
        tracked=np.setdiff1d(np.arange(len(channels)), () if rotates else base_channels), states={},
    )  # fmt: skip
    return with_laws(tables, isolators)


def with_laws(tables: Tables, isolators: Mapping[str, Isolator]) -> Tables:
    """Return tables with other laws of all mounts, in their order, with as many states; all else is unchanged."""
    acting = {mount: isolator.conditioned for mount, isolator in isolators.items()}
    axes: list[list[int]] = []
    parameters: list[Array] = []
    states: dict[str, tuple[slice, slice, slice]] = {}
    n_states = n_parameters = 0
    for mount, isolator in acting.items():
        slices, coupled = [], isolator.coupled
        together = isolator.coupled_axes if coupled is not None and coupled.brackets is not None else ()
        for axis, law in enumerate(isolator.axes.values()):
            size = law.n_states if law is not None else 0
            slices.append(slice(n_states, n_states + size))
            number = WITH_ANOTHER if axis in together else law.kernel if law is not None else -1
            axes.append([number, n_parameters, n_states, size])
            if law is not None:
                parameters.append(law.kernel_parameters())
                n_parameters += parameters[-1].size
            n_states += size
        states[mount] = (slices[0], slices[1], slices[2])
    rewritten = replace(tables, layout=tables.layout.copy(), states=states)
    for row, isolator in zip(rewritten.rows(at.MOUNTS, at.MOUNT_COLUMNS, len(acting)), acting.values(), strict=True):
        row[at.COUPLING] = -1
        if isolator.coupled is not None:
            row[at.COUPLING] = n_parameters
            parameters.append(isolator.coupled.mount_parameters())
            n_parameters += parameters[-1].size
        row[at.TURNING : at.MODELLED], row[at.PARTNER] = rotational_stiffness(isolator), max(isolator.coupled_axes, default=0)
        row[at.TRAVEL : at.SHAPES] = rated_travel(isolator)
    rewritten.rows(at.AXES, at.AXIS_COLUMNS, len(axes))[:] = axes
    rewritten.layout[at.N_SLIPPING] = sum(kernel in (MASING, PARALLEL) for kernel, *_ in axes)
    par = np.concatenate([*parameters, []])
    stops = []
    for number, (kernel, first, state, _) in enumerate(axes):
        parallel = par[first + 1 :][: 3 * int(par[first])].reshape(-1, 3) if kernel == PARALLEL else ()
        for kind, p, z in [(STOP, 0, 0)] if kernel == STOP else parallel:
            if kind == STOP:
                p = first + int(p)
                stops.append([*divmod(number, 3), p, state + z if par[p + LOSS] != 0.0 else -1])
    rewritten.layout[at.N_STOPS], room = len(stops), tables.user.n_stops  # `changed` refuses more of them
    rewritten.rows(at.STOPS, at.STOP_COLUMNS, room)[: len(stops)] = np.reshape(stops[:room], (-1, at.STOP_COLUMNS))
    return replace(rewritten, parameters=par)


def rotational_stiffness(isolator: Isolator) -> tuple[float, float, float]:
    """Return the rotational stiffness of an isolator about roll, shear and axial [N m/rad]."""
    rotation = isolator.rotation
    return (0.0, 0.0, 0.0) if rotation is None else (rotation.roll, rotation.shear, rotation.axial)


def rated_travel(isolator: Isolator) -> list[float]:
    """Return 1 / rated travel^2 along roll, shear, in compression and in tension [1/m^2]; 0 where none is rated."""
    stated = isolator.limits.travel.stated
    ratings = ("roll", "shear", "compression", "tension")
    # a number, for any length
    return [(1.0 / max(stated[rating], 1e-100)) ** 2 if rating in stated else 0.0 for rating in ratings]
