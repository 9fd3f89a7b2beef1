"""Vaiana and Rosati's rate-independent law."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import where
from wirerope_mj.foundation.structure import bounds
from wirerope_mj.mounts.laws.law import FAINT, Law, Stiffness, anywhere

VAIANA_ROSATI = 7
_NAMES = ("kb", "f0", "alpha", "b1", "b2", "g1", "g2", "g3")
Force = Annotated[float, bounds("N")]
Length = Annotated[float, bounds("m")]
PerLength = Annotated[float, bounds("1/m")]


@dataclass(frozen=True, kw_only=True)
class VaianaRosati(Law):
    """Vaiana and Rosati's law: while the deflection grows or falls, the force approaches an upper or a lower limit curve.

        xdot > 0:  F = U(x) - [U(x_P) - F_P] exp(-alpha (x - x_P)),          U = fe(x) + kb x + f0
        xdot < 0:  F = L(x) - [L(x_P) - F_P] exp(+alpha_minus (x - x_P)),    L = fe_minus(x) + kb_minus x - f0_minus
        fe(x) = b1 (exp(b2 x) - 1) + 4 g1 / (1 + exp(-g2 (x - g3))) - 2 g1

    with any earlier point (x_P, F_P) of the branch, so that a branch is exact in one step. kb [N/m], f0 [N], alpha [1/m],
    b1 [N], b2 [1/m], g1 [N], g2 [1/m], g3 [m]; `..._minus` are those of the lower curve; where they are not given they are
    the same, and vary with them. b1 and b2 harden one side, g1 to g3 bend both. Both curves are shifted by one force, so that
    their mean m is zero at x = 0 where the unloaded isolator stands; F = m(x) + z. With f0 = f0_minus and g3 = 0 that
    force is none.

    With the same parameters both ways it is kb x + fe(x) beside Bouc-Wen's z with n = 1, gamma = 0, beta = alpha and the slope
    alpha f0: passive if kb, b1 b2 and g1 g2 are not negative. Different parameters describe measured loops but not a passive
    law: the unloaded state need not be the one to which small vibrations lead, so that work can be drawn from it once. Where
    the two curves cross, the law ends (`finite_travel`).

    Source: N. Vaiana, public slides on the Vaiana-Rosati model, analytical and differential form (2023).
    """

    name: ClassVar[str] = "vaiana-rosati"
    kernel: ClassVar[int] = VAIANA_ROSATI
    example: ClassVar[Entries] = {
        "kb": 3e4, "f0": 150.0, "alpha": 300.0, "b1": 20.0, "b2": 60.0, "g1": 15.0, "g2": 300.0, "g3": 0.0,
        "f0_minus": 100.0, "alpha_minus": 450.0,
    }  # fmt: skip
    smoothable: ClassVar[bool] = True
    state_names: ClassVar[tuple[str, ...]] = ("z",)  # the force from the mean of the limit curves
    travel_rule: ClassVar[str] = "its limit curves cross"
    leaders: ClassVar[Mapping[str, str]] = {f"{name}_minus": name for name in _NAMES}
    faint_parameters: ClassVar[Mapping[str, float]] = {
        name + side: FAINT for name in ("kb", "f0", "b1", "g1") for side in ("", "_minus")
    }

    kb: Stiffness
    f0: Force
    alpha: PerLength
    b1: Force = 0.0
    b2: PerLength = 0.0
    g1: Force = 0.0
    g2: PerLength = 0.0
    g3: Length = 0.0
    kb_minus: Stiffness | None = None
    f0_minus: Force | None = None
    alpha_minus: PerLength | None = None
    b1_minus: Force | None = None
    b2_minus: PerLength | None = None
    g1_minus: Force | None = None
    g2_minus: PerLength | None = None
    g3_minus: Length | None = None

    def __post_init__(self) -> None:
        for name in _NAMES:
            if getattr(self, f"{name}_minus") is None:
                object.__setattr__(self, f"{name}_minus", getattr(self, name))
        super().__post_init__()

    def _validate(self) -> None:
        for name in ("f0", "alpha", "f0_minus", "alpha_minus"):
            if anywhere(getattr(self, name) <= 0.0):
                raise ValueError(f"`{name}` must be > 0, got {getattr(self, name)}: the law would not dissipate.")
        gap = np.min(self._gap(0.0))
        if gap <= 0.0:
            raise ValueError(f"the upper limit curve must lie above the lower one, but at zero it lies {-gap:.6g} N below.")

    def kernel_parameters(self) -> Array:
        """Return the parameters of the upper curve, of the lower curve, and the mean of both at zero."""
        upper, lower, _, _ = self._limits(0.0)
        return np.array([*self._parameters, 0.5 * (upper + lower)])

    @property
    def _parameters(self) -> list[Any]:
        return [getattr(self, name + side) for side in ("", "_minus") for name in _NAMES]

    def _limits(self, x: float) -> tuple[float, float, float, float]:
        """Return the upper and the lower limit curve at x [N] and their slopes [N/m]."""
        p = np.array(self._parameters)
        upper, upper_slope = limit_curve(p, 0, x)
        lower, lower_slope = limit_curve(p, 8, x)
        return upper + p[1], lower - p[9], upper_slope, lower_slope

    def _gap(self, x: Any) -> Any:
        """Return the distance of the limit curves at x [N]; x may be an array, and so may the parameters."""
        p = self._parameters
        with np.errstate(over="ignore", invalid="ignore"):
            upper, lower = (
                b1 * np.expm1(b2 * x) + 2.0 * g1 * np.tanh(0.5 * g2 * (x - g3)) + kb * x
                for kb, _, _, b1, b2, g1, g2, g3 in (p[:8], p[8:])
            )
            return upper + p[1] - (lower - p[9])

    @property
    def z_max(self) -> float:
        """Half the distance of the limit curves at zero [N], the bound of z if both have the same shape."""
        return 0.5 * float(self._gap(0.0))

    @property
    def initial_stiffness(self) -> float:
        """Larger of the tangents upwards and downwards at the unloaded state [N/m]."""
        _, _, upper_slope, lower_slope = self._limits(0.0)
        return max(upper_slope + self.alpha * self.z_max, lower_slope + self._parameters[10] * self.z_max)

    @property
    def finite_travel(self) -> float:  # type: ignore[override]
        """Smallest deflection to either side at which the limit curves cross [m]; infinite if they never do."""
        p = self._parameters
        if all(np.array_equal(p[i], p[i + 8]) for i in (0, 3, 4, 5, 6, 7)):
            return math.inf
        if any(isinstance(value, np.ndarray) for value in p):
            raise TypeError("where limit curves cross is sought for one law at a time.")
        growth = max(abs(p[4]), abs(p[12]))
        lengths = [1.0 / abs(p[i]) for i in (4, 6, 12, 14) if p[i]] + [abs(p[i]) for i in (7, 15) if p[i]]
        if p[0] != p[8]:
            lengths.append(self._gap(0.0) / abs(p[0] - p[8]))
        # From far below the shortest length over which a curve changes to far beyond the longest; exp() ends at 700.
        farthest = min(1e2 * max(lengths), 700.0 / growth if growth else math.inf)
        steps = np.geomspace(1e-3 * min(lengths), farthest, 2000)
        crossings = []
        for sign in (-1.0, 1.0):
            gaps = self._gap(sign * steps)
            if (gaps <= 0.0).any():
                first = int(np.argmax(gaps <= 0.0))
                inside = steps[first - 1] if first else 0.0
                crossing = scipy.optimize.brentq(lambda x, s=sign: self._gap(s * x), inside, steps[first], xtol=1e-15)
                crossings.append(float(crossing))
        return min(crossings, default=math.inf)

    @property
    def coordinates(self) -> dict[str, float]:
        return {name: getattr(self, name) for name in _NAMES}

    def check_path(self, path: Array) -> None:
        super().check_path(path)
        limit, reach = self.finite_travel, float(np.abs(path).max())
        if reach > limit:
            raise ValueError(
                f"the limit curves of {self.name} cross at a deflection of {limit:.6g} m, and the path leads to {reach:.6g} m."
            )


@njit
def limit_curve(p, i, x):
    """Return fe(x) + kb x [N] and its slope; p = kb, f0, alpha, b1, b2, g1, g2, g3."""
    growth = p[i + 3] * math.expm1(p[i + 4] * x)
    bend = math.tanh(0.5 * p[i + 6] * (x - p[i + 7]))
    force = growth + 2.0 * p[i + 5] * bend + p[i] * x
    return force, p[i + 4] * (growth + p[i + 3]) + p[i + 5] * p[i + 6] * (1.0 - bend * bend) + p[i]


@njit
def vaiana_rosati(p, i, x, v, z, j, zdot, k):
    """Return F = m(x) - m(0) + z [N], m the mean of the upper and the lower limit curve, half of 2 h apart.

    p = the eight parameters for v > 0, the eight for v < 0, m(0). dz/dx = h' + alpha (h - z) upwards, -h' + alpha (h + z)
    downwards.
    """
    upper, upper_slope = limit_curve(p, i, x)
    lower, lower_slope = limit_curve(p, i + 8, x)
    upper, lower = upper + p[i + 1], lower - p[i + 9]
    half, half_slope = 0.5 * (upper - lower), 0.5 * (upper_slope - lower_slope)
    up, hysteretic = v >= 0.0, z[j]
    s = where(up, 1.0, -1.0)
    zdot[k] = (s * half_slope + where(up, p[i + 2], p[i + 10]) * (half - s * hysteretic)) * v
    return 0.5 * (upper + lower) - p[i + 16] + hysteretic


@njit
def approach(p, i, x0, x1, z):
    """Return Vaiana and Rosati's state at deflection x1, reached from x0 with the state z; `p[i:]` as for `vaiana_rosati`."""
    side, s = (i, 1.0) if x1 >= x0 else (i + 8, -1.0)
    up0, _ = limit_curve(p, i, x0)
    low0, _ = limit_curve(p, i + 8, x0)
    up1, _ = limit_curve(p, i, x1)
    low1, _ = limit_curve(p, i + 8, x1)
    half0 = 0.5 * (up0 + p[i + 1] - low0 + p[i + 9])
    half1 = 0.5 * (up1 + p[i + 1] - low1 + p[i + 9])
    gap = s * half0 - z
    return s * half1 - gap * math.exp(-p[side + 2] * abs(x1 - x0))


