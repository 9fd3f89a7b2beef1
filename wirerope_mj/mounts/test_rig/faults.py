"""Faults of a rig that a record shows: hum of the mains, a zero that drifts, a channel that lags, noise; each with its size."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.test_rig.reading import read_rows
from wirerope_mj.mounts.test_rig.turning import rms_noise

MAINS = (50.0, 60.0)
"""Frequencies at which hum is looked for [Hz]."""

_NEAR, _ASIDE = 0.6, 8.0  # Hz from a mains frequency: where its line is looked for, and where its neighbours are
_STANDS_OUT = 3.0  # times that a line is above the largest of its neighbours: harmonics of the test fall evenly
_LEAST = 1e-3  # of half of the force range, below which hum changes no parameter
_DRIFTS = 0.02  # of half of the force range over the record, from which a drift is named
_LAGS = 0.005  # of the period, from which a lag is named: the parabolas are up to 0.3 % off
_NOISY = 0.03  # of half of the force range, from which noise is named
_SURE = 4.0  # standard errors of a drift or a lag
_WINDOW = 0.06  # of the period, to either side of a turning point, within which the force is a parabola on each side
_LIKE = 0.1  # ratio by which cycles may differ and count as alike


@dataclass(frozen=True, kw_only=True)
class Hum:
    """A line of the mains in a force: frequency [Hz] and amplitude [N]."""

    frequency: float
    amplitude: float


def hum_in(time: Array, force: Array) -> Hum | None:
    """Return the largest line of the mains that stands out of a force's spectrum, None if none does.

    Args:
        time: instants [s], (n,), uniform to a thousandth of a step.
        force: (n,) [N].
    """
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

    def left(at: float) -> float:
        return -_line(time, force, at)[1]

    best = scipy.optimize.minimize_scalar(left, bounds=(frequency - spacing, frequency + spacing), method="bounded")
    return Hum(frequency=float(best.x), amplitude=-float(best.fun))


def _line(time: Array, force: Array, frequency: float) -> tuple[Array, float]:
    """Return the oscillation of a frequency in a force, beside what is slow, and its amplitude [N]."""
    angle = 2.0 * np.pi * frequency * (time - time[0])
    window = np.hanning(force.size)
    quiet = force - _slow(force, max(1, round(1.0 / (frequency * (time[1] - time[0])))))
    waves = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    parts = np.linalg.lstsq(waves * window[:, np.newaxis], quiet * window, rcond=None)[0]
    return waves @ parts, float(np.hypot(*parts))


def _slow(force: Array, period: int) -> Array:
    """Return the running mean over one period of the hum, which is without it; twice, so that what is straight stays."""
    mean = scipy.ndimage.uniform_filter1d(force, period, mode="nearest")
    return np.asarray(scipy.ndimage.uniform_filter1d(mean, period, mode="nearest"))


def without_hum(time: Array, force: Array, hum: Hum) -> Array:
    """Return a force without a line of the mains: a notch at its frequency alone, which bends nothing else."""
    return force - _line(time, force, hum.frequency)[0]


def record_faults(time: Array, deflection: Array, force: Array) -> Iterator[str]:
    """Yield a sentence for each fault that a record shows; none for a clean one.

    Args:
        time: instants [s], (n,).
        deflection: (n,) [m].
        force: (n,) [N].
    """
    half = 0.5 * float(np.ptp(force))
    hum = hum_in(time, force)
    if hum is not None:
        force = without_hum(time, force, hum)
        share = 100.0 * hum.amplitude / half
        yield (
            f"hum of {hum.amplitude:.3g} N at {hum.frequency:.4g} Hz, {share:.2g} % of half of the force range, was taken out "
            "by a notch at that frequency: look for a loop in the ground of the load cell"
        )
    tops = _tops(deflection)
    drift, error = _drift(time, deflection, force, tops)
    if abs(drift) > max(_SURE * error, _DRIFTS * half):
        yield (
            f"the zero of the force drifts by {drift:.3g} N over the record, {100.0 * abs(drift) / half:.2g} % of half of the "
            "force range; what is linear of it was taken out: let the load cell warm up"
        )
    lag, error, period = _lag(time, deflection, force, tops)
    if abs(lag) > max(_SURE * error, _LAGS * period):
        which = "force turns round after" if lag > 0.0 else "force turns round before"
        size = f"about {1e3 * abs(lag):.2g} ms, {100.0 * abs(lag) / period:.2g} % of a cycle"
        cause = "the force channel lags" if lag > 0.0 else "the deflection channel lags, or the device is viscous"
        yield (f"the {which} the deflection by {size}: {cause}; areas and damping of the loops are wrong by it")
    noise = rms_noise(force)
    if noise > _NOISY * half:
        yield f"noise of the force is {noise:.3g} N rms, {100.0 * noise / half:.2g} % of half of its range: average more cycles"


def _tops(deflection: Array) -> Array:
    """Return the samples at which the deflection is highest in a cycle."""
    smooth = scipy.ndimage.uniform_filter1d(deflection, 5)
    return scipy.signal.find_peaks(smooth, prominence=0.02 * float(np.ptp(deflection)))[0]


def _drift(time: Array, deflection: Array, force: Array, tops: Array) -> tuple[float, float]:
    """Return how far the mean force of like cycles goes over the whole record, and its standard error [N]."""
    runs: list[list[tuple[float, float, float, float]]] = [[]]
    for first, last in zip(tops[:-1], tops[1:], strict=True):
        inside = slice(first, last)
        size = float(np.ptp(deflection[inside]))
        if runs[-1] and abs(size - runs[-1][-1][2]) > _LIKE * runs[-1][-1][2]:
            runs.append([])
        runs[-1].append((float(time[inside].mean()), float(force[inside].mean()), size, float(last - first)))
    noise, weights, total = rms_noise(force), 0.0, 0.0
    for run in runs:
        later = np.array(run[1:])  # the way to the first still bends
        if len(later) >= 3:
            since = later[:, 0] - later[:, 0].mean()
            weight = float((since**2).sum() * later[:, 3].mean())  # over the noise's variance that of the slope
            weights, total = weights + weight, total + weight * float(since @ later[:, 1] / (since @ since))
    length = float(time[-1] - time[0])
    return (length * total / weights, length * noise / np.sqrt(weights)) if weights else (0.0, np.inf)


def _lag(time: Array, deflection: Array, force: Array, tops: Array) -> tuple[float, float, float]:
    """Return how much later than the deflection the force turns round at its largest strokes, standard error, period [s]."""
    bottoms = _tops(-deflection)
    if tops.size < 3 or bottoms.size < 3:
        return 0.0, np.inf, 1.0
    period = float(np.median(np.diff(time[tops])))
    step = float(time[-1] - time[0]) / (time.size - 1)
    width = max(6, round(_WINDOW * period / step))
    high, low = deflection[tops].max(), deflection[bottoms].min()
    turns = [(row, 1.0) for row in tops if deflection[row] > high - _LIKE * (high - low)]
    turns += [(row, -1.0) for row in bottoms if deflection[row] < low + _LIKE * (high - low)]
    whole = [(row, sign) for row, sign in turns if row >= width and row + width < time.size]
    if len(whole) < 4:
        return 0.0, np.inf, period
    places = np.concatenate([row + np.arange(-width, width + 1) for row, _ in whole]).reshape(len(whole), -1)
    instants = time[places] - time[[row for row, _ in whole]][:, np.newaxis]
    (later, error), (turned, _) = (_turn(instants, values[places], step) for values in (force, deflection))
    return later - turned, error, period


def _turn(instants: Array, values: Array, step: float) -> tuple[float, float]:
    """Return how long after the middle values turn round, (n_turns, n), all of them alike, and its standard error [s].

    On each side of that instant they are a parabola: a hysteretic force comes back steeper than it went.
    """

    def misfit(at: float) -> float:
        total = 0.0
        for since, one in zip(instants - at, values, strict=True):
            waves = np.stack([np.ones(since.size), np.minimum(since, 0.0) ** 2, np.maximum(since, 0.0) ** 2], axis=1)
            total += float(np.sum((waves @ np.linalg.lstsq(waves, one, rcond=None)[0] - one) ** 2))
        return total

    grid = np.linspace(0.7 * instants[0, 0], 0.7 * instants[0, -1], 57)
    costs = np.array([misfit(at) for at in grid])
    best = int(np.clip(costs.argmin(), 1, grid.size - 2))
    found = scipy.optimize.minimize_scalar(misfit, bounds=(grid[best - 1], grid[best + 1]), method="bounded")
    bend = (misfit(found.x + step) - 2.0 * found.fun + misfit(found.x - step)) / step**2
    variance = found.fun / max(values.size - 3 * len(values) - 1, 1)
    return float(found.x), float(np.sqrt(2.0 * variance / bend)) if bend > 0.0 else np.inf


def file_faults(path: Path) -> list[str]:
    """Return the faults of every record in a file, each beginning with its name; none where it says no time."""
    return [
        f"{path}: {text}"
        for samples in read_rows(path)
        if samples.time
        for text in record_faults(np.array(samples.time), np.array(samples.deflection), np.array(samples.force))
    ]
