"""A motion that repeats itself under a sine of the base, the result of `periodic_orbit`."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from wirerope_mj.dynamics.periodic.multipliers import Multipliers
from wirerope_mj.dynamics.periodic.smoothing import smoothed
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.directions import Direction, direction_text
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity
from wirerope_mj.motions import Sine


@dataclass(frozen=True, kw_only=True, repr=False)
class PeriodicOrbit(Summarised):
    """A motion that repeats itself after an integer number of the base's periods.

    Attributes:
        system: the system.
        frequency: of the base [Hz].
        acceleration: amplitude of the base's acceleration [m/s^2].
        direction: along which the base moves.
        periods: number of the base's periods after which the motion repeats itself; above 1 for a subharmonic.
        smoothing_width: velocity over which the laws were smoothed [m/s]; 0 for the laws as they are.
        state: at phase 0 of the base's sine.
        steps: model steps in the whole motion.
        floquet_multipliers: by falling modulus, without the neutral ones.
        neutral: number of neutral directions: those along which the motion can be shifted and still repeats itself (the offset
            of a law without an elastic part, the state of an axis that does not move).
        stable: whether no multiplier lies outside the unit circle.
        residual: largest difference of end and start, relative to the ranges of deflections, rates and states.
        iterations: of Newton's method.
        model_steps: of all integrations that finding it took.
        message: residual, iterations and transient.
    """

    system: System = field(repr=False)
    frequency: float
    acceleration: float
    direction: Direction
    periods: int
    smoothing_width: float
    state: State = field(repr=False)
    steps: int
    floquet_multipliers: Multipliers
    neutral: int
    stable: bool
    residual: float
    iterations: int
    model_steps: int
    message: str

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
        return simulate(
            smoothed(self.system, self.smoothing_width) if self.smoothing_width else self.system,
            self.motion,
            duration=self.duration,
            initial=self.state,
            timestep=self.duration / self.steps,
            sample_rate=self.steps / self.duration,
        )
