"""Equivalent linearisation: an isolator as the spring and damper of its loop at the amplitude of its motion.

Ko's decomposition takes a loop of amplitude D apart into its mid-line and an ellipse of the same area. In the motion D cos(w t)
the mid-line pushes like the spring of its first harmonic, which is that of the whole loop, and the ellipse is a damper,

    K(D) = (1 / (pi D)) int F cos(w t) d(w t)        c(D) = W(D) / (pi w D^2)

Under a base acceleration a sin(w t) the response is that of a linear oscillator with the coefficients of its own amplitude,
D |K - m w^2 + i w c| = m a. Where the curve folds, one frequency has three amplitudes. A mass on such a spring gives the peak
response to a transient from a linear response spectrum, too: Demetriades' simplified method.

Sources: Ko et al. (1992), thesis 2.5.2; for the equivalent coefficients Caughey (1960).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import scipy

from wirerope_mj.dynamics.single_mass.cycle import cycle_force, is_neutral, largest, require_steady, steady_cycle
from wirerope_mj.foundation.arguments import finite, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike, Integers
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.mounts.laws import Law

_SAMPLES = 256  # samples of a cycle: the area of a loop with a sharp tip is then right to 1e-6
_ITERATIONS = 200  # most amplitudes tried: with a smooth spectrum about 30 give ten digits


@dataclass(frozen=True, kw_only=True)
class EquivalentOscillator:
    """Spring and damper of a law's loop at one amplitude and frequency."""

    amplitude: float  # of the deflection about its offset, D [m]
    offset: float  # mean deflection [m], where the mean force carries the weight
    frequency: float  # [Hz]
    stiffness: float  # of the first harmonic of the mid-line, K [N/m]
    secant_stiffness: float  # [F(d_max) - F(d_min)] / (2 D) [N/m]
    energy: float  # dissipated in one cycle, W [J]
    largest_force: float  # largest |force + weight| on the loop [N]

    @property
    def damping(self) -> float:
        """Equivalent viscous coefficient W / (pi w D^2) [N s/m]: W work of a cycle, w angular frequency, D amplitude."""
        return self.energy / (2.0 * np.pi**2 * self.frequency * self.amplitude**2)

    @property
    def damping_ratio(self) -> float:
        """W / (2 pi K D^2) [-] with the secant stiffness, as of a `Loop`; infinite without stiffness."""
        with np.errstate(divide="ignore"):
            return float(np.float64(self.energy) / np.float64(2.0 * np.pi * self.secant_stiffness * self.amplitude**2))


def require_oscillator(law: Law, *, mass: float, frequency: float, acceleration: float, gravity: float) -> None:
    """Raise ValueError unless a mass on this law has periodic motions under this excitation."""
    require_steady(law)
    for name, value in (("mass", mass), ("frequency", frequency), ("acceleration", acceleration)):
        positive(name, value)
    if finite("gravity", gravity) != 0.0 and is_neutral(law):
        raise ValueError(
            f"`gravity` must be 0 for this {law.name} law, got {gravity}: it has no elastic part, and in steady vibration "
            "it carries no weight."
        )


