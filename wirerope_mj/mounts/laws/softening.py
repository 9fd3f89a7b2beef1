"""Bouc-Wen laws that soften in use: by wear and pinching, or by the largest deflection so far, as filled rubber does."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import raised, some, where
from wirerope_mj.foundation.structure import NotNegative, bounds
from wirerope_mj.mounts.laws.bouc_wen import Hysteresis, bouc_wen_rate
from wirerope_mj.mounts.laws.law import Quadratic, Spring, anywhere
from wirerope_mj.mounts.laws.ni import polynomial

BABER_NOORI = 8
# Fraction of its first stiffness that a worn law keeps: at none, z would vanish over no distance if n < 1.
WORN_OUT = 1e-3


@dataclass(frozen=True, kw_only=True)
class BoucWenBaberNoori(Hysteresis):
    """Bouc-Wen-Baber-Noori law: F = k x + z, with wear and pinching that grow with the work e of z, edot = z xdot [J].

        zdot = (h / eta) {A xdot - nu [gamma + beta sgn(xdot) sgn(z)] |z|^n xdot}
        A = alpha - delta_alpha e (not below alpha / 1000: worn out),   nu = 1 + delta_nu e,   eta = 1 + delta_eta e
        h = 1 - s exp{-[z sgn(xdot) - q z_u]^2 / w^2},   s = zeta (1 - exp(-p e)),   w = (psi + delta_psi e)(lam + s)
        z_u = [A / (nu (beta + gamma))]^(1/n)

    delta_alpha [1/m^2] takes stiffness, delta_nu [1/J] strength, delta_eta [1/J] stiffness at the same strength. The loop is
    pinched around z = q z_u while loading: zeta [-], 0 <= zeta < 1, is the final depth, p [1/J] how fast it comes, psi [N],
    delta_psi [N/J] and lam [-] its width. Without wear and pinching it is the Bouc-Wen law. It is passive whatever the wear: at
    equal z and e unloading is never less steep than loading (beta > 0, q >= 0), so that no path gives back more than e.

    Wire ropes need it only for wear and cyclic softening. Source: Baber and Noori; the form is that of the public codes BWBN.
    """

    name: ClassVar[str] = "bouc-wen-baber-noori"
    kernel: ClassVar[int] = BABER_NOORI
    example: ClassVar[Entries] = {
        "alpha": 1e5, "beta": 250.0, "gamma": 100.0, "n": 1.0, "k": 4e4, "delta_alpha": 200.0, "delta_nu": 0.1,
        "delta_eta": 0.05, "zeta": 0.6, "q": 0.1, "p": 1.0, "psi": 60.0, "delta_psi": 5.0, "lam": 0.5,
    }  # fmt: skip
    state_names: ClassVar[tuple[str, ...]] = ("z", "e")  # the hysteretic force [N] and its work [J]
    elastic: ClassVar[tuple[str, ...]] = ("k",)
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k")

    k: Spring = 0.0
    delta_alpha: Annotated[float, bounds("1/m^2", ge=0.0)] = 0.0
    delta_nu: Annotated[float, bounds("1/J", ge=0.0)] = 0.0
    delta_eta: Annotated[float, bounds("1/J", ge=0.0)] = 0.0
    zeta: NotNegative = 0.0
    q: NotNegative = 0.0
    p: Annotated[float, bounds("1/J", ge=0.0)] = 0.0
    psi: Annotated[float, bounds("N", ge=0.0)] = 0.0
    delta_psi: Annotated[float, bounds("N/J", ge=0.0)] = 0.0
    lam: NotNegative = 0.0

    def _validate(self) -> None:
        super()._validate()
        if anywhere(self.beta + self.gamma <= 0.0):
            raise ValueError(f"`beta` + `gamma` must be > 0, got {self.beta + self.gamma}: z would have no bound.")
        if anywhere(self.zeta >= 1.0):
            raise ValueError(f"`zeta` must be < 1, got {self.zeta}: at 1 the pinched branch has no stiffness left.")
        if anywhere((self.zeta > 0.0) & ((self.psi == 0.0) | (self.lam + self.p == 0.0))):
            raise ValueError("`psi` and one of `lam` and `p` must be > 0 if `zeta` is: the pinching would have no width.")


@njit
def baber_noori(p, i, x, v, z, j, zdot, k):
    """Return F = k x + z [N] with wear and pinching; states z and its work e [J].

    p = alpha, beta, gamma, n, k, delta_alpha, delta_nu, delta_eta, zeta, q, p, psi, delta_psi, lam.
    """
    force, e = z[j], z[j + 1]
    alpha = max(p[i] - p[i + 5] * e, WORN_OUT * p[i])
    nu, eta = 1.0 + p[i + 6] * e, 1.0 + p[i + 7] * e
    beta, gamma, n = nu * p[i + 1], nu * p[i + 2], p[i + 3]
    slip = p[i + 8] * -math.expm1(-p[i + 10] * e)
    pinch = 1.0
    pinched = (slip > 0.0) & (v != 0.0)
    if some(pinched):
        bound = raised(alpha / (beta + gamma), 1.0 / n)
        width = (p[i + 11] + p[i + 12] * e) * (p[i + 13] + slip)
        distance = (where(v > 0.0, force, -force) - p[i + 9] * bound) / width
        pinch = where(pinched, 1.0 - slip * math.exp(-distance * distance), 1.0)
    zdot[k] = pinch / eta * bouc_wen_rate(alpha, beta, gamma, n, v, force)
    zdot[k + 1] = force * v
    return p[i + 4] * x + force


SCRAGGED_BOUC_WEN = 15
# Path, in units of `reach`, on which m closes all but 1/e of its distance to |x|: far below what the softening resolves, and
# long enough for steps that resolve the motion. Without it the rate of m would jump, and a step would miss part of a peak.
CATCHES_UP = 0.1


@dataclass(frozen=True, kw_only=True)
class ScraggedBoucWen(Hysteresis):
    """Bouc-Wen with Ni's polynomial F1, both softer the farther the device has been (scragging, Mullins' effect).

        F  = D(m) z + {1 - [1 - D(m)] [1 - min(1, x^2 / m^2)]} F1(x),   D(m) = 1 - softening [1 - exp(-m / reach)]
        dm = max(0, |x| - m) |dx| / (reach / 10)

    z and its parameters as in `Hysteresis`, F1 = k1 x + k2 sgn(x) x^2 + k3 x^3 [N]; m [m] follows the largest |x| so far.
    Beyond m the elastic force is that of the virgin device, and within it is lost what x^2 / m^2, the energy of the deflection
    over the largest, leaves of the softening [-], 0 to less than 1, which comes over `reach` [m]. It is lost for the rest of
    the path, and a new run begins virgin.

    Passive: no part of F at a given x grows with m, m never falls, and F1 x >= 0, so that with S(z) of `Hysteresis`
    D(m) S(z) + int_0^x {..} F1 dx is an energy that m only takes from.

    Source: the form of F is ours, after L. Mullins, Softening of rubber by deformation, Rubber Chem. Technol. 42 (1969) 339,
    and the damage variable of R. W. Ogden and D. G. Roxburgh, A pseudo-elastic model for the Mullins effect in filled rubber,
    Proc. R. Soc. A 455 (1999) 2861, which depends on the energy over the largest.
    """

    name: ClassVar[str] = "scragged-bouc-wen"
    kernel: ClassVar[int] = SCRAGGED_BOUC_WEN
    example: ClassVar[Entries] = {
        "alpha": 1e5, "beta": 250.0, "gamma": 100.0, "n": 1.0, "softening": 0.4, "reach": 4e-3, "k1": 8e4, "k2": -1e6,
        "k3": 2e7,
    }  # fmt: skip
    # z before its softening [N], the deflection that is remembered [m]
    state_names: ClassVar[tuple[str, ...]] = ("z", "m")
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k1")

    softening: NotNegative
    reach: Annotated[float, bounds("m", gt=0.0)]
    k1: Spring = 0.0
    k2: Quadratic = 0.0
    k3: Annotated[float, bounds("N/m^3", ge=0.0)] = 0.0

    def _validate(self) -> None:
        super()._validate()
        if anywhere(self.softening >= 1.0):
            raise ValueError(f"`softening` must be < 1, got {self.softening}: nothing of the force would be left.")
        if anywhere(self.k2 < -2.0 * np.sqrt(self.k1 * self.k3)):
            raise ValueError(
                f"`k2` must be >= -2 sqrt(k1 k3) = {-2.0 * np.sqrt(self.k1 * self.k3)}, got {self.k2}: a force against the "
                "spring's own deflection would not be passive."
            )

    def kernel_parameters(self) -> Array:
        """Return alpha, beta, gamma, n, k1, k2, k3, softening, reach."""
        spring, lost = [self.k1, self.k2, self.k3], [self.softening, self.reach]
        return np.array([self.alpha, self.beta, self.gamma, self.n, *spring, *lost])


@njit
def scragged_bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F [N]; states z [N] and m [m]; p = alpha, beta, gamma, n, k1, k2, k3, softening, reach."""
    hysteretic, memory, size = z[j], max(z[j + 1], 0.0), abs(x)
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, hysteretic)
    zdot[k + 1] = max(size - memory, 0.0) * abs(v) / (CATCHES_UP * p[i + 8])
    lost = -p[i + 7] * math.expm1(-memory / p[i + 8])
    within = where(size < memory, 1.0 - size * size / max(memory * memory, 1e-300), 0.0)
    return (1.0 - lost) * hysteretic + (1.0 - lost * within) * polynomial(p[i + 4], p[i + 5], p[i + 6], x)
