"""Choosing the step before the run by pilots, short trial simulations, whose step is halved until samples and peaks agree."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter

import numpy as np

from wirerope_mj.engine.kernel.layout import WILD
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.engine.simulation.engines import WHY, Engine, compute, run_in_lanes, unsupported_run
from wirerope_mj.engine.simulation.grid import TimeGrid, time_grid
from wirerope_mj.engine.simulation.run import RunResult
from wirerope_mj.engine.simulation.stability import eigenvalues, stable_step
from wirerope_mj.engine.simulation.stages import Later
from wirerope_mj.engine.simulation.stepper import moving_with_base
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.budget import require_memory
from wirerope_mj.foundation.errors import BudgetError, SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

# decay of a hysteretic state over a given step from which on RK4 may make it grow, and half of the step is tried beside it
STIFF = 2.0
HALVINGS = 11  # halvings after which the search ends: 1e-3 s becomes 5e-7 s
# the same where bodies touch: an impact's error falls slowly and irregularly, so the error reached is reported instead
HALVINGS_IN_CONTACT = 4
LUCK = 2  # halvings before which errors in contact say little: where in a step the touch falls is luck
# error aimed at where bodies touch and the accuracy asked for is out of reach: no stop is known better than that
ENOUGH_IN_CONTACT = 1e-3
SAMPLES, STABILITY, DURATION = "the sample interval", "the stability of the stiffest mount", "the duration"
CORNERS = "the corners of the motion, such as the samples of a record"
ACCURACY, GIVEN = "the accuracy asked for", "the timestep asked for"
CONTACTS = "contacts, where finer steps bring too little"  # limits of a step
# error of the coarser of two runs over their difference at order 2, taken where bodies touch and where the step is given
RICHARDSON = 4.0 / 3.0
# difference of two runs, the step of one half that of the other, over the finer one's error: 2^p - 1 at order p. It is 1 where
# a peak is a corner, as at a slider that begins to slip, and it is not trusted to be more than at order 1.6
LEAST_FALL, MOST_FALL = 1.0, 2.0
# difference one halving before over the finer one's error at order 2: one that falls faster falls by luck
TWO_HALVINGS = 12.0
# error of a run over its difference from that with two thirds of its step, at order 2
THIRD = 9.0 / 5.0
# bytes of a value in the samples of pilots: rows and vectors of a coarse, a fine and a longer one are held at once
OF_A_VALUE = 6 * 8
SMALL = 1e-3  # quantities smaller than this fraction of the largest of their kind are judged against that fraction
# peaks below which a quantity rests [m/s^2]: what an equilibrium's rounding leaves is 1e-10, and no step makes it smaller
STILL = {"acceleration": 1e-6}
KEPT = 20_000_000  # numbers that a pilot may have to be kept as the run's answer: 160 MB
# slowest periods after the motion's last corner that a pilot covers: the largest peaks lie within them
PILOT_PERIODS = 6.0
WINDOWS = 6  # pilots of a motion too long to be tried whole
# fraction of the accuracy that windows must keep: between them the error was seen to be up to 1.7 times theirs
WINDOWED = 0.5


@dataclass(frozen=True, kw_only=True)
class ChosenStep:
    """A step [s], the error estimated for it, relative to the peaks, and what keeps it from being longer.

    `done` is the result of the run with this step, and its samples, where a pilot (trial simulation) was the whole run.
    """

    timestep: float
    error: float
    limited_by: str
    done: tuple[RunResult, Array] | None = field(default=None, compare=False, repr=False)


def limit_of_given(timestep: float, sample_rate: float) -> str:
    """Name what limits the steps where `timestep` [s] is given: steps also end at samples."""
    return GIVEN if timestep <= 1.0 / sample_rate else SAMPLES


def error_of_given(
    system: System, motion: BaseMotion, start: State, *, decay: float, timestep: float, duration: float, sample_rate: float,
    engine: Engine = "auto",
) -> float:  # fmt: skip
    """Estimate the error of a given step relative to the peaks, by short trial simulations with this step and half of it.

    NaN where that fails, or hysteretic states decay by little over the step, see `decay_over_step`.
    """
    if decay <= STIFF:
        return np.nan
    pilots = _Pilots(system, motion, start, duration=duration, sample_rate=sample_rate, engine=engine)
    del pilots.windows[1:]
    difference = _difference(pilots.at(timestep), pilots.at(timestep / 2.0))
    return RICHARDSON * difference if np.isfinite(difference) else np.nan


def choose_timestep(
    system: System, motion: BaseMotion, start: State, *, duration: float, sample_rate: float, accuracy: float,
    engine: Engine = "auto", longest: float = math.inf, progress: Callable[[float, float], None] = lambda done, run: None,
) -> ChosenStep:  # fmt: skip
    """Halve the step until short trial runs (pilots) keep samples and refined peaks within `accuracy`; returns also the error.

    The series starts at the sample interval or the stability limit, whichever is shorter. A pilot is the run itself if that
    is short, else windows of it that start from `start`. The errors of two pilots are estimated by `_errors`, and the coarser
    or the finer is taken where that is enough. Where bodies touch, `accuracy` may not be reached: refining ends as soon
    as that shows, and the error says what was reached. BudgetError if a finer step would take more than `longest` [s] of
    computing in all. `progress` takes the fraction of all pilots that is done, as far as their order of convergence tells, and
    the time [s] that the run then takes.
    """
    pilots = _Pilots(system, motion, start, duration=duration, sample_rate=sample_rate, engine=engine)
    pilots.longest = longest
    windows = pilots.windows
    seconds, values = sum(length for _, length in windows), system.model.nsensordata - system.assembly.sensor
    require_memory(
        f"the runs by which a step is chosen, {seconds:.4g} s with {sample_rate:.4g} samples a second,",
        OF_A_VALUE * seconds * sample_rate * values, "Use a lower `sample_rate`, or give the `timestep`.",
    )  # fmt: skip
    step, limit = min((1.0 / sample_rate, SAMPLES), (stable_step(system), STABILITY), (duration, DURATION))
    between = _step_between_corners(motion, windows, sample_rate, step)
    step, limit = (between, CORNERS) if between < step else (step, limit)
    whole = windows == [(start.time, duration)]
    wanted = accuracy if len(windows) == 1 else WINDOWED * accuracy
    coarse = pilots.at(step)
    in_contact: list[ChosenStep] = []
    hit: list[ChosenStep] = []  # of runs that hit a stop among the laws
    before = np.nan
    for halving in range(HALVINGS):
        fine = pilots.at(step / 2.0)
        if coarse and fine and [pilot.run.steps for pilot in coarse] == [pilot.run.steps for pilot in fine]:
            step, coarse = step / 2.0, fine  # between samples and corners no step was cut: nothing is learned
            continue
        difference = _difference(coarse, fine)
        touches = fine is not None and any(pilot.touches for pilot in fine)
        error, finer = (RICHARDSON * difference, np.inf) if touches else _errors(difference, before)
        # Where the order is not yet known the finer one's error is taken for the whole difference, and then for half of it.
        halvings = _halvings(error if touches else finer, wanted * (1.0 if touches or np.isfinite(before) else 2.0))
        progress(*pilots.times(halvings, 0.0 if whole else duration))
        if fine is not None and not touches and any(pilot.hits for pilot in fine) and np.isfinite(difference):
            if finer <= wanted:  # by luck, or since it converges: a third step tells
                third = _difference(pilots.at(step / 3.0), fine)
                difference, finer = max(difference, third), max(finer, THIRD * third)
                error = max(error, finer)
            hit.append(ChosenStep(timestep=step, error=difference, limited_by=SENSITIVE))
        if error <= wanted:
            longer = _longer(pilots, fine, step, error, wanted, 0.5) if halving and not whole else None
            choice = ChosenStep(timestep=step, error=error, limited_by=ACCURACY if halving else limit)
            return longer or _with_pilot(choice, coarse, whole)
        if touches and np.isfinite(difference):
            in_contact.append(_with_pilot(ChosenStep(timestep=step, error=error, limited_by=CONTACTS), coarse, whole))
            halvings = len(in_contact) - 1  # of steps at which the run does not fail
            in_reach = error / 2.0 ** (HALVINGS_IN_CONTACT - halvings)  # in contact an error falls with order 1 at best
            if halvings >= LUCK and in_reach > wanted and not in_reach <= ENOUGH_IN_CONTACT < error:
                return _most_accurate(in_contact)
        elif finer <= wanted:
            choice = ChosenStep(timestep=step / 2.0, error=finer, limited_by=ACCURACY)
            longer = None if whole else _longer(pilots, fine, step / 2.0, choice.error, wanted)
            return longer or _with_pilot(choice, fine, whole)
        step, coarse, before = step / 2.0, fine, difference
    if pilots.failures and not np.isfinite(error):
        every = "every step" if coarse is None else "steps"
        raise SimulationError(f"the run fails at {every} down to {step:.3g} s: {pilots.failures[-1]}")
    if hit and hit[-1].error <= 1.0:  # the longest step that is about as good as the best, and how much all finer ones scatter
        least = min(pilot_step.error for pilot_step in hit)
        first = next(i for i, pilot_step in enumerate(hit) if pilot_step.error <= 2.0 * least)
        return replace(hit[first], error=max(pilot_step.error for pilot_step in hit[first:]))
    raise SimulationError(
        f"no step down to {step:.3g} s keeps samples and peaks within {accuracy:.3g} of the peaks; the last error was "
        f"{error:.3g}. Ask for less (a larger `accuracy`), or give the `timestep`."
    )


def _errors(difference: float, before: float) -> tuple[float, float]:
    """Estimate the errors of the coarser and the finer of two runs from their difference and that of one halving before.

    How the difference fell tells the order; NaN before, or not finite: order 1.
    """
    if not np.isfinite(before) or difference == 0.0:
        finer = difference / LEAST_FALL
    else:
        fall = min(max(before / difference - 1.0, LEAST_FALL), MOST_FALL)
        finer = max(difference / fall, before / TWO_HALVINGS)
    return difference + finer, finer


def _halvings(error: float, wanted: float) -> int:
    """Estimate how many halvings, each of which leaves a quarter, bring an error below what is wanted."""
    return max(math.ceil(math.log(error / wanted, 4.0)), 0) if 0.0 < error < np.inf else 0 if error == 0.0 else HALVINGS


def _longer(
    pilots: "_Pilots", fine: "list[_Pilot] | None", step: float, error: float, wanted: float, finer: float = 1.0
) -> ChosenStep | None:
    """Return a step between `step` and its double, which was too long, if it is accurate enough; None otherwise.

    Its error is estimated by second-order convergence against `fine`, trial runs with `finer` times `step`.
    """
    factor = min(1.9, 0.9 * np.sqrt(wanted / error)) if error > 0.0 else 1.0
    if factor <= 1.15:
        return None
    tried = pilots.at(factor * step)
    if tried is None or fine is None:
        return None
    # Samples and corners cut steps: how much longer they are is known by how many there are.
    taken = finer * min(fine_pilot.run.steps / pilot.run.steps for fine_pilot, pilot in zip(fine, tried, strict=True))
    if taken <= 1.15:
        return None
    longer = _difference(tried, fine) * taken**2 / (taken**2 - finer**2)
    return ChosenStep(timestep=factor * step, error=longer, limited_by=ACCURACY) if longer <= wanted else None


def _with_pilot(step: ChosenStep, pilots: "list[_Pilot] | None", whole: bool) -> ChosenStep:
    """Attach the trial run's result to a step if that run was the whole one and is small enough to be kept."""
    kept = whole and pilots is not None and pilots[0].rows.size <= KEPT
    return replace(step, done=(pilots[0].run, pilots[0].rows)) if kept and pilots else step


