"""Laws that depend on the rate, along a path in time that is a cubic between samples.

Their states have closed forms, or there are none: what is left is the work, a Gauss-Legendre sum on pieces that end at
reversals. Only a smoothed law is integrated.
"""

import math

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.cubic import position, reversals, shifted, speed, zero_between
from wirerope_mj.mounts.laws.kernels import (
    KELVIN_VOIGT,
    PARALLEL,
    SMOOTHED,
    STOP,
    TINKER_CUTCHINS,
    ZENER,
    component,
    evaluate,
    evaluate_one,
)
from wirerope_mj.mounts.laws.path import SCRATCH, segment_of_one
from wirerope_mj.mounts.laws.quadrature import NODES, WEIGHTS
from wirerope_mj.mounts.laws.smooth_steps import follow_smoothed
from wirerope_mj.mounts.laws.stop_kernels import VISCOUS, stop_work

_GROWTH = 3.0
"""Ratio of the rates at the ends of a piece up to which |v|^n and tanh(v / s) are smooth on it to 1e-9."""

_NARROWEST = 1e-6
"""Share of a sample's interval below which a piece is not cut any further."""


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
def width_of_piece(law, p, i, cubic, start, end, shortest):
    """Return how far from `start` the next piece may reach, so that the power is smooth on it."""
    width = end - start
    if law == ZENER:
        return min(width, 1.0 / p[i + 2])
    if law == SMOOTHED:
        bend = p[i]
    elif law == TINKER_CUTCHINS and not (p[i + 4] == 1.0 and p[i + 5] == 0.0 and p[i + 6] == 0.0 and p[i + 7] == 0.0):
        bend = p[i + 8]
    else:
        return width
    v0 = abs(speed(cubic, start))
    while width > shortest:
        v1 = abs(speed(cubic, start + width))
        if max(v0, v1) <= _GROWTH * min(v0, v1) + bend:
            break
        width *= 0.5
    return width


@njit
def work_over(law, p, i, cubic, start, end, z, j, n_states, trial, unused):
    """Carry the states `z[j:]` in place over start <= t <= end, without a reversal, and return the work done on the law [J]."""
    if law not in (ZENER, TINKER_CUTCHINS, SMOOTHED, KELVIN_VOIGT, STOP) or (law == STOP and p[i + VISCOUS] == 0.0):
        return segment_of_one(law, p, i, position(cubic, start), position(cubic, end), z, j, n_states, unused, trial)
    if law == STOP:
        return stop_work(p, i, cubic, start, end, z, j)
    work, shortest = 0.0, _NARROWEST * (end - start)
    origin = z[j] if law == ZENER else 0.0
    begun = start
    while start < end:
        width = width_of_piece(law, p, i, cubic, start, end, shortest)
        if law == SMOOTHED:
            work += follow_smoothed(p, i, cubic, start, min(start + width, end), z, j)
            start = end if start + width >= end else start + width
            continue
        for node in range(8):
            t = start + width * NODES[node]
            if law == ZENER:
                trial[0] = zener_state(p[i + 1], p[i + 2], shifted(cubic, begun), origin, t - begun)
            v = speed(cubic, t)
            work += width * WEIGHTS[node] * v * evaluate_one(law, p, i, position(cubic, t), v, trial, 0, unused, 0)
        start = end if start + width >= end else start + width
    if law == ZENER:
        z[j] = zener_state(p[i + 1], p[i + 2], shifted(cubic, begun), origin, end - begun)
    return work


@njit
def work_of_all(law, p, cubic, start, end, z, n_states, trial, unused):
    """Do the same for a law or for several in parallel."""
    if law != PARALLEL:
        return work_over(law, p, 0, cubic, start, end, z, 0, n_states, trial, unused)
    work = 0.0
    for part in range(int(p[0])):
        one, first, state, count = component(p, 0, part, n_states)
        work += work_over(one, p, first, cubic, start, end, z, state, count, trial, unused)
    return work


@njit
def follow_time(law, p, time, deflection, rate, z, n_states):
    """Return force (n_t,), states (n_t, n_states) and cumulated work (n_t,), with `rate` at the samples `time`."""
    n_t = deflection.size
    force, states, work = np.empty(n_t), np.empty((n_t, n_states)), np.zeros(n_t)
    trial, unused = np.empty(n_states + 1), np.empty(SCRATCH * (n_states + 1))
    for t in range(n_t):
        if t > 0:
            h = time[t] - time[t - 1]
            cubic, one, two = reversals(deflection[t - 1], deflection[t], rate[t - 1], rate[t], h)
            work[t], start = work[t - 1], 0.0
            for end in (one, two, h):
                if (
                    end > start
                    and law not in (KELVIN_VOIGT, ZENER)
                    and position(cubic, start) * position(cubic, end) < 0.0
                ):
                    middle = zero_between(cubic, start, end)  # friction or a polynomial may have a kink there
                    work[t] += work_of_all(law, p, cubic, start, middle, z, n_states, trial, unused)
                    start = middle
                if end > start:
                    work[t] += work_of_all(law, p, cubic, start, end, z, n_states, trial, unused)
                    start = end
        states[t] = z[:n_states]
        force[t] = evaluate(law, p, 0, deflection[t], rate[t], z, 0, unused, 0)
    return force, states, work
