"""Steady sine of the base, and unbalance of machines that rotate or reciprocate on the payload."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import as_times, finite, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike, Entries
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text, unit_vector
from wirerope_mj.foundation.quantities import Phrase
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.doubts import doubt_of_swing
from wirerope_mj.motions.motion import BaseMotion, Said, StraightMotion
from wirerope_mj.motions.payload_forces import PayloadForce
from wirerope_mj.motions.phrases import START, SpokenMotion, made_of, site_first


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
    def doubt(self) -> str:
        """Question whether a unit is wrong, if nothing swings so; else ""."""
        return doubt_of_swing(self.frequency, abs(self.amplitude))

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
        """Evaluate displacement (order 0), velocity (1) or acceleration (2); after the end the base coasts, (n_t,)."""
        if order == 2:
            return np.where(t < self.duration, self.amplitude * np.sin(self._omega * t), 0.0)
        within = np.minimum(t, self.duration)
        velocity = -self.amplitude / self._omega * np.cos(self._omega * within)
        if order == 1:
            return velocity
        return -self.amplitude / self._omega**2 * np.sin(self._omega * within) + velocity * (t - within)


_PHRASE: Entries = {
    "needs": {"unbalance": 1}, "words": START | {"order": "", "for": "time"}, "begins": site_first,
    "may": {"time": 1, "frequency": 2},
}  # fmt: skip


def _shaft(kind: str, shape: Callable[..., BaseMotion], phrase: Phrase, direction: Direction, _: int, site: str) -> BaseMotion:
    """Make an unbalance from a phrase; its direction is that of `kind`: the "axis" of rotation or "line" of reciprocation."""
    named, frequencies = phrase.named, phrase.quantities.get("frequency", ())
    if len(frequencies) != (2 if "time" in phrase.quantities else 1):
        raise ValueError("one frequency must stand there, or two and the time of the run-up between them.")
    values: Entries = {"unbalance": phrase.one("unbalance"), "frequency": frequencies[0], kind: direction}
    values |= {"order": named.get("order", 1.0), "start": phrase.start}
    if len(frequencies) == 2:
        values |= {"final_frequency": frequencies[1], "run_up": phrase.one("time")}
    return shape(site=site, **values | ({"duration": named["for"]} if "for" in named else {}))


@dataclass(frozen=True, kw_only=True)
class Unbalance(PayloadForce):
    """Inertia force of a mass that rotates or reciprocates with a shaft, at constant speed or running up or down.

    The shaft turns by phi with phi' = w and phi'' = a: at `frequency`, or from `frequency` to `final_frequency` at a constant
    rate within `run_up`. With k the order, U the unbalance, u and v the axes across the shaft,

        rotating:        F = U [(k^2 w^2 cos k phi + k a sin k phi) u + (k^2 w^2 sin k phi - k a cos k phi) v]
        reciprocating:   F = U  (k^2 w^2 cos k phi + k a sin k phi) along the line

    which is minus mass times acceleration of the eccentric mass; that mass itself is part of the body's.
    """

    kind: ClassVar[str] = "unbalance"
    phrases = (
        SpokenMotion(
            name="unbalance", example="engine 20 kg.mm 5 to 30 Hz 20 s x", **_PHRASE, make=partial(_shaft, "axis"),
            summary="a force on the payload, at its site force/engine: unbalance of a shaft about x, running up within 20 s; "
            '"25 Hz" for constant speed; "order 2", "for 10 s".',
        ),
        SpokenMotion(
            name="reciprocating", example="engine 8 kg.mm 25 Hz order 2 z", **_PHRASE, make=partial(_shaft, "line"),
            summary="the same of what moves to and fro along z.",
        ),
    )  # fmt: skip

    site: str
    unbalance: float  #: mass times eccentricity, or reciprocating mass times amplitude, U [kg m]
    frequency: float  #: speed of the shaft [Hz]; at the start where it runs up, >= 0 then
    #: shaft about which it rotates, `"x"`, `"y"`, `"z"` or a 3-vector, site axes; None with `line`
    axis: Direction | None = None
    line: Direction | None = None  #: line along which it reciprocates, given likewise; None with `axis`
    order: float = 1.0  #: multiple of the shaft's speed
    final_frequency: float | None = None  #: speed at the end of the run-up [Hz]; None: constant speed
    run_up: float = 0.0  #: length of the run-up [s]; the final speed stays after it
    phase: float = 0.0  #: k phi at the start [rad]
    start: float = 0.0  #: instant at which it begins [s]
    duration: float = math.inf  #: length [s]; endless by default

    def __post_init__(self) -> None:
        self._check()
        if (self.axis is None) == (self.line is None):
            raise ValueError("one of `axis`, about which it rotates, and `line`, along which it reciprocates, must be given.")
        runs_up = self.final_frequency is not None
        values = {
            "unbalance": ranges.level("unbalance", self.unbalance),
            "frequency": ranges.frequency("frequency", self.frequency, least=0.0 if runs_up else ranges.SLOWEST),
            "order": positive("order", ranges.level("order", self.order)),
            "run_up": ranges.length("run_up", self.run_up, least=ranges.SHORTEST if runs_up else 0.0),
            "phase": finite("phase", self.phase),
            "duration": self.duration if self.duration == math.inf else ranges.length("duration", self.duration),
        }
        if runs_up:
            values["final_frequency"] = ranges.frequency("final_frequency", self.final_frequency, least=0.0)
        elif self.run_up:
            raise ValueError("`run_up` needs `final_frequency`.")
        fastest = max(values["frequency"], values.get("final_frequency", 0.0))
        ranges.frequency("order` times `frequency", values["order"] * fastest, least=0.0)
        self._set(**values)
        for name in ("axis", "line"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, checked_direction(getattr(self, name), name))

    @cached_property
    def _across(self) -> tuple[Array, Array]:
        """Unit vectors u and v across the shaft, right-handed with it, (3,); of a line, its unit vector and zero."""
        if self.line is not None:
            return unit_vector(self.line), np.zeros(3)
        assert self.axis is not None
        shaft = unit_vector(self.axis)
        u = np.roll(np.eye(3)[int(np.argmax(np.abs(shaft)))], 1)  # the next axis: y of x, z of y, x of z
        u -= (u @ shaft) * shaft
        u /= np.linalg.norm(u)
        return u, np.cross(shaft, u)

    def shaft_frequency(self, time: ArrayLike) -> Array:
        """Return the speed of the shaft at the times [s], in Hz, (n_t,)."""
        t = as_times(time) - self.start
        if self.final_frequency is None:
            return np.full(t.size, self.frequency)
        progress = np.clip(t / self.run_up, 0.0, 1.0)
        return self.frequency + (self.final_frequency - self.frequency) * progress

    def _wrench(self, t: Array) -> Array:
        """Evaluate the inertia force by the shaft's angle, speed and acceleration at times since the start, (n_t, 6)."""
        omega = 2.0 * math.pi * self.shaft_frequency(t + self.start)
        shaft_angle, alpha = 2.0 * math.pi * self.frequency * t, np.zeros(t.size)
        if self.final_frequency is not None:
            rate = 2.0 * math.pi * (self.final_frequency - self.frequency) / self.run_up
            during = np.minimum(t, self.run_up)
            shaft_angle = shaft_angle + rate * during * (t - 0.5 * during)
            alpha[t < self.run_up] = rate
        angle, k = self.order * shaft_angle + self.phase, self.order
        (cosine, sine), square = (np.cos(angle), np.sin(angle)), (k * omega) ** 2
        u, v = self._across
        wrench = np.zeros((t.size, 6))
        along_u, along_v = square * cosine + k * alpha * sine, square * sine - k * alpha * cosine
        wrench[:, :3] = self.unbalance * (along_u[:, np.newaxis] * u + along_v[:, np.newaxis] * v)
        return wrench

    @property
    def corners(self) -> Array:
        """Start and end, and the end of the run-up [s], (n,)."""
        if self.final_frequency is None or self.run_up >= self.duration:
            return super().corners
        return np.sort(np.append(super().corners, self.start + self.run_up))

    def _described(self) -> tuple[str, float]:
        """Describe the unbalance in a line, such as `unbalance 0.02 kg m at engine about x, 25 Hz`."""
        about, along = (direction_text(direction) for direction in (self.axis or "z", self.line or "z"))
        orientation = f"about {about}" if self.axis is not None else f"along {along}"
        speed = f"{self.frequency:.4g} Hz"
        if self.final_frequency is not None:
            speed = f"{self.frequency:.4g} to {self.final_frequency:.4g} Hz in {self.run_up:.4g} s"
        order = f", order {self.order:g}" if self.order != 1.0 else ""
        period = 1.0 / (self.order * max(self.frequency, self.final_frequency or 0.0))
        return f"unbalance {self.unbalance:.4g} kg m at {self.site} {orientation}, {speed}{order}", period