@njit
def limit_work(p, i, x):
    """Return the integral of fe + kb x from 0, and of its bend from g3, to x [J]; `p[i:]` as in `limit_curve`."""
    work, y = 0.5 * p[i] * x * x, p[i + 4] * x
    if abs(y) > 0.1:
        work += p[i + 3] * x * (math.expm1(y) / y - 1.0)
    else:  # the difference cancels: its series sum y^k / (k + 1)!
        work += p[i + 3] * x * y * (1 / 2 + y * (1 / 6 + y * (1 / 24 + y * (1 / 120 + y * (1 / 720 + y * (1 / 5040))))))
    u = abs(0.5 * p[i + 6] * (x - p[i + 7]))
    if u > 0.1:
        return work + 4.0 * p[i + 5] / p[i + 6] * (u + math.log1p(math.exp(-2.0 * u)) - math.log(2.0))  # ln cosh u
    w = u * u  # the same by its series, over u^2 / 2
    ratio = 1.0 - w * (1 / 6 - w * (2 / 45 - w * (17 / 1260 - w * 62 / 14175)))
    return work + 0.5 * p[i + 5] * p[i + 6] * (x - p[i + 7]) ** 2 * ratio


@njit
def approach_work(p, i, x0, x1, z):
    """Return the work done on Vaiana and Rosati's law from deflection x0 with the state z to x1 [J]."""
    side, s = (i, 1.0) if x1 >= x0 else (i + 8, -1.0)
    up, _ = limit_curve(p, i, x0)
    low, _ = limit_curve(p, i + 8, x0)
    gap = s * 0.5 * (up + p[i + 1] - low + p[i + 9]) - z
    curve = limit_work(p, side, x1) - limit_work(p, side, x0) + (s * p[side + 1] - p[i + 16]) * (x1 - x0)
    return curve + s * gap * math.expm1(-p[side + 2] * abs(x1 - x0)) / p[side + 2]
