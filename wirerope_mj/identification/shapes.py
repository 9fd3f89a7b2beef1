"""Laws that reproduce the figures of a data sheet exactly.

All have n = 1 and gamma = 0, so that z = alpha x_y (1 - exp(-x / x_y)) on the virgin path, with the yield deflection
x_y = 1 / beta. Written S(x) = z + k1 x + k3 x^3, the force is F = exp(lambda x) S with lambda = ln(r) / (2 D), where
r = F(D) / |F(-D)|: S is odd, so r is met exactly. What is left is linear in alpha, k1, k3 for a given x_y, and the last
figure is met by a root in one variable.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from wirerope_mj.errors import ConvergenceError
from wirerope_mj.identification.figures import damping_ratio
from wirerope_mj.laws import AsymmetricBoucWen, SymmetricBoucWen
from wirerope_mj.units import STANDARD_GRAVITY

HARDENING_YIELD = 0.2
"""Share of the rated travel at which z yields where k3 is in use. No source gives it; a fifth keeps the softening well
below the rated travel, where the hardening that the vendor's secants show sets in."""

NiLaw = AsymmetricBoucWen | SymmetricBoucWen


@dataclass(frozen=True, kw_only=True)
class Stiffnesses:
    """Vibration stiffness [N/m] (tangent at the origin), shock stiffness [N/m] (secant at `travel` [m]) and damping."""

    travel: float
    vibration: float
    shock: float
    damping: float


@dataclass(frozen=True, kw_only=True)
class Points:
    """Static and shock force [N] at deflection [m], and the resonance [Hz] of the static load's mass."""

    static_force: float
    static_deflection: float
    shock_force: float
    travel: float
    resonance: float

    @property
    def dynamic_stiffness(self) -> float:
        """Tangent that the resonance asks for [N/m]."""
        return self.static_force / STANDARD_GRAVITY * (2.0 * math.pi * self.resonance) ** 2


def fit_stiffnesses(figures: Stiffnesses, ratio: float | None) -> NiLaw:
    """Return the law with these stiffnesses and damping ratio at half the travel; `ratio` is r, None = symmetric.

    Without hardening (k3 = 0) if some yield deflection gives the damping; else yielding at a fifth of the travel, and
    k3 brings the secant up to the shock stiffness.
    """
    travel, vibration = figures.travel, figures.vibration
    secant = figures.shock * math.sqrt(ratio or 1.0)

    def softening(share: float) -> NiLaw | None:
        alpha = (vibration - secant) / (1.0 - _mean_slope(1.0 / share))
        return _law(alpha, vibration - alpha, 0.0, share * travel, travel, ratio)

    def hardening(share: float) -> NiLaw | None:
        alpha = share * vibration
        lack = secant - vibration + alpha * (1.0 - _mean_slope(1.0 / HARDENING_YIELD))
        return _law(alpha, vibration - alpha, lack / travel**2, HARDENING_YIELD * travel, travel, ratio)

    def surplus(law: NiLaw) -> float:
        return damping_ratio(law, travel / 2.0) - figures.damping

    misses: list[float] = []
    for family, shares in ((softening, np.geomspace(0.02, 0.6, 24)), (hardening, np.linspace(0.05, 0.95, 19))):
        law = _meet(family, surplus, shares, misses)
        if law is not None:
            return law
    reach = (
        f"reach {figures.damping + min(misses):.3g} to {figures.damping + max(misses):.3g}" if misses else "exist not"
    )
    raise ConvergenceError(
        f"no law has a damping ratio of {figures.damping:.3g} with a vibration stiffness of {vibration:.6g} N/m and a "
        f"shock stiffness of {figures.shock:.6g} N/m at {travel:.6g} m: damping ratios {reach}; try another target."
    )


