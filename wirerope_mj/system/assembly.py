"""From MJCF and isolators to the compiled model: state actuator, sensors, driven base, and the tables of the callback."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from wirerope_mj.control import layout as at
from wirerope_mj.errors import ModelError
from wirerope_mj.system.declared import DeclaredMount

DRIVE_ARMATURE = 1e10
"""Inertia of a driven slide [kg]: what pushes back on the base, say 1 MN, changes its acceleration by 1e-4 m/s^2."""

SOLVER_TOLERANCE = 1e-15
"""The drive's inertia enters MuJoCo's termination scale: with the default 1e-8 contacts stop iterating too early."""

POINT = "point/"


@dataclass(frozen=True, kw_only=True)
class Assembly:
    """The compiled model and where its parts stand."""

    model: mujoco.MjModel
    user: at.UserData
    userdata: int  # first entry of the system's userdata
    activation: int  # first internal state in act
    sensor: int  # first of the system's sensor values
    bodies: tuple[int, ...]
    points: tuple[int, ...]
    driven_dofs: tuple[int, ...]
    drive: npt.NDArray[np.float64]  # slide accelerations from base acceleration, (n_driven, 3)
    channels: npt.NDArray[np.int64]  # places of the tracked 3-vectors among the system's sensor values, (n_channels,)
    state_offsets: dict[str, tuple[slice, slice, slice]]  # per mount: states of roll, shear, axial among the internal states


def name_moving_bodies(spec: mujoco.MjSpec, model: mujoco.MjModel) -> None:
    """Give every moving body without a name one, so that it can be observed and drawn."""
    for body, element in enumerate(spec.bodies):
        if not element.name and model.body_weldid[body] != 0:
            element.name = f"body_{body}"


def assemble(spec: mujoco.MjSpec, declared: list[DeclaredMount], base: int) -> Assembly:
    """Add what the callback needs to `spec` and compile it.

    Args:
        spec: parsed MJCF; changed in place.
        declared: mounts, with the site ids of the MJCF as it stands.
        base: body id of the base, 0 if it is the world.
    """
    plain = spec.compile()
    name_moving_bodies(spec, plain)
    plain = spec.compile()
    driven = _driven_joints(spec, plain, base)
    _set_options(spec)
    bodies = tuple(body for body in range(1, plain.nbody) if plain.body_weldid[body] != 0)
    points = tuple(site for site in range(plain.nsite) if POINT in plain.site(site).name)
    axes = [(mount, law) for mount in declared for law in mount.isolator.axes.values()]
    n_states = sum(law.n_states for _, law in axes if law is not None)
    n_channels = len(bodies) + 2 * len(points) + 2 * len(declared)
    user = at.UserData(
        n_mounts=len(declared), n_states=n_states, n_tree=plain.nbody, n_channels=n_channels
    )
    _add_sensors(spec, plain, declared, bodies, points)
    userdata = spec.nuserdata if spec.nuserdata > 0 else 0
    spec.nuserdata = userdata + user.size
    n_parameters = sum(law.kernel_parameters().size for _, law in axes if law is not None)
    n_layout = (
        at.HEADER
        + at.MOUNT_COLUMNS * len(declared)
        + 3 * at.AXIS_COLUMNS * len(declared)
        + at.DRIVEN_COLUMNS * len(driven)
        + at.BODY_COLUMNS * len(bodies)
        + at.POINT_COLUMNS * len(points)
        + at.TREE_COLUMNS * plain.nbody
        + at.CHANNEL_COLUMNS * n_channels
    )
    spec.add_numeric(name=at.LAYOUT, size=n_layout, data=[0.0])
    spec.add_numeric(name=at.PARAMETERS, size=max(n_parameters, 1), data=[0.0])
    _add_state_actuator(spec, plain, n_states)
    model = spec.compile()
    activation = int(model.actuator_actadr[-1])
    sensor = int(model.sensor_adr[model.sensor(f"body/{model.body(bodies[0]).name}").id])
    first = [int(model.numeric_adr[model.numeric(name).id]) for name in (at.LAYOUT, at.PARAMETERS)]
    model.actuator_dynprm[-1, :5] = at.MAGIC, *first, userdata, activation
    drive = _drive_rows(model, driven)
    table, parameters, offsets = _tables(model, declared, base, driven, drive, bodies, points, sensor)
    assert table.size == n_layout and parameters.size == n_parameters
    model.numeric_data[first[0] : first[0] + n_layout] = table
    model.numeric_data[first[1] : first[1] + n_parameters] = parameters
    return Assembly(
        model=model,
        user=user,
        userdata=userdata,
        activation=activation,
        sensor=sensor,
        bodies=bodies,
        points=points,
        driven_dofs=tuple(int(model.jnt_dofadr[joint]) for joint in driven),
        drive=drive,
        channels=table[int(table[at.CHANNELS]) :].astype(np.int64),
        state_offsets=offsets,
    )


def _driven_joints(spec: mujoco.MjSpec, model: mujoco.MjModel, base: int) -> list[int]:
    """Return the ids of the base's slides, made into a drive: huge inertia, no spring, damper or friction of their own."""
    if base == 0:
        return []
    first = int(model.body_jntadr[base])
    joints = [
        joint
        for joint in range(first, first + int(model.body_jntnum[base]))
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE
    ]
    elements = spec.joints
    for joint in joints:
        elements[joint].armature = DRIVE_ARMATURE
        elements[joint].frictionloss = 0.0
        elements[joint].limited = mujoco.mjtLimited.mjLIMITED_FALSE
    return joints


