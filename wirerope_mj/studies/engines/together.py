"""Variants of a study side by side in the kernel's lanes, without systems of their own."""

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.control.install import state_of
from wirerope_mj.engine.kernel.equations import Equations, equations
from wirerope_mj.engine.kernel.variants import Numbers
from wirerope_mj.engine.simulation import BatchFailure, BatchResult, simulate_batch
from wirerope_mj.engine.simulation.engines import unsupported_motion, unsupported_system
from wirerope_mj.engine.simulation.grid import joined, time_grid
from wirerope_mj.engine.simulation.in_lanes import Sink, go_in_lanes, moving
from wirerope_mj.engine.simulation.recorder import column_plan
from wirerope_mj.engine.simulation.simulate import MOST_STEPS, check_direction, checked_corners
from wirerope_mj.engine.simulation.stability import rates_of, stable_step, variant_rates
from wirerope_mj.engine.simulation.stepper import HISTORIES, moving_with_base
from wirerope_mj.engine.statics.find import equilibrium_solver
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.foundation.arrays import Array, Booleans, Entries, Integers
from wirerope_mj.foundation.errors import AccuracyWarning, WireRopeError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import AXES, Isolator
from wirerope_mj.mounts.laws import Parallel
from wirerope_mj.mounts.laws.law import FACTORS, ROUNDING, Law
from wirerope_mj.mounts.laws.plane import Form, form_of, rates_in_plane
from wirerope_mj.studies.inputs.column import Draft
from wirerope_mj.studies.inputs.variants import Maker, Work, systems_valid
from wirerope_mj.studies.measures import Extremes, measures_together


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
    """Return the measures of those variants that can be computed side by side; the others are for `simulate_batch`.

    Which they are, and what comes of each, does not depend on the variants that share a call. Their systems are the same to the
    last bit as those that `wirerope_mj.studies.inputs.variants.Maker` makes, and are not made.
    """
    ready = _ready(work, rows)
    return NONE if ready is None else _measured(work, ready)


def together_again(work: Work, done: Together, rows: Sequence[int]) -> Together:
    """Return the measures of some rows once more, over another duration; indices are those among `rows`."""
    if done.ready is None:
        return NONE
    place = {row: number for number, row in enumerate(rows)}
    some = [k for k, row in enumerate(done.ready.indices.tolist()) if row in place]
    if not some:
        return NONE
    ready = done.ready.taken(some)
    return _measured(work, replace(ready, indices=np.array([place[row] for row in ready.indices.tolist()])))


def _measured(work: Work, ready: "_Ready") -> Together:
    """Step variants to the end, and return what is measured of those that hold."""
    _, extremes, good = _stepped(work, ready)
    columns = measures_together(work.system, extremes, ready.forces, ready.isolators)
    return Together(
        indices=ready.indices[good], columns={name: one[good] for name, one in columns.items()}, late=extremes.late[good],
        slowest=ready.slowest[good], ready=ready,
    )  # fmt: skip


def histories_together(
    work: Work, rows: Sequence[Entries], columns: Sequence[str], threads: int
) -> tuple[Array, dict[int, Array]]:
    """Return instants (n_t,) and columns, as `histories` does, of those variants that can be computed side by side."""
    plan = column_plan(work.system)
    wanted = [plan.names.index(name) - plan.first_sensor for name in columns]
    found: dict[int, dict[int, Array]] = {}

    def sink(number: int, first: int, values: Array) -> None:
        found.setdefault(number, {})[first] = values[:, wanted].copy()

    ready = _ready(work, rows)
    if ready is None:
        return np.zeros(0), {}
    time, _, good = _stepped(work, ready, sink, threads)
    parts = {number: np.concatenate([own[first] for first in sorted(own)]) for number, own in found.items()}
    return time, {int(ready.indices[k]): parts[k] for k in np.flatnonzero(good).tolist()}


