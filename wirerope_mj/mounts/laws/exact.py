"""Closed forms of the laws along a monotone segment: the state is exact however long the segment is.

Over a segment of direction s = +-1 let y = s z and l = |x - x0|. Bouc-Wen's equation becomes y' = alpha - B |y|^n with
B = gamma - beta while y < 0 (unloading) and B = beta + gamma from there on, which n = 1 and n = 2 solve by exponentials and
hyperbolic or circular tangents (also Charalampakis and Koumousis 2008). Vaiana and Rosati's law approaches its limit curve
exponentially; a Jenkin element is elastic up to its slip force. The work has a closed form too, but for the Bouc-Wen laws,
where it is a Gauss-Legendre sum.
"""

import math

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.kernels import (
    ASYMMETRIC_BOUC_WEN,
    BOUC_WEN,
    MASING,
    STOP,
    SYMMETRIC_BOUC_WEN,
    TABULATED,
    VAIANA_ROSATI,
    evaluate_one,
    limit_curve,
)
from wirerope_mj.mounts.laws.stop_kernels import LOSS, advance_stop, turned
from wirerope_mj.mounts.laws.table_kernels import advance_table

_NODES = np.array([0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263])
_WEIGHTS = np.array([0.17392742256872692, 0.32607257743127307, 0.32607257743127307, 0.17392742256872692])

_PANELS_PER_LENGTH = 4.0
"""Panels in the length over which a law forgets by 1/e: four points in a quarter of it leave at most 3e-10 of the work."""

_SETTLED = 40.0
"""Such lengths after which the state stands at its bound but for rounding: exp(-40) = 4e-18."""

_MOST_PANELS = 4096
"""What else bends the force, exponentials of the deflection, overflows before a thousand of its lengths."""


@njit
def has_closed_form(law, p, i):
    """Return whether the law of this number has a closed form with these parameters."""
    if law in (BOUC_WEN, SYMMETRIC_BOUC_WEN, ASYMMETRIC_BOUC_WEN):
        return p[i + 3] == 1.0 or p[i + 3] == 2.0
    return law in (MASING, VAIANA_ROSATI, STOP, TABULATED)


@njit
def branch(alpha, b, n, y, length):
    """Return y after a length along y' = alpha - b |y|^n, for n = 1 or 2 and y that does not change its sign."""
    if n == 1.0:
        b = b if y >= 0.0 else -b
        return y + (alpha - b * y) * (length if b == 0.0 else -math.expm1(-b * length) / b)
    root = math.sqrt(alpha * abs(b))
    if root == 0.0:
        return y + alpha * length
    if b > 0.0:
        t = math.tanh(root * length)
        return (y + alpha / root * t) / (1.0 + root / alpha * y * t)
    if root * length + math.atan(root / alpha * y) >= 0.5 * math.pi:
        return np.inf  # hardening beyond its finite travel
    t = math.tan(root * length)
    return (y + alpha / root * t) / (1.0 - root / alpha * y * t)


@njit
def length_to_zero(alpha, b, n, y):
    """Return the length after which y < 0 is zero along y' = alpha - b |y|^n, n = 1 or 2; inf if it never is."""
    if n == 1.0:
        start = alpha + b * y
        if start <= 0.0:
            return np.inf
        return -y / alpha if b == 0.0 else math.log1p(-b * y / start) / b
    root = math.sqrt(alpha * abs(b))
    ratio = -y * root / alpha
    if root == 0.0:
        return -y / alpha
    if b < 0.0:
        return math.atan(ratio) / root
    return math.atanh(ratio) / root if ratio < 1.0 else np.inf


@njit
def approach(p, i, x0, x1, z):
    """Return Vaiana and Rosati's z at x1 on the way from (x0, z); `p[i:]` as their kernel's."""
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
    share = 1.0 - w * (1 / 6 - w * (2 / 45 - w * (17 / 1260 - w * 62 / 14175)))
    return work + 0.5 * p[i + 5] * p[i + 6] * (x - p[i + 7]) ** 2 * share


@njit
def approach_work(p, i, x0, x1, z):
    """Return the work done on Vaiana and Rosati's law on the way from (x0, z) to x1 [J]."""
    side, s = (i, 1.0) if x1 >= x0 else (i + 8, -1.0)
    up, _ = limit_curve(p, i, x0)
    low, _ = limit_curve(p, i + 8, x0)
    gap = s * 0.5 * (up + p[i + 1] - low + p[i + 9]) - z
    curve = limit_work(p, side, x1) - limit_work(p, side, x0) + (s * p[side + 1] - p[i + 16]) * (x1 - x0)
    return curve + s * gap * math.expm1(-p[side + 2] * abs(x1 - x0)) / p[side + 2]


