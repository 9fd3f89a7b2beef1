"""Spring and damper of a law's closed loop at one amplitude: the coefficients of equivalent linearisation.

Ko's decomposition takes a loop of amplitude D apart into its mid-line and an ellipse of the same area. In the motion D cos(w t)
the mid-line pushes like the spring of its first harmonic, which is that of the whole loop, and the ellipse is a damper,

    K(D) = (1 / (pi D)) int F cos(w t) d(w t)        c(D) = W(D) / (pi w D^2)

Sources: Ko et al. (1992), thesis 2.5.2; for the equivalent coefficients Caughey (1960).

A mass on such a spring gives the peak response to a transient from a linear response spectrum: Demetriades' simplified method.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.dynamics.single_mass.cycle import cycle_force, is_neutral, largest, require_steady
from wirerope_mj.foundation.arguments import finite, positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.mounts.laws import Law

SAMPLES = 256  # samples of a cycle: the area of a loop with a sharp tip is then right to 1e-6
_ITERATIONS = 200  # amplitudes tried: about 30 bring a smooth spectrum to ten digits


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
        """Equivalent viscous coefficient W / (pi w D^2) [N s/m]."""
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
    """Return spring and damper of the law's closed loop at an amplitude [m], about the deflection whose mean force is -weight.

    The frequency [Hz] does not matter to a rate-independent law; a law without an elastic part carries no weight [N].
    """
    angle = 2.0 * np.pi * np.arange(SAMPLES + 1) / SAMPLES
    omega = 2.0 * np.pi * frequency
    shape, rate = amplitude * np.cos(angle), -omega * amplitude * np.sin(angle)

    def force(offset: float) -> Array:
        if not np.isfinite(offset):
            return np.full(SAMPLES, np.nan)
        return cycle_force(law, offset + shape, rate, period=1.0 / frequency)[:-1]

    def mean_force(offset: float) -> float:
        with np.errstate(over="ignore", invalid="ignore"):  # exponentials, at amplitudes far beyond the laws' travel
            return float(force(offset).mean()) + weight

    offset = 0.0 if is_neutral(law) else _offset(mean_force, law, amplitude, weight)
    f = force(offset)
    energy = -2.0 * np.pi * amplitude * float(f @ np.sin(angle[:-1])) / SAMPLES
    return EquivalentOscillator(
        amplitude=amplitude, offset=offset, frequency=frequency, energy=energy,
        stiffness=2.0 * float(f @ np.cos(angle[:-1])) / (SAMPLES * amplitude),
        secant_stiffness=float(f[0] - f[SAMPLES // 2]) / (2.0 * amplitude),
        largest_force=largest(np.abs(f + weight), smooth=not law.rate_independent),
    )  # fmt: skip


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
            return float(scipy.optimize.brentq(excess, before, step, xtol=1e-14 * abs(step), rtol=1e-14))
        before, step = step, 1.5 * step
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
    """Return the peak response to a base motion of which only the response spectrum is known.

    An amplitude D gives the isolator's loop, the loop a secant stiffness K and a damping ratio zeta = W / (2 pi K D^2), these a
    linear oscillator, and that the spectral displacement S; the geometric mean of D and S is tried next. A loop dissipates
    over a full cycle what zeta stands for, and holds no drift: under one short pulse, and where the force
    saturates, the deflection is estimated too low. Source: Demetriades, Constantinou and Reinhorn (1993).

    Args:
        law: of the axis, none that wears. The loop of one that depends on the rate is drawn at the oscillator's period.
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
    """Return the spectral displacement [m], or raise ValueError if it is none."""
    value = float(spectrum(period, damping_ratio))
    if not (np.isfinite(value) and value > 0.0):
        raise ValueError(
            f"`spectrum` must be finite and > 0, got {value} at {period:.6g} s and a damping of {damping_ratio:.4g}."
        )
    return value
