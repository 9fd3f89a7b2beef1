"""Start of a simulation: settled, relaxed, unloaded, or a given state, moving with the base."""

import mujoco
import numpy as np

from wirerope_mj.engine.control.layout import TRAVEL_MEMORY
from wirerope_mj.engine.control.state import STATE, state_of
from wirerope_mj.engine.simulation.stepper import velocity_jump
from wirerope_mj.engine.statics import History, equilibrium
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

# relative difference of base positions and velocities that is integration error and not another motion
SAME_MOTION = 1e-6
HISTORIES: dict[str, History] = {"settled": "virgin", "relaxed": "relaxed"}


def initial_state(system: System, motion: BaseMotion, initial: str | State) -> State:
    """Return the state at the start of a simulation.

    The base stands and moves as the motion says just before the start; if the given state's base does not, the whole system
    is carried along (a Galilean change), so that nothing but the motion's own acceleration disturbs it.

    Args:
        system: the system.
        motion: base motion.
        initial: "settled", "relaxed", "unloaded" or a state.
    """
    if isinstance(initial, State):
        size = mujoco.mj_stateSize(system.model, STATE)
        added = TRAVEL_MEMORY * len(system.mounts)
        if initial.values.shape == (size - added,):  # of a version that did not follow travel along all axes
            initial = State(values=np.append(initial.values, np.zeros(added)), time=initial.time)
        if initial.values.shape != (size,):
            raise ValueError(f"`initial` has {initial.values.size} values; a state of this system has {size}.")
        state = initial
    elif isinstance(initial, str) and initial in HISTORIES:
        state = equilibrium(system, history=HISTORIES[initial]).state
    elif initial == "unloaded":
        with system.assembly.scratch.data(system.model) as data:
            state = state_of(system.model, data)
    else:
        raise ValueError(f"`initial` must be 'settled', 'relaxed', 'unloaded' or a State, got {initial!r}.")
    return moving_with_base(system, motion, state)


def moving_with_base(system: System, motion: BaseMotion, state: State) -> State:
    """Return `state` with the base where the motion has it at the state's instant, the whole system carried along."""
    assembly, model = system.assembly, system.model
    joints = list(assembly.subjects.driven)
    if not joints:
        return state
    now = np.array([state.time])
    displacement, velocity = motion.displacement(now)[0], motion.velocity(now)[0]
    velocity = velocity - velocity_jump(motion, state.time)  # the simulation itself applies a jump at its start
    dofs, addresses = model.jnt_dofadr[joints], model.jnt_qposadr[joints]
    qpos, qvel = np.empty(model.nq), np.empty(model.nv)
    mujoco.mj_extractState(model, state.values, STATE, qpos, mujoco.mjtState.mjSTATE_QPOS)
    mujoco.mj_extractState(model, state.values, STATE, qvel, mujoco.mjtState.mjSTATE_QVEL)
    q, v = qpos[addresses] - model.qpos0[addresses], qvel[dofs]
    dq, dv = assembly.tables.drive @ displacement - q, assembly.tables.drive @ velocity - v
    moved = np.abs(dq).max() > SAME_MOTION * max(np.abs(q).max(), 1e-3)
    moved |= np.abs(dv).max() > SAME_MOTION * max(np.abs(v).max(), 1e-3)
    if not moved:
        return state
    to_world = np.linalg.pinv(assembly.tables.drive)
    with assembly.scratch.data(model) as data:
        mujoco.mj_setState(model, data, state.values, STATE)
        _carry(system, data, to_world @ dq, to_world @ dv)
        return State(values=state_of(model, data).values, time=state.time)


def _carry(system: System, data: mujoco.MjData, shift: Array, velocity: Array) -> None:
    """Move every tree of the model by `shift` [m] and `velocity` [m/s] as far as the joints at its root allow."""
    model = system.model
    mujoco.mj_kinematics(model, data)
    for body in range(1, model.nbody):
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
