"""The mean of cycles at equal phases, through their turning points.

A mean over samples on both sides of a turning point lies below it, that of a triangle by an eighth of the way that the samples
cover, and its energy with it. Here either side goes to the turning point by a parabola of its own, which fits a sine, a
triangle and a hold alike.
"""

from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.mounts.test_rig.passive import require_area, require_passive
from wirerope_mj.mounts.test_rig.turning import RecordedLoop, Trace

REACH = 0.03  # Fraction of a cycle on either side: a sine is a parabola there to 1e-4 of its amplitude
BINS = 3.0  # Bins on either side at least, so that three samples of it give a parabola


def reach_of(bins: int) -> float:
    """Return the fraction of a cycle on either side of a turning point that a parabola is fitted to, for a number of bins."""
    return max(REACH, BINS / bins)


def tip_of(distance: Array, deflection: Array, force: Array) -> tuple[float, float]:
    """Fit deflection [m] and force [N] at a turning point to samples, (n,) each; before it distances are negative.

    The deflection takes the same parabola over the phase to both sides; the force one parabola over the deflection before the
    turning point and another behind it, which meet there.
    """
    tip = _value_at_tip([np.abs(distance), distance**2], deflection)
    before, after = (np.where(side, deflection - tip, 0.0) for side in (distance < 0.0, distance > 0.0))
    return tip, _value_at_tip([before, before**2, after, after**2], force)


def _value_at_tip(terms: list[Array], values: Array) -> float:
    """Fit the value at the turning point by least squares, beside terms that vanish there."""
    mean = float(values.mean())
    matrix = np.stack([np.ones(values.size), *terms], axis=1)
    sizes = np.maximum(np.abs(matrix).max(axis=0), 1e-300)
    return mean + float(np.linalg.lstsq(matrix / sizes, values - mean, rcond=None)[0][0])


# Samples of a loop: chords then lose 2e-4 of its area, and a fit does not slow down with the rate of the acquisition.
POINTS = 200
_FEWEST_AT_TIP = 3  # samples that a parabola at a turning point takes
_AT_TIP = 0.05  # of a bin, within which samples stand at a turning point: a chord to the next loses 1e-4 of a stroke


@dataclass(frozen=True)
class PhasedCycle:
    """Samples of one cycle and their phases."""

    samples: Integers  # their indices in the record, (n,)
    phase: Array  # of each, 0 to 1; in a run 0.5 is the turning point between, (n,)
    tips: tuple[float, ...]  # phases of turning points that are not samples themselves
    middle: float = 0.5  # time of phase 0.5 over the period

    def of(self, values: Array) -> Array:
        """Interpolate a series of the record at `POINTS` even phases of the cycle."""
        return np.interp(np.arange(POINTS) / POINTS, self.phase, values[self.samples])

    def elapsed(self, phase: Array) -> Array:
        return np.interp(phase, [0.0, 0.5, 1.0], [0.0, self.middle, 1.0])

    def mean(self, values: Array) -> float:
        return float(np.interp(np.arange(POINTS) / POINTS, self.elapsed(self.phase), values[self.samples]).mean())


def cycle_to(trace: Trace, end: int) -> PhasedCycle:
    """Cut the cycle that ends at a turning point, given by its number, out of a record."""
    bounds = trace.times[end - 2 : end + 1]
    inside = np.flatnonzero((trace.time >= bounds[0]) & (trace.time <= bounds[2]))
    middle = float((bounds[1] - bounds[0]) / (bounds[2] - bounds[0]))
    return PhasedCycle(inside, np.interp(trace.time[inside], bounds, [0.0, 0.5, 1.0]), tips=(0.0, 0.5), middle=middle)


def whole_record(trace: Trace) -> PhasedCycle:
    """Take a record for one cycle; its last sample repeats the first or stands one step before it."""
    x, samples = trace.deflection, trace.time.size
    steps = np.abs(np.diff(x))
    repeated = abs(float(x[-1] - x[0])) <= 0.5 * min(steps[0], steps[-1])
    span = 1.0 if repeated else (samples - 1) / samples
    elapsed, turning = (span * (t - trace.time[0]) / np.ptp(trace.time) for t in (trace.time, trace.times[1:-1]))
    if samples <= POINTS + 1:
        return PhasedCycle(np.arange(samples), elapsed, tips=())
    # Turning points where bins have their middle, as those of a run.
    tips = np.round(turning * POINTS) / POINTS
    phase = np.interp(elapsed, [0.0, *turning, 1.0], [0.0, *tips, 1.0])
    return PhasedCycle(np.arange(samples), phase, tips=(*tips.tolist(), *([0.0] if tips.size == 1 else [])))


