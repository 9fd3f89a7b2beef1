"""Semi-empirical laws without internal states: Tinker and Cutchins' law and Ko's equivalent viscous law."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import raised, some, where
from wirerope_mj.mounts.laws.law import FAINT, Law

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
    force_powers: ClassVar[Mapping[str, float]] = dict.fromkeys(("k1", "k2", "k3", "c", "f0", "f1", "f2"), 1.0)
    faint_parameters: ClassVar[Mapping[str, float]] = dict.fromkeys(force_powers, FAINT)
    units: ClassVar[Mapping[str, str]] = {
        "k1": "N/m", "k2": "N/m^2", "k3": "N/m^3", "c": "N (s/m)^n", "f0": "N", "f1": "N/m", "f2": "N/m^2", "smoothing": "m/s",
    }  # fmt: skip
    damping_parameters: ClassVar[tuple[str, ...]] = ("c", "f0", "f1", "f2")
    not_negative: ClassVar[tuple[str, ...]] = ("k1", "k3", "c", "f0", "f1", "f2")
    above_zero: ClassVar[tuple[str, ...]] = ("n", "smoothing")
    elastic: ClassVar[tuple[str, ...]] = ("k1", "k2", "k3")
    tangents: ClassVar[tuple[str, ...]] = ("k1",)

    k1: float
    k2: float = 0.0
    k3: float = 0.0
    c: float = 0.0
    n: float = 1.0
    f0: float = 0.0
    f1: float = 0.0
    f2: float = 0.0
    smoothing: float

    @property
    def damping_coefficient(self) -> float:  # type: ignore[override]
        """Slope of damping and friction at rest, at x = 0 [N s/m]."""
        damping = self.c if self.n == 1.0 else self.c * self.smoothing ** (self.n - 1.0) if self.n < 1.0 else 0.0
        return damping + self.f0 / self.smoothing


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
    force_powers: ClassVar[Mapping[str, float]] = dict.fromkeys(("k1", "k2", "k3", "energy"), 1.0)
    faint_parameters: ClassVar[Mapping[str, float]] = dict.fromkeys(force_powers, FAINT)
    units: ClassVar[Mapping[str, str]] = {
        "k1": "N/m", "k2": "N/m^2", "k3": "N/m^3", "energy": "J", "amplitude": "m", "frequency": "Hz",
    }  # fmt: skip
    damping_parameters: ClassVar[tuple[str, ...]] = ("energy",)
    not_negative: ClassVar[tuple[str, ...]] = ("energy",)
    above_zero: ClassVar[tuple[str, ...]] = ("amplitude", "frequency")
    tangents: ClassVar[tuple[str, ...]] = ("k1",)

    k1: float
    k2: float = 0.0
    k3: float = 0.0
    energy: float
    amplitude: float
    frequency: float

    def _validate(self) -> None:
        super()._validate()
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
