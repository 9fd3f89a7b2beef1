"""Tabulated forces: the cubics between points, and the kernels that follow them.

p = alpha, beta, 0, 1, number m of knots, knots (m,), coefficients (m + 1, 8): before the first knot, and from each knot on.
The coefficients are those of M and then of g in ascending powers of the distance from the knot, the first for both rows there.
"""

import math
from collections.abc import Sequence

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import count, picked, ranked
from wirerope_mj.mounts.laws.cubic import NODES, WEIGHTS

ROW = 8  # Coefficients from one knot to the next: four of M, four of g
# Lengths of 1 / beta up to which the quadrature of eight points has a cubic times an exponential to rounding.
_SHORT = 2.0


@njit
def row_at(p, i, x):
    """Return how many knots of the table are at or below a deflection: the number of its row of coefficients."""
    return ranked(p, i + 5, count(p, i + 4), x)


@njit
def cubics(p, i, row, x):
    """Return the mean force M [N] and the factor g on friction [-] of a row of coefficients at a deflection."""
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


def monotone(x: Array, values: Array) -> "scipy.interpolate.PPoly":
    """Return the monotone cubics through points."""
    with np.errstate(over="ignore"):  # a mean of slopes of which one is as good as zero
        return scipy.interpolate.PchipInterpolator(x, values)


def level_cubics(knots: Sequence[float], values: Sequence[float] | Array, scale: float) -> "scipy.interpolate.PPoly":
    """Return values over `scale` as a function of |x|, joined by cubics that are level at the knots; 0 without values."""
    if len(values) == 0 or scale == 0.0:
        return scipy.interpolate.PPoly(np.zeros((1, 1)), np.array([-1.0, 1.0]))
    ends = np.concatenate([-np.array(knots)[::-1], knots])
    scaled = np.concatenate([np.array(values)[::-1], values]) / scale
    return scipy.interpolate.PPoly.from_bernstein_basis(
        scipy.interpolate.BPoly.from_derivatives(ends, np.column_stack([scaled, np.zeros_like(scaled)]))
    )


def clip_to_curve(x: Array, curve: "scipy.interpolate.PPoly") -> Array:
    """Return deflections clipped to the range of a curve."""
    return np.clip(x, curve.x[0], curve.x[-1])


def packed(curve: "scipy.interpolate.PPoly", fraction: "scipy.interpolate.PPoly", z_max: float, x_y: float) -> Array:
    """Return the kernel's parameters of a law with the mean force M, `curve`, and the factor g on friction, `fraction`."""
    knots = np.union1d(curve.x, fraction.x)
    rows = np.zeros((knots.size + 1, 8))
    factorials = (1.0, 1.0, 2.0, 6.0)
    for first, poly in ((0, curve), (4, fraction)):
        at = clip_to_curve(knots, poly)
        for power in range(4):
            rows[1:, first + power] = poly(at, power) / factorials[power]
    # Outside both are what they are at their ends; M goes straight on.
    below, above = knots < curve.x[0], knots >= curve.x[-1]
    for outside, end in ((below, curve.x[0]), (above, curve.x[-1])):
        rows[1:][outside, 0] = curve(end) + curve(end, 1) * (knots[outside] - end)
        rows[1:][outside, 1] = curve(end, 1)
        rows[1:][outside, 2:4] = 0.0
    rows[1:][(knots < fraction.x[0]) | (knots >= fraction.x[-1]), 5:] = 0.0
    rows[0] = rows[1]
    rows[0, [2, 3, 5, 6, 7]] = 0.0
    return np.concatenate([[z_max / x_y, 1.0 / x_y, 0.0, 1.0, knots.size], knots, rows.ravel()])


def cycle_area(knots: Sequence[float], widths: Array, amplitude: float, x_y: float) -> float:
    """Return the area of a closed cycle about zero with half widths [N] at knots of |x| [J]."""
    elastic = scipy.interpolate.PPoly(np.zeros((1, 1)), np.array([-1.0, 1.0]))
    # Unit bound of z: g takes the widths themselves.
    p = packed(elastic, level_cubics(knots, widths, 1.0), 1.0, x_y)
    z, work = np.array([-math.tanh(amplitude / x_y)]), 0.0
    for end in (amplitude, -amplitude):  # as `path.advance` does, by way of zero
        work += advance_table(p, 0, -end, 0.0, z, 0) + advance_table(p, 0, 0.0, end, z, 0)
    return float(work)
