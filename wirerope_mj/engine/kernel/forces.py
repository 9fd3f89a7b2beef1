"""Forces of the mounts on the links, and the rates of their states: the same laws that the callback evaluates."""

from wirerope_mj.engine.control.mounts import AXIAL, coupled_forces, righting_torque
from wirerope_mj.engine.control.vectors import (
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
    turned_back,
    vector,
)
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.mounts.laws.registry import evaluate


@njit
def couple_axes(lay, m, axis, num, y, work, record):
    """Couple roll and its partner axis of the mount in row `m`: write the rates of their hysteretic states anew, add forces."""
    rates, z = lay[at.RATES], lay[at.NQ] + lay[at.NV]
    first, other = lay[at.PARAMETERS] + lay[m + at.COUPLING], lay[m + at.PARTNER]
    j, k = lay[axis + at.FIRST_STATE], lay[axis + at.FIRST_STATE + at.AXIS_COLUMNS * other]
    fu, fw = coupled_forces(
        lay[axis + at.LAW], other == AXIAL, num, first, lay[axis + at.LAW_STATES], work[record], work[record + other],
        work[record + at.RATE], work[record + at.RATE + other], y, z + j, z + k, work, rates + j, rates + k,
    )  # fmt: skip
    work[record + at.FORCE] += fu
    work[record + at.FORCE + other] += fw


@njit
def orientation(lay, link, f, fix, work):
    """Return the orientation in the world of a frame whose orientation in a link is `fix[f:]`."""
    return product(quaternion(work, lay[at.KIN] + at.KIN_SIZE * link + at.KIN_Q), quaternion(fix, f))


@njit
def add_torque(lay, m, payload, base, fix, num, work):
    """Add the torques of the mount in row `m`, which resists turning, to the wrenches on its links."""
    f, p = lay[m + at.AXES_IN], lay[m + at.POINTS]
    b, s = orientation(lay, base, f + at.BASE_TURN, fix, work), orientation(lay, payload, f + at.PAYLOAD_TURN, fix, work)
    t = righting_torque(b, s, quaternion(fix, f + at.AS_MODELLED), vector(num, p + at.RESISTING))
    torque = plus(plus(times(t[0], vector(fix, f)), times(t[1], vector(fix, f + 3))), times(t[2], vector(fix, f + 6)))
    if lay[lay[at.LINKS] + at.LINK_COLUMNS * base + at.KIND] != at.STRAIGHT:
        torque = turned(work, lay[at.KIN] + at.KIN_SIZE * base + at.KIN_R, torque)
    grow(work, lay[at.WRENCH] + 6 * payload + 3, torque)
    if lay[m + at.MOVED]:
        grow(work, lay[at.WRENCH] + 6 * base + 3, times(-1.0, torque))


@njit
def elastic_motion(lay, k, fix, values, first, column):
    """Return a point's elastic motion in its axes: shapes times modal coordinates (column 1), or rates or accelerations (0)."""
    x = times(0.0, (values[first], values[first], values[first]))
    for mode in range(lay[k]):
        row = k + 1 + at.SHAPE_COLUMNS * mode
        x = plus(x, times(values[first + lay[row + column]], vector(fix, lay[row + at.SHAPE])))
    return x


@njit
def elastic_motion_with_rate(lay, k, fix, y):
    """Return elastic displacement and velocity of a point of a flexible part, in its axes, in one pass over the shapes."""
    x = v = times(0.0, (y[0], y[0], y[0]))
    for mode in range(lay[k]):
        row = k + 1 + at.SHAPE_COLUMNS * mode
        shape = vector(fix, lay[row + at.SHAPE])
        x, v = plus(x, times(y[lay[row + 1]], shape)), plus(v, times(y[lay[at.NQ] + lay[row]], shape))
    return x, v


@njit
def push_modes(lay, k, fix, work, force):
    """Add the modal forces of a force at a point of a flexible part, in the point's axes, to the right sides of its modes."""
    for mode in range(lay[k]):
        row = k + 1 + at.SHAPE_COLUMNS * mode
        work[lay[at.RHS] + lay[row]] += dot(vector(fix, lay[row + at.SHAPE]), force)


