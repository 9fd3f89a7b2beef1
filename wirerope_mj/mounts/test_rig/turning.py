"""Turning points of a noisy deflection, and the loop cut from a long record with the turning points before it."""

from dataclasses import dataclass, field

import numpy as np

from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.mounts.laws import Loop

_SURE = 8.0  # standard deviations of noise: samples of one stroke differ by more once in 1e8 pairs
_SMALLEST = 0.01  # of the range: smaller movements are the rig's, not the test's
_SMOOTHED = 8  # samples of the shortest stroke for one of the window: a sine loses less than 1 % of its amplitude
_DEPTH = 0.15  # of a stroke below its end, where a sine is steep enough for its crossings to be sharp


@dataclass(frozen=True, kw_only=True)
class Trace:
    """Recorded deflection, smoothed, with its turning points."""

    time: Array  # of the samples, (n_t,)
    deflection: Array  # as recorded [m], (n_t,)
    smooth: Array  # the same, smoothed [m], (n_t,)
    window: int  # samples that were averaged
    noise: float  # standard deviation of the deflection's noise [m]
    # samples of the turning points, (n,), the record's first and last sample among them; empty if it never moves
    turns: Integers
    times: Array  # of the turning points, (n,), between the crossings on both sides and so sharper than the samples

    @property
    def smooth_noise(self) -> float:
        """Standard deviation of the noise that is left in `smooth` [m]."""
        return self.noise / np.sqrt(self.window)

    @property
    def strokes(self) -> Array:
        return np.abs(np.diff(self.smooth[self.turns]))

    @property
    def raw_turning(self) -> Array:
        """Farthest recorded deflections at the turning points [m], (n,): smoothing cuts those at the end of a ramp off."""
        padded = np.pad(self.deflection, self.window, "edge")
        around = np.lib.stride_tricks.sliding_window_view(padded, 2 * self.window + 1)
        rising = np.diff(self.smooth[self.turns], prepend=self.smooth[self.turns[1]]) > 0.0
        return np.where(rising, around[self.turns].max(axis=1), around[self.turns].min(axis=1))

    def smoothed(self, values: Array) -> Array:
        return _smoothed(values, self.window)


