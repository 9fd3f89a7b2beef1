"""The restoring-force laws as scalar kernels, one source for the native and the Python callback, traces and statics.

Every kernel has the same signature

    force = kernel(p, i, x, v, z, j, zdot, k)

with the parameters in `p[i:]`, deflection `x` [m], deflection rate `v` [m/s] and internal states in `z[j:]`; it writes the
states' rates to `zdot[k:]` and returns the force [N]. With JIT disabled the kernels are plain Python.
"""

import math

import numpy as np

from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.mounts.laws.stop_kernels import stop
from wirerope_mj.mounts.laws.table_kernels import tabulated

BOUC_WEN = 0
ASYMMETRIC_BOUC_WEN = 1
SYMMETRIC_BOUC_WEN = 2
KELVIN_VOIGT = 3
ZENER = 4
TINKER_CUTCHINS = 5
MASING = 6
VAIANA_ROSATI = 7
BABER_NOORI = 8
BIAXIAL = 9
SMOOTHED = 10
LOOP = 11
TABULATED = 12
STOP = 13
PARALLEL = 14

WORN_OUT = 1e-3
"""Share of its first stiffness that a worn law keeps: at none, z would vanish over no distance if n < 1."""


@inlined
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


@inlined
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
def zener(p, i, x, v, z, j, zdot, k):
    """Return F = k0 x + z [N] with zdot = k1 v - r z; p = k0, k1, r = k1 / c."""
    zdot[k] = p[i + 1] * v - p[i + 2] * z[j]
    return p[i] * x + z[j]


@njit
def tinker_cutchins(p, i, x, v, z, j, zdot, k):
    """Return k1 x + k2 x^2 + k3 x^3 + c |v|^n sgn(v) + Fc(x) tanh(v/s) [N]; p = k1, k2, k3, c, n, f0, f1, f2, s."""
    n, s = p[i + 4], p[i + 8]
    if n == 1.0:
        damping = p[i + 3] * v
    elif n > 1.0:
        damping = p[i + 3] * abs(v) ** (n - 1.0) * v
    else:  # |v|^n has an infinite slope at rest: smoothed over the same velocity as the friction
        damping = p[i + 3] * (v * v + s * s) ** (0.5 * (n - 1.0)) * v
    friction = (p[i + 5] + p[i + 6] * abs(x) + p[i + 7] * x * x) * math.tanh(v / s)
    return x * (p[i] + x * (p[i + 1] + x * p[i + 2])) + damping + friction


@njit
def masing(p, i, x, v, z, j, zdot, k):
    """Return F = k x + sum of z_e clipped to +-h_e [N]; p = k, number of elements, stiffnesses c_e, slip forces h_e.

    The states grow elastically, beyond h_e too; who integrates them removes the overshoot after every step.
    """
    n = int(p[i + 1])
    force = p[i] * x
    for e in range(n):
        slip = p[i + 2 + n + e]
        zdot[k + e] = p[i + 2 + e] * v
        force += min(max(z[j + e], -slip), slip)
    return force


@njit
def hold_slip(p, i, z, j):
    """Clip the states of Masing's law to the slip forces, in place."""
    n = int(p[i + 1])
    for e in range(n):
        slip = p[i + 2 + n + e]
        z[j + e] = min(max(z[j + e], -slip), slip)


@njit
def limit_curve(p, i, x):
    """Return fe(x) + kb x [N] and its slope; p = kb, f0, alpha, b1, b2, g1, g2, g3."""
    growth = p[i + 3] * math.expm1(p[i + 4] * x)
    bend = math.tanh(0.5 * p[i + 6] * (x - p[i + 7]))
    force = growth + 2.0 * p[i + 5] * bend + p[i] * x
    return force, p[i + 4] * (growth + p[i + 3]) + p[i + 5] * p[i + 6] * (1.0 - bend * bend) + p[i]


