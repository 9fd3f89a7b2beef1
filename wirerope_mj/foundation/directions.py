"""Directions along which the base moves: parsed, checked, as a unit vector, as text and as a stored value; rotations."""

from collections.abc import Sequence

import numpy as np

from wirerope_mj.foundation.arrays import Array

# A base axis, `"x"`, `"y"` or `"z"`, or a vector of any length along which the base moves.
Direction = str | tuple[float, float, float]

AXES = ("x", "y", "z")
ROTATIONS = ("roll", "pitch", "yaw")  # about x, y, z
_UNIT: dict[str, tuple[float, float, float]] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
# How an option says one direction.
WORDING = "x, y, z, -x, -y, -z or a vector such as 1,1,0"


def directions_in(text: str) -> tuple[Direction, ...]:
    """Parse axes, several together as in "xyz", one with a sign as in "-z", or a vector as in "1,1,0"; () for anything else."""
    if text and set(text) <= set(AXES) and len(set(text)) == len(text):
        return tuple(text)
    if text[:1] in ("+", "-") and text[1:] in AXES:
        x, y, z = (0.0 - c for c in _UNIT[text[1:]])  # no -0.0
        return (text[1:],) if text[0] == "+" else ((x, y, z),)
    try:
        x, y, z = (float(number) for number in text.split(","))
    except ValueError:
        return ()
    return ((x, y, z),)


def direction_in(text: str, name: str) -> Direction:
    """Parse one direction; ValueError if the text holds none or several, names the argument."""
    directions = directions_in(text)
    if len(directions) != 1:
        raise ValueError(f"`{name}` must be {WORDING}, got {text!r}.")
    return directions[0]


def checked_direction(direction: str | Sequence[float] | Array, name: str = "direction") -> Direction:
    """Check a direction and return it as given, in plain Python values that are stored and read back exactly.

    `name` is the argument's, for messages.
    """
    if isinstance(direction, str):
        if direction not in _UNIT:
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
    vector = np.array(_UNIT[direction] if isinstance(direction, str) else direction)
    vector /= np.max(np.abs(vector))  # so that neither tiny nor huge vectors overflow in the norm
    return vector / np.linalg.norm(vector)


def direction_text(direction: Direction) -> str:
    """Format a direction for a human reader, `z` or `(1, 1, 0)`."""
    return direction if isinstance(direction, str) else "(" + ", ".join(f"{c:.4g}" for c in direction) + ")"


def plain_direction(direction: Direction) -> str | list[float]:
    """Return the direction as a TOML value."""
    return direction if isinstance(direction, str) else list(direction)


def rotation_matrices(quaternion: Array) -> Array:
    """Return the rotation matrices (..., 3, 3) of unit quaternions (..., 4), w first."""
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    matrices = np.empty((*np.shape(w), 3, 3))
    for i, row in enumerate(rows):
        for j, element in enumerate(row):
            matrices[..., i, j] = element
    return matrices
