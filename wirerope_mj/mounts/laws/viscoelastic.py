"""Linear viscoelastic laws, as of rubber and leaf-spring mounts."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.law import FAINT, Law, anywhere

KELVIN_VOIGT = 3
ZENER = 4


@dataclass(frozen=True, kw_only=True)
class KelvinVoigt(Law):
    """Kelvin-Voigt law F = k x + c xdot, k [N/m], c [N s/m]; complex stiffness k + i omega c, loss factor omega c / k."""

    name: ClassVar[str] = "kelvin-voigt"
    kernel: ClassVar[int] = KELVIN_VOIGT
    example: ClassVar[Entries] = {"k": 1e5, "c": 300.0}
    rate_independent: ClassVar[bool] = False
    force_powers: ClassVar[Mapping[str, float]] = {"k": 1.0, "c": 1.0}
    faint_parameters: ClassVar[Mapping[str, float]] = {"k": 0.0, "c": FAINT}
    units: ClassVar[Mapping[str, str]] = {"k": "N/m", "c": "N s/m"}
    damping_parameters: ClassVar[tuple[str, ...]] = ("c",)
    not_negative: ClassVar[tuple[str, ...]] = ("k", "c")
    tangents: ClassVar[tuple[str, ...]] = ("k",)

    k: float
    c: float

    def _validate(self) -> None:
        super()._validate()
        if anywhere((self.k == 0.0) & (self.c == 0.0)):
            raise ValueError("`k` and `c` must not both be 0: leave the axis out of the isolator instead.")

    @property
    def damping_coefficient(self) -> float:  # type: ignore[override]
        """Damping c [N s/m]."""
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
    force_powers: ClassVar[Mapping[str, float]] = {"k0": 1.0, "k1": 1.0, "c": 1.0}
    faint_parameters: ClassVar[Mapping[str, float]] = {"k0": 0.0, "k1": FAINT, "c": FAINT}
    units: ClassVar[Mapping[str, str]] = {"k0": "N/m", "k1": "N/m", "c": "N s/m"}
    state_names: ClassVar[tuple[str, ...]] = ("z",)  # the force of the branch with the damper
    damping_parameters: ClassVar[tuple[str, ...]] = ("k1", "c")  # that branch, whose force decays as fast as before
    not_negative: ClassVar[tuple[str, ...]] = ("k0",)
    above_zero: ClassVar[tuple[str, ...]] = ("k1", "c")
    elastic: ClassVar[tuple[str, ...]] = ("k0",)
    tangents: ClassVar[tuple[str, ...]] = ("k0", "k1")  # against a sudden deflection

    k0: float
    k1: float
    c: float

    def kernel_parameters(self) -> Array:
        """Return k0, k1, k1 / c."""
        return np.array([self.k0, self.k1, self.relaxation_rate])

    @property
    def relaxation_rate(self) -> float:  # type: ignore[override]
        """Rate k1 / c at which the damper lets its branch's force decay [1/s]."""
        return self.k1 / self.c


# What is left of a law that has failed and cannot be made faint itself, by its number of states.
FAINT_LAWS = (
    KelvinVoigt(**KelvinVoigt.faint_parameters),
    Zener(**Zener.faint_parameters),
)


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
