"""Which engine computes a run: the kernel where its equations hold and its steps are MuJoCo's, else MuJoCo."""

import hashlib
import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.control.install import Kind, state_of
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.equations import equations as equations
from wirerope_mj.engine.kernel.equations import not_held
from wirerope_mj.engine.kernel.variants import NOTHING, Group, group_of
from wirerope_mj.engine.simulation.grid import TimeGrid, time_grid
from wirerope_mj.engine.simulation.in_lanes import Sink, final_state, go_in_lanes, moving_indices
from wirerope_mj.engine.simulation.run import RunResult, peaks_of, run
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.simulation.stages import drive_of
from wirerope_mj.engine.simulation.stepper import riding_dofs
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import AccuracyWarning, SimulationError
from wirerope_mj.foundation.lanes import WIDTH
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion, Sine

# largest difference from MuJoCo, relative to the scale of what is compared: far above the rounding of either, 1e-12
AGREEMENT = 1e-9
STATES = 104  # random states in which accelerations are compared: a hundred, and what fills the last lanes
# random displacement [m], angle [rad] and rate [m/s, rad/s] of a coordinate: millimetres of a mount, degrees of a link
PLACE, TURN, SPEED = 2e-3, 0.02, 0.2
STEPS = 40  # steps of the short run
FINER = 4  # steps that are tried, each a tenth of the one before
UNJUDGED = "the native callback, with which it is compared, is not available"  # why a system is not judged
_known: dict[bytes, str] = {}
Engine = Literal["auto", "mujoco", "kernel"]

# reasons why the kernel gives a run up
WHY = {
    at.WILD: "its motion grew without bound",
    at.LIMITED: "a joint came to its limit",
    at.TOUCHING: "bodies moved by more than the clearance between them and may have touched",
}


