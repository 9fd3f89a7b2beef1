"""What all laws with a Bouc-Wen hysteretic force have in common."""

import math
from typing import ClassVar

from wirerope_mj.laws.law import Law


class Hysteresis(Law):
    """A law with the hysteretic state z of the Bouc-Wen equation, thesis (3.7).

        zdot = alpha xdot - [gamma + beta sgn(xdot) sgn(z)] |z|^n xdot

    alpha [N/m] is the slope of z at z = 0; beta and gamma [N^(1-n)/m] shape the loop, beta being the dissipative one; n [-]
    sets the sharpness of the transition. Passive if and only if beta > 0: with S(z) = int_0^z s ds / (alpha +
    (beta - gamma)|s|^n) as stored energy, the power z xdot - dS/dt is proportional to beta. With beta + gamma < 0 and n > 1
    the force is infinite at a finite deflection.
    """

    state_names: ClassVar[tuple[str, ...]] = ("z",)

    # Each law declares its parameters itself, in the order in which they are written; these are what all of them have.
    alpha: float
    beta: float
    n: float

    def _validate(self) -> None:
        for name in ("alpha", "beta", "n"):
            if getattr(self, name) <= 0.0:
                raise ValueError(f"`{name}` must be > 0, got {getattr(self, name)}: the law would not be passive.")

    @property
    def _total(self) -> float:
        """Sum of beta and gamma: what bends the loading branch."""
        return self.beta + getattr(self, "gamma", 0.0)

    @property
    def damping_coefficient(self) -> float:
        """Zero: the force does not depend on the rate [N s/m]."""
        return 0.0

    @property
    def z_max(self) -> float:
        """Bound of z, (alpha / (beta + gamma))^(1/n) [N], thesis (3.19); infinite if beta + gamma <= 0."""
        return (self.alpha / self._total) ** (1.0 / self.n) if self._total > 0.0 else math.inf

    @property
    def finite_travel(self) -> float:
        """Deflection at which z becomes infinite on the virgin path [m]; infinite unless beta + gamma < 0 and n > 1.

        x* = (1/alpha) (alpha / |beta + gamma|)^(1/n) (pi/n) / sin(pi/n), the integral of dz / (alpha + |beta + gamma| z^n).
        """
        if self._total >= 0.0 or self.n <= 1.0:
            return math.inf
        share = math.pi / self.n
        return (self.alpha / -self._total) ** (1.0 / self.n) / self.alpha * share / math.sin(share)
