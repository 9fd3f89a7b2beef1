"""A loop cut from a long record, with the turning points before it."""

from dataclasses import dataclass, field

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import Loop


@dataclass(frozen=True, repr=False)
class RecordedLoop(Loop):
    """The mean of a run's last cycles, without drift, and the turning points of the deflection that led there.

    A hysteretic force remembers how its cycle was reached, the longer the smaller the cycle. Rate-independent laws need no more
    than the turning points to be led the same way.
    """

    # turning points from the unloaded device to the first of the averaged cycles [m], (n,)
    history: Array = field(default_factory=lambda: np.zeros(0), repr=False)
    # time since the cycle began over its period, from 0 to 1, (n_t,)
    elapsed: Array = field(default_factory=lambda: np.zeros(0), repr=False)
    averaged: int = 0  # cycles in the mean; 0 if it is not known how they were reached, and the loop counts as steady
    # standard deviation of what the averaged cycles differ by, as it is left in their mean [N]; 0 of a single one
    scatter: float = 0.0
    period: float | None = None  # of its cycles [s]; None where the record has no time


def mean_of_cycles(forces: Array, elapsed: Array) -> Array:
    """Average successive cycles' forces [N], (n_t,), from (n_cycles, n_t), without a zero that drifts linearly.

    The drift is that of the cycles' mean forces, or of a single one's ends, and is zero at the end of the last cycle. The
    first and last values returned are equal; `elapsed` is the time since a cycle's begin over its period, from 0 to 1, (n_t,).
    """
    if forces.shape[0] == 1:
        return forces[0] - (forces[0, -1] - forces[0, 0]) * (elapsed - 1.0)
    means = np.asarray(np.trapezoid(forces, elapsed, axis=1))
    drift = (means[-1] - means[0]) / (forces.shape[0] - 1)
    # Cycle k has drifted by k + elapsed, and their mean k is (n - 1) / 2.
    mean = np.asarray(forces.mean(axis=0) - drift * (elapsed - 0.5 * (forces.shape[0] + 1)))
    mean[[0, -1]] = 0.5 * (mean[0] + mean[-1])
    return mean
