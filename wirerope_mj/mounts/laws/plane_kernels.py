"""Kernels of two coupled deflections: two hysteretic forces with one bound, and a rope loop's elastic energy between them.

In series with brackets what stands between has two deflections of its own. With these deflections d, the mount's forces F(d, z)
while the hysteretic forces z are held, the deflections x of mount and brackets together, and the brackets' compliances
C = diag(1/K), 0 of an axis without one,

    d + C F(d, z) = x        ddot + C (dF/dd ddot + dF/dz zdot) = xdot

of which the first is solved by Newton's method. zdot is linear in ddot but for the sign of the work on each scale's hysteretic
forces (`biaxial_rates`), so that the second is solved by linear equations until these signs are those of its solution. Nothing
is added to the mount's states.
"""

import math

from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import count, raised, some, where
from wirerope_mj.mounts.laws.bouc_wen import FAR, OVERSHOOT
from wirerope_mj.mounts.laws.ni import polynomial

BIAXIAL = 9
LOOP = 11
RATE_NUMBERS = 6  # Parameters of `biaxial_rates`; of a law of several scales as many for each, one after another

LOOP_ROWS, LOOP_COLUMNS, LOOP_COEFFICIENTS = 4, 5, 6  # offsets among the parameters of `loop_force`
COMPLIANCES = 2  # of roll and the other axis' brackets, 0 without one [m/N]


@njit
def loop_force(p, i, u, w):
    """Return the forces dU/du and dU/dw [N] of the elastic energy between roll u and axial deflection w, `LoopCoupling`.

    p = roll, compression, tension, W, I, J, coefficients row by row.
    """
    cu, cw = min(max(u, -p[i]), p[i]), min(max(w, -p[i + 1]), p[i + 2])
    rows, columns = count(p, i + LOOP_ROWS), count(p, i + LOOP_COLUMNS)
    a, b = (cu / p[i]) * (cu / p[i]), cw / p[i + 3]
    # Horner's scheme in b within that in a, each with its derivative; the powers begin with the first.
    value_b, of_a, of_ab, value = 0.0, 0.0, 0.0, 0.0
    for row in range(rows - 1, -1, -1):
        q, q_b = 0.0, 0.0
        for column in range(columns - 1, -1, -1):
            q_b = q_b * b + q
            q = q * b + p[i + LOOP_COEFFICIENTS + columns * row + column]
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
def state_direction(p, i, z, jx, jy):
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
    wx, wy, reach = state_direction(p, i, z, jx, jy)
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


ON_BRACKETS = 18  # number of the kernel along a line
# in place of a law's number: the axis' force is found with that of the axis it is coupled to, both on brackets
WITH_ANOTHER = -2
LINE = 5  # parameters of the kernel along a line before those of a mount: number of scales, start (2), direction (2)
ELASTIC = 7  # of every scale: k1, k2, k3 of both axes, lambda of the other one's F2
# Step of central differences of forces [m]: rounding, and what the third derivative adds, are 1e-10 of a slope
_NUDGE = 1e-7
_FOUND = 1e-13  # of the deflections: a step that Newton's method, which is quadratic there, need not take
_STEPS = 40  # five are usual; a step that does not lead nearer is halved
# Of the deflections, left of the equation: a mount that buckles on a bracket softer than itself jumps, and there is no answer.
_LOST = 1e-6
_SIGNS = 8  # two are usual


@inlined
def compliances_index(p, i, n):
    """Return the index of the brackets' compliances, between the loop's energy and the elastic parameters of every scale."""
    loop = i + RATE_NUMBERS * n
    return loop + LOOP_COEFFICIENTS + count(p, loop + LOOP_ROWS) * count(p, loop + LOOP_COLUMNS)


@njit
def forces_at_states(p, i, n, u, w, z, j, k):
    """Return the forces [N] at the mount's own deflections u and w and hysteretic forces `z[j:]` and `z[k:]`."""
    e = compliances_index(p, i, n) + COMPLIANCES
    fu, fw = loop_force(p, i + RATE_NUMBERS * n, u, w)
    for scale in range(n):
        fu += z[j + scale] + polynomial(p[e], p[e + 1], p[e + 2], u)
        fw += math.exp(p[e + 6] * w) * (z[k + scale] + polynomial(p[e + 3], p[e + 4], p[e + 5], w))
        e += ELASTIC
    return fu, fw


