"""The motion of a ship in waves: surge, sway, heave, roll, pitch and yaw by amplitude and period."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import finite
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.quantities import Phrase
from wirerope_mj.motions import ranges
from wirerope_mj.motions.envelope import Envelope
from wirerope_mj.motions.motion import BaseMotion, Said
from wirerope_mj.motions.phrases import SpokenMotion

SHIFTS, TURNS = ("surge", "sway", "heave"), ("roll", "pitch", "yaw")  # along and about x, y, z
_PLACE = ("forward", "port", "above")  # words for the equipment's place along x, y, z
LARGEST_ANGLE = math.radians(89.0)  # at a pitch of 90 deg roll and yaw are one
PERIODS = (0.5, 1000.0)  # least and largest [s]: no hull follows faster waves, and a slower one merely leans
Swing = tuple[float, float]  # amplitude [m or rad] and period [s]


def _make(shape: Callable[..., Any], phrase: Phrase, *_: object) -> Any:
    """Make a ship motion from a phrase, in which an amplitude and a period stand behind each of roll, heave and the like."""
    named, periods = phrase.named, phrase.quantities.get("time", ())
    swings = [word for word in named if word in SHIFTS + TURNS]
    if len(periods) != len(swings):
        raise ValueError(f"a period must stand behind each of {', '.join(swings) or 'roll, pitch, ..'}, got {len(periods)}.")
    place = tuple(named.get(word, 0.0) for word in _PLACE)
    lengths = {key: named[word] for word, key in (("ramp", "ramp"), ("for", "duration")) if word in named}
    given = {word: (named[word], period) for word, period in zip(swings, periods, strict=True)}
    return shape(**given, position=place, start=phrase.start, **lengths)


@dataclass(frozen=True, kw_only=True)
class ShipMotion(BaseMotion):
    """Harmonic motion of a ship in waves, and the motion of a base at some place aboard.

    Each of its six parts is w(t) A sin(2 pi (t - start) / T), x forward, y to port, z up: surge, sway and heave move the point
    about which the ship turns, the base turns by roll, pitch and yaw (`BaseMotion`), and its origin swings about that point. A
    positive roll puts starboard down, a positive pitch the bow. w grows from 0 to 1 within the ramp, as `Envelope` has it,
    and falls so at the end, so that a base at rest and upright begins without a jump of its acceleration.

    All parts begin with the same phase; for others add motions with starts of their own.
    """

    kind: ClassVar[str] = "ship-motion"
    phrases = (
        SpokenMotion(
            name="ship-motion", example="roll 20 deg 9 s pitch 5 deg 7 s heave 1 m 8 s above 10 m for 40 s",
            summary="a ship in waves: amplitude and period of roll, pitch, yaw, heave, sway, surge; the equipment's place from "
            'the point about which it turns, "above", "forward", "port"; "ramp 9 s", "for 40 s".',
            needs={}, may={"time": 6}, make=_make, directed=False,
            words=dict.fromkeys(TURNS, "angle") | dict.fromkeys(SHIFTS + _PLACE, "displacement")
            | dict.fromkeys(("ramp", "for", "at"), "time"),
        ),
    )  # fmt: skip

    roll: Swing | None = None  #: amplitude [rad], half of what it sweeps, and period [s]; so are those of pitch and yaw
    pitch: Swing | None = None
    yaw: Swing | None = None
    surge: Swing | None = None  #: amplitude [m] and period [s]; so are those of sway and heave
    sway: Swing | None = None
    heave: Swing | None = None
    #: place of the base's own origin from the point about which the ship turns [m], forward, to port, up, (3,)
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ramp: float | None = None  #: time within which it grows, and at its end falls [s]; None: the longest period
    duration: float = math.inf  #: length with both ramps [s]; endless by default
    start: float = 0.0  #: instant at which it begins [s]

    def __post_init__(self) -> None:
        for name in SHIFTS + TURNS:
            if (value := getattr(self, name)) is None:
                continue
            if not isinstance(value, tuple | list) or len(value) != 2:
                raise ValueError(f"`{name}` must be amplitude and period, got {value!r}.")
            amplitude = ranges.level(f"{name}", value[0])
            if name in TURNS and abs(amplitude) > LARGEST_ANGLE:
                raise ValueError(
                    f"`{name}` must be at most {math.degrees(LARGEST_ANGLE):g} deg, got {math.degrees(amplitude):.4g}."
                )
            shortest, longest = PERIODS
            if not shortest <= (period := finite(f"period of {name}", value[1])) <= longest:
                raise ValueError(
                    f"`{name}` must have a period of {shortest:g} to {longest:g} s, got {period:g}: waves move boats in 1 s "
                    "and more, ships in 3 to 30 s. What is faster is a vibration along an axis, such as a sine."
                )
            self._set(**{name: (amplitude, period)})
        if not self._swings:
            raise ValueError(f"one of {', '.join(TURNS + SHIFTS)} must be given.")
        if not isinstance(self.position, tuple | list) or len(self.position) != 3:
            raise ValueError(f"`position` must be three lengths, got {self.position!r}.")
        self._set(position=tuple(finite("position", value) for value in self.position), start=ranges.start("start", self.start))
        longest = max(period for _, period in self._swings.values())
        self._set(ramp=longest if self.ramp is None else ranges.length("ramp", self.ramp))
        if self.duration != math.inf:
            self._set(duration=ranges.length("duration", self.duration))
            if self.duration < 2.0 * self._rise:
                raise ValueError(f"`duration` of {self.duration:g} s must hold both ramps, of {self._rise:g} s each.")

    @property
    def _swings(self) -> dict[str, Swing]:
        """Amplitudes and periods of the parts that are given, by name."""
        parts = {name: getattr(self, name) for name in TURNS + SHIFTS}
        return {name: value for name, value in parts.items() if value is not None}

    @property
    def _rise(self) -> float:
        assert self.ramp is not None  # chosen where none is given
        return self.ramp

    @property
    def _envelope(self) -> Envelope:
        return Envelope(start=self.start, stop=self.end, rise=self._rise, fall=self._rise)

    @property
    def rotates(self) -> bool:
        return any(getattr(self, name) is not None for name in TURNS)

    @property
    def centre(self) -> tuple[float, float, float]:
        x, y, z = self.position
        return 0.0 - x, 0.0 - y, 0.0 - z

    @property
    def end(self) -> float:
        """Instant at which the ship is at rest again [s]."""
        return self.start + self.duration

    @property
    def corners(self) -> Array:
        """Begin and end of both ramps [s], (n,)."""
        return self._envelope.corners

    @property
    def directions(self) -> Array:
        """Vectors that span the directions in which the base's origin moves, (n, 3)."""
        if self.rotates and any(self.position):
            return np.eye(3)
        return np.eye(3)[[getattr(self, name) is not None for name in SHIFTS]]

    def _parts(self, t: Array, order: int, names: tuple[str, ...]) -> Array:
        """Return three of the six parts, by `names`, as values (order 0), rates (1) or accelerations (2), (n_t, 3)."""
        values = np.zeros((t.size, 3))
        envelope = self._envelope.derivatives(t)
        for column, name in enumerate(names):
            if name in self._swings:
                amplitude, period = self._swings[name]
                omega = 2.0 * math.pi / period
                phase = omega * (t - self.start)
                sines = np.sin(phase), omega * np.cos(phase), -(omega**2) * np.sin(phase)
                terms = (math.comb(order, k) * envelope[k] * sines[order - k] for k in range(order + 1))
                values[:, column] = amplitude * sum(terms)
        return values

    def _derivative(self, t: Array, order: int) -> Array:
        return self._parts(t, order, SHIFTS)

    def _angles(self, t: Array, order: int) -> Array:
        return self._parts(t, order, TURNS)

    @cached_property
    def _said(self) -> Said:
        """Describe the motion in a line, such as `ship motion: roll 20 deg in 9 s, base 10 m above the axis`."""
        parts = [
            f"{name} {math.degrees(amplitude):.4g} deg in {period:.4g} s" if name in TURNS
            else f"{name} {amplitude:.4g} m in {period:.4g} s"
            for name, (amplitude, period) in self._swings.items()
        ]  # fmt: skip
        place = [f"{value:.4g} m {word}" for word, value in zip(_PLACE, self.position, strict=True) if value]
        text = f"ship motion: {', '.join(parts)}" + (f", {', '.join(place)} of where it turns" if place else "")
        ends = ((self.end, "ship at rest"),) if math.isfinite(self.end) else ()
        events = ((self.start, "ship motion begins"), (self.start + self._rise, "ship motion at full amplitude"), *ends)
        return Said(text, events, shortest_time=min(self._rise, *(period for _, period in self._swings.values())))
