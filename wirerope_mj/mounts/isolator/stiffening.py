"""Stiffening over the first cycles: by how much a rope that has been worked is stiffer than one that has not."""

import math
from dataclasses import asdict, dataclass
from typing import Any

from wirerope_mj.foundation.arguments import finite


@dataclass(frozen=True, kw_only=True)
class Stiffening:
    """A factor on all forces of an isolator, 1 + after_50 ln(cycles) / ln(50), for the cycles that it has gone through.

    It is held constant within a run: the effect takes tens of cycles, a shock or a look at one resonance few. It multiplies
    stiffness and friction of all axes alike, which the source does not say: it speaks of stiffness. Beyond 50 cycles the
    logarithm is an extrapolation.

    Source: M. Fu and Z. Yang, Stiffness hardening effect of wire rope isolators under small cyclic loads, Materials 17 (2024)
    4983, abstract: under small cycles at a large preload the stiffness grows with the logarithm of the number of cycles, by
    about 10 to 30 % after 50.

    Attributes:
        after_50: ratio by which the stiffness has grown after 50 cycles, 0 to 1; published 0.1 to 0.3.
        cycles: cycles that the isolator has gone through when the run starts, >= 1; at 1 nothing changes.
    """

    after_50: float
    cycles: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 <= finite("after_50", self.after_50) <= 1.0:
            raise ValueError(f"`after_50` must be a number from 0 to 1, got {self.after_50!r}.")
        if finite("cycles", self.cycles) < 1.0:
            raise ValueError(f"`cycles` must be >= 1, got {self.cycles!r}.")

    @property
    def factor(self) -> float:
        """Factor on all forces [-], >= 1; exactly 1 at one cycle and 1 + after_50 at fifty."""
        return 1.0 + self.after_50 * (math.log(self.cycles) / math.log(50.0))

    @property
    def description(self) -> str:
        """The values and the factor that they amount to, as text."""
        values = f"after_50 = {self.after_50:.6g}, cycles = {self.cycles:.6g}"
        return f"{values}: all forces are {self.factor:.6g} times those of the laws"

    def to_dict(self) -> dict[str, Any]:
        """Return the stiffening as it stands in an isolator file."""
        return asdict(self)
