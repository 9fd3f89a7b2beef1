"""Whether the kernel may compute a system: what its equations hold, and MuJoCo's own accelerations and steps beside its own."""

import hashlib
import warnings
from dataclasses import replace

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.control.state import state_of
from wirerope_mj.engine.kernel.equations import Equations
from wirerope_mj.engine.kernel.group import group_of
from wirerope_mj.engine.kernel.held import equations as equations
from wirerope_mj.engine.kernel.held import not_held
from wirerope_mj.engine.kernel.probe import probe
from wirerope_mj.engine.simulation.grid import time_grid
from wirerope_mj.engine.simulation.in_lanes import go_in_lanes
from wirerope_mj.engine.simulation.run import run
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import AccuracyWarning, SimulationError
from wirerope_mj.foundation.lanes import WIDTH
from wirerope_mj.motions import Sine

AGREEMENT = 1e-9
"""Largest difference from MuJoCo, relative to the scale of what is compared: far above the rounding of either, 1e-12."""

STATES = 104
"""Random states in which accelerations are compared: a hundred, and what fills the last lanes."""

PLACE, TURN, SPEED = 2e-3, 0.02, 0.2
"""Random displacement [m], angle [rad] and rate [m/s, rad/s] of a coordinate: millimetres of a mount, degrees of a link."""

STEPS = 40
"""Steps of the short run."""

FINER = 4
"""Steps that are tried, each a tenth of the one before."""

UNJUDGED = "the native callback, with which it is compared, is not available"
"""Why a system is not judged."""

_known: dict[bytes, str] = {}


@once_per_system
def unfit(system: System) -> str:
    """Return why the kernel cannot compute a system, "" if it can.

    Systems of one structure are compared with MuJoCo once.

    Warns:
        AccuracyWarning: kernel and MuJoCo differ, which should not be; MuJoCo is believed.
    """
    beyond = not_held(system)
    if beyond:
        return beyond
    key = hashlib.blake2b(equations(system).key, digest_size=16).digest()
    if key not in _known:
        try:
            _known[key] = _differs(system)
        except SimulationError as error:
            return str(error)
        if _known[key]:
            warnings.warn(f"MuJoCo computes this system: {_known[key]}.", AccuracyWarning, stacklevel=2)
    return _known[key]


def _differs(system: System) -> str:
    """Return in what the kernel differs from MuJoCo, "" if it does not."""
    rng = np.random.default_rng(2004)
    model = without_constraints(system.model)
    own = equations(system)
    states, expected, base = np.empty((STATES, model.nq + model.nv + model.na)), [], rng.normal(size=(STATES, 3)) * 10.0
    data = mujoco.MjData(model)
    user = system.assembly.user(data.userdata)
    driven = system.assembly.driven_dofs
    with installed(model, data) as kind:
        if kind != "native":
            raise SimulationError(UNJUDGED)
        for number in range(STATES):
            mujoco.mj_resetData(model, data)
            move = rng.normal(size=model.nv) * np.where(_turns(model), TURN, PLACE)
            move[driven] = 0.0
            mujoco.mj_integratePos(model, data.qpos, move, 1.0)
            data.qvel[:], data.act[:] = rng.normal(size=model.nv) * SPEED, rng.uniform(size=model.na)
            states[number] = np.concatenate([data.qpos, data.qvel, data.act])
            user[control.STAGE_POINTS], user[control.STAGES : control.STAGES + 3] = 1.0, base[number]
            mujoco.mj_forward(model, data)
            expected.append(np.concatenate([data.qacc, data.act_dot]))
    got = _accelerations(own, states, base)
    kinds = slice(0, model.nv), slice(model.nv, None)
    apart = max(_apart(np.array(expected)[:, kind], got[:, kind]) for kind in kinds)
    if not apart <= AGREEMENT:
        return f"its accelerations differ from the kernel's by {apart:.1e} of their scale"
    qvel, step = states[0, model.nq : model.nq + model.nv], min(0.2 * stable_step(system), 1e-3)
    why = ""
    for _ in range(FINER):  # springs of joints do not count in the stable step
        try:
            apart = _run_apart(system, qvel, step)
            if apart <= AGREEMENT:
                return ""
            why = f"its steps differ from the kernel's by {apart:.1e} of their scale"
        except SimulationError:
            why = "its motion grows without bound, however short the step"
        step /= 10.0  # rounding grows too where a state yields within a step
    return why


