"""The map of a system over whole periods of its base's sine: what searches and branches ask of it, whoever steps."""

from abc import ABC, abstractmethod
from contextlib import AbstractContextManager

from wirerope_mj.dynamics.periodic.coordinates import Coordinates
from wirerope_mj.dynamics.periodic.track import Drive, Track
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array


class Flow(ABC):
    """The map from the unknowns at phase 0 to those some periods later.

    Attributes:
        coordinates: the unknowns.
        system: what is stepped: that of the coordinates, or one with the same states and smoothed laws.
        width: velocity over which its laws are smoothed [m/s]; 0 for laws as they are.
        taken: model steps taken so far, of all copies.
        passes: single forward passes in addition; a step has four.
    """

    def __init__(self, coordinates: Coordinates, system: System) -> None:
        self.coordinates, self.system, self.model = coordinates, system, system.model
        self.width, self.taken, self.passes = 0.0, 0, 0

    @property
    def steps(self) -> int:
        """Model steps taken so far, forward passes counted as quarters."""
        return self.taken + self.passes // 4

    def smooth(self, width: float) -> None:
        """Smooth the laws over a velocity [m/s]."""
        self.width = width

    @abstractmethod
    def ready(self) -> AbstractContextManager[None]:
        """Make the mounts act; everything else of a flow is called within."""

    @abstractmethod
    def ends(self, starts: Array, drive: Drive) -> Array:
        """Return the unknowns at the end of each copy's periods, (n, n_x); NaN where a copy went astray.

        Args:
            starts: unknowns at phase 0, (n, n_x).
            drive: the sine.
        """

    @abstractmethod
    def follow(self, start: Array, drive: Drive) -> Track:
        """Return the track of one copy from `start`, (n_x,)."""