def oscillator_at(law: Law, amplitude: float, *, frequency: float, weight: float = 0.0) -> EquivalentOscillator:
    """Linearise the law's closed loop at an amplitude [m], about the deflection whose mean force is -weight [N].

    The frequency [Hz] does not matter to a rate-independent law; a law without an elastic part carries no weight.
    """
    angle = 2.0 * np.pi * np.arange(_SAMPLES + 1) / _SAMPLES
    shape, rate = amplitude * np.cos(angle), -2.0 * np.pi * frequency * amplitude * np.sin(angle)

    def force(offset: float) -> Array:
        if not np.isfinite(offset):
            return np.full(_SAMPLES, np.nan)
        return cycle_force(law, offset + shape, rate, period=1.0 / frequency)[:-1]

    def excess(offset: float) -> float:
        with np.errstate(over="ignore", invalid="ignore"):  # exponentials, at amplitudes far beyond the laws' travel
            return float(force(offset).mean()) + weight

    offset = 0.0 if is_neutral(law) else _offset(excess, law, amplitude, weight)
    f = force(offset)
    return EquivalentOscillator(
        amplitude=amplitude, offset=offset, frequency=frequency,
        energy=-2.0 * np.pi * amplitude * float(f @ np.sin(angle[:-1])) / _SAMPLES,
        stiffness=2.0 * float(f @ np.cos(angle[:-1])) / (_SAMPLES * amplitude),
        secant_stiffness=float(f[0] - f[_SAMPLES // 2]) / (2.0 * amplitude),
        largest_force=largest(np.abs(f + weight), smooth=not law.rate_independent),
    )  # fmt: skip


def _offset(excess: Callable[[float], float], law: Law, amplitude: float, weight: float) -> float:
    """Find the mean deflection [m] at which a cycle's mean force carries the weight, a zero of `excess`; NaN without one."""
    at_zero = excess(0.0)
    if abs(at_zero) <= 1e-13 * max(abs(weight), law.initial_stiffness * amplitude):  # rounding of a sum over a cycle
        return 0.0
    before, offset = 0.0, -at_zero / law.initial_stiffness
    for _ in range(60):
        at_offset = excess(offset)
        if not np.isfinite(at_offset):
            break
        if at_offset * at_zero <= 0.0:
            return float(scipy.optimize.brentq(excess, before, offset, xtol=1e-14 * abs(offset), rtol=1e-14))
        before, offset = offset, 1.5 * offset
    return float("nan")


@dataclass(frozen=True, kw_only=True)
class SimplifiedPeak:
    """Peak response of one mass on one isolator axis by an equivalent linear oscillator."""

    deflection: float  # D [m]
    acceleration: float  # K D / m of the mass [m/s^2]
    stiffness: float  # secant stiffness K at D [N/m]
    damping_ratio: float  # of the loop at D [-]
    period: float  # of the equivalent oscillator, 2 pi sqrt(m / K) [s]
    iterations: int  # amplitudes tried


def simplified_peak(
    law: Law, *, mass: float, spectrum: Callable[[float, float], float], tolerance: float = 1e-10
) -> SimplifiedPeak:
    """Estimate the peak response to a base motion of which only the response spectrum is known.

    An amplitude D gives the isolator's loop, the loop a secant stiffness K and a damping ratio zeta = W / (2 pi K D^2), these a
    linear oscillator, and that the spectral displacement S; the geometric mean of D and S is tried next. A loop dissipates
    over a full cycle what zeta stands for, and holds no drift: under one short pulse, and where the force
    saturates, the deflection is estimated too low. Source: Demetriades, Constantinou and Reinhorn (1993).

    Args:
        law: of the axis, not one that wears. The loop of a law that depends on the rate is computed at the oscillator's period.
        mass: [kg].
        spectrum: spectral displacement [m] of the base motion by period [s] and damping ratio [-].
        tolerance: relative change of D at which it has converged.

    Raises:
        ValueError: `mass` is not positive, or the spectrum is not a finite displacement > 0.
        ConvergenceError: the amplitudes do not converge.
    """
    require_steady(law)
    positive("mass", mass)
    period = 2.0 * np.pi * np.sqrt(mass / law.initial_stiffness)
    deflection = _spectral(spectrum, period, 0.0)
    for iteration in range(1, _ITERATIONS + 1):
        loop = oscillator_at(law, deflection, frequency=1.0 / period)
        if not loop.secant_stiffness > 0.0:
            raise ConvergenceError(
                f"the isolator has no stiffness at {deflection:.6g} m, hence no equivalent oscillator: is the motion too large?"
            )
        period = 2.0 * np.pi * float(np.sqrt(mass / loop.secant_stiffness))
        wanted = _spectral(spectrum, period, loop.damping_ratio)
        if abs(wanted - deflection) <= tolerance * deflection:
            return SimplifiedPeak(
                deflection=deflection, acceleration=loop.secant_stiffness * deflection / mass,
                stiffness=loop.secant_stiffness, damping_ratio=loop.damping_ratio, period=period, iterations=iteration,
            )  # fmt: skip
        deflection = float(np.sqrt(deflection * wanted))
    raise ConvergenceError(
        f"the peak deflection does not converge: {deflection:.6g} m after {_ITERATIONS} iterations, and the spectrum gives "
        f"{wanted:.6g} m there. Is the spectrum continuous?"
    )


def _spectral(spectrum: Callable[[float, float], float], period: float, damping_ratio: float) -> float:
    """Evaluate and check the spectral displacement [m]; ValueError unless it is finite and > 0."""
    value = float(spectrum(period, damping_ratio))
    if not (np.isfinite(value) and value > 0.0):
        raise ValueError(
            f"`spectrum` must be finite and > 0, got {value} at {period:.6g} s and a damping of {damping_ratio:.4g}."
        )
    return value


# Range and density of the amplitudes tried: from a tenth of that by the unloaded stiffness, fine enough for three roots.
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
    """Response curve by equivalent linearisation: a column for each of up to three amplitudes of a frequency, rising."""

    frequency: Array  # [Hz], (n_f,)
    deflection: Array  # amplitude of the deflection D [m], (n_f, 3); NaN where there are fewer solutions
    amplitude: Array  # largest |absolute acceleration| of the mass [m/s^2], (n_f, 3)
    stiffness: Array  # K [N/m], (n_f, 3)
    damping_ratio: Array  # of the loop [-], (n_f, 3)

    @property
    def solutions(self) -> Integers:
        return np.isfinite(self.deflection).sum(axis=1)


def equivalent_linear(
    law: Law, *, mass: float, frequencies: ArrayLike, acceleration: float, gravity: float = 0.0
) -> EquivalentLinear:
    """Compute the response of one mass on one isolator axis to a sine of base acceleration by equivalent linearisation.

    For a linear law it is exact. Superharmonics are left out: for a law that saturates or stiffens within the cycle the error
    is a few per cent, and near the superharmonic resonances below the first the result is not valid (bounds in the tests).

    Args:
        law: of the axis, not one that wears.
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
    """Estimate the periodic motions under a sine of base acceleration, the smallest first.

    They are starting values of shooting and harmonic balance: deflection, rate and internal states at phase 0. The arguments
    are those of `equivalent_linear`, for one frequency.
    """
    require_oscillator(law, mass=mass, frequency=frequency, acceleration=acceleration, gravity=gravity)
    omega, orbits = 2.0 * np.pi * frequency, []
    for o in _solutions(law, _oscillators(law, mass * gravity), mass, frequency, acceleration):
        phasor = 1j * mass * acceleration / complex(o.stiffness - mass * omega**2, omega * o.damping)
        turning = phasor * np.exp(2j * np.pi * np.arange(_SAMPLES + 1) / _SAMPLES)
        deflection, rate = o.offset + turning.real, (1j * omega * turning).real
        states = steady_cycle(law, deflection, rate, period=1.0 / o.frequency).loop.internal_states[0]
        orbits.append(
            LinearisedOrbit(oscillator=o, phasor=phasor, deflection=float(deflection[0]), rate=float(rate[0]), states=states)
        )
    return tuple(orbits)


def _oscillators(law: Law, weight: float) -> Callable[[float, float], EquivalentOscillator]:
    """Make `oscillator_at` a function of amplitude [m] and frequency [Hz], cached by amplitude for rate-independent laws."""
    if not law.rate_independent:
        return lambda amplitude, frequency: oscillator_at(law, amplitude, frequency=frequency, weight=weight)
    at_1_hz = cache(lambda amplitude: oscillator_at(law, amplitude, frequency=1.0, weight=weight))
    return lambda amplitude, frequency: replace(at_1_hz(amplitude), frequency=frequency)


def _solutions(
    law: Law, oscillator: Callable[[float, float], EquivalentOscillator], mass: float, frequency: float, acceleration: float
) -> list[EquivalentOscillator]:
    """Find the oscillators whose amplitude is that of their own response to the base, the smallest first."""
    omega = 2.0 * np.pi * frequency

    def excess(log_amplitude: float) -> float:
        """Compute the logarithm of the force that the amplitude needs over the excitation's."""
        o = oscillator(float(np.exp(log_amplitude)), frequency)
        needed = abs(complex(o.stiffness - mass * omega**2, omega * o.damping)) * o.amplitude
        return float(np.log(needed / (mass * acceleration))) if needed > 0.0 else -np.inf

    unloaded = law.initial_stiffness + omega * law.damping_coefficient + mass * omega**2
    # The same amplitudes at all frequencies: their loops are computed once.
    start = np.floor(np.log10(0.1 * mass * acceleration / unloaded) * _PER_DECADE)
    grid = np.log(10.0) / _PER_DECADE * (start + np.arange(int(_DECADES * _PER_DECADE) + 1))
    return [oscillator(float(np.exp(root)), frequency) for root in _roots(excess, grid)]


def _roots(function: Callable[[float], float], grid: Array) -> Iterator[float]:
    """Yield the roots of a function between the points of a grid, two that are closer than its points included."""
    values = np.array([function(point) for point in grid])
    for i in range(grid.size - 1):
        if values[i] * values[i + 1] <= 0.0 and np.isfinite(values[i + 1]):
            yield float(scipy.optimize.brentq(function, grid[i], grid[i + 1], xtol=1e-15, rtol=1e-14))
        around = values[i - 1 : i + 2]
        if i > 0 and np.ptp(np.sign(around)) == 0.0 and np.argmin(np.abs(around)) == 1:  # local minimum of the size
            low, high, side = grid[i - 1], grid[i + 1], np.sign(values[i])
            tip = scipy.optimize.minimize_scalar(
                lambda x, side=side: side * function(x), bounds=(low, high), method="bounded"
            ).x
            if side * function(tip) < 0.0:
                yield float(scipy.optimize.brentq(function, low, tip, rtol=1e-14))
                yield float(scipy.optimize.brentq(function, tip, high, rtol=1e-14))
