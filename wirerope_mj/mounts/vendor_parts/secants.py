"""Ni's laws from the secant stiffnesses that vendors state.

The curve of the elastic part comes from the rope loop, F1 = k1 (x + kappa x^3) and F2 = exp(lambda x). Friction is d v(a / x_y)
on the virgin path and +-d s(a / x_y) at the ends of the steady loop of amplitude a, v and s those of the rule (`FitRule`): with
one state of n = 1, 1 - exp(-a / x_y) and tanh(a / x_y). A secant is then linear in the two sizes d and k1, and what a vendor
states of the loop's width gives x_y:

    virgin, at a compression of a    exp(-lambda a) [d v(a / x_y) / a + k1 (1 + kappa a^2)]
    steady, amplitude a              cosh(lambda a) [d s(a / x_y) / a + k1 (1 + kappa a^2)]
"""

import math

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.mounts.laws import Parallel
from wirerope_mj.mounts.vendor_parts.fit_rule import RULES, ElasticShape, FitRule, NiLaw
from wirerope_mj.mounts.vendor_parts.law_values import Secant

# Amplitude of a vibration stiffness where the vendor states none, as a fraction of the rated travel. It is where VMC's values
# of the CB1400-15 stand: with the sag and the shock response of a rack on ten of them its vibration stiffness in compression
# and that in shear are both the secant at 2.5 mm of 35.6 mm.
VIBRATION_AMPLITUDE = 0.07
# Amplitude of the damping ratio where the data sheet states none [m]: the small vibration for which vendors state damping.
DAMPING_AMPLITUDE = 1e-3
# Yield deflections that are tried, in amplitudes of the damping: below, the loop is a parallelogram, above, a thread.
_REACH = (0.02, 20.0)


def fit_secants(
    secants: tuple[Secant, ...], curve: ElasticShape, yielding: float, rule: FitRule = RULES[1]
) -> NiLaw | Parallel:
    """Return the law whose secants are the stated ones; of more than two the largest relative error is as small as can be.

    Args:
        secants: at least two.
        curve: of the elastic part.
        yielding: yield deflection x_y of friction [m].
        rule: how all else of the law follows.

    Raises:
        ConvergenceError: the secants ask for friction or a spring that is not positive.
    """
    friction, spring = _sizes(secants, curve, yielding, rule)
    return rule.law(friction, yielding, spring, curve)


def _sizes(secants: tuple[Secant, ...], curve: ElasticShape, yielding: float, rule: FitRule) -> tuple[float, float]:
    """Return friction [N] and spring [N/m] of these secants; ConvergenceError unless both are positive."""
    friction, spring = _nearest(np.array([_row(secant, curve, yielding, rule) for secant in secants]))
    if friction <= 0.0 or spring <= 0.0:
        stated = ", ".join(f"{1e-3 * s.stiffness:.6g} N/mm at {1e3 * s.deflection:.4g} mm" for s in secants)
        raise ConvergenceError(
            f"no passive law has the secants {stated}: they ask for {friction:.6g} N of friction beside a spring of "
            f"{1e-3 * spring:.6g} N/mm. A secant at a small amplitude must exceed that at a large one by more than the "
            "elastic part of the rope loop does."
        )
    return friction, spring


def fit_damped(
    secants: tuple[Secant, ...], curve: ElasticShape, *, damping: float, amplitude: float, rule: FitRule = RULES[1]
) -> NiLaw | Parallel:
    """Return the law with these secants and this damping ratio of the steady loop of an amplitude [m].

    Raises:
        ConvergenceError: no yield deflection gives that damping; says what can be reached.
    """
    exponent = curve.asymmetry or 0.0

    def surplus(yielding: float) -> float:
        friction, spring = _sizes(secants, curve, yielding, rule)
        held = friction * rule.friction(amplitude, yielding, steady=True)
        tips = math.cosh(exponent * amplitude) * (held + amplitude * spring * (1.0 + curve.cubic * amplitude**2))
        return friction * rule.lost(amplitude, yielding, exponent) / (2.0 * math.pi * tips * amplitude) - damping

    tried = amplitude * np.geomspace(*_REACH, 25)
    reached: list[float] = []
    for yielding in tried:
        try:
            reached.append(surplus(float(yielding)))
        except ConvergenceError:
            reached.append(math.nan)
    for index in range(len(tried) - 1):
        if reached[index] >= 0.0 > reached[index + 1]:
            # To 1e-13 of a yield deflection of millimetres.
            yielding = float(scipy.optimize.brentq(surplus, tried[index], tried[index + 1], xtol=1e-16, rtol=1e-13))
            return fit_secants(secants, curve, yielding, rule)
    known = [damping + value for value in reached if math.isfinite(value)]
    if not known:
        fit_secants(secants, curve, float(tried[len(tried) // 2]), rule)  # says why there is no law at all
    raise ConvergenceError(
        f"no law with these secants has a damping ratio of {damping:.3g} at {1e3 * amplitude:.4g} mm: damping ratios reach "
        f"{min(known):.3g} to {max(known):.3g}; try another target."
    )


def _nearest(rows: Array) -> tuple[float, float]:
    """Return the two scales with which all rows come nearest to 1: their largest distance is the least."""
    if len(rows) == 2:
        friction, spring = np.linalg.solve(rows, np.ones(2)).tolist()
        return friction, spring
    sizes = np.abs(rows).max(axis=0)  # newtons and newtons per metre, made comparable
    distance = -np.ones((len(rows), 1))
    sides = np.block([[rows / sizes, distance], [-rows / sizes, distance]])
    bounds = np.concatenate([np.ones(len(rows)), -np.ones(len(rows))])
    best = scipy.optimize.linprog([0.0, 0.0, 1.0], A_ub=sides, b_ub=bounds, bounds=[(None, None)] * 3)
    friction, spring = (best.x[:2] / sizes).tolist()
    return friction, spring


def _row(secant: Secant, curve: ElasticShape, yielding: float, rule: FitRule) -> tuple[float, float]:
    """Return the secants of 1 N of friction and of 1 N/m of the spring, as fractions of a stated secant."""
    a, exponent = secant.deflection, curve.asymmetry or 0.0
    factor = (math.cosh(exponent * a) if secant.steady else math.exp(-exponent * a)) / secant.stiffness
    friction = rule.friction(a, yielding, steady=secant.steady)
    return factor * friction / a, factor * (1.0 + curve.cubic * a * a)
