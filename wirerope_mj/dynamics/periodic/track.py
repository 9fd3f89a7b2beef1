"""The base's sine and its steps, and the track of one copy of a system through its periods."""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.engine.simulation.stability import eigenvalues, stable_step
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions import Sine

STEPS = 128
"""Steps per period of the base for an error of 1e-4 of accelerations and deflections: measured on one mass from a seventh of
its resonance to twice it, superharmonic resonances included, and on a floor. The kinks at reversals leave order 2."""

NATURAL = 32
"""Steps per period of the system's fastest motion: between reversals RK4 has its order 4."""

REFERENCE = 1e-4
"""Accuracy for which these numbers hold."""

STABLE = 0.9
"""Fraction of the stability limit that a step may have."""


class Steps:
    """The number of steps in a period of the base of one system, for an accuracy."""

    def __init__(self, system: System, accuracy: float) -> None:
        self._finer = math.sqrt(REFERENCE / accuracy)
        self._highest = float(np.abs(eigenvalues(system).imag).max(initial=0.0)) / (2.0 * math.pi)
        self._longest = STABLE * stable_step(system)

    def per_period(self, frequency: float) -> int:
        """Return the number for a frequency [Hz].

        It is even: with a law without an elastic part only the symmetry of the two half periods keeps the mass from drifting,
        and an odd number would break it.
        """
        wanted = self._finer * max(STEPS, NATURAL * self._highest / frequency)
        return 2 * math.ceil(max(wanted, 1.0 / (frequency * self._longest)) / 2.0)


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A sine of the base and its steps: frequency [Hz], acceleration [m/s^2], periods and steps in all."""

    frequency: float
    acceleration: float
    periods: int
    steps: int

    @property
    def duration(self) -> float:
        """Length [s]."""
        return self.periods / self.frequency

    def sine(self, direction: str | tuple[float, float, float]) -> Sine:
        """Return the motion of a base along a direction."""
        return Sine(frequency=self.frequency, acceleration=self.acceleration, direction=direction)


@dataclass(frozen=True, kw_only=True)
class Track:
    """One copy's unknowns at its end, (n_x,), and values of the engine at the start of every step.

    sensors are the system's sensor values (n_steps, n_s); qpos, qvel and act the engine's state, (n_steps, n_q|n_v|n_a).
    """

    end: Array
    sensors: Array
    qpos: Array
    qvel: Array
    act: Array
    drive: Drive
