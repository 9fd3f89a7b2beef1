"""A law along one cycle of a periodic deflection, in its steady state: engine-free, what harmonic balance rests on."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.single_mass.closing import (
    closed_states,
    closed_states_in_time,
    path_between,
    steady_force,
    turning_points,
)
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import BoucWenBaberNoori, Law, Loop
from wirerope_mj.mounts.laws.timed import follow_time


@dataclass(frozen=True, kw_only=True)
class ClosedCycle:
    """A law along one closed cycle.

    Attributes:
        loop: the whole path; with a rate-independent law the turning points between the samples are on it.
        samples: their indices on that path, (n_t,).
    """

    loop: Loop
    samples: npt.NDArray[np.int64]

    @property
    def force(self) -> Array:
        """Force at the samples [N], (n_t,)."""
        return self.loop.force[self.samples]

    @property
    def hysteretic_state(self) -> Array:
        """Hysteretic state at the samples [N], (n_t,)."""
        return self.loop.hysteretic_state[self.samples]

    @property
    def states(self) -> Array:
        """Internal states at the first sample, (n_states,)."""
        return self.loop.internal_states[0]


def require_steady(law: Law) -> None:
    """Raise ValueError if no cycle of the law repeats the one before."""
    if any(isinstance(one, BoucWenBaberNoori) for one in law.components):
        raise ValueError("a law that wears, bouc-wen-baber-noori, has no steady cycle: take its Bouc-Wen law instead.")


def is_neutral(law: Law) -> bool:
    """Return whether the law has no preferred position: a shift of the deflection leaves the force of its cycles unchanged."""
    return law.largest_force < np.inf


def cycle_force(law: Law, deflection: Array, rate: Array, *, period: float) -> Array:
    """Return the steady force [N], (n_t,), along one cycle; NaN where it leaves the finite numbers.

    A rate-independent law is followed exactly along the path, from the unloaded state at zero deflection on until its cycle
    closes; one that depends on the rate along the cubic through deflections and rates.

    Args:
        law: the law, none that wears.
        deflection: uniform samples over one period, the last the first again [m], (n_t,).
        rate: deflection rate at the samples [m/s], (n_t,).
        period: duration of the cycle [s].
    """
    p, n = law.kernel_parameters(), law.n_states
    if law.rate_independent:
        return steady_force(law.kernel, p, deflection, rate, period / (deflection.size - 1), n)
    time = np.linspace(0.0, period, deflection.size)
    states = closed_states_in_time(law.kernel, p, time, deflection, rate, n)
    return follow_time(law.kernel, p, time, deflection, rate, states, n)[0]


def steady_cycle(law: Law, deflection: Array, rate: Array, *, period: float) -> ClosedCycle:
    """Return all of the same cycle, its work included; the arguments are those of `cycle_force`.

    Raises:
        ValueError: the force leaves the finite numbers along the path.
    """
    p, n = law.kernel_parameters(), law.n_states
    if law.rate_independent:
        path, indices = path_between(deflection, rate, period / (deflection.size - 1))
        states = closed_states(law.kernel, p, turning_points(path), n)
        return ClosedCycle(loop=law.trace(path, initial_states=_zero_if_lost(states)), samples=indices)
    time = np.linspace(0.0, period, deflection.size)
    states = closed_states_in_time(law.kernel, p, time, deflection, rate, n)
    loop = law.trace(deflection, time=time, rate=rate, initial_states=_zero_if_lost(states))
    return ClosedCycle(loop=loop, samples=np.arange(deflection.size))


def _zero_if_lost(states: Array) -> Array:
    """Return states from which a trace says itself where the force leaves the finite numbers."""
    return np.where(np.isfinite(states), states, 0.0)


def largest(values: Array, *, smooth: bool) -> float:
    """Return the largest of the values at uniform samples of one period; of a smooth curve the tip of the parabola there."""
    top = int(np.argmax(values))
    before, at, after = values[top - 1], values[top], values[(top + 1) % values.size]
    bend = before - 2.0 * at + after
    return float(at - (after - before) ** 2 / (8.0 * bend)) if smooth and bend < 0.0 else float(at)
