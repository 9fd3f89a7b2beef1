"""Sampled histories of a run: columns, extremes at and between the samples, and the interval in which a base is steady.

Between two samples stands the cubic that has the values and rates of both (Hermite). Where a cubic over two intervals misses
the sample in between, by m, those over single intervals miss the history by m / 16 where it is smooth, and by m / 4 where its
second derivative jumps, as with friction and pulses. So samples that are too few for a history can be recognised: their rates
do not fit the other samples.
"""

import math
from collections.abc import Iterator

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import RandomVibration, motion_from_dict

SAMPLED = "sampled at"  # Beginning of the notes on values that are not judged because samples are too few


def read_columns(response: Response, first: str, count: int) -> Array:
    """Read `count` columns from the one named `first` on, (n_t, count).

    They are not kept in the response: of a long response in a file only the columns in use are in memory.
    """
    column = response.samples.names.index(first)
    return response.samples.columns(column, column + count)


def read_start(response: Response, first: str) -> Array:
    """Read the first sample of the vector whose columns begin with the one named `first`, (3,)."""
    column = response.samples.names.index(first)
    return next(iter(response.samples.blocks(column, column + 3)))[0]


def sampled_text(time: Array) -> str:
    return f"{SAMPLED} {sample_rate(time):.4g} Hz"


def samples_hold(response: Response) -> str:
    """Describe the resolution of a run's samples: the highest frequency they show, and the part of a peak they miss."""
    rate, worst, of_what = sample_rate(response.time), 0.0, ""
    for kind, peaks in (("bodies", response.peaks.bodies), ("points", response.peaks.points)):
        for name, peak in peaks.items():
            acceleration = read_columns(response, f"{kind}/{name}/acceleration/x", 3)
            reached = sampled_peak(response.time, np.linalg.norm(acceleration, axis=1))[0]
            missed = 1.0 - reached / peak.acceleration.value if peak.acceleration.value > AT_REST else 0.0
            worst, of_what = max((worst, of_what), (missed, name))
    text = f"{rate:.4g} samples a second tell nothing above {0.5 * rate:.4g} Hz, and shapes up to a tenth of their rate"
    return text + (f"; they miss {100.0 * worst:.2g} % of the peak acceleration of {of_what}" if worst > _MISSED else "")


AT_REST = 1e-3 * STANDARD_GRAVITY  # Acceleration below which something rests [m/s^2]
_MISSED = 0.01  # missed fraction of a peak from which it is reported


def sampled_peak(time: Array, values: Array) -> tuple[float, float]:
    """Find the largest of `values` (n,) and its instant [s] by the parabola through the samples beside it."""
    k = int(values.argmax())
    if 0 < k < values.size - 1:
        before, top, after = values[k - 1 : k + 2].tolist()
        bend = before - 2.0 * top + after
        if bend < 0.0:
            shift = 0.5 * (before - after) / bend
            return top - 0.25 * (before - after) * shift, float(time[k] + shift * (time[k + 1] - time[k]))
    return float(values[k]), float(time[k])


# Kinds of motions that go on steadily.
STEADY = frozenset({"sweep", "sine", "ship-motion", "vibration-lines", "harmonic-force", "unbalance"})


def steady_interval(motion: Entries) -> tuple[bool, float, float]:
    """Check whether a motion is random vibration alone, and find the interval [s] in which all random vibration is stationary.

    Without any random vibration these are minus and plus infinity. Files of records are not read.
    """
    parts = list(elements(motion))
    random = [motion_from_dict(part) for part in parts if part.get("kind") == RandomVibration.kind]
    intervals = [motion.steady for motion in random if isinstance(motion, RandomVibration)]
    first = max((interval[0] for interval in intervals), default=-math.inf)
    last = min((interval[1] for interval in intervals), default=math.inf)
    return bool(parts) and len(intervals) == len(parts), first, last


# Field that holds the duration of a blow, by the kind of its motion; a blow without one changes the base's velocity at once
DURATION_FIELDS = {
    "velocity-step": "", "drop": "", "rotational-drop": "", "shock-table-impact": "pulse_duration",
    "decaying-sine": "impact_duration",
}  # fmt: skip