@dataclass(frozen=True, kw_only=True)
class _Ready:
    """Variants that are about to begin."""

    indices: Integers  # which of the rows they are, (n,)
    motions: list[BaseMotion]  # of their bases
    isolators: Sequence[Mapping[str, Isolator]]  # of the mounts that have others than the system's
    numbers: Array  # of their equations, (n, n_num)
    states: Array  # (n, n_state)
    forces: Array | None  # of the mounts at rest [N], (n, n_mounts, 3), if they start there
    slowest: Array  # period of the slowest mode of each [s], (n,); NaN where mounts stand elsewhere or resist turning

    def taken(self, some: Sequence[int]) -> "_Ready":
        """Return some of them."""
        forces = None if self.forces is None else self.forces[some]
        return _Ready(
            indices=self.indices[some], motions=[self.motions[k] for k in some],
            isolators=[self.isolators[k] for k in some], numbers=self.numbers[some], states=self.states[some],
            forces=forces, slowest=self.slowest[some],
        )  # fmt: skip


def _ready(work: Work, rows: Sequence[Entries]) -> _Ready | None:
    """Return those variants that can be computed side by side where they begin; None if none can."""
    system = work.system
    if not rows or work.duration / work.timestep > MOST_STEPS or unsupported_system(system):
        return None
    variants = _variants(work, rows)
    if not variants.indices:
        return None
    states, forces, good = _starts(work, variants)
    good &= _steps_hold(work, variants, rows)
    chosen = np.flatnonzero(good)
    if not chosen.size:
        return None
    slowest = variant_rates(system).slowest_periods(variants.numbers, variants.rates, variants.shifts)
    ready = _Ready(
        indices=np.array(variants.indices), motions=variants.motions, isolators=variants.isolators,
        numbers=variants.numbers, states=states, forces=forces, slowest=slowest,
    )  # fmt: skip
    return ready.taken(chosen.tolist())


def _stepped(work: Work, ready: _Ready, sink: Sink | None = None, threads: int = 1) -> tuple[Array, Extremes, Booleans]:
    """Step variants to the end: sample instants [s], extremes over every step, and which variants hold, (n,)."""
    system, motions = work.system, ready.motions
    grid = time_grid(
        start=0.0, duration=work.duration, sample_rate=work.sample_rate, timestep=work.timestep, motion=motions[0],
        corners=joined(checked_corners(work.corners), *{id(one): one.corners for one in motions}.values()),
    )  # fmt: skip
    own = equations(system)
    done = go_in_lanes(
        [Equations(lay=own.lay, fix=own.fix, num=numbers, rest=own.rest, counts=own.counts) for numbers in ready.numbers],
        system.assembly.tables.drive, motions, ready.states, grid, threads=threads, sink=sink,
    )  # fmt: skip
    extremes = Extremes.of_lanes(system, done)
    deflections = len(system.assembly.subjects.bodies) + 2 * len(system.assembly.subjects.points)
    low, high = (one[:, deflections::2] for one in (extremes.lowest, extremes.highest))
    return grid.sample_times, extremes, ~extremes.failed & _lawful(system, low, high)


@dataclass(frozen=True, kw_only=True)
class _Variants:
    """Variants by what their equations differ in."""

    indices: list[int]  # which of the rows they are
    motions: list[BaseMotion]  # of their bases
    isolators: Sequence[Mapping[str, Isolator]]  # of the mounts that have others than the system's
    numbers: Array  # of their equations, (n, n_num)
    rates: Array  # of their laws, as `rates_of` has them, (n, 5, 3 n_mounts)
    shifts: Array  # of their mounts along the world's axes [m], (n, n_mounts, 3)


@once_per_system
def _numbers(system: System) -> Numbers:
    """Return what writes the numbers of a system's variants; made once."""
    return Numbers(system, equations(system))


