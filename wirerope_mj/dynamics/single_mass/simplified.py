"""Demetriades' simplified method: the peak response to a transient from a linear response spectrum."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wirerope_mj.dynamics.single_mass.cycle import require_steady
from wirerope_mj.dynamics.single_mass.equivalent import oscillator_at
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.mounts.laws import Law

_ITERATIONS = 200
"""Amplitudes tried: about 30 bring a smooth spectrum to ten digits."""


@dataclass(frozen=True, kw_only=True)
class SimplifiedPeak:
    """Peak response of one mass on one isolator axis by an equivalent linear oscillator.

    Attributes:
        deflection: D [m].
        acceleration: K D / m of the mass [m/s^2].
        stiffness: secant stiffness K at D [N/m].
        damping_ratio: of the loop at D [-].
        period: of the equivalent oscillator, 2 pi sqrt(m / K) [s].
        iterations: amplitudes tried.
    """

    deflection: float
    acceleration: float
    stiffness: float
    damping_ratio: float
    period: float
    iterations: int


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
                deflection=deflection,
                acceleration=loop.secant_stiffness * deflection / mass,
                stiffness=loop.secant_stiffness,
                damping_ratio=loop.damping_ratio,
                period=period,
                iterations=iteration,
            )
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
