"""A motion that repeats itself under a sine of the base, the result of `periodic_orbit`, and its harmonics."""

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

import numpy as np
import scipy

from wirerope_mj.dynamics.periodic.laws import smoothed
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array, ComplexArray
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text, unit_vector
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity
from wirerope_mj.motions import Sine


@dataclass(frozen=True, kw_only=True, repr=False)
class PeriodicOrbit(Summarised):
    """A motion that repeats itself after an integer number of the base's periods."""

    system: System = field(repr=False)
    frequency: float  #: of the base [Hz]
    acceleration: float  #: amplitude of the base's acceleration [m/s^2]
    direction: Direction  #: along which the base moves
    periods: int  #: number of the base's periods after which the motion repeats itself; above 1 for a subharmonic
    smoothing_width: float  #: velocity over which the laws were smoothed [m/s]; 0 for the laws as they are
    state: State = field(repr=False)  #: at phase 0 of the base's sine
    steps: int  #: model steps in the whole motion
    floquet_multipliers: ComplexArray  #: by falling modulus, without the neutral ones
    #: number of neutral directions: those along which the motion can be shifted and still repeats itself (the offset of a law
    #: without an elastic part, the state of an axis that does not move)
    neutral: int
    stable: bool  #: whether no multiplier lies outside the unit circle
    residual: float  #: largest difference of end and start, relative to the ranges of deflections, rates and states
    iterations: int  #: of Newton's method
    model_steps: int  #: of all integrations that finding it took
    message: str  #: residual, iterations and transient

    def _summary(self) -> tuple[str, dict[str, str]]:
        largest = float(np.abs(self.floquet_multipliers).max(initial=0.0))
        return "PeriodicOrbit", {
            "base": f"{quantity(self.acceleration, 'm/s^2')} at {self.frequency:.4g} Hz along {direction_text(self.direction)}",
            "periods": str(self.periods),
            "stability": f"{'stable' if self.stable else 'unstable'}, largest multiplier {largest:.4g}",
            "residual": f"{self.residual:.1e} after {self.iterations} iterations",
            "message": self.message,
        }

    @property
    def duration(self) -> float:
        """Time after which the motion repeats itself [s]."""
        return self.periods / self.frequency

    @property
    def motion(self) -> Sine:
        """The base's motion."""
        return Sine(frequency=self.frequency, acceleration=self.acceleration, direction=self.direction)

    @cached_property
    def response(self) -> Response:
        """The motion over its own duration, sampled at every step."""
        system = smoothed(self.system, self.smoothing_width) if self.smoothing_width else self.system
        step, rate = self.duration / self.steps, self.steps / self.duration
        return simulate(system, self.motion, duration=self.duration, initial=self.state, timestep=step, sample_rate=rate)

    def deflection_rate(self, mount: str) -> Array:
        """Differentiate a mount's deflection, as the periodic cubic spline through its samples [m/s], (n_t, 3)."""
        deflection = self.response.mounts[mount].deflection
        closed = np.concatenate([deflection[:-1], deflection[:1]])  # without the residual
        return np.asarray(scipy.interpolate.CubicSpline(self.response.time, closed, bc_type="periodic")(self.response.time, 1))


@dataclass(frozen=True, kw_only=True)
class HarmonicContent:
    """Harmonics of a payload's acceleration over a periodic motion."""

    order: tuple[Fraction, ...]  # multiples of the base's frequency, fractions for subharmonics, (n,)
    frequency: Array  # [Hz], (n,)
    amplitude: Array  # [m/s^2], (n,)
    phase: Array  # of a cosine at phase 0 of the base's sine [rad], (n,)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each harmonic."""
        names = []
        for order in self.order:
            if order in (0, 1):
                names.append("fundamental" if order else "mean")
            elif order.denominator == 1:
                names.append(f"superharmonic {order.numerator}")
            else:
                names.append(f"{'sub' if order < 1 else 'ultrasub'}harmonic {order.numerator}/{order.denominator}")
        return tuple(names)

    def of(self, order: int | Fraction) -> float:
        """Look up the amplitude of one order [m/s^2]; 0 if it is above the highest."""
        wanted = Fraction(order)
        return float(self.amplitude[self.order.index(wanted)]) if wanted in self.order else 0.0

    @property
    def distortion(self) -> float:
        """Root mean square of all but the fundamental and the mean, over the fundamental."""
        overtones = [a for order, a in zip(self.order, self.amplitude, strict=True) if order not in (0, 1)]
        return float(np.linalg.norm(overtones) / self.of(1))


def harmonic_content(
    orbit: PeriodicOrbit, *, payload: str, direction: str | tuple[float, float, float] | None = None, highest: int = 20
) -> HarmonicContent:
    """Transform a payload's absolute acceleration along a direction, that of the base unless given, up to a highest order.

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
    frequency = np.array([float(o) * orbit.frequency for o in order])
    return HarmonicContent(order=order, frequency=frequency, amplitude=amplitude, phase=np.angle(spectrum[:kept]))
