"""Stepping a system by MuJoCo: its start state, preparation of every segment, and what MuJoCo's warnings mean."""

import copy
import math

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.install import STATE, state_of
from wirerope_mj.engine.simulation.grid import SAME_TIME, Grid
from wirerope_mj.engine.simulation.stages import Drive, Segment, along_slides, drive_of, loads_at
from wirerope_mj.engine.statics import History, equilibrium
from wirerope_mj.engine.system import System, beyond_laws
from wirerope_mj.engine.system.on_deck import GRAVITY_ERROR, has_deck
from wirerope_mj.foundation.arrays import AnyArray, Array, Integers
from wirerope_mj.foundation.directions import direction_text
from wirerope_mj.foundation.errors import ModelError, SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import falling_text

_NEAR = 0.8  # fraction of a law's finite travel from which on a step that fails is put down to it
_FARTHEST = 1.0  # m: where a motion has grown without bound it went through every smaller deflection
_GREW = "the motion grew without bound; use a smaller `timestep`, and check masses, stops and mount loads"
_GREW_FALLING = (
    "the motion grew without bound because the force of a mount falls as its deflection grows: no timestep mends that; take a "
    "law that holds there, or test larger amplitudes"
)
_GREW_BUCKLED = (
    "the motion grew without bound because a mount buckled on its bracket: no timestep mends that; take a stiffer bracket, a "
    "larger mount, or a stop before its loops are pressed so far"
)
_GROWING = ("mjWARN_BADQACC", "mjWARN_BADQPOS", "mjWARN_BADQVEL")

_REMEDIES = {
    "mjWARN_BADCTRL": "a control is not finite or above 1e10; check what writes `ctrl`",
    "mjWARN_CNSTRFULL": "there are more contacts than memory; raise <size memory=...> in the model",
    "mjWARN_CONTACTFULL": "there are more contacts than memory; raise <size memory=...> in the model",
    "mjWARN_INERTIA": "a mass or inertia is close to zero; check the model's masses",
}

# relative difference of base positions and velocities that is integration error and not another motion
SAME_MOTION = 1e-6
HISTORIES: dict[str, History] = {"settled": "virgin", "relaxed": "relaxed"}


