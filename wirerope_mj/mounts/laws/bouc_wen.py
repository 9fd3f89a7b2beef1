"""Bouc-Wen's hysteretic force, common to all laws with it, and the laws of the thesis and of Ozdemir."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import power, where
from wirerope_mj.foundation.structure import bounds
from wirerope_mj.mounts.laws.law import FAINT, Law, Normalised, Spring, Stiffness, anywhere

# Least n of a law. States are followed to rounding below it too; but there (1/2)^(1/n), a millionth of its bound, is the z at
# which half of the slope is gone, which no test shows, and 1 % of beta + gamma is 1 / n % of the bound, more than 20 %.
LEAST_EXPONENT = 0.05
# Largest n of a law: its loop is within 3 % of a parallelogram, and beyond it the corner is a jump of the tangent.
LARGEST_EXPONENT = 100.0
# (|z| / z_max)^n between which the rate of z is bounded. Solutions stay below 1, and stages of steps up to 1.4 yield
# deflections, for which RK4 is stable at the bound, below 1.5: what such steps compute does not change. Up to some ten yield
# deflections a step z then stays within as many bounds, and an error of percents is left; beyond that the run ends as before,
# in infinity.
OVERSHOOT, FAR = 2.0, 1000.0


_ELASTIC = ("k", "k1", "k2", "k3")  # Parameters of the elastic force beside z


@dataclass(frozen=True, kw_only=True)
class Hysteresis(Law):
    """A law with the hysteretic state z of the Bouc-Wen equation, thesis (3.7).

        zdot = alpha xdot - [gamma + beta sgn(xdot) sgn(z)] |z|^n xdot

    alpha [N/m] is the slope of z at z = 0; beta and gamma [N^(1-n)/m] shape the loop, beta being the dissipative one; n [-]
    sets the sharpness of the transition and is at least 0.05. Passive if and only if beta > 0: with S(z) = int_0^z s ds /
    (alpha + (beta - gamma)|s|^n) as stored energy, the power z xdot - dS/dt is proportional to beta. With beta + gamma < 0 and
    n > 1 the force is infinite at a finite deflection.
    """

    state_names: ClassVar[tuple[str, ...]] = ("z",)
    # A bound of 1 N is never reached, and any two laws that have it can be coupled.
    faint_parameters: ClassVar[Mapping[str, float]] = {"alpha": FAINT, "beta": FAINT, "n": 1.0} | dict.fromkeys(
        ("gamma", "k", "k1", "k2", "k3", "c"), 0.0
    )

    alpha: Stiffness
    beta: Annotated[float, bounds("N^(1-n)/m")]
    gamma: Annotated[float, bounds("N^(1-n)/m")]
    n: float

    @classmethod
    def from_normalised(cls, *, z_max: float, x_y: float, sigma: float, n: float, **others: float) -> Self:
        """Return the law with alpha, beta and gamma from the normalised form; `others` are its further parameters.

        alpha = z_max / x_y, beta = sigma alpha / z_max^n, gamma = (1 - sigma) alpha / z_max^n.
        """
        for name in ("alpha", "beta", "gamma"):
            if name in others:
                raise ValueError(f"`{name}` follows from the normalised form and cannot be given with it.")
        form = Normalised(z_max=z_max, x_y=x_y, sigma=sigma, n=n)
        alpha = form.z_max / form.x_y
        try:
            total = alpha / float(form.z_max) ** float(n)
        except (OverflowError, ZeroDivisionError):
            raise ValueError(f"`z_max`^`n` must be a finite number > 0, got {z_max}^{n}: take other units.") from None
        return cls(**{"alpha": alpha, "beta": sigma * total, "gamma": (1.0 - sigma) * total, "n": n, **others})

    @property
    def normalised(self) -> Normalised:
        """The normalised form; ValueError if z is not bounded."""
        if self._total <= 0.0:
            raise ValueError(f"`beta` + `gamma` must be > 0 for a normalised form, got {self._total}: z has no bound.")
        return Normalised(z_max=self.z_max, x_y=self.z_max / self.alpha, sigma=self.beta / self._total, n=self.n)

    @property
    def normal_form(self) -> Normalised | None:  # type: ignore[override]
        return self.normalised if self._total > 0.0 else None

    @property
    def bouc_wen_parameters(self) -> Array | None:  # type: ignore[override]
        return self.kernel_parameters()[:4] if self.n_states == 1 else None

    @property
    def is_steep(self) -> bool:  # type: ignore[override]
        return self.n < 1.0

    @property
    def yield_rate(self) -> float:  # type: ignore[override]
        return self.n * self.alpha / self.z_max

    @property
    def coordinates(self) -> dict[str, float]:
        form = self.normalised
        elastic = {name: getattr(self, name) for name in _ELASTIC if hasattr(self, name)}
        return {"z_max": form.z_max, "x_y": form.x_y, "sigma": form.sigma, "n": form.n, **elastic}

    def _validate(self) -> None:
        for name in ("alpha", "beta", "n"):
            if anywhere(getattr(self, name) <= 0.0):
                raise ValueError(f"`{name}` must be > 0, got {getattr(self, name)}: the law would not be passive.")
        if anywhere(self.n < LEAST_EXPONENT):
            raise ValueError(
                f"`n` must be >= {LEAST_EXPONENT}, got {self.n}: below, beta + gamma would have to be known to far better "
                "than 1 % to give the bound of z, (alpha / (beta + gamma))^(1/n), to 20 %, and half of the slope alpha is lost "
                "at a millionth of it. Such a loop is dry friction: take enhanced-dry-friction or masing."
            )
        if anywhere(self.n > LARGEST_EXPONENT):
            raise ValueError(
                f"`n` must be <= {LARGEST_EXPONENT:g}, got {self.n}: beyond, the loop is that of dry friction: take masing."
            )

    @property
    def _total(self) -> float:
        return self.beta + self.gamma

    @property
    def force_powers(self) -> Mapping[str, float]:
        """Power of force in the unit of each parameter; beta and gamma are [N^(1-n)/m]."""
        return {name: 1.0 - self.n if name in ("beta", "gamma") else power for name, power in super().force_powers.items()}

    @property
    def damping_parameters(self) -> tuple[str, ...]:  # type: ignore[override]
        return tuple(name for name in self.force_powers if name not in _ELASTIC)

    @property
    def yield_powers(self) -> Mapping[str, float]:  # type: ignore[override]
        """Exponents with which a factor on the yield deflection of z enters each parameter."""
        return {name: -1.0 for name in self.units() if name in ("alpha", "beta", "gamma")}

    @property
    def z_max(self) -> float:
        """Bound of z, (alpha / (beta + gamma))^(1/n) [N], thesis (3.19); infinite if beta + gamma <= 0."""
        return (self.alpha / self._total) ** (1.0 / self.n) if self._total > 0.0 else math.inf

    @property
    def finite_travel(self) -> float:  # type: ignore[override]
        """Deflection at which z becomes infinite on the virgin path [m]; infinite unless beta + gamma < 0 and n > 1.

        x* = (1/alpha) (alpha / |beta + gamma|)^(1/n) (pi/n) / sin(pi/n), the integral of dz / (alpha + |beta + gamma| z^n).
        """
        if not anywhere((self._total < 0.0) & (self.n > 1.0)):
            return math.inf
        angle = math.pi / self.n
        return (self.alpha / -self._total) ** (1.0 / self.n) / self.alpha * angle / math.sin(angle)


@inlined
def bouc_wen_rate(alpha, beta, gamma, n, v, z):
    """Return zdot = alpha v - [gamma + beta sgn(v) sgn(z)] |z|^n v [N/s], thesis (3.7); no |z|^(n-1), so n < 1 is safe.

    Beyond `OVERSHOOT` of the bound, where no solution is but a stage of a long step may be, the slope stays bounded: -alpha
    on the way out and alpha on the way back. Else a step of more than 1.4 yield deflections ends in infinity.
    """
    size, out = power(abs(z), n), v * z >= 0.0
    pull, reach = (gamma + where(out, beta, -beta)) * size, (beta + gamma) * size
    bounded = where(reach > OVERSHOOT * alpha, where(out, OVERSHOOT * alpha, 0.0), pull)
    return (alpha - where(reach > FAR * alpha, pull, bounded)) * v


BOUC_WEN = 0


@dataclass(frozen=True, kw_only=True)
class BoucWen(Hysteresis):
    """Bouc-Wen hysteresis with a linear spring k [N/m] in parallel, F = k x + z; z and its parameters as in `Hysteresis`.

    Source: W. Schwanen, Modelling and identification of the dynamic behavior of a wire rope spring (2004), (3.7), (3.9).
    """

    name: ClassVar[str] = "bouc-wen"
    kernel: ClassVar[int] = BOUC_WEN
    example: ClassVar[Entries] = {"alpha": 1e5, "beta": 75.0, "gamma": 30.0, "n": 1.2, "k": 2e4}
    smoothable: ClassVar[bool] = True
    elastic: ClassVar[tuple[str, ...]] = ("k",)
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k")

    k: Spring = 0.0


@dataclass(frozen=True, kw_only=True)
class Ozdemir(Hysteresis):
    """Ozdemir's law: Bouc-Wen with gamma = 0, zdot = alpha xdot - beta |xdot| |z|^(n-1) z, and F = k x + z.

    Softening only. A parameterisation of the Bouc-Wen kernel. Source: thesis 3.2.1.
    """

    name: ClassVar[str] = "ozdemir"
    kernel: ClassVar[int] = BOUC_WEN
    example: ClassVar[Entries] = {"alpha": 1e5, "beta": 300.0, "n": 1.0, "k": 2e4}
    smoothable: ClassVar[bool] = True
    elastic: ClassVar[tuple[str, ...]] = ("k",)
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k")

    gamma: ClassVar[float] = 0.0  # type: ignore[misc]
    k: Spring = 0.0

    @classmethod
    def from_normalised(cls, *, z_max: float, x_y: float, sigma: float = 1.0, n: float, **others: float) -> Self:
        """Return the law from the normalised form, whose sigma can only be 1."""
        if sigma != 1.0:
            raise ValueError(f"`sigma` must be 1, got {sigma}: Ozdemir's law has no gamma.")
        form = Normalised(z_max=z_max, x_y=x_y, sigma=sigma, n=n)
        return cls(alpha=form.z_max / form.x_y, beta=form.z_max ** (1.0 - n) / form.x_y, n=n, **others)

    def kernel_parameters(self) -> Array:
        return np.array([self.alpha, self.beta, 0.0, self.n, self.k])

    @property
    def coordinates(self) -> dict[str, float]:
        return {name: value for name, value in super().coordinates.items() if name != "sigma"}


@njit
def bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F = k x + z [N], thesis (3.4) with g = k x; p = alpha, beta, gamma, n, k."""
    hysteretic = z[j]
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, hysteretic)
    return p[i + 4] * x + hysteretic