def has_peak(stored: Entries) -> bool:
    """Tell whether a stored motion's acceleration has a peak: not with a steady sine or a velocity step in it."""

    def is_sudden(part: Entries) -> bool:
        return part.get("kind") in DURATION_FIELDS and not part.get(DURATION_FIELDS[part["kind"]])

    return not any(part.get("kind") in STEADY or is_sudden(part) for part in elements(stored))


def elements(stored: Entries) -> Iterator[Entries]:
    """Yield the elementary motions that a stored motion adds, scales and turns."""
    inner = [*stored.get("terms", ()), *([stored["motion"]] if "motion" in stored else ())]
    if not inner:
        yield stored
    for part in inner:
        yield from elements(part)


# Error of a cubic over one interval, over the misfit of that over two: with a second derivative that jumps.
_ERROR_OF_MISFIT = 0.25


# Least samples to a period of the mean frequency, rms of the rates over 2 pi that of the values, for cubics to be used.
_LEAST_PER_PERIOD = 4.0
# Error, as a fraction of the range, above which a cubic's extreme is not used, and the samples alone count.
_LARGEST_ERROR = 0.01


def sample_rate(time: Array) -> float:
    """Rate of uniform samples [Hz], from their instants [s]; 0 for a single sample."""
    return (time.size - 1) / float(time[-1] - time[0]) if time.size > 1 else 0.0


def path(values: Array, rates: Array, spacing: float) -> tuple[Array, Array]:
    """List the samples, (n,), and the extremes of the cubics between them in order, and their positions [samples]."""
    start, step = values[:-1], np.diff(values)
    slope, last = spacing * rates[:-1], spacing * rates[1:]
    square, cube = 3.0 * step - 2.0 * slope - last, slope + last - 2.0 * step
    # Roots of the derivative, slope + 2 square s + 3 cube s^2, without the loss of digits of the usual formula.
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -(square + np.copysign(np.sqrt(square * square - 3.0 * cube * slope), square))
        roots = np.sort([q / (3.0 * cube), slope / q], axis=0)
    inside = (roots > 0.0) & (roots < 1.0)
    roots = np.where(inside, roots, np.nan)
    between = start + roots * (slope + roots * (square + roots * cube))
    numbers = np.arange(start.size)
    places = np.append(np.column_stack([numbers, numbers + roots[0], numbers + roots[1]]).ravel(), start.size)
    reached = np.append(np.column_stack([start, between[0], between[1]]).ravel(), values[-1])
    known = np.isfinite(reached)
    return reached[known], places[known]


def misfit(values: Array, rates: Array, spacing: float) -> Array:
    """Estimate the error of the cubics beside each sample, (n,), in units of the history; infinite below three samples."""
    if values.size < 3:
        return np.full(values.size, np.inf)
    middle = 0.5 * (values[:-2] + values[2:]) + 0.25 * spacing * (rates[:-2] - rates[2:])
    return np.pad(_ERROR_OF_MISFIT * np.abs(middle - values[1:-1]), 1, mode="edge")


def peak_between(time: Array, values: Array, rates: Array) -> tuple[float, float, float]:
    """Find the largest value at or between samples, its instant [s], and the most by which the history may exceed it."""
    if values.size < 2:
        return float(values[0]), float(time[0]), np.inf
    spacing = 1.0 / sample_rate(time)
    reached, places = path(values, rates, spacing)
    k = int(reached.argmax())
    error = misfit(values, rates, spacing)
    beside = np.minimum(places.astype(np.int64), values.size - 2)
    if np.std(rates) * _LEAST_PER_PERIOD * spacing > 2.0 * np.pi * np.std(values):
        k = int(values.argmax())
        return float(values[k]), float(time[k]), np.inf
    highest = float((reached + np.maximum(error[beside], error[beside + 1])).max())
    if highest - reached[k] > _LARGEST_ERROR * np.ptp(values):
        k = int(np.searchsorted(places, values.argmax()))
    return float(reached[k]), float(time[0] + places[k] * spacing), highest - float(reached[k])


def parabolas(values: Array) -> Array:
    """Replace each turning point of samples (n,) by the vertex of the parabola through it and its neighbours."""
    refined = values.copy()
    before, middle, after = values[:-2], values[1:-1], values[2:]
    turns = (middle - before) * (after - middle) < 0.0
    bend = np.where(turns, before - 2.0 * middle + after, 1.0)
    refined[1:-1] -= np.where(turns, 0.125 * (before - after) ** 2 / bend, 0.0)
    return refined
