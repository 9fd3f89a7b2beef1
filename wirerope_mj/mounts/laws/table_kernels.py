"""The tabulated law: two piecewise cubics of the deflection, one of them times a Bouc-Wen state with n = 1 and gamma = 0.

p = alpha, beta, 0, 1, number m of knots, knots (m,), coefficients (m + 1, 8): before the first knot, and from each knot on.
The coefficients are those of M and then of g in ascending powers of the distance from the knot, the first for both rows there.
"""

import math

from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import count, picked, ranked
from wirerope_mj.mounts.laws.cubic import NODES, WEIGHTS

ROW = 8  # Coefficients from one knot to the next: four of M, four of g
# Lengths of 1 / beta up to which the quadrature of eight points has a cubic times an exponential to rounding.
_SHORT = 2.0


@njit
def row_at(p, i, x):
    """Return how many knots are at or below a deflection: the number of its row of coefficients."""
    return ranked(p, i + 5, count(p, i + 4), x)


@njit
def cubics(p, i, row, x):
    """Return M [N] and g [-] of a row of coefficients at a deflection."""
    c, at = i + 5 + count(p, i + 4), ROW * row
    d = x - picked(p, i + 5, max(row - 1, 0))
    mean = picked(p, c, at) + d * (picked(p, c + 1, at) + d * (picked(p, c + 2, at) + d * picked(p, c + 3, at)))
    g = picked(p, c + 4, at) + d * (picked(p, c + 5, at) + d * (picked(p, c + 6, at) + d * picked(p, c + 7, at)))
    return mean, g


@njit
def tabulated(p, i, x, v, z, j, zdot, k):
    """Return F = M(x) + g(x) z [N] with zdot = alpha v - beta |v| z."""
    friction = z[j]
    zdot[k] = p[i] * v - p[i + 1] * abs(v) * friction
    mean, g = cubics(p, i, row_at(p, i, x), x)
    return mean + g * friction


@njit
def decaying(p, i, row, x, s, length):
    """Return the integral of g exp(-beta l) over the length l [m] from x in the direction s, inside one row.

    By parts it is the sum of the derivatives of g at the start, less those at the end times exp(-beta l), over beta^(n+1).
    """
    rate, total = p[i + 1], 0.0
    if rate * length <= _SHORT:  # where these terms would cancel
        for node in range(8):
            _, g = cubics(p, i, row, x + s * length * NODES[node])
            total += WEIGHTS[node] * g * math.exp(-rate * length * NODES[node])
        return total * length
    m = int(p[i + 4])
    c, knot, fade = i + 9 + m + ROW * row, p[i + 5 + max(row - 1, 0)], math.exp(-rate * length)
    for end in range(2):
        d = x - knot + end * s * length
        value = p[c] + d * (p[c + 1] + d * (p[c + 2] + d * p[c + 3]))
        slope = s * (p[c + 1] + d * (2.0 * p[c + 2] + 3.0 * d * p[c + 3]))
        bend, jerk = 2.0 * p[c + 2] + 6.0 * d * p[c + 3], 6.0 * s * p[c + 3]
        total += (1.0 - 2.0 * end) * (fade if end else 1.0) * (value + (slope + (bend + jerk / rate) / rate) / rate)
    return total / rate


@njit
def advance_table(p, i, x0, x1, z, j):
    """Carry the state in `z[j]` in place from deflection x0 to x1 and return the work done on the law [J]."""
    s = 1.0 if x1 >= x0 else -1.0
    bound, knots, m, work = s * p[i] / p[i + 1], i + 5, int(p[i + 4]), 0.0
    row, x = row_at(p, i, x0), x0
    while x != x1:
        end, ahead = x1, row if s > 0.0 else row - 1
        if 0 <= ahead < m and abs(p[knots + ahead] - x) < abs(x1 - x):
            end = p[knots + ahead]
        length = abs(end - x)
        if length > 0.0:
            elastic = 0.0
            for node in range(8):
                mean, g = cubics(p, i, row, x + s * length * NODES[node])
                elastic += WEIGHTS[node] * (mean + g * bound)
            away = z[j] - bound
            work += s * (elastic * length + away * decaying(p, i, row, x, s, length))
            z[j] = bound + away * math.exp(-p[i + 1] * length)
        x, row = end, row + (1 if s > 0.0 else -1)
    return work