@inlined
def push_base(lay, fix, work, base):
    """Begin the right sides of the modes with the base's: minus participation factors times its acceleration."""
    row = lay[at.MODES]
    for _ in range(lay[at.N_MODES]):
        work[lay[at.RHS] + lay[row]] = -1.0 * dot(vector(fix, lay[row + 1]), base)
        row += at.MODE_COLUMNS


@njit
def push_loads(lay, fix, num, work):
    """Add the forces and moments at sites, which stand in LOADS along the sites' axes, to the wrenches on their links."""
    row, load = lay[at.FORCES], lay[at.LOADS]
    for _ in range(lay[at.N_FORCES]):
        link, p, f = lay[row + at.FORCE_LINK], lay[row + at.FORCE_POINT], lay[row + at.FORCE_AXES]
        axes, arm = (vector(fix, f), vector(fix, f + 3), vector(fix, f + 6)), vector(num, p)
        force = torque = times(0.0, arm)
        for c in range(3):
            force, torque = plus(force, times(work[load + c], axes[c])), plus(torque, times(work[load + 3 + c], axes[c]))
        if lay[row + at.FORCE_SHAPES]:
            push_modes(lay, lay[row + at.FORCE_SHAPES], fix, work, force)
        if lay[lay[at.LINKS] + at.LINK_COLUMNS * link + at.KIND] != at.STRAIGHT:
            r = lay[at.KIN] + at.KIN_SIZE * link + at.KIN_R
            arm, force, torque = turned(work, r, arm), turned(work, r, force), turned(work, r, torque)
        grow(work, lay[at.WRENCH] + 6 * link, force)
        grow(work, lay[at.WRENCH] + 6 * link + 3, plus(torque, cross(arm, force)))
        row, load = row + at.FORCE_COLUMNS, load + 6


@inlined
def deflect(lay, fix, num, y, work):
    """Write every mount's deflection and its rate, in its axes, and its arm on the payload's link, to RECORD."""
    run, m, record = lay[at.RUNS], lay[at.MOUNTS], lay[at.RECORD]
    for _ in range(lay[at.N_RUNS]):
        k, b = lay[at.KIN] + at.KIN_SIZE * lay[run + at.RUN_PAYLOAD], lay[at.KIN] + at.KIN_SIZE * lay[run + at.RUN_BASE]
        straight = lay[lay[at.LINKS] + at.LINK_COLUMNS * lay[run + at.RUN_BASE] + at.KIND] == at.STRAIGHT
        turns = lay[lay[at.LINKS] + at.LINK_COLUMNS * lay[run + at.RUN_PAYLOAD] + at.KIND] != at.STRAIGHT
        apart = minus(vector(work, k + at.KIN_O), vector(work, b + at.KIN_O))
        faster = minus(vector(work, k + at.KIN_V), vector(work, b + at.KIN_V))
        w = vector(work, k + at.KIN_W)
        for _ in range(lay[run + at.RUN_MOUNTS]):
            p, f, rate = lay[m + at.POINTS], lay[m + at.AXES_IN], faster
            arm = vector(num, p)  # on a link that never turns it is in the world's axes, as base points and axes are
            there = vector(num, p + at.ON_BASE)
            above, below = lay[m + at.BENT], lay[m + at.BENT_BASE]
            own = given = times(0.0, arm)
            if above:
                x, own = elastic_motion_with_rate(lay, above, fix, y)
                arm = plus(arm, x)
            if below:
                x, given = elastic_motion_with_rate(lay, below, fix, y)
                there = plus(there, x)
            if turns:
                arm = turned(work, k + at.KIN_R, arm)
                rate = plus(rate, cross(w, arm))
            if above:
                rate = plus(rate, turned(work, k + at.KIN_R, own) if turns else own)
            keep(work, record + at.ARM, arm)
            reach = plus(apart, arm)
            if straight:
                d = minus(reach, there)
            else:
                d = turned_back(work, b + at.KIN_R, minus(reach, turned(work, b + at.KIN_R, there)))
                rate = turned_back(work, b + at.KIN_R, minus(rate, cross(vector(work, b + at.KIN_W), reach)))
            if below:
                rate = minus(rate, given)
            if not lay[m + at.ALIGNED]:
                ex, ey, ez = vector(fix, f), vector(fix, f + 3), vector(fix, f + 6)
                d, rate = (dot(ex, d), dot(ey, d), dot(ez, d)), (dot(ex, rate), dot(ey, rate), dot(ez, rate))
            keep(work, record, d)
            keep(work, record + at.RATE, rate)
            record, m = record + at.RECORD_SIZE, m + at.MOUNT_COLUMNS
        run += at.RUN_COLUMNS


