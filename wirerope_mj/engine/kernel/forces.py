"""Forces of the mounts on the links, and the rates of their states: the same laws that the callback evaluates."""

from wirerope_mj.engine.control.mounts import AXIAL
from wirerope_mj.engine.control.rotation import righting
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.links import carried
from wirerope_mj.engine.kernel.vectors import (
    cross,
    dot,
    grow,
    keep,
    minus,
    plus,
    product,
    quaternion,
    times,
    turned,
    vector,
)
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.mounts.laws.kernels import evaluate
from wirerope_mj.mounts.laws.plane_kernels import biaxial_rates, loop_force


@inlined
def axes_of(lay, m, fix, work):
    """Return the axes of the mount in row `m`, world frame."""
    f, link = lay[m + at.AXES_IN], lay[m + at.BASE_LINK]
    x, y, z = vector(fix, f), vector(fix, f + 3), vector(fix, f + 6)
    if lay[lay[at.LINKS] + at.LINK_COLUMNS * link + at.KIND] != at.STRAIGHT:
        r = lay[at.KIN] + at.KIN_SIZE * link + at.KIN_R
        x, y, z = turned(work, r, x), turned(work, r, y), turned(work, r, z)
    return x, y, z


@njit
def couple_axes(lay, m, axis, num, y, work, record, rates, axes):
    """Give roll and another axis of the mount in row `m` one hysteretic force: its rates replace those of the axes.

    Returns what the elastic energy of a loop adds to the mount's force [N], in its axes.
    """
    first, other, z = lay[at.PARAMETERS] + lay[m + at.COUPLING], lay[m + at.PARTNER], lay[at.NQ] + lay[at.NV]
    j, k = lay[axis + 2], lay[axis + 2 + at.AXIS_COLUMNS * other]
    roll, along = work[record + 6], work[record + 6 + other]
    biaxial_rates(num, first, roll, along, y, z + j, z + k, work, rates + j, rates + k)
    if other != AXIAL:
        return 0.0 * roll, 0.0 * roll
    fu, fw = loop_force(num, first + 6, work[record], work[record + AXIAL])
    work[record + 3] += fu
    work[record + 3 + AXIAL] += fw
    return fu, fw


@njit
def orientation(lay, link, f, fix, work):
    """Return the orientation in the world of what has that at `fix[f:]` in a link."""
    return product(quaternion(work, lay[at.KIN] + at.KIN_SIZE * link + at.KIN_Q), quaternion(fix, f))


@njit
def add_torque(lay, m, fix, num, work, axes):
    """Add the torques of the mount in row `m`, which resists turning, to the wrenches on its links."""
    f, p, payload, base = lay[m + at.AXES_IN], lay[m + at.POINTS], lay[m + at.PAYLOAD], lay[m + at.BASE_LINK]
    b, s = orientation(lay, base, f + 9, fix, work), orientation(lay, payload, f + 13, fix, work)
    e = product((b[0], -b[1], -b[2], -b[3]), s)
    e = product(e, (fix[f + 17], -fix[f + 18], -fix[f + 19], -fix[f + 20]))
    t = righting(e[0], e[1], e[2], e[3], num[p + 6], num[p + 7], num[p + 8])
    x, y, z = axes
    torque = plus(plus(times(t[0], x), times(t[1], y)), times(t[2], z))
    grow(work, lay[at.WRENCH] + 6 * payload + 3, torque)
    if lay[m + at.MOVED]:
        grow(work, lay[at.WRENCH] + 6 * base + 3, times(-1.0, torque))


@inlined
def apply_mounts(lay, fix, num, y, work):
    """Write every mount's deflection, force and rate to RECORD, state rates to RATES, and wrenches on links to WRENCH.

    A wrench is force and torque about the link's origin, world axes.
    """
    n_mounts, wrench, record, rates = lay[at.N_MOUNTS], lay[at.WRENCH], lay[at.RECORD], lay[at.RATES]
    z, parameters = lay[at.NQ] + lay[at.NV], lay[at.PARAMETERS]
    for c in range(6 * lay[at.N_LINKS]):
        work[wrench + c] = 0.0
    m, axis = lay[at.MOUNTS], lay[at.AXES]
    for _ in range(n_mounts):
        payload, base, p = lay[m + at.PAYLOAD], lay[m + at.BASE_LINK], lay[m + at.POINTS]
        k = lay[at.KIN] + at.KIN_SIZE * payload
        arm = turned(work, k + at.KIN_R, vector(num, p))
        site = plus(vector(work, k + at.KIN_O), arm)
        velocity = carried(arm, vector(work, k + at.KIN_W), vector(work, k + at.KIN_V))
        b = lay[at.KIN] + at.KIN_SIZE * base
        reach = minus(site, vector(work, b + at.KIN_O))
        velocity = minus(velocity, carried(reach, vector(work, b + at.KIN_W), vector(work, b + at.KIN_V)))
        d = minus(reach, turned(work, b + at.KIN_R, vector(num, p + 3)))
        axes = axes_of(lay, m, fix, work)
        keep(work, record, (dot(axes[0], d), dot(axes[1], d), dot(axes[2], d)))
        keep(work, record + 6, (dot(axes[0], velocity), dot(axes[1], velocity), dot(axes[2], velocity)))
        first = axis
        for c in range(3):
            law, force = lay[axis], 0.0 * d[0]
            if law >= 0:
                state = lay[axis + 2]
                force = evaluate(
                    law, num, parameters + lay[axis + 1], work[record + c], work[record + 6 + c], y, z + state, work,
                    rates + state,
                )  # fmt: skip
            work[record + 3 + c] = force
            axis += at.AXIS_COLUMNS
        if lay[m + at.COUPLING] >= 0:
            couple_axes(lay, m, first, num, y, work, record, rates, axes)
        f = vector(work, record + 3)
        force = plus(plus(times(f[0], axes[0]), times(f[1], axes[1])), times(f[2], axes[2]))
        grow(work, wrench + 6 * payload, times(-1.0, force))
        grow(work, wrench + 6 * payload + 3, cross(force, arm))
        if lay[m + at.MOVED]:
            grow(work, wrench + 6 * base, force)
            grow(work, wrench + 6 * base + 3, cross(reach, force))
        if lay[m + at.RESISTS]:
            add_torque(lay, m, fix, num, work, axes)
        record += 9
        m += at.MOUNT_COLUMNS
