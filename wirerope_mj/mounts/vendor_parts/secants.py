"""Ni's laws from the secant stiffnesses that vendors state, by rules that are the same for all parts.

What a sheet states fixes a bound d of the friction force, a spring k1 and, by a damping ratio or as it stands, a yield
deflection x_y. All else of the axis' law is the same for the whole catalogue. The rule of two scales, whose reasons are in
docs/catalogue.md:

    friction       Bouc-Wen states in parallel, n = 2 and gamma = 0: d and x_y, d / 8 and x_y / 20
    axial          c ln b and k3 / k1 a third of the rope loop's
    shear, roll    x_y three quarters of the axial one; k3 / k1 in parts of the rope loop's, which the sheet may state

The curve of the elastic part comes from the rope loop, F1 = k1 (x + kappa x^3) and F2 = exp(lambda x). Friction is d v(a / x_y)
on the virgin path and +-d s(a / x_y) at the ends of the steady loop of amplitude a, v and s those of the rule (`FitRule`): with
one state of n = 1, 1 - exp(-a / x_y) and tanh(a / x_y). A secant is then linear in the two sizes d and k1, and what a vendor
states of the loop's width gives x_y:

    virgin, at a compression of a    exp(-lambda a) [d v(a / x_y) / a + k1 (1 + kappa a^2)]
    steady, amplitude a              cosh(lambda a) [d s(a / x_y) / a + k1 (1 + kappa a^2)]
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.polynomial.legendre import leggauss

from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.mounts.laws import AsymmetricBoucWen, Parallel, SymmetricBoucWen
from wirerope_mj.mounts.vendor_parts.law_values import Secant

NiLaw = AsymmetricBoucWen | SymmetricBoucWen
# Of one panel of `PANELS`, in yield deflections from where the state is zero: the integral is right to rounding.
NODES, WEIGHTS = leggauss(16)
PANELS = np.array([-1.0, 0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 40.0])
_CLOSE = 1e-15  # Relative change of the steady state's search at which it ends


@dataclass(frozen=True, kw_only=True)
class ElasticShape:
    """Shape of the elastic part: exponent lambda of F2 [1/m] (None: a law that is odd) and kappa = k3 / k1 [1/m^2]."""

    asymmetry: float | None
    cubic: float


@dataclass(frozen=True, kw_only=True)
class FitRule:
    """Rule of a fit to vendors' values: what is the same for the laws of all parts."""

    n: int  # exponent of the hysteretic states, 1 or 2, for which loops have a closed form
    # of every state its bound and its yield deflection, in parts of those of the first
    scales: tuple[tuple[float, float], ...]
    asymmetry: float  # c ln b and k3 / k1 along the axis, in parts of those of the rope loop
    # yield deflection in shear in parts of the axial one, where the sheet states no damping in shear
    shear_yield: float

    def friction(self, deflection: float, yielding: float, *, steady: bool) -> float:
        """Return friction over its bound d [-] at a deflection of the virgin path, or at the ends of the steady loop [m]."""
        reaches = [(share, deflection / (part * yielding)) for share, part in self.scales]  # in yield deflections
        if steady:
            return sum(share * _steady(self.n, reach) for share, reach in reaches)
        return sum(share * (-math.expm1(-reach) if self.n == 1 else math.tanh(reach)) for share, reach in reaches)

    def deviation(self, asymmetry: float, of_bars: float) -> float:
        """Return the standard deviation of the axial law's c [1/m], from the rope loop's c and its deviation for the bars.

        What the rope loop says and what the rule makes of it are two deviations apart; that of the bars comes on top.
        """
        return math.hypot(0.5 * (1.0 - self.asymmetry) * asymmetry, self.asymmetry * of_bars)

    def lost(self, amplitude: float, yielding: float, asymmetry: float) -> float:
        """Return the area of the steady loop of an amplitude [m] per newton of the friction's bound d [m].

        It is 2 int cosh(lambda x) w(x) dx on the way up, w summed over the states; on the way down w(x) is -w(-x).
        """
        total = 0.0
        for share, part in self.scales:
            reach, tip = part * yielding, _steady(self.n, amplitude / (part * yielding))
            zero = reach * (math.log1p(tip) if self.n == 1 else math.atan(tip))  # of the way at which w = 0
            ends = np.unique(np.clip([0.0, *(zero + reach * PANELS), 2.0 * amplitude], 0.0, 2.0 * amplitude))
            half = 0.5 * np.diff(ends)[:, None]
            way = ends[:-1, None] + half * (1.0 + NODES)
            after = (way - zero) / reach
            square = np.where(after < 0.0, np.tan(np.minimum(after, 0.0)), np.tanh(after))
            rising = -np.expm1(-after) if self.n == 1 else square
            total += share * float(np.sum(half * WEIGHTS * np.cosh(asymmetry * (way - amplitude)) * rising))
        return 2.0 * total

    def law(self, friction: float, yielding: float, spring: float, curve: ElasticShape) -> NiLaw | Parallel:
        """Return the law with the bound `friction` [N], the yield deflection `yielding` [m] and k1 = `spring` [N/m]."""
        laws: list[NiLaw] = []
        for share, part in self.scales:
            bound, reach, elastic = share * friction, part * yielding, 0.0 if laws else spring
            values = {
                "alpha": bound / reach, "beta": bound ** (1 - self.n) / reach, "gamma": 0.0, "n": float(self.n),
                "k1": elastic, "k2": 0.0, "k3": curve.cubic * elastic,
            }  # fmt: skip
            # Nine digits are what a file should show; they are far below every tolerance.
            values = {key: float(f"{value:.9g}") for key, value in values.items()}
            if curve.asymmetry is None:
                laws.append(SymmetricBoucWen(**values))
            else:
                laws.append(AsymmetricBoucWen(**values, b=math.e, c=float(f"{curve.asymmetry:.9g}")))
        return laws[0] if len(laws) == 1 else Parallel(laws=tuple(laws))