class Stepper:
    """A copy of a system's model and its data, stepped by MuJoCo through the segments of a time grid."""

    def __init__(self, system: System, motion: BaseMotion, initial: State) -> None:
        self.system, self.motion, self._grid = system, motion, Grid.empty()
        self.model, self.data = copy.copy(system.model), mujoco.MjData(system.model)
        mujoco.mj_setState(self.model, self.data, initial.values, STATE)
        assembly = system.assembly
        self.user = assembly.user(self.data.userdata)
        self.user[at.OBSERVING], self.user[at.HISTORY], self.user[at.EVENT] = 1.0, 0.0, at.SMOOTH
        self._dofs = side_by_side(np.array(assembly.driven_dofs, dtype=int))
        self._slides = side_by_side(self.model.jnt_qposadr[list(assembly.subjects.driven)])
        self._origin = self.model.qpos0[self._slides].copy()
        self._since_check: list[Segment] = []
        self._checked = state_of(self.model, self.data).values

    def enter(self, grid: Grid) -> None:
        """Check the steps so far, and go over to the next block of the time grid."""
        self.check()  # a second look at earlier segments needs the grid that they belong to
        self._grid = grid

    def begin(self, base: Segment) -> None:
        """Prepare the steps of a segment: set the base to its motion, velocity jumps included."""
        self._since_check.append(base)
        grid, user, segment, accelerations = self._grid, self.user, base.number, base.accelerations
        start, length = grid.start[segment], grid.stop[segment] - grid.start[segment]
        if grid.event[segment] == at.JUMP:
            rates = self.motion._angles(np.array([start - SAME_TIME, start]), 1)
            jump = velocity_jump(self.motion, float(start))
            keep_momentum(self.system, self.model, self.data, jump, rates[1] - rates[0])
        self._place_base(base.positions, base.rates)
        user[at.EVENT] = grid.event[segment]
        user[at.STAGE_POINTS], user[at.STAGE_START] = accelerations.shape[0], start
        user[at.STAGE_RATE] = 2.0 * grid.steps[segment] / length
        user[at.STAGES : at.STAGES + accelerations.size] = accelerations.ravel()
        self._set_turns(base.turns)
        self._set_loads(base.forces)
        self.data.time = start  # so that rounding does not add up over the steps
        self.model.opt.timestep = length / grid.steps[segment]

    def finish(self) -> State:
        """Return the final state, and observe the last instant with the acceleration just before it."""
        self.check()
        model, data, user = self.model, self.data, self.user
        if self._grid.stop.size:
            data.time = self._grid.stop[-1]
            self._place_base(*base_before(self.motion, drive_of(self.system), float(data.time)))
        # A state does not carry what belongs to this run alone: stage table and tracker.
        kept = user.copy()
        user[:] = 0.0
        final = state_of(model, data)
        user[:] = kept
        user[at.STAGE_POINTS], user[at.STAGE_START], user[at.STAGE_RATE] = 1.0, data.time, 0.0
        user[at.STAGES : at.STAGES + 3] = acceleration_before(self.motion, float(data.time))
        self._set_turns(turning_before(self.motion, drive_of(self.system), float(data.time)))
        sites = self.system.assembly.subjects.force_names if self.motion.loaded_sites else ()
        self._set_loads(loads_at(self.motion, sites, np.array([float(data.time)])))
        mujoco.mj_forward(model, data)
        return final

    def return_to(self, state: State) -> None:
        """Restore a state that `state_of` returned between two segments, also after a failure."""
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, state.values, STATE)
        self._since_check.clear()
        self._checked = state.values

    def _set_loads(self, forces: Array) -> None:
        if forces.size:
            first = self.system.assembly.tables.user.forces
            self.user[first : first + forces.size] = forces.ravel()

    def _set_turns(self, turns: Array) -> None:
        first = self.system.assembly.tables.user.turns
        self.user[first : first + turns.size] = turns.ravel()

    def _place_base(self, positions: Array, rates: Array) -> None:
        self.data.qpos[self._slides] = self._origin + positions
        self.data.qvel[self._dofs] = rates

    def check(self) -> None:
        """Raise SimulationError if one of MuJoCo's warning counters rose since the last check."""
        if not self.data.warning.number.any():
            self._since_check.clear()
            self._checked = state_of(self.model, self.data).values
            return
        segments = self._since_check.copy()
        # Once a number is not finite all are: only a second look, step by step, shows where it began.
        self.return_to(State(values=self._checked, time=0.0))
        earlier = deflections = np.zeros((len(self.system.mounts), 3))
        states = self.data.act.copy()
        for segment in segments:
            self.begin(segment)
            for _ in range(int(self._grid.steps[segment.number])):
                last = self.system.assembly.tables.user.mount_rows(self.user)[:, 0]  # of the last pass
                if np.isfinite(last).all():
                    earlier, deflections, states = deflections, last.copy(), self.data.act.copy()
                mujoco.mj_step(self.model, self.data)
                for kind, warning in enumerate(self.data.warning):
                    if warning.number:
                        buckled = self._describe_buckling(deflections, deflections - earlier, states)
                        falling = buckled or self._describe_falling_force(deflections)
                        name, remedy = mujoco.mjtWarning(kind).name, "see MuJoCo's documentation of this warning"
                        if name in _GROWING:
                            remedy = _GREW_BUCKLED if buckled else _GREW_FALLING if falling else _GREW
                        acceleration = np.nan_to_num(np.abs(self.data.qacc), nan=np.inf, posinf=np.inf)
                        body = self.model.body(self.model.dof_bodyid[int(np.argmax(acceleration))]).name
                        message = beyond_laws(self.system, deflections, fraction=_NEAR)
                        beyond = f" Mount {message[0]!r} stood {message[1]}." if message else ""
                        raise SimulationError(
                            f"at t = {self.data.time:.6g} s MuJoCo reported {name.removeprefix('mjWARN_')} for body {body!r}: "
                            f"{_REMEDIES.get(name, remedy)}.{falling or beyond}"
                        )
        raise SimulationError("MuJoCo reported a warning in the last forward pass; use a smaller `timestep`.")

    def _describe_buckling(self, deflections: Array, moved: Array, states: Array) -> str:
        """Describe the first mount that loses equilibrium with its bracket within two steps, "" if none does."""
        firsts = self.system.assembly.tables.rows(at.AXES, at.AXIS_COLUMNS, 3 * len(deflections))[:, 2].astype(int)
        for number, (name, mount) in enumerate(self.system.mounts.items()):
            law, axes = mount.isolator.coupled, list(mount.isolator.coupled_axes)
            if law is None or law.brackets is None:
                continue
            z = np.concatenate([states[first : first + len(law.scales)] for first in firsts[3 * number :][axes]])
            for ahead in np.linspace(0.0, 2.0, 9):
                if not np.isfinite(law.own_deflection((deflections + ahead * moved)[number, axes], z)).all():
                    along = [AXES[axis] for axis in axes]
                    x = " and ".join(
                        f"{1e3 * x:.4g} mm {axis}" for axis, x in zip(along, deflections[number, axes], strict=True)
                    )
                    soft = " and ".join(
                        f"{1e-6 * stiffness:.4g} kN/mm {axis}"
                        for axis, stiffness in zip(along, law.brackets, strict=True)
                        if stiffness < math.inf
                    )
                    return f" Mount {name!r} stood at {x}, on a bracket of {soft}."
        return ""

    def _describe_falling_force(self, deflections: Array) -> str:
        """Describe the first mount at a deflection where its force decreases, "" if there is none."""
        for (name, mount), row in zip(self.system.mounts.items(), deflections, strict=True):
            for (axis, law), x in zip(mount.isolator.axes.items(), map(float, row), strict=True):
                reach = min(max(x, -_FARTHEST), _FARTHEST) if math.isfinite(x) else 0.0
                if law is not None and (text := falling_text(law, min(reach, 0.0), max(reach, 0.0))):
                    return f" Mount {name!r} stood at {1e3 * x:.4g} mm on its {axis} axis, where {text}."
        return ""


