"""Motion of the links: origins, axes, velocities, and accelerations as far as they do not come from the coordinates' own."""

import math

from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.vectors import (
    cross,
    grow,
    keep,
    orient,
    plus,
    product,
    quaternion,
    times,
    turned,
    unit,
    vector,
)
from wirerope_mj.foundation.jit import inlined, njit


@inlined
def carried(r, w, v):
    """Return the velocity of a point r away from one with the velocity v on a body that turns with w."""
    return plus(v, cross(w, r))


@inlined
def swung(r, w, alpha, a):
    """Return the acceleration of a point r away from one with the acceleration a on a body that turns with w and alpha."""
    return plus(plus(a, cross(alpha, r)), cross(w, cross(w, r)))


@inlined
def place_straight(lay, row, k, over, fix, y, work):
    """Place a link that never turns: its axes, those of the model, stand in its rows already."""
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
    """Place a floating link: velocity in the world's axes, angular velocity in its own, neither with a bias."""
    first = lay[row + at.FIRST_DOF]
    q, v = lay[lay[at.DOFS] + at.DOF_COLUMNS * first + at.DOF_QPOS], lay[at.NQ] + first
    keep(work, k + at.KIN_O, vector(y, q))
    orient(work, k + at.KIN_Q, unit(quaternion(y, q + 3)), k + at.KIN_R)
    keep(work, k + at.KIN_V, vector(y, v))
    keep(work, k + at.KIN_W, turned(work, k + at.KIN_R, vector(y, v + 3)))


@njit
def place_turning(lay, row, k, over, fix, y, work):
    """Place a link with hinges, or on one that turns: one joint after the other, as MuJoCo does."""
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
        keep(work, k + at.KIN_V, carried(r, w, vector(work, over + at.KIN_V)))
        keep(work, k + at.KIN_L0, swung(r, w, alpha, vector(work, over + at.KIN_L0)))
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
            keep(work, k + at.KIN_V, plus(carried(e, w, v), times(rate, axis)))
            keep(work, k + at.KIN_L0, plus(swung(e, w, alpha, a), times(2.0 * rate, cross(w, axis))))
            continue
        b = turned(work, k + at.KIN_R, vector(fix, f + at.ANCHOR))
        c, vc, ac = plus(o, b), carried(b, w, v), swung(b, w, alpha, a)
        turn = math.cos(0.5 * x), math.sin(0.5 * x)
        q = product(quaternion(work, k + at.KIN_Q), (turn[0], turn[1] * own[0], turn[1] * own[1], turn[1] * own[2]))
        orient(work, k + at.KIN_Q, unit(q), k + at.KIN_R)
        alpha, w = plus(alpha, times(rate, cross(w, axis))), plus(w, times(rate, axis))
        b = times(-1.0, turned(work, k + at.KIN_R, vector(fix, f + at.ANCHOR)))
        keep(work, s + 6 * dof + 3, c)
        keep(work, k + at.KIN_W, w)
        keep(work, k + at.KIN_A0, alpha)
        keep(work, k + at.KIN_O, plus(c, b))
        keep(work, k + at.KIN_V, carried(b, w, vc))
        keep(work, k + at.KIN_L0, swung(b, w, alpha, ac))


@inlined
def place_links(lay, fix, y, work):
    """Write the motion of all links; what hangs on a link comes after it.

    Of a turning link's dofs the axes stand in `work[SUB:]`, a hinge's anchor behind its axis.
    """
    row, k = lay[at.LINKS], lay[at.KIN]
    for _ in range(lay[at.N_LINKS]):
        kind, over = lay[row + at.KIND], lay[at.KIN] + at.KIN_SIZE * lay[row + at.PARENT]
        if kind == at.FREE:
            place_free(lay, row, k, y, work)
        elif kind == at.STRAIGHT:
            place_straight(lay, row, k, over, fix, y, work)
        else:
            place_turning(lay, row, k, over, fix, y, work)
        row, k = row + at.LINK_COLUMNS, k + at.KIN_SIZE
