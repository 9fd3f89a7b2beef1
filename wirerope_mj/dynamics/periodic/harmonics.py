"""Harmonics of a periodic motion: at the base's frequency, its multiples and its fractions."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from wirerope_mj.dynamics.periodic.orbit import PeriodicOrbit
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import checked_direction, unit_vector


@dataclass(frozen=True, kw_only=True)
class HarmonicContent:
    """Harmonics of a payload's acceleration over a periodic motion.

    Attributes:
        order: multiples of the base's frequency, fractions for subharmonics, (n,).
        frequency: [Hz], (n,).
        amplitude: [m/s^2], (n,).
        phase: of a cosine at phase 0 of the base's sine [rad], (n,).
    """

    order: tuple[Fraction, ...]
    frequency: Array
    amplitude: Array
    phase: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each harmonic."""
        return tuple(_name(order) for order in self.order)

    def of(self, order: int | Fraction) -> float:
        """Return the amplitude of one order [m/s^2]; 0 if it is above the highest."""
        wanted = Fraction(order)
        return float(self.amplitude[self.order.index(wanted)]) if wanted in self.order else 0.0

    @property
    def distortion(self) -> float:
        """Root mean square of all but the fundamental and the mean, over the fundamental."""
        others = [a for order, a in zip(self.order, self.amplitude, strict=True) if order not in (0, 1)]
        return float(np.linalg.norm(others) / self.of(1))


def harmonic_content(
    orbit: PeriodicOrbit, *, payload: str, direction: str | tuple[float, float, float] | None = None, highest: int = 20
) -> HarmonicContent:
    """Return the harmonics of a payload's absolute acceleration up to an order.

    Args:
        orbit: the motion.
        payload: body of the response.
        direction: along which the acceleration is taken; that of the base unless given.
        highest: highest multiple of the base's frequency.

    Raises:
        ValueError: the payload is not known.
    """
    one_of("payload", payload, orbit.response.bodies)
    along = unit_vector(orbit.direction if direction is None else checked_direction(direction))
    acceleration = orbit.response.bodies[payload].acceleration[:-1] @ along
    spectrum = np.fft.rfft(acceleration) / acceleration.size
    kept = min(highest * orbit.periods + 1, spectrum.size)
    amplitude = np.abs(spectrum[:kept]) * np.where(np.arange(kept) == 0, 1.0, 2.0)
    order = tuple(Fraction(number, orbit.periods) for number in range(kept))
    return HarmonicContent(
        order=order,
        frequency=np.array([float(o) * orbit.frequency for o in order]),
        amplitude=amplitude,
        phase=np.angle(spectrum[:kept]),
    )


def _name(order: Fraction) -> str:
    if order == 0:
        return "mean"
    if order == 1:
        return "fundamental"
    if order.denominator == 1:
        return f"superharmonic {order.numerator}"
    return f"{'sub' if order < 1 else 'ultrasub'}harmonic {order.numerator}/{order.denominator}"
