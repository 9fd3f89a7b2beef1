"""Impact of a drop table."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import between, positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction, plain_direction
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.motion import StartedMotion, unique_times
from wirerope_mj.motions.pulses import HalfSine


@dataclass(frozen=True, init=False)
class ShockTableImpact(StartedMotion):
    """Shock of a table that falls from a height, strikes its programmer and rebounds.

    The impact velocity is V = sqrt(2 g h), the rebound velocity e V, and the shock is their sum, V (1 + e), along the
    direction: at once, or as the half-sine of a programmer, whose peak is pi V (1 + e)/(2 D).

    By default only the impact is played, from rest: the payload then meets it settled on its mounts, and the base coasts
    at V (1 + e). That is the shock seen from a frame that moves with the falling table, but for one thing: a falling
    table leaves its payload weightless, so that the mounts have let go of their static deflection, or still swing about it,
    when the table strikes. With `fall` the fall of sqrt(2 h/g) is played too, at acceleration -g along the direction, which
    is what a payload in a model with gravity g against the direction must feel to be weightless. Brakes and second impacts
    are left out.

    Args:
        drop_height: height h [m].
        rebound: rebound velocity over impact velocity e, from 0 (the table stays) to 1.
        pulse_duration: length D of the programmer's half-sine [s]; None: the velocity changes at once.
        direction: direction of the shock, against that of the fall: `"x"`, `"y"`, `"z"` or a 3-vector.
        start: instant at which the motion begins [s]: the impact, or the release if the fall is played.
        fall: whether the fall before the impact is played.
        gravity: acceleration of the fall g [m/s^2].
    """

    kind: ClassVar[str] = "shock-table-impact"

    drop_height: float
    rebound: float
    pulse_duration: float | None
    direction: Direction
    start: float
    fall: bool
    gravity: float
    duration: float

    def __init__(
        self,
        *,
        drop_height: float,
        rebound: float = 0.0,
        pulse_duration: float | None = None,
        direction: str | Sequence[float] = "z",
        start: float = 0.0,
        fall: bool = False,
        gravity: float = STANDARD_GRAVITY,
    ) -> None:
        object.__setattr__(self, "drop_height", ranges.level("drop_height", positive("drop_height", drop_height)))
        object.__setattr__(self, "rebound", between("rebound", rebound, 0.0, 1.0))
        length = None if pulse_duration is None else ranges.length("pulse_duration", pulse_duration)
        object.__setattr__(self, "pulse_duration", length)
        object.__setattr__(self, "direction", checked_direction(direction))
        object.__setattr__(self, "start", ranges.start("start", start))
        object.__setattr__(self, "fall", bool(fall))
        object.__setattr__(self, "gravity", positive("gravity", gravity))
        object.__setattr__(self, "duration", self.fall_duration + (length or 0.0))

    @property
    def impact_velocity(self) -> float:
        """Velocity V at which the table strikes [m/s]."""
        return math.sqrt(2 * self.gravity * self.drop_height)

    @property
    def velocity_change(self) -> float:
        """Velocity change V (1 + e) of the impact [m/s]."""
        return self.impact_velocity * (1 + self.rebound)

    @property
    def peak(self) -> float:
        """Peak acceleration of the programmer's half-sine [m/s^2]; infinite if the velocity changes at once."""
        return math.inf if self.pulse_duration is None else self._pulse(self.pulse_duration).peak

    @property
    def fall_duration(self) -> float:
        """Length of the fall that is played [s]: sqrt(2 h/g), or zero."""
        return self.impact_velocity / self.gravity if self.fall else 0.0

    @property
    def impact(self) -> float:
        """Instant at which the table strikes [s]."""
        return self.start + self.fall_duration

    @property
    def corners(self) -> Array:
        """Release, impact and end of the pulse [s], (n,)."""
        return unique_times([self.start, self.impact, self.end])

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        """The impact, if the velocity changes at once."""
        return () if self.pulse_duration is not None else ((self.impact, self.velocity_change * self.unit),)

    @property
    def description(self) -> str:
        """For instance `drop table 0.5 m, rebound 0.2, 3.758 m/s in 11 ms along z`."""
        pulse = "at once" if self.pulse_duration is None else f"in {1e3 * self.pulse_duration:.4g} ms"
        falls = " after its fall" if self.fall else ""
        size = f"{self.drop_height:.4g} m, rebound {self.rebound:.4g}, {self.velocity_change:.4g} m/s {pulse}{falls}"
        return f"drop table {size} {self._line_text}"

    @property
    def events(self) -> tuple[tuple[float, str], ...]:
        """Release, impact and its end."""
        release = ((self.start, "table falls"),) if self.fall else ()
        over = ((self.end, "impact ends"),) if self.pulse_duration is not None else ()
        return (*release, (self.impact, "table strikes"), *over)

    @property
    def shortest_time(self) -> float:
        """Length of the half-sine [s]; infinite if the velocity changes at once."""
        return self.pulse_duration if self.pulse_duration is not None else math.inf

    def _pulse(self, length: float) -> HalfSine:
        peak = math.pi * self.velocity_change / (2 * length)
        return HalfSine(peak=peak, duration=length, direction=self.direction, start=self.impact)

    def _parameters(self, files: Mapping[Path, str]) -> dict[str, Any]:
        values = {"drop_height": self.drop_height, "rebound": self.rebound, "start": self.start, "fall": self.fall}
        length = {} if self.pulse_duration is None else {"pulse_duration": self.pulse_duration}
        return {**values, **length, "gravity": self.gravity, "direction": plain_direction(self.direction)}

    def _along(self, t: Array, order: int) -> Array:
        fallen, since = np.clip(t - self.start, 0.0, self.fall_duration), np.maximum(t - self.impact, 0.0)
        fall = (
            -self.gravity * fallen * (fallen / 2 + since),
            -self.gravity * fallen,
            np.where((t >= self.start) & (t < self.impact), -self.gravity, 0.0),
        )[order]
        if self.pulse_duration is not None:
            return fall + self._pulse(self.pulse_duration)._along(t, order)
        if order == 2:
            return fall
        return fall + (
            self.velocity_change * since if order == 0 else np.where(t >= self.impact, self.velocity_change, 0.0)
        )
