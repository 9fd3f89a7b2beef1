"""Motion of the links: origins, axes, velocities, and accelerations as far as they do not come from the coordinates' own."""

import math

from wirerope_mj.engine.control.vectors import (
    acceleration_at,
    cross,
    dot,
    grow,
    keep,
    plus,
    product,
    quaternion,
    times,
    turned,
    unit,
    vector,
    velocity_at,
)
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.foundation.jit import inlined, njit


@inlined
def orient(kin, k, q, r):
    """Write a unit quaternion and its matrix to kin[k:] and kin[r:]."""
    w, x, y, z = q
    kin[k], kin[k + 1], kin[k + 2], kin[k + 3] = w, x, y, z
    kin[r], kin[r + 1], kin[r + 2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    kin[r + 3], kin[r + 4], kin[r + 5] = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    kin[r + 6], kin[r + 7], kin[r + 8] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)


@inlined
def half_turn(s):
    """Return cos(t / 2) and sin(t / 2) / t of the square s of an angle t <= 2: their series to 1e-17."""
    h = 0.25 * s
    c = 1 / 40320.0 - h * (1 / 3628800.0 - h * (1 / 479001600.0 - h * (1 / 87178291200.0 - h * (1 / 20922789888000.0))))
    c = 1.0 - h * (0.5 - h * (1 / 24.0 - h * (1 / 720.0 - h * c)))
    d = 1 / 362880.0 - h * (1 / 39916800.0 - h * (1 / 6227020800.0 - h * (1 / 1307674368000.0)))
    d = 1.0 - h * (1 / 6.0 - h * (1 / 120.0 - h * (1 / 5040.0 - h * d)))
    return c, 0.5 * d


@inlined
def turn_rate(u, w):
    """Return the rate of the rotation vector u whose angular velocity, in the turned axes, is w: dexp^-1.

    w + u x w / 2 + k u x (u x w), k = 1/t^2 - cot(t / 2) / (2 t) with t = |u| <= 1 by its series; `half_turn` and this make
    Runge and Kutta's method on orientations one of fourth order (Munthe-Kaas 1999), as MuJoCo's is.
    """
    s = dot(u, u)
    k = 1 / 30240.0 + s * (1 / 1209600.0 + s * (1 / 47900160.0 + s * (691 / 1307674368000.0 + s * (1 / 74724249600.0))))
    k = 1 / 12.0 + s * (1 / 720.0 + s * k)
    one = cross(u, w)
    return plus(plus(w, times(0.5, one)), times(k, cross(u, one)))


@inlined
def place_straight(lay, row, k, over, fix, y, work):
    """Write position and velocity of a link that never turns, whose axes, those of the model, are written beforehand."""
    nq, first, f = lay[at.NQ], lay[row + at.FIRST_DOF], lay[row + at.FRAME]
    o = vector(fix, f)
    v = (0.0, 0.0, 0.0)
    if lay[row + at.PARENT] >= 0:
        o, v = plus(o, vector(work, over + at.KIN_O)), vector(work, over + at.KIN_V)
    keep(work, k + at.KIN_O, o)
    keep(work, k + at.KIN_V, v)
    for dof in range(first, first + lay[row + at.DOFS_OF]):
        d = lay[at.DOFS] + at.DOF_COLUMNS * dof
        f = lay[d + at.DOF_FIX]
        axis = vector(fix, f + at.AXIS)
        grow(work, k + at.KIN_O, times(y[lay[d + at.DOF_QPOS]] - fix[f + at.ORIGIN], axis))
        grow(work, k + at.KIN_V, times(y[nq + dof], axis))


@inlined
def place_free(lay, row, k, y, work):
    """Write the motion of a floating link; its angular velocity is read in its own axes, its velocity in the world's."""
    first = lay[row + at.FIRST_DOF]
    q, v = lay[lay[at.DOFS] + at.DOF_COLUMNS * first + at.DOF_QPOS], lay[at.NQ] + first
    keep(work, k + at.KIN_O, vector(y, q))
    orient(work, k + at.KIN_Q, unit(quaternion(y, q + 3)), k + at.KIN_R)
    keep(work, k + at.KIN_V, vector(y, v))
    keep(work, k + at.KIN_W, turned(work, k + at.KIN_R, vector(y, v + 3)))


