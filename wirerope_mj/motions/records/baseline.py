"""Corrections of the baseline of a measured acceleration, each only on request."""

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.records.rest import offset_of

BASELINES = ("none", "rest", "mean", "velocity", "highpass")

# of the Butterworth filter; it is run forward and backward, so that its gain is that of the fourth order, without phase
_ORDER = 2

# periods of the cutoff by which a record is lengthened at either end, at rest, for the filter's answer, which comes before a
# shock as well as after it. It has died away there to 1e-4.
_QUIET = 2.0

# samples that may be added: a cutoff far below anything in a record would fill the memory with rest
_MOST_ADDED = 20_000_000


def without_baseline(time: Array, samples: Array, baseline: str, highpass: float | None) -> tuple[Array, Array]:
    """Return instants and samples without a constant (`baseline`), or without what is slower than a cutoff [Hz].

    The samples are changed in place, unless they are filtered: a record is then longer, by rest at both ends.

    Args:
        time: equally spaced instants [s], (n,).
        samples: acceleration [m/s^2], (n, 3).
        baseline: one of `BASELINES`.
        highpass: cutoff of the high-pass filter [Hz], where its gain is one half.

    Raises:
        ValueError: the cutoff is half the sampling rate or more, or lower than can be meant.
    """
    if highpass is not None:
        return _highpassed(time, samples, highpass)
    for column in samples.T:
        if baseline == "rest":
            column -= offset_of(column)
        elif baseline == "mean":
            column -= column.mean()
        elif baseline == "velocity":
            # The trapezoidal rule at equal intervals, without the copies that it would make of a long record.
            gained = column.sum() - (column[0] + column[-1]) / 2.0
            column -= gained / (time.size - 1)
    return time, samples


def _highpassed(time: Array, samples: Array, cutoff: float) -> tuple[Array, Array]:
    from scipy.signal import butter, sosfiltfilt

    step = float(time[-1] - time[0]) / (time.size - 1)
    if cutoff >= (0.5 - 1e-9) / step:
        raise ValueError(f"`highpass` must be below half the sampling rate, {0.5 / step:.6g}, got {cutoff!r}.")
    quiet = int(np.ceil(_QUIET / (cutoff * step)))
    if 2 * quiet > _MOST_ADDED:
        raise ValueError(
            f"`highpass` must be at least {2.0 * _QUIET / (_MOST_ADDED * step):.3g} Hz at {1.0 / step:.6g} samples a second, "
            f"got {cutoff!r}: the filter needs {_QUIET:g} of its periods at rest before and behind the record."
        )
    sections = butter(_ORDER, cutoff, "highpass", fs=1.0 / step, output="sos")
    longer = np.zeros((time.size + 2 * quiet, samples.shape[1]))
    for column, filtered in zip(samples.T, longer.T, strict=True):
        if column.any():
            # An offset that goes on for ever is nothing after the filter; taken off first, it makes no jump at the ends.
            filtered[quiet:-quiet] = column - offset_of(column)
            filtered[:] = sosfiltfilt(sections, filtered, padtype="constant", padlen=quiet)
    return time[0] + step * np.arange(len(longer)), longer