@inlined
def evaluate_laws(lay, num, y, work):
    """Write the force of every axis of every mount to RECORD, and the rates of its states to RATES."""
    axis, record, parameters = lay[at.AXES], lay[at.RECORD], lay[at.PARAMETERS]
    z, rates = lay[at.NQ] + lay[at.NV], lay[at.RATES]
    for _ in range(lay[at.N_MOUNTS]):
        for c in range(3):
            law, x = lay[axis + at.LAW], work[record + c]
            force = 0.0 * x
            if law >= 0:
                p, state = parameters + lay[axis + at.FIRST_PARAMETER], lay[axis + at.FIRST_STATE]
                force = evaluate(law, num, p, x, work[record + at.RATE + c], y, z + state, work, rates + state)
            work[record + at.FORCE + c] = force
            axis += at.AXIS_COLUMNS
        record += at.RECORD_SIZE


@inlined
def apply_mounts(lay, fix, num, y, work):
    """Write deflection, force, rate and arm of every mount to RECORD, state rates to RATES, wrenches on links to WRENCH.

    A wrench is force and torque about the link's origin, world axes. Mounts between the same two links follow each other in a
    run. Laws are called in a loop of their own, where no more than a deflection and its rate need be kept in registers.
    """
    deflect(lay, fix, num, y, work)
    evaluate_laws(lay, num, y, work)
    wrench, record = lay[at.WRENCH], lay[at.RECORD]
    for c in range(6 * lay[at.N_LINKS]):
        work[wrench + c] = 0.0
    run, m, axis = lay[at.RUNS], lay[at.MOUNTS], lay[at.AXES]
    for _ in range(lay[at.N_RUNS]):
        payload, base = lay[run + at.RUN_PAYLOAD], lay[run + at.RUN_BASE]
        k, b = lay[at.KIN] + at.KIN_SIZE * payload, lay[at.KIN] + at.KIN_SIZE * base
        straight = lay[lay[at.LINKS] + at.LINK_COLUMNS * base + at.KIND] == at.STRAIGHT
        total = times(0.0, vector(work, k + at.KIN_O))
        torque = total
        for _ in range(lay[run + at.RUN_MOUNTS]):
            if lay[m + at.COUPLING] >= 0:
                couple_axes(lay, m, axis, num, y, work, record)
            f, force, arm = lay[m + at.AXES_IN], vector(work, record + at.FORCE), vector(work, record + at.ARM)
            if not lay[m + at.ALIGNED]:
                force = plus(
                    plus(times(force[0], vector(fix, f)), times(force[1], vector(fix, f + 3))),
                    times(force[2], vector(fix, f + 6)),
                )
            if lay[m + at.BENT_BASE]:
                push_modes(lay, lay[m + at.BENT_BASE], fix, work, force)
            if not straight:
                force = turned(work, b + at.KIN_R, force)
            if lay[m + at.BENT]:
                own = force
                if lay[lay[at.LINKS] + at.LINK_COLUMNS * payload + at.KIND] != at.STRAIGHT:
                    own = turned_back(work, k + at.KIN_R, force)
                push_modes(lay, lay[m + at.BENT], fix, work, times(-1.0, own))
            total, torque = plus(total, force), plus(torque, cross(arm, force))
            if lay[m + at.MOVED]:
                reach = plus(arm, minus(vector(work, k + at.KIN_O), vector(work, b + at.KIN_O)))
                grow(work, wrench + 6 * base, force)
                grow(work, wrench + 6 * base + 3, cross(reach, force))
            if lay[m + at.RESISTS]:
                add_torque(lay, m, payload, base, fix, num, work)
            record, m, axis = record + at.RECORD_SIZE, m + at.MOUNT_COLUMNS, axis + 3 * at.AXIS_COLUMNS
        grow(work, wrench + 6 * payload, times(-1.0, total))
        grow(work, wrench + 6 * payload + 3, times(-1.0, torque))
        run += at.RUN_COLUMNS