@njit
def series_slopes(p, i, n, u, w, z, j, k):
    """Return the matrix 1 + C dF/dd at constant hysteretic forces, row by row (4), C the brackets' compliances."""
    b, each = compliances_index(p, i, n), 0.5 / _NUDGE
    (u1, w1), (u2, w2) = forces_at_states(p, i, n, u + _NUDGE, w, z, j, k), forces_at_states(p, i, n, u - _NUDGE, w, z, j, k)
    (u3, w3), (u4, w4) = forces_at_states(p, i, n, u, w + _NUDGE, z, j, k), forces_at_states(p, i, n, u, w - _NUDGE, z, j, k)
    roll, other = each * p[b], each * p[b + 1]
    return 1.0 + roll * (u1 - u2), roll * (u3 - u4), other * (w1 - w2), 1.0 + other * (w3 - w4)


@njit
def own_deflections(p, i, n, x, y, z, j, k):
    """Return the mount's own deflections u and w [m] of x and y of mount and brackets together, and 1 + C dF/dd there (4).

    NaN where there are none.
    """
    b = compliances_index(p, i, n)
    u, w, du, dw, left = x, y, 0.0 * x, 0.0 * y, 1e300 + 0.0 * x
    a = f = g = d = left
    for _ in range(_STEPS):
        tu, tw = u + du, w + dw
        fu, fw = forces_at_states(p, i, n, tu, tw, z, j, k)
        ru, rw = tu - x + p[b] * fu, tw - y + p[b + 1] * fw
        size = max(abs(ru), abs(rw))
        nearer = size < left
        ta, tf, tg, td = series_slopes(p, i, n, tu, tw, z, j, k)
        det = ta * td - tf * tg
        u, w, left = where(nearer, tu, u), where(nearer, tw, w), where(nearer, size, left)
        a, f, g, d = where(nearer, ta, a), where(nearer, tf, f), where(nearer, tg, g), where(nearer, td, d)
        du = where(nearer, (f * rw - d * ru) / det, 0.5 * du)
        dw = where(nearer, (g * ru - a * rw) / det, 0.5 * dw)
        if not some(abs(du) + abs(dw) > _FOUND * (abs(x) + abs(y) + abs(u) + abs(w))):
            break
    lost = left > _LOST * (abs(x) + abs(y))
    return where(lost, math.nan, u), where(lost, math.nan, w), a, f, g, d


@njit
def on_brackets(p, i, n, x, y, vx, vy, z, j, k, zdot, to_j, to_k):
    """Return the forces [N] of deflections x and y of mount and brackets, of rates vx and vy; write the rates of n scales.

    p = of every scale those of `biaxial_rates`, those of `loop_force`, 1/K of both axes [m/N], of every scale `ELASTIC`.
    """
    u, w, a, f, g, d = own_deflections(p, i, n, x, y, z, j, k)
    b, du, dw = compliances_index(p, i, n), vx, vy
    for _ in range(_SIGNS):
        auu, auw, awu, aww = a, f, g, d
        for scale in range(n):
            q = i + RATE_NUMBERS * scale
            wx, wy, reach = state_direction(p, q, z, j + scale, k + scale)
            along = du / p[q + 4] * wx + dw / p[q + 5] * wy
            reach = reach * (where(along < 0.0, -1.0, 1.0) * p[q] + (1.0 - p[q]))
            roll, other = p[b] * p[q + 2], p[b + 1] * p[q + 3] * math.exp(p[b + COMPLIANCES + ELASTIC * scale + 6] * w)
            auu, auw = auu + roll * (1.0 - reach * wx * wx) / p[q + 4], auw - roll * reach * wx * wy / p[q + 5]
            awu, aww = awu - other * reach * wx * wy / p[q + 4], aww + other * (1.0 - reach * wy * wy) / p[q + 5]
        det = auu * aww - auw * awu
        before_u, before_w = du, dw
        du, dw = (aww * vx - auw * vy) / det, (auu * vy - awu * vx) / det
        if not some(abs(du - before_u) + abs(dw - before_w) > 0.0):
            break
    for scale in range(n):
        biaxial_rates(p, i + RATE_NUMBERS * scale, du, dw, z, j + scale, k + scale, zdot, to_j + scale, to_k + scale)
    return forces_at_states(p, i, n, u, w, z, j, k)


@njit
def on_brackets_along(p, i, x, v, z, j, zdot, k):
    """Return the force along a straight line of deflections [N], x the distance from its start; first the states of roll.

    p = number of scales, start and direction of the line (2 each), those of `on_brackets`.
    """
    n, ex, ey = count(p, i), p[i + 3], p[i + 4]
    fu, fw = on_brackets(
        p, i + LINE, n, p[i + 1] + x * ex, p[i + 2] + x * ey, v * ex, v * ey, z, j, j + n, zdot, k, k + n
    )  # fmt: skip
    return ex * fu + ey * fw
