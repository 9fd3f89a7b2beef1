"""Ni's modifications of the Bouc-Wen law for wire-rope isolators."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import kernels
from wirerope_mj.mounts.laws.hysteresis import Hysteresis
from wirerope_mj.mounts.laws.law import anywhere


@dataclass(frozen=True, kw_only=True)
class SymmetricBoucWen(Hysteresis):
    """Ni's symmetric law for shear and roll: F = z + F1(x), F1 = k1 x + k2 sgn(x) x^2 + k3 x^3.

    Softens at small deflections through z and hardens at large ones through k2 [N/m^2] and k3 [N/m^3]; k1 [N/m], z and its
    parameters as in `Hysteresis`. F1 is that of a stable spring if k1, k3 >= 0 and k2 >= -3 sqrt(k1 k3 / 2); a fit that ends
    elsewhere holds for its own travel only. Source: Ni, Ko, Wong and Zhan (1999) as described in Schwanen (2004), section 3.4.
    """

    name: ClassVar[str] = "symmetric-bouc-wen"
    kernel: ClassVar[int] = kernels.SYMMETRIC_BOUC_WEN

    alpha: float
    beta: float
    gamma: float
    n: float
    k1: float
    k2: float
    k3: float

    def kernel_parameters(self) -> Array:
        """Return alpha, beta, gamma, n, k1, k2, k3."""
        return np.array([self.alpha, self.beta, self.gamma, self.n, self.k1, self.k2, self.k3])

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state, alpha + k1 [N/m]."""
        return self.alpha + self.k1


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
    kernel: ClassVar[int] = kernels.ASYMMETRIC_BOUC_WEN

    b: float
    c: float

    def _validate(self) -> None:
        super()._validate()
        if anywhere(self.b <= 0.0):
            raise ValueError(f"`b` must be > 0, got {self.b}: F2 = b^(c x) is a stiffness factor.")

    def kernel_parameters(self) -> Array:
        """Return alpha, beta, gamma, n, k1, k2, k3, c ln b."""
        return np.append(super().kernel_parameters(), self.asymmetry)

    @property
    def asymmetry(self) -> float:
        """Exponent lambda = c ln b of F2 = exp(lambda x) [1/m], the only identifiable combination of b and c."""
        return self.c * math.log(self.b)
