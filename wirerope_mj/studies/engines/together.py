"""Variants of a study side by side in the kernel's lanes, without systems of their own."""

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.engine.control.install import state_of
from wirerope_mj.engine.kernel.equations import Equations, equations
from wirerope_mj.engine.simulation import BatchFailure, BatchResult, simulate_batch
from wirerope_mj.engine.simulation.engines import unsupported_system
from wirerope_mj.engine.simulation.grid import merge_instants, time_grid
from wirerope_mj.engine.simulation.in_lanes import Sink, go_in_lanes, moving_indices
from wirerope_mj.engine.simulation.recorder import column_plan
from wirerope_mj.engine.simulation.simulate import MOST_STEPS, checked_corners
from wirerope_mj.engine.simulation.stability import stable_step, variant_rates
from wirerope_mj.engine.simulation.stages import drive_of
from wirerope_mj.engine.simulation.stepper import HISTORIES, moving_with_base
from wirerope_mj.engine.statics.find import equilibrium_solver
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.foundation.arrays import Array, Booleans, Entries, Integers
from wirerope_mj.foundation.errors import AccuracyWarning, WireRopeError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws.law import ROUNDING
from wirerope_mj.studies.measures import Extremes, measures_together
from wirerope_mj.studies.vary.variant_numbers import Variants, variants_of
from wirerope_mj.studies.vary.variants import Maker, Work


@dataclass(frozen=True, kw_only=True)
class Together:
    """Measures of variants that were computed side by side."""

    indices: Integers  # which of the rows they are of, (n,)
    columns: Mapping[str, Array]  # by the measure's name, (n,) each
    late: Array  # when something of them last reached an extreme that counts [s], (n,)
    slowest: Array  # period of the slowest mode of each [s], (n,); NaN where it needs a system of its own
    ready: "_Ready | None"  # what they began from


NONE = Together(indices=np.zeros(0, dtype=np.int64), columns={}, late=np.zeros(0), slowest=np.zeros(0), ready=None)


def together(work: Work, rows: Sequence[Entries]) -> Together:
    """Compute the measures of the variants that can go side by side in the kernel's lanes; others need `simulate_batch`.

    Which they are, and what comes of each, does not depend on the variants that share a call. Their systems are the same to the
    last bit as those that `wirerope_mj.studies.vary.variants.Maker` makes, and are not made.
    """
    ready = _ready(work, rows)
    return NONE if ready is None else _measured(work, ready)


def together_again(work: Work, done: Together, rows: Sequence[int]) -> Together:
    """Compute the variants of some rows of `done` again over the duration of `work`; `indices` are then places in `rows`."""
    if done.ready is None:
        return NONE
    place = {row: number for number, row in enumerate(rows)}
    some = [k for k, row in enumerate(done.ready.indices.tolist()) if row in place]
    if not some:
        return NONE
    ready = done.ready.taken(some)
    return _measured(work, replace(ready, indices=np.array([place[row] for row in ready.indices.tolist()])))


def _measured(work: Work, ready: "_Ready") -> Together:
    """Step variants to the end, and return the measures of the valid ones."""
    _, extremes, good = _step(work, ready)
    columns = measures_together(work.system, extremes, ready.forces, ready.isolators)
    return Together(
        indices=ready.indices[good], columns={name: column[good] for name, column in columns.items()}, late=extremes.late[good],
        slowest=ready.slowest[good], ready=ready,
    )  # fmt: skip


def histories_together(
    work: Work, rows: Sequence[Entries], columns: Sequence[str], threads: int
) -> tuple[Array, dict[int, Array]]:
    """Return sample instants [s], (n_t,), and by row the columns, (n_t, n_columns), of variants that can go side by side."""
    plan = column_plan(work.system)
    wanted = [plan.names.index(name) - plan.first_sensor for name in columns]
    found_blocks: dict[int, dict[int, Array]] = {}

    def sink(number: int, first: int, values: Array) -> None:
        found_blocks.setdefault(number, {})[first] = values[:, wanted].copy()

    ready = _ready(work, rows)
    if ready is None:
        return np.zeros(0), {}
    time, _, good = _step(work, ready, sink, threads)
    parts = {number: np.concatenate([blocks[first] for first in sorted(blocks)]) for number, blocks in found_blocks.items()}
    return time, {int(ready.indices[k]): parts[k] for k in np.flatnonzero(good).tolist()}


