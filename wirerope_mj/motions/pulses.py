"""Shock pulses and the velocity step (IEC 60068-2-27, MIL-STD-810 method 516); hull plates under an underwater explosion."""

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import finite, positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction
from wirerope_mj.foundation.units import STANDARD_GRAVITY, duration_text
from wirerope_mj.motions import ranges
from wirerope_mj.motions.doubts import doubt_of_length, doubt_of_velocity
from wirerope_mj.motions.motion import Said, StartedMotion, unique_times
from wirerope_mj.motions.phrases import START, SpokenMotion, made_of
from wirerope_mj.motions.piecewise import PiecewiseLinear

_NEEDS: Mapping[str, int] = {"acceleration": 1, "time": 1}
_MAKE = made_of(peak="acceleration", duration="time")
SEA_WATER = 1025.0 * 1500.0  # density times velocity of sound [Pa s/m]
ALIKE = 1e-6  # distance of psi from 1 within which the formulas of psi = 1 are right to a millionth, and exact integrals
_RISE = 0.1  # rise and fall of a trapezoid over its length unless a phrase says them, as the shock standards draw it


@dataclass(frozen=True, kw_only=True)
class Pulse(StartedMotion):
    """Acceleration pulse along one direction: at rest before `start`, coasting at its velocity change after its end."""

    peak: float  # peak acceleration [m/s^2]; negative for a shock against the direction
    duration: float  # length of the pulse [s]
    direction: Direction  # `"x"`, `"y"`, `"z"` or a 3-vector
    start: float = 0.0  # instant at which the pulse begins [s]

    def __post_init__(self) -> None:
        self._set(peak=ranges.level("peak", self.peak), duration=ranges.length("duration", self.duration))
        self._set(direction=checked_direction(self.direction), start=ranges.start("start", self.start))

    @property
    @abstractmethod
    def velocity_change(self) -> float:
        """Velocity along the direction that the pulse leaves behind [m/s]."""

    @property
    def doubt(self) -> str:
        """Question whether a unit is wrong, if the pulse's length or velocity change is beyond those of tests; else ""."""
        too_long = doubt_of_length(self.duration, f"was {self.duration:.4g} ms meant?")
        return too_long or doubt_of_velocity(self.velocity_change, self.duration)

    @cached_property
    def _said(self) -> Said:
        """Describe the pulse in a line, such as `half-sine 15 g 11 ms along z`."""
        text = f"{self.kind} {self.peak / STANDARD_GRAVITY:.4g} g {duration_text(self.duration, 4)} {self._line_text}"
        return Said(text, ((self.start, f"{self.kind} begins"), (self.end, f"{self.kind} ends")), shortest_time=self.duration)


@dataclass(frozen=True, kw_only=True)
class HalfSine(Pulse):
    """Half-sine pulse, a = A sin(pi t / D); velocity change 2 A D / pi.

    `peak` is A [m/s^2], negative for a shock against the `direction` (`"x"`, `"y"`, `"z"` or a 3-vector), `duration` D [s];
    the pulse begins at `start` [s].
    """

    kind: ClassVar[str] = "half-sine"
    phrases = (
        SpokenMotion(
            name="half-sine", example="15 g 11 ms z", summary="peak, length, direction.", needs=_NEEDS, make=_MAKE
        ),
    )  # fmt: skip

    @property
    def velocity_change(self) -> float:
        """Velocity along the direction that the pulse leaves behind [m/s]."""
        return 2 * self.peak * self.duration / math.pi

    def _along(self, t: Array, order: int) -> Array:
        """Evaluate displacement (order 0), velocity (1) or acceleration (2) of the half-sine in closed form, (n_t,)."""
        # pi t / D, held at 0 before the pulse and at pi after it
        phase = np.minimum(np.maximum(math.pi * (t - self.start) / self.duration, 0.0), math.pi)
        if order == 2:
            return np.where((t >= self.start) & (t < self.end), self.peak * np.sin(phase), 0.0)
        if order == 1:
            # 2 sin^2(p/2) is 1 - cos p without its cancellation at the start of the pulse.
            return self.velocity_change * np.sin(phase / 2) ** 2
        within = self.velocity_change / 2 * self.duration / math.pi * (phase - np.sin(phase))
        return within + self.velocity_change * np.maximum(t - self.end, 0.0)


