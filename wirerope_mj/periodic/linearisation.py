"""Equivalent linearisation: an isolator as the spring and damper of its loop at the amplitude that it swings with.

Ko's decomposition takes a loop of amplitude D apart into a stiffness and an ellipse of the same area,

    K(D) = [F(d_max) - F(d_min)] / (2 D)        c(D) = W(D) / (pi w D^2)

so that the response to a base acceleration a sin(w t) is that of a linear oscillator with the coefficients of its amplitude,
D |K - m w^2 + i w c| = m a. Where the curve folds, one frequency has three amplitudes. Sources: Ko et al. (1992), thesis 2.5.2;
for the equivalent coefficients Caughey (1960).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, minimize_scalar

from wirerope_mj.laws import Law
from wirerope_mj.periodic.cycle import Array, cycle_force, is_neutral, largest, require_steady, steady_cycle

_SAMPLES = 256
"""Samples of a cycle: the area of a loop with a sharp tip is then right to 1e-6."""

_DECADES, _PER_DECADE = 6.0, 24
"""Amplitudes looked at: from a tenth of what the unloaded stiffness would give, finely enough to tell three roots apart."""


@dataclass(frozen=True, kw_only=True)
class EquivalentOscillator:
    """Spring and damper of a law's loop at one amplitude and frequency.

    Attributes:
        amplitude: of the deflection about its offset, D [m].
        offset: mean deflection [m], where the mean force carries the weight.
        frequency: [Hz].
        stiffness: secant stiffness K [N/m].
        energy: dissipated in one cycle, W [J].
        largest_force: largest |force + weight| on the loop [N].
    """

    amplitude: float
    offset: float
    frequency: float
    stiffness: float
    energy: float
    largest_force: float

    @property
    def damping(self) -> float:
        """Equivalent viscous coefficient W / (pi w D^2) [N s/m]."""
        return self.energy / (2.0 * np.pi**2 * self.frequency * self.amplitude**2)

    @property
    def damping_ratio(self) -> float:
        """W / (2 pi K D^2) [-], the ratio at the resonance of this spring; infinite without stiffness."""
        with np.errstate(divide="ignore"):
            return float(np.float64(self.energy) / np.float64(2.0 * np.pi * self.stiffness * self.amplitude**2))


@dataclass(frozen=True, kw_only=True)
class LinearisedOrbit:
    """A periodic motion estimated by equivalent linearisation, deflection = offset + Re[phasor exp(i w t)].

    Attributes:
        oscillator: spring and damper at its amplitude.
        phasor: complex amplitude of the deflection [m].
        deflection: at phase 0 of the sine [m].
        rate: deflection rate there [m/s].
        states: internal states of the law there, on the closed loop of that amplitude, (n_states,).
    """

    oscillator: EquivalentOscillator
    phasor: complex
    deflection: float
    rate: float
    states: Array


@dataclass(frozen=True, kw_only=True)
class EquivalentLinear:
    """Response curve by equivalent linearisation: one column for each amplitude that a frequency has, the smallest first.

    Attributes:
        frequency: [Hz], (n_f,).
        deflection: amplitude of the deflection D [m], (n_f, 3); NaN where there are fewer solutions.
        amplitude: largest |absolute acceleration| of the mass [m/s^2], (n_f, 3).
        stiffness: [N/m], (n_f, 3).
        damping_ratio: W / (2 pi K D^2) [-], (n_f, 3).
        solutions: how many there are, (n_f,).
    """

    frequency: Array
    deflection: Array
    amplitude: Array
    stiffness: Array
    damping_ratio: Array

    @property
    def solutions(self) -> npt.NDArray[np.int64]:
        """Number of solutions at each frequency, (n_f,)."""
        return np.isfinite(self.deflection).sum(axis=1)


def equivalent_linear(
    law: Law, *, mass: float, frequencies: npt.ArrayLike, acceleration: float, gravity: float = 0.0
) -> EquivalentLinear:
    """Return the response of one mass on one isolator axis to a sine of base acceleration by equivalent linearisation.

    A linear law is answered exactly. Superharmonics are not seen at all.

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
    table = np.full((4, f.size, 3), np.nan)
    for row, frequency in enumerate(f):
        orbits = linearised_orbits(law, mass=mass, frequency=frequency, acceleration=acceleration, gravity=gravity)
        for column, o in enumerate(orbit.oscillator for orbit in orbits[:3]):
            table[:, row, column] = o.amplitude, o.largest_force / mass, o.stiffness, o.damping_ratio
    return EquivalentLinear(
        frequency=f, deflection=table[0], amplitude=table[1], stiffness=table[2], damping_ratio=table[3]
    )


def linearised_orbits(
    law: Law, *, mass: float, frequency: float, acceleration: float, gravity: float = 0.0
) -> tuple[LinearisedOrbit, ...]:
    """Return the periodic motions under a sine of base acceleration by equivalent linearisation, the smallest first.

    They are what shooting and harmonic balance begin with: deflection, rate and internal states at phase 0. The arguments
    are those of `equivalent_linear`, for one frequency.
    """
    require_oscillator(law, mass=mass, frequency=frequency, acceleration=acceleration, gravity=gravity)
    omega, weight = 2.0 * np.pi * frequency, mass * gravity

    def excess(log_amplitude: float) -> float:
        """Return by which factor the force that the amplitude needs exceeds the excitation's, as a logarithm."""
        o = oscillator_at(law, float(np.exp(log_amplitude)), frequency=frequency, weight=weight)
        needed = abs(complex(o.stiffness - mass * omega**2, omega * o.damping)) * o.amplitude
        return float(np.log(needed / (mass * acceleration))) if needed > 0.0 else -np.inf

    unloaded = law.initial_stiffness + omega * law.damping_coefficient + mass * omega**2
    start = np.log(0.1 * mass * acceleration / unloaded)
    grid = start + np.log(10.0) / _PER_DECADE * np.arange(int(_DECADES * _PER_DECADE) + 1)
    found = []
    for root in _roots(excess, grid):
        o = oscillator_at(law, float(np.exp(root)), frequency=frequency, weight=weight)
        phasor = 1j * mass * acceleration / complex(o.stiffness - mass * omega**2, omega * o.damping)
        found.append(_orbit(law, o, phasor))
    return tuple(found)