def _most_accurate(tried: list[ChosenStep]) -> ChosenStep:
    """Return the step with the least error, which is raised to the largest error of any finer step.

    If that exceeds half of the coarsest step's, though order 1 would leave a quarter, the response itself is sensitive.
    """
    errors = [step.error for step in tried]
    least = errors.index(min(errors))
    error = max(errors[least:])
    sensitive = error > max(ENOUGH_IN_CONTACT, 0.5 * errors[0])
    return replace(tried[least], error=error, limited_by=SENSITIVE if sensitive else CONTACTS)


def _step_between_corners(motion: BaseMotion, windows: list[tuple[float, float]], sample_rate: float, step: float) -> float:
    """Return the median step if corners cut most steps short, as a record's samples do, else `step`.

    Halving a longer step would change nothing, so that no error would show.
    """
    taken, corners = [], 0
    for begin, length in windows:
        grid = time_grid(start=begin, duration=length, sample_rate=sample_rate, timestep=step, motion=motion)
        for block in grid.blocks():
            taken.append(np.repeat((block.stop - block.start) / block.steps, block.steps))
            corners += int(np.count_nonzero(block.corner_after))
    steps = np.concatenate(taken)
    # The intervals between a record's instants differ by rounding: none of them may need a second step for that.
    return min(step, float(np.median(steps)) * (1.0 + 1e-6)) if 2 * corners > steps.size else step