def find_turning_points(deflection: Array, time: Array) -> Trace:
    """Find where a deflection [m], (n_t,), turns round: reversals by more than the noise and 1 % of the range.

    A first pass over the raw samples finds the shortest stroke, a second over the deflection smoothed over an eighth of it
    finds the small ones beside the noise. The time of each is in the middle between the crossings of one depth on both sides,
    which noise hardly shifts. The deflection is not constant, and time increases, (n_t,).
    """
    noise, least = rms_noise(deflection), _SMALLEST * float(np.ptp(deflection))
    turns = _reversals(deflection, max(_SURE * noise, least))
    window = max(int(np.diff(turns).min()) // _SMOOTHED, 1) if turns.size > 1 else 1
    smooth = _smoothed(deflection, window)
    turns = _reversals(smooth, max(_SURE * noise / np.sqrt(window), least))

    def crossing(sample: int, level: float) -> float:
        """Time at which the deflection crosses a level between a sample and the next."""
        fraction = (level - smooth[sample]) / (smooth[sample + 1] - smooth[sample])
        return float(time[sample] + fraction * (time[sample + 1] - time[sample]))

    times = time[turns].astype(np.float64)
    for index in range(1, turns.size - 1):
        before, turn, after = (int(sample) for sample in turns[index - 1 : index + 2])
        sign = 1.0 if smooth[turn] > smooth[before] else -1.0
        # At one depth in all cycles of a run, also where its last stroke is cut short: else a wave that rises faster than
        # it falls would shift.
        stroke, rest = np.abs(smooth[turn] - smooth[[before, after]])
        level = sign * smooth[turn] - min(_DEPTH * stroke, 0.9 * rest)
        rise, fall = sign * smooth[before : turn + 1], sign * smooth[turn : after + 1]
        left = before + int(np.flatnonzero(rise <= level)[-1])
        right = turn + int(np.flatnonzero(fall <= level)[0])
        times[index] = 0.5 * (crossing(left, sign * level) + crossing(right - 1, sign * level))
    return Trace(time=time, deflection=deflection, smooth=smooth, window=window, noise=noise, turns=turns, times=times)


def rms_noise(values: Array) -> float:
    """Estimate the standard deviation of a series' noise from its fourth differences.

    They are white noise times sqrt(70), and next to nothing of a cycle of a dozen samples or more; their median does not see
    turning points.
    """
    if values.size < 6:
        return 0.0
    return float(np.median(np.abs(np.diff(values, 4)))) / (0.6745 * np.sqrt(70.0))


def _smoothed(values: Array, window: int) -> Array:
    """Average over `window` samples, over fewer at the ends."""
    window += 1 - window % 2
    if window == 1:
        return values
    half = window // 2
    sums = np.concatenate([[0.0], np.cumsum(values - values[0])])
    index = np.arange(values.size)
    # The same number on both sides, so that a straight line stays where it is.
    reach = np.minimum(half, np.minimum(index, values.size - 1 - index))
    return values[0] + (sums[index + reach + 1] - sums[index - reach]) / (2 * reach + 1)


def _reversals(values: Array, threshold: float) -> Integers:
    """Find the samples at which a series turns back by more than `threshold`, with its first and last sample."""
    turns: list[int] = []
    high = low = extreme = 0
    direction = 0
    for index, value in enumerate(values.tolist()):
        if direction == 0:
            high = index if value > values[high] else high
            low = index if value < values[low] else low
            if values[high] - values[low] > threshold:
                direction, turns, extreme = (1, [low], high) if high > low else (-1, [high], low)
        elif (value - values[extreme]) * direction > 0.0:
            extreme = index
        elif (values[extreme] - value) * direction > threshold:
            turns.append(extreme)
            direction, extreme = -direction, index
    return np.array([*turns, extreme] if turns else [], dtype=np.int64)


@dataclass(frozen=True, repr=False)
class RecordedLoop(Loop):
    """The mean of a run's last cycles, without drift, and the turning points of the deflection that led there.

    A hysteretic force remembers how its cycle was reached, the longer the smaller the cycle. Rate-independent laws need no more
    than the turning points to be led the same way.
    """

    # turning points from the unloaded device to the first of the averaged cycles [m], (n,)
    history: Array = field(default_factory=lambda: np.zeros(0), repr=False)
    # time since the cycle began over its period, from 0 to 1, (n_t,)
    elapsed: Array = field(default_factory=lambda: np.zeros(0), repr=False)
    averaged: int = 0  # cycles in the mean; 0 if it is not known how they were reached, and the loop counts as steady
    # standard deviation of what the averaged cycles differ by, as it is left in their mean [N]; 0 of a single one
    scatter: float = 0.0
    period: float | None = None  # of its cycles [s]; None where the record has no time


def mean_of_cycles(forces: Array, elapsed: Array) -> Array:
    """Average successive cycles' forces [N], (n_t,), from (n_cycles, n_t), without a zero that drifts linearly.

    The drift is that of the cycles' mean forces, or of a single one's ends, and is zero at the end of the last cycle. The
    first and last values returned are equal; `elapsed` is the time since a cycle's begin over its period, from 0 to 1, (n_t,).
    """
    if forces.shape[0] == 1:
        return forces[0] - (forces[0, -1] - forces[0, 0]) * (elapsed - 1.0)
    means = np.asarray(np.trapezoid(forces, elapsed, axis=1))
    drift = (means[-1] - means[0]) / (forces.shape[0] - 1)
    # Cycle k has drifted by k + elapsed, and their mean k is (n - 1) / 2.
    mean = np.asarray(forces.mean(axis=0) - drift * (elapsed - 0.5 * (forces.shape[0] + 1)))
    mean[[0, -1]] = 0.5 * (mean[0] + mean[-1])
    return mean
