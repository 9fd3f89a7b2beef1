"""Laws whose force depends on the deflection rate: linear viscoelastic laws, Tinker and Cutchins', Ko's equivalent viscous."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import raised, some, where
from wirerope_mj.foundation.structure import Positive, bounds
from wirerope_mj.mounts.laws.law import FAINT, Cubic, Law, Quadratic, Spring, Stiffness, anywhere

KELVIN_VOIGT = 3
ZENER = 4


@dataclass(frozen=True, kw_only=True)
class KelvinVoigt(Law):
    """Kelvin-Voigt law F = k x + c xdot, k [N/m], c [N s/m]; complex stiffness k + i omega c, loss factor omega c / k."""

    name: ClassVar[str] = "kelvin-voigt"
    kernel: ClassVar[int] = KELVIN_VOIGT
    example: ClassVar[Entries] = {"k": 1e5, "c": 300.0}
    rate_independent: ClassVar[bool] = False
    faint_parameters: ClassVar[Mapping[str, float]] = {"k": 0.0, "c": FAINT}
    damping_parameters: ClassVar[tuple[str, ...]] = ("c",)
    tangents: ClassVar[tuple[str, ...]] = ("k",)

    k: Spring
    c: Annotated[float, bounds("N s/m", ge=0.0)]

    def _validate(self) -> None:
        if anywhere((self.k == 0.0) & (self.c == 0.0)):
            raise ValueError("`k` and `c` must not both be 0: leave the axis out of the isolator instead.")

    @property
    def damping_coefficient(self) -> float:  # type: ignore[override]
        return self.c


@dataclass(frozen=True, kw_only=True)
class Zener(Law):
    """Zener's law, the standard linear solid: a spring k0 beside a spring k1 [N/m] in series with a damper c [N s/m].

        F = k0 x + z,   zdot = k1 xdot - (k1 / c) z

    z is the force of the branch with the damper. Complex stiffness k0 + k1 i w / (k1 / c + i w), so that the stiffness grows
    from k0 at rest to k0 + k1; the loss factor is largest, k1 / (2 sqrt(k0 (k0 + k1))), at
    w = (k1 / c) sqrt(k0 / (k0 + k1)) [rad/s]. A static load is carried by k0 alone.
    """

    name: ClassVar[str] = "zener"
    kernel: ClassVar[int] = ZENER
    example: ClassVar[Entries] = {"k0": 5e4, "k1": 5e4, "c": 800.0}
    rate_independent: ClassVar[bool] = False
    faint_parameters: ClassVar[Mapping[str, float]] = {"k0": 0.0, "k1": FAINT, "c": FAINT}
    state_names: ClassVar[tuple[str, ...]] = ("z",)  # the force of the branch with the damper
    damping_parameters: ClassVar[tuple[str, ...]] = ("k1", "c")  # that branch, whose force decays as fast as before
    elastic: ClassVar[tuple[str, ...]] = ("k0",)
    tangents: ClassVar[tuple[str, ...]] = ("k0", "k1")  # against a sudden deflection

    k0: Spring
    k1: Annotated[float, bounds("N/m", gt=0.0)]
    c: Annotated[float, bounds("N s/m", gt=0.0)]

    def kernel_parameters(self) -> Array:
        return np.array([self.k0, self.k1, self.relaxation_rate])

    @property
    def relaxation_rate(self) -> float:  # type: ignore[override]
        """Rate k1 / c at which the damper lets its branch's force decay [1/s]."""
        return self.k1 / self.c


Law._faint = (KelvinVoigt(**KelvinVoigt.faint_parameters), Zener(**Zener.faint_parameters))


@njit
def kelvin_voigt(p, i, x, v, z, j, zdot, k):
    """Return F = k x + c v [N]; p = k, c."""
    return p[i] * x + p[i + 1] * v


@njit
def zener(p, i, x, v, z, j, zdot, k):
    """Return F = k0 x + z [N] with zdot = k1 v - r z; p = k0, k1, r = k1 / c."""
    relaxing = z[j]
    zdot[k] = p[i + 1] * v - p[i + 2] * relaxing
    return p[i] * x + relaxing


