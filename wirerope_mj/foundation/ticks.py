"""Ticks of axes: round numbers inside a range, linear or logarithmic."""

import math

import numpy as np

from wirerope_mj.foundation.arrays import Array

# First digits of the numbers on a logarithmic axis, from many to few; 10, 100, .. are always among them.
_DIGITS = ((1.0, 2.0, 3.0, 5.0, 7.0), (1.0, 2.0, 5.0), (1.0, 3.0), (1.0,))
# Numbers of `_DIGITS` from which they are the ticks within one decade; with fewer, equal steps are.
_ENOUGH = 4


def log_ticks(low: float, high: float, *, most: int = 12) -> Array:
    """Choose round numbers for a logarithmic axis from `low` to `high`: every decade, and no more than `most` otherwise."""
    decades = 10.0 ** np.arange(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for digits in _DIGITS:
        ticks = (decades[:, None] * np.array(digits)).ravel()
        ticks = ticks[(ticks >= low * (1.0 - 1e-9)) & (ticks <= high * (1.0 + 1e-9))]
        if ticks.size <= most:
            break
    if high >= 10.0 * low or _ENOUGH <= ticks.size <= most:
        return ticks
    # Equal steps crowd towards the upper end of a logarithmic axis: fewer, until the last two stand as far apart as `most` do.
    for count in range(min(most, 6), 1, -1):
        equal = linear_ticks(low, high, most=count)
        if equal.size > 1 and math.log(equal[-1] / equal[-2]) >= math.log(high / low) / (most + 1):
            return equal
    return ticks if ticks.size > 1 else linear_ticks(low, high, most=2)


def linear_ticks(low: float, high: float, *, most: int = 6) -> Array:
    """Return equally spaced round numbers inside a range, about `most` of them."""
    rough = math.log10((high - low) / most)
    steps = math.floor(rough) + np.log10([1.0, 2.0, 5.0, 10.0])
    step = float(10.0 ** steps[np.abs(steps - rough).argmin()])
    return np.asarray(np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1) * step)
