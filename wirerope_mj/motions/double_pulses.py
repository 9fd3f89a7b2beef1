"""Naval double pulses, half-sines or triangles: a first one up to a velocity, a second one back to rest at a displacement."""

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import between
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.doubts import doubt_of_length
from wirerope_mj.motions.motion import Said, StartedMotion, unique_times
from wirerope_mj.motions.piecewise import PiecewiseLinear


@dataclass(frozen=True, init=False, repr=False)
class DoublePulse(StartedMotion):
    """Two opposite acceleration pulses: at rest before `start`, at rest at the displacement after the second."""

    renamed: ClassVar[Mapping[str, str]] = {"velocity": "peak_velocity", "displacement": "final_displacement"}

    peak: float  # peak acceleration of the first pulse [m/s^2]
    peak_velocity: float  # velocity between the pulses, the largest there is [m/s]
    final_displacement: float  # displacement after the second pulse, the largest there is [m]
    direction: Direction  # `"x"`, `"y"`, `"z"` or a 3-vector
    start: float  # instant at which the first pulse begins [s]
    duration: float  # length of both pulses together [s]

    def __init__(
        self, *, peak: float, velocity: float, displacement: float, direction: str | Sequence[float], start: float = 0.0
    ) -> None:
        self._set(peak=ranges.level("peak", peak), peak_velocity=ranges.level("velocity", velocity))
        self._set(final_displacement=ranges.level("displacement", displacement))
        if len({math.copysign(1.0, value) for value in (self.peak, self.peak_velocity, self.final_displacement)}) > 1:
            raise ValueError(
                "`peak`, `velocity` and `displacement` must have the same sign (negative: a shock against the direction), "
                f"got {self.peak:.4g}, {self.peak_velocity:.4g} and {self.final_displacement:.4g}."
            )
        self._set(direction=checked_direction(direction), start=ranges.start("start", start))
        if self.second_duration <= 0:
            a, v, d, factor = abs(self.peak), abs(velocity), abs(displacement), self._travel_factor
            raise ValueError(
                f"no {self.kind} reaches {v:.6g} m/s with a peak of {a:.6g} m/s^2 and then stops at {d:.6g} m: the first pulse "
                f"lasts {self.first_duration:.4g} s and ends {factor * v * v / a:.6g} m from the start, and the second one "
                f"needs more room than that (its length would be {self.second_duration:.4g} s). "
                f"The condition is displacement > {factor:.5g} velocity^2 / peak: "
                f"`displacement` above {factor * v * v / a:.6g} m, `velocity` below {math.sqrt(a * d / factor):.6g} m/s "
                f"or `peak` above {factor * v * v / d:.6g} m/s^2."
            )
        self._set(duration=self.first_duration + self.second_duration)

    def __repr__(self) -> str:
        """Return the call that makes this motion: the constructor's names, not those of the attributes."""
        given = ", ".join(f"{name}={value!r}" for name, value in self._parameters({}).items())
        return f"{type(self).__name__}({given})"

    @property
    def doubt(self) -> str:
        """Question whether one of the units is wrong, if the pulses last long; else ""."""
        return doubt_of_length(self.duration, "is one of its units another?")

    @property
    @abstractmethod
    def first_duration(self) -> float:
        """Length of the first pulse [s]."""

    @property
    @abstractmethod
    def second_duration(self) -> float:
        """Length of the second pulse [s]."""

    @property
    def second_peak(self) -> float:
        """Acceleration at the peak of the second pulse [m/s^2], of the sign opposite to `peak`: both have one area."""
        return -self.peak * self.first_duration / self.second_duration

    @property
    @abstractmethod
    def _travel_factor(self) -> float:
        """Displacement at the end of the first pulse over V^2/a [-], with its velocity V and its peak a."""

    @property
    def middle(self) -> float:
        """Instant at which the first pulse ends and the second begins [s]."""
        return self.start + self.first_duration

    @cached_property
    def _said(self) -> Said:
        """Describe the pulses in a line, such as `double half-sine 60 g, 2.25 m/s, 52.5 mm along z`."""
        name = self.kind.replace("-", " ", 1)
        level = f"{self.peak / STANDARD_GRAVITY:.4g} g, {self.peak_velocity:.4g} m/s"
        text = f"{name} {level}, {1e3 * self.final_displacement:.4g} mm {self._line_text}"
        events = (self.start, f"{name} begins"), (self.middle, "second pulse begins"), (self.end, f"{name} ends")
        return Said(text, events, shortest_time=min(self.first_duration, self.second_duration))


