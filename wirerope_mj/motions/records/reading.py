"""What the file of a measured record holds, before anything is done to it."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, unit_vector


@dataclass(frozen=True)
class Reading:
    """Accelerations as they were measured.

    Attributes:
        time: Instants of the file's own clock [s], increasing, shape (n,).
        samples: Acceleration along x, y, z [m/s^2], shape (n, 3).
        units: Units in which the file gives them, each once.
    """

    time: Array
    samples: Array
    units: tuple[str, ...]


def axes_of(directions: Iterable[Direction]) -> Array:
    """Return the unit vectors of the channels' directions, shape (n_channels, 3)."""
    return np.array([unit_vector(direction) for direction in directions])
