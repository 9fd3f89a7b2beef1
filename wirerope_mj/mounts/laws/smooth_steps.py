"""A rate-dependent law with one state in time along a cubic path, by Dormand and Prince's adaptive pair 5(4)."""

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.cubic import position, speed
from wirerope_mj.mounts.laws.kernels import evaluate_one

# Error of a step as a fraction of the state, or of what it would gain over the interval; hundreds of steps stay below 1e-8.
TOLERANCE = 1e-11
# Fraction of an interval below which a failing step can only be a kink, whose contribution is below rounding.
_SMALLEST = 1e-9
# Fraction of an interval that a step takes at most: the work, which is not controlled, is then as good as the state.
_WIDEST = 0.5
_ABSCISSAE = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_STAGES = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_ERROR = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@njit
def slope_at(law, p, i, cubic, t, z, scratch):
    """Return zdot [N/s] and the power [W] at the instant t in the state z."""
    scratch[0], v = z, speed(cubic, t)
    force = evaluate_one(law, p, i, position(cubic, t), v, scratch, 0, scratch, 1)
    return scratch[1], force * v


@njit
def integrate_in_time(law, p, i, cubic, start, end, z, j):
    """Carry the state `z[j]` in place from `start` to `end` and return the work done on the law [J]; NaN if it is lost."""
    k, scratch = np.empty((7, 2)), np.empty(2)
    t, step, work, now = start, _WIDEST * (end - start), 0.0, z[j]
    k[0] = slope_at(law, p, i, cubic, t, now, scratch)
    while t < end:
        step = min(step, end - t)
        after, gain, error = now, 0.0, step * _ERROR[0] * k[0, 0]
        for stage in range(1, 7):
            after, gain = now, 0.0
            for before in range(stage):
                after += step * _STAGES[stage, before] * k[before, 0]
                gain += step * _STAGES[stage, before] * k[before, 1]
            k[stage] = slope_at(law, p, i, cubic, t + _ABSCISSAE[stage] * step, after, scratch)
            error += step * _ERROR[stage] * k[stage, 0]
        size = max(abs(now), abs(after), abs(k[0, 0]) * (end - start), abs(k[6, 0]) * (end - start))
        ratio = abs(error) / (TOLERANCE * size + 1e-300)
        if not (np.isfinite(after) and np.isfinite(gain)):
            ratio = np.inf
        if ratio > 1.0 and step > _SMALLEST * (end - start):
            step *= max(0.2, 0.9 * ratio**-0.2)
            continue
        if ratio == np.inf:
            z[j] = np.nan
            return np.nan
        # An interval between a reversal and a sample may be as short as the rounding of its instants.
        t = end if step >= end - t or t + step <= t else t + step
        now, work = after, work + gain
        k[0] = k[6]
        step = min(step * min(5.0, 0.9 * (min(ratio, 1.0) + 1e-10) ** -0.2), _WIDEST * (end - start))
    z[j] = now
    return work
