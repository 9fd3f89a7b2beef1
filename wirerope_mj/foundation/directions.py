"""Directions along which the base moves: an axis or a vector, checked, as a unit vector, as text and as a stored value."""

from collections.abc import Sequence

import numpy as np

from wirerope_mj.foundation.arrays import Array

Direction = str | tuple[float, float, float]
"""A base axis, `"x"`, `"y"` or `"z"`, or a vector of any length along which the base moves."""

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def checked_direction(direction: str | Sequence[float] | Array, name: str = "direction") -> Direction:
    """Return the direction as it was given, in plain Python values, so that it can be stored and read back exactly.

    `name` is the argument's, for messages.
    """
    if isinstance(direction, str):
        if direction not in _AXES:
            raise ValueError(f'`{name}` must be "x", "y", "z" or a 3-vector, got {direction!r}.')
        return direction
    try:
        vector = np.asarray(direction, dtype=float)
    except (TypeError, ValueError):
        vector = np.empty(0)
    if vector.shape != (3,):
        raise ValueError(f'`{name}` must be "x", "y", "z" or a 3-vector, got {direction!r}.')
    if not np.all(np.isfinite(vector)) or not np.any(vector):
        raise ValueError(f"`{name}` must be finite and not zero, got {vector.tolist()}.")
    x, y, z = vector.tolist()
    return (x, y, z)


def unit_vector(direction: Direction) -> Array:
    """Return the unit vector of a checked direction, (3,)."""
    vector = np.array(_AXES[direction] if isinstance(direction, str) else direction)
    vector /= np.max(np.abs(vector))  # so that neither tiny nor huge vectors overflow in the norm
    return vector / np.linalg.norm(vector)


def direction_text(direction: Direction) -> str:
    """Return the direction for a human reader, `z` or `(1, 1, 0)`."""
    return direction if isinstance(direction, str) else "(" + ", ".join(f"{c:.4g}" for c in direction) + ")"


def plain_direction(direction: Direction) -> str | list[float]:
    """Return the direction as a TOML value."""
    return direction if isinstance(direction, str) else list(direction)
