"""Kernels of two coupled deflections: two hysteretic forces with one bound, and a rope loop's elastic energy between them."""

import math

from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import count, raised, where
from wirerope_mj.mounts.laws.hysteresis import FAR, OVERSHOOT
from wirerope_mj.mounts.laws.ni import polynomial

BIAXIAL = 9
LOOP = 11
RATE_NUMBERS = 6  # Parameters of `biaxial_rates`; of a law of several scales as many for each, one after another


@njit
def loop_force(p, i, u, w):
    """Return the forces dU/du and dU/dw [N] of the elastic energy between roll u and axial deflection w, `LoopCoupling`.

    p = roll, compression, tension, W, I, J, coefficients row by row.
    """
    cu, cw = min(max(u, -p[i]), p[i]), min(max(w, -p[i + 1]), p[i + 2])
    rows, columns = count(p, i + 4), count(p, i + 5)
    a, b = (cu / p[i]) * (cu / p[i]), cw / p[i + 3]
    # Horner's scheme in b within that in a, each with its derivative; the powers begin with the first.
    value_b, of_a, of_ab, value = 0.0, 0.0, 0.0, 0.0
    for row in range(rows - 1, -1, -1):
        q, q_b = 0.0, 0.0
        for column in range(columns - 1, -1, -1):
            q_b = q_b * b + q
            q = q * b + p[i + 6 + columns * row + column]
        q_b = q_b * b + q
        q = q * b
        of_a, of_ab = of_a * a + value, of_ab * a + value_b
        value, value_b = value * a + q, value_b * a + q_b
    of_a, of_ab = of_a * a + value, of_ab * a + value_b
    value_b = value_b * a
    slope = 2.0 * cu / (p[i] * p[i])
    cross = of_ab * slope / p[i + 3]
    return of_a * slope + cross * (w - cw), value_b / p[i + 3] + cross * (u - cu)


@njit
def loop_plane_force(p, i, u, w, zu, zw):
    """Return the forces of roll and axial [N] at the deflections u, w and hysteretic forces zu, zw; p as for `loop_plane`."""
    fu, fw = loop_force(p, i + 17, u, w)
    fu += zu + polynomial(p[i + 6], p[i + 7], p[i + 8], u)
    fw += math.exp(p[i + 16] * w) * (zw + polynomial(p[i + 9], p[i + 10], p[i + 11], w))
    return fu, fw


@njit
def loop_plane(p, i, x, v, z, j, zdot, k):
    """Return the force along a straight line in the plane of roll and axial [N], x the distance from its start.

    p = those of `biaxial`, lambda of the axial law's F2, those of `loop_force`.
    """
    ex, ey = p[i + 14], p[i + 15]
    biaxial_rates(p, i, v * ex, v * ey, z, j, j + 1, zdot, k, k + 1)
    fu, fw = loop_plane_force(p, i, p[i + 12] + x * ex, p[i + 13] + x * ey, z[j], z[j + 1])
    return ex * fu + ey * fw


@njit
def reached(p, i, z, jx, jy):
    """Return the direction of w, a unit vector or 0, and |w|^n of two coupled hysteretic forces, see `biaxial_rates`."""
    wx, wy = z[jx] / p[i + 2], z[jy] / p[i + 3]
    size = math.sqrt(wx * wx + wy * wy)
    length = where(size > 0.0, size, 1.0)
    reach = raised(size, p[i + 1])
    return wx / length, wy / length, where(reach > FAR, reach, min(reach, OVERSHOOT))


@njit
def biaxial_rates(p, i, vx, vy, z, jx, jy, zdot, kx, ky):
    """Write the rates of two coupled hysteretic forces; p = sigma, n, bounds z_m (2), yield deflections x_y (2).

    The states are `z[jx]` and `z[jy]`, their rates `zdot[kx]` and `zdot[ky]`. With w = z / z_m and u = v / x_y:

        wdot = u - w |w|^(n-2) [sigma |u.w| + (1 - sigma) u.w]

    From `OVERSHOOT` of the bound, where no solution is, up to `FAR`, |w|^n counts as that, as in `bouc_wen_rate`.
    """
    sigma = p[i]
    wx, wy, reach = reached(p, i, z, jx, jy)
    ux, uy = vx / p[i + 4], vy / p[i + 5]
    along = ux * wx + uy * wy
    pull = reach * (sigma * abs(along) + (1.0 - sigma) * along)
    zdot[kx], zdot[ky] = p[i + 2] * (ux - pull * wx), p[i + 3] * (uy - pull * wy)


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
