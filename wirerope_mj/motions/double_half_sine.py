"""Naval double half-sine."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.double_pulse import DoublePulse


@dataclass(frozen=True, init=False, repr=False)
class DoubleHalfSine(DoublePulse):
    """Two half-sines: a = a1 sin(pi t/t1), then -a2 sin(pi (t - t1)/t2).

    From the peak a1, the velocity V between the pulses and the displacement D after them,

        t1 = pi V/(2 a1),   t2 = 2 D/V - t1,   a2 = a1 t1/t2

    (naval practice for a three-branch design spectrum, BV 0430 and STANAG; the kinematics are derived here). There is such
    a motion if t2 > 0, which is D > (pi/4) V^2/a1.

    Args:
        peak: peak acceleration a1 of the first pulse [m/s^2]; negative, with the other two, for a shock against the
            direction.
        velocity: velocity V between the pulses [m/s].
        displacement: displacement D after the second pulse [m].
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        start: instant at which the first pulse begins [s].
    """

    kind: ClassVar[str] = "double-half-sine"

    @property
    def first_duration(self) -> float:
        """Length t1 of the first half-sine [s]."""
        return math.pi * self.peak_velocity / (2 * self.peak)

    @property
    def second_duration(self) -> float:
        """Length t2 of the second half-sine [s]."""
        return 2 * self.final_displacement / self.peak_velocity - self.first_duration

    @property
    def second_peak(self) -> float:
        """Peak of the second half-sine, -a2 [m/s^2]."""
        return -self.peak * self.first_duration / self.second_duration

    @property
    def _travel_factor(self) -> float:
        return math.pi / 4

    def _along(self, t: Array, order: int) -> Array:
        # The phases of the two half-sines, each held at 0 before it and at pi after it.
        first = np.clip(math.pi * (t - self.start) / self.first_duration, 0.0, math.pi)
        second = np.clip(math.pi * (t - self.middle) / self.second_duration, 0.0, math.pi)
        if order == 2:
            value = np.where(t < self.middle, self.peak * np.sin(first), self.second_peak * np.sin(second))
            return np.where((t >= self.start) & (t < self.end), value, 0.0)
        if order == 1:
            # Written with squares of sines because 1 - cos cancels at the start; pi - second makes the end exactly zero.
            root = np.where(t < self.middle, np.sin(first / 2), np.sin((math.pi - second) / 2))
            return self.peak_velocity * root**2
        ahead = self.first_duration / math.pi * (first - np.sin(first))
        back = self.second_duration / math.pi * (second + np.sin(second))
        return self.peak_velocity / 2 * (ahead + back)
