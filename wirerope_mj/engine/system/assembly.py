"""From MJCF and isolators to the compiled model: driven base, state actuator, sensors, the callback's tables, scratch data."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.response.peaks import ContactPeak
from wirerope_mj.engine.system.declared import DeclaredMount
from wirerope_mj.engine.system.equalities import check_base_is_free, stiffen
from wirerope_mj.engine.system.modal import declared_modes
from wirerope_mj.engine.system.tables import (
    DRIVE_ARMATURE,
    ROTATING_ARMATURE,
    TURNS,
    Subjects,
    Tables,
    declared_contacts,
    declared_pairs,
    make_tables,
)
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ModelError

# the drive's inertia enters MuJoCo's termination scale: with the default 1e-8 contacts stop iterating too early
SOLVER_TOLERANCE = 1e-15
POINT, FORCE = "point/", "force/"
AXIS_ERROR = 1e-9  # by which a component of a hinge's axis may differ from that of the world's: rounding of numbers as written


class Scratch:
    """MuJoCo data to borrow for models of one layout, a system and its variants; several threads may borrow at once."""

    def __init__(self) -> None:
        self._free: list[mujoco.MjData] = []

    @contextmanager
    def data(self, model: mujoco.MjModel) -> Iterator[mujoco.MjData]:
        """Lend data in the model's initial state, as from `MjData(model)`; nothing is computed yet."""
        try:
            data = self._free.pop()
        except IndexError:
            data = mujoco.MjData(model)
        else:
            mujoco.mj_resetData(model, data)
        yield data
        self._free.append(data)  # not after an error, whatever that left

    def __reduce__(self) -> tuple[type["Scratch"], tuple[()]]:
        """Pickle without the data: a copy lends its own."""
        return Scratch, ()


@dataclass(frozen=True, kw_only=True)
class Assembly:
    """The compiled model and where its parts stand."""

    model: mujoco.MjModel
    tables: Tables  # what the callback reads
    subjects: Subjects  # what takes part
    userdata: int  # first entry of the system's userdata
    activation: int  # first internal state in act
    sensor: int  # first of the system's sensor values
    contacts: dict[str, ContactPeak]  # the model's declared pairs of geoms by name, as contacts that have not touched
    # data to compute with, shared by all variants of a system
    scratch: Scratch = field(default_factory=Scratch, repr=False, compare=False)

    def user(self, userdata: Array) -> Array:
        """Return the system's part of userdata, (..., n_userdata), a view."""
        return userdata[..., self.userdata : self.userdata + self.tables.user.size]

    @property
    def driven_dofs(self) -> list[int]:
        return [int(self.model.jnt_dofadr[joint]) for joint in self.subjects.driven]


