"""Ni's modifications of the Bouc-Wen law for wire-rope isolators."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from wirerope_mj.laws import kernels
from wirerope_mj.laws.bouc_wen import finite_travel, hysteretic_bound, validate_hysteresis
from wirerope_mj.laws.law import Law


@dataclass(frozen=True, kw_only=True)
class AsymmetricBoucWen(Law):
    """Ni's asymmetric law for tension and compression, deflection positive in tension.

        F  = F2(x) [z + F1(x)]                                 (3.15)
        F1 = k1 x + k2 sgn(x) x^2 + k3 x^3                     (3.16)
        F2 = b^(c x)                                           (3.17)
        zdot = alpha xdot - [gamma + beta sgn(xdot) sgn(z)] |z|^n xdot    (3.18)

    k1 [N/m], k2 [N/m^2], k3 [N/m^3], b [-], c [1/m]; the others as in `BoucWen`. Only the product c ln b acts: with
    c ln b > 0 the isolator hardens in tension and softens in compression. The hysteretic part is passive for every
    F2 > 0 if beta > 0. Source: Schwanen (2004), section 3.4, after Ni, Ko, Wong and Zhan (1999).
    """

    name: ClassVar[str] = "asymmetric-bouc-wen"
    kernel: ClassVar[int] = kernels.ASYMMETRIC_BOUC_WEN
    state_names: ClassVar[tuple[str, ...]] = ("z",)

    alpha: float
    beta: float
    gamma: float
    n: float
    k1: float
    k2: float
    k3: float
    b: float
    c: float

    def _validate(self) -> None:
        validate_hysteresis(alpha=self.alpha, beta=self.beta, n=self.n)
        if self.b <= 0.0:
            raise ValueError(f"`b` must be > 0, got {self.b}: F2 = b^(c x) is a stiffness factor.")

    def kernel_parameters(self) -> npt.NDArray[np.float64]:
        """Return alpha, beta, gamma, n, k1, k2, k3, c ln b."""
        return np.array([self.alpha, self.beta, self.gamma, self.n, self.k1, self.k2, self.k3, self.asymmetry])

    @property
    def asymmetry(self) -> float:
        """Exponent lambda = c ln b of F2 = exp(lambda x) [1/m], the only identifiable combination of b and c."""
        return self.c * math.log(self.b)

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state, alpha + k1 [N/m]."""
        return self.alpha + self.k1

    @property
    def damping_coefficient(self) -> float:
        """Zero: the force does not depend on the rate [N s/m]."""
        return 0.0

    @property
    def z_max(self) -> float:
        """Bound of z [N], before the factor F2."""
        return hysteretic_bound(self.alpha, self.beta, self.gamma, self.n)

    @property
    def finite_travel(self) -> float:
        """Deflection at which the virgin path reaches infinite force [m]; infinite unless beta + gamma < 0 and n > 1."""
        return finite_travel(self.alpha, self.beta, self.gamma, self.n)


@dataclass(frozen=True, kw_only=True)
class SymmetricBoucWen(Law):
    """Ni's symmetric law for shear and roll: F = F1(x) + z, the asymmetric law with F2 = 1.

    Softens at small deflections through z and hardens at large ones through k2 and k3. Units as in `AsymmetricBoucWen`.
    Source: Ni, Ko, Wong and Zhan (1999) as described in Schwanen (2004), section 3.4.
    """

    name: ClassVar[str] = "symmetric-bouc-wen"
    kernel: ClassVar[int] = kernels.SYMMETRIC_BOUC_WEN
    state_names: ClassVar[tuple[str, ...]] = ("z",)

    alpha: float
    beta: float
    gamma: float
    n: float
    k1: float
    k2: float
    k3: float

    def _validate(self) -> None:
        validate_hysteresis(alpha=self.alpha, beta=self.beta, n=self.n)

    def kernel_parameters(self) -> npt.NDArray[np.float64]:
        """Return alpha, beta, gamma, n, k1, k2, k3."""
        return np.array([self.alpha, self.beta, self.gamma, self.n, self.k1, self.k2, self.k3])

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state, alpha + k1 [N/m]."""
        return self.alpha + self.k1

    @property
    def damping_coefficient(self) -> float:
        """Zero: the force does not depend on the rate [N s/m]."""
        return 0.0

    @property
    def z_max(self) -> float:
        """Bound of z [N]."""
        return hysteretic_bound(self.alpha, self.beta, self.gamma, self.n)

    @property
    def finite_travel(self) -> float:
        """Deflection at which the virgin path reaches infinite force [m]; infinite unless beta + gamma < 0 and n > 1."""
        return finite_travel(self.alpha, self.beta, self.gamma, self.n)