def _windows(
    system: System, motion: BaseMotion, start: State, duration: float, sample_rate: float
) -> list[tuple[float, float]]:
    """Return starts and lengths [s] of the trial runs; each begins whole sample intervals after the first."""
    rates = np.abs(eigenvalues(system))
    slowest = 2.0 * np.pi / max(float(rates[rates > 1.0].min(initial=60.0)), 6.0)  # from 1 Hz up: no pilot of minutes
    length = PILOT_PERIODS * slowest
    begin, end = start.time, start.time + duration
    over = min(max(motion.end, begin), end)
    if over - begin <= (WINDOWS - 1) * length:
        return [(begin, min(over + length, end) - begin)]
    # Geometric spacing follows a logarithmic sweep; the last window ends with the motion.
    starts = (over - length - begin) * np.geomspace(1.0, 2.0**WINDOWS, WINDOWS) / 2.0**WINDOWS
    starts = begin + np.floor(starts * sample_rate) / sample_rate
    starts[0] = begin
    return [(float(instant), length) for instant in starts]


@dataclass(frozen=True, kw_only=True)
class _Pilot:
    """A trial run over one window of the motion: its result, samples, peaks and contacts."""

    run: RunResult
    rows: Array  # sensor values at the samples, (n_t, n_values)
    vectors: Array  # accelerations, displacements, deflections and forces over time, (n_t, n_channels, 3)
    peaks: Array  # value, minimum and maximum of every channel, (n_channels, 7)
    kinds: list[str]
    touches: bool  # whether a contact of geoms was active
    hits: bool  # whether a stop among the laws was struck