@dataclass(frozen=True, kw_only=True)
class Sawtooth(Pulse):
    """Terminal-peak sawtooth, a = A t / D and then at once zero; velocity change A D / 2. Arguments are those of `HalfSine`."""

    kind: ClassVar[str] = "sawtooth"
    phrases = (
        SpokenMotion(
            name="sawtooth", example="20 g 11 ms z", summary="terminal peak, length, direction.", needs=_NEEDS, make=_MAKE,
            written=r"(?:terminal[- ]peak[- ])?saw[- ]?tooth",
        ),
    )  # fmt: skip

    @property
    def velocity_change(self) -> float:
        return self.peak * self.duration / 2

    @cached_property
    def _piecewise(self) -> PiecewiseLinear:
        return PiecewiseLinear(np.array([self.start, self.end]), np.array([0.0, self.peak]))

    def _along(self, t: Array, order: int) -> Array:
        return self._piecewise.derivative(t, order)


@dataclass(frozen=True, kw_only=True)
class Trapezoid(Pulse):
    """Trapezoidal pulse with equal rise and fall r; velocity change A (D - r). With r = 0 it is a rectangle.

    A is the acceleration of the plateau, D includes rise and fall; the values are as in `HalfSine`.
    """

    kind: ClassVar[str] = "trapezoid"
    phrases = (
        SpokenMotion(
            name="trapezoid", example="10 g 18 ms rise 2 ms z", summary="peak, length, rise and fall, direction.",
            needs=_NEEDS, words=START | {"rise": "time"},
            make=lambda shape, phrase, direction, *_: shape(
                peak=phrase.one("acceleration"), duration=phrase.one("time"), direction=direction, start=phrase.start,
                rise=phrase.named.get("rise", _RISE * phrase.one("time")),
            ),
        ),
    )  # fmt: skip

    rise: float  #: length r of the rise, and of the fall [s]

    def __post_init__(self) -> None:
        super().__post_init__()
        rise = finite("rise", self.rise)
        if not 0 <= rise <= self.duration / 2:
            raise ValueError(f"`rise` must lie between 0 and half the duration, {self.duration / 2:g} s, got {rise!r}.")
        object.__setattr__(self, "rise", ranges.length("rise", rise, least=0.0))

    @property
    def velocity_change(self) -> float:
        return self.peak * (self.duration - self.rise)

    @property
    def corners(self) -> Array:
        """Start, ends of the plateau and end of the pulse [s], (n,)."""
        return unique_times(self._knots)

    @property
    def _knots(self) -> Array:
        return np.array([self.start, self.start + self.rise, self.start + (self.duration - self.rise), self.end])

    @cached_property
    def _piecewise(self) -> PiecewiseLinear:
        return PiecewiseLinear(self._knots, np.array([0.0, self.peak, self.peak, 0.0]))

    def _along(self, t: Array, order: int) -> Array:
        return self._piecewise.derivative(t, order)


@dataclass(frozen=True, init=False)
class VelocityStep(StartedMotion):
    """Sudden velocity of the base: at rest before `start`, at constant velocity from there on.

    The acceleration is zero; the jump itself stands in `velocity_jumps`. The `velocity` [m/s] after the step at `start` [s] is
    negative for a step against the `direction` (`"x"`, `"y"`, `"z"` or a 3-vector).
    """

    kind: ClassVar[str] = "velocity-step"
    renamed: ClassVar[Mapping[str, str]] = {"velocity": "velocity_change"}
    phrases = (
        SpokenMotion(
            name="velocity-step", example="2 m/s z", summary="velocity change at once.", needs={"velocity": 1},
            make=made_of(velocity="velocity"),
        ),
    )  # fmt: skip

    velocity_change: float
    direction: Direction
    start: float
    duration: float

    def __init__(self, *, velocity: float, direction: str | Sequence[float], start: float = 0.0) -> None:
        self._set(velocity_change=ranges.level("velocity", velocity), direction=checked_direction(direction))
        self._set(start=ranges.start("start", start), duration=0.0)

    @property
    def doubt(self) -> str:
        """Question whether the velocity is in another unit, if it is larger or smaller than any test's; else ""."""
        return doubt_of_velocity(self.velocity_change, 0.0, "is it in mm/s, or in another unit?")

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        """The step: its instant [s] and the jump (3,) [m/s]."""
        return ((self.start, self.velocity_change * self.unit),)

    @cached_property
    def _said(self) -> Said:
        """Describe the step in a line, such as `velocity step 2 m/s along z`; its time scale is infinite."""
        text = f"velocity step {self.velocity_change:.4g} m/s {self._line_text}"
        return Said(text, ((self.start, "velocity step"),), shortest_time=math.inf)

    def _along(self, t: Array, order: int) -> Array:
        if order == 2:
            return np.zeros_like(t)
        if order == 1:
            return np.where(t >= self.start, self.velocity_change, 0.0)
        return self.velocity_change * np.maximum(t - self.start, 0.0)


