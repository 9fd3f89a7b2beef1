"""Finding where a branch turns back or changes its stability, between two of its points."""

from collections.abc import Callable

import numpy as np

from wirerope_mj.periodic.branch import Kind
from wirerope_mj.periodic.continuation import Continuation, Point
from wirerope_mj.periodic.multipliers import MARGIN

CLOSE = 1e-6
"""Share of the parameter to which a fold or a change of stability is located."""

LOCATIONS = 12
"""Points that locating one may take."""


def unstable(point: Point) -> int:
    """Return the number of multipliers outside the unit circle."""
    return int((np.abs(point.stability.multipliers) > 1.0 + MARGIN).sum())


def turns(a: Point, b: Point) -> bool:
    """Return whether the branch turns back between two points."""
    return float(a.tangent[-1] * b.tangent[-1]) < 0.0


def locate(path: Continuation, a: Point, b: Point, length: float) -> tuple[Kind, complex, Point] | None:
    """Return what happens between `a` and `b`, an arclength apart, the multiplier concerned and the point nearest to it."""
    if turns(a, b):
        found = _between(path, a, b, length, lambda p: float(p.tangent[-1]))
        return "fold", _nearest_to_one(found), found
    low, high = sorted((unstable(a), unstable(b)))
    if low == high:
        return None
    found = _between(path, a, b, length, lambda p: _modulus(p, low) - 1.0)
    more = a if unstable(a) > unstable(b) else b
    critical = complex(more.stability.multipliers[low])
    return _kind(critical), critical, found


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


def _between(path: Continuation, a: Point, b: Point, length: float, test: Callable[[Point], float]) -> Point:
    """Return the point where `test` vanishes, by the Illinois method on the arclength from `a`."""
    left, right, f_left, f_right = 0.0, length, test(a), test(b)
    best, least = (a, abs(f_left)) if abs(f_left) < abs(f_right) else (b, abs(f_right))
    for _ in range(LOCATIONS):
        middle = (left * f_right - right * f_left) / (f_right - f_left)
        point = path.step(a, middle)
        if point is None:
            break
        value = test(point)
        if abs(value) < least:
            best, least = point, abs(value)
        # what is left of the interval, as a share of the parameter
        if path.unit * abs(point.tangent[-1]) * abs(right - left) < CLOSE:
            break
        if value * f_right < 0.0:
            left, f_left = right, f_right
        else:
            f_left *= 0.5
        right, f_right = middle, value
    return best
