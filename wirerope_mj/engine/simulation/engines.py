"""Which engine computes a run: the kernel where its equations hold, MuJoCo everywhere else."""

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from wirerope_mj.engine.control.install import Kind
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.group import Group
from wirerope_mj.engine.simulation.grid import TimeGrid
from wirerope_mj.engine.simulation.in_lanes import InLanes, final_state, go_in_lanes, moving
from wirerope_mj.engine.simulation.judge import equations, unfit
from wirerope_mj.engine.simulation.run import RunResult, peaks_of, run
from wirerope_mj.engine.simulation.stepper import riding_dofs
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

Engine = Literal["auto", "mujoco", "kernel"]

# reasons why the kernel gives a run up
WHY = {
    at.WILD: "its motion grew without bound",
    at.LIMITED: "a joint came to its limit",
    at.TOUCHING: "bodies moved by more than the clearance between them and may have touched",
}


def compute(
    system: System,
    motion: BaseMotion,
    grid: TimeGrid,
    start: State,
    *,
    engine: Engine,
    callback: Kind,
    sink: Callable[[int, Array], None],
    progress: Callable[[float], None] | None = None,
) -> RunResult:
    """Return what comes of a run, as `wirerope_mj.engine.simulation.run.run` does; the kernel gives up what it does not hold.

    `sink` may be given samples again from the first on.

    Raises:
        SimulationError: MuJoCo warned that the state is not valid any more, or "kernel" was asked for and cannot compute this.
    """
    one_of("engine", engine, ("auto", "mujoco", "kernel"))
    why = (
        "it was asked for"
        if engine == "mujoco"
        else "the callback in Python is MuJoCo's"
        if callback != "native"
        else ""
    )
    if not why:
        why = unfit(system) or leap(system, motion)
        done = None if why else _by_kernel(system, motion, grid, start, sink, progress)
        if isinstance(done, RunResult):
            return done
        why = why or str(done)
        if engine == "kernel":
            raise SimulationError(refused(why))
    return replace(run(system, motion, grid, start, callback=callback, sink=sink, progress=progress), why=why)


def refused(why: str) -> str:
    """Return the message about a run that only the kernel was to compute, from the reason why it cannot."""
    return f'the kernel cannot compute this run: {why}. Ask for `engine` "auto", or "mujoco".'


def leap(system: System, motion: BaseMotion) -> str:
    """Return why the kernel does not follow a motion, "" if it does."""
    if motion.loaded_sites:
        return "forces act on the payload"
    if motion.velocity_jumps and riding_dofs(system.model, system.assembly.driven_dofs).size:
        return "the base's velocity jumps under what rides on it through joints of its own"
    return ""


def failure(group: Group, number: int) -> str:
    """Return why the kernel gave up a variant of a group, "" if it did not."""
    code = float(group.failed[number])
    return WHY[code] if code else ""


def memory_of(system: System, group: Group, number: int) -> Array:
    """Return the memory of one variant's peaks, stops and travels as the system's userdata has it, (n_userdata,)."""
    user = np.zeros(system.assembly.tables.user.size)
    tables = system.assembly.tables
    tables.user.channel_rows(user)[tables.tracked] = group.channels(number)
    tables.user.stop_rows(user)[: len(group.stops(number))] = group.stops(number)
    tables.user.travel_rows(user)[:] = group.travels(number)
    return user


def _by_kernel(
    system: System, motion: BaseMotion, grid: TimeGrid, start: State, sink: Callable[[int, Array], None],
    progress: Callable[[float], None] | None,
) -> RunResult | str:  # fmt: skip
    """Return what comes of a run by the kernel, or why it gave up."""
    done = go_in_lanes(
        [equations(system)], system.assembly.tables.drive, [motion], start.values[moving(system)][np.newaxis], grid,
        sink=lambda _, first, rows: sink(first, rows), progress=progress,
    )  # fmt: skip
    group = done.groups[0][0]
    if why := failure(group, 0):
        return why
    return result_of(system, start, grid, done, group, 0, 0)


def result_of(
    system: System, start: State, grid: TimeGrid, done: InLanes, group: Group, lane: int, variant: int
) -> RunResult:
    """Return what came of one variant, in a lane of its group."""
    return RunResult(
        final_state=final_state(system, start, group.states[:, lane], grid.stop),
        peaks=peaks_of(system, memory_of(system, group, lane), done.base_peaks[done.which[variant]]),
        callback="native",
        steps=done.steps,
        largest_step=done.largest_step,
        engine="kernel",
    )
