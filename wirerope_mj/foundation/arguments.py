"""Checks of the arguments that the base motions share; each says what must hold and what it got."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Direction = str | tuple[float, float, float]
"""A base axis, `"x"`, `"y"` or `"z"`, or a vector of any length along which the base moves."""

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def finite(name: str, value: float) -> float:
    """Returns the value as a plain float; a value that is no finite number is a ValueError."""
    if isinstance(value, str | bool):
        raise ValueError(f"`{name}` must be a finite number, got {value!r}.")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"`{name}` must be a finite number, got {value!r}.") from None
    if not math.isfinite(number):
        raise ValueError(f"`{name}` must be a finite number, got {number!r}.")
    return number


def positive(name: str, value: float) -> float:
    """Returns the value as a plain float; zero and less are a ValueError."""
    number = finite(name, value)
    if number <= 0:
        raise ValueError(f"`{name}` must be > 0, got {number!r}.")
    return number


def nonzero(name: str, value: float) -> float:
    """Returns the value as a plain float of either sign; zero is a ValueError."""
    number = finite(name, value)
    if number == 0:
        raise ValueError(f"`{name}` must not be zero.")
    return number


def checked_direction(direction: str | Sequence[float] | NDArray[np.float64]) -> Direction:
    """Returns the direction as it was given, in plain Python values, so that it can be stored and read back exactly."""
    if isinstance(direction, str):
        if direction not in _AXES:
            raise ValueError(f'`direction` must be "x", "y", "z" or a 3-vector, got {direction!r}.')
        return direction
    try:
        vector = np.asarray(direction, dtype=float)
    except (TypeError, ValueError):
        vector = np.empty(0)
    if vector.shape != (3,):
        raise ValueError(f'`direction` must be "x", "y", "z" or a 3-vector, got {direction!r}.')
    if not np.all(np.isfinite(vector)) or not np.any(vector):
        raise ValueError(f"`direction` must be finite and not zero, got {vector.tolist()}.")
    x, y, z = vector.tolist()
    return (x, y, z)


def unit_vector(direction: Direction) -> NDArray[np.float64]:
    """Returns the unit vector of a checked direction, shape (3,)."""
    vector = np.array(_AXES[direction] if isinstance(direction, str) else direction)
    vector /= np.max(np.abs(vector))  # so that neither tiny nor huge vectors overflow in the norm
    return vector / np.linalg.norm(vector)


def direction_text(direction: Direction) -> str:
    """Returns the direction for a human reader, `z` or `(1, 1, 0)`."""
    return direction if isinstance(direction, str) else "(" + ", ".join(f"{c:.4g}" for c in direction) + ")"


def plain_direction(direction: Direction) -> str | list[float]:
    """Returns the direction as a TOML value."""
    return direction if isinstance(direction, str) else list(direction)


def as_times(time: ArrayLike) -> NDArray[np.float64]:
    """Returns the times as an array (n_t,); a single time becomes an array of one."""
    times = np.atleast_1d(np.asarray(time, dtype=float))
    if times.ndim != 1:
        raise ValueError(f"`time` must be a number or one-dimensional, got shape {times.shape}.")
    return times


def at_least_one(name: str, value: int) -> int:
    """Returns a whole number >= 1, as a plain int; anything else is a ValueError."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 1:
        raise ValueError(f"`{name}` must be a whole number >= 1, got {value!r}.")
    return int(value)


def checked_seed(seed: int) -> int:
    """Returns a whole number >= 0, as a plain int; anything else is a ValueError."""
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"`seed` must be a whole number >= 0, got {seed!r}.")
    return int(seed)
