"""Ticks of axes: round numbers inside a range, linear or logarithmic."""

import math

import numpy as np

from wirerope_mj.foundation.arrays import Array

_ENOUGH = 4  # numbers 1, 2, 5, 10, .. in a range from which they are the ticks of its axis; with fewer, equal steps are


def log_ticks(low: float, high: float, *, most: int = 12) -> Array:
    """Return round numbers for a logarithmic axis from `low` to `high`, about `most` of them at the most."""
    decades = 10.0 ** np.arange(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for digits in ((1.0, 2.0, 3.0, 5.0, 7.0), (1.0, 2.0, 5.0), (1.0,)):
        ticks = (decades[:, None] * np.array(digits)).ravel()
        ticks = ticks[(ticks >= low * (1.0 - 1e-9)) & (ticks <= high * (1.0 + 1e-9))]
        if ticks.size <= most:
            break
    return ticks if ticks.size >= _ENOUGH else linear_ticks(low, high)


def linear_ticks(low: float, high: float, *, most: int = 6) -> Array:
    """Return equally spaced round numbers inside a range, about `most` of them."""
    rough = math.log10((high - low) / most)
    steps = math.floor(rough) + np.log10([1.0, 2.0, 5.0, 10.0])
    step = float(10.0 ** steps[np.abs(steps - rough).argmin()])
    return np.asarray(np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1) * step)
