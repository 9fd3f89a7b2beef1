"""Checks of the samples and frequencies of a spectrum."""

import math

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arrays import Array

# largest distance of an instant from its uniform position, in steps: what rounding to a few digits leaves in a file
JITTER = 0.01


def check_samples(time: npt.ArrayLike, acceleration: npt.ArrayLike) -> tuple[Array, float]:
    """Return the samples as an array, (n,) or (n, k), and their step [s].

    Raises:
        ValueError: instants and samples do not belong together, are too few, not finite or not uniform.
    """
    instants, values = np.asarray(time, dtype=np.float64), np.asarray(acceleration, dtype=np.float64)
    if instants.ndim != 1 or instants.size < 2:
        raise ValueError(f"`time` must hold at least two instants in a row, got the shape {instants.shape}.")
    if values.ndim not in (1, 2) or values.shape[0] != instants.size:
        raise ValueError(
            f"`acceleration` must hold one row for each of the {instants.size} instants, got the shape {values.shape}."
        )
    if not np.isfinite(instants).all():
        raise ValueError(f"`time` must be finite; instant {int(np.flatnonzero(~np.isfinite(instants))[0])} is not.")
    if not np.isfinite(values).all():
        row = int(np.argwhere(~np.isfinite(values))[0, 0])
        raise ValueError(f"`acceleration` must be finite; the sample at {instants[row]:.6g} s is not.")
    step = float(instants[-1] - instants[0]) / (instants.size - 1)
    if not step > 0.0:
        raise ValueError("`time` must increase.")
    away = np.abs(instants - (instants[0] + step * np.arange(instants.size))) / step
    if away.max() > JITTER:
        row = int(np.argmax(away > JITTER))
        raise ValueError(
            f"`time` must be uniform: {instants[row]:.9g} s lies {away[row]:.3g} steps of {step:.6g} s away from its position; "
            "resample the record first."
        )
    return values, step


def octave_grid(low: float, high: float, *, per_octave: int = 12) -> Array:
    """Return frequencies evenly spaced in logarithm, `per_octave` to an octave, that include 1000 Hz if it is within [Hz]."""
    first = math.ceil(per_octave * math.log2(low / 1000.0) - 1e-9)
    last = math.floor(per_octave * math.log2(high / 1000.0) + 1e-9)
    return 1000.0 * 2.0 ** (np.arange(first, max(first, last) + 1) / per_octave)
