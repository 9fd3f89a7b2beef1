"""Systems through one time grid by the kernel, one to a lane, on several threads."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np

from wirerope_mj.engine.control.install import STATE, check_callbacks
from wirerope_mj.engine.kernel.equations import Equations
from wirerope_mj.engine.kernel.variants import NOTHING, Group, group_of
from wirerope_mj.engine.response.peaks import Peak
from wirerope_mj.engine.simulation.grid import TimeGrid
from wirerope_mj.engine.simulation.stages import Drive, StageTables, distinct_motions, events_key, loads_at
from wirerope_mj.engine.simulation.stepper import acceleration_before, base_before, turning_before
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.lanes import WIDTH
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

# takes the number of a variant, of the first of some samples, and these samples' sensor values, (n_samples, n_values)
Sink = Callable[[int, int, Array], None]
_ROWS, _MOVED = ("start", "stop", "steps", "sampled", "event"), ("positions", "rates", "accelerations")


@dataclass(frozen=True, kw_only=True)
class InLanes:
    """Variants that were stepped side by side to the end of a time grid, and the peaks of their base motions."""

    groups: list[tuple[Group, list[int]]]  # the variants side by side, and those of each group by their numbers
    base_peaks: list[Peak]  # peak of the base's acceleration of every distinct motion
    which: list[int]  # number of each variant's motion among these, (n,)
    steps: int  # number of steps
    largest_step: float  # largest of them [s]


def indices(model: mujoco.MjModel, part: mujoco.mjtState) -> Integers:
    """Return the indices of a part of MuJoCo's state among the values of a `State`."""
    numbers = np.arange(mujoco.mj_stateSize(model, STATE), dtype=np.float64)
    extracted = np.empty(mujoco.mj_stateSize(model, part))
    mujoco.mj_extractState(model, numbers, STATE, extracted, part)
    return extracted.astype(np.int64)


@once_per_system
def moving_indices(system: System) -> Integers:
    """Return the indices of qpos, qvel and act among the values of a `State`."""
    kinds = mujoco.mjtState
    parts = (kinds.mjSTATE_QPOS, kinds.mjSTATE_QVEL, kinds.mjSTATE_ACT)
    return np.concatenate([indices(system.model, part) for part in parts])


def go_in_lanes(
    equations: Sequence[Equations], drive: Drive, motions: Sequence[BaseMotion], states: Array, grid: TimeGrid, *,
    threads: int = 1, sink: Sink | None = None, progress: Callable[[float], None] | None = None,
) -> InLanes:  # fmt: skip
    """Step variants side by side through a time grid, from `states`, their qpos, qvel and act, (n, n_state).

    `sink` takes the samples if they are wanted, `progress` the simulated time [s] now and then.
    """
    check_callbacks()
    distinct, which = distinct_motions(motions)
    events = [events_key(motion) for motion in distinct]
    groups = _groups(equations, states, which, [events[motion] for motion in which])
    sites = equations[0].loaded if any(motion.loaded_sites for motion in distinct) else ()
    tables = [StageTables(motion, drive, sites) for motion in distinct]
    done, steps, largest, stop = 0, 0, 0.0, grid.start
    with ThreadPoolExecutor(threads) as pool:
        run = pool.map if threads > 1 and len(groups) > 1 else map
        for block in grid.blocks():
            blocks = [block.with_events_of(motion) if motion is not grid.motion else block for motion in distinct]
            for stages in zip(*(table.blocks(part) for table, part in zip(tables, blocks, strict=True)), strict=True):
                cut = slice(stages[0].first, stages[0].first + stages[0].ends.size)
                grids = [np.array([getattr(grid, row)[cut] for row in _ROWS]) for grid in blocks]
                moved = [np.array([getattr(stage, part) for stage in stages]) for part in _MOVED]
                if sites or stages[0].turns.size:
                    moved[2] = np.array(
                        [_side_by_side(stage.accelerations, stage.turns, stage.forces, len(sites)) for stage in stages]
                    )
                samples = int(blocks[0].sampled[cut].sum())
                list(run(partial(_advance, grids, moved, stages[0].ends, samples, done, sink), groups))
                done += samples
                if progress is not None:
                    progress(float(grids[0][1, -1]))
            steps, largest = steps + int(block.steps.sum()), max(largest, block.largest_step)
            stop = float(block.stop[-1]) if block.stop.size else stop
    _finish(groups, distinct, drive, sites, stop, done if done < grid.sample_times.size else -1, sink)
    return InLanes(groups=groups, base_peaks=[table.peak for table in tables], which=which, steps=steps, largest_step=largest)