def _variants(work: Work, rows: Sequence[Entries]) -> _Variants:
    """Return the variants that have the structure of the study's system and are valid."""
    system, make = work.system, Maker(work.system, work.motions, work.columns)
    table = pa.table({column.name: [row[column.name] for row in rows] for column in work.columns})
    valid = systems_valid(system, work.columns, table)
    own_rates = variant_rates(system).own
    laws: _Laws = {}
    checked: set[int] = set()  # of motions, by their identity: `make` keeps them
    written: _Written = {}
    indices, motions, isolators, numbers, rates, shifts = [], [], [], [], [], []
    for index, row in enumerate(rows):
        try:
            draft, motion = make.draft(row), make.motion(row)
            if id(motion) not in checked:
                if unsupported_motion(system, motion):
                    continue
                check_direction(system, motion)
                checked.add(id(motion))
            own = equations(system).num.copy(), own_rates.copy()
            if plain := valid and _plain(draft):
                _write_laws(draft, *own, laws)
            others = make.isolators(draft, draft.gone if plain else [*draft.isolators, *draft.parameters, *draft.gone])
            if not all(_write_isolator(system, mount, one, *own, written) for mount, one in others.items()):
                continue
            changes = make.moves(draft, {})
            _numbers(system).write_springs(own[0], changes.tunings)
            if not _numbers(system).write_geometry(own[0], changes):
                continue
        except (ValueError, WireRopeError):
            continue  # says so where it is made alone
        indices.append(index)
        motions.append(motion)
        isolators.append(others)
        numbers.append(own[0])
        rates.append(own[1])
        shifts.append([changes.positions.get(mount, (0.0, 0.0, 0.0)) for mount in system.mounts])
    return _Variants(
        indices=indices,
        motions=motions,
        isolators=isolators,
        numbers=np.array(numbers),
        rates=np.array(rates),
        shifts=np.array(shifts),
    )


# By mount and identity of an isolator, which `Maker` keeps: its numbers and where they stand, the rates of its laws and
# the columns in which they stand; None if it has another structure than the system's.
_Written = dict[tuple[str, int], tuple[Integers, Array, slice, Array] | None]
# By law and parameters: its kernel's parameters, its rates, and the forms of its scales if it is coupled.
_Forms = list[Form]
_Laws = dict[object, tuple[Array, tuple[float, ...], _Forms]]


def _plain(draft: Draft) -> bool:
    """Return whether only parameters of laws vary, of isolators that act as written."""
    mounts = draft.system.mounts
    return not draft.isolators and all(
        mounts[mount].written.conditioned is mounts[mount].written and all(part in AXES for part, _ in parameters)
        for mount, parameters in draft.parameters.items()
    )


def _write_isolator(system: System, mount: str, isolator: Isolator, numbers: Array, rates: Array, written: _Written) -> bool:
    """Write an isolator to the numbers of the equations and to the laws' rates; returns whether it has their structure."""
    key = (mount, id(isolator))
    if key not in written:
        acting, first = isolator.conditioned, 3 * list(system.mounts).index(mount)
        own = _numbers(system).of_isolator(mount, acting) if acting.holds_everywhere else None
        of_laws = np.array([rates_of(law) for law in acting.axes.values()]).T
        written[key] = None if own is None else (*own, slice(first, first + 3), of_laws)
    if (known := written[key]) is None:
        return False
    places, values, columns, of_laws = known
    numbers[places], rates[:, columns] = values, of_laws
    return True


def _write_laws(draft: Draft, numbers: Array, rates: Array, laws: _Laws) -> None:
    """Write other parameters of laws, known to be valid, to the numbers of the equations and to the laws' rates."""
    system, writer, gone = draft.system, _numbers(draft.system), draft.gone
    for number, (mount, written) in enumerate(system.mounts.items()):
        if mount not in draft.parameters or mount in gone:
            continue
        own: dict[str, Entries] = {}
        for (axis, name), value in draft.parameters[mount].items():
            own.setdefault(axis, {})[name] = value
        isolator, forms = written.isolator, {}
        for axis, values in own.items():
            law, place = isolator.axes[axis], AXES.index(axis)
            assert law is not None  # the column has seen to it
            key = (id(law), tuple(sorted(values.items())))
            if key not in laws:
                varied = _unchecked(law, values)
                laws[key] = _numbers_of(varied, coupled=place in isolator.coupled_axes)
            parameters, rates[:, 3 * number + place], forms[place] = laws[key]
            writer.write_law(numbers, mount, place, parameters)
        if isolator.coupled_axes and any(place in isolator.coupled_axes for place in forms):
            one, other = (forms.get(place) or _forms(isolator.axes[AXES[place]], laws) for place in isolator.coupled_axes)
            scales = map(rates_in_plane, one, other)
            writer.write_coupling(numbers, mount, np.array([value for scale in scales for value in scale]))


def _unchecked(law: Law, values: Entries) -> Law:
    """Return a law with other parameters, whole columns of which are known to be valid."""
    varied: Law = object.__new__(type(law))
    if isinstance(law, Parallel) and not set(values) & set(FACTORS):
        parts = zip(law.laws, law.composed(values), strict=True)
        vars(varied)["laws"] = tuple(_unchecked(one, own) for one, own in parts)
    else:
        vars(varied).update(vars(law), **law.completed(values))
    return varied