@dataclass(frozen=True, init=False, repr=False)
class DoubleHalfSine(DoublePulse):
    """Two half-sines: a = a1 sin(pi t/t1), then -a2 sin(pi (t - t1)/t2).

    From the peak a1, the velocity V between the pulses and the displacement D after them,

        t1 = pi V/(2 a1),   t2 = 2 D/V - t1,   a2 = a1 t1/t2

    (naval practice for a three-branch design spectrum, BV 0430 and STANAG; the kinematics are derived here). There is such
    a motion if t2 > 0, which is D > (pi/4) V^2/a1.

    `peak` is a1 [m/s^2], `velocity` V [m/s] and `displacement` D [m], all three negative for a shock against the `direction`
    (`"x"`, `"y"`, `"z"` or a 3-vector); the first pulse begins at `start` [s].
    """

    kind: ClassVar[str] = "double-half-sine"

    @property
    def first_duration(self) -> float:
        return math.pi * self.peak_velocity / (2 * self.peak)

    @property
    def second_duration(self) -> float:
        return 2 * self.final_displacement / self.peak_velocity - self.first_duration

    @property
    def _travel_factor(self) -> float:
        return math.pi / 4

    def _along(self, t: Array, order: int) -> Array:
        """Evaluate displacement (order 0), velocity (1) or acceleration (2) of both half-sines in closed form, (n_t,)."""
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


@dataclass(frozen=True, init=False, repr=False)
class DoubleTriangle(DoublePulse):
    """Two triangles: up to a2 at t2, zero at t3, down to a4 at t4, zero at t5.

    From the peak a2, the velocity V between the pulses and the displacement D after them, with t2 = r1 t3 and
    t4 = t3 + r2 T2,

        t3 = 2 V/a2,   T2 = t5 - t3 = (3 D/V - (2 - r1) t3)/(1 + r2),   a4 = -a2 t3/T2

    (naval practice for a three-branch design spectrum, BV 0430 and STANAG; sources differ on which way the second triangle
    leans, r2 = 0.4 or 0.6; the kinematics are derived here). There is such a motion if T2 > 0, which is
    D > V t3 (2 - r1)/3.

    `r1` and `r2` say where the peaks lie in their triangles, from 0 to 1; all else is as in `DoubleHalfSine`.
    """

    kind: ClassVar[str] = "double-triangle"

    r1: float
    r2: float

    def __init__(
        self, *, peak: float, velocity: float, displacement: float, direction: str | Sequence[float],
        start: float = 0.0, r1: float = 0.4, r2: float = 0.4,
    ) -> None:  # fmt: skip
        for name, value in (("r1", r1), ("r2", r2)):
            object.__setattr__(self, name, between(name, value, 0.0, 1.0))
        super().__init__(peak=peak, velocity=velocity, displacement=displacement, direction=direction, start=start)

    @property
    def first_duration(self) -> float:
        return 2 * self.peak_velocity / self.peak

    @property
    def second_duration(self) -> float:
        room = 3 * self.final_displacement / self.peak_velocity - (2 - self.r1) * self.first_duration
        return room / (1 + self.r2)

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

    def _along(self, t: Array, order: int) -> Array:
        return self._piecewise.derivative(t, order)