@njit
def place_turning(lay, row, k, over, fix, y, work):
    """Write the motion of a link that has hinges or stands on a turning link: joint after joint, as MuJoCo does."""
    nq, first, f, s = lay[at.NQ], lay[row + at.FIRST_DOF], lay[row + at.FRAME], lay[at.SUB]
    keep(work, k + at.KIN_O, vector(fix, f))
    orient(work, k + at.KIN_Q, quaternion(fix, f + 3), k + at.KIN_R)
    for c in range(at.KIN_W, at.KIN_A):
        work[k + c] = 0.0
    if lay[row + at.PARENT] >= 0:
        r = turned(work, over + at.KIN_R, vector(fix, f))
        w, alpha = vector(work, over + at.KIN_W), vector(work, over + at.KIN_A0)
        keep(work, k + at.KIN_O, plus(vector(work, over + at.KIN_O), r))
        q = product(quaternion(work, over + at.KIN_Q), quaternion(fix, f + 3))
        orient(work, k + at.KIN_Q, unit(q), k + at.KIN_R)
        keep(work, k + at.KIN_W, w)
        keep(work, k + at.KIN_A0, alpha)
        keep(work, k + at.KIN_V, velocity_at(r, w, vector(work, over + at.KIN_V)))
        keep(work, k + at.KIN_L0, acceleration_at(r, w, alpha, vector(work, over + at.KIN_L0)))
    for dof in range(first, first + lay[row + at.DOFS_OF]):
        d = lay[at.DOFS] + at.DOF_COLUMNS * dof
        f = lay[d + at.DOF_FIX]
        own = vector(fix, f + at.AXIS)
        axis, x, rate = turned(work, k + at.KIN_R, own), y[lay[d + at.DOF_QPOS]] - fix[f + at.ORIGIN], y[nq + dof]
        o, v, a = vector(work, k + at.KIN_O), vector(work, k + at.KIN_V), vector(work, k + at.KIN_L0)
        w, alpha = vector(work, k + at.KIN_W), vector(work, k + at.KIN_A0)
        keep(work, s + 6 * dof, axis)
        if lay[d + at.DOF_KIND] == at.SLIDE:
            e = times(x, axis)
            keep(work, k + at.KIN_O, plus(o, e))
            keep(work, k + at.KIN_V, plus(velocity_at(e, w, v), times(rate, axis)))
            keep(work, k + at.KIN_L0, plus(acceleration_at(e, w, alpha, a), times(2.0 * rate, cross(w, axis))))
            continue
        b = turned(work, k + at.KIN_R, vector(fix, f + at.ANCHOR))
        c, vc, ac = plus(o, b), velocity_at(b, w, v), acceleration_at(b, w, alpha, a)
        turn = math.cos(0.5 * x), math.sin(0.5 * x)
        q = product(quaternion(work, k + at.KIN_Q), (turn[0], turn[1] * own[0], turn[1] * own[1], turn[1] * own[2]))
        orient(work, k + at.KIN_Q, unit(q), k + at.KIN_R)
        alpha, w = plus(alpha, times(rate, cross(w, axis))), plus(w, times(rate, axis))
        b = times(-1.0, turned(work, k + at.KIN_R, vector(fix, f + at.ANCHOR)))
        keep(work, s + 6 * dof + 3, c)
        keep(work, k + at.KIN_W, w)
        keep(work, k + at.KIN_A0, alpha)
        keep(work, k + at.KIN_O, plus(c, b))
        keep(work, k + at.KIN_V, velocity_at(b, w, vc))
        keep(work, k + at.KIN_L0, acceleration_at(b, w, alpha, ac))


@inlined
def place_links(lay, fix, y, work):
    """Write the motion of all links, of which each comes after the link that carries it.

    Axes of a turning link's coordinates go to `work[SUB:]`, a hinge's anchor behind its axis.
    """
    row, k = lay[at.LINKS], lay[at.KIN]
    for _ in range(lay[at.N_LINKS]):
        kind, over = lay[row + at.KIND], lay[at.KIN] + at.KIN_SIZE * lay[row + at.PARENT]
        if kind == at.FREE:
            place_free(lay, row, k, y, work)
        elif kind == at.STRAIGHT:
            place_straight(lay, row, k, over, fix, y, work)
        elif kind != at.MODAL:
            place_turning(lay, row, k, over, fix, y, work)
        row, k = row + at.LINK_COLUMNS, k + at.KIN_SIZE