def velocity_jump(motion: BaseMotion, time: float) -> Array:
    """Return the jump of the base's velocity at an instant [m/s], (3,); `motion.velocity` already contains it."""
    return sum((jump for instant, jump in motion.velocity_jumps if abs(instant - time) <= SAME_TIME), np.zeros(3))


def base_before(motion: BaseMotion, drive: Drive, time: float) -> tuple[Array, Array]:
    """Return the driven coordinates and rates just before an instant, without its velocity jump, (n_driven,) each."""
    now = np.array([time])
    rates = along_slides(drive.slides, motion.velocity(now) - velocity_jump(motion, time))
    if motion.rotates:
        rates = rates + along_slides(drive.hinges, motion._angles(now - SAME_TIME, 1))
    return drive.positions(motion, now)[0], rates[0]


def turning_before(motion: BaseMotion, drive: Drive, time: float) -> Array:
    """Return the second derivatives of roll, pitch and yaw just before an instant, (1, 3), or nothing, see `Drive.turns`."""
    return drive.turns(motion, np.array([max(time - SAME_TIME, 0.0)]))


def acceleration_before(motion: BaseMotion, time: float) -> Array:
    """Return the base acceleration just before an instant [m/s^2], (3,)."""
    return motion.acceleration(np.array([max(time - SAME_TIME, 0.0)]))[0]