@njit
def vaiana_rosati(p, i, x, v, z, j, zdot, k):
    """Return F = m(x) - m(0) + z [N], m the mean of the upper and the lower limit curve, half of 2 h apart.

    p = the eight parameters for v > 0, the eight for v < 0, m(0). dz/dx = h' + alpha (h - z) upwards, -h' + alpha (h + z)
    downwards.
    """
    upper, upper_slope = limit_curve(p, i, x)
    lower, lower_slope = limit_curve(p, i + 8, x)
    upper, lower = upper + p[i + 1], lower - p[i + 9]
    half, half_slope = 0.5 * (upper - lower), 0.5 * (upper_slope - lower_slope)
    if v >= 0.0:
        zdot[k] = (half_slope + p[i + 2] * (half - z[j])) * v
    else:
        zdot[k] = (-half_slope + p[i + 10] * (half + z[j])) * v
    return 0.5 * (upper + lower) - p[i + 16] + z[j]


@njit
def baber_noori(p, i, x, v, z, j, zdot, k):
    """Return F = k x + z [N] with wear and pinching; states z and its work e [J].

    p = alpha, beta, gamma, n, k, delta_alpha, delta_nu, delta_eta, zeta, q, p, psi, delta_psi, lam.
    """
    force, e = z[j], z[j + 1]
    alpha = max(p[i] - p[i + 5] * e, WORN_OUT * p[i])
    nu, eta = 1.0 + p[i + 6] * e, 1.0 + p[i + 7] * e
    beta, gamma, n = nu * p[i + 1], nu * p[i + 2], p[i + 3]
    slip = p[i + 8] * -math.expm1(-p[i + 10] * e)
    pinch = 1.0
    if slip > 0.0 and v != 0.0:
        bound = (alpha / (beta + gamma)) ** (1.0 / n)
        width = (p[i + 11] + p[i + 12] * e) * (p[i + 13] + slip)
        distance = ((force if v > 0.0 else -force) - p[i + 9] * bound) / width
        pinch = 1.0 - slip * math.exp(-distance * distance)
    zdot[k] = pinch / eta * bouc_wen_rate(alpha, beta, gamma, n, v, force)
    zdot[k + 1] = force * v
    return p[i + 4] * x + force


@njit
def hold_slips(law, p, i, z, j):
    """Do the same for each of Masing's laws among several in parallel, or the only one."""
    if law == MASING:
        hold_slip(p, i, z, j)
    elif law == PARALLEL:
        for part in range(int(p[i])):
            row = i + 1 + 3 * part
            if p[row] == MASING:
                hold_slip(p, i + int(p[row + 1]), z, j + int(p[row + 2]))


@njit
def smoothable(law, p, i, x, v, z, j, zdot, k):
    """Do what `evaluate` does for the laws with one state whose rate is a slope for v > 0 and another for v < 0, times v."""
    if law == BOUC_WEN:
        return bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == SYMMETRIC_BOUC_WEN:
        return symmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == ASYMMETRIC_BOUC_WEN:
        return asymmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == STOP:
        return stop(p, i, x, v, z, j, zdot, k)
    if law == TABULATED:
        return tabulated(p, i, x, v, z, j, zdot, k)
    return vaiana_rosati(p, i, x, v, z, j, zdot, k)


@njit
def smoothed(p, i, x, v, z, j, zdot, k):
    """Return the force of a law whose two slopes blend over a velocity: zdot = v [s+ (1 + t) + s- (1 - t)] / 2, t = tanh(v/e).

    p = e, number of the law, its parameters; s+ and s- are its slopes dz/dx for v > 0 and v < 0.
    """
    law = int(p[i + 1])
    smoothable(law, p, i + 2, x, 1.0, z, j, zdot, k)
    up = zdot[k]
    force = smoothable(law, p, i + 2, x, -1.0, z, j, zdot, k)
    down, half = -zdot[k], 0.5 * math.tanh(v / p[i])
    zdot[k] = v * (up * (0.5 + half) + down * (0.5 - half))
    return force


@njit
def biaxial_rates(p, i, vx, vy, z, jx, jy, zdot, kx, ky):
    """Write the rates of two coupled hysteretic forces; p = sigma, n, bounds z_m (2), yield deflections x_y (2).

    The states are `z[jx]` and `z[jy]`, their rates `zdot[kx]` and `zdot[ky]`. With w = z / z_m and u = v / x_y:

        wdot = u - w |w|^(n-2) [sigma |u.w| + (1 - sigma) u.w]
    """
    sigma, n = p[i], p[i + 1]
    wx, wy = z[jx] / p[i + 2], z[jy] / p[i + 3]
    ux, uy = vx / p[i + 4], vy / p[i + 5]
    size = math.sqrt(wx * wx + wy * wy)
    if size > 0.0:
        wx, wy = wx / size, wy / size
        along = ux * wx + uy * wy
        pull = size**n * (sigma * abs(along) + (1.0 - sigma) * along)
        ux, uy = ux - pull * wx, uy - pull * wy
    zdot[kx], zdot[ky] = p[i + 2] * ux, p[i + 3] * uy


