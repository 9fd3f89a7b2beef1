"""Bouc-Wen law that softens with the largest deflection so far, as filled rubber does in its first cycles."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import where
from wirerope_mj.mounts.laws.hysteresis import Hysteresis, bouc_wen_rate
from wirerope_mj.mounts.laws.law import anywhere
from wirerope_mj.mounts.laws.ni import polynomial

SCRAGGED_BOUC_WEN = 15
# Path, in units of `reach`, on which m closes all but 1/e of its distance to |x|: far below what the softening resolves, and
# long enough for steps that resolve the motion. Without it the rate of m would jump, and a step would miss part of a peak.
CATCHES_UP = 0.1


@dataclass(frozen=True, kw_only=True)
class ScraggedBoucWen(Hysteresis):
    """Bouc-Wen with Ni's polynomial F1, both softer the farther the device has been (scragging, Mullins' effect).

        F  = D(m) z + {1 - [1 - D(m)] [1 - min(1, x^2 / m^2)]} F1(x),   D(m) = 1 - softening [1 - exp(-m / reach)]
        dm = max(0, |x| - m) |dx| / (reach / 10)

    z and its parameters as in `Hysteresis`, F1 = k1 x + k2 sgn(x) x^2 + k3 x^3 [N]; m [m] follows the largest |x| so far.
    Beyond m the elastic force is that of the virgin device, and within it is lost what x^2 / m^2, the energy of the deflection
    over the largest, leaves of the softening [-], 0 to less than 1, which comes over `reach` [m]. It is lost for the rest of
    the path, and a new run begins virgin.

    Passive: no part of F at a given x grows with m, m never falls, and F1 x >= 0, so that with S(z) of `Hysteresis`
    D(m) S(z) + int_0^x {..} F1 dx is an energy that m only takes from.

    Source: the form of F is ours, after L. Mullins, Softening of rubber by deformation, Rubber Chem. Technol. 42 (1969) 339,
    and the damage variable of R. W. Ogden and D. G. Roxburgh, A pseudo-elastic model for the Mullins effect in filled rubber,
    Proc. R. Soc. A 455 (1999) 2861, which depends on the energy over the largest.
    """

    name: ClassVar[str] = "scragged-bouc-wen"
    kernel: ClassVar[int] = SCRAGGED_BOUC_WEN
    example: ClassVar[Entries] = {
        "alpha": 1e5, "beta": 250.0, "gamma": 100.0, "n": 1.0, "softening": 0.4, "reach": 4e-3, "k1": 8e4, "k2": -1e6,
        "k3": 2e7,
    }  # fmt: skip
    # z before its softening [N], the deflection that is remembered [m]
    state_names: ClassVar[tuple[str, ...]] = ("z", "m")
    not_negative: ClassVar[tuple[str, ...]] = ("softening", "k1", "k3")
    above_zero: ClassVar[tuple[str, ...]] = ("reach",)
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k1")

    alpha: float
    beta: float
    gamma: float
    n: float
    softening: float
    reach: float
    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0

    def _validate(self) -> None:
        super()._validate()
        if anywhere(self.softening >= 1.0):
            raise ValueError(f"`softening` must be < 1, got {self.softening}: nothing of the force would be left.")
        if anywhere(self.k2 < -2.0 * np.sqrt(self.k1 * self.k3)):
            raise ValueError(
                f"`k2` must be >= -2 sqrt(k1 k3) = {-2.0 * np.sqrt(self.k1 * self.k3)}, got {self.k2}: a force against the "
                "spring's own deflection would not be passive."
            )

    def kernel_parameters(self) -> Array:
        """Return alpha, beta, gamma, n, k1, k2, k3, softening, reach."""
        spring, lost = [self.k1, self.k2, self.k3], [self.softening, self.reach]
        return np.array([self.alpha, self.beta, self.gamma, self.n, *spring, *lost])


@njit
def scragged_bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F [N]; states z [N] and m [m]; p = alpha, beta, gamma, n, k1, k2, k3, softening, reach."""
    hysteretic, memory, size = z[j], max(z[j + 1], 0.0), abs(x)
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, hysteretic)
    zdot[k + 1] = max(size - memory, 0.0) * abs(v) / (CATCHES_UP * p[i + 8])
    lost = -p[i + 7] * math.expm1(-memory / p[i + 8])
    within = where(size < memory, 1.0 - size * size / max(memory * memory, 1e-300), 0.0)
    return (1.0 - lost) * hysteretic + (1.0 - lost * within) * polynomial(p[i + 4], p[i + 5], p[i + 6], x)