@njit
def zener_state(k1, decay, cubic, z, t):
    """Return z at t along zdot = k1 v - decay z with v of a cubic path, from z at 0.

    z exp(-x) + k1 (v0 phi1 t + v1 phi2 t^2 + v2 phi3 t^3), x = decay t, v = v0 + v1 t + v2 t^2 / 2, with the functions
    phi1 = (1 - exp(-x)) / x, phi2 = (1 - phi1) / x, phi3 = (1/2 - phi2) / x of exponential integrators.
    """
    x = decay * t
    if x > 0.5:
        phi1 = -math.expm1(-x) / x
        phi2 = (1.0 - phi1) / x
        phi3 = (0.5 - phi2) / x
    else:  # the quotients cancel: phi3 by its series sum (-x)^k / (k + 3)!, the others from it
        phi3, term = 0.0, 1.0 / 6.0
        for k in range(14):
            phi3 += term
            term *= -x / (k + 4.0)
        phi2 = 0.5 - x * phi3
        phi1 = 1.0 - x * phi2
    v0, v1, v2 = cubic[1], 2.0 * cubic[2], 6.0 * cubic[3]
    return z * math.exp(-x) + k1 * t * (v0 * phi1 + t * (v1 * phi2 + t * v2 * phi3))


TINKER_CUTCHINS = 5


@dataclass(frozen=True, kw_only=True)
class TinkerCutchins(Law):
    """Tinker and Cutchins' law: nonlinear stiffness, n-th power damping and Coulomb friction that varies with deflection.

        F = k1 x + k2 x^2 + k3 x^3 + c |xdot|^n sgn(xdot) + (f0 + f1 |x| + f2 x^2) tanh(xdot / smoothing)

    k1 [N/m], k2 [N/m^2], k3 [N/m^3], c [N (s/m)^n], f0 [N], f1 [N/m], f2 [N/m^2], smoothing [m/s]. Over a cycle A sin(w t) the
    n-th power term takes gamma_n c w^n A^(n+1) with gamma_n = 2 sqrt(pi) Gamma((n+2)/2) / Gamma((n+3)/2), friction
    4 f0 A + 2 f1 A^2 + (4/3) f2 A^3 for a small smoothing. The springs are stable if 2 k2^2 <= 9 k1 k3.

    Source: Tinker and Cutchins (1992), thesis 2.5.2; how the friction varies is our choice.

    Coulomb friction is undefined at rest, so it is smoothed: at the rate xdot the force is tanh(xdot / smoothing) times it. The
    price is creep: a load F below the friction f0 is not held but sinks with smoothing * atanh(F / f0), and a static
    equilibrium rests on the springs alone. Choose `smoothing` near a hundredth of the rates that matter. The same velocity
    rounds |xdot|^n at rest if n < 1.
    """

    name: ClassVar[str] = "tinker-cutchins"
    kernel: ClassVar[int] = TINKER_CUTCHINS
    example: ClassVar[Entries] = {
        "k1": 8e4, "k2": 2e5, "k3": 2e7, "c": 200.0, "n": 1.5, "f0": 40.0, "f1": 2e3, "f2": 1e5, "smoothing": 0.02,
    }  # fmt: skip
    rate_independent: ClassVar[bool] = False
    faint_parameters: ClassVar[Mapping[str, float]] = dict.fromkeys(("k1", "k2", "k3", "c", "f0", "f1", "f2"), FAINT)
    damping_parameters: ClassVar[tuple[str, ...]] = ("c", "f0", "f1", "f2")
    elastic: ClassVar[tuple[str, ...]] = ("k1", "k2", "k3")
    tangents: ClassVar[tuple[str, ...]] = ("k1",)

    k1: Spring
    k2: Quadratic = 0.0
    k3: Annotated[float, bounds("N/m^3", ge=0.0)] = 0.0
    c: Annotated[float, bounds("N (s/m)^n", ge=0.0)] = 0.0
    n: Positive = 1.0
    f0: Annotated[float, bounds("N", ge=0.0)] = 0.0
    f1: Annotated[float, bounds("N/m", ge=0.0)] = 0.0
    f2: Annotated[float, bounds("N/m^2", ge=0.0)] = 0.0
    smoothing: Annotated[float, bounds("m/s", gt=0.0)]

    @property
    def damping_coefficient(self) -> float:  # type: ignore[override]
        """Slope of damping and friction at rest, at x = 0 [N s/m]."""
        damping = self.c if self.n == 1.0 else self.c * self.smoothing ** (self.n - 1.0) if self.n < 1.0 else 0.0
        return damping + self.f0 / self.smoothing

    def with_friction(self, factor: float) -> Self:
        friction = {name: positive("factor", factor) * getattr(self, name) for name in ("f0", "f1", "f2")}
        return replace(self, **friction)


