"""A base motion seen from a later instant on, so that windows of one motion can be stepped side by side."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions import BaseMotion


@dataclass(frozen=True, eq=False)
class Later(BaseMotion):
    """`motion` whose time begins at the instant `at` [s]; it is stepped through and never stored."""

    motion: BaseMotion
    at: float
    kind: ClassVar[str] = "later"

    @property
    def duration(self) -> float:  # type: ignore[override]
        """Length that is left [s]."""
        return self.motion.end - self.at

    def _derivative(self, t: Array, order: int) -> Array:
        return self.motion._derivative(t + self.at, order)

    @property
    def corners(self) -> Array:
        """Instants of the motion's corners [s], (n,)."""
        return self.motion.corners - self.at

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        """Instants [s] and jumps of the velocity (3,) [m/s]."""
        return tuple((time - self.at, jump) for time, jump in self.motion.velocity_jumps)

    @property
    def description(self) -> str:
        """One line for a human reader."""
        return f"{self.motion.description}, from {self.at:.6g} s"

    @property
    def events(self) -> tuple[tuple[float, str], ...]:
        """Events: instants [s] and texts."""
        return tuple((time - self.at, text) for time, text in self.motion.events)

    @property
    def shortest_time(self) -> float:
        """Shortest time scale [s]."""
        return self.motion.shortest_time

    @property
    def directions(self) -> Array:
        """Vectors that span the directions of the motion, (n, 3)."""
        return self.motion.directions

    def _parameters(self, files: Mapping[Path, str]) -> dict[str, Any]:
        raise NotImplementedError("a window of a motion is not stored")
