"""Naval double triangle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import between
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.double_pulse import DoublePulse
from wirerope_mj.motions.motion import unique_times
from wirerope_mj.motions.piecewise import PiecewiseLinear


@dataclass(frozen=True, init=False, repr=False)
class DoubleTriangle(DoublePulse):
    """Two triangles: up to a2 at t2, zero at t3, down to a4 at t4, zero at t5.

    From the peak a2, the velocity V between the pulses and the displacement D after them, with t2 = r1 t3 and
    t4 = t3 + r2 T2,

        t3 = 2 V/a2,   T2 = t5 - t3 = (3 D/V - (2 - r1) t3)/(1 + r2),   a4 = -a2 t3/T2

    (naval practice for a three-branch design spectrum, BV 0430 and STANAG; sources differ on which way the second triangle
    leans, r2 = 0.4 or 0.6; the kinematics are derived here). There is such a motion if T2 > 0, which is
    D > V t3 (2 - r1)/3.

    Args:
        peak: peak acceleration a2 of the first triangle [m/s^2]; negative, with the other two, for a shock against the
            direction.
        velocity: velocity V between the pulses [m/s].
        displacement: displacement D after the second pulse [m].
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        start: instant at which the first pulse begins [s].
        r1: where the first peak lies in its triangle, from 0 to 1.
        r2: where the second peak lies in its triangle, from 0 to 1.
    """

    kind: ClassVar[str] = "double-triangle"

    r1: float
    r2: float

    def __init__(
        self,
        *,
        peak: float,
        velocity: float,
        displacement: float,
        direction: str | Sequence[float],
        start: float = 0.0,
        r1: float = 0.4,
        r2: float = 0.4,
    ) -> None:
        for name, value in (("r1", r1), ("r2", r2)):
            object.__setattr__(self, name, between(name, value, 0.0, 1.0))
        super().__init__(peak=peak, velocity=velocity, displacement=displacement, direction=direction, start=start)

    @property
    def first_duration(self) -> float:
        """Length t3 of the first triangle [s]."""
        return 2 * self.peak_velocity / self.peak

    @property
    def second_duration(self) -> float:
        """Length T2 of the second triangle [s]."""
        room = 3 * self.final_displacement / self.peak_velocity - (2 - self.r1) * self.first_duration
        return room / (1 + self.r2)

    @property
    def second_peak(self) -> float:
        """Peak a4 of the second triangle [m/s^2]."""
        return -self.peak * self.first_duration / self.second_duration

    @property
    def instants(self) -> tuple[float, float, float, float]:
        """t2, t3, t4 and t5: first peak, middle, second peak and end, counted from `start` [s]."""
        t3, second = self.first_duration, self.second_duration
        return self.r1 * t3, t3, t3 + self.r2 * second, self.duration

    @property
    def corners(self) -> Array:
        """Start, peaks, middle and end [s], (n,)."""
        return unique_times(self._knots)

    @property
    def _travel_factor(self) -> float:
        return 2 * (2 - self.r1) / 3

    @property
    def _knots(self) -> Array:
        return self.start + np.array([0.0, *self.instants])

    @cached_property
    def _piecewise(self) -> PiecewiseLinear:
        return PiecewiseLinear(self._knots, np.array([0.0, self.peak, 0.0, self.second_peak, 0.0]))

    def _parameters(self, files: Mapping[Path, str]) -> dict[str, Any]:
        return {**super()._parameters(files), "r1": self.r1, "r2": self.r2}

    def _along(self, t: Array, order: int) -> Array:
        return self._piecewise.derivative(t, order)
