"""Equivalent linearisation: an isolator as the spring and damper of its loop at the amplitude of its motion.

The base acceleration is a sin(w t). An amplitude D of the deflection gives the spring K(D) and the damper c(D) of `equivalent`,
so that the response is that of a linear oscillator with the coefficients of its amplitude,
D |K - m w^2 + i w c| = m a. Where the curve folds, one frequency has three amplitudes.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import scipy

from wirerope_mj.dynamics.single_mass.cycle import steady_cycle
from wirerope_mj.dynamics.single_mass.equivalent import SAMPLES, EquivalentOscillator, oscillator_at, require_oscillator
from wirerope_mj.foundation.arrays import Array, ArrayLike, Integers
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.mounts.laws import Law

# Amplitudes looked at: from a tenth of what the unloaded stiffness would give, finely enough to tell three roots apart.
_DECADES, _PER_DECADE = 6.0, 24


@dataclass(frozen=True, kw_only=True)
class LinearisedOrbit:
    """A periodic motion estimated by equivalent linearisation, deflection = offset + Re[phasor exp(i w t)]."""

    oscillator: EquivalentOscillator  # spring and damper at its amplitude
    phasor: complex  # complex amplitude of the deflection [m]
    deflection: float  # at phase 0 of the sine [m]
    rate: float  # deflection rate there [m/s]
    states: Array  # internal states of the law there, on the closed loop of that amplitude, (n_states,)


@dataclass(frozen=True, kw_only=True, repr=False)
class EquivalentLinear(Brief):
    """Response curve by equivalent linearisation: one column for each amplitude that a frequency has, the smallest first."""

    frequency: Array  # [Hz], (n_f,)
    deflection: Array  # amplitude of the deflection D [m], (n_f, 3); NaN where there are fewer solutions
    amplitude: Array  # largest |absolute acceleration| of the mass [m/s^2], (n_f, 3)
    stiffness: Array  # K [N/m], (n_f, 3)
    damping_ratio: Array  # of the loop [-], (n_f, 3)

    @property
    def solutions(self) -> Integers:
        """Number of solutions at each frequency, (n_f,)."""
        return np.isfinite(self.deflection).sum(axis=1)


def equivalent_linear(
    law: Law, *, mass: float, frequencies: ArrayLike, acceleration: float, gravity: float = 0.0
) -> EquivalentLinear:
    """Return the response of one mass on one isolator axis to a sine of base acceleration by equivalent linearisation.

    A linear law is answered exactly. Superharmonics are not seen: a law that saturates or stiffens within the cycle is answered
    to a few per cent, and near the superharmonic resonances below the first not at all (bounds in the tests).

    Args:
        law: of the axis, none that wears.
        mass: [kg].
        frequencies: [Hz], (n_f,).
        acceleration: amplitude of the base [m/s^2].
        gravity: acceleration that acts on the mass towards compression [m/s^2].

    Raises:
        ValueError: an argument is not positive, or the law cannot carry the weight.
    """
    f = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
    oscillator = _oscillators(law, mass * gravity)
    table = np.full((4, f.size, 3), np.nan)
    for row, frequency in enumerate(f):
        require_oscillator(law, mass=mass, frequency=frequency, acceleration=acceleration, gravity=gravity)
        for column, o in enumerate(_solutions(law, oscillator, mass, frequency, acceleration)[:3]):
            table[:, row, column] = o.amplitude, o.largest_force / mass, o.stiffness, o.damping_ratio
    return EquivalentLinear(frequency=f, deflection=table[0], amplitude=table[1], stiffness=table[2], damping_ratio=table[3])


def linearised_orbits(
    law: Law, *, mass: float, frequency: float, acceleration: float, gravity: float = 0.0
) -> tuple[LinearisedOrbit, ...]:
    """Return the periodic motions under a sine of base acceleration by equivalent linearisation, the smallest first.

    They are what shooting and harmonic balance begin with: deflection, rate and internal states at phase 0. The arguments
    are those of `equivalent_linear`, for one frequency.
    """
    require_oscillator(law, mass=mass, frequency=frequency, acceleration=acceleration, gravity=gravity)
    omega, orbits = 2.0 * np.pi * frequency, []
    for o in _solutions(law, _oscillators(law, mass * gravity), mass, frequency, acceleration):
        phasor = 1j * mass * acceleration / complex(o.stiffness - mass * omega**2, omega * o.damping)
        orbits.append(_orbit(law, o, phasor))
    return tuple(orbits)


def _oscillators(law: Law, weight: float) -> Callable[[float, float], EquivalentOscillator]:
    """Return `oscillator_at` by amplitude and frequency; a rate-independent law has one loop for all frequencies."""
    if not law.rate_independent:
        return lambda amplitude, frequency: oscillator_at(law, amplitude, frequency=frequency, weight=weight)
    at_1_hz = cache(lambda amplitude: oscillator_at(law, amplitude, frequency=1.0, weight=weight))
    return lambda amplitude, frequency: replace(at_1_hz(amplitude), frequency=frequency)


def _solutions(
    law: Law, oscillator: Callable[[float, float], EquivalentOscillator], mass: float, frequency: float, acceleration: float
) -> list[EquivalentOscillator]:
    """Return the oscillators consistent with their own amplitude at a frequency, the smallest first."""
    omega = 2.0 * np.pi * frequency

    def excess(log_amplitude: float) -> float:
        """Return by which factor the force that the amplitude needs exceeds the excitation's, as a logarithm."""
        o = oscillator(float(np.exp(log_amplitude)), frequency)
        needed = abs(complex(o.stiffness - mass * omega**2, omega * o.damping)) * o.amplitude
        return float(np.log(needed / (mass * acceleration))) if needed > 0.0 else -np.inf

    unloaded = law.initial_stiffness + omega * law.damping_coefficient + mass * omega**2
    # The same amplitudes at all frequencies: their loops are computed once.
    start = np.floor(np.log10(0.1 * mass * acceleration / unloaded) * _PER_DECADE)
    grid = np.log(10.0) / _PER_DECADE * (start + np.arange(int(_DECADES * _PER_DECADE) + 1))
    return [oscillator(float(np.exp(root)), frequency) for root in _roots(excess, grid)]


