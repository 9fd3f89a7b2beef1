"""Internal states of the mounts carried on straight lines of their deflections, infinitely slowly.

Coupled axes go on straight lines in the plane of two deflections: with w = z / z_m and a line of the length S in deflections
over x_y, e its direction there and n across it, w = a e + b n follows

    a' = 1 - a^2 r^(n-2),    b' = -a b r^(n-2),    r = |w|

where it loads, a >= 0, and goes on doing so (`wirerope_mj.mounts.laws.plane_kernels.biaxial_rates`). There r grows, and the
only short length is r itself, so that the steps of a fifth-order method are known beforehand. For n = 2 there is a closed form,
a = tanh(s + artanh a_0), and straight ahead, b = 0, for n = 1. Lines that unload, and those near zero that would take many
steps, are left to the laws' own integration.
"""

import math

from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import WIDTH, lane, power, rows, some, table, where
from wirerope_mj.mounts.laws.path import advance
from wirerope_mj.mounts.laws.plane_kernels import (
    BIAXIAL,
    COMPLIANCES,
    ELASTIC,
    LOOP_COEFFICIENTS,
    LOOP_COLUMNS,
    LOOP_ROWS,
    ON_BRACKETS,
    RATE_NUMBERS,
    WITH_ANOTHER,
)
from wirerope_mj.mounts.laws.plane_kernels import LINE as LINE_ON_BRACKETS
from wirerope_mj.mounts.laws.registry import (
    ASYMMETRIC_BOUC_WEN,
    BOUC_WEN,
    PARALLEL,
    RATE_DEPENDENT,
    SYMMETRIC_BOUC_WEN,
    carry_exactly,
    component,
    has_closed_form,
)

NEVER = 1e300  # length after which a state comes to zero that never does [m]
# longest step over the length on which a state changes: 1e-11 of the state is left to the error of a whole line
STEP = 0.08
MAX_STEPS = 64.0  # steps from which on the adaptive integration of one lane is the cheaper one
# yield deflections, for n = 1, after which a state has come to its bound but for rounding and forgotten where it began
SATURATED = 60.0
LINE = 12  # index of a line's start and direction among the parameters of the biaxial kernel


@inlined
def first_power_state(alpha, b, y, length):
    """Return y after a length of y' = alpha - b y, b replaced by -b where y < 0 at the start."""
    b = where(y >= 0.0, b, -b)
    flat = b == 0.0
    grown = where(flat, length, -math.expm1(-b * length) / where(flat, 1.0, b))
    return y + (alpha - b * y) * grown


@inlined
def carry_first_power(p, i, x0, x1, z):
    """Return Bouc-Wen's state for n = 1 carried from deflection x0 to x1, in closed form."""
    s, length = where(x1 > x0, 1.0, -1.0), abs(x1 - x0)
    alpha, y = p[i], where(x1 > x0, z, -z)
    loading, unloading = p[i + 1] + p[i + 2], p[i + 2] - p[i + 1]
    back = y < 0.0
    stays, from_zero, rest, unloaded = back, y, length, y
    if some(back):
        flat = unloading == 0.0
        start = alpha + unloading * y
        over = 1.0 - unloading * y / start
        to_zero = where(flat, -y / alpha, math.log(where(over > 0.0, over, 1.0)) / where(flat, 1.0, unloading))
        to_zero = where(start > 0.0, to_zero, NEVER)
        stays = back & (to_zero >= length)
        unloaded = first_power_state(alpha, unloading, where(stays, y, 0.0), length)
        rest = where(stays, 0.0, where(back, length - to_zero, length))
        from_zero = where(back, 0.0, y)
    loaded = first_power_state(alpha, loading, from_zero, rest)
    return s * where(stays, unloaded, loaded)


@njit
def carry_law(law, p, x0, x1, z, n_states, slopes, trial):
    """Carry the states of a law, or of laws in parallel, in place from deflection x0 to x1, in closed form if there is one."""
    for part in range(int(p[0]) if law == PARALLEL else 1):
        one, first, state, count = law, 0, 0, n_states
        if law == PARALLEL:
            one, first, state, count = component(p, 0, part, n_states)
        if one in RATE_DEPENDENT:  # infinitely slow: their states stay at zero
            continue
        if x0 != x1 and has_closed_form(one, p, first):
            carry_exactly(one, p, first, x0, x1, z, state)
        else:
            advance(one, p, first, x0, x1, z, state, count, slopes, trial)


@njit
def carry_axis(law, numbers, number, first, size, x0, x1, states, carried, state, n_states, target, scratch):
    """Carry the states of one mount axis in one lane from deflection x0 to x1."""
    p, slopes, trial, z = scratch[0], scratch[1], scratch[2], scratch[3]
    for i in range(size):
        p[i] = numbers[first + i, number]
    for k in range(n_states):
        z[k] = carried[state + k, number]
    carry_law(law, p, x0, x1, z, n_states, slopes, trial)
    for k in range(n_states):
        states[target + k, number] = z[k]


