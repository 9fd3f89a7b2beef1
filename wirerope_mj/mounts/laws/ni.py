"""Ni's modifications of the Bouc-Wen law for wire-rope isolators."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.structure import bounds
from wirerope_mj.mounts.laws.bouc_wen import BOUC_WEN, Hysteresis, bouc_wen, bouc_wen_rate
from wirerope_mj.mounts.laws.law import Cubic, Quadratic, Stiffness, anywhere

ASYMMETRIC_BOUC_WEN = 1
SYMMETRIC_BOUC_WEN = 2


@dataclass(frozen=True, kw_only=True)
class SymmetricBoucWen(Hysteresis):
    """Ni's symmetric law for shear and roll: F = z + F1(x), F1 = k1 x + k2 sgn(x) x^2 + k3 x^3.

    Softens at small deflections through z and hardens at large ones through k2 [N/m^2] and k3 [N/m^3]; k1 [N/m], z and its
    parameters as in `Hysteresis`. F1 is that of a stable spring if k1, k3 >= 0 and k2 >= -3 sqrt(k1 k3 / 2); a fit that ends
    elsewhere holds for its own travel only. Source: (3.15) of Schwanen (2004) with F2 = 1, our reading of what section 3.4 says
    of the symmetric law of Ni, Ko, Wong and Zhan (1999).
    """

    name: ClassVar[str] = "symmetric-bouc-wen"
    kernel: ClassVar[int] = SYMMETRIC_BOUC_WEN
    example: ClassVar[Entries] = {"alpha": 1e5, "beta": 0.6, "gamma": -0.2, "n": 2.0, "k1": 8e4, "k2": 1e5, "k3": 2e7}
    smoothable: ClassVar[bool] = True
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k1")

    k1: Stiffness
    k2: Quadratic
    k3: Cubic


@dataclass(frozen=True, kw_only=True)
class AsymmetricBoucWen(SymmetricBoucWen):
    """Ni's asymmetric law for tension and compression, deflection positive in tension.

        F  = F2(x) [z + F1(x)]                       (3.15), z as in (3.18), F1 as in `SymmetricBoucWen` (3.16)
        F2 = b^(c x)                                 (3.17)

    b [-], c [1/m]. Only the product c ln b acts: with c ln b > 0 the isolator hardens in tension and softens in compression.
    The hysteretic part is passive for every F2 > 0 if beta > 0. Source: Schwanen (2004), section 3.4, after Ni, Ko, Wong and
    Zhan (1999).
    """

    name: ClassVar[str] = "asymmetric-bouc-wen"
    kernel: ClassVar[int] = ASYMMETRIC_BOUC_WEN
    example: ClassVar[Entries] = {
        "alpha": 1e5, "beta": 150.0, "gamma": 30.0, "n": 1.0, "k1": 8e4, "k2": 1e5, "k3": 2e7, "b": 2.0, "c": 6.0,
    }  # fmt: skip

    b: float
    c: Annotated[float, bounds("1/m")]

    def _validate(self) -> None:
        super()._validate()
        if anywhere(self.b <= 0.0):
            raise ValueError(f"`b` must be > 0, got {self.b}: F2 = b^(c x) is a stiffness factor.")

    def kernel_parameters(self) -> Array:
        return np.append(super().kernel_parameters()[:7], self.asymmetry)

    @property
    def asymmetry(self) -> float:
        """Exponent lambda = c ln b of F2 = exp(lambda x) [1/m], the only identifiable combination of b and c."""
        return self.c * math.log(self.b)

    @property
    def coordinates(self) -> dict[str, float]:
        return {**super().coordinates, "c_ln_b": self.asymmetry}


@inlined
def polynomial(k1, k2, k3, x):
    """Return Ni's odd polynomial F1 = k1 x + k2 sgn(x) x^2 + k3 x^3 [N], thesis (3.16)."""
    return x * (k1 + k2 * abs(x) + k3 * x * x)


@njit
def asymmetric_bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F = exp(lambda x) [z + F1(x)] [N], thesis (3.15); p = alpha, beta, gamma, n, k1, k2, k3, lambda."""
    hysteretic = z[j]
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, hysteretic)
    return math.exp(p[i + 7] * x) * (hysteretic + polynomial(p[i + 4], p[i + 5], p[i + 6], x))


@njit
def symmetric_bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F = z + F1(x) [N], Ni's law for shear and roll; p = alpha, beta, gamma, n, k1, k2, k3."""
    hysteretic = z[j]
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, hysteretic)
    return hysteretic + polynomial(p[i + 4], p[i + 5], p[i + 6], x)


@njit
def bouc_wen_force(law, p, i, x, v, z, j, zdot, k):
    """Return the force [N] of the law of Bouc-Wen's or of Ni's with this number, and write the rate of its state."""
    if law == BOUC_WEN:
        return bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == SYMMETRIC_BOUC_WEN:
        return symmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    return asymmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
