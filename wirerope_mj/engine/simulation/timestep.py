"""Choosing the step before the run: pilots of the same system and motion, halved until samples and peaks agree."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.simulation.engines import Engine, compute
from wirerope_mj.engine.simulation.grid import time_grid
from wirerope_mj.engine.simulation.initial import moving_with_base
from wirerope_mj.engine.simulation.stability import eigenvalues, stable_step
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import BaseMotion

HALVINGS = 11
"""Halvings after which the search ends: 1e-3 s becomes 5e-7 s."""

HALVINGS_IN_CONTACT = 4
"""The same where bodies touch: an impact's error falls slowly and irregularly, so the error reached is reported instead."""

LUCK = 2
"""Halvings before which errors in contact say little: where in a step the touch falls is luck."""

ENOUGH_IN_CONTACT = 1e-3
"""Error aimed at where bodies touch and the accuracy asked for is out of reach: no stop is known better than that."""

SAMPLES, STABILITY, DURATION = "the sample interval", "the stability of the stiffest mount", "the duration"
CORNERS = "the corners of the motion, such as the samples of a record"
ACCURACY, GIVEN = "the accuracy asked for", "the timestep asked for"
CONTACTS = "contacts, where finer steps bring too little"
"""Limits of a step."""

RICHARDSON = 4.0 / 3.0
"""Error of the coarser of two runs from their difference at order 2, the order that reversals of the mounts leave to RK4."""

SMALL = 1e-3
"""Quantities smaller than this fraction of the largest of their kind are judged against that fraction."""

STILL = {"acceleration": 1e-6}
"""Peaks below which a quantity rests [m/s^2]: what an equilibrium's rounding leaves is 1e-10, and no step makes it smaller."""

PILOT_PERIODS = 6.0
"""Slowest periods after the motion's last corner that a pilot covers: the largest peaks lie within them."""

WINDOWS = 6
"""Pilots of a motion too long to be tried whole."""

WINDOWED = 0.5
"""Fraction of the accuracy that windows must keep: between them the error was seen to be up to 1.7 times theirs."""


@dataclass(frozen=True, kw_only=True)
class ChosenStep:
    """A step [s], the error estimated for it, relative to the peaks, and what keeps it from being longer."""

    timestep: float
    error: float
    limited_by: str


def limit_of_given(timestep: float, sample_rate: float) -> str:
    """Return what limits the steps where `timestep` [s] was given: samples are ends of steps as well."""
    return GIVEN if timestep <= 1.0 / sample_rate else SAMPLES


def choose_timestep(
    system: System,
    motion: BaseMotion,
    start: State,
    *,
    duration: float,
    sample_rate: float,
    accuracy: float,
    engine: Engine = "auto",
) -> ChosenStep:
    """Return the largest step of a halving series whose pilots keep samples and refined peaks within `accuracy`.

    The series starts at the sample interval or the stability limit, whichever is shorter. A pilot is the run itself if that
    is short, else windows of it that start from `start`. Where bodies touch, `accuracy` may not be reached: refining ends as
    soon as that shows, and the error says what was reached.
    """
    windows = _windows(system, motion, start, duration)
    step, limit = min((1.0 / sample_rate, SAMPLES), (stable_step(system), STABILITY), (duration, DURATION))
    between = _step_between_corners(motion, windows, sample_rate, step)
    step, limit = (between, CORNERS) if between < step else (step, limit)

    failures: list[str] = []
    pilots = partial(_pilots, system, motion, start, windows, sample_rate, engine, failures)
    wanted = accuracy if len(windows) == 1 else WINDOWED * accuracy
    coarse = pilots(step)
    in_contact: list[ChosenStep] = []
    for halving in range(HALVINGS):
        fine = pilots(step / 2.0)
        error = RICHARDSON * _difference(coarse, fine)
        touches = fine is not None and any(pilot.touches for pilot in fine)
        if error <= wanted:
            longer = _longer(pilots, fine, step, error, wanted) if halving else None
            return longer or ChosenStep(timestep=step, error=error, limited_by=ACCURACY if halving else limit)
        if touches:
            in_contact.append(ChosenStep(timestep=step, error=error, limited_by=CONTACTS))
            if halving >= LUCK and not _pays(error, halving, wanted):
                return _best(in_contact)
        step, coarse = step / 2.0, fine
    if coarse is None:
        raise SimulationError(f"the run fails at every step down to {step:.3g} s: {failures[-1]}")
    raise SimulationError(
        f"no step down to {step:.3g} s keeps samples and peaks within {accuracy:.3g} of the peaks; the last error was "
        f"{error:.3g}. Ask for less (a larger `accuracy`), or give the `timestep`."
    )


