"""A law from points of force-deflection curves."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from typing import Annotated, ClassVar, Literal

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.structure import In, bounds
from wirerope_mj.foundation.summary import AsCall
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS
from wirerope_mj.mounts.laws.law import ROUNDING, Law
from wirerope_mj.mounts.laws.table_kernels import clip_to_curve, cycle_area, level_cubics, monotone, packed

TABULATED = 12
IN_LENGTH, IN_FORCE = In(LENGTH_UNITS, bare=True), In(FORCE_UNITS, bare=True)  # what its keys in a file may end with
_FARTHEST_YIELD = 100.0  # times the travel, at which a loop has no width any more that a number could say


@dataclass(frozen=True, kw_only=True, repr=False)
class Tabulated(AsCall, Law):
    """A law from points of curves: one piecewise cubic, plus a second one times an exponential hysteretic force.

        F = M(x) + g(x) z,    zdot = (z_max xdot - |xdot| z) / x_y

    z [N] is Bouc-Wen's with n = 1 and gamma = 0, bounded by z_max, and 0 <= g <= 1 with g = 1 where the loop is widest: in
    saturation the force is M + g z_max, the upper limit curve, or M - g z_max, the lower one. The curves are given by points at
    the `deflection` [m], (n,), strictly increasing and around 0, in one of three ways:

    - `upper` and `lower` [N], (n,): the limit curves.
    - `force` [N], (n,) with `amplitudes` [m] and `areas` [J], (m,): a curve, and the areas of closed cycles about zero. The
      half width h = g z_max is a function of |x| with knots at the amplitudes. Where it is constant, a cycle of amplitude A has
      the area 4 h [A - x_y tanh(A / x_y)]. The curve is the `curve` "virgin", first loading from rest in both directions, which
      has the point (0, 0), or "mid", M.
    - `force` alone: M without hysteresis.

    Between the points M, and g of limit curves, is Fritsch and Carlson's monotone cubic (SciPy's PCHIP); g of areas joins its
    knots by cubics that are level there, so that areas are linear in it. M is shifted so that F = 0 at x = 0, z = 0. With
    g = 1 it is Vaiana and Rosati's law with the same curves both ways.

    It is passive for every g >= 0 from z = 0. The work of g z is linear in g, so take g concentrated at one deflection: the
    path crosses it upwards and downwards in turn, and w = z / z_max is the convolution of dx / x_y with exp(-s / x_y) over the
    path's length s. Between two crossings an excursion above takes w to E w - p, one below to E w + p, with 0 < E <= 1 and p >=
    0; w at the first crossing has its sign. So the sum of w at upward less that at downward crossings is never negative. z = 0
    is where small vibrations lead at every deflection.
    """

    name: ClassVar[str] = "tabulated"
    kernel: ClassVar[int] = TABULATED
    example: ClassVar[Entries] = {
        "deflection": [-0.06, -0.02, -5e-3, 0.0, 5e-3, 0.02, 0.06],
        "upper": [-1.5e3, -1.1e3, -150.0, 150.0, 600.0, 2.5e3, 9e3],
        "lower": [-2.0e3, -1.6e3, -450.0, -150.0, 200.0, 1.7e3, 8e3], "yield_deflection": 2e-3,
    }  # fmt: skip
    smoothable: ClassVar[bool] = True
    state_names: ClassVar[tuple[str, ...]] = ("z",)  # the hysteretic force where the loop is widest
    travel_rule: ClassVar[str] = "its table ends (`extrapolate = true` goes on with its end slope)"
    needs_rating: ClassVar[bool] = False

    deflection: Annotated[Sequence[float], IN_LENGTH, bounds("m")]
    upper: Annotated[Sequence[float], IN_FORCE, bounds("N")] = ()
    lower: Annotated[Sequence[float], IN_FORCE, bounds("N")] = ()
    force: Annotated[Sequence[float], IN_FORCE, bounds("N")] = ()
    curve: Literal["virgin", "mid"] = "virgin"
    amplitudes: Annotated[Sequence[float], IN_LENGTH, bounds("m")] = ()
    areas: Annotated[Sequence[float], In({"J": 1.0}, bare=True), bounds("J")] = ()
    #: x_y, the length over which unloading leaves one limit curve for the other by 1 - 1/e [m]; > 0 if there is hysteresis
    yield_deflection: Annotated[float, IN_LENGTH, bounds("m")] = 0.0
    symmetric: bool = False  #: the points begin at 0 and are mirrored about it
    #: beyond its ends the table goes on with their slope and g; else the law does not hold there
    extrapolate: bool = False

    def _validate(self) -> None:
        x = np.array(self.deflection)
        if x.size < 2:
            raise ValueError(f"`deflection` must have at least 2 points, got {x.size}.")
        _require_increasing("deflection", x)
        if self.symmetric and x[0] != 0.0:
            raise ValueError(f"`deflection` must begin at 0 where `symmetric` mirrors it, got {x[0]:.6g} m.")
        beyond = self.symmetric or self.extrapolate
        if not (x[0] <= 0.0 <= x[-1] if beyond else x[0] < 0.0 < x[-1]):
            raise ValueError(
                f"`deflection` must reach from below zero to above, got {x[0]:.6g} to {x[-1]:.6g} m; from zero on only if "
                "`symmetric` mirrors the points or `extrapolate` goes on with the slope at zero."
            )
        if bool(self.force) == bool(self.upper or self.lower):
            raise ValueError("give either `upper` and `lower`, the limit curves, or `force`, one curve.")
        for name in ("force",) if self.force else ("upper", "lower"):
            if (count := len(getattr(self, name))) != x.size:
                raise ValueError(f"`{name}` must have one entry for each `deflection`, {x.size}, got {count}.")
        self._validate_width()
        if self.initial_stiffness < 0.0:
            raise ValueError(f"the force must not fall at zero deflection, got a slope of {self.initial_stiffness:.6g} N/m.")

    def _validate_width(self) -> None:
        """Raise ValueError unless the width of the loop is stated completely and consistently."""
        if len(self.amplitudes) != len(self.areas):
            raise ValueError(
                f"`areas` must have one entry for each of `amplitudes`, {len(self.amplitudes)}, got {len(self.areas)}."
            )
        if self.upper and self.areas:
            raise ValueError("`areas` go with `force`: limit curves have their areas themselves.")
        for name in ("amplitudes", "areas"):
            if any(value <= 0.0 for value in getattr(self, name)):
                raise ValueError(f"every entry of `{name}` must be > 0, got {min(getattr(self, name)):.6g}.")
        _require_increasing("amplitudes", np.array(self.amplitudes))
        if self.amplitudes and self.amplitudes[-1] > self.finite_travel + ROUNDING:
            raise ValueError(
                f"`amplitudes` must end within the table, at {self.finite_travel:.6g} m, got {self.amplitudes[-1]:.6g} m: "
                "areas are those of cycles about zero. `extrapolate = true` goes on beyond it."
            )
        half = np.array(self.upper) - np.array(self.lower)
        if (half < 0.0).any():
            at = int(np.argmin(half))
            raise ValueError(
                f"`upper` must not lie below `lower`: at {self.deflection[at]:.6g} m it lies {-half[at]:.6g} N below."
            )
        if self.yield_deflection < 0.0 or (self.yield_deflection == 0.0 and (self.areas or half.any())):
            raise ValueError(f"`yield_deflection` must be > 0 for a law with hysteresis, got {self.yield_deflection}.")
        if self.yield_deflection > _FARTHEST_YIELD * self.finite_travel:
            raise ValueError(
                f"`yield_deflection` is beyond the table: got {self.yield_deflection:.6g} m, and the table ends at "
                f"{self.finite_travel:.6g} m; is it in mm?"
            )
        if self.force and self.curve == "virgin" and (0.0, 0.0) not in zip(self.deflection, self.force, strict=True):
            raise ValueError('the points of a "virgin" curve must contain `deflection` 0 with `force` 0: it begins at rest.')

    @cached_property
    def _curves(self) -> "tuple[scipy.interpolate.PPoly, scipy.interpolate.PPoly, float]":
        """Mean force M [N] and factor g on friction [-] over the deflection, and the bound z_max of friction [N]."""
        x = self._mirrored(np.array(self.deflection), odd=True)
        if self.upper:
            upper, lower = np.array(self.upper), np.array(self.lower)
            mean = self._mirrored(0.5 * (upper + lower), odd=True)
            half = self._mirrored(0.5 * (upper - lower), odd=False)
            z_max = float(half.max())
            fraction = monotone(x, half / z_max if z_max > 0.0 else half)
        else:
            widths: list[float] = []
            for number, (amplitude, area) in enumerate(zip(self.amplitudes, self.areas, strict=True)):
                # What the next amplitude's knot changes lies beyond this cycle: the areas are met one after the other.
                parts = np.eye(number + 1)
                areas = [cycle_area(self.amplitudes[: number + 1], part, amplitude, self.yield_deflection) for part in parts]
                width = (area - float(np.dot(areas[:-1], widths))) / areas[-1]
                if width < 0.0:
                    raise ValueError(
                        f"`areas`: the smaller cycles make {area - width * areas[-1]:.6g} J of a cycle of {amplitude:.6g} m "
                        f"already, more than its {area:.6g} J."
                    )
                widths.append(width)
            z_max = max(widths, default=0.0)
            fraction = level_cubics(self.amplitudes, widths, z_max)
            mean = self._mirrored(np.array(self.force), odd=True)
            if self.curve == "virgin" and z_max > 0.0:
                built_up = np.expm1(-np.abs(x) / self.yield_deflection)
                mean = mean + z_max * fraction(clip_to_curve(x, fraction)) * np.sign(x) * built_up
        curve = monotone(x, mean)
        if not self.symmetric:
            curve.c[-1] -= curve(0.0)
        return curve, fraction, z_max

    def _mirrored(self, values: Array, *, odd: bool) -> Array:
        """Return the values at the points and, if the law is symmetric, at the mirrored points."""
        if not self.symmetric:
            return values
        values = values - values[0] if odd else values
        return np.concatenate([-values[:0:-1] if odd else values[:0:-1], values])

    def kernel_parameters(self) -> Array:
        return self._parameters.copy()

    @cached_property
    def _parameters(self) -> Array:
        return packed(*self._curves, self.yield_deflection or 1.0)  # without hysteresis any length will do

    @property
    def bouc_wen_parameters(self) -> Array:  # type: ignore[override]
        """alpha, beta, gamma and n of the friction as a Bouc-Wen law: z_max / x_y, 1 / x_y, 0, 1."""
        return self._parameters[:4]

    def certainly_valid(self, columns: Mapping[str, object]) -> bool:
        return False

    def to_dict(self) -> Entries:
        values = asdict(self)
        stated = {item.name: values[item.name] for item in fields(self) if values[item.name] != item.default}
        return {"law": self.name, **{key: list(v) if isinstance(v, tuple) else v for key, v in stated.items()}}

    @property
    def z_max(self) -> float:
        """Largest half distance of the limit curves [N], the bound of z; 0 without hysteresis."""
        return self._curves[2]

    @property
    def initial_stiffness(self) -> float:
        """Tangent at the unloaded state, M'(0) + g(0) z_max / x_y [N/m]."""
        curve, fraction, z_max = self._curves
        share = float(fraction(clip_to_curve(np.zeros(1), fraction))[0])
        return float(curve(0.0, 1)) + (share * z_max / self.yield_deflection if z_max > 0.0 else 0.0)

    @property
    def travel_ends(self) -> tuple[float, float]:
        """Deflections below and above zero up to which the table reaches [m]; infinite if it is extrapolated."""
        if self.extrapolate:
            return math.inf, math.inf
        above = self.deflection[-1]
        return (above if self.symmetric else -self.deflection[0]), above

    @property
    def finite_travel(self) -> float:  # type: ignore[override]
        return min(self.travel_ends)

    def check_path(self, path: Array) -> None:
        super().check_path(path)
        below, above = self.travel_ends
        outside = (path < -below - ROUNDING) | (path > above + ROUNDING)
        if outside.any():
            raise ValueError(
                f"a deflection of {path[np.argmax(outside)]:.6g} m is outside the table of the law, which reaches from "
                f"{-below:.6g} to {above:.6g} m. `extrapolate = true` goes on with its end slope."
            )


def _require_increasing(name: str, values: Array) -> None:
    if (np.diff(values) <= 0.0).any():
        at = int(np.argmax(np.diff(values) <= 0.0))
        raise ValueError(f"`{name}` must increase strictly, got {values[at]:.6g} before {values[at + 1]:.6g}.")