class _Pilots:
    """Pilots: trial runs of a system with a chosen step over windows, short parts of a run, spread over its motion."""

    def __init__(
        self, system: System, motion: BaseMotion, start: State, *, duration: float, sample_rate: float, engine: Engine
    ) -> None:
        self.system, self.motion, self.start = system, motion, start
        self.sample_rate, self.engine = sample_rate, engine
        self.windows = _windows(system, motion, start, duration, sample_rate)
        self.failures: list[str] = []
        self.longest, self.began, self.last = math.inf, perf_counter(), 0.0  # times of computing [s], the last of a pilot's

    @cached_property
    def starts(self) -> list[State]:
        """States at the starts of the windows: the run's start state, moved with the base."""
        states = [State(values=self.start.values.copy(), time=begin) for begin, _ in self.windows]
        return [
            state if state.time == self.start.time else moving_with_base(self.system, self.motion, state) for state in states
        ]  # fmt: skip

    def at(self, step: float) -> list[_Pilot] | None:
        """Simulate all windows with one step; None, with the reason added to `failures`, if the step is too large."""
        began = perf_counter()
        if began - self.began + 2.0 * self.last > self.longest:  # half a step takes twice as long
            raise BudgetError(
                f"steps down to {2.0 * step:.2g} s are not fine enough, and finer ones take more than {self.longest:g} s of "
                "computing. Is the motion meant to be as large as that?"
            )
        several = len(self.windows) > 1 and self.engine != "mujoco" and not unsupported_run(self.system, self.motion)
        try:
            together = self._side_by_side(step) if several else None
            return together or [self._run_pilot(*each, step) for each in zip(self.starts, self.windows, strict=True)]
        except SimulationError as failure:
            self.failures.append(str(failure))
            return None
        finally:
            self.last = perf_counter() - began

    def times(self, halvings: int, duration: float) -> tuple[float, float]:
        """Estimate which fraction of the computing time of all trial runs has passed, and the time of the run [s].

        Each halving takes twice the time, and the step of the run is that of the last trial to twice it.
        """
        elapsed, trial = perf_counter() - self.began, self.last / sum(length for _, length in self.windows)
        return elapsed / (elapsed + self.last * (2.0 ** (halvings + 1) - 2.0)), trial * 2.0 ** (halvings - 0.5) * duration

    def _side_by_side(self, step: float) -> list[_Pilot] | None:
        """Simulate windows of equal length, which begin at samples, by the kernel side by side; None if it gave one up."""
        motions = [Later(self.motion, begin) for begin, _ in self.windows]
        grid = time_grid(
            start=0.0, duration=self.windows[0][1], sample_rate=self.sample_rate, timestep=step, motion=motions[0],
            corners=np.concatenate([motion.corners for motion in motions]),
        )  # fmt: skip
        rows = [self._samples(grid) for _ in motions]

        def sink(window: int, first: int, values: Array) -> None:
            rows[window][first : first + len(values)] = values

        done = run_in_lanes([self.system] * len(motions), motions, self.starts, grid, sink=sink)
        if why := next((outcome for outcome in done if isinstance(outcome, str)), ""):
            if why == WHY[WILD]:
                raise SimulationError(why)
            return None
        return [
            _pilot_of(self.system, outcome, kept)
            for outcome, kept in zip(done, rows, strict=True)
            if isinstance(outcome, RunResult)
        ]

    def _run_pilot(self, start: State, window: tuple[float, float], step: float) -> _Pilot:
        begin, length = window
        grid = time_grid(start=begin, duration=length, sample_rate=self.sample_rate, timestep=step, motion=self.motion)
        rows = self._samples(grid)

        def sink(first: int, values: Array) -> None:
            rows[first : first + len(values)] = values

        done = compute(self.system, self.motion, grid, start, engine=self.engine, callback="native", sink=sink)
        return _pilot_of(self.system, done, rows)

    def _samples(self, grid: TimeGrid) -> Array:
        return np.empty((grid.sample_times.size, self.system.model.nsensordata - self.system.assembly.sensor))