def _side_by_side(accelerations: Array, turns: Array, forces: Array, n_sites: int) -> Array:
    """Join accelerations of the base and of its roll, pitch, yaw, (n, 3) each, and loads, (n, n_sites, 6), column by column."""
    n = len(accelerations)
    loads = forces.reshape(n, -1) if forces.size else np.zeros((n, 6 * n_sites))
    return np.concatenate([accelerations, turns.reshape(n, -1), loads], axis=1)


def _groups(
    equations: Sequence[Equations], states: Array, which: list[int], events: Sequence[object]
) -> list[tuple[Group, list[int]]]:
    """Group variants that may share lanes, in the order of the first of each group."""
    alike: dict[object, list[int]] = {}
    keys = {id(equation): equation.key for equation in equations}
    for number, (equation, event) in enumerate(zip(equations, events, strict=True)):
        alike.setdefault((keys[id(equation)], event), []).append(number)
    groups = []
    for numbers in alike.values():
        for first in range(0, len(numbers), WIDTH):
            some = numbers[first : first + WIDTH]
            group = group_of([equations[i] for i in some], states[some], [which[i] for i in some])
            groups.append((group, some))
    return groups


def _advance(
    grids: Sequence[Array], moved: Sequence[Array], ends: Integers, samples: int, done: int, sink: Sink | None,
    group: tuple[Group, list[int]],
) -> None:  # fmt: skip
    """Step a group through segments; for each base motion `grids` has the grid's rows, `moved` the base's motion."""
    (lanes, numbers), (positions, rates, accelerations) = group, moved
    out = np.empty((lanes.size, samples, lanes.equations.n_values)) if sink is not None else NOTHING
    lanes.step(grids[int(lanes.which[0])], positions, rates, accelerations, ends, out)
    if sink is not None:
        for number, rows in zip(numbers, out, strict=True):
            sink(number, done, rows)


def _finish(
    groups: list[tuple[Group, list[int]]], motions: Sequence[BaseMotion], drive: Drive, sites: Sequence[str], stop: float,
    sample: int, sink: Sink | None,
) -> None:  # fmt: skip
    """Observe the last instant with the bases' motion just before it, and pass its values on if it is sampled."""
    before = [base_before(motion, drive, stop) for motion in motions]
    positions, rates = (np.array([moves[part] for moves in before])[:, np.newaxis] for part in (0, 1))
    table = np.array([acceleration_before(motion, stop) for motion in motions])[:, np.newaxis]
    turns = [turning_before(motion, drive, stop) for motion in motions]
    if sites or turns[0].size:
        loads = [loads_at(motion, sites, np.array([stop])) for motion in motions]
        table = np.array([_side_by_side(*columns, len(sites)) for columns in zip(table, turns, loads, strict=True)])
    for lanes, numbers in groups:
        wanted = sink is not None and sample >= 0
        out = np.empty((lanes.size, 1, lanes.equations.n_values)) if wanted else NOTHING
        lanes.finish(stop, positions, rates, table, out)
        if sink is not None and wanted:
            for number, rows in zip(numbers, out, strict=True):
                sink(number, sample, rows)


def final_state(system: System, start: State, values: Array, time: float) -> State:
    """Return the final state: the start state with its last instant, qpos, qvel and act, (n_state,).

    What belongs to the run alone, the system's part of userdata, is zero.
    """
    kinds, first = mujoco.mjtState, system.assembly.userdata
    changed = start.values.copy()
    changed[moving_indices(system)], changed[indices(system.model, kinds.mjSTATE_TIME)] = values, time
    changed[indices(system.model, kinds.mjSTATE_USERDATA)[first : first + system.assembly.tables.user.size]] = 0.0
    return State(values=changed, time=time)