@dataclass(frozen=True, kw_only=True)
class EquivalentViscous(Law):
    """Ko's decomposition of a loop: its mid-line, and a viscous ellipse of the same area, at one amplitude and frequency.

        F = k1 x + k2 x^2 + k3 x^3 + c_eq xdot,   c_eq = W / (pi w A^2)

    k1 [N/m], k2 [N/m^2], k3 [N/m^3]: mid-line at the `amplitude` A [m]; W: `energy` of a cycle there [J]; w = 2 pi `frequency`.
    Away from that amplitude and frequency the law does not hold: its ellipse grows with both, where a rope's loop does not know
    the frequency. Source: Ko et al. (1992), thesis 2.5.2.
    """

    name: ClassVar[str] = "equivalent-viscous"
    kernel: ClassVar[int] = TINKER_CUTCHINS
    example: ClassVar[Entries] = {"k1": 8e4, "k2": 2e5, "k3": 2e7, "energy": 2.0, "amplitude": 0.01, "frequency": 12.0}
    rate_independent: ClassVar[bool] = False
    faint_parameters: ClassVar[Mapping[str, float]] = dict.fromkeys(("k1", "k2", "k3", "energy"), FAINT)
    damping_parameters: ClassVar[tuple[str, ...]] = ("energy",)
    tangents: ClassVar[tuple[str, ...]] = ("k1",)

    k1: Stiffness
    k2: Quadratic = 0.0
    k3: Cubic = 0.0
    energy: Annotated[float, bounds("J", ge=0.0)]
    amplitude: Annotated[float, bounds("m", gt=0.0)]
    frequency: Annotated[float, bounds("Hz", gt=0.0)]

    def _validate(self) -> None:
        with np.errstate(all="ignore"):
            damping = np.divide(self.energy, self.frequency * np.square(self.amplitude))
        if not np.all(np.isfinite(damping)):
            raise ValueError(f"`amplitude` must not be so small that the damping is infinite, got {self.amplitude}.")

    def kernel_parameters(self) -> Array:
        """Return the parameters of Tinker and Cutchins' kernel: the mid-line and linear damping, no friction."""
        return np.array([self.k1, self.k2, self.k3, self.damping_coefficient, 1.0, 0.0, 0.0, 0.0, 1.0])

    @property
    def damping_coefficient(self) -> float:  # type: ignore[override]
        """Equivalent viscous coefficient c_eq [N s/m]."""
        return self.energy / (math.pi * 2.0 * math.pi * self.frequency * self.amplitude**2)


@njit
def tinker_cutchins(p, i, x, v, z, j, zdot, k):
    """Return k1 x + k2 x^2 + k3 x^3 + c |v|^n sgn(v) + Fc(x) tanh(v/s) [N]; p = k1, k2, k3, c, n, f0, f1, f2, s."""
    n, s = p[i + 4], p[i + 8]
    size = 1.0
    if some(n != 1.0):
        above = n > 1.0
        # |v|^n has an infinite slope at rest if n < 1: smoothed over the same velocity as the friction
        size = raised(where(above, abs(v), v * v + s * s), where(above, 1.0, 0.5) * (n - 1.0))
    damping = p[i + 3] * size * v
    friction = (p[i + 5] + p[i + 6] * abs(x) + p[i + 7] * x * x) * math.tanh(v / s)
    return x * (p[i] + x * (p[i + 1] + x * p[i + 2])) + damping + friction
