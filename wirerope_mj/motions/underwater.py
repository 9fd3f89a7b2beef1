"""Hull plates that the shock wave of an underwater explosion strikes."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction
from wirerope_mj.motions import ranges
from wirerope_mj.motions.motion import Said, StartedMotion
from wirerope_mj.motions.phrases import SpokenMotion, made_of

SEA_WATER = 1025.0 * 1500.0  # density times velocity of sound [Pa s/m]
ALIKE = 1e-6  # distance of psi from 1 within which the formulas of psi = 1 are right to a millionth, and exact integrals


@dataclass(frozen=True, kw_only=True)
class StruckPlate(StartedMotion):
    """Plate with air behind that a plane underwater shock wave strikes: kicked off until the water lets go, then coasting.

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
    duration: float = field(init=False)  #: until the water lets go [s]

    def __post_init__(self) -> None:
        self._set(pressure=ranges.level("pressure", self.pressure), decay=ranges.length("decay", self.decay))
        for name in ("areal_mass", "impedance"):
            self._set(**{name: ranges.level(name, positive(name, getattr(self, name)))})
        self._set(direction=checked_direction(self.direction), start=ranges.start("start", self.start))
        kick = self.decay if self._alike else self.decay * math.log(self.psi) / (self.psi - 1.0)
        self._set(duration=ranges.length("duration", kick))

    @property
    def psi(self) -> float:
        """Decay over the time m/(rho c) in which the plate follows the water."""
        return self.impedance * self.decay / self.areal_mass

    @property
    def velocity_change(self) -> float:
        """Velocity along the direction with which the plate leaves the water [m/s]."""
        return float(self._kick(np.array([self.duration]), 1)[0])

    @cached_property
    def _said(self) -> Said:
        """For instance `plate of 320 kg/m^2 struck by 14 MPa decaying in 0.9 ms: 11.72 m/s along z`."""
        wave = f"struck by {self.pressure / 1e6:.4g} MPa decaying in {1e3 * self.decay:.4g} ms"
        text = f"plate of {self.areal_mass:.4g} kg/m^2 {wave}: {self.velocity_change:.4g} m/s {self._line_text}"
        events = (self.start, "wave strikes the plate"), (self.end, "water lets go of the plate")
        return Said(text, events, min(self.decay, self.duration))

    @cached_property
    def _alike(self) -> bool:
        return abs(self.psi - 1.0) < ALIKE

    def _kick(self, since: Array, order: int) -> Array:
        """Return displacement, velocity or acceleration at times within the kick [s], (n,)."""
        t, psi = since / self.decay, 1.0 if self._alike else self.psi
        falling, following = np.exp(-t), np.exp(-psi * t)
        if self._alike:
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