@once_per_system
def unsupported_system(system: System) -> str:
    """Return the reason why the kernel cannot compute a system, "" if it can.

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
            _known[key] = _disagreement(system)
        except SimulationError as error:
            return str(error)
        if _known[key]:
            warnings.warn(f"MuJoCo computes this system: {_known[key]}.", AccuracyWarning, stacklevel=2)
    return _known[key]


def _disagreement(system: System) -> str:
    """Compare the kernel with MuJoCo on a system and describe their difference, "" if they agree."""
    rng = np.random.default_rng(2004)
    model = without_constraints(system.model)
    joints = model.dof_jntid
    second_half = np.arange(model.nv) >= model.jnt_dofadr[joints] + 3  # of a floating body's coordinates the angles
    turns = (model.jnt_type[joints] == mujoco.mjtJoint.mjJNT_HINGE) | second_half
    tables = system.assembly.tables
    states, expected = np.empty((STATES, model.nq + model.nv + model.na)), list[Array]()
    base = rng.normal(size=(STATES, 6 if tables.rotates else 3)) * 10.0
    loads = rng.normal(size=6 * len(system.assembly.subjects.forces)) * 100.0
    data = mujoco.MjData(model)
    user = system.assembly.user(data.userdata)
    driven = system.assembly.driven_dofs
    with installed(model, data) as kind:
        if kind != "native":
            raise SimulationError(UNJUDGED)
        for number in range(STATES):
            mujoco.mj_resetData(model, data)
            move = rng.normal(size=model.nv) * np.where(turns, TURN, PLACE)
            move[driven] = 0.0
            mujoco.mj_integratePos(model, data.qpos, move, 1.0)
            data.qvel[:], data.act[:] = rng.normal(size=model.nv) * SPEED, rng.uniform(size=model.na)
            states[number] = np.concatenate([data.qpos, data.qvel, data.act])
            user[control.STAGE_POINTS], user[control.STAGES : control.STAGES + 3] = 1.0, base[number, :3]
            user[tables.user.forces :][: loads.size] = loads
            user[tables.user.turns : tables.user.size] = np.resize(base[number, 3:], tables.user.size - tables.user.turns)
            mujoco.mj_forward(model, data)
            expected.append(np.concatenate([data.qacc, data.act_dot]))
    got = _accelerations(system, states, base, loads)
    kinds = slice(0, model.nv), slice(model.nv, None)
    apart = max(_relative_difference(np.array(expected)[:, kind], got[:, kind]) for kind in kinds)
    if not apart <= AGREEMENT:
        return f"its accelerations differ from the kernel's by {apart:.1e} of their scale"
    qvel, step = states[0, model.nq : model.nq + model.nv], min(0.2 * stable_step(system), 1e-3)
    why = ""
    for _ in range(FINER):  # springs of joints do not count in the stable step
        try:
            apart = _compare_runs(system, qvel, step)
            if apart <= AGREEMENT:
                return ""
            why = f"its steps differ from the kernel's by {apart:.1e} of their scale"
        except SimulationError:
            why = "its motion grows without bound, however short the step"
        step /= 10.0  # rounding grows too where a state yields within a step
    return why


def without_constraints(model: mujoco.MjModel) -> mujoco.MjModel:
    """Copy a model with limits and contacts disabled, as the kernel computes it."""
    model = model.__copy__()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    return model


def _accelerations(system: System, states: Array, base: Array, loads: Array) -> Array:
    """Compute by the kernel accelerations and state rates, (n, nv + n_states), at states (n, n_state) of a system.

    `base` are accelerations of the base, (n, 3 or 6); the forces and moments at sites, `loads` (6 n_forces,), are common.
    """
    kernel_equations, model, accelerations = equations(system), system.model, []
    driven = model.nq + np.array(system.assembly.driven_dofs, dtype=int)
    rates = np.ascontiguousarray(states[:, np.newaxis, driven])  # another layout would compile all of it again
    table = np.concatenate([base, np.tile(loads, (len(base), 1))], axis=1)[:, np.newaxis]
    for first in range(0, len(states), WIDTH):
        some = slice(first, first + WIDTH)
        group = group_of([kernel_equations] * WIDTH, states[some], range(WIDTH))
        group.finish(0.0, np.zeros_like(rates[some]), rates[some], table[some], NOTHING)
        parts = (int(kernel_equations.lay[at.RHS]), model.nv), (int(kernel_equations.lay[at.RATES]), model.na)
        accelerations.append(np.concatenate([group.memory[begin : begin + size] for begin, size in parts]))
    return np.concatenate(accelerations, axis=1).T


def _relative_difference(expected: Array, got: Array) -> float:
    """Return the largest difference between the columns of two arrays (n, m), each relative to its largest value.

    A column below a millionth of the largest one is rounding: its differences are relative to that millionth.
    """
    scale = np.abs(expected).max(axis=0)
    scale = np.maximum(scale, 1e-6 * scale.max(initial=0.0))
    with np.errstate(invalid="ignore"):
        apart = np.abs(expected - got).max(axis=0) / np.where(scale > 0.0, scale, 1.0)
    return float(np.max(apart, initial=0.0))


def _compare_runs(system: System, qvel: Array, step: float) -> float:
    """Compare kernel and MuJoCo over a short run; returns the largest difference of samples over the largest of their kind."""
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
        [equations(system)], drive_of(system), [motion], state[np.newaxis], grid, sink=lambda _, i, rows: sink(1, i, rows)
    )
    expected, got = (sample.reshape(-1, channels.size // 3, 3) for sample in samples)
    n_mounts = len(system.mounts)
    kinds = np.array(["motion"] * (channels.shape[0] - 2 * n_mounts) + ["deflection", "force"] * n_mounts)
    worst = 0.0
    for kind in dict.fromkeys(kinds.tolist()):
        wanted, reached = (samples[:, kinds == kind] for samples in (expected, got))
        worst = max(worst, float(np.abs(wanted - reached).max(initial=0.0) / max(np.abs(wanted).max(initial=0.0), 1e-300)))
    return worst


def compute(
    system: System, motion: BaseMotion, grid: TimeGrid, start: State, *, engine: Engine, callback: Kind,
    sink: Callable[[int, Array], None], progress: Callable[[float], None] | None = None,
) -> RunResult:  # fmt: skip
    """Step a system through a time grid, by the kernel where it can, else by MuJoCo; `sink` takes the samples.

    `sink` may be given samples again from the first on, where the kernel gives up and MuJoCo begins anew.

    Raises:
        SimulationError: MuJoCo warned that the state is not valid any more, or "kernel" was asked for and cannot compute this.
    """
    one_of("engine", engine, ("auto", "mujoco", "kernel"))
    if engine == "mujoco":
        why = "it was asked for"
    elif callback != "native":
        why = "the callback in Python is MuJoCo's"
    else:
        why = unsupported_run(system, motion)
        if not why:
            done = run_in_lanes(
                [system], [motion], [start], grid, sink=lambda _, first, rows: sink(first, rows), progress=progress
            )[0]
            if isinstance(done, RunResult):
                return done
            why = done
        if engine == "kernel":
            raise SimulationError(refusal_message(why))
    return replace(run(system, motion, grid, start, callback=callback, sink=sink, progress=progress), why=why)


def refusal_message(why: str) -> str:
    """Word the message for a run that only the kernel was to compute and cannot, from the reason."""
    return f'the kernel cannot compute this run: {why}. Ask for `engine` "auto", or "mujoco".'


def unsupported_motion(system: System, motion: BaseMotion) -> str:
    """Return the reason why the kernel does not follow a motion, "" if it does."""
    modes, driven = system.assembly.subjects.modes, system.assembly.driven_dofs
    if motion.velocity_jumps and (modes or riding_dofs(system.model, driven).size):
        return "the base's velocity jumps under what rides on it through joints or modes of its own"
    return ""


def unsupported_run(system: System, motion: BaseMotion) -> str:
    """Return the reason why the kernel cannot compute a system under a motion, "" if it can."""
    return unsupported_system(system) or unsupported_motion(system, motion)


def failure(group: Group, number: int) -> str:
    """Return the reason why the kernel gave up a variant of a group, "" if it did not."""
    code = float(group.failed[number])
    return WHY[code] if code else ""


def run_in_lanes(
    systems: Sequence[System], motions: Sequence[BaseMotion], starts: Sequence[State], grid: TimeGrid, *, threads: int = 1,
    sink: Sink | None = None, progress: Callable[[float], None] | None = None,
) -> list[RunResult | str]:  # fmt: skip
    """Step variants through a time grid by the kernel; returns each one's result, or the reason why the kernel gave it up."""
    states = np.array([start.values[moving_indices(system)] for system, start in zip(systems, starts, strict=True)])
    done = go_in_lanes(
        [equations(system) for system in systems], drive_of(systems[0]), motions, states, grid, threads=threads,
        sink=sink, progress=progress,
    )  # fmt: skip
    results: list[RunResult | str] = [""] * len(systems)
    for group, numbers in done.groups:
        for lane, number in enumerate(numbers):
            if why := failure(group, lane):
                results[number] = why
                continue
            system, tables = systems[number], systems[number].assembly.tables
            user = np.zeros(tables.user.size)  # peaks, stops and travels as the system's userdata has them
            tables.user.channel_rows(user)[tables.tracked] = group.channels(lane)
            tables.user.stop_rows(user)[: len(group.stops(lane))] = group.stops(lane)
            tables.user.travel_rows(user)[:] = group.travels(lane)
            tables.user.closing_rows(user)[: len(group.closings(lane))] = group.closings(lane)
            results[number] = RunResult(
                final_state=final_state(system, starts[number], group.states[:, lane], grid.stop),
                peaks=peaks_of(system, user, done.base_peaks[done.which[number]]), callback="native", steps=done.steps,
                largest_step=done.largest_step, engine="kernel",
            )  # fmt: skip
    return results
