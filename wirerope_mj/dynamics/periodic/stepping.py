"""The steps of a sine's periods in lanes, accelerations around the instants of a motion, and a linear equation along it."""

import numpy as np

from wirerope_mj.engine.control.layout import MAX_STEPS
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.observe import measure
from wirerope_mj.engine.kernel.steps import base_at, forward, place_base, shift, take_step, watch
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import WIDTH, lane, rows, table


@njit
def go(structure, shared, numbers, states, memory, positions, rates, motion, h, track, values):
    """Step all lanes along with a base that moves alike in all of them.

    Args:
        structure: `lay` of the equations.
        shared: their `fix`.
        numbers: of the lanes, (n, WIDTH), see `wirerope_mj.engine.kernel.layout`.
        states: of the lanes, (n_state, WIDTH).
        memory: of the lanes, (n_work, WIDTH).
        positions: of the driven slides at every MAX_STEPS-th step, as MuJoCo's stages have them, (1, n, n_driven).
        rates: of the driven slides, alike.
        motion: accelerations of the base at all half steps, (1, 2 n_steps + 1, 3).
        h: length of a step [s].
        track: takes the first lane's state at the start of the first steps, (n_kept, n_state).
        values: takes its sensor values, (n_kept, n_values).
    """
    lay, fix, num, y, work = table(structure), table(shared), rows(numbers), rows(states), rows(memory)
    which = np.zeros(WIDTH, dtype=np.int64)
    steps = (motion.shape[1] - 1) // 2
    for step in range(steps):
        if step % MAX_STEPS == 0:
            place_base(lay, fix, states, which, positions, rates, step // MAX_STEPS)
        forward(lay, fix, num, y, work, base_at(motion, which, True, 2 * step))
        watch(lay, fix, y, work)
        if step < track.shape[0]:
            measure(lay, fix, num, y, work, True)
            for i in range(track.shape[1]):
                track[step, i] = states[i, 0]
            for i in range(values.shape[1]):
                values[step, i] = lane(work[lay[at.VALUES] + i], 0)
        middle, end = base_at(motion, which, True, 2 * step + 1), base_at(motion, which, True, 2 * step + 2)
        take_step(lay, fix, num, y, work, middle, end, h)
    forward(lay, fix, num, y, work, base_at(motion, which, True, 2 * steps))
    watch(lay, fix, y, work)


@njit
def look_around(structure, shared, numbers, states, memory, track, moves, motion, wanted, factors, out):
    """Write how accelerations and rates of the internal states change beside the instants of a motion.

    Args:
        structure: `lay` of the equations.
        shared: their `fix`.
        numbers: of the lanes, as of `go`.
        states: of the lanes, overwritten.
        memory: of the lanes.
        track: states of the motion, (n_instants, n_state).
        moves: by how much lanes lie beside it: tangents of configuration, velocities, states, (n_groups, n_tangent, WIDTH).
        motion: accelerations of the base at the instants, (1, n_instants, 3).
        wanted: accelerations and rates that are, counted one behind the other, (n_wanted,).
        factors: of their changes, (n_wanted,).
        out: takes the changes behind other rows, (n_instants, n_others + n_wanted, n_groups, WIDTH).
    """
    lay, fix, num, y, work = table(structure), table(shared), rows(numbers), rows(states), rows(memory)
    groups, move, result, others = moves.shape[0], rows(moves), rows(out), out.shape[1] - wanted.size
    which, unmoved, moved = np.zeros(WIDTH, dtype=np.int64), lay[at.SUM], lay[at.SLOPE]
    for k in range(track.shape[0]):
        base = base_at(motion, which, True, k)
        for i in range(track.shape[1]):
            y[i] = track[k, i]
            work[lay[at.START] + i] = track[k, i]
        forward(lay, fix, num, y, work, base)
        keep_rates(lay, work, unmoved)
        for group in range(groups):
            for i in range(moves.shape[1]):
                work[moved + i] = move[group * moves.shape[1] + i]
            shift(lay, y, work, moved, 1.0)
            forward(lay, fix, num, y, work, base)
            watch(lay, fix, y, work)
            keep_rates(lay, work, moved)
            for i in range(wanted.size):
                change = factors[i] * (work[moved + wanted[i]] - work[unmoved + wanted[i]])
                result[(k * out.shape[1] + others + i) * groups + group] = change


@inlined
def keep_rates(lay, work, section):
    """Write accelerations and rates of the internal states to a section."""
    for i in range(lay[at.NV]):
        work[section + i] = work[lay[at.RHS] + i]
    for i in range(lay[at.N_STATES]):
        work[section + lay[at.NV] + i] = work[lay[at.RATES] + i]


@inlined
def add_slope(n, first, column, value, entry, width, work, source, target, start, weight, h):
    """Add A times the columns at `source` to the sum, weighted; write to `target` where it leads from `start` over h."""
    for i in range(n):
        slope = 0.0 * work[source]
        for e in range(first[i], first[i + 1]):
            slope = slope + value[entry + width * i + column[e]] * work[source + column[e]]
        work[i] = work[i] + weight * slope
        work[target + i] = work[start + i] + h * slope


@njit
def go_along(begin, columns, matrix, h, phi, room):
    """Solve d/dt phi = A phi in place by RK4 over pairs of the samples of A, the first behind the last; their number is even.

    Args:
        begin: where the rows' entries that are not zero begin in `columns`, (n + 1,).
        columns: of these entries.
        matrix: A, (n_samples, n, n_columns), of the columns the first n.
        h: time between two samples [s].
        phi: columns of the solution, (n_groups, n, WIDTH).
        room: to work in, (4 n, WIDTH).
    """
    first, column, value, work = table(begin), table(columns), table(matrix), rows(room)
    samples, n, width = matrix.shape
    size, here, one, other = n * width, n, 2 * n, 3 * n
    for group in range(phi.shape[0]):
        solution = rows(phi[group])
        for i in range(n):
            work[here + i] = solution[i]
        for k in range(0, samples, 2):
            a, b, c = k * size, (k + 1) * size, (k + 2) % samples * size
            for i in range(n):
                work[i] = 0.0
            add_slope(n, first, column, value, a, width, work, here, one, here, 1.0, h)
            add_slope(n, first, column, value, b, width, work, one, other, here, 2.0, h)
            add_slope(n, first, column, value, b, width, work, other, one, here, 2.0, 2.0 * h)
            add_slope(n, first, column, value, c, width, work, one, other, here, 1.0, 0.0)
            for i in range(n):
                work[here + i] = work[here + i] + h / 3.0 * work[i]
        for i in range(n):
            solution[i] = work[here + i]
