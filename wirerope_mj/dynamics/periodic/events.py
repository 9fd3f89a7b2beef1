"""Finding where a branch turns back or changes its stability, between two of its points."""

from collections.abc import Callable

import numpy as np

from wirerope_mj.dynamics.periodic.branch import Kind
from wirerope_mj.dynamics.periodic.continuation import Continuation, Point
from wirerope_mj.dynamics.periodic.multipliers import MARGIN

CLOSE = 1e-6
"""Relative distance in the parameter to which a change of stability is located."""

LOCATIONS = 12
"""Points that locating one may take."""

TIGHTER = 1e-2
"""Fraction of the branch's tolerance to which the corrector works at a fold: where a branch is steep, a residual of 1e-6 moves the
parameter by 1e-5."""


def unstable(point: Point) -> int:
    """Return the number of multipliers outside the unit circle."""
    return int((np.abs(point.stability.multipliers) > 1.0 + MARGIN).sum())


def turns(a: Point, b: Point) -> bool:
    """Return whether the branch turns back between two points."""
    return float(a.tangent[-1] * b.tangent[-1]) < 0.0


def locate(path: Continuation, a: Point, b: Point, length: float) -> tuple[Kind, complex, Point, float] | None:
    """Return the event between `a` and `b`, an arclength apart: kind, multiplier, its point and arclength from `a`."""
    if turns(a, b):
        # Where the tangent turns, not where the parameter of the points is largest: the tangent is that of the continuous motion,
        # and at the tip of a needle the reversals that pass a step shake the parameter by twice the steps' own error.
        point, arclength = _between(path, a, b, length, lambda p: float(p.tangent[-1]), path.tolerance * TIGHTER)
        return "fold", _nearest_to_one(point), point, arclength
    low, high = sorted((unstable(a), unstable(b)))
    if low == high:
        return None
    point, arclength = _between(path, a, b, length, lambda p: _modulus(p, low) - 1.0)
    more = a if unstable(a) > unstable(b) else b
    critical = complex(more.stability.multipliers[low])
    return _kind(critical), critical, point, arclength


def _kind(multiplier: complex) -> Kind:
    if abs(multiplier.imag) > 1e-6 * abs(multiplier):
        return "Neimark-Sacker"
    return "period doubling" if multiplier.real < 0.0 else "symmetry breaking"


def _modulus(point: Point, index: int) -> float:
    multipliers = point.stability.multipliers
    return float(np.abs(multipliers[index])) if index < multipliers.size else 0.0


def _nearest_to_one(point: Point) -> complex:
    multipliers = point.stability.multipliers
    return complex(multipliers[np.argmin(np.abs(multipliers - 1.0))]) if multipliers.size else 1.0 + 0.0j


def _between(
    path: Continuation,
    a: Point,
    b: Point,
    length: float,
    test: Callable[[Point], float],
    tolerance: float | None = None,
) -> tuple[Point, float]:
    """Return the point where `test` vanishes and its arclength from `a`, by the Illinois method."""
    left, right, f_left, f_right = 0.0, length, test(a), test(b)
    best, arclength, least = (a, 0.0, abs(f_left)) if abs(f_left) < abs(f_right) else (b, length, abs(f_right))
    for _ in range(LOCATIONS):
        middle = (left * f_right - right * f_left) / (f_right - f_left)
        point = path.step(a, middle, tolerance) or path.step(a, middle)
        if point is None:
            break
        value = test(point)
        if abs(value) < least:
            best, arclength, least = point, middle, abs(value)
        # the remaining interval, relative to the parameter
        if path.unit * abs(point.tangent[-1]) * abs(right - left) < CLOSE:
            break
        if value * f_right < 0.0:
            left, f_left = right, f_right
        else:
            f_left *= 0.5
        right, f_right = middle, value
    return best, arclength
