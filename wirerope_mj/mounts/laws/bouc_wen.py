"""Bouc-Wen law of the thesis and Ozdemir's reduction of it."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.hysteresis import Hysteresis, Normalised, bouc_wen_rate

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
    not_negative: ClassVar[tuple[str, ...]] = ("k",)
    elastic: ClassVar[tuple[str, ...]] = ("k",)
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k")

    alpha: float
    beta: float
    gamma: float
    n: float
    k: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Ozdemir(Hysteresis):
    """Ozdemir's law: Bouc-Wen with gamma = 0, zdot = alpha xdot - beta |xdot| |z|^(n-1) z, and F = k x + z.

    Softening only. A parameterisation of the Bouc-Wen kernel. Source: thesis 3.2.1.
    """

    name: ClassVar[str] = "ozdemir"
    kernel: ClassVar[int] = BOUC_WEN
    example: ClassVar[Entries] = {"alpha": 1e5, "beta": 300.0, "n": 1.0, "k": 2e4}
    smoothable: ClassVar[bool] = True
    not_negative: ClassVar[tuple[str, ...]] = ("k",)
    elastic: ClassVar[tuple[str, ...]] = ("k",)
    tangents: ClassVar[tuple[str, ...]] = ("alpha", "k")

    alpha: float
    beta: float
    n: float
    k: float = 0.0

    @classmethod
    def from_normalised(cls, *, z_max: float, x_y: float, sigma: float = 1.0, n: float, **others: float) -> Self:
        """Return the law from the normalised form, whose sigma can only be 1."""
        if sigma != 1.0:
            raise ValueError(f"`sigma` must be 1, got {sigma}: Ozdemir's law has no gamma.")
        form = Normalised(z_max=z_max, x_y=x_y, sigma=sigma, n=n)
        return cls(alpha=form.z_max / form.x_y, beta=form.z_max ** (1.0 - n) / form.x_y, n=n, **others)

    def kernel_parameters(self) -> Array:
        """Return alpha, beta, 0, n, k."""
        return np.array([self.alpha, self.beta, 0.0, self.n, self.k])

    @property
    def coordinates(self) -> dict[str, float]:
        """The normalised form without sigma, which is 1, and the elastic part."""
        return {name: value for name, value in super().coordinates.items() if name != "sigma"}


@njit
def bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F = k x + z [N], thesis (3.4) with g = k x; p = alpha, beta, gamma, n, k."""
    hysteretic = z[j]
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, hysteretic)
    return p[i + 4] * x + hysteretic