@dataclass(frozen=True, kw_only=True)
class StruckPlate(StartedMotion):
    """Plate with air behind that a plane underwater shock wave strikes: accelerated until the water cavitates, then coasting.

    The wave p0 e^(-t/theta) is reflected and the plate radiates, so that its mass m per area obeys

        m v' + rho c v = 2 p0 e^(-t/theta),    v = 2 p0 theta/m (e^(-t/theta) - e^(-psi t/theta))/(psi - 1)

    with psi = rho c theta/m until theta ln(psi)/(psi - 1). There the pressure on the plate has fallen to zero, water bears no
    tension, and the plate is at its largest velocity, 2 p0/(rho c) psi^(1/(1 - psi)). Later loads, those of the bubble too, are
    left out. Pressure and decay come from the charge by a law of similitude of your source.

    Source: G. I. Taylor, 1941, The pressure and impulse of submarine explosion waves on plates.
    """

    kind: ClassVar[str] = "struck-plate"
    phrases = (
        SpokenMotion(
            name="struck-plate", example="14 MPa 0.9 ms 320 kg/m2 z",
            summary="a hull plate under an underwater shock wave: peak pressure, decay, mass per area, direction.",
            needs={"pressure": 1, "time": 1, "areal mass": 1},
            make=made_of(pressure="pressure", decay="time", areal_mass="areal mass"),
        ),
    )  # fmt: skip

    pressure: float  #: peak p0 of the incident wave [Pa]
    decay: float  #: time theta in which it falls to 1/e [s]
    areal_mass: float  #: mass m of plate and what moves with it, per area [kg/m^2]
    direction: Direction  #: of the motion: `"x"`, `"y"`, `"z"` or a 3-vector
    impedance: float = SEA_WATER  #: rho c of the water [Pa s/m]
    start: float = 0.0  #: instant at which the wave arrives [s]
    duration: float = field(init=False)  #: until the water cavitates [s]

    def __post_init__(self) -> None:
        self._set(pressure=ranges.level("pressure", self.pressure), decay=ranges.length("decay", self.decay))
        for name in ("areal_mass", "impedance"):
            self._set(**{name: ranges.level(name, positive(name, getattr(self, name)))})
        self._set(direction=checked_direction(self.direction), start=ranges.start("start", self.start))
        kick = self.decay if self._psi_is_one else self.decay * math.log(self.psi) / (self.psi - 1.0)
        self._set(duration=ranges.length("duration", kick))

    @property
    def psi(self) -> float:
        """Decay time of the wave over the time constant m/(rho c) of the plate [-]."""
        return self.impedance * self.decay / self.areal_mass

    @property
    def velocity_change(self) -> float:
        """Velocity along the direction with which the plate leaves the water [m/s]."""
        return float(self._kick(np.array([self.duration]), 1)[0])

    @cached_property
    def _said(self) -> Said:
        """Describe the plate, such as `plate of 320 kg/m^2 struck by 14 MPa decaying in 0.9 ms: 11.72 m/s along z`."""
        wave = f"struck by {self.pressure / 1e6:.4g} MPa decaying in {1e3 * self.decay:.4g} ms"
        text = f"plate of {self.areal_mass:.4g} kg/m^2 {wave}: {self.velocity_change:.4g} m/s {self._line_text}"
        events = (self.start, "wave strikes the plate"), (self.end, "water lets go of the plate")
        return Said(text, events, shortest_time=min(self.decay, self.duration))

    @cached_property
    def _psi_is_one(self) -> bool:
        return abs(self.psi - 1.0) < ALIKE

    def _kick(self, since: Array, order: int) -> Array:
        """Return displacement (order 0), velocity (1) or acceleration (2) at times [s] since the wave's arrival, (n,)."""
        t, psi = since / self.decay, 1.0 if self._psi_is_one else self.psi
        falling, following = np.exp(-t), np.exp(-psi * t)
        if self._psi_is_one:
            shape = (1.0 - falling * (1.0 + t), falling * t, falling * (1.0 - t))[order]
        else:
            shape = (np.expm1(-psi * t) / psi - np.expm1(-t), falling - following, psi * following - falling)[order]
            shape = shape / (psi - 1.0)
        return np.asarray(2.0 * self.pressure * self.decay / self.areal_mass * self.decay ** (1 - order) * shape)

    def _along(self, t: Array, order: int) -> Array:
        since = np.clip(t - self.start, 0.0, self.duration)
        if order == 2:
            return np.where((t >= self.start) & (t < self.end), self._kick(since, 2), 0.0)
        coasted = self.velocity_change * np.maximum(t - self.end, 0.0) if order == 0 else 0.0
        return self._kick(since, order) + coasted
