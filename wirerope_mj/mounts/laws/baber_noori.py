"""Bouc-Wen law with wear and pinching."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import raised, some, where
from wirerope_mj.mounts.laws.hysteresis import Hysteresis, bouc_wen_rate
from wirerope_mj.mounts.laws.law import anywhere

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
    not_negative: ClassVar[tuple[str, ...]] = (
        "k", "delta_alpha", "delta_nu", "delta_eta", "zeta", "q", "p", "psi", "delta_psi", "lam",
    )  # fmt: skip
    elastic: ClassVar[tuple[str, ...]] = ("k",)
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k")

    alpha: float
    beta: float
    gamma: float
    n: float
    k: float = 0.0
    delta_alpha: float = 0.0
    delta_nu: float = 0.0
    delta_eta: float = 0.0
    zeta: float = 0.0
    q: float = 0.0
    p: float = 0.0
    psi: float = 0.0
    delta_psi: float = 0.0
    lam: float = 0.0

    def _validate(self) -> None:
        super()._validate()
        if anywhere(self.beta + self.gamma <= 0.0):
            raise ValueError(f"`beta` + `gamma` must be > 0, got {self.beta + self.gamma}: z would have no bound.")
        if anywhere(self.zeta >= 1.0):
            raise ValueError(f"`zeta` must be < 1, got {self.zeta}: at 1 the pinched branch has no stiffness left.")
        if anywhere((self.zeta > 0.0) & ((self.psi == 0.0) | (self.lam + self.p == 0.0))):
            raise ValueError("`psi` and one of `lam` and `p` must be > 0 if `zeta` is: the pinching would have no width.")

    @property
    def force_powers(self) -> Mapping[str, float]:  # type: ignore[override]
        """Power of force in the unit of each parameter; the work e grows with the force."""
        return {**super().force_powers, "delta_nu": -1.0, "delta_eta": -1.0, "p": -1.0, "psi": 1.0}


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
