"""Bouc-Wen law of the thesis and Ozdemir's reduction of it."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from wirerope_mj.laws import kernels
from wirerope_mj.laws.law import Law, require_not_negative


@dataclass(frozen=True, kw_only=True)
class BoucWen(Law):
    """Bouc-Wen hysteresis with a linear spring in parallel.

        F = k x + z
        zdot = alpha xdot - [gamma + beta sgn(xdot) sgn(z)] |z|^n xdot

    alpha [N/m] is the slope of z at z = 0; beta and gamma [N^(1-n)/m] shape the loop, beta being the
    dissipative one; n [-] sets the sharpness of the transition; k [N/m]. With beta + gamma > 0 the hysteretic
    force is bounded by z_max = (alpha / (beta + gamma))^(1/n), thesis (3.19).

    Passive if and only if beta > 0; with beta + gamma < 0 and n > 1 the force is infinite at a finite deflection.
    Source: W. Schwanen, Modelling and identification of the dynamic behavior of a wire rope spring (2004), (3.7), (3.9).
    """

    name: ClassVar[str] = "bouc-wen"
    kernel: ClassVar[int] = kernels.BOUC_WEN
    state_names: ClassVar[tuple[str, ...]] = ("z",)

    alpha: float
    beta: float
    gamma: float
    n: float
    k: float = 0.0

    def _validate(self) -> None:
        validate_hysteresis(alpha=self.alpha, beta=self.beta, n=self.n)
        require_not_negative(self, "k")

    def kernel_parameters(self) -> npt.NDArray[np.float64]:
        """Return alpha, beta, gamma, n, k."""
        return np.array([self.alpha, self.beta, self.gamma, self.n, self.k])

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state, alpha + k [N/m]."""
        return self.alpha + self.k

    @property
    def damping_coefficient(self) -> float:
        """Zero: the force does not depend on the rate [N s/m]."""
        return 0.0

    @property
    def z_max(self) -> float:
        """Bound of the hysteretic force [N], thesis (3.19); infinite if beta + gamma <= 0."""
        return hysteretic_bound(self.alpha, self.beta, self.gamma, self.n)

    @property
    def finite_travel(self) -> float:
        """Deflection at which the virgin path reaches infinite force [m]; infinite unless beta + gamma < 0 and n > 1."""
        return finite_travel(self.alpha, self.beta, self.gamma, self.n)


@dataclass(frozen=True, kw_only=True)
class Ozdemir(Law):
    """Ozdemir's law: Bouc-Wen with gamma = 0, zdot = alpha xdot - beta |xdot| |z|^(n-1) z, and F = k x + z.

    Softening only, z_max = (alpha / beta)^(1/n). A parameterisation of the Bouc-Wen kernel. Source: thesis 3.2.1.
    """

    name: ClassVar[str] = "ozdemir"
    kernel: ClassVar[int] = kernels.BOUC_WEN
    state_names: ClassVar[tuple[str, ...]] = ("z",)

    alpha: float
    beta: float
    n: float
    k: float = 0.0

    def _validate(self) -> None:
        validate_hysteresis(alpha=self.alpha, beta=self.beta, n=self.n)
        require_not_negative(self, "k")

    def kernel_parameters(self) -> npt.NDArray[np.float64]:
        """Return alpha, beta, 0, n, k."""
        return np.array([self.alpha, self.beta, 0.0, self.n, self.k])

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state, alpha + k [N/m]."""
        return self.alpha + self.k

    @property
    def damping_coefficient(self) -> float:
        """Zero: the force does not depend on the rate [N s/m]."""
        return 0.0

    @property
    def z_max(self) -> float:
        """Bound of the hysteretic force [N]."""
        return hysteretic_bound(self.alpha, self.beta, 0.0, self.n)


def validate_hysteresis(*, alpha: float, beta: float, n: float) -> None:
    """Raise ValueError unless alpha, beta, gamma, n describe a passive hysteresis.

    beta > 0 is what passivity takes: with S(z) = int_0^z s ds / (alpha + (beta - gamma)|s|^n) as stored energy, the power
    z xdot - dS/dt is proportional to beta.
    """
    for name, value in (("alpha", alpha), ("beta", beta), ("n", n)):
        if value <= 0.0:
            raise ValueError(f"`{name}` must be > 0, got {value}: the law would not be passive.")


def hysteretic_bound(alpha: float, beta: float, gamma: float, n: float) -> float:
    """Return z_max = (alpha / (beta + gamma))^(1/n) [N], infinite if beta + gamma <= 0."""
    return (alpha / (beta + gamma)) ** (1.0 / n) if beta + gamma > 0.0 else math.inf


def finite_travel(alpha: float, beta: float, gamma: float, n: float) -> float:
    """Return the deflection [m] at which z becomes infinite on the virgin path; infinite where it does not.

    For beta + gamma < 0 and n > 1 it is x* = (1/alpha) (alpha / |beta + gamma|)^(1/n) (pi/n) / sin(pi/n), the integral of
    dz / (alpha + |beta + gamma| z^n).
    """
    total = -(beta + gamma)
    if total <= 0.0 or n <= 1.0:
        return math.inf
    return (alpha / total) ** (1.0 / n) / alpha * (math.pi / n) / math.sin(math.pi / n)