def without_constraints(model: mujoco.MjModel) -> mujoco.MjModel:
    """Return a copy in which no limit and no contact acts, as where the kernel computes."""
    model = model.__copy__()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    return model


def _turns(model: mujoco.MjModel) -> Array:
    """Return which coordinates are angles, (nv,)."""
    turning = np.zeros(model.nv, dtype=bool)
    for joint in range(model.njnt):
        first, kind = int(model.jnt_dofadr[joint]), model.jnt_type[joint]
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            turning[first + 3 : first + 6] = True
        turning[first] |= kind == mujoco.mjtJoint.mjJNT_HINGE
    return turning


def _accelerations(own: Equations, states: Array, base: Array) -> Array:
    """Return accelerations and state rates in states (n, n_state) with the base's accelerations (n, 3), (n, nv + n_states)."""
    group = group_of([own] * WIDTH, states[:WIDTH], [0] * WIDTH)
    lanes = [np.ascontiguousarray(one.reshape(-1, WIDTH, one.shape[1]).swapaxes(1, 2)) for one in (states, base)]
    out = np.empty((len(lanes[0]), states.shape[1] - own.n_extra, WIDTH))
    probe(own.lay, own.fix, group.numbers, lanes[0], group.memory, lanes[1], out)
    return out.swapaxes(1, 2).reshape(states.shape[0], -1)


def _apart(expected: Array, got: Array) -> float:
    """Return the largest difference of columns of one kind, each relative to its largest value.

    What is a millionth of the largest column or less is rounding, and relative to that.
    """
    scale = np.abs(expected).max(axis=0)
    scale = np.maximum(scale, 1e-6 * scale.max(initial=0.0))
    with np.errstate(invalid="ignore"):
        apart = np.abs(expected - got).max(axis=0) / np.where(scale > 0.0, scale, 1.0)
    return float(np.max(apart, initial=0.0))


def _run_apart(system: System, qvel: Array, step: float) -> float:
    """Return how far samples of a short run from the modelled geometry lie apart, relative to the largest of their kind."""
    model, tables = without_constraints(system.model), system.assembly.tables
    direction = np.linalg.pinv(tables.drive).sum(axis=1) if len(tables.drive) else np.array([0.0, 0.0, 1.0])
    motion = Sine(frequency=0.05 / step, acceleration=10.0, direction=tuple(direction))
    grid = time_grid(start=0.0, duration=STEPS * step, sample_rate=0.25 / step, timestep=step, motion=motion)
    data = mujoco.MjData(model)
    data.qvel[:] = qvel
    state = np.concatenate([data.qpos, data.qvel, data.act])
    channels = tables.channels[:, np.newaxis] + np.arange(3)
    samples = [np.zeros((grid.sample_times.size, *channels.shape)) for _ in range(2)]

    def sink(which: int, first: int, rows: Array) -> None:
        samples[which][first : first + len(rows)] = rows[:, channels]

    start = state_of(model, data)
    run(replace(system, model=model), motion, grid, start, callback="native", sink=lambda i, rows: sink(0, i, rows))
    go_in_lanes(
        [equations(system)], tables.drive, [motion], state[np.newaxis], grid, sink=lambda _, i, rows: sink(1, i, rows)
    )
    expected, got = (one.reshape(-1, channels.size // 3, 3) for one in samples)
    n_mounts = len(system.mounts)
    kinds = np.array(["motion"] * (channels.shape[0] - 2 * n_mounts) + ["deflection", "force"] * n_mounts)
    worst = 0.0
    for kind in dict.fromkeys(kinds.tolist()):
        one, other = (samples[:, kinds == kind] for samples in (expected, got))
        worst = max(worst, float(np.abs(one - other).max(initial=0.0) / max(np.abs(one).max(initial=0.0), 1e-300)))
    return worst