@dataclass(frozen=True, kw_only=True)
class _Ready:
    """Start of variants that are to be stepped side by side: motions, numbers of their equations, and states."""

    indices: Integers  # which of the rows they are, (n,)
    motions: list[BaseMotion]  # of their bases
    isolators: Sequence[Mapping[str, Isolator]]  # of the mounts that have others than the system's
    numbers: Array  # of their equations, (n, n_num)
    states: Array  # (n, n_state)
    forces: Array | None  # of the mounts at rest [N], (n, n_mounts, 3), if they start there
    slowest: Array  # period of the slowest mode of each [s], (n,); NaN where mounts stand elsewhere or resist turning

    def taken(self, some: Sequence[int]) -> "_Ready":
        """Return the start of some of the variants, by their places in these arrays."""
        forces = None if self.forces is None else self.forces[some]
        return _Ready(
            indices=self.indices[some], motions=[self.motions[k] for k in some],
            isolators=[self.isolators[k] for k in some], numbers=self.numbers[some], states=self.states[some],
            forces=forces, slowest=self.slowest[some],
        )  # fmt: skip


def _ready(work: Work, rows: Sequence[Entries]) -> _Ready | None:
    """Return the start of the variants that can be computed side by side; None if none can."""
    system = work.system
    if not rows or work.duration / work.timestep > MOST_STEPS or unsupported_system(system):
        return None
    variants = variants_of(work, rows)
    if not variants.indices:
        return None
    states, forces, good = _start_states(work, variants)
    holds = variant_rates(system).certainly_stable(work.timestep, variants.numbers, variants.rates, variants.shifts)
    make = Maker(system, work.motions, work.columns)
    for number in np.flatnonzero(~holds):
        holds[number] = work.timestep <= stable_step(make.system(rows[variants.indices[number]]))
    good &= holds
    chosen = np.flatnonzero(good)
    if not chosen.size:
        return None
    slowest = variant_rates(system).slowest_periods(variants.numbers, variants.rates, variants.shifts)
    ready = _Ready(
        indices=np.array(variants.indices), motions=variants.motions, isolators=variants.isolators,
        numbers=variants.numbers, states=states, forces=forces, slowest=slowest,
    )  # fmt: skip
    return ready.taken(chosen.tolist())


def _step(work: Work, ready: _Ready, sink: Sink | None = None, threads: int = 1) -> tuple[Array, Extremes, Booleans]:
    """Step variants to the end; return sample instants [s], extremes over all steps, and which variants are valid, (n,)."""
    system, motions = work.system, ready.motions
    grid = time_grid(
        start=0.0, duration=work.duration, sample_rate=work.sample_rate, timestep=work.timestep, motion=motions[0],
        corners=merge_instants(checked_corners(work.corners), *{id(motion): motion.corners for motion in motions}.values()),
    )  # fmt: skip
    shared = equations(system)
    done = go_in_lanes(
        [
            Equations(lay=shared.lay, fix=shared.fix, num=numbers, rest=shared.rest, counts=shared.counts)
            for numbers in ready.numbers
        ],
        drive_of(system), motions, ready.states, grid, threads=threads, sink=sink,
    )  # fmt: skip
    extremes = Extremes.of_lanes(system, done)
    deflections = len(system.assembly.subjects.bodies) + 2 * len(system.assembly.subjects.points)
    low, high = (extreme[:, deflections::2] for extreme in (extremes.lowest, extremes.highest))
    return grid.sample_times, extremes, ~extremes.failed & _lawful(system, low, high)


