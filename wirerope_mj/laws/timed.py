"""Laws that depend on the rate, along a path in time that is a cubic between samples.

Their states have closed forms, or there are none: what is left is the work, a Gauss-Legendre sum on pieces that end at
reversals.
"""

import math

import numpy as np

from wirerope_mj.jit import njit
from wirerope_mj.laws.kernels import TINKER_CUTCHINS, ZENER, evaluate
from wirerope_mj.laws.quadrature import NODES, WEIGHTS

_GROWTH = 3.0
"""Ratio of the rates at the ends of a piece up to which |v|^n and tanh(v / s) are smooth on it to 1e-9."""

_NARROWEST = 1e-6
"""Share of a sample's interval below which a piece is not cut any further."""


@njit
def position(cubic, t):
    """Return the deflection at t."""
    return cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3]))


@njit
def speed(cubic, t):
    """Return the deflection rate at t."""
    return cubic[1] + t * (2.0 * cubic[2] + t * 3.0 * cubic[3])


@njit
def zener_state(k1, decay, cubic, z, t):
    """Return z at t along zdot = k1 v - decay z with v of a cubic path, from z at 0.

    z exp(-x) + k1 (v0 phi1 t + v1 phi2 t^2 + v2 phi3 t^3), x = decay t, v = v0 + v1 t + v2 t^2 / 2, with the functions
    phi1 = (1 - exp(-x)) / x, phi2 = (1 - phi1) / x, phi3 = (1/2 - phi2) / x of exponential integrators.
    """
    x = decay * t
    if x > 0.5:
        phi1 = -math.expm1(-x) / x
        phi2 = (1.0 - phi1) / x
        phi3 = (0.5 - phi2) / x
    else:  # the quotients cancel: phi3 by its series sum (-x)^k / (k + 3)!, the others from it
        phi3, term = 0.0, 1.0 / 6.0
        for k in range(14):
            phi3 += term
            term *= -x / (k + 4.0)
        phi2 = 0.5 - x * phi3
        phi1 = 1.0 - x * phi2
    v0, v1, v2 = cubic[1], 2.0 * cubic[2], 6.0 * cubic[3]
    return z * math.exp(-x) + k1 * t * (v0 * phi1 + t * (v1 * phi2 + t * v2 * phi3))


@njit
def width_of_piece(law, p, cubic, start, end, shortest):
    """Return how far from `start` the next piece may reach, so that the power is smooth on it."""
    width = end - start
    if law == ZENER:
        return min(width, 1.0 / p[2])
    if law != TINKER_CUTCHINS or (p[4] == 1.0 and p[5] == 0.0 and p[6] == 0.0 and p[7] == 0.0):
        return width
    v0 = abs(speed(cubic, start))
    while width > shortest:
        v1 = abs(speed(cubic, start + width))
        if max(v0, v1) <= _GROWTH * min(v0, v1) + p[8]:
            break
        width *= 0.5
    return width


@njit
def work_over(law, p, cubic, start, end, z, trial, unused):
    """Carry the state `z` in place over start <= t <= end and return the work done on the law [J]."""
    work, shortest = 0.0, _NARROWEST * (end - start)
    origin = z[0] if law == ZENER else 0.0
    begun = start
    while start < end:
        width = width_of_piece(law, p, cubic, start, end, shortest)
        for node in range(8):
            t = start + width * NODES[node]
            if law == ZENER:
                trial[0] = zener_state(p[1], p[2], shifted(cubic, begun), origin, t - begun)
            v = speed(cubic, t)
            work += width * WEIGHTS[node] * v * evaluate(law, p, 0, position(cubic, t), v, trial, 0, unused, 0)
        start = end if start + width >= end else start + width
    if law == ZENER:
        z[0] = zener_state(p[1], p[2], shifted(cubic, begun), origin, end - begun)
    return work


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
    """Return where a cubic that changes its sign is zero."""
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


@njit
def follow_time(law, p, time, deflection, rate, z, n_states):
    """Return force (n_t,), states (n_t, n_states) and cumulated work (n_t,), with `rate` at the samples `time`."""
    n_t = deflection.size
    force, states, work = np.empty(n_t), np.empty((n_t, n_states)), np.zeros(n_t)
    trial, unused = np.empty(n_states + 1), np.empty(n_states + 1)
    for t in range(n_t):
        if t > 0:
            h = time[t] - time[t - 1]
            cubic, one, two = reversals(deflection[t - 1], deflection[t], rate[t - 1], rate[t], h)
            work[t], start = work[t - 1], 0.0
            for end in (one, two, h):
                if end > start and law == TINKER_CUTCHINS and position(cubic, start) * position(cubic, end) < 0.0:
                    middle = zero_between(cubic, start, end)  # friction may have a kink there
                    work[t] += work_over(law, p, cubic, start, middle, z, trial, unused)
                    start = middle
                if end > start:
                    work[t] += work_over(law, p, cubic, start, end, z, trial, unused)
                    start = end
        states[t] = z[:n_states]
        force[t] = evaluate(law, p, 0, deflection[t], rate[t], z, 0, unused, 0)
    return force, states, work
