"""Internal states of the mounts carried on straight lines of their deflections, infinitely slowly."""

import math

from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import WIDTH, rows, some, table, where
from wirerope_mj.mounts.laws.kernels import ASYMMETRIC_BOUC_WEN, BOUC_WEN, SYMMETRIC_BOUC_WEN
from wirerope_mj.mounts.laws.path import advance

NEVER = 1e300  # length after which a state comes to zero that never does [m]


@inlined
def along(alpha, b, y, length):
    """Return y after a length along y' = alpha - b y, or + b y where y < 0."""
    b = where(y >= 0.0, b, -b)
    flat = b == 0.0
    grown = where(flat, length, -math.expm1(-b * length) / where(flat, 1.0, b))
    return y + (alpha - b * y) * grown


@inlined
def carry_first_power(p, i, x0, x1, z):
    """Return Bouc-Wen's state for n = 1 carried from deflection x0 to x1, as `exact.carry_bouc_wen` does."""
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
        unloaded = along(alpha, unloading, where(stays, y, 0.0), length)
        rest = where(stays, 0.0, where(back, length - to_zero, length))
        from_zero = where(back, 0.0, y)
    loaded = along(alpha, loading, from_zero, rest)
    return s * where(stays, unloaded, loaded)


@njit
def carry_one(law, numbers, number, first, size, x0, x1, states, carried, state, n_states, target, scratch):
    """Carry the states of one lane's axis by the laws' own closed forms, series and integration."""
    p, slopes, trial, z = scratch[0], scratch[1], scratch[2], scratch[3]
    for i in range(size):
        p[i] = numbers[first + i, number]
    for k in range(n_states):
        z[k] = carried[state + k, number]
    advance(law, p, 0, x0, x1, z, 0, n_states, slopes, trial)
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
        law, p, state, n_states = lay[axis], lay[at.PARAMETERS] + lay[axis + 1], lay[axis + 2], lay[axis + 3]
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
                carry_one(
                    law, numbers, number, p, sizes[k], x0, x1, states, carried, state, n_states, first_state + state,
                    scratch,
                )  # fmt: skip