def assemble(spec: mujoco.MjSpec, declared: list[DeclaredMount], base: int) -> Assembly:
    """Add the callback's tables and actuator to `spec` in place, and compile it; `base` is a body id, 0 for the world."""
    for element in spec.bodies:
        if not element.name:  # each has one, so that it can be observed and drawn
            element.name = f"body_{element.id}"
    plain = spec.compile()
    modes = declared_modes(plain)
    modal = {mode.body for mode in modes}  # no bodies that anything of is seen
    bodies = tuple(body for body in range(1, plain.nbody) if plain.body_weldid[body] != 0 and body not in modal)
    points = tuple(site for site in range(plain.nsite) if POINT in plain.site(site).name)
    forces = tuple(site for site in range(plain.nsite) if FORCE in plain.site(site).name)
    for site in forces:
        if plain.body_weldid[plain.site_bodyid[site]] in (0, base):
            raise ModelError(
                f"site {plain.site(site).name!r}: a force acts on what the mounts carry, and this site is fixed to the base or "
                "the world."
            )
    slide, base_joints = mujoco.mjtJoint.mjJNT_SLIDE, np.flatnonzero(plain.jnt_bodyid == base).tolist() if base else []
    hinges = [joint for joint in base_joints if plain.joint(joint).name.endswith(TURNS)]
    if hinges:
        _check_hinges(plain, base, base_joints)
    driven = tuple(joint for joint in base_joints if plain.jnt_type[joint] == slide or joint in hinges)
    for joint in spec.joints:
        if joint.id in driven:  # a drive: huge inertia, no friction and no limits of its own
            joint.armature, joint.frictionloss = ROTATING_ARMATURE if hinges else DRIVE_ARMATURE, 0.0
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
    subjects = Subjects(
        base=base, driven=driven, bodies=bodies, points=points,
        body_names=tuple(plain.body(body).name for body in bodies),
        point_names=tuple(plain.site(site).name.replace(POINT, "", 1) for site in points), forces=forces,
        force_names=tuple(plain.site(site).name.replace(FORCE, "", 1) for site in forces), modes=modes,
    )  # fmt: skip
    # Whatever is added stands after what the model has, so that all addresses are known before it is compiled.
    tables = make_tables(plain, mujoco.MjData(plain), declared, subjects, sensor=int(plain.nsensordata))
    userdata = int(plain.nuserdata)
    tolerance = SOLVER_TOLERANCE * (DRIVE_ARMATURE / ROTATING_ARMATURE if hinges else 1.0)
    spec.option.integrator, spec.option.tolerance = mujoco.mjtIntegrator.mjINT_RK4, tolerance
    # The state at a warning must survive for the message, and the sensor callback is the observer.
    disable = mujoco.mjtDisableBit
    spec.option.disableflags |= disable.mjDSBL_AUTORESET
    spec.option.disableflags &= ~(disable.mjDSBL_SENSOR | disable.mjDSBL_ACTUATION | disable.mjDSBL_SPRING)
    stiffen(spec)
    spec.nuserdata = userdata + tables.user.size
    spec.add_numeric(name=at.LAYOUT, size=tables.layout.size, data=tables.layout.tolist())
    parameters = [*tables.parameters.tolist(), 0.0]  # never empty
    spec.add_numeric(name=at.PARAMETERS, size=len(parameters), data=parameters)
    # The internal states are activations of an actuator; any joint carries it, a slide is the cheapest.
    first = int(plain.nnumericdata)
    addresses = [first, first + tables.layout.size, userdata, int(plain.na)]
    if plain.njnt == 0:
        raise ModelError("the model has no joint: nothing in it can move.")
    carrier = int(np.argmax(plain.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE))
    joint = next(element for element in spec.joints if element.id == carrier)
    if not joint.name:
        joint.name = "wirerope/carrier"
    n_states = tables.user.n_states
    spec.add_actuator(
        name=at.STATE_ACTUATOR, dyntype=mujoco.mjtDyn.mjDYN_USER if n_states else mujoco.mjtDyn.mjDYN_NONE,
        actdim=n_states if n_states else -1, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=joint.name, gainprm=[0.0] * 10,
        biasprm=[0.0] * 10, dynprm=[at.MAGIC, *map(float, addresses), 0.0, 0.0, 0.0, 0.0, 0.0],
    )  # fmt: skip
    sizes = {f"body/{name}": at.KINEMATICS for name in subjects.body_names}
    sizes |= {plain.site(site).name: at.POINT_VALUES for site in points}
    sizes |= {f"mount/{mount.name}": at.MOUNT_VALUES + mount.isolator.n_states for mount in declared}
    sizes |= {f"contact/{pair}": 1 for pair in range(len(declared_pairs(plain)))}
    for name, size in sizes.items():
        spec.add_sensor(
            name=name, type=mujoco.mjtSensor.mjSENS_USER, dim=size, needstage=mujoco.mjtStage.mjSTAGE_ACC,
            datatype=mujoco.mjtDataType.mjDATATYPE_REAL,
        )  # fmt: skip
    model = spec.compile()
    if model.neq and driven:
        check_base_is_free(model, model.body(base).name, [int(model.jnt_dofadr[joint]) for joint in driven])
    return Assembly(
        model=model, tables=tables, subjects=subjects, userdata=userdata, activation=int(plain.na),
        sensor=int(plain.nsensordata), contacts=declared_contacts(model, base),
    )  # fmt: skip


def _check_hinges(model: mujoco.MjModel, base: int, joints: list[int]) -> None:
    """Raise ModelError unless the base has three slides, then hinges of yaw, pitch and roll at its origin, and no others."""
    data, kinds = mujoco.MjData(model), mujoco.mjtJoint
    mujoco.mj_kinematics(model, data)
    wanted = [kinds.mjJNT_SLIDE] * 3 + [kinds.mjJNT_HINGE] * 3
    fits = [model.jnt_type[joint] for joint in joints] == wanted
    for joint, name, axis in zip(joints[3:], reversed(TURNS), np.eye(3)[::-1], strict=False):
        fits = fits and model.joint(joint).name.endswith(name) and not model.jnt_pos[joint].any()
        fits = fits and bool(np.abs(data.xaxis[joint] - axis).max() < AXIS_ERROR)
    if not fits or any(mode.owner == base for mode in declared_modes(model)):
        raise ModelError(
            f"the base {model.body(base).name!r} rotates by three slides and, behind them, the hinges base/yaw, base/pitch and "
            "base/roll about the world's z, y and x axes at its own origin, has no other joints and does not bend; it has "
            f"{[model.joint(joint).name for joint in joints]}. `wirerope_mj.with_rotation(system)` writes them."
        )