def _longer(
    pilots: Callable[[float], "list[_Pilot] | None"],
    fine: "list[_Pilot] | None",
    step: float,
    error: float,
    wanted: float,
) -> ChosenStep | None:
    """Return a step between `step` and its double, which failed, if it is accurate enough: order 2 says where to look."""
    factor = min(1.9, 0.9 * np.sqrt(wanted / error)) if error > 0.0 else 1.0
    if factor <= 1.15:
        return None
    longer = _difference(pilots(factor * step), fine) * factor**2 / (factor**2 - 0.25)
    return ChosenStep(timestep=factor * step, error=longer, limited_by=ACCURACY) if longer <= wanted else None


def _pays(error: float, halving: int, wanted: float) -> bool:
    """Return whether halving the step further will do in contact, where an error falls with order 1 at best.

    Either it brings the accuracy that is wanted within the halvings that are left, or, where that is out of reach, one that
    is enough and not reached yet.
    """
    in_reach = error / 2.0 ** (HALVINGS_IN_CONTACT - halving)
    return in_reach <= wanted or in_reach <= ENOUGH_IN_CONTACT < error


def _best(tried: list[ChosenStep]) -> ChosenStep:
    """Return the step of the least error; what finer ones differ by, if it is more, counts as its error."""
    errors = [step.error for step in tried]
    least = errors.index(min(errors))
    return replace(tried[least], error=max(errors[least:]))


def _step_between_corners(
    motion: BaseMotion, windows: list[tuple[float, float]], sample_rate: float, step: float
) -> float:
    """Return the usual step of a motion whose corners cut most of its steps short, as a record's samples do, or `step`.

    To halve a longer one would change nothing, and the error would be taken for none.
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


def _windows(system: System, motion: BaseMotion, start: State, duration: float) -> list[tuple[float, float]]:
    """Return starts and lengths [s] of the pilots."""
    rates = np.abs(eigenvalues(system))
    slowest = 2.0 * np.pi / max(float(rates[rates > 1.0].min(initial=60.0)), 6.0)  # from 1 Hz up: no pilot of minutes
    length = PILOT_PERIODS * slowest
    begin, end = start.time, start.time + duration
    over = min(max(motion.end, begin), end)
    if over - begin <= (WINDOWS - 1) * length:
        return [(begin, min(over + length, end) - begin)]
    # Geometric spacing follows a logarithmic sweep; the last window ends with the motion.
    starts = begin + (over - length - begin) * np.geomspace(1.0, 2.0**WINDOWS, WINDOWS) / 2.0**WINDOWS
    starts[0] = begin
    return [(float(instant), length) for instant in starts]


@dataclass(frozen=True, kw_only=True)
class _Pilot:
    vectors: Array  # accelerations, displacements, deflections and forces over time, (n_t, n_channels, 3)
    peaks: Array  # value, minimum and maximum of every channel, (n_channels, 7)
    kinds: list[str]
    touches: bool  # whether a contact of geoms was active


def _pilots(
    system: System, motion: BaseMotion, start: State, windows: list[tuple[float, float]], sample_rate: float,
    engine: Engine, failures: list[str], step: float,
) -> list[_Pilot] | None:  # fmt: skip
    """Return the pilots of all windows with one step; None, and the reason in `failures`, where it was too large."""
    try:
        return [_pilot(system, motion, start, window, sample_rate, engine, step) for window in windows]
    except SimulationError as failure:
        failures.append(str(failure))
        return None


def _pilot(
    system: System, motion: BaseMotion, start: State, window: tuple[float, float], sample_rate: float, engine: Engine,
    step: float,
) -> _Pilot:  # fmt: skip
    begin, length = window
    grid = time_grid(start=begin, duration=length, sample_rate=sample_rate, timestep=step, motion=motion)
    judged = system.assembly.tables.tracked  # what is fixed to the base follows the motion, whatever the step
    channels = system.assembly.tables.channels[judged]
    history = np.empty((grid.sample_times.size, channels.size, 3))

    def sink(first: int, values: Array) -> None:
        history[first : first + len(values)] = values[:, channels[:, None] + np.arange(3)]

    at_begin = State(values=start.values.copy(), time=begin)
    if begin != start.time:
        at_begin = moving_with_base(system, motion, at_begin)
    done = compute(system, motion, grid, at_begin, engine=engine, callback="native", sink=sink)
    names, rows = _peak_rows(done.peaks)
    # Of geoms alone: with a mount's stop the error falls as it does without one.
    touches = any(contact.touches and not contact.mount for contact in (done.peaks.contacts or {}).values())
    return _Pilot(vectors=history, peaks=rows[judged], kinds=[names[i] for i in judged], touches=touches)


def _peak_rows(peaks: Peaks) -> tuple[list[str], Array]:
    kinds, rows = [], []
    for room in (peaks.bodies, peaks.points, peaks.mounts):
        for entry in room.values():
            for kind in entry.__dataclass_fields__:
                peak = getattr(entry, kind)
                kinds.append(kind)
                rows.append(np.concatenate([[peak.value], peak.minimum, peak.maximum]))
    return kinds, np.array(rows)


def _difference(coarse: list[_Pilot] | None, fine: list[_Pilot] | None) -> float:
    """Return the largest difference of samples and peaks relative to the peaks over all pilots."""
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
