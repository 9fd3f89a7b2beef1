"""The restoring-force laws as scalar kernels, one source for the native and the Python callback, traces and statics.

Every kernel has the same signature

    force = kernel(p, i, x, v, z, j, zdot, k)

with the parameters in `p[i:]`, deflection `x` [m], deflection rate `v` [m/s] and internal states in `z[j:]`; it writes the
states' rates to `zdot[k:]` and returns the force [N]. With JIT disabled the kernels are plain Python.
"""

import math

import numpy as np

from wirerope_mj.jit import njit

BOUC_WEN = 0
ASYMMETRIC_BOUC_WEN = 1
SYMMETRIC_BOUC_WEN = 2
KELVIN_VOIGT = 3


@njit
def bouc_wen_rate(alpha, beta, gamma, n, v, z):
    """Return zdot = alpha v - [gamma + beta sgn(v) sgn(z)] |z|^n v [N/s], thesis (3.7); no |z|^(n-1), so n < 1 is safe."""
    size = abs(z)
    if n == 1.0:  # pow() costs more than the rest of the kernel, and n is 1 or 2 in most fits
        power = size
    elif n == 2.0:
        power = size * size
    else:
        power = size**n
    if v * z >= 0.0:
        return (alpha - (gamma + beta) * power) * v
    return (alpha - (gamma - beta) * power) * v


@njit
def polynomial(k1, k2, k3, x):
    """Return Ni's odd polynomial F1 = k1 x + k2 sgn(x) x^2 + k3 x^3 [N], thesis (3.16)."""
    return x * (k1 + k2 * abs(x) + k3 * x * x)


@njit
def bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F = k x + z [N], thesis (3.4) with g = k x; p = alpha, beta, gamma, n, k."""
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, z[j])
    return p[i + 4] * x + z[j]


@njit
def asymmetric_bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F = exp(lambda x) [z + F1(x)] [N], thesis (3.15); p = alpha, beta, gamma, n, k1, k2, k3, lambda."""
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, z[j])
    return math.exp(p[i + 7] * x) * (z[j] + polynomial(p[i + 4], p[i + 5], p[i + 6], x))


@njit
def symmetric_bouc_wen(p, i, x, v, z, j, zdot, k):
    """Return F = z + F1(x) [N], Ni's law for shear and roll; p = alpha, beta, gamma, n, k1, k2, k3."""
    zdot[k] = bouc_wen_rate(p[i], p[i + 1], p[i + 2], p[i + 3], v, z[j])
    return z[j] + polynomial(p[i + 4], p[i + 5], p[i + 6], x)


@njit
def kelvin_voigt(p, i, x, v, z, j, zdot, k):
    """Return F = k x + c v [N]; p = k, c."""
    return p[i] * x + p[i + 1] * v


@njit
def evaluate(law, p, i, x, v, z, j, zdot, k):
    """Return the force [N] of the law with this number and write the rates of its states."""
    if law == ASYMMETRIC_BOUC_WEN:
        return asymmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == SYMMETRIC_BOUC_WEN:
        return symmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == BOUC_WEN:
        return bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == KELVIN_VOIGT:
        return kelvin_voigt(p, i, x, v, z, j, zdot, k)
    return np.nan
