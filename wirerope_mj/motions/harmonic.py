"""Steady sine, and logarithmic sine sweep of constant acceleration, velocity or displacement amplitude."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import as_times, the_one_given
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.motion import Said, StraightMotion
from wirerope_mj.motions.phrases import SpokenMotion, made_of
from wirerope_mj.motions.sweep_levels import FORMS, Course


@dataclass(frozen=True, init=False)
class Sine(StraightMotion):
    """Steady sine a = A sin(w t), v = -(A/w) cos(w t), x = -(A/w^2) sin(w t); the base already oscillates at time 0.

    With a duration the acceleration ends there and the base coasts at the velocity that it then has; that velocity is
    zero if the duration is an odd multiple of a quarter period.

    Args:
        frequency: frequency [Hz].
        acceleration: acceleration amplitude A [m/s^2].
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        duration: instant at which the acceleration ends [s]; None: never.
    """

    kind: ClassVar[str] = "sine"
    renamed: ClassVar[Mapping[str, str]] = {"acceleration": "amplitude"}
    phrases = (
        SpokenMotion(
            name="sine", example="0.5 g 12 Hz 10 s z", summary="steady sine: amplitude, frequency, length, direction.",
            needs={"acceleration": 1, "frequency": 1, "time": 1}, words={},
            make=made_of(started=False, frequency="frequency", acceleration="acceleration", duration="time"),
        ),
    )  # fmt: skip

    frequency: float
    amplitude: float
    direction: Direction
    duration: float

    def __init__(
        self, *, frequency: float, acceleration: float, direction: str | Sequence[float], duration: float | None = None
    ) -> None:
        self._set(frequency=ranges.frequency("frequency", frequency))
        self._set(amplitude=ranges.level("acceleration", acceleration))
        self._set(direction=checked_direction(direction))
        self._set(duration=math.inf if duration is None else ranges.length("duration", duration))

    @property
    def corners(self) -> Array:
        """End of the sine [s], (1,), or nothing if it has none."""
        return np.array([self.duration] if math.isfinite(self.duration) else [])

    @cached_property
    def _said(self) -> Said:
        """Describe the sine in a line, such as `sine 10 Hz 0.5 g along z`."""
        level = f"{self.frequency:.4g} Hz {self.amplitude / STANDARD_GRAVITY:.4g} g"
        ends = ((self.duration, "sine ends"),) if math.isfinite(self.duration) else ()
        events = ((0.0, f"sine of {self.frequency:.4g} Hz begins"), *ends)
        return Said(f"sine {level} along {direction_text(self.direction)}", events, shortest_time=1 / self.frequency)

    @property
    def _omega(self) -> float:
        return 2 * math.pi * self.frequency

    def _along(self, t: Array, order: int) -> Array:
        if order == 2:
            return np.where(t < self.duration, self.amplitude * np.sin(self._omega * t), 0.0)
        within = np.minimum(t, self.duration)
        velocity = -self.amplitude / self._omega * np.cos(self._omega * within)
        if order == 1:
            return velocity
        return -self.amplitude / self._omega**2 * np.sin(self._omega * within) + velocity * (t - within)


@dataclass(frozen=True, init=False)
class Sweep(StraightMotion):
    """Logarithmic sine sweep, up or down, of constant acceleration, velocity or displacement amplitude.

    With w0 = 2 pi start, K = rate ln 2 / 60, s = +1 (up) or -1 (down), and u = w/K, u0 = w0/K,

        w(t) = w0 e^(s K t),    phase = s (u - u0),

        acceleration A:  a = A sin(phase),   v = -(A/K) Im[e^(i (u - u0)) h1(u)],   x = s (A/K^2) Im[e^(i (u - u0)) h2(u)]
        velocity V:      a = V w sin(phase),   v = -V cos(phase),   x = s (V/K) Re[e^(i (u - u0)) h1(u)]
        displacement X:  a = X (w^2 sin(phase) - s K w cos(phase)),   v = -X w cos(phase),   x = -X sin(phase)

    where h1 and h2 are the integrals of `oscillating_tails`. Their constants of integration are those that vanish for
    large u, so that each differs from what a steady sine of that frequency would have by a fraction of the order of 1/u
    only: the base starts on the steady oscillation and drifts nowhere, however long the sweep.

    After `duration` the oscillation goes on at the stop frequency with neither velocity nor displacement jumping. The
    fraction of 1/u by which the velocity of a sweep of constant acceleration then differs from that of a steady sine stays
    as a slow drift; for 2 octaves/min and 30 Hz it is at most 1/8160 of the velocity amplitude. With a constant velocity
    the same fraction of the displacement stays as an offset. A run is best ended where the sweep ends.

    Args:
        start: frequency at time 0 [Hz].
        stop: frequency at the end [Hz]; below `start` the sweep goes down.
        rate: sweep rate [octaves/min], positive in both directions.
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        acceleration: acceleration amplitude A [m/s^2]; exactly one of the three amplitudes is given.
        velocity: velocity amplitude V [m/s].
        displacement: displacement amplitude X [m], half of what runs from peak to peak.
    """

    kind: ClassVar[str] = "sweep"
    phrases = (
        SpokenMotion(
            name="sweep", example="0.5 g 5 to 50 Hz 2 oct/min z",
            summary="logarithmic sine sweep: amplitude, frequencies, rate, direction.",
            needs={"acceleration": 1, "frequency": 2, "sweep rate": 1}, words={},
            make=lambda shape, phrase, direction, *_: shape(
                start=phrase.quantities["frequency"][0], stop=phrase.quantities["frequency"][1], direction=direction,
                rate=phrase.one("sweep rate"), acceleration=phrase.one("acceleration"),
            ),
        ),
    )  # fmt: skip

    start: float
    stop: float
    rate: float
    quantity: str
    amplitude: float
    direction: Direction
    duration: float

    def __init__(
        self, *, start: float, stop: float, rate: float, acceleration: float | None = None, velocity: float | None = None,
        displacement: float | None = None, direction: str | Sequence[float],
    ) -> None:  # fmt: skip
        self._set(start=ranges.frequency("start", start), stop=ranges.frequency("stop", stop))
        if self.start == self.stop:
            raise ValueError(f"`stop` must differ from `start`, got {self.stop!r} Hz for both; use Sine instead.")
        self._set(rate=ranges.sweep_rate("rate", rate))
        given = {"acceleration": acceleration, "velocity": velocity, "displacement": displacement}
        quantity, amplitude = the_one_given(given)
        self._set(quantity=quantity, amplitude=ranges.level(quantity, amplitude))
        self._set(direction=checked_direction(direction), duration=self.course.duration)

    @cached_property
    def course(self) -> Course:
        """Frequency and phase over time."""
        return Course(start=self.start, stop=self.stop, rate=self.rate)

    def frequency(self, time: ArrayLike) -> Array:
        """Return the instantaneous frequency [Hz] at the times [s], (n_t,)."""
        return self.course.frequency(as_times(time))

    @property
    def corners(self) -> Array:
        """End of the sweep [s], (1,)."""
        return np.array([self.duration])

    @cached_property
    def _said(self) -> Said:
        """Describe the sweep, such as `sweep 0.1 to 30 Hz, 2 octaves/min, 0.1 g along z`, or `... 50 mm/s along z`."""
        course = f"sweep {self.start:.4g} to {self.stop:.4g} Hz, {self.rate:.4g} octaves/min"
        if self.quantity == "acceleration":
            level = f"{self.amplitude / STANDARD_GRAVITY:.4g} g"
        else:
            level = f"{1e3 * self.amplitude:.4g} {'mm/s' if self.quantity == 'velocity' else 'mm'}"
        text = f"{course}, {level} along {direction_text(self.direction)}"
        events = (0.0, f"sweep begins at {self.start:.4g} Hz"), (self.duration, f"sweep reaches {self.stop:.4g} Hz")
        return Said(text, events, shortest_time=1 / max(self.start, self.stop))

    def _argument(self, name: str) -> object:
        return (self.amplitude if name == self.quantity else None) if name in FORMS else super()._argument(name)

    def _along(self, t: Array, order: int) -> Array:
        return self.amplitude * FORMS[self.quantity][order](self.course, t)