def oscillator_at(law: Law, amplitude: float, *, frequency: float, weight: float = 0.0) -> EquivalentOscillator:
    """Return spring and damper of the law's closed loop at an amplitude [m], about the deflection whose mean force is -weight.

    Args:
        law: the law.
        amplitude: D [m].
        frequency: [Hz]; it does not matter to a rate-independent law.
        weight: [N], towards compression; a law without an elastic part carries none.
    """
    angle = 2.0 * np.pi * np.arange(_SAMPLES + 1) / _SAMPLES
    omega = 2.0 * np.pi * frequency
    shape, rate = amplitude * np.cos(angle), -omega * amplitude * np.sin(angle)

    def force(offset: float) -> Array:
        return cycle_force(law, offset + shape, rate, period=1.0 / frequency)[:-1]

    offset = 0.0 if is_neutral(law) else _offset(lambda at: float(force(at).mean()) + weight, law, amplitude, weight)
    f = force(offset) if np.isfinite(offset) else np.full(_SAMPLES, np.nan)
    stiffness = (f[0] - f[_SAMPLES // 2]) / (2.0 * amplitude)
    energy = -2.0 * np.pi * amplitude * float(f @ np.sin(angle[:-1])) / _SAMPLES
    return EquivalentOscillator(
        amplitude=amplitude,
        offset=offset,
        frequency=frequency,
        stiffness=float(stiffness),
        energy=energy,
        largest_force=largest(np.abs(f + weight), smooth=not law.rate_independent),
    )


def require_oscillator(law: Law, *, mass: float, frequency: float, acceleration: float, gravity: float) -> None:
    """Raise ValueError unless a mass on this law has periodic motions under this excitation."""
    require_steady(law)
    for name, value in (("mass", mass), ("frequency", frequency), ("acceleration", acceleration)):
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"`{name}` must be finite and > 0, got {value}.")
    if not np.isfinite(gravity):
        raise ValueError(f"`gravity` must be finite, got {gravity}.")
    if gravity != 0.0 and is_neutral(law):
        raise ValueError(
            f"`gravity` must be 0 for this {law.name} law, got {gravity}: it has no elastic part, and in steady vibration "
            "it carries no weight."
        )


def _offset(excess: Callable[[float], float], law: Law, amplitude: float, weight: float) -> float:
    """Return the mean deflection at which the mean force carries the weight [m]; NaN if none is found."""
    here = excess(0.0)
    if abs(here) <= 1e-13 * max(abs(weight), law.initial_stiffness * amplitude):  # rounding of a sum over a cycle
        return 0.0
    step, before = -here / law.initial_stiffness, 0.0
    for _ in range(60):
        there = excess(step)
        if not np.isfinite(there):
            return float("nan")
        if there * here <= 0.0:
            return float(brentq(excess, before, step, xtol=1e-14 * abs(step), rtol=1e-14))
        before, step = step, 1.5 * step
    return float("nan")


def _orbit(law: Law, oscillator: EquivalentOscillator, phasor: complex) -> LinearisedOrbit:
    """Return the motion of a phasor with the law's states at phase 0."""
    omega = 2.0 * np.pi * oscillator.frequency
    turning = phasor * np.exp(2j * np.pi * np.arange(_SAMPLES + 1) / _SAMPLES)
    deflection, rate = oscillator.offset + turning.real, (1j * omega * turning).real
    cycle = steady_cycle(law, deflection, rate, period=1.0 / oscillator.frequency)
    return LinearisedOrbit(
        oscillator=oscillator,
        phasor=phasor,
        deflection=float(deflection[0]),
        rate=float(rate[0]),
        states=cycle.states,
    )


def _roots(function: Callable[[float], float], grid: Array) -> Iterator[float]:
    """Yield the roots of a function between the points of a grid, two that are closer than its points included."""
    values = np.array([function(at) for at in grid])
    for i in range(grid.size - 1):
        if values[i] * values[i + 1] <= 0.0 and np.isfinite(values[i + 1]):
            yield float(brentq(function, grid[i], grid[i + 1], xtol=1e-15, rtol=1e-14))
        if (
            i == 0
            or not values[i - 1] * values[i + 1] > 0.0
            or not abs(values[i]) < min(abs(values[i - 1 : i + 2 : 2]))
        ):
            continue
        side = np.sign(values[i])
        nearest = minimize_scalar(
            lambda at, side=side: side * function(at), bounds=grid[[i - 1, i + 1]], method="bounded"
        )
        if side * function(nearest.x) < 0.0:
            yield float(brentq(function, grid[i - 1], nearest.x, rtol=1e-14))
            yield float(brentq(function, nearest.x, grid[i + 1], rtol=1e-14))
