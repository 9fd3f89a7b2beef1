"""Closed forms of Bouc-Wen's state along a monotone segment for n = 1 and n = 2: exact however long the segment is.

Over a segment of direction s = +-1 let y = s z and l = |x - x0|. Bouc-Wen's equation becomes y' = alpha - B |y|^n with
B = gamma - beta while y < 0 (unloading) and B = beta + gamma from there on, which n = 1 and n = 2 solve by exponentials and
hyperbolic or circular tangents (also Charalampakis and Koumousis 2008). The work is a Gauss-Legendre sum.
"""

import math

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.ni import ASYMMETRIC_BOUC_WEN, bouc_wen_force

_NODES = np.array([0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263])
_WEIGHTS = np.array([0.17392742256872692, 0.32607257743127307, 0.32607257743127307, 0.17392742256872692])
# Panels in the length over which a law forgets by 1/e: four points in a quarter of it leave at most 3e-10 of the work.
_PANELS_PER_LENGTH = 4.0
_SETTLED = 40.0  # Such lengths after which the state stands at its bound but for rounding: exp(-40) = 4e-18
# Cap on them: what else bends the force, exponentials of the deflection, overflows before a thousand of its lengths.
_MOST_PANELS = 4096


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
def rates(law, p, i, b):
    """Return how fast the state settles, and how fast an asymmetric law's exp(lambda x) changes, over a length [1/m]."""
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
            work += _WEIGHTS[node] * bouc_wen_force(law, p, i, x0 + s * length, 0.0, trial, 0, unused, 0)
    return s * work * width


@njit
def advance_branch(law, p, i, x0, s, length, b, z, j, trial, unused):
    """Carry the state over a length on which one closed form holds and return the work done on the law [J]."""
    end = s * branch(p[i], b, p[i + 3], s * z[j], length)
    state, bend = rates(law, p, i, b)
    # For n = 2 a tangent near its pole bends faster than it settles: by |b z| over a length.
    fastest = state if p[i + 3] == 1.0 else max(state, abs(b) * max(abs(z[j]), abs(end)))
    settled = length
    if b > 0.0 and length * state > _SETTLED:
        settled = _SETTLED / state
    work = work_between(law, p, i, x0, s, 0.0, settled, fastest + bend, b, z[j], trial, unused)
    if settled < length:
        work += work_between(law, p, i, x0, s, settled, length, bend, b, z[j], trial, unused)
    z[j] = end
    return work


@njit
def advance_bouc_wen(law, p, i, x0, x1, z, j, trial, unused):
    """Carry the state `z[j]` in place from deflection x0 to x1 and return the work done on the law [J].

    `trial` and `unused` are scratch arrays of at least one entry.
    """
    s, length, work = 1.0 if x1 > x0 else -1.0, abs(x1 - x0), 0.0
    if s * z[j] < 0.0:
        b = p[i + 2] - p[i + 1]
        first = length_to_zero(p[i], b, p[i + 3], s * z[j])
        if first >= length:
            return advance_branch(law, p, i, x0, s, length, b, z, j, trial, unused)
        work = advance_branch(law, p, i, x0, s, first, b, z, j, trial, unused)
        z[j] = 0.0
        x0, length = x0 + s * first, length - first
    return work + advance_branch(law, p, i, x0, s, length, p[i + 1] + p[i + 2], z, j, trial, unused)


@njit
def carry_bouc_wen(p, i, x0, x1, z, j):
    """Carry the state `z[j]` in place from deflection x0 to x1 without summing the work."""
    s, length, b = 1.0 if x1 > x0 else -1.0, abs(x1 - x0), p[i + 1] + p[i + 2]
    if s * z[j] < 0.0:
        unloading = p[i + 2] - p[i + 1]
        first = length_to_zero(p[i], unloading, p[i + 3], s * z[j])
        if first >= length:
            b = unloading
        else:
            z[j], length = 0.0, length - first
    z[j] = s * branch(p[i], b, p[i + 3], s * z[j], length)
