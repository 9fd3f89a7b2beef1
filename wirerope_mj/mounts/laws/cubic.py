"""A deflection between two samples, the cubic through deflections and rates, and the sum by which work is integrated.

That is Gauss and Legendre's rule of eight points between 0 and 1, exact for polynomials of degree 15. It covers the power of a
cubic spring along a cubic path, which has degree 11.
"""

import math

import numpy as np

from wirerope_mj.foundation.jit import njit

_HALVES = np.array([0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623])
_HALF_WEIGHTS = np.array([0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626])
NODES = 0.5 * np.concatenate([1.0 - _HALVES[::-1], 1.0 + _HALVES])
WEIGHTS = 0.5 * np.concatenate([_HALF_WEIGHTS[::-1], _HALF_WEIGHTS])


@njit
def position(cubic, t):
    """Return the deflection at the instant t of a cubic, given by its coefficients."""
    return cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3]))


@njit
def speed(cubic, t):
    """Return the deflection rate at the instant t of a cubic, given by its coefficients."""
    return cubic[1] + t * (2.0 * cubic[2] + t * 3.0 * cubic[3])


@njit
def reversals(x0, x1, v0, v1, h):
    """Return the cubic that joins positions and rates at the ends of a time h, and where inside it the rate is zero.

    Of the two instants, those that do not exist are h.
    """
    b, c = 3.0 * (x1 - x0) / h - 2.0 * v0 - v1, v0 + v1 - 2.0 * (x1 - x0) / h
    cubic = (x0, v0, b / h, c / (h * h))  # the rate over u = t / h is v0 + 2 b u + 3 c u^2
    root = b * b - 3.0 * c * v0
    if root <= 0.0:
        return cubic, h, h
    q = -(b + math.copysign(math.sqrt(root), b))
    one, two = h, h
    if q != 0.0 and 0.0 < v0 / q < 1.0:
        one = h * v0 / q
    if c != 0.0 and 0.0 < q / (3.0 * c) < 1.0:
        two = h * q / (3.0 * c)
    return cubic, min(one, two), max(one, two)


@njit
def zero_between(cubic, start, end):
    """Return the instant at which a cubic that changes its sign between two instants is zero."""
    rising = position(cubic, end) > 0.0
    for _ in range(60):
        middle = 0.5 * (start + end)
        if (position(cubic, middle) > 0.0) == rising:
            end = middle
        else:
            start = middle
    return end


@njit
def shifted(cubic, t):
    """Return the coefficients of the cubic about the instant t."""
    a, b, c, d = cubic
    return a + t * (b + t * (c + t * d)), b + t * (2.0 * c + t * 3.0 * d), c + 3.0 * d * t, d