def mean_loop(
    cycles: list[PhasedCycle], x: Array, f: Array, count: int, gap: float, location: str, *, stop: bool = False
) -> RecordedLoop:
    """Average cycles over bins of phase, whose first and last bin are the same; `count` cycles were run.

    Deflections x [m] and forces f [N] without drift are those of the record, (n_t,); `gap` is that between the forces at the
    ends of the last cycle [N]. `location` says where the cycles stand; a bump stop need not have force or area.
    """
    phase = np.concatenate([cycle.phase for cycle in cycles])
    bins = min(POINTS, *(round((cycle.phase.size - 1) / np.ptp(cycle.phase)) for cycle in cycles))
    bins -= bins % 2 if cycles[0].tips else 0  # half a cycle after the first turning point is a bin's middle too
    numbers = _bin(phase, bins)
    filled = np.bincount(numbers, minlength=bins)
    # Forces about the mean of their cycle, so that a bin which one cycle passes by does not stand apart.
    levels = [cycle.mean(f) for cycle in cycles]
    path = [x[cycle.samples] for cycle in cycles]
    force = [f[cycle.samples] - level for cycle, level in zip(cycles, levels, strict=True)]
    means = [_mean_over_bins(cycles, values, bins) for values in (path, force)]
    for tip in cycles[0].tips:
        distance, index = (phase - tip + 0.5) % 1.0 - 0.5, round(tip * bins) % bins
        if filled[index] and np.abs(distance[numbers == index]).max() < _AT_TIP / bins:
            continue
        near = np.abs(distance) <= reach_of(bins)
        if near.sum() < _FEWEST_AT_TIP:
            raise ValueError(
                f"{location}: at a turning point of the cycle there are {near.sum()} samples within {reach_of(bins):.2g} of "
                "its period: are rows missing there? Leave the loop out, or repeat it."
            )
        ends = tip_of(distance[near], np.concatenate(path)[near], np.concatenate(force)[near])
        means[0][index], means[1][index] = ends
        filled[index] += 1
    mean_x, mean_f = (mean[filled > 0] for mean in means)
    mean_f += np.mean(levels)
    loop = RecordedLoop.from_samples(np.append(mean_x, mean_x[0]), np.append(mean_f, mean_f[0]), cycles=count)
    assert isinstance(loop, RecordedLoop)
    if len(cycles) > 1:  # standard deviation from cycle to cycle, as it is left in their mean
        shown = [np.bincount(_bin(cycle.phase, bins), minlength=bins) > 0 for cycle in cycles]
        each = [_mean_over_bins([cycle], [values], bins) for cycle, values in zip(cycles, force, strict=True)]
        variance = np.stack(each)[:, np.all(shown, axis=0)].var(axis=0, ddof=1)
        loop = replace(loop, scatter=float(np.sqrt(variance.mean() / len(cycles))) if variance.size else 0.0)
    require_passive(loop, location, stop=stop)
    if not stop:
        require_area(loop, location)
    elapsed = np.mean([cycle.elapsed(np.flatnonzero(filled) / bins) for cycle in cycles], axis=0)
    return replace(loop, closure=gap / max(float(np.ptp(mean_f)), 1e-300), elapsed=np.append(elapsed, 1.0))


def _bin(phase: Array, bins: int) -> Integers:
    return np.floor(phase * bins + 0.5).astype(np.int64) % bins


def _mean_over_bins(cycles: list[PhasedCycle], values: list[Array], bins: int) -> Array:
    """Average the cycles' means over bins, with equal weights, (bins,); 0 where no cycle has a sample."""
    sums, counts = np.zeros(bins), np.zeros(bins)
    for cycle, series in zip(cycles, values, strict=True):
        numbers = _bin(cycle.phase, bins)
        filled = np.bincount(numbers, minlength=bins)
        sums += np.bincount(numbers, series, bins) / np.maximum(filled, 1)
        counts += filled > 0
    return sums / np.maximum(counts, 1.0)
