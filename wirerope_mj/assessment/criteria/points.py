"""Frequencies with values: rows of both, and curves through points, straight between them on logarithmic axes."""

import math

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arrays import Array


def check_rows(name: str, frequency: npt.ArrayLike, value: npt.ArrayLike) -> tuple[Array, Array]:
    """Return frequencies [Hz] and values in any order as arrays.

    Raises:
        ValueError: they are not as many, a frequency is not positive, or a value is negative.
    """
    f, v = np.atleast_1d(np.asarray(frequency, dtype=np.float64)), np.atleast_1d(np.asarray(value, dtype=np.float64))
    if f.ndim != 1 or f.shape != v.shape or not f.size:
        raise ValueError(
            f"`frequency` and `{name}` must be rows of the same length, got the shapes {f.shape} and {v.shape}."
        )
    if not (np.isfinite(f).all() and np.isfinite(v).all() and f.min() > 0.0 and v.min() >= 0.0):
        raise ValueError(f"`frequency` must be finite and > 0 Hz and `{name}` finite and >= 0.")
    return f, v


def check_points(name: str, frequency: npt.ArrayLike, value: npt.ArrayLike) -> tuple[Array, Array]:
    """Return frequencies [Hz] and values of a curve as arrays.

    Raises:
        ValueError: they are not as many, not positive, or the frequencies do not increase.
    """
    f, v = np.atleast_1d(np.asarray(frequency, dtype=np.float64)), np.atleast_1d(np.asarray(value, dtype=np.float64))
    if f.ndim != 1 or f.shape != v.shape or not f.size:
        raise ValueError(f"`{name}` must be as many frequencies as values, got the shapes {f.shape} and {v.shape}.")
    if not (np.isfinite(f).all() and np.isfinite(v).all() and f.min() > 0.0 and v.min() > 0.0):
        raise ValueError(f"`{name}` must hold finite frequencies and values > 0.")
    if f.size > 1 and not (np.diff(f) > 0.0).all():
        raise ValueError(f"`{name}` must have increasing frequencies, got {', '.join(f'{x:.6g}' for x in f[:8])}.")
    return f, v


def curve_at(points: tuple[Array, Array], frequency: Array) -> Array:
    """Return the curve through `points` at frequencies [Hz], straight on logarithmic axes; NaN outside of it."""
    f, v = points
    inside = (frequency >= f[0] * (1.0 - 1e-9)) & (frequency <= f[-1] * (1.0 + 1e-9))
    return np.where(inside, np.exp(np.interp(np.log(frequency), np.log(f), np.log(v))), math.nan)
