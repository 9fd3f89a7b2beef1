"""What may be taken off a measured acceleration, each of it only on request."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BASELINES = ("none", "mean", "velocity", "highpass")

_ORDER = 2
"""Of the Butterworth filter; it is run forward and backward, so that its gain is that of the fourth order, without phase."""

_SETTLED = 3.0
"""Periods of the cutoff by which the record is continued at either end, as its mirror image, for the filter to settle."""


def take_baseline_off(
    time: NDArray[np.float64], samples: NDArray[np.float64], baseline: str, highpass: float | None
) -> None:
    """Changes samples (n, 3) in place: a mean, what makes the final velocity zero, or what is slower than a cutoff [Hz].

    Args:
        time: Equally spaced instants [s], (n,).
        samples: Acceleration [m/s^2], (n, 3).
        baseline: One of `BASELINES`.
        highpass: Cutoff of the high-pass filter [Hz], where its gain is one half.
    """
    for column in samples.T:
        if baseline == "mean":
            column -= column.mean()
        elif baseline == "velocity":
            # The trapezoidal rule at equal intervals, without the copies that it would make of a long record.
            gained = column.sum() - (column[0] + column[-1]) / 2.0
            column -= gained / (time.size - 1)
        elif baseline == "highpass" and highpass is not None:
            column[:] = _highpassed(column, highpass, (time.size - 1) / (time[-1] - time[0]))


def _highpassed(column: NDArray[np.float64], cutoff: float, rate: float) -> NDArray[np.float64]:
    from scipy.signal import butter, sosfiltfilt

    sections = butter(_ORDER, cutoff, "highpass", fs=rate, output="sos")
    continued = min(column.size - 1, int(np.ceil(_SETTLED * rate / cutoff)))
    return np.asarray(sosfiltfilt(sections, column, padtype="odd", padlen=continued))
