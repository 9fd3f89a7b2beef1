"""Naval double pulses: a first pulse up to a velocity, a second one back to rest at a displacement."""

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction, plain_direction
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.motion import StartedMotion, unique_times


@dataclass(frozen=True, init=False, repr=False)
class DoublePulse(StartedMotion):
    """Two opposite acceleration pulses: at rest before `start`, at rest at the displacement after the second.

    Attributes:
        peak: peak acceleration of the first pulse [m/s^2].
        peak_velocity: velocity between the pulses, the largest there is [m/s].
        final_displacement: displacement after the second pulse, the largest there is [m].
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        start: instant at which the first pulse begins [s].
        duration: length of both pulses together [s].
    """

    peak: float
    peak_velocity: float
    final_displacement: float
    direction: Direction
    start: float
    duration: float

    def __init__(
        self, *, peak: float, velocity: float, displacement: float, direction: str | Sequence[float], start: float = 0.0
    ) -> None:
        object.__setattr__(self, "peak", ranges.level("peak", peak))
        object.__setattr__(self, "peak_velocity", ranges.level("velocity", velocity))
        object.__setattr__(self, "final_displacement", ranges.level("displacement", displacement))
        if len({math.copysign(1.0, value) for value in (self.peak, self.peak_velocity, self.final_displacement)}) > 1:
            raise ValueError(
                "`peak`, `velocity` and `displacement` must have the same sign (negative: a shock against the direction), "
                f"got {self.peak:.4g}, {self.peak_velocity:.4g} and {self.final_displacement:.4g}."
            )
        object.__setattr__(self, "direction", checked_direction(direction))
        object.__setattr__(self, "start", ranges.start("start", start))
        self._check_second_pulse()
        object.__setattr__(self, "duration", self.first_duration + self.second_duration)

    def __repr__(self) -> str:
        """Return the call that makes this motion: the constructor's names, not those of the attributes."""
        given = ", ".join(f"{name}={value!r}" for name, value in self._parameters({}).items())
        return f"{type(self).__name__}({given})"

    @property
    @abstractmethod
    def first_duration(self) -> float:
        """Length of the first pulse [s]."""

    @property
    @abstractmethod
    def second_duration(self) -> float:
        """Length of the second pulse [s]."""

    @property
    @abstractmethod
    def second_peak(self) -> float:
        """Acceleration at the peak of the second pulse [m/s^2], of the sign opposite to `peak`."""

    @property
    @abstractmethod
    def _travel_factor(self) -> float:
        """Displacement at the end of the first pulse, times a / V^2."""

    def _check_second_pulse(self) -> None:
        """Raise ValueError if the first pulse alone already reaches the final displacement."""
        if self.second_duration > 0:
            return
        a, v, d = abs(self.peak), abs(self.peak_velocity), abs(self.final_displacement)
        factor = self._travel_factor
        raise ValueError(
            f"no {self.kind} reaches {v:.6g} m/s with a peak of {a:.6g} m/s^2 and then stops at {d:.6g} m: the first pulse "
            f"lasts {self.first_duration:.4g} s and ends {factor * v * v / a:.6g} m from the start, and the second one "
            f"needs more room than that (its length would be {self.second_duration:.4g} s). "
            f"The condition is displacement > {factor:.5g} velocity^2 / peak: "
            f"`displacement` above {factor * v * v / a:.6g} m, `velocity` below {math.sqrt(a * d / factor):.6g} m/s "
            f"or `peak` above {factor * v * v / d:.6g} m/s^2."
        )

    @property
    def middle(self) -> float:
        """Instant at which the first pulse ends and the second begins [s]."""
        return self.start + self.first_duration

    @property
    def corners(self) -> Array:
        """Start, middle and end [s], (3,)."""
        return unique_times([self.start, self.middle, self.end])

    @property
    def description(self) -> str:
        """For instance `double half-sine 60 g, 2.25 m/s, 52.5 mm along z`."""
        level = f"{self.peak / STANDARD_GRAVITY:.4g} g, {self.peak_velocity:.4g} m/s"
        size = f"{level}, {1e3 * self.final_displacement:.4g} mm"
        return f"{self.kind.replace('-', ' ', 1)} {size} {self._line_text}"

    @property
    def events(self) -> tuple[tuple[float, str], ...]:
        """Start of the two pulses and end of the second."""
        name = self.kind.replace("-", " ", 1)
        return (self.start, f"{name} begins"), (self.middle, "second pulse begins"), (self.end, f"{name} ends")

    @property
    def shortest_time(self) -> float:
        """Length of the shorter pulse [s]."""
        return min(self.first_duration, self.second_duration)

    def _parameters(self, files: Mapping[Path, str]) -> dict[str, Any]:
        levels = {"peak": self.peak, "velocity": self.peak_velocity, "displacement": self.final_displacement}
        return {**levels, "direction": plain_direction(self.direction), "start": self.start}
