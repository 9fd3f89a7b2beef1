"""Sampled histories between their samples, by cubics where the rate is known at them, and the error of these cubics.

Between two samples stands the cubic that has the values and rates of both (Hermite). Where a cubic over two intervals misses
the sample in between, by m, those over single intervals miss the history by m / 16 where it is smooth, and by m / 4 where its
second derivative jumps, as friction and pulses let it. Samples that are too few for a history give themselves away so: their
rates do not fit what other samples say.
"""

import numpy as np

from wirerope_mj.foundation.arrays import Array

# Error of a cubic over one interval, over the misfit of that over two: with a second derivative that jumps.
_OF_MISFIT = 0.25


# Samples to a period of the mean frequency, rms of the rates over 2 pi that of the values, below which cubics tell nothing.
_LEAST = 4.0
# Error, as a fraction of the range, above which a cubic's extreme says nothing, and the samples alone count.
_TRUSTED = 0.01


def sample_rate(time: Array) -> float:
    """Return the rate of uniform samples [Hz], from their instants [s]; 0 for one alone."""
    return (time.size - 1) / float(time[-1] - time[0]) if time.size > 1 else 0.0


def path(values: Array, rates: Array, spacing: float) -> tuple[Array, Array]:
    """Return samples, (n,), and extremes of the cubics between them in their order, and where they are, in samples."""
    start, step = values[:-1], np.diff(values)
    slope, other = spacing * rates[:-1], spacing * rates[1:]
    square, cube = 3.0 * step - 2.0 * slope - other, slope + other - 2.0 * step
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
    return np.pad(_OF_MISFIT * np.abs(middle - values[1:-1]), 1, mode="edge")


def peak_between(time: Array, values: Array, rates: Array) -> tuple[float, float, float]:
    """Return the largest value, its instant [s], and by how much the history may be above it; never more than it reached."""
    if values.size < 2:
        return float(values[0]), float(time[0]), np.inf
    spacing = 1.0 / sample_rate(time)
    reached, places = path(values, rates, spacing)
    k = int(reached.argmax())
    error = misfit(values, rates, spacing)
    beside = np.minimum(places.astype(np.int64), values.size - 2)
    if np.std(rates) * _LEAST * spacing > 2.0 * np.pi * np.std(values):
        k = int(values.argmax())
        return float(values[k]), float(time[k]), np.inf
    highest = float((reached + np.maximum(error[beside], error[beside + 1])).max())
    if highest - reached[k] > _TRUSTED * np.ptp(values):
        k = int(np.searchsorted(places, values.argmax()))
    return float(reached[k]), float(time[0] + places[k] * spacing), highest - float(reached[k])


def parabolas(values: Array) -> Array:
    """Return samples (n,), whose turning points are those of the parabolas through three of them."""
    refined = values.copy()
    before, here, after = values[:-2], values[1:-1], values[2:]
    turns = (here - before) * (after - here) < 0.0
    bend = np.where(turns, before - 2.0 * here + after, 1.0)
    refined[1:-1] -= np.where(turns, 0.125 * (before - after) ** 2 / bend, 0.0)
    return refined