# The rules by their number of scales.
RULES = {
    1: FitRule(n=1, scales=((1.0, 1.0),), asymmetry=1.0, shear_yield=1.0),
    2: FitRule(n=2, scales=((1.0, 1.0), (1.0 / 8.0, 1.0 / 20.0)), asymmetry=1.0 / 3.0, shear_yield=0.75),
}


def first_state(law: NiLaw | Parallel) -> NiLaw:
    """Return the component that has the polynomial and the first hysteretic state."""
    law = law.components[0]  # type: ignore[assignment]
    assert isinstance(law, NiLaw)
    return law


def _steady(n: int, reach: float) -> float:
    """Return w, a hysteretic force over its bound, at the ends of the steady loop of an amplitude of `reach` yield deflections.

    n = 1: w = tanh(reach). n = 2: arctan w + artanh w = 2 reach, on the way from -w to w; with w = tanh u by Newton's method.
    """
    if n == 1:
        return math.tanh(reach)
    u = reach
    for _ in range(100):
        w = math.tanh(u)
        change = (math.atan(w) + u - 2.0 * reach) / (1.0 + (1.0 - w * w) / (1.0 + w * w))
        u -= change
        if abs(change) <= _CLOSE * u:
            break
    return math.tanh(u)


# Amplitude of a vibration stiffness where the vendor states none, as a fraction of the rated travel. It is where VMC's values
# of the CB1400-15 stand: with the sag and the shock response of a rack on ten of them its vibration stiffness in compression
# and that in shear are both the secant at 2.5 mm of 35.6 mm.
VIBRATION_AMPLITUDE = 0.07
# Amplitude of the damping ratio where the data sheet states none [m]: the small vibration for which vendors state damping.
DAMPING_AMPLITUDE = 1e-3
# Yield deflections that are tried, in amplitudes of the damping: below, the loop is a parallelogram, above, a thread.
_REACH = (0.02, 20.0)


def fit_secants(secants: Sequence[Secant], curve: ElasticShape, yielding: float, rule: FitRule = RULES[1]) -> NiLaw | Parallel:
    """Fit the law to the stated secants; of more than two the largest relative error is minimised.

    `yielding` is the yield deflection x_y of friction [m]; all else of the law follows by the rule. ConvergenceError: the
    secants ask for friction or a spring that is not positive.
    """
    friction, spring = _sizes(secants, curve, yielding, rule)
    return rule.law(friction, yielding, spring, curve)


def _sizes(secants: Sequence[Secant], curve: ElasticShape, yielding: float, rule: FitRule) -> tuple[float, float]:
    """Solve for friction [N] and spring [N/m] of these secants; ConvergenceError unless both are positive."""
    exponent, rows = curve.asymmetry or 0.0, []  # secants of 1 N of friction and of 1 N/m of the spring, over the stated ones
    for secant in secants:
        a, steady = secant.deflection, secant.steady
        factor = (math.cosh(exponent * a) if steady else math.exp(-exponent * a)) / secant.stiffness
        rows.append((factor * rule.friction(a, yielding, steady=steady) / a, factor * (1.0 + curve.cubic * a * a)))
    if len(rows) == 2:
        friction, spring = np.linalg.solve(rows, np.ones(2)).tolist()
    else:  # the largest distance of a row from 1 is the least
        matrix = np.array(rows)
        sizes = np.abs(matrix).max(axis=0)  # newtons and newtons per metre, made comparable
        distance = -np.ones((len(rows), 1))
        sides = np.block([[matrix / sizes, distance], [-matrix / sizes, distance]])
        bounds = np.concatenate([np.ones(len(rows)), -np.ones(len(rows))])
        best = scipy.optimize.linprog([0.0, 0.0, 1.0], A_ub=sides, b_ub=bounds, bounds=[(None, None)] * 3)
        friction, spring = (best.x[:2] / sizes).tolist()
    if friction <= 0.0 or spring <= 0.0:
        stated = ", ".join(f"{1e-3 * s.stiffness:.6g} N/mm at {1e3 * s.deflection:.4g} mm" for s in secants)
        raise ConvergenceError(
            f"no passive law has the secants {stated}: they ask for {friction:.6g} N of friction beside a spring of "
            f"{1e-3 * spring:.6g} N/mm. A secant at a small amplitude must exceed that at a large one by more than the "
            "elastic part of the rope loop does."
        )
    return friction, spring


def fit_damped(
    secants: Sequence[Secant], curve: ElasticShape, *, damping: float, amplitude: float, rule: FitRule = RULES[1]
) -> NiLaw | Parallel:
    """Fit the law to these secants and this damping ratio of the steady loop of an amplitude [m].

    ConvergenceError: no yield deflection gives that damping; says what can be reached.
    """
    exponent = curve.asymmetry or 0.0

    def surplus(yielding: float) -> float:
        """Compute the damping ratio with a yield deflection [m], less that asked for."""
        friction, spring = _sizes(secants, curve, yielding, rule)
        friction_force = friction * rule.friction(amplitude, yielding, steady=True)
        tips = math.cosh(exponent * amplitude) * (friction_force + amplitude * spring * (1.0 + curve.cubic * amplitude**2))
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