def _pilot_of(system: System, done: RunResult, rows: Array) -> _Pilot:
    """Keep of a trial run what steps are compared by: vectors over time, peaks, and whether contacts were active."""
    tables = system.assembly.tables
    judged = tables.tracked  # what is fixed to the base follows the motion, whatever the step
    names, peaks = [], []
    for entry in (entry for room in (done.peaks.bodies, done.peaks.points, done.peaks.mounts) for entry in room.values()):
        for kind, peak in vars(entry).items():
            names.append(kind)
            peaks.append(np.concatenate([[peak.value], peak.minimum, peak.maximum]))
    # Of geoms alone: with a mount's stop the error falls as it does without one.
    touches = any(contact.touches and not contact.mount for contact in (done.peaks.contacts or {}).values())
    return _Pilot(
        run=done, rows=rows, vectors=rows[:, tables.channels[judged, np.newaxis] + np.arange(3)], peaks=np.array(peaks)[judged],
        kinds=[names[i] for i in judged], touches=touches, hits=bool(done.peaks.struck),
    )  # fmt: skip


def _difference(coarse: list[_Pilot] | None, fine: list[_Pilot] | None) -> float:
    """Return the largest difference of samples and peaks between runs with two steps, relative to the peaks."""
    if coarse is None or fine is None:
        return np.inf
    kinds = np.array(fine[0].kinds)
    scale = np.max([pilot.peaks[:, 0] for pilot in fine], axis=0)
    for kind in set(fine[0].kinds):
        same = kinds == kind
        scale[same] = np.maximum(scale[same], max(SMALL * scale[same].max(), STILL.get(kind, 0.0)))
    scale = np.where(scale > 0.0, scale, 1.0)
    largest = 0.0
    for a, b in zip(coarse, fine, strict=True):
        samples = np.linalg.norm(a.vectors - b.vectors, axis=2).max(axis=0, initial=0.0)
        peaks = np.abs(a.peaks - b.peaks).max(axis=1)
        largest = max(largest, float((np.maximum(samples, peaks) / scale).max()))
    return largest if np.isfinite(largest) else np.inf
