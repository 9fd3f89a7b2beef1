"""Content of the file of a measured record, before anything is done to it."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, unit_vector


@dataclass(frozen=True)
class Reading:
    """Accelerations as they were measured.

    Attributes:
        time: instants of the file's own clock [s], increasing, (n,).
        samples: acceleration along x, y, z [m/s^2], (n, 3).
        units: in which the file gives them, each once.
        warnings: what had to be done to the samples, and what looks wrong about them.
    """

    time: Array
    samples: Array
    units: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    def warned(self, *messages: str) -> "Reading":
        """Return the same reading with more warnings."""
        return replace(self, warnings=(*self.warnings, *messages))


def axes_of(directions: Iterable[Direction]) -> Array:
    """Return the unit vectors of the channels' directions, (n_channels, 3)."""
    return np.array([unit_vector(direction) for direction in directions])