def _set_options(spec: mujoco.MjSpec) -> None:
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.tolerance = SOLVER_TOLERANCE
    # The state at a warning must survive for the message, and the sensor callback is the observer.
    disable = mujoco.mjtDisableBit
    spec.option.disableflags |= disable.mjDSBL_AUTORESET
    spec.option.disableflags &= ~(disable.mjDSBL_SENSOR | disable.mjDSBL_ACTUATION | disable.mjDSBL_SPRING)


def _add_sensors(
    spec: mujoco.MjSpec,
    model: mujoco.MjModel,
    declared: list[DeclaredMount],
    bodies: tuple[int, ...],
    points: tuple[int, ...],
) -> None:
    def add(name: str, size: int) -> None:
        spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_USER,
            dim=size,
            needstage=mujoco.mjtStage.mjSTAGE_ACC,
            datatype=mujoco.mjtDataType.mjDATATYPE_REAL,
        )

    for body in bodies:
        add(f"body/{model.body(body).name}", at.KINEMATICS)
    for site in points:
        add(model.site(site).name, at.POINT_VALUES)
    for mount in declared:
        n_states = sum(law.n_states for law in mount.isolator.axes.values() if law is not None)
        add(f"mount/{mount.name}", at.MOUNT_VALUES + n_states)


def _add_state_actuator(spec: mujoco.MjSpec, model: mujoco.MjModel, n_states: int) -> None:
    """Add the actuator whose activations are the internal states; any joint carries it, a slide is the cheapest."""
    if model.njnt == 0:
        raise ModelError("the model has no joint: nothing in it can move.")
    carrier = int(np.argmax(model.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE))
    joint = spec.joints[carrier]
    if not joint.name:
        joint.name = "wirerope/carrier"
    spec.add_actuator(
        name=at.STATE_ACTUATOR,
        dyntype=mujoco.mjtDyn.mjDYN_USER if n_states else mujoco.mjtDyn.mjDYN_NONE,
        actdim=n_states if n_states else -1,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        target=joint.name,
        gainprm=[0.0] * 10,
        biasprm=[0.0] * 10,
    )


def _drive_rows(model: mujoco.MjModel, driven: list[int]) -> npt.NDArray[np.float64]:
    """Return the map from base acceleration (3,) to slide accelerations, (n_driven, 3)."""
    if not driven:
        return np.zeros((0, 3))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    axes = data.xaxis[driven]  # (n_driven, 3)
    if np.linalg.matrix_rank(axes, tol=1e-9) < len(driven):
        names = [model.joint(joint).name for joint in driven]
        raise ModelError(f"the slides {names} of the base do not have independent directions.")
    return np.linalg.pinv(axes).T