def _numbers_of(law: Law, *, coupled: bool) -> tuple[Array, tuple[float, ...], _Forms]:
    return law.kernel_parameters(), rates_of(law), [form_of(part) for part in law.components] if coupled else []


def _forms(law: Law | None, laws: _Laws) -> _Forms:
    """Return the forms of a law that does not vary."""
    assert law is not None  # it is coupled
    key = (id(law), ())
    if key not in laws:
        laws[key] = _numbers_of(law, coupled=True)
    return laws[key][2]


def _starts(work: Work, variants: _Variants) -> tuple[Array, Array | None, Booleans]:
    """Return qpos, qvel and act at the start, forces of the mounts at rest if they start there, and whether these are found."""
    system, n = work.system, len(variants.indices)
    unloaded, where = _unloaded(system), moving(system)
    forces, found = None, np.ones(n, dtype=bool)
    if work.initial in HISTORIES:
        rests = equilibrium_solver(system).solve(variants.numbers, HISTORIES[work.initial])
        states, forces, found = rests.states, rests.mounts[:, :, 1], rests.found & rests.held
        found &= _lawful(system, rests.mounts[:, :, 0], rests.mounts[:, :, 0])
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
    return states, forces, found


@once_per_system
def _unloaded(system: System) -> State:
    """Return the state of the modelled geometry at rest."""
    with system.assembly.scratch.data(system.model) as data:
        return state_of(system.model, data)


def _steps_hold(work: Work, variants: _Variants, rows: Sequence[Entries]) -> Booleans:
    """Return for which variants the step is stable."""
    holds = variant_rates(work.system).certainly_stable(work.timestep, variants.numbers, variants.rates, variants.shifts)
    make = Maker(work.system, work.motions, work.columns)
    for number in np.flatnonzero(~holds):
        holds[number] = work.timestep <= stable_step(make.system(rows[variants.indices[number]]))
    return holds


@once_per_system
def _ends(system: System) -> Array:
    """Return the deflections below and above zero up to which laws hold [m], (n_mounts, 3, 2)."""
    laws = [law for mount in system.mounts.values() for law in mount.isolator.axes.values()]
    return np.array([(np.inf, np.inf) if law is None else law.travel_ends for law in laws]).reshape(-1, 3, 2)


def _lawful(system: System, lowest: Array, highest: Array) -> Booleans:
    """Return which variants' mounts stayed where the laws hold, as `beyond_law` has it; deflections (n, n_mounts, 3) [m]."""
    below, above = _ends(system)[:, :, 0], _ends(system)[:, :, 1]
    beyond = (-lowest > below + ROUNDING) | (highest > above + ROUNDING)
    return np.asarray(~beyond.any(axis=(1, 2)))


def histories(work: Work, rows: Sequence[Entries], columns: Sequence[str]) -> tuple[Array, list[Array | None]]:
    """Return sample instants [s], (n_t,), and columns of variants, (n_t, n_columns); None of one that fails.

    Columns are those of a response, such as "bodies/rack/acceleration/z"; none of the base.
    """
    time, done = histories_together(work, rows, columns, threads=os.cpu_count() or 1)
    found: list[Array | None] = [done.get(index) for index in range(len(rows))]
    make = Maker(work.system, work.motions, work.columns)
    systems: list[System] = []
    motions: list[BaseMotion] = []
    indices: list[int] = []
    for index, row in enumerate(rows):
        if found[index] is not None:
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
                found[index] = np.stack([result.response.column(name) for name in columns], axis=1)
    return time, found


def go_alone(
    work: Work, systems: Sequence[System], motions: Sequence[BaseMotion], *, responses: bool, threads: int | None = None
) -> list[BatchResult | BatchFailure]:
    """Compute variants by systems of their own, without the warnings that a study gives before it begins."""
    with warnings.catch_warnings(action="ignore", category=AccuracyWarning):
        return simulate_batch(
            systems, motions, duration=work.duration, timestep=work.timestep, initial=work.initial,
            sample_rate=work.sample_rate, corners=work.corners, threads=threads, responses=responses, judged=False,
        )  # fmt: skip