def _orbit(law: Law, oscillator: EquivalentOscillator, phasor: complex) -> LinearisedOrbit:
    """Return the motion of a phasor with the law's states at phase 0."""
    omega = 2.0 * np.pi * oscillator.frequency
    turning = phasor * np.exp(2j * np.pi * np.arange(SAMPLES + 1) / SAMPLES)
    deflection, rate = oscillator.offset + turning.real, (1j * omega * turning).real
    cycle = steady_cycle(law, deflection, rate, period=1.0 / oscillator.frequency)
    return LinearisedOrbit(
        oscillator=oscillator, phasor=phasor, deflection=float(deflection[0]), rate=float(rate[0]), states=cycle.states
    )


def _roots(function: Callable[[float], float], grid: Array) -> Iterator[float]:
    """Yield the roots of a function between the points of a grid, two that are closer than its points included."""
    values = np.array([function(at) for at in grid])
    for i in range(grid.size - 1):
        if values[i] * values[i + 1] <= 0.0 and np.isfinite(values[i + 1]):
            yield float(scipy.optimize.brentq(function, grid[i], grid[i + 1], xtol=1e-15, rtol=1e-14))
        if i > 0 and np.ptp(np.sign(values[i - 1 : i + 2])) == 0.0 and np.argmin(np.abs(values[i - 1 : i + 2])) == 1:
            yield from _pair(function, grid[i - 1], grid[i + 1], np.sign(values[i]))


def _pair(function: Callable[[float], float], low: float, high: float, side: float) -> Iterator[float]:
    """Yield the two roots of a function that has the sign `side` at both ends and comes nearest to zero between them."""
    nearest = scipy.optimize.minimize_scalar(lambda at: side * function(at), bounds=(low, high), method="bounded").x
    if side * function(nearest) < 0.0:
        yield float(scipy.optimize.brentq(function, low, nearest, rtol=1e-14))
        yield float(scipy.optimize.brentq(function, nearest, high, rtol=1e-14))
