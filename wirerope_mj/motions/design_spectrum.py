"""Three-branch design spectrum of naval shock, and the double pulses that stand for it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions import ranges
from wirerope_mj.motions.double_half_sine import DoubleHalfSine
from wirerope_mj.motions.double_triangle import DoubleTriangle

# peak, velocity and displacement of the pulse over the spectrum's: as the BV 043/85 literature uses them, from memory
FACTORS = (0.6, 0.75, 1.05)


@dataclass(frozen=True, kw_only=True)
class DesignSpectrum:
    """Undamped shock spectrum of constant displacement, velocity and acceleration, one branch after the other.

    The levels come from the customer's specification (BV 043, STANAG 4142, ...); none are built in. With the usual factors
    the undamped spectra of the pulses lie at 1.05 d0 far below the first corner f1. Where the second corner f2 is 3 to 40
    times the first, that of the double half-sine lies between 0.69 and 1.19 v0 from f1 to f2 and reaches 1.06 to 1.19 a0 from
    f2 on; that of the double triangle 0.67 to 1.21 v0 (1.26 with `r2=0.6`) and 0.94 to 1.03 a0 (1.11). The farther apart the
    corners, the lower all of these; neither pulse is an envelope. Far above f2 both fall to the pulse's own peak, 0.6 a0, as
    the spectrum of every pulse does.

    Attributes:
        displacement: spectral displacement d0 of the low branch [m].
        velocity: spectral pseudo-velocity v0 of the middle branch [m/s].
        acceleration: spectral acceleration a0 of the high branch [m/s^2].
    """

    displacement: float
    velocity: float
    acceleration: float

    def __post_init__(self) -> None:
        for item in fields(self):
            object.__setattr__(self, item.name, ranges.level(item.name, positive(item.name, getattr(self, item.name))))
        highest = math.sqrt(self.displacement * self.acceleration)
        if self.velocity >= highest:
            raise ValueError(
                f"`velocity` must be below sqrt(displacement * acceleration) = {highest:.6g} m/s, where the other two "
                f"branches meet, got {self.velocity!r}: the spectrum would have no branch of constant velocity."
            )

    @property
    def corner_frequencies(self) -> tuple[float, float]:
        """Frequencies at which the branches meet [Hz]: f1 = v0/(2 pi d0) and f2 = a0/(2 pi v0)."""
        low = self.velocity / (2 * math.pi * self.displacement)
        return low, self.acceleration / (2 * math.pi * self.velocity)

    def pseudo_velocity(self, frequencies: ArrayLike) -> Array:
        """Return the spectrum's pseudo-velocity [m/s] at the frequencies [Hz]: the lowest of w d0, v0 and a0/w."""
        omega = 2 * np.pi * np.asarray(frequencies, dtype=float)
        if np.any(omega <= 0):
            raise ValueError("`frequencies` must be > 0.")
        return np.minimum(np.minimum(omega * self.displacement, self.velocity), self.acceleration / omega)

    def double_half_sine(
        self, *, direction: str | Sequence[float], factors: Sequence[float] = FACTORS, start: float = 0.0
    ) -> DoubleHalfSine:
        """Return the double half-sine that stands for the spectrum.

        Args:
            direction: `"x"`, `"y"`, `"z"` or a 3-vector.
            factors: first peak over a0, velocity over v0 and final displacement over d0.
            start: instant at which the first pulse begins [s].
        """
        peak, velocity, displacement = self._pulse(factors)
        return DoubleHalfSine(peak=peak, velocity=velocity, displacement=displacement, direction=direction, start=start)

    def double_triangle(
        self,
        *,
        direction: str | Sequence[float],
        factors: Sequence[float] = FACTORS,
        start: float = 0.0,
        r1: float = 0.4,
        r2: float = 0.4,
    ) -> DoubleTriangle:
        """Return the double triangle that stands for the spectrum.

        Args:
            direction: `"x"`, `"y"`, `"z"` or a 3-vector.
            factors: first peak over a0, velocity over v0 and final displacement over d0.
            start: instant at which the first pulse begins [s].
            r1: where the first peak lies in its triangle, from 0 to 1.
            r2: where the second peak lies in its triangle, from 0 to 1; sources give 0.4 and 0.6.
        """
        peak, velocity, displacement = self._pulse(factors)
        return DoubleTriangle(
            peak=peak, velocity=velocity, displacement=displacement, direction=direction, start=start, r1=r1, r2=r2
        )

    def _pulse(self, factors: Sequence[float]) -> tuple[float, float, float]:
        if len(factors) != 3:
            raise ValueError(f"`factors` must be three, on acceleration, velocity and displacement, got {factors!r}.")
        a, v, d = (positive("factors", factor) for factor in factors)
        return a * self.acceleration, v * self.velocity, d * self.displacement
