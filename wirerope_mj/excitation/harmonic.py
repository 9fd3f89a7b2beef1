"""Steady sine and logarithmic sine sweep of constant acceleration amplitude."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wirerope_mj.excitation.checks import (
    Direction,
    as_times,
    checked_direction,
    direction_text,
    nonzero,
    plain_direction,
    positive,
)
from wirerope_mj.excitation.motion import StraightMotion
from wirerope_mj.excitation.sweep_integrals import oscillating_tails
from wirerope_mj.units import STANDARD_GRAVITY


@dataclass(frozen=True, init=False)
class Sine(StraightMotion):
    """Steady sine a = A sin(w t), v = -(A/w) cos(w t), x = -(A/w^2) sin(w t); the base already oscillates at time 0.

    With a duration the acceleration ends there and the base coasts at the velocity that it then has; that velocity is
    zero if the duration is an odd multiple of a quarter period.

    Args:
        frequency: Frequency [Hz].
        acceleration: Acceleration amplitude A [m/s^2].
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        duration: Instant at which the acceleration ends [s]; None: never.
    """

    kind: ClassVar[str] = "sine"

    frequency: float
    amplitude: float
    direction: Direction
    duration: float

    def __init__(
        self, *, frequency: float, acceleration: float, direction: str | Sequence[float], duration: float | None = None
    ) -> None:
        object.__setattr__(self, "frequency", positive("frequency", frequency))
        object.__setattr__(self, "amplitude", nonzero("acceleration", acceleration))
        object.__setattr__(self, "direction", checked_direction(direction))
        object.__setattr__(self, "duration", math.inf if duration is None else positive("duration", duration))

    @property
    def corners(self) -> NDArray[np.float64]:
        """End of the sine [s], shape (1,), or nothing if it has none."""
        return np.array([self.duration] if math.isfinite(self.duration) else [])

    @property
    def description(self) -> str:
        """For instance `sine 10 Hz 0.5 g along z`."""
        level = f"{self.frequency:.4g} Hz {self.amplitude / STANDARD_GRAVITY:.4g} g"
        return f"sine {level} along {direction_text(self.direction)}"

    @property
    def events(self) -> tuple[tuple[float, str], ...]:
        """Start of the sine, and its end if it has one."""
        ends = ((self.duration, "sine ends"),) if math.isfinite(self.duration) else ()
        return ((0.0, f"sine of {self.frequency:.4g} Hz begins"), *ends)

    @property
    def shortest_time(self) -> float:
        """Period [s]."""
        return 1 / self.frequency

    def _parameters(self, files: Mapping[Path, str]) -> dict[str, Any]:
        direction = plain_direction(self.direction)
        values = {"frequency": self.frequency, "acceleration": self.amplitude, "direction": direction}
        return {**values, "duration": self.duration} if math.isfinite(self.duration) else values

    @property
    def _omega(self) -> float:
        return 2 * math.pi * self.frequency

    def _acceleration(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.where(t < self.duration, self.amplitude * np.sin(self._omega * t), 0.0)

    def _velocity(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        return -self.amplitude / self._omega * np.cos(self._omega * np.minimum(t, self.duration))

    def _displacement(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        within = np.minimum(t, self.duration)
        oscillation = -self.amplitude / self._omega**2 * np.sin(self._omega * within)
        return oscillation + self._velocity(within) * (t - within)


@dataclass(frozen=True, init=False)
class Sweep(StraightMotion):
    """Logarithmic sine sweep of constant acceleration amplitude, up or down.

    With w0 = 2 pi start, K = rate ln 2 / 60, s = +1 (up) or -1 (down), and u = w/K, u0 = w0/K,

        w(t) = w0 e^(s K t),    phase = s (u - u0),    a = A sin(phase),
        v = -(A/K) Im[e^(i (u - u0)) h1(u)],    x = s (A/K^2) Im[e^(i (u - u0)) h2(u)],

    where h1 and h2 are the integrals of `oscillating_tails`. Their constants of integration are those that vanish for
    large u, so that v and x differ from -(A/w) cos(phase) and -(A/w^2) sin(phase) by a share of the order of 1/u only:
    the base starts on the steady oscillation and drifts nowhere, however long the sweep.

    After `duration` the oscillation goes on at the stop frequency with nothing jumping. The share of 1/u by which the
    velocity then differs from that of a steady sine stays as a slow drift; for 2 octaves/min and 30 Hz it is at most
    1/8160 of the velocity amplitude. A run is best ended where the sweep ends.

    Args:
        start: Frequency at time 0 [Hz].
        stop: Frequency at the end [Hz]; below `start` the sweep goes down.
        rate: Sweep rate [octaves/min], positive in both directions.
        acceleration: Acceleration amplitude A [m/s^2].
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
    """

    kind: ClassVar[str] = "sweep"

    start: float
    stop: float
    rate: float
    amplitude: float
    direction: Direction
    duration: float

    def __init__(
        self, *, start: float, stop: float, rate: float, acceleration: float, direction: str | Sequence[float]
    ) -> None:
        object.__setattr__(self, "start", positive("start", start))
        object.__setattr__(self, "stop", positive("stop", stop))
        if self.start == self.stop:
            raise ValueError(f"`stop` must differ from `start`, got {self.stop!r} Hz for both; use Sine instead.")
        object.__setattr__(self, "rate", positive("rate", rate))
        object.__setattr__(self, "amplitude", nonzero("acceleration", acceleration))
        object.__setattr__(self, "direction", checked_direction(direction))
        object.__setattr__(self, "duration", 60 * abs(math.log2(self.stop / self.start)) / self.rate)

    def frequency(self, time: ArrayLike) -> NDArray[np.float64]:
        """Returns the instantaneous frequency [Hz] at the times [s], shape (n_t,)."""
        t = as_times(time)
        within = self.start * np.exp(self._sign * self._growth * np.minimum(t, self.duration))
        return np.where(t < self.duration, within, self.stop)

    @property
    def corners(self) -> NDArray[np.float64]:
        """End of the sweep [s], shape (1,)."""
        return np.array([self.duration])

    @property
    def description(self) -> str:
        """For instance `sweep 0.1 to 30 Hz, 2 octaves/min, 0.1 g along z`."""
        course = f"sweep {self.start:.4g} to {self.stop:.4g} Hz, {self.rate:.4g} octaves/min"
        return f"{course}, {self.amplitude / STANDARD_GRAVITY:.4g} g along {direction_text(self.direction)}"

    @property
    def events(self) -> tuple[tuple[float, str], ...]:
        """Start and end of the sweep."""
        begins = f"sweep begins at {self.start:.4g} Hz"
        return (0.0, begins), (self.duration, f"sweep reaches {self.stop:.4g} Hz")

    @property
    def shortest_time(self) -> float:
        """Period at the highest frequency [s]."""
        return 1 / max(self.start, self.stop)

    def _parameters(self, files: Mapping[Path, str]) -> dict[str, Any]:
        values = {"start": self.start, "stop": self.stop, "rate": self.rate, "acceleration": self.amplitude}
        return {**values, "direction": plain_direction(self.direction)}

    @property
    def _sign(self) -> float:
        return 1.0 if self.stop > self.start else -1.0

    @property
    def _growth(self) -> float:
        """K: the relative growth of the frequency, either way [1/s]."""
        return self.rate * math.log(2) / 60

    def _angle(self, within: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns u and u - u0 at times up to the end of the sweep; the difference is taken without cancellation."""
        u0 = 2 * math.pi * self.start / self._growth
        exponent = self._sign * self._growth * within
        return u0 * np.exp(exponent), u0 * np.expm1(exponent)

    def _phase(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        within = np.minimum(t, self.duration)
        return self._sign * self._angle(within)[1] + 2 * math.pi * self.stop * (t - within)

    def _acceleration(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.amplitude * np.sin(self._phase(t))

    def _velocity(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        within = np.minimum(t, self.duration)
        u, angle = self._angle(within)
        velocity = -self.amplitude / self._growth * np.imag(np.exp(1j * angle) * oscillating_tails(u)[0])
        omega = 2 * math.pi * self.stop
        return velocity - self.amplitude / omega * (np.cos(self._phase(t)) - np.cos(self._phase(within)))

    def _displacement(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        within = np.minimum(t, self.duration)
        u, angle = self._angle(within)
        scale = self._sign * self.amplitude / self._growth**2
        displacement = scale * np.imag(np.exp(1j * angle) * oscillating_tails(u)[1])
        if not np.any(t > self.duration):
            return displacement
        omega = 2 * math.pi * self.stop
        last = self._phase(within)
        drift = self._velocity(within) + self.amplitude / omega * np.cos(last)
        oscillation = -self.amplitude / omega**2 * (np.sin(self._phase(t)) - np.sin(last))
        return displacement + drift * (t - within) + oscillation