@njit
def masing_increment(p, i, x0, x1, z, j):
    """Carry the states of Jenkin elements from x0 to x1 and return the work done on the law [J]."""
    n, dx = int(p[i + 1]), x1 - x0
    work = p[i] * dx * 0.5 * (x0 + x1)
    for e in range(n):
        stiffness, slip = p[i + 2 + e], p[i + 2 + n + e]
        start = min(max(z[j + e], -slip), slip)
        end = min(max(start + stiffness * dx, -slip), slip)
        elastic = (end - start) / stiffness
        work += 0.5 * (start + end) * elastic + end * (dx - elastic)
        z[j + e] = end
    return work


@njit
def rates(law, p, i, b):
    """Return how fast the state and the rest of the force change over a length [1/m]."""
    state = abs(b) if p[i + 3] == 1.0 else math.sqrt(p[i] * abs(b))
    return state, (abs(p[i + 7]) if law == ASYMMETRIC_BOUC_WEN else 0.0)


@njit
def work_between(law, p, i, x0, s, first, last, rate, b, z, trial, unused):
    """Return the work done on the law between two lengths after (x0, z) [J], `rate` the fastest change between them."""
    wanted = _PANELS_PER_LENGTH * (last - first) * rate
    count = int(wanted) + 1 if wanted < _MOST_PANELS else _MOST_PANELS
    work, width = 0.0, (last - first) / count
    for panel in range(count):
        for node in range(4):
            length = first + width * (panel + _NODES[node])
            trial[0] = s * branch(p[i], b, p[i + 3], s * z, length)
            work += _WEIGHTS[node] * evaluate_one(law, p, i, x0 + s * length, 0.0, trial, 0, unused, 0)
    return s * work * width


@njit
def stretch(law, p, i, x0, s, length, b, z, j, trial, unused):
    """Carry the state over a length on which one closed form holds and return the work done on the law [J]."""
    state, bend = rates(law, p, i, b)
    settled = length
    if b > 0.0 and length * state > _SETTLED:
        settled = _SETTLED / state
    work = work_between(law, p, i, x0, s, 0.0, settled, state + bend, b, z[j], trial, unused)
    if settled < length:
        work += work_between(law, p, i, x0, s, settled, length, bend, b, z[j], trial, unused)
    z[j] = s * branch(p[i], b, p[i + 3], s * z[j], length)
    return work


@njit
def advance_exactly(law, p, i, x0, x1, z, j, trial, unused):
    """Carry the states in `z[j:]` in place from deflection x0 to x1 and return the work done on the law [J].

    `trial` and `unused` are scratch arrays of at least one entry. The law must have a closed form.
    """
    if law == MASING:
        return masing_increment(p, i, x0, x1, z, j)
    if law == VAIANA_ROSATI:
        work = approach_work(p, i, x0, x1, z[j])
        z[j] = approach(p, i, x0, x1, z[j])
        return work
    if law == STOP:
        return advance_stop(p, i, x0, x1, z, j)
    if law == TABULATED:
        return advance_table(p, i, x0, x1, z, j)
    s, length, work = 1.0 if x1 > x0 else -1.0, abs(x1 - x0), 0.0
    if s * z[j] < 0.0:
        b = p[i + 2] - p[i + 1]
        first = length_to_zero(p[i], b, p[i + 3], s * z[j])
        if first >= length:
            return stretch(law, p, i, x0, s, length, b, z, j, trial, unused)
        work = stretch(law, p, i, x0, s, first, b, z, j, trial, unused)
        z[j] = 0.0
        x0, length = x0 + s * first, length - first
    return work + stretch(law, p, i, x0, s, length, p[i + 1] + p[i + 2], z, j, trial, unused)


@njit
def carry_exactly(law, p, i, x0, x1, z, j):
    """Carry the states in `z[j:]` in place from deflection x0 to x1 as `advance_exactly` does, without summing the work."""
    if law == MASING:
        masing_increment(p, i, x0, x1, z, j)
        return
    if law == VAIANA_ROSATI:
        z[j] = approach(p, i, x0, x1, z[j])
        return
    if law == STOP:
        if p[i + LOSS] > 0.0:
            z[j] = turned(p, i, z[j], 1.0 if x1 > x0 else -1.0, abs(x1 - x0))
        return
    s, length, b = 1.0 if x1 > x0 else -1.0, abs(x1 - x0), p[i + 1] + p[i + 2]
    if s * z[j] < 0.0:
        unloading = p[i + 2] - p[i + 1]
        first = length_to_zero(p[i], unloading, p[i + 3], s * z[j])
        if first >= length:
            b = unloading
        else:
            z[j], length = 0.0, length - first
    z[j] = s * branch(p[i], b, p[i + 3], s * z[j], length)
