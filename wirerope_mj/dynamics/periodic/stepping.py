"""Kernels of periodic motions: steps of a sine's periods, accelerations beside a motion, and the linear equation along it."""

import numpy as np

from wirerope_mj.engine.control.layout import MAX_STEPS
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.forces import deflect
from wirerope_mj.engine.kernel.links import place_links
from wirerope_mj.engine.kernel.observe import measure
from wirerope_mj.engine.kernel.steps import base_at, forward, mark_failures, place_base, shift, take_step
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import WIDTH, lane, rows, table
from wirerope_mj.mounts.laws.cubic import position, reversals
from wirerope_mj.mounts.laws.power import ORDER, carry_power


@njit
def step_periods(structure, shared, numbers, states, memory, positions, rates, motion, h, carried, lanes, track, values):
    """Step all lanes through the periods of the base's sine, which is the same in all of them.

    Args:
        structure: `lay` of the equations.
        shared: their `fix`.
        numbers: of the lanes, (n, WIDTH), see `wirerope_mj.engine.kernel.layout`.
        states: of the lanes, (n_state, WIDTH).
        memory: of the lanes, (n_work, WIDTH).
        positions: of the driven slides at every MAX_STEPS-th step, as MuJoCo's stages have them, (1, n, n_driven).
        rates: of the driven slides, (1, n, n_driven).
        motion: accelerations of the base at all half steps, (1, 2 n_steps + 1, 3).
        h: length of a step [s].
        carried: states with n < 1: for each the addresses of its deflection and of its rate in the memory, of its first
            parameter in the numbers, and its row among the states, (n_carried, 4). A step's stages sample the slope of these
            states, which has no derivative where they are zero: the map of a period would be rough to 1e-4 of itself. They are
            integrated over a step in closed form, along the deflection between its start and end.
        lanes: number of lanes in use.
        track: takes the first lane's state at the start of the first steps, (n_kept, n_state).
        values: takes its sensor values, (n_kept, n_values).
    """
    lay, fix, num, y, work = table(structure), table(shared), rows(numbers), rows(states), rows(memory)
    which = np.zeros(WIDTH, dtype=np.int64)
    steps = (motion.shape[1] - 1) // 2
    before, c, a = np.empty((carried.shape[0], 3, lanes)), np.empty(ORDER + 1), np.empty(ORDER + 1)
    for step in range(steps):
        if step % MAX_STEPS == 0:
            place_base(lay, fix, states, which, positions, rates, step // MAX_STEPS)
        forward(lay, fix, num, y, work, base_at(motion, which, True, 2 * step))
        mark_failures(lay, fix, y, work)
        if step < track.shape[0]:
            measure(lay, fix, num, y, work, True)
            for i in range(track.shape[1]):
                track[step, i] = states[i, 0]
            for i in range(values.shape[1]):
                values[step, i] = lane(work[lay[at.VALUES] + i], 0)
        middle, end = base_at(motion, which, True, 2 * step + 1), base_at(motion, which, True, 2 * step + 2)
        for i in range(carried.shape[0]):
            for number in range(lanes):
                before[i, 0, number] = memory[carried[i, 0], number]
                before[i, 1, number] = memory[carried[i, 1], number]
                before[i, 2, number] = states[carried[i, 3], number]
        take_step(lay, fix, num, y, work, middle, end, h)
        if carried.shape[0] > 0:
            place_links(lay, fix, y, work)
            deflect(lay, fix, num, y, work)
            for i in range(carried.shape[0]):
                for number in range(lanes):
                    x0, v0, z0 = before[i, 0, number], before[i, 1, number], before[i, 2, number]
                    x1, v1 = memory[carried[i, 0], number], memory[carried[i, 1], number]
                    if abs(x1 - x0) < np.inf and abs(z0) < np.inf:
                        first = carried[i, 2]
                        p = numbers[first : first + 4, number]
                        states[carried[i, 3], number] = state_along_cubic(p, x0, v0, x1, v1, h, z0, c, a)
    forward(lay, fix, num, y, work, base_at(motion, which, True, 2 * steps))
    mark_failures(lay, fix, y, work)


@njit
def state_along_cubic(p, x0, v0, x1, v1, h, z0, c, a):
    """Integrate Bouc-Wen's state z0 over a step h along the cubic through deflections and rates, from reversal to reversal."""
    z = np.array([z0])
    cubic, first, second = reversals(x0, x1, v0, v1, h)
    last = x0
    for instant in (first, second):
        if 0.0 < instant < h:
            turning = position(cubic, instant)
            carry_power(p, 0, last, turning, z, 0, c, a)
            last = turning
    carry_power(p, 0, last, x1, z, 0, c, a)
    return z[0]


@njit
def differences_about(structure, shared, numbers, states, memory, track, moves, motion, wanted, factors, out):
    """Write the changes of accelerations and rates due to displacements from a motion, at the motion's instants.

    Args:
        structure: `lay` of the equations.
        shared: their `fix`.
        numbers: of the lanes, as of `step_periods`.
        states: of the lanes, overwritten.
        memory: of the lanes.
        track: states of the motion, (n_instants, n_state).
        moves: displacements of the lanes: tangents of configuration, velocities, states, (n_groups, n_tangent, WIDTH).
        motion: accelerations of the base at the instants, (1, n_instants, 3).
        wanted: addresses in the memory of the accelerations and rates, (n_wanted,).
        factors: of their changes, (n_wanted,).
        out: takes the changes behind other rows, (n_instants, n_others + n_wanted, n_groups, WIDTH).
    """
    lay, fix, num, y, work = table(structure), table(shared), rows(numbers), rows(states), rows(memory)
    groups, move, result, above = moves.shape[0], rows(moves), rows(out), out.shape[1] - wanted.size
    which, unmoved, moved = np.zeros(WIDTH, dtype=np.int64), lay[at.SUM], lay[at.SLOPE]
    for k in range(track.shape[0]):
        base = base_at(motion, which, True, k)
        for i in range(track.shape[1]):
            y[i] = track[k, i]
            work[lay[at.START] + i] = track[k, i]
        forward(lay, fix, num, y, work, base)
        for i in range(wanted.size):
            work[unmoved + i] = work[wanted[i]]
        for group in range(groups):
            for i in range(moves.shape[1]):
                work[moved + i] = move[group * moves.shape[1] + i]
            shift(lay, y, work, moved, 1.0)
            forward(lay, fix, num, y, work, base)
            mark_failures(lay, fix, y, work)
            for i in range(wanted.size):
                change = factors[i] * (work[wanted[i]] - work[unmoved + i])
                result[(k * out.shape[1] + above + i) * groups + group] = change


@inlined
def weigh(n, weights, work, source, target):
    """Write the columns at `source`, times a weight for each row, to `target`."""
    for i in range(n):
        work[target + i] = weights[i] * work[source + i]


@inlined
def slope_of(i, first, column, value, entry, width, work, source):
    """Multiply row `i` of the sparse matrix A by the columns at `source`."""
    slope = 0.0 * work[source]
    for e in range(first[i], first[i + 1]):
        slope = slope + value[entry + width * i + column[e]] * work[source + column[e]]
    return slope


@inlined
def add_slope(n, first, column, value, entry, width, scale, gain, decay, work, source, target, start, weight, h):
    """Add the weighted derivative at `source` to the sum of an RK4 step; write `start` plus h times it to `target`."""
    weighed = 4 * n
    weigh(n, scale, work, source, weighed)
    for i in range(n):
        slope = slope_of(i, first, column, value, entry, width, work, weighed)
        slope = gain[i] * slope + decay[i] * work[source + i]
        work[i] = work[i] + weight * slope
        work[target + i] = work[start + i] + h * slope


@inlined
def apply_reversals(n, first, column, value, entry, width, scale, turns, waits, work, here):
    """Multiply the columns at `here` by the factors `turns` of reversals that lie `waits` after, where w' = dv until then."""
    weigh(n, scale, work, here, 4 * n)
    for i in range(n):
        if turns[i] != 1.0:
            ahead = waits[i] * slope_of(i, first, column, value, entry, width, work, 4 * n)
            work[here + i] = turns[i] * (work[here + i] + ahead) - ahead


@njit
def integrate_linear(begin, columns, matrix, h, scale, gain, decay, turns, waits, phi, room):
    """Solve d/dt phi = gain A (scale phi) + decay phi in place by RK4 over pairs of the samples of A, row by row.

    The first sample follows the last; their number is even. Before each pair rows are multiplied by the factors of reversals.

    Args:
        begin: where the rows' entries that are not zero begin in `columns`, (n + 1,).
        columns: of these entries.
        matrix: A, (n_samples, n, n_columns), of the columns the first n.
        h: time between two samples [s].
        scale: factors of phi in A's product, at the three samples of every pair, (n_pairs, 3, n); this and the next: `Slopes`.
        gain: factors of A's product, (n_pairs, 3, n).
        decay: factors of phi, (n_pairs, 3, n).
        turns: factors at reversals before every pair and behind the last, (n_pairs + 1, n).
        waits: times to these reversals [s], (n_pairs + 1, n).
        phi: columns of the solution, (n_groups, n, WIDTH).
        room: to work in, (5 n, WIDTH).
    """
    first, column, value, work = table(begin), table(columns), table(matrix), rows(room)
    samples, n, width = matrix.shape
    size, here, trial, second = n * width, n, 2 * n, 3 * n
    for group in range(phi.shape[0]):
        solution = rows(phi[group])
        for i in range(n):
            work[here + i] = solution[i]
        for k in range(0, samples, 2):
            s, g, d = scale[k // 2], gain[k // 2], decay[k // 2]
            a, b, c = k * size, (k + 1) * size, (k + 2) % samples * size
            apply_reversals(n, first, column, value, a, width, s[0], turns[k // 2], waits[k // 2], work, here)
            for i in range(n):
                work[i] = 0.0
            add_slope(n, first, column, value, a, width, s[0], g[0], d[0], work, here, trial, here, 1.0, h)
            add_slope(n, first, column, value, b, width, s[1], g[1], d[1], work, trial, second, here, 2.0, h)
            add_slope(n, first, column, value, b, width, s[1], g[1], d[1], work, second, trial, here, 2.0, 2.0 * h)
            add_slope(n, first, column, value, c, width, s[2], g[2], d[2], work, trial, second, here, 1.0, 0.0)
            for i in range(n):
                work[here + i] = work[here + i] + h / 3.0 * work[i]
        last = samples // 2
        apply_reversals(n, first, column, value, 0, width, scale[last - 1, 2], turns[last], waits[last], work, here)
        for i in range(n):
            solution[i] = work[here + i]
