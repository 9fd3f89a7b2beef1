"""Shocks of test machines: the decaying oscillation of a struck deck, and the impact of a drop table."""

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import between, finite, positive, the_one_given
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.doubts import doubt_of_velocity
from wirerope_mj.motions.motion import Said, StartedMotion, unique_times
from wirerope_mj.motions.phrases import START, SpokenMotion, made_of
from wirerope_mj.motions.pulses import HalfSine

LEFT_AT_END = 1e-3  # fraction of the oscillation that is left at `end`
# largest product of a blow's length and the deck's decay rate: the oscillation that its beginning excites is gone long
# before its end, and e to that power is far from overflow
SLOWEST_BLOW = 100.0
# periods of the deck that a blow lasts, and acceleration of its free oscillation [m/s^2], beyond which units are questioned
_LONGEST_BLOW, _LARGEST_PEAK = 2.0, 1e4


@dataclass(frozen=True, init=False)
class DecayingSine(StartedMotion):
    """Deck of one frequency that is struck and oscillates freely: velocity and displacement return to zero by themselves.

    The displacement x of the deck, at rest before `start`, obeys

        x'' + 2 zeta w0 x' + w0^2 x = f(t),    w0 = 2 pi frequency,    integral of f = V

    with f a blow that gives the velocity V at once (`impact_duration` zero), so that with wd = w0 sqrt(1 - zeta^2)

        x = (V/wd) e^(-zeta w0 t) sin(wd t),

    or a half-sine of the length D, (pi V/2D) sin(pi t/D), so that nothing jumps. Decks of several frequencies are sums of such
    motions.

    Args:
        frequency: undamped frequency of the deck [Hz].
        damping: damping ratio zeta, above 0 and below 1.
        velocity: velocity V that the blow gives [m/s]; negative for a blow against the direction.
        acceleration: instead of the velocity: amplitude [m/s^2] of the free oscillation's acceleration, its envelope drawn
            back to `start`.
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        impact_duration: length D of the blow [s]; 0: the velocity jumps.
        start: instant at which the deck is struck [s].
    """

    kind: ClassVar[str] = "decaying-sine"
    renamed: ClassVar[Mapping[str, str]] = {"velocity": "level", "acceleration": "level"}
    phrases = (
        SpokenMotion(
            name="struck-deck", example="14 Hz 1.5 m/s damping 5 % blow 4 ms z",
            summary="a deck of one frequency under a blow: frequency, velocity, damping, length of the blow, direction.",
            needs={"frequency": 1, "velocity": 1}, words=START | {"damping": "ratio", "blow": "time"},
            needed_words=("damping", "blow"),
            make=made_of(frequency="frequency", damping="damping", velocity="velocity", impact_duration="blow"),
        ),
    )  # fmt: skip

    frequency: float
    damping: float
    quantity: str
    level: float
    direction: Direction
    impact_duration: float
    start: float
    duration: float  #: time until a thousandth of the oscillation is left [s]; it goes on, exactly, after that

    def __init__(
        self, *, frequency: float, damping: float, velocity: float | None = None, acceleration: float | None = None,
        direction: str | Sequence[float], impact_duration: float = 0.0, start: float = 0.0,
    ) -> None:  # fmt: skip
        self._set(frequency=ranges.frequency("frequency", frequency))
        if not 0 < finite("damping", damping) < 1:
            raise ValueError(f"`damping` must lie above 0 and below 1, for the deck must come to rest, got {damping!r}.")
        quantity, level = the_one_given({"velocity": velocity, "acceleration": acceleration})
        self._set(damping=float(damping), quantity=quantity, level=ranges.level(quantity, level))
        self._set(direction=checked_direction(direction))
        self._set(impact_duration=ranges.length("impact_duration", impact_duration, least=0.0))
        self._set(start=ranges.start("start", start))
        fading = -math.log(LEFT_AT_END) / (self.damping * self._omega)
        if fading > ranges.LONGEST:
            raise ValueError(
                f"`damping` of {self.damping!r} lets the deck swing for {fading:.3g} s; it must come to rest within "
                f"{ranges.LONGEST:g} s."
            )
        self._set(duration=self.impact_duration + fading)
        if self.damping * self._omega * self.impact_duration > SLOWEST_BLOW:
            raise ValueError(
                f"`impact_duration` of {self.impact_duration:.4g} s is no blow on this deck, whose oscillation fades within "
                f"{fading:.4g} s: it must be shorter than {SLOWEST_BLOW / (self.damping * self._omega):.4g} s."
            )

    @property
    def velocity_change(self) -> float:
        """Velocity V that the blow gives [m/s], whichever level was given."""
        if self.quantity == "velocity":
            return self.level
        return self.level / (self._omega**2 * abs(self._free))

    @property
    def doubt(self) -> str:
        """Question whether a unit is wrong, if the blow's length, acceleration or velocity is beyond any deck's; else ""."""
        if self.impact_duration * self.frequency > _LONGEST_BLOW:
            return (
                f"its blow of {self.impact_duration:.4g} s lasts longer than two periods of the deck, "
                f"{1.0 / self.frequency:.3g} s each: was {self.impact_duration:.4g} ms meant?"
            )
        peak = abs(self.velocity_change) * self._omega
        if peak > _LARGEST_PEAK:
            return (
                f"its acceleration would reach {peak / STANDARD_GRAVITY:.4g} g without a blow's length, more than that of any "
                "deck: are frequency and velocity in Hz and m/s?"
            )
        return doubt_of_velocity(self.velocity_change, 0.0, "is it in mm/s, or in another unit?")

    @property
    def corners(self) -> Array:
        """Start and end of the blow [s], (n,)."""
        return unique_times([self.start, self.start + self.impact_duration])

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        """Instant [s] and jump (3,) [m/s] of a blow of no length; empty for others."""
        return () if self.impact_duration else ((self.start, self.velocity_change * self.unit),)

    @cached_property
    def _said(self) -> Said:
        """Describe the deck in a line, such as `deck of 14 Hz, damping 0.05, struck to 2 m/s along z`."""
        deck = f"deck of {self.frequency:.4g} Hz, damping {self.damping:.4g}, struck to {self.velocity_change:.4g} m/s"
        blow = f" in {1e3 * self.impact_duration:.4g} ms" if self.impact_duration else ""
        events = (self.start, f"deck of {self.frequency:.4g} Hz is struck"), (self.end, "deck is at rest within 0.1 %")
        return Said(
            f"{deck}{blow} {self._line_text}", events, shortest_time=min(1 / self.frequency, self.impact_duration or math.inf)
        )

    @property
    def _omega(self) -> float:
        return 2 * math.pi * self.frequency

    @property
    def _root(self) -> complex:
        """Exponent s = -zeta w0 + i wd of the free oscillation e^(s t)."""
        return self._omega * complex(-self.damping, math.sqrt(1 - self.damping**2))

    @cached_property
    def _forced(self) -> tuple[complex, complex]:
        """Complex amplitudes Q, K of Im(Q e^(i p t)) + Re(K e^(s t)), x in a blow of V = 1; p = pi/D, s is `_root`."""
        p = math.pi / self.impact_duration
        q = p / 2 / complex(self._omega**2 - p**2, 2 * self.damping * self._omega * p)
        at_rest = -q.imag
        return q, complex(at_rest, (p * q.real + self._root.real * at_rest) / self._root.imag)

    @cached_property
    def _free(self) -> complex:
        """Complex amplitude K of the displacement Re(K e^(s t)) after a blow of 1 m/s, s being `_root`."""
        if not self.impact_duration:
            return -1j / self._root.imag
        # The half-sine is a sine that starts at 0 and the same sine that starts at D: after that their forces cancel.
        return self._forced[1] * (1 + cmath.exp(-self._root * self.impact_duration))

    def _along(self, t: Array, order: int) -> Array:
        """Evaluate displacement (order 0), velocity (1) or acceleration (2) in the blow and in free oscillation, (n_t,)."""
        since = np.maximum(t - self.start, 0.0)
        value = np.real(self._free * self._root**order * np.exp(self._root * since))
        if self.impact_duration:
            q, k = self._forced
            p = 1j * math.pi / self.impact_duration
            swinging = np.real(k * self._root**order * np.exp(self._root * since))
            during = np.imag(q * p**order * np.exp(p * since)) + swinging
            value = np.where(t < self.start + self.impact_duration, during, value)
        return np.where(t >= self.start, self.velocity_change * value, 0.0)