@njit
def biaxial(p, i, x, v, z, j, zdot, k):
    """Return the force along a straight line in the plane [N], x the distance from its start, two coupled states.

    p = those of `biaxial_rates`, k1, k2, k3 of both axes, start (2) and direction (2) of the line.
    """
    ex, ey = p[i + 14], p[i + 15]
    biaxial_rates(p, i, v * ex, v * ey, z, j, j + 1, zdot, k, k + 1)
    fx = z[j] + polynomial(p[i + 6], p[i + 7], p[i + 8], p[i + 12] + x * ex)
    fy = z[j + 1] + polynomial(p[i + 9], p[i + 10], p[i + 11], p[i + 13] + x * ey)
    return ex * fx + ey * fy


@inlined
def evaluate(law, p, i, x, v, z, j, zdot, k):
    """Return the force [N] of the law with this number and write the rates of its states."""
    if law <= KELVIN_VOIGT:
        return common(law, p, i, x, v, z, j, zdot, k)
    if law == PARALLEL:
        return parallel(p, i, x, v, z, j, zdot, k)
    return evaluate_rarer(law, p, i, x, v, z, j, zdot, k)


@njit
def parallel(p, i, x, v, z, j, zdot, k):
    """Return the sum of the forces of several laws [N].

    p = their number, for each of them its own number and where its parameters and its states begin, the parameters.
    """
    force = 0.0
    for part in range(int(p[i])):
        row = i + 1 + 3 * part
        state = int(p[row + 2])
        force += evaluate_one(int(p[row]), p, i + int(p[row + 1]), x, v, z, j + state, zdot, k + state)
    return force


@njit
def component(p, i, part, n_states):
    """Return number, first parameter, first state and number of states of one of several laws in parallel with n_states."""
    row = i + 1 + 3 * part
    after = int(p[row + 5]) if part + 1 < int(p[i]) else n_states
    return int(p[row]), i + int(p[row + 1]), int(p[row + 2]), after - int(p[row + 2])


@njit
def evaluate_one(law, p, i, x, v, z, j, zdot, k):
    """Do what `evaluate` does for every law but several in parallel."""
    if law <= KELVIN_VOIGT:
        return common(law, p, i, x, v, z, j, zdot, k)
    return evaluate_rarer(law, p, i, x, v, z, j, zdot, k)


@inlined
def common(law, p, i, x, v, z, j, zdot, k):
    """Do the same for the laws that most mounts have."""
    if law == ASYMMETRIC_BOUC_WEN:
        return asymmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == SYMMETRIC_BOUC_WEN:
        return symmetric_bouc_wen(p, i, x, v, z, j, zdot, k)
    if law == BOUC_WEN:
        return bouc_wen(p, i, x, v, z, j, zdot, k)
    return kelvin_voigt(p, i, x, v, z, j, zdot, k)


@njit
def evaluate_rarer(law, p, i, x, v, z, j, zdot, k):
    """Do the same for the laws that few mounts have: inlined, they would slow down the others."""
    if law == ZENER:
        return zener(p, i, x, v, z, j, zdot, k)
    if law == TINKER_CUTCHINS:
        return tinker_cutchins(p, i, x, v, z, j, zdot, k)
    if law == MASING:
        return masing(p, i, x, v, z, j, zdot, k)
    if law == VAIANA_ROSATI:
        return vaiana_rosati(p, i, x, v, z, j, zdot, k)
    if law == BABER_NOORI:
        return baber_noori(p, i, x, v, z, j, zdot, k)
    if law == BIAXIAL:
        return biaxial(p, i, x, v, z, j, zdot, k)
    if law == SMOOTHED:
        return smoothed(p, i, x, v, z, j, zdot, k)
    if law == STOP:
        return stop(p, i, x, v, z, j, zdot, k)
    if law == TABULATED:
        return tabulated(p, i, x, v, z, j, zdot, k)
    return np.nan
