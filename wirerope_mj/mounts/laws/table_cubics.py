"""Piecewise cubics of the tabulated law: made from points, handed to its kernel, and the area of a cycle with them."""

import math
from collections.abc import Sequence

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws.table_kernels import advance_table


def monotone(x: Array, values: Array) -> "scipy.interpolate.PPoly":
    """Return the monotone cubics through points."""
    with np.errstate(over="ignore"):  # a mean of slopes of which one is as good as zero
        return scipy.interpolate.PchipInterpolator(x, values)


def level_cubics(knots: Sequence[float], values: Sequence[float] | Array, scale: float) -> "scipy.interpolate.PPoly":
    """Return values over a scale as a function of |x|, joined by cubics that are level at its knots; constant without any."""
    if len(values) == 0 or scale == 0.0:
        return scipy.interpolate.PPoly(np.zeros((1, 1)), np.array([-1.0, 1.0]))
    ends = np.concatenate([-np.array(knots)[::-1], knots])
    scaled = np.concatenate([np.array(values)[::-1], values]) / scale
    return scipy.interpolate.PPoly.from_bernstein_basis(
        scipy.interpolate.BPoly.from_derivatives(ends, np.column_stack([scaled, np.zeros_like(scaled)]))
    )


def held(x: Array, curve: "scipy.interpolate.PPoly") -> Array:
    """Return deflections, those beyond the ends of a curve moved there."""
    return np.clip(x, curve.x[0], curve.x[-1])


def packed(curve: "scipy.interpolate.PPoly", fraction: "scipy.interpolate.PPoly", z_max: float, x_y: float) -> Array:
    """Return the kernel's parameters of a law with M and g, `curve` and `fraction`."""
    knots = np.union1d(curve.x, fraction.x)
    rows = np.zeros((knots.size + 1, 8))
    factorials = (1.0, 1.0, 2.0, 6.0)
    for first, poly in ((0, curve), (4, fraction)):
        at = held(knots, poly)
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
