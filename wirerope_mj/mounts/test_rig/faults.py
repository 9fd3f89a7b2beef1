"""Faults of a rig that a record shows: hum of the mains, drift of the zero, play, a channel that lags, noise; with sizes."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import duration_text
from wirerope_mj.mounts.test_rig.lag import lag_in
from wirerope_mj.mounts.test_rig.play import play_in
from wirerope_mj.mounts.test_rig.reading import read_rows
from wirerope_mj.mounts.test_rig.turning import Trace, find_turning_points, rms_noise

MAINS = (50.0, 60.0)  # Frequencies at which hum is looked for [Hz]
_NEAR, _ASIDE = 0.6, 8.0  # Hz from a mains frequency: where its line is looked for, and where its neighbours are
_STANDS_OUT = 3.0  # times that a line is above the largest of its neighbours: harmonics of the test fall evenly
_LEAST = 1e-3  # of half of the force range, below which hum changes no parameter
_DRIFTS = 0.02  # of half of the force range over the record, from which a drift is named
_LAGS = 0.0009  # of the period: a lag is named from 0.1 %, which is told to a tenth
_HIDDEN = 0.3  # of the period, times noise over half of the force range: a bend that noise hides is taken for as much lag
_NOISY = 0.03  # of half of the force range, from which noise is named
_SURE = 4.0  # standard errors of a drift or a lag
_LIKE = 0.1  # ratio by which strokes may differ and count as alike
_FEWEST_CYCLES = 4  # whole cycles of a run, of which the way to the first still bends


@dataclass(frozen=True, kw_only=True)
class Hum:
    """A line of the mains in a force: frequency [Hz] and amplitude [N]."""

    frequency: float
    amplitude: float


def hum_in(time: Array, force: Array) -> Hum | None:
    """Return the largest line of the mains in a force [N], (n,), at even instants [s] that stands out, None if none does."""
    if time.size < 3:
        return None
    step = float(time[-1] - time[0]) / (time.size - 1)
    if np.abs(np.diff(time) - step).max() > 1e-2 * step:  # a file's digits round instants
        return None
    values = (force - force.mean()) * np.hanning(force.size)
    frequency, size = np.fft.rfftfreq(force.size, step), np.abs(np.fft.rfft(values)) * 4.0 / force.size
    found = []
    for mains in MAINS:
        near = np.abs(frequency - mains) <= _NEAR
        aside = (np.abs(frequency - mains) <= _ASIDE) & (np.abs(frequency - mains) > 2.0 * _NEAR)
        if frequency[-1] < mains + _ASIDE or near.sum() < 3:
            continue
        line = float(size[near].max())
        if line > _STANDS_OUT * float(size[aside].max()) and line > _LEAST * 0.5 * float(np.ptp(force)):
            found.append(_refined(time, force, float(frequency[near][size[near].argmax()]), 1.0 / (step * force.size)))
    return max(found, key=lambda one: one.amplitude, default=None)


def _refined(time: Array, force: Array, frequency: float, spacing: float) -> Hum:
    """Return the line near a frequency that takes most out of the force."""
    best = scipy.optimize.minimize_scalar(
        lambda at: -_line(time, force, at)[1], bounds=(frequency - spacing, frequency + spacing), method="bounded"
    )
    return Hum(frequency=float(best.x), amplitude=-float(best.fun))


def _line(time: Array, force: Array, frequency: float) -> tuple[Array, float]:
    """Return the oscillation of a frequency in a force, beside what is slow, and its amplitude [N]."""
    angle = 2.0 * np.pi * frequency * (time - time[0])
    window = np.hanning(force.size)
    period = max(1, round(1.0 / (frequency * (time[1] - time[0]))))
    # The running mean over one period of the hum is without it; twice, so that what is straight stays.
    mean = scipy.ndimage.uniform_filter1d(force, period, mode="nearest")
    quiet = force - scipy.ndimage.uniform_filter1d(mean, period, mode="nearest")
    waves = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    parts = np.linalg.lstsq(waves * window[:, np.newaxis], quiet * window, rcond=None)[0]
    return waves @ parts, float(np.hypot(*parts))


def without_hum(time: Array, force: Array, hum: Hum) -> Array:
    """Return a force without a line of the mains: a notch at its frequency alone, which bends nothing else."""
    return force - _line(time, force, hum.frequency)[0]


@dataclass(frozen=True, kw_only=True)
class Checked:
    """Sentences on the faults of a rig that a record shows, and the least lag that it would have shown, over the period."""

    faults: list[str]
    least_lag: float  # NaN where no lag can be told


def checked_record(time: Array, deflection: Array, force: Array) -> Checked:
    """Look for faults in a record: instants [s], deflection [m], force [N], (n,) each; a clean one has none."""
    faults: list[str] = []
    half = 0.5 * float(np.ptp(force))
    hum = hum_in(time, force)
    if hum is not None:
        force = without_hum(time, force, hum)
        share = 100.0 * hum.amplitude / half
        faults.append(
            f"hum of {hum.amplitude:.3g} N at {hum.frequency:.4g} Hz, {share:.2g} % of half of the force range, was taken out "
            "by a notch at that frequency: look for a loop in the ground of the load cell"
        )
    drift, error = _drift(time, deflection, force)
    if abs(drift) > max(_SURE * error, _DRIFTS * half):
        faults.append(
            f"the zero of the force drifts by {drift:.3g} N over the record, {100.0 * abs(drift) / half:.2g} % of half of the "
            "force range; what is linear of it was taken out: let the load cell warm up"
        )
    play = play_in(time, deflection, force)
    if play is not None:
        faults.append(
            f"behind each reversal the force stands at one value over about {1e3 * play.width:.2g} mm and is stiff before and "
            f"behind it, in {play.strokes} strokes: play (backlash) in the device or its fixture. No law that is fitted here "
            "has a dead zone that goes with the reversal, so that none follows these loops: take up the play and test again"
        )
    lag = None if play else lag_in(time, deflection, force)  # with play they do not turn round together
    noise = rms_noise(force)
    least = max(_SURE * lag.error / lag.period, _LAGS, _HIDDEN * noise / max(half, 1e-300)) if lag else math.nan
    if lag is not None and abs(lag.delay) > least * lag.period:
        which = "force turns round after" if lag.delay > 0.0 else "force turns round before"
        share, doubt = 100.0 * abs(lag.delay) / lag.period, 100.0 * lag.error / lag.period
        size = f"about {duration_text(abs(lag.delay), 2)}, {share:.2g} +- {max(doubt, 0.01):.1g} % of a cycle"
        cause = "the force channel lags" if lag.delay > 0.0 else "the deflection channel lags, or the device is viscous"
        faults.append(
            f"the {which} the deflection by {size}: {cause}; the loss factor of the loops is wrong by about "
            f"{2.0 * np.pi * abs(lag.delay) / lag.period:.1g}, and so are the parameters that follow from their tips"
        )
    if noise > _NOISY * half:
        faults.append(
            f"noise of the force is {noise:.3g} N rms, {100.0 * noise / half:.2g} % of half of its range: average more cycles"
        )
    return Checked(faults=faults, least_lag=least)


def _drift(time: Array, deflection: Array, force: Array) -> tuple[float, float]:
    """Return how far the zero of the force goes over the whole record, and its standard error [N].

    Cycles are whole, from turning point to turning point between the samples. Their mean force fades, too, where a device
    forgets how it was loaded before, fastest in large cycles: so the largest ones count, others as far as they agree with them,
    and of a run no more than its later half shows.
    """
    if np.ptp(deflection) == 0.0:
        return 0.0, np.inf
    trace = find_turning_points(deflection, time)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(time))])
    noise, length = rms_noise(force), float(np.ptp(time))
    slopes = []
    for run in _runs(trace):
        begins = trace.times[run[0] : run[1] + 1 : 2]
        if begins.size < _FEWEST_CYCLES + 1:
            continue
        means = np.diff(np.interp(begins, time, work)) / np.diff(begins)
        middles = 0.5 * (begins[1:] + begins[:-1])
        count = np.searchsorted(time, begins[-1]) - np.searchsorted(time, begins[0])
        whole, late = (_line_through(middles[first:], means[first:]) for first in (1, max(1, means.size // 2)))
        # Samples err by noise, and where they are few by what lies between them, which shows in the means alone.
        each = max(noise / np.sqrt(count / means.size), whole[1])
        error = each / np.linalg.norm(middles[1:] - middles[1:].mean())
        slope = whole[0]
        if abs(late[0]) < abs(slope) - _SURE * error:
            slope = late[0] if late[0] * slope > 0.0 else 0.0
        slopes.append((float(np.mean(trace.strokes[run[0] : run[1]])), float(slope), float(error)))
    if not slopes:
        return 0.0, np.inf
    _, first, error = max(slopes)
    agreeing = [(s, e) for _, s, e in slopes if abs(s - first) <= _SURE * np.hypot(e, error)]
    weights = np.array([max(e, 1e-100) ** -2.0 for _, e in agreeing])
    mean = float(weights @ [s for s, _ in agreeing] / weights.sum())
    return length * mean, length / float(np.sqrt(weights.sum()))


def _runs(trace: Trace) -> list[tuple[int, int]]:
    """Return the first and the last turning point of every run of like strokes; the first and the last stroke are in none."""
    runs: list[tuple[int, int]] = []
    strokes = trace.strokes
    for index in range(1, strokes.size - 1):
        if runs and abs(strokes[index] - strokes[index - 1]) <= _LIKE * strokes[index]:
            runs[-1] = (runs[-1][0], index + 1)
        else:
            runs.append((index, index + 1))
    return runs


def _line_through(time: Array, values: Array) -> tuple[float, float]:
    """Return the slope of the straight line through values, and what they scatter about it by."""
    since = time - time.mean()
    slope = float(since @ values / (since @ since))
    left = values - values.mean() - slope * since
    return slope, float(np.sqrt(left @ left / max(values.size - 2, 1)))


def checked_file(path: Path) -> Checked:
    """Look for faults in every record of a file, each named with it; none are told where it says no time."""
    records = [one for one in read_rows(path) if one.time]
    each = [checked_record(np.array(one.time), np.array(one.deflection), np.array(one.force)) for one in records]
    faults = [f"{path}: {text}" for one in each for text in one.faults]
    return Checked(
        faults=faults, least_lag=max((one.least_lag for one in each if not math.isnan(one.least_lag)), default=math.nan)
    )
