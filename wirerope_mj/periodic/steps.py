"""How many steps a period of the base is cut into."""

import math

import numpy as np

from wirerope_mj.simulation.stability import eigenvalues, stable_step
from wirerope_mj.system import System

STEPS = 128
"""Steps per period for an error of 1e-4 of the ranges: the kinks at the mounts' reversals leave RK4 the order 2, with a
constant of about 1.6 per squared step of one period."""

REFERENCE = 1e-4
"""Accuracy for which `STEPS` holds."""

STABLE = 0.9
"""Share of the stability limit that a step may have."""


def steps_per_period(system: System, frequency: float, accuracy: float) -> int:
    """Return the number of steps in a period of the base.

    What moves at the system's own frequencies above the base's (superharmonic resonances) gets as many steps per period of its
    own as the base gets. The number is even: with a law without an elastic part only the symmetry of the two half periods keeps
    the mass from drifting, and an odd number would break it.
    """
    own = np.abs(eigenvalues(system).imag).max(initial=0.0) / (2.0 * math.pi)
    wanted = STEPS * math.sqrt(REFERENCE / accuracy) * max(1.0, own / frequency)
    limit = 1.0 / (frequency * STABLE * stable_step(system))
    return 2 * math.ceil(max(wanted, limit) / 2.0)