@dataclass(frozen=True, kw_only=True)
class ShockTableImpact(StartedMotion):
    """Shock of a table that falls from a height, strikes its programmer and rebounds.

    The impact velocity is V = sqrt(2 g h), the rebound velocity e V, and the shock is their sum, V (1 + e), along the
    direction: at once, or as the half-sine of a programmer, whose peak is pi V (1 + e)/(2 D).

    By default only the impact is played, from rest: the payload then meets it settled on its mounts, and the base coasts
    at V (1 + e). That is the shock seen from a frame that moves with the falling table, but for one thing: a falling
    table leaves its payload weightless, so that the mounts have let go of their static deflection, or still swing about it,
    when the table strikes. With `fall` the fall of sqrt(2 h/g) is played too, at acceleration -g along the direction, which
    is what a payload in a model with gravity g against the direction must undergo to be weightless. Brakes and second impacts
    are left out.
    """

    kind: ClassVar[str] = "shock-table-impact"
    phrases: ClassVar[tuple[SpokenMotion, ...]] = (
        SpokenMotion(
            name="drop-table", example="500 mm rebound 0.2 11 ms z", needs={"displacement": 1}, may={"time": 1},
            summary="height of fall, rebound (0), half-sine of the programmer (at once), direction of the shock.",
            words=START | {"rebound": ""},
            make=lambda shape, phrase, direction, *_: shape(
                drop_height=phrase.one("displacement"), rebound=phrase.named.get("rebound", 0.0), direction=direction,
                pulse_duration=phrase.one("time") if "time" in phrase.quantities else None, start=phrase.start,
            ),
        ),
    )  # fmt: skip

    drop_height: float  #: height h [m]
    rebound: float = 0.0  #: rebound velocity over impact velocity e, from 0 (the table stays) to 1
    #: length D of the programmer's half-sine [s]; None: the velocity changes at once
    pulse_duration: float | None = None
    direction: Direction = "z"  #: of the shock, against that of the fall: `"x"`, `"y"`, `"z"` or a 3-vector
    start: float = 0.0  #: instant at which the motion begins [s]: the impact, or the release if the fall is played
    fall: bool = False  #: whether the fall before the impact is played
    gravity: float = STANDARD_GRAVITY  #: acceleration of the fall g [m/s^2]
    duration: float = field(init=False)  #: of the fall, if it is played, and of the half-sine [s]

    def __post_init__(self) -> None:
        length = self.pulse_duration
        self._set(
            drop_height=ranges.level("drop_height", positive("drop_height", self.drop_height)),
            rebound=between("rebound", self.rebound, 0.0, 1.0),
            pulse_duration=None if length is None else ranges.length("pulse_duration", length),
            direction=checked_direction(self.direction), start=ranges.start("start", self.start),
            fall=bool(self.fall), gravity=positive("gravity", self.gravity),
        )  # fmt: skip
        self._set(duration=self.fall_duration + (self.pulse_duration or 0.0))

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
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        """Instant [s] and jump (3,) [m/s] of the impact, if the velocity changes at once; else empty."""
        return () if self.pulse_duration is not None else ((self.impact, self.velocity_change * self.unit),)

    @cached_property
    def _said(self) -> Said:
        """Describe the impact in a line, such as `drop table 0.5 m, rebound 0.2, 3.758 m/s in 11 ms along z`."""
        pulse = "at once" if self.pulse_duration is None else f"in {1e3 * self.pulse_duration:.4g} ms"
        falls = " after its fall" if self.fall else ""
        size = f"{self.drop_height:.4g} m, rebound {self.rebound:.4g}, {self.velocity_change:.4g} m/s {pulse}{falls}"
        release = ((self.start, "table falls"),) if self.fall else ()
        over = ((self.end, "impact ends"),) if self.pulse_duration is not None else ()
        events = (*release, (self.impact, "table strikes"), *over)
        return Said(f"drop table {size} {self._line_text}", events, shortest_time=self.pulse_duration or math.inf)

    def _pulse(self, length: float) -> HalfSine:
        peak = math.pi * self.velocity_change / (2 * length)
        return HalfSine(peak=peak, duration=length, direction=self.direction, start=self.impact)

    def _along(self, t: Array, order: int) -> Array:
        """Evaluate displacement (order 0), velocity (1) or acceleration (2) of the fall, if played, and impact, (n_t,)."""
        fallen, since = np.clip(t - self.start, 0.0, self.fall_duration), np.maximum(t - self.impact, 0.0)
        falling = np.where((t >= self.start) & (t < self.impact), -self.gravity, 0.0)
        fall = (-self.gravity * fallen * (fallen / 2 + since), -self.gravity * fallen, falling)[order]
        if self.pulse_duration is not None:
            return fall + self._pulse(self.pulse_duration)._along(t, order)
        if order == 2:
            return fall
        return fall + self.velocity_change * (since if order == 0 else np.where(t >= self.impact, 1.0, 0.0))
