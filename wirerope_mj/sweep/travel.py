"""Deflections against what the laws hold for, which is an error, and against what the isolators are rated for, a warning."""

import math

import numpy as np
import numpy.typing as npt

from wirerope_mj.errors import SimulationError
from wirerope_mj.system import System

Array = npt.NDArray[np.float64]

WAYS = ("roll", "shear", "compression", "tension")
"""Ways in which a travel is rated, in the order of a watch's columns."""


RAN_AWAY = 10.0
"""Finite travels beyond which a deflection is but the overflow of a law that has ended."""


class Lawful:
    """Knows how far the laws of all mounts hold."""

    def __init__(self, system: System) -> None:
        self._mounts = system.mounts
        axes = [mount.isolator.axes.values() for mount in system.mounts.values()]
        self._limits = np.array([[math.inf if law is None else law.finite_travel for law in laws] for laws in axes])

    def require(self, frequency: Array, reached: Array) -> None:
        """Raise SimulationError at the first cycle in which a mount went beyond the finite travel of its law.

        Args:
            frequency: of the cycles [Hz], (n,).
            reached: largest absolute deflections in them [m], (n, n_mounts, 3).
        """
        beyond = reached > self._limits
        if not beyond.any():
            return
        row, number, place = np.argwhere(beyond)[0]
        name, mount = list(self._mounts.items())[number]
        axis, law = list(mount.isolator.axes.items())[place]
        assert law is not None  # what has no law has no end of it
        far = reached[row, number, place]
        went = f"reached {far:.4g} m" if far < RAN_AWAY * law.finite_travel else "ran away"
        raise SimulationError(
            f"at {frequency[row]:.5g} Hz mount {name!r} {went} on its {axis} axis, whose "
            f"law holds up to {law.finite_travel:.4g} m, where {law.travel_rule}. Shake more gently, or use an isolator with "
            "more travel."
        )


class TravelWatch:
    """Remembers where the mounts go farthest while a sweep goes on."""

    def __init__(self, system: System) -> None:
        self._names = tuple(system.mounts)
        rated = [[getattr(m.isolator.limits.travel, way) for way in WAYS] for m in system.mounts.values()]
        self._rated = np.array([[math.inf if limit is None else limit for limit in row] for row in rated])
        self._largest = np.full((len(system.mounts), len(WAYS)), -math.inf)
        self._at = np.zeros(self._largest.shape)

    def add(self, frequency: Array, lowest: Array, highest: Array) -> None:
        """Take extreme deflections [m], (n, n_mounts, 3), at frequencies [Hz], (n,)."""
        both = np.maximum(highest, -lowest)
        reached = np.stack([both[..., 0], both[..., 1], -lowest[..., 2], highest[..., 2]], axis=-1)
        row = np.argmax(reached, axis=0)
        largest = np.take_along_axis(reached, row[np.newaxis], axis=0)[0]
        grown = largest > self._largest
        self._largest, self._at = np.where(grown, largest, self._largest), np.where(grown, frequency[row], self._at)

    def warnings(self) -> tuple[str, ...]:
        """Return a sentence for every rated travel that was exceeded, where it was most."""
        return tuple(
            f"mount {name!r} goes {self._largest[m, w]:.4g} m in {way} at {self._at[m, w]:.5g} Hz, beyond its rated "
            f"{self._rated[m, w]:.4g} m."
            for m, name in enumerate(self._names)
            for w, way in enumerate(WAYS)
            if self._largest[m, w] > self._rated[m, w]
        )