def _tables(
    model: mujoco.MjModel,
    declared: list[DeclaredMount],
    base: int,
    driven: list[int],
    drive: npt.NDArray[np.float64],
    bodies: tuple[int, ...],
    points: tuple[int, ...],
    sensor: int,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], dict[str, tuple[slice, slice, slice]]]:
    """Return layout, law parameters, and the places of every mount's internal states."""
    # A base whose only freedom is the drive is not moved by what pushes back on it.
    prescribed = base and model.body_dofnum[base] == len(driven)
    mounts, axes, parameters, channels = [], [], [], []
    offsets: dict[str, tuple[slice, slice, slice]] = {}
    n_states = n_parameters = 0
    place = at.KINEMATICS * len(bodies) + at.POINT_VALUES * len(points)
    for mount in declared:
        sites = (mount.payload_site, mount.base_site)
        on = [int(model.site_bodyid[site]) for site in sites]
        reacts = not (prescribed and model.body_weldid[on[1]] == base) and model.body_weldid[on[1]] != 0
        mounts.append([*sites, *on, *(model.body_rootid[body] for body in on), float(reacts)])
        first, slices = n_states, []
        for law in mount.isolator.axes.values():
            if law is None:
                axes.append([-1, 0, 0, 0])
                slices.append(slice(n_states, n_states))
                continue
            axes.append([law.kernel, n_parameters, n_states, law.n_states])
            slices.append(slice(n_states, n_states + law.n_states))
            parameters.append(law.kernel_parameters())
            n_parameters, n_states = n_parameters + parameters[-1].size, n_states + law.n_states
        offsets[mount.name] = (slices[0], slices[1], slices[2])
        channels += [place, place + 3]
        place += at.MOUNT_VALUES + n_states - first
    body_channels = [at.KINEMATICS * i + at.ACCELERATION for i in range(len(bodies))]
    first = at.KINEMATICS * len(bodies)
    point_channels = [
        first + at.POINT_VALUES * i + part for i in range(len(points)) for part in (at.ACCELERATION, at.RELATIVE)
    ]
    mass = [driven_mass(model, joint) for joint in driven]
    parts = [
        mounts,
        axes,
        [[model.jnt_dofadr[joint], m, *row] for joint, m, row in zip(driven, mass, drive, strict=True)],
        [[body, model.body_rootid[body]] for body in bodies],
        _point_rows(model, points, base),
        list(zip(model.body_parentid, model.body_dofadr, model.body_dofnum, strict=True)),
        [[channel] for channel in body_channels + point_channels + channels],
    ]
    flat = [np.array(part, dtype=np.float64).ravel() for part in parts]
    starts = at.HEADER + np.concatenate([[0], np.cumsum([part.size for part in flat])])
    header = np.zeros(at.HEADER)
    counts = [len(declared), len(driven), len(bodies), len(points), model.nbody, n_states, len(parts[6])]
    header[: len(counts)] = counts
    header[at.MOUNTS : at.CHANNELS + 1] = starts[:7]
    header[at.SENSOR] = sensor
    return np.concatenate([header, *flat]), np.concatenate([*parameters, []]), offsets


def _point_rows(model: mujoco.MjModel, points: tuple[int, ...], base: int) -> list[list[float]]:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    bodies = model.site_bodyid
    return [
        [site, bodies[site], model.body_rootid[bodies[site]], base, *(data.site_xpos[site] - data.xipos[base])]
        for site in points
    ]


def driven_mass(model: mujoco.MjModel, joint: int) -> float:
    """Return the inertia [kg] that a driven slide moves: its armature and all it carries."""
    return float(model.dof_armature[model.jnt_dofadr[joint]] + model.body_subtreemass[model.jnt_bodyid[joint]])
