"""Where the signal of a measured record stands when nothing happens, and whether it is of a pulse or of a vibration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_RESTS, _BAND, _BESIDE = 0.3, 0.02, 0.1
"""A record rests at its median if this share of its samples lies beside it, within a share of its range or of the median."""

_PULSE_WAVES = 10
"""Half waves above a tenth of the peak up to which a record is of a pulse, which begins and ends near zero."""


def resting_value(a: Array) -> float | None:
    """Returns the value at which a signal (n,) rests between its events, None if it does not."""
    middle = float(np.median(a))
    band = max(_BAND * float(np.ptp(a)), _BESIDE * abs(middle))
    share = np.count_nonzero((a >= middle - band) & (a <= middle + band)) / a.size
    return middle if share >= _RESTS else None


def standing_value(a: Array) -> float:
    """Returns the value that a signal (n,) had before and after: where it rests, a vibration's mean, zero for a bare pulse."""
    rest = resting_value(a)
    if rest is not None:
        return rest
    mean = float(a.mean())
    return 0.0 if is_pulse(a, mean) else mean


def is_pulse(a: Array, rest: float) -> bool:
    """Returns whether a signal (n,) is of a pulse and not of a vibration: it has few half waves about its rest."""
    peak = peak_from(a, rest)
    signs = np.sign(a[np.abs(a - rest) > 0.1 * peak] - rest)
    return bool(np.count_nonzero(np.diff(signs)) < _PULSE_WAVES)


def peak_from(a: Array, rest: float) -> float:
    """Returns how far a signal (n,) goes from its rest, to either side."""
    return max(float(a.max()) - rest, rest - float(a.min()))