@njit
def carry_states(structure, numbers, states, memory, before, carried, follows, sizes, scratch):
    """Carry the states of all lanes from deflections `before`, (3 n_mounts, WIDTH), and states `carried` to those in RECORD.

    Other arguments are those of `wirerope_mj.engine.kernel.rest.settle`, and four rows of scratch numbers: for one lane's
    parameters, its states, and what `advance` needs.
    """
    lay, num, y, work = table(structure), rows(numbers), rows(states), rows(memory)
    start, z0 = rows(before), rows(carried)
    axis, record = lay[at.AXES], lay[at.RECORD]
    first_state = lay[at.NQ] + lay[at.NV]
    for k in range(follows.size):
        law, p = lay[axis + at.LAW], lay[at.PARAMETERS] + lay[axis + at.FIRST_PARAMETER]
        state, n_states = lay[axis + at.FIRST_STATE], lay[axis + at.LAW_STATES]
        here = record + at.RECORD_SIZE * (k // 3) + k % 3
        axis += at.AXIS_COLUMNS
        if not follows[k]:
            continue
        power = law in (BOUC_WEN, SYMMETRIC_BOUC_WEN, ASYMMETRIC_BOUC_WEN)
        if power:
            y[first_state + state] = carry_first_power(num, p, start[k], work[here], z0[state])
            if not some(num[p + 3] != 1.0):
                continue
        for number in range(WIDTH):
            if not power or numbers[p + 3, number] != 1.0:
                x0, x1 = before[k, number], memory[here, number]
                carry_axis(
                    law, numbers, number, p, sizes[k], x0, x1, states, carried, state, n_states, first_state + state,
                    scratch,
                )  # fmt: skip


@inlined
def slopes(a, b, n):
    """Return the slopes a' and b' of the state along and across a line on which it loads."""
    square = max(a * a + b * b, 1e-300)
    bend = power(math.sqrt(square), n) / square * a
    return 1.0 - bend * a, -bend * b


@inlined
def step_ahead(a, b, n, h):
    """Return the state a along and b across a line after a step `h` of it, by Dormand and Prince's method."""
    a1, b1 = slopes(a, b, n)
    a2, b2 = slopes(a + h * (1 / 5 * a1), b + h * (1 / 5 * b1), n)
    a3, b3 = slopes(a + h * (3 / 40 * a1 + 9 / 40 * a2), b + h * (3 / 40 * b1 + 9 / 40 * b2), n)
    a4, b4 = slopes(a + h * (44 / 45 * a1 - 56 / 15 * a2 + 32 / 9 * a3), b + h * (44 / 45 * b1 - 56 / 15 * b2 + 32 / 9 * b3), n)
    a5, b5 = slopes(
        a + h * (19372 / 6561 * a1 - 25360 / 2187 * a2 + 64448 / 6561 * a3 - 212 / 729 * a4),
        b + h * (19372 / 6561 * b1 - 25360 / 2187 * b2 + 64448 / 6561 * b3 - 212 / 729 * b4),
        n,
    )
    a6, b6 = slopes(
        a + h * (9017 / 3168 * a1 - 355 / 33 * a2 + 46732 / 5247 * a3 + 49 / 176 * a4 - 5103 / 18656 * a5),
        b + h * (9017 / 3168 * b1 - 355 / 33 * b2 + 46732 / 5247 * b3 + 49 / 176 * b4 - 5103 / 18656 * b5),
        n,
    )
    return (
        a + h * (35 / 384 * a1 + 500 / 1113 * a3 + 125 / 192 * a4 - 2187 / 6784 * a5 + 11 / 84 * a6),
        b + h * (35 / 384 * b1 + 500 / 1113 * b3 + 125 / 192 * b4 - 2187 / 6784 * b5 + 11 / 84 * b6),
    )


@njit
def carry_lanes(num, p, dx, dy, y, j, k, zx, zy):
    """Write the states `zx`, `zy` carried over a line (dx, dy) to y[j] and y[k]; returns 1 for the lanes that are not done."""
    n, bx, by = num[p + 1], num[p + 2], num[p + 3]
    ux, uy, wx, wy = dx / num[p + 4], dy / num[p + 5], zx / bx, zy / by
    length = math.sqrt(ux * ux + uy * uy)
    moves = length > 0.0
    divisor = where(moves, length, 1.0)
    ex, ey = where(moves, ux / divisor, 1.0), uy / divisor
    a, b = wx * ex + wy * ey, wy * ex - wx * ey
    size = math.sqrt(wx * wx + wy * wy)
    ahead, square = (b == 0.0) & (n == 1.0) & (a >= 0.0), (n == 2.0) & (a >= 0.0)
    steps = -math.floor(-length * max(n, 1.0) / (STEP * max(min(1.0, 2.0 * size), 1e-9)))
    left = where(moves & (a >= 0.0) & (steps <= MAX_STEPS), steps, 0.0)
    late = moves & ((a < 0.0) | (steps > MAX_STEPS))
    not_done = where(ahead | square, 0.0, where(late, 1.0, 0.0))
    left = where(ahead | square, 0.0, left)
    straight = a + (1.0 - a) * -math.expm1(-length)
    h = length / max(left, 1.0)
    while some(left > 0.0):
        one, other = step_ahead(a, b, n, h)
        a, b = where(left > 0.0, one, a), where(left > 0.0, other, b)
        left = left - 1.0
    if some(square):  # tanh(s) = m / (2 - m) and 1 / cosh(s) = 2 exp(-s) / (2 - m)
        m = -math.expm1(-2.0 * length)
        below = 2.0 - m + m * a
        a, b = where(square, (m + (2.0 - m) * a) / below, a), where(square, 2.0 * math.exp(-length) * b / below, b)
    a = where(ahead, straight, a)
    y[j] = where(moves, bx * (a * ex - b * ey), zx)
    y[k] = where(moves, by * (a * ey + b * ex), zy)
    return not_done


@njit
def carry_line(numbers, number, first, dx, dy, states, j, k, zx, zy, scratch):
    """Carry two coupled states of one lane over a line by the laws' own integration."""
    p, slopes, trial, z = scratch[0], scratch[1], scratch[2], scratch[3]
    for i in range(RATE_NUMBERS):
        p[i] = numbers[first + i, number]
    for i in range(RATE_NUMBERS, LINE + 2):
        p[i] = 0.0  # of work, which is not needed; a line is the same wherever it begins
    length, ux, uy = math.sqrt(dx * dx + dy * dy), dx / p[4], dy / p[5]
    p[LINE + 2], p[LINE + 3] = dx / length, dy / length
    z[0], z[1] = zx, zy
    part = min(1.0, SATURATED / (min(p[1], 1.0) * math.sqrt(ux * ux + uy * uy)))
    advance(BIAXIAL, p, 0, 0.0, part * length, z, 0, 2, slopes, trial)
    states[j, number], states[k, number] = z[0], z[1]


@njit
def carry_on_brackets(numbers, number, first, n, line, states, first_state, carried, j, k, scratch):
    """Carry the n states of each of one lane's two axes on brackets over `line`: its start (2) and its extent (2) [m]."""
    p, slopes, trial, z = scratch[0], scratch[1], scratch[2], scratch[3]
    length = math.sqrt(line[2] * line[2] + line[3] * line[3])
    divisor = length if length > 0.0 else 1.0
    loop = first + RATE_NUMBERS * n
    coefficients = int(numbers[loop + LOOP_ROWS, number]) * int(numbers[loop + LOOP_COLUMNS, number])
    size = (RATE_NUMBERS + ELASTIC) * n + LOOP_COEFFICIENTS + coefficients + COMPLIANCES
    for i in range(size):
        p[LINE_ON_BRACKETS + i] = numbers[first + i, number]
    # as `on_brackets_along` reads them: number of scales, start and direction of the line
    p[0], p[1], p[2], p[3], p[4] = n, line[0], line[1], line[2] / divisor, line[3] / divisor
    for scale in range(n):
        z[scale], z[n + scale] = carried[j + scale, number], carried[k + scale, number]
    if length > 0.0:
        advance(ON_BRACKETS, p, 0, 0.0, length, z, 0, 2 * n, slopes, trial)
    for scale in range(n):
        states[first_state + j + scale, number], states[first_state + k + scale, number] = z[scale], z[n + scale]


@njit
def carry_coupled(structure, numbers, states, memory, before, carried, scratch):
    """Carry the states of all coupled axes; the arguments are those of `carry.carry_states`."""
    lay, num, y, work = table(structure), rows(numbers), rows(states), rows(memory)
    start, z0 = rows(before), rows(carried)
    m, axis, record, first_state = lay[at.MOUNTS], lay[at.AXES], lay[at.RECORD], lay[at.NQ] + lay[at.NV]
    for mount in range(lay[at.N_MOUNTS]):
        if lay[m + at.COUPLING] >= 0:
            p, other = lay[at.PARAMETERS] + lay[m + at.COUPLING], lay[m + at.PARTNER]
            j, k = lay[axis + at.FIRST_STATE], lay[axis + at.FIRST_STATE + at.AXIS_COLUMNS * other]
            dx, dy = work[record] - start[3 * mount], work[record + other] - start[3 * mount + other]
            n = lay[axis + at.LAW_STATES]
            if lay[axis + at.LAW] == WITH_ANOTHER:
                for number in range(WIDTH):
                    here, there = before[3 * mount, number], before[3 * mount + other, number]
                    line = (here, there, lane(dx, number), lane(dy, number))
                    carry_on_brackets(numbers, number, p, n, line, states, first_state, carried, j, k, scratch)
                n = 0
            for _ in range(n):
                late = carry_lanes(num, p, dx, dy, y, first_state + j, first_state + k, z0[j], z0[k])
                if some(late > 0.0):
                    for number in range(WIDTH):
                        if lane(late, number) > 0.0:
                            carry_line(
                                numbers, number, p, lane(dx, number), lane(dy, number), states, first_state + j,
                                first_state + k, carried[j, number], carried[k, number], scratch,
                            )  # fmt: skip
                p, j, k = p + RATE_NUMBERS, j + 1, k + 1
        m, axis, record = m + at.MOUNT_COLUMNS, axis + 3 * at.AXIS_COLUMNS, record + at.RECORD_SIZE