def fit_points(figures: Points, ratio: float | None) -> NiLaw:
    """Return the law through both points whose small vibration about the relaxed sag has the resonance.

    In compression (`ratio` given) k3 = 0 and the yield deflection is found; in shear and roll (None) it is a fifth of
    the travel and k3 is found.
    """
    travel, exponent = figures.travel, _exponent(ratio, figures.travel)
    places = np.array([figures.static_deflection, travel])
    # On the compressive path |F| = exp(-lambda x) S(x): S is what the law without its factor must carry.
    secants = np.array([figures.static_force, figures.shock_force]) / places * np.exp(exponent * places)

    def through_points(yielding: float, k3: float) -> NiLaw | None:
        matrix = np.stack([[_mean_slope(place / yielding) for place in places], np.ones(2)], axis=1)
        alpha, k1 = np.linalg.solve(matrix, secants - k3 * places**2)
        return _law(alpha, k1, k3, yielding, travel, ratio)

    def softening(share: float) -> NiLaw | None:
        return through_points(share * travel, 0.0)

    def hardening(share: float) -> NiLaw | None:
        return through_points(HARDENING_YIELD * travel, share * secants[1] / travel**2)

    def surplus(law: NiLaw) -> float:
        return _relaxed_tangent(law, figures.static_force) / figures.dynamic_stiffness - 1.0

    misses: list[float] = []
    law = _meet(hardening if ratio is None else softening, surplus, np.linspace(0.02, 0.98, 49), misses)
    if law is not None:
        return law
    distance = min((abs(miss) for miss in misses), default=math.inf)
    raise ConvergenceError(
        f"no law goes through {figures.static_force:.6g} N at {figures.static_deflection:.6g} m and "
        f"{figures.shock_force:.6g} N at {travel:.6g} m and has {figures.resonance:.4g} Hz, that is "
        f"{figures.dynamic_stiffness:.6g} N/m, about the relaxed sag: the nearest misses that stiffness by "
        f"{100.0 * distance:.3g} %. Try another tension ratio, or check the three figures against each other."
    )


def _meet(
    family: Callable[[float], NiLaw | None],
    surplus: Callable[[NiLaw], float],
    shares: npt.NDArray[np.float64],
    misses: list[float],
) -> NiLaw | None:
    """Return the law of a one-parameter family without surplus, None if no two neighbours of `shares` enclose one.

    What each trial misses by is added to `misses`, for the message if no family meets the figures.
    """

    def miss(share: float) -> float:
        law = family(share)
        return math.nan if law is None else surplus(law)

    known = [miss(float(share)) for share in shares]
    misses += [value for value in known if math.isfinite(value)]
    for index in range(len(known) - 1):
        if known[index] * known[index + 1] <= 0.0:
            return family(float(brentq(miss, shares[index], shares[index + 1], xtol=1e-13)))
    return None


def _mean_slope(reach: float) -> float:
    """Return z / (alpha x) = (1 - exp(-u)) / u on the virgin path at u = x / x_y."""
    return -math.expm1(-reach) / reach


def _exponent(ratio: float | None, travel: float) -> float:
    """Return lambda = ln(r) / (2 D) [1/m]; 0 for a symmetric law."""
    return 0.0 if ratio is None else math.log(ratio) / (2.0 * travel)


def _law(alpha: float, k1: float, k3: float, yielding: float, travel: float, ratio: float | None) -> NiLaw | None:
    """Return the law of these parameters, or None unless it is passive and its elastic part alone carries load.

    Without an elastic part that grows everywhere no equilibrium would be left once vibration has relaxed z.
    """
    if alpha <= 0.0 or k1 <= 0.0 or k3 < 0.0:
        return None
    values = {"alpha": alpha, "beta": 1.0 / yielding, "gamma": 0.0, "n": 1.0, "k1": k1, "k2": 0.0, "k3": k3}
    # Nine digits are what a file should show; they are far below every tolerance.
    values = {key: float(f"{value:.9g}") for key, value in values.items()}
    if ratio is None:
        return SymmetricBoucWen(**values)
    return AsymmetricBoucWen(**values, b=math.e, c=float(f"{_exponent(ratio, travel):.9g}"))


def _relaxed_tangent(law: NiLaw, load: float) -> float:
    """Return F2 (alpha + F1') + lambda F2 F1 [N/m] where F2 F1 = -load, x < 0; NaN if nowhere."""
    exponent = law.asymmetry if isinstance(law, AsymmetricBoucWen) else 0.0

    def elastic(x: float) -> float:
        return math.exp(exponent * x) * x * (law.k1 + law.k3 * x * x)

    # A spring k1 softened by F2 carries most at x = -1 / lambda; without F2 at most load / k1 is needed.
    far = max(-3.0 * load / law.k1, -1.0 / exponent if exponent else -math.inf)
    if elastic(far) > -load:
        return math.nan
    x = brentq(lambda x: elastic(x) + load, far, 0.0, xtol=1e-15)
    return float(math.exp(exponent * x) * (law.alpha + law.k1 + 3.0 * law.k3 * x * x) - exponent * load)
