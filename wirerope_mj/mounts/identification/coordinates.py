"""Numbers in which a law is searched for: normalised, named, bounded, positive ones by their logarithm."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from wirerope_mj.mounts.laws import Law


@dataclass(frozen=True, kw_only=True)
class Scales:
    """Sizes of the measured loops."""

    deflection: float  # the largest amplitude [m]
    least: float  # the least amplitude [m]
    force: float  # half the largest force range [N]
    # how far a stop's sides that close were deflected [m]; 0 of one that does not
    below: float = 0.0
    above: float = 0.0


# Fraction of the least amplitude below which a deflection of slip is not seen: of a sine's 200 samples nine behind a turning
# point still show the stiffness before it, fewer show a jump of the force alone.
SEEN = 0.02


@dataclass(frozen=True)
class Coordinate:
    """One number that is searched for."""

    name: str  # as tables print it
    unit: str
    # bounds of its value; a coordinate with a lower bound > 0 is searched for by its logarithm
    lower: float
    upper: float
    scale: float = 1.0  # size of its value, for one that may be zero
    linear: bool = False  # whether the force is proportional to it, all others given
    stiffness: bool = False  # whether it belongs to the elastic part, which the first of the thesis' three stages fits

    @property
    def logarithmic(self) -> bool:
        """True if it is searched for by its logarithm."""
        return self.lower > 0.0

    def inside(self, value: float) -> float:
        """Return the number that stands for a value, within the bounds."""
        value = min(max(value, self.lower), self.upper)
        return math.log(value) if self.logarithmic else value / self.scale

    def value(self, number: float) -> float:
        """Return the value that a number stands for."""
        return math.exp(number) if self.logarithmic else number * self.scale

    def slope(self, number: float) -> float:
        """Return the derivative of the value by the number."""
        return math.exp(number) if self.logarithmic else self.scale


@dataclass(frozen=True, kw_only=True)
class Family:
    """Coordinates of the laws of one class."""

    coordinates: Callable[[Scales], list[Coordinate]]  # the numbers, from the sizes of the measured loops
    make: Callable[[dict[str, float]], Law]  # the law of their values
    read: Callable[[Law], dict[str, float]]  # the values of a law
    # values of coordinates that are given unless they are asked for, or a start has others
    usual: Mapping[str, float] = field(default_factory=dict)
