"""Bouc-Wen's hysteretic force, common to all laws with it: its rate, its parameters and their normalised form."""

import math
from collections.abc import Mapping
from typing import ClassVar, Self

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.jit import inlined
from wirerope_mj.foundation.lanes import power, where
from wirerope_mj.mounts.laws.law import FAINT, Law, Normalised, anywhere

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


class Hysteresis(Law):
    """A law with the hysteretic state z of the Bouc-Wen equation, thesis (3.7).

        zdot = alpha xdot - [gamma + beta sgn(xdot) sgn(z)] |z|^n xdot

    alpha [N/m] is the slope of z at z = 0; beta and gamma [N^(1-n)/m] shape the loop, beta being the dissipative one; n [-]
    sets the sharpness of the transition and is at least 0.05. Passive if and only if beta > 0: with S(z) = int_0^z s ds /
    (alpha + (beta - gamma)|s|^n) as stored energy, the power z xdot - dS/dt is proportional to beta. With beta + gamma < 0 and
    n > 1 the force is infinite at a finite deflection.
    """

    state_names: ClassVar[tuple[str, ...]] = ("z",)
    units: ClassVar[Mapping[str, str]] = {
        "alpha": "N/m", "beta": "N^(1-n)/m", "gamma": "N^(1-n)/m", "k": "N/m", "k1": "N/m", "k2": "N/m^2", "k3": "N/m^3",
    }  # fmt: skip
    # A bound of 1 N is never reached, and any two laws that have it can be coupled.
    faint_parameters: ClassVar[Mapping[str, float]] = {"alpha": FAINT, "beta": FAINT, "n": 1.0} | dict.fromkeys(
        ("gamma", "k", "k1", "k2", "k3", "c"), 0.0
    )
    # Each law declares its parameters itself, in the order in which they are written; these are what all of them have.
    alpha: float
    beta: float
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
    def normal_form(self) -> Normalised | None:
        """The normalised form; None if z is not bounded."""
        return self.normalised if self._total > 0.0 else None

    @property
    def bouc_wen_parameters(self) -> Array | None:
        """Those of z; None beside another state."""
        return self.kernel_parameters()[:4] if self.n_states == 1 else None

    @property
    def is_steep(self) -> bool:
        """True if n < 1."""
        return self.n < 1.0

    @property
    def yield_rate(self) -> float:
        """That of z, n alpha / z_max [1/m]."""
        return self.n * self.alpha / self.z_max

    @property
    def coordinates(self) -> dict[str, float]:
        """The normalised form and the elastic part."""
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
        super()._validate()

    @property
    def _total(self) -> float:
        """Sum of beta and gamma: what bends the loading branch."""
        return self.beta + getattr(self, "gamma", 0.0)

    @property
    def force_powers(self) -> Mapping[str, float]:  # type: ignore[override]
        """Power of force in the unit of each parameter; beta and gamma are [N^(1-n)/m]."""
        bends = {name: 1.0 - self.n for name in ("beta", "gamma") if hasattr(self, name)}
        return {"alpha": 1.0, **bends, **{name: 1.0 for name in _ELASTIC if hasattr(self, name)}}

    @property
    def damping_parameters(self) -> tuple[str, ...]:  # type: ignore[override]
        """All parameters of z, which is the hysteretic part."""
        return tuple(name for name in self.force_powers if name not in _ELASTIC)

    @property
    def yield_powers(self) -> Mapping[str, float]:  # type: ignore[override]
        """Those of all slopes of z: z is the same function of the deflection over the factor."""
        return {name: -1.0 for name in ("alpha", "beta", "gamma") if hasattr(self, name)}

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