def keep_momentum(system: System, model: mujoco.MjModel, data: mujoco.MjData, jump: Array, turn: Array) -> None:
    """Keep the momentum of bodies that are jointed to the base while the base's velocity jumps by `jump` [m/s], (3,).

    The rates of roll, pitch and yaw jump by `turn` [rad/s], (3,).

    No spring passes on an impulse: M_rr dv_r + M_rb dv_b = 0 for the riding coordinates r and the driven ones b, so that a
    slide between base and frame takes up the whole jump; a mode of a flexible part that of its participation.
    """
    driven = system.assembly.driven_dofs
    for mode in system.assembly.subjects.modes:
        data.qvel[mode.dof] -= mode.participation @ jump
    riding = riding_dofs(model, driven)
    if not riding.size:
        return
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_makeM(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    tables = system.assembly.tables
    impulse = mass[riding][:, driven] @ (tables.drive @ jump + tables.turning @ turn)
    data.qvel[riding] -= np.linalg.solve(mass[np.ix_(riding, riding)], impulse)


def side_by_side(indices: AnyArray) -> AnyArray | slice:
    """Convert consecutive indices to a slice, into which NumPy writes three times as fast."""
    first, n = int(indices[0]) if indices.size else 0, indices.size
    return slice(first, first + n) if np.array_equal(indices, np.arange(first, first + n)) else indices


def riding_dofs(model: mujoco.MjModel, driven: list[int]) -> Integers:
    """Return the velocity coordinates of bodies that are jointed to the driven base."""
    roots = model.body_rootid[model.dof_bodyid]
    rides = np.isin(roots, roots[driven])
    rides[driven] = False
    return np.flatnonzero(rides)


def initial_state(system: System, motion: BaseMotion, initial: str | State | None) -> State:
    """Return the start state: "settled", "relaxed", "unloaded", a given state, or None for the motion's own.

    The base stands and moves as the motion says just before the start; if the given state's base does not, the whole system
    is carried along (a Galilean change), so that nothing but the motion's own acceleration disturbs it. ModelError if the
    base falls otherwise than the model's gravity has it, or on a deck that bends.
    """
    if motion.up is not None and not falls_by_gravity(system, motion.up):
        up, gravity = (direction_text(tuple(vector.tolist())) for vector in (motion.up, system.model.opt.gravity))
        raise ModelError(
            f"the base falls with {up} upwards, and gravity of this model is {gravity} m/s^2: "
            "`wirerope_mj.with_gravity(system, up=..)` turns it."
        )
    if motion.up is not None and has_deck(system):
        raise ModelError("a case that falls stands on no deck: leave the deck that bends out.")
    initial = motion.initial if initial is None else initial
    if isinstance(initial, State):
        size = mujoco.mj_stateSize(system.model, STATE)
        user = system.assembly.tables.user
        # of versions that followed neither the speeds at which stops close nor travel along all axes
        for added in (user.size - user.closings, user.size - user.travels):
            if initial.values.shape == (size - added,):
                initial = State(values=np.append(initial.values, np.zeros(added)), time=initial.time)
        if initial.values.shape != (size,):
            raise ValueError(f"`initial` has {initial.values.size} values; a state of this system has {size}.")
        state = initial
    elif isinstance(initial, str) and initial in HISTORIES:
        state = equilibrium(system, history=HISTORIES[initial]).state
    elif initial == "unloaded":
        laws = {name: mount.isolator.conditioned.axes.values() for name, mount in system.mounts.items()}
        stops = ((name, stop) for name, axes in laws.items() for law in axes if law is not None for stop in law.stops)
        if pressed := next((name for name, stop in stops if min(stop.unloaded_gaps.values()) < 0.0), None):
            raise ModelError(
                f"stop {pressed!r} was installed under load and presses in the unloaded geometry, where `initial` 'unloaded' "
                "begins: begin 'settled', or state its gaps unloaded."
            )
        with system.assembly.scratch.data(system.model) as data:
            state = state_of(system.model, data)
    else:
        raise ValueError(f"`initial` must be 'settled', 'relaxed', 'unloaded' or a State, got {initial!r}.")
    return moving_with_base(system, motion, state)


def falls_by_gravity(system: System, up: Array) -> bool:
    """Tell whether a system's gravity is the standard one, opposite to the unit vector `up`."""
    return bool(np.allclose(system.model.opt.gravity, -STANDARD_GRAVITY * up, rtol=0.0, atol=GRAVITY_ERROR))


def moving_with_base(system: System, motion: BaseMotion, state: State) -> State:
    """Return `state` with the base moved to the motion at the state's instant, the whole system carried along."""
    assembly, model = system.assembly, system.model
    joints = list(assembly.subjects.driven)
    if not joints:
        return state
    drive = drive_of(system)
    positions, rates = base_before(motion, drive, state.time)  # the simulation itself applies a jump at its start
    dofs, addresses = model.jnt_dofadr[joints], model.jnt_qposadr[joints]
    qpos, qvel = np.empty(model.nq), np.empty(model.nv)
    mujoco.mj_extractState(model, state.values, STATE, qpos, mujoco.mjtState.mjSTATE_QPOS)
    mujoco.mj_extractState(model, state.values, STATE, qvel, mujoco.mjtState.mjSTATE_QVEL)
    q, v = qpos[addresses] - model.qpos0[addresses], qvel[dofs]
    dq, dv = positions - q, rates - v
    moved = np.abs(dq).max() > SAME_MOTION * max(np.abs(q).max(), 1e-3)
    moved |= np.abs(dv).max() > SAME_MOTION * max(np.abs(v).max(), 1e-3)
    if not moved:
        return state
    to_world = np.linalg.pinv(assembly.tables.drive)
    with assembly.scratch.data(model) as data:
        mujoco.mj_setState(model, data, state.values, STATE)
        if np.any(drive.hinges.T @ dq) or np.any(drive.hinges.T @ dv) or np.any(drive.hinges.T @ q):
            _turn(system, data, model.qpos0[addresses] + positions, rates)
        else:
            _carry(system, data, to_world @ dq, to_world @ dv)
        return State(values=state_of(model, data).values, time=state.time)


def _carry(system: System, data: mujoco.MjData, shift: Array, velocity: Array) -> None:
    """Add `shift` [m] and `velocity` [m/s] to every tree of bodies, as far as the joints at its root allow."""
    model = system.model
    modal = {mode.body for mode in system.assembly.subjects.modes}  # their coordinates are relative to the base
    mujoco.mj_kinematics(model, data)
    for body in set(range(1, model.nbody)) - modal:
        if model.body_parentid[body] != 0 or not model.body_jntnum[body]:
            continue
        first = int(model.body_jntadr[body])
        joints = np.arange(first, first + int(model.body_jntnum[body]))
        if model.jnt_type[first] == mujoco.mjtJoint.mjJNT_FREE:
            q, d = int(model.jnt_qposadr[first]), int(model.jnt_dofadr[first])
            data.qpos[q : q + 3] += shift
            data.qvel[d : d + 3] += velocity
            continue
        slides = joints[model.jnt_type[joints] == mujoco.mjtJoint.mjJNT_SLIDE]
        if slides.size:
            to_slides = np.linalg.pinv(data.xaxis[slides]).T
            data.qpos[model.jnt_qposadr[slides]] += to_slides @ shift
            data.qvel[model.jnt_dofadr[slides]] += to_slides @ velocity


def _turn(system: System, data: mujoco.MjData, positions: Array, rates: Array) -> None:
    """Set the base's slides and hinges to positions and rates, (n_driven,), and carry floating bodies along rigidly."""
    model, assembly = system.model, system.assembly

    def frame() -> tuple[Array, Array, Array, Array]:
        """Return the base's origin, axes, velocity and angular velocity."""
        for compute in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):
            compute(model, data)
        velocity, base = np.empty(6), assembly.subjects.base
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, base, velocity, 0)
        return data.xpos[base].copy(), data.xmat[base].reshape(3, 3).copy(), velocity[3:], velocity[:3]

    origin, axes, velocity, spin = frame()
    data.qpos[model.jnt_qposadr[list(assembly.subjects.driven)]], data.qvel[assembly.driven_dofs] = positions, rates
    new_origin, new_axes, new_velocity, new_spin = frame()
    turn, quaternion = new_axes @ axes.T, np.empty(4)
    mujoco.mju_mat2Quat(quaternion, turn.ravel())
    for joint in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE):
        q, d = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        body, arm = data.xmat[model.jnt_bodyid[joint]].reshape(3, 3), data.qpos[q : q + 3] - origin
        relative = data.qvel[d : d + 3] - velocity - np.cross(spin, arm)
        turning = body @ data.qvel[d + 3 : d + 6] - spin  # a floating body's angular velocity is in its own axes
        data.qpos[q : q + 3] = new_origin + turn @ arm
        mujoco.mju_mulQuat(data.qpos[q + 3 : q + 7], quaternion, data.qpos[q + 3 : q + 7].copy())
        data.qvel[d : d + 3] = new_velocity + np.cross(new_spin, turn @ arm) + turn @ relative
        data.qvel[d + 3 : d + 6] = (turn @ body).T @ (new_spin + turn @ turning)