def _start_states(work: Work, variants: Variants) -> tuple[Array, Array | None, Booleans]:
    """Return qpos, qvel and act at the start, the mounts' forces if that is an equilibrium, and whether it was found, (n,)."""
    system, n = work.system, len(variants.indices)
    unloaded, where = _unloaded(system), moving_indices(system)
    forces, valid = None, np.ones(n, dtype=bool)
    if work.initial in HISTORIES:
        rests = equilibrium_solver(system).solve(variants.numbers, HISTORIES[work.initial])
        states, valid = rests.states, rests.found & rests.held
        deflections, forces = np.moveaxis(rests.mounts, 2, 0)
        valid &= _lawful(system, deflections, deflections)
    else:
        states = np.tile(unloaded.values[where], (n, 1))
    moves: dict[int, Array] = {}
    for number, motion in enumerate(variants.motions):
        if id(motion) not in moves:
            moves[id(motion)] = moving_with_base(system, motion, unloaded).values[where] - unloaded.values[where]
        move = moves[id(motion)]
        if not move[: system.model.nq].any():  # velocities alone, from rest: the same of every state
            states[number] += move
        else:
            values = unloaded.values.copy()
            values[where] = states[number]
            states[number] = moving_with_base(system, motion, State(values=values, time=0.0)).values[where]
    return states, forces, valid


@once_per_system
def _unloaded(system: System) -> State:
    """Return the state of the modelled geometry at rest, without loads in the mounts."""
    with system.assembly.scratch.data(system.model) as data:
        return state_of(system.model, data)


@once_per_system
def _travel_ends(system: System) -> Array:
    """Return the deflections [m], below and above zero, up to which laws hold, (n_mounts, 3, 2)."""
    laws = [law for mount in system.mounts.values() for law in mount.isolator.axes.values()]
    return np.array([(np.inf, np.inf) if law is None else law.travel_ends for law in laws]).reshape(-1, 3, 2)


def _lawful(system: System, lowest: Array, highest: Array) -> Booleans:
    """Return the mask of variants all of whose laws hold over deflections [m] from lowest to highest, (n, n_mounts, 3)."""
    below, above = _travel_ends(system)[:, :, 0], _travel_ends(system)[:, :, 1]
    beyond = (-lowest > below + ROUNDING) | (highest > above + ROUNDING)
    return np.asarray(~beyond.any(axis=(1, 2)))


def histories(work: Work, rows: Sequence[Entries], columns: Sequence[str]) -> tuple[Array, list[Array | None]]:
    """Return sample instants [s], (n_t,), and columns of variants, (n_t, n_columns); None of one that fails.

    Columns are those of a response, such as "bodies/rack/acceleration/z"; none of the base.
    """
    time, done = histories_together(work, rows, columns, threads=os.cpu_count() or 1)
    histories: list[Array | None] = [done.get(index) for index in range(len(rows))]
    make = Maker(work.system, work.motions, work.columns)
    systems: list[System] = []
    motions: list[BaseMotion] = []
    indices: list[int] = []
    for index, row in enumerate(rows):
        if histories[index] is not None:
            continue
        try:
            system, motion = make.system(row), make.motion(row)
        except (ValueError, WireRopeError):
            continue
        systems, motions, indices = [*systems, system], [*motions, motion], [*indices, index]
    if systems:
        for index, result in zip(indices, go_alone(work, systems, motions, responses=True), strict=True):
            if not isinstance(result, BatchFailure) and result.response is not None:
                time = result.response.time
                histories[index] = np.stack([result.response.column(name) for name in columns], axis=1)
    return time, histories


def go_alone(
    work: Work, systems: Sequence[System], motions: Sequence[BaseMotion], *, responses: bool, threads: int | None = None
) -> list[BatchResult | BatchFailure]:
    """Compute variants by systems of their own, without the warnings that a study gives before it begins."""
    with warnings.catch_warnings(action="ignore", category=AccuracyWarning):
        return simulate_batch(
            systems, motions, duration=work.duration, timestep=work.timestep, initial=work.initial,
            sample_rate=work.sample_rate, corners=work.corners, threads=threads, responses=responses, judged=False,
        )  # fmt: skip
