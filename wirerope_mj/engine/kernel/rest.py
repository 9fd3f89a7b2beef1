"""Positions of rest of the variants in all lanes at once: each lane goes its own way, and all are evaluated together.

The lanes' searches are those of `wirerope_mj.engine.statics.loading`, one for each load step, and their hysteretic states are
carried on straight lines from where the last load step ended. A lane that is done, or that found no root, waits for the others;
what it asks for depends on its own results alone, so that it has the same bits in any company.
"""

import math

import numpy as np

from wirerope_mj.engine.control.vectors import product, quaternion, unit
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.carry import carry_coupled, carry_states
from wirerope_mj.engine.kernel.forces import deflect
from wirerope_mj.engine.kernel.links import half_turn, place_links
from wirerope_mj.engine.kernel.steps import forward
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import WIDTH, rows, table
from wirerope_mj.mounts.laws.path import put

# what a lane evaluates next: its position, a column of the Jacobian to either side, a trial position, or nothing more
BEGIN, ABOVE, BELOW, TRY, CONVERGED, FAILED = range(6)
# settings of the search, see `wirerope_mj.engine.statics.loading`
TOLERANCE, ACCEPTED, DIFFERENCE, LONGEST, SLOW, ITERATIONS, HALVINGS, MOST, SETTINGS = range(9)
# pivot relative to the largest entry of its column below which a Jacobian is not inverted here, and its lane is lost
SINGULAR = 1e-9


@njit
def move_position(lay, position, step, out):
    """Write to `out` the coordinates after a step of all velocity coordinates, as mj_integratePos does."""
    for i in range(position.size):
        out[i] = position[i]
    for dof in range(step.size):
        d = lay[at.DOFS] + at.DOF_COLUMNS * dof
        kind, q = lay[d + at.DOF_KIND], lay[d + at.DOF_QPOS]
        if kind <= at.HINGE:
            out[q] += step[dof]
        elif kind == at.FLOATING:
            for c in range(3):
                out[q + c] += step[dof + c]
            u, v, w = step[dof + 3], step[dof + 4], step[dof + 5]
            c, s = half_turn(u * u + v * v + w * w)
            turned = unit(product(quaternion(position, q + 3), (c, s * u, s * v, s * w)))
            out[q + 3], out[q + 4], out[q + 5], out[q + 6] = turned


@njit
def largest(values):
    """Return the largest magnitude, NaN if any is."""
    size = 0.0
    for value in values:
        if not abs(value) <= size:
            size = abs(value)
            if math.isnan(size):
                return size
    return size


@njit
def invert(matrix, out):
    """Write the inverse of a matrix, which is overwritten, to `out` by Gauss-Jordan with row pivots; False if there is none."""
    n = matrix.shape[0]
    for i in range(n):
        for j in range(n):
            out[i, j] = 1.0 if i == j else 0.0
    scale = np.empty(n)
    for j in range(n):
        scale[j] = largest(matrix[:, j])
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            p = i if abs(matrix[i, k]) > abs(matrix[p, k]) else p
        pivot = matrix[p, k]
        if not abs(pivot) > SINGULAR * scale[k] or not abs(pivot) < np.inf:
            return False
        for j in range(n):
            matrix[k, j], matrix[p, j] = matrix[p, j], matrix[k, j]
            out[k, j], out[p, j] = out[p, j], out[k, j]
        for j in range(n):
            matrix[k, j] /= pivot
            out[k, j] /= pivot
        for i in range(n):
            ratio = matrix[i, k]
            if i != k and ratio != 0.0:
                for j in range(n):
                    matrix[i, j] -= ratio * matrix[k, j]
                    out[i, j] -= ratio * out[k, j]
    return True


@njit
def update_inverse(inverse, step, before, after, slow):
    """Update an inverse Jacobian in place by Broyden's formula after a step; return whether it is still usable."""
    n = step.size
    expected, across = np.zeros(n), np.zeros(n)
    for i in range(n):
        for j in range(n):
            expected[i] += inverse[i, j] * (after[j] - before[j])
            across[i] += step[j] * inverse[j, i]
    agreement, size = 0.0, 0.0
    for i in range(n):
        agreement += step[i] * expected[i]
        size += step[i] * step[i]
    if largest(after) > slow * largest(before) or not agreement >= slow * size:
        return False
    for i in range(n):
        for j in range(n):
            inverse[i, j] += (step[i] - expected[i]) * across[j] / agreement
    return True


@njit
def begin_iteration(search, number, settings):
    """Begin a lane's next iteration, or end its search: converged, failed, Newton's step, or differences for a Jacobian."""
    phase, counts, value, step, inverse, _trial = search
    size = largest(value[number])
    if not size > settings[TOLERANCE] or not size < np.inf or counts[number, 1] >= settings[ITERATIONS]:
        phase[number] = CONVERGED if size <= settings[ACCEPTED] else FAILED
        return
    counts[number, 1] += 1
    if counts[number, 0] == 0:  # no inverse Jacobian
        phase[number], counts[number, 3] = ABOVE, 0
        return
    begin_step(search, number, settings)


@njit
def begin_step(search, number, settings):
    """Set a lane's trial step to that of Newton's method, shortened to the longest allowed."""
    phase, counts, value, step, inverse, _trial = search
    n = value.shape[1]
    for i in range(n):
        total = 0.0
        for j in range(n):
            total -= inverse[number, i, j] * value[number, j]
        step[number, i] = total
    shorter = min(1.0, settings[LONGEST] / max(largest(step[number]), 1e-12))
    for i in range(n):
        step[number, i] *= shorter
    phase[number], counts[number, 2] = TRY, 0


@njit
def continue_search(search, number, result, jacobian, settings):
    """Continue a lane's search with the accelerations `result` at its trial position; return whether that is accepted.

    `counts` of a lane: 1 if it has an inverse Jacobian, 2 if that is fresh; iterations; halvings; column of the Jacobian.
    """
    phase, counts, value, step, inverse, _trial = search
    own, n = phase[number], value.shape[1]
    if own == BEGIN:
        put(result, 0, value[number], 0, n)
        begin_iteration(search, number, settings)
    elif own == ABOVE:
        for i in range(n):
            jacobian[number, i, counts[number, 3]] = result[i]
        phase[number] = BELOW
    elif own == BELOW:
        column = counts[number, 3]
        for i in range(n):
            jacobian[number, i, column] = (jacobian[number, i, column] - result[i]) / (2.0 * settings[DIFFERENCE])
        counts[number, 3] += 1
        phase[number] = ABOVE
        if counts[number, 3] == n:
            counts[number, 0] = 2
            phase[number] = FAILED
            if invert(jacobian[number], inverse[number]):
                begin_step(search, number, settings)
    elif own == TRY:
        if largest(result) < largest(value[number]):
            serves = update_inverse(inverse[number], step[number], value[number], result, settings[SLOW])
            counts[number, 0] = 1 if serves else 0
            put(result, 0, value[number], 0, n)
            begin_iteration(search, number, settings)
            return True
        counts[number, 2] += 1
        fresh = counts[number, 0] == 2
        if counts[number, 2] < (settings[HALVINGS] if fresh else 1.0):
            for i in range(n):
                step[number, i] *= 0.5
        elif fresh:  # leads nowhere: rounding may have ended the search before
            phase[number] = CONVERGED if largest(value[number]) <= settings[ACCEPTED] else FAILED
        else:
            counts[number, 0] = 0
            begin_iteration(search, number, settings)
    return False


@njit
def deflections(lay, fix, num, y, work):
    """Place the links of all lanes and write the mounts' deflections to RECORD."""
    place_links(lay, fix, y, work)
    deflect(lay, fix, num, y, work)


@njit
def evaluate_at(structure, shared, numbers, states, memory, before, carried, follows, sizes, scratch):
    """Compute each variant's accelerations at rest in its position, states carried there from deflections `before`."""
    lay, fix, num, y, work = table(structure), table(shared), rows(numbers), rows(states), rows(memory)
    if follows.size:
        deflections(lay, fix, num, y, work)
        carry_states(structure, numbers, states, memory, before, carried, follows, sizes, scratch)
        carry_coupled(structure, numbers, states, memory, before, carried, scratch)
    zero = 0.0 * y[0]
    forward(lay, fix, num, y, work, (zero, zero, zero, zero, zero, zero))


@njit
def settle(structure, shared, numbers, states, memory, free, loads, follows, sizes, settings, residual, grams):
    """Bring all lanes from the positions in `states`, where they are weightless, to rest under their weight.

    Of the equations' structure and shared numbers the gravity is written to. The numbers, states and memory of the lanes,
    (n, WIDTH), are those of `wirerope_mj.engine.kernel.layout`; velocities are zero.

    Args:
        structure: `lay` of the equations.
        shared: `fix` of the equations.
        numbers: of the lanes.
        states: of the lanes.
        memory: of the lanes.
        free: velocity coordinates that the base does not drive, (n_free,).
        loads: fractions of the weight, the last of them 1, (n_loads,).
        follows: whether the states of an axis follow the path, (3 n_mounts,); empty where all states stay zero.
        sizes: numbers of parameters of the axes' laws, (3 n_mounts,).
        settings: of the search, (SETTINGS,).
        residual: takes the largest acceleration left, (WIDTH,); infinite where no position of rest was found.
        grams: takes G^T G with the rates G of all deflections by the free velocities, (WIDTH, n_free, n_free).
    """
    lay = table(structure)
    nq, nv, n = structure[at.NQ], structure[at.NV], free.size
    first = nq + nv
    gravity = shared[structure[at.GRAVITY] : structure[at.GRAVITY] + 3].copy()
    position, trial = np.ascontiguousarray(states[:nq].T), np.empty((WIDTH, nq))
    value, step = np.zeros((WIDTH, n)), np.zeros((WIDTH, n))
    inverse, jacobian = np.zeros((WIDTH, n, n)), np.zeros((WIDTH, n, n))
    phase, counts = np.zeros(WIDTH, dtype=np.int64), np.zeros((WIDTH, 4), dtype=np.int64)
    before, carried = np.zeros((structure[at.N_MOUNTS] * 3, WIDTH)), np.zeros((structure[at.N_STATES] + 1, WIDTH))
    search = (phase, counts, value, step, inverse, trial)
    whole, result = np.zeros(nv), np.empty(n)
    scratch = np.empty((4, 20 * (structure[at.N_STATES] + 2) + numbers.shape[0]))
    residual[:] = 0.0
    tried = 0
    for load in loads:
        for c in range(3):
            shared[structure[at.GRAVITY] + c] = load * gravity[c]
        waiting = 0
        for number in range(WIDTH):
            phase[number] = BEGIN if residual[number] < np.inf else FAILED
            counts[number, 1] = 0
            waiting += phase[number] == BEGIN
        while waiting:
            for number in range(WIDTH):
                own = phase[number]
                whole[:] = 0.0
                if own in (ABOVE, BELOW):
                    whole[free[counts[number, 3]]] = settings[DIFFERENCE] if own == ABOVE else -settings[DIFFERENCE]
                elif own == TRY:
                    for i in range(n):
                        whole[free[i]] = step[number, i]
                move_position(lay, position[number], whole, trial[number])
                for i in range(nq):
                    states[i, number] = trial[number, i]
            evaluate_at(structure, shared, numbers, states, memory, before, carried, follows, sizes, scratch)
            tried += 1
            waiting = 0
            for number in range(WIDTH):
                if phase[number] >= CONVERGED:
                    continue
                for i in range(n):
                    result[i] = memory[structure[at.RHS] + free[i], number]
                if tried > settings[MOST]:
                    phase[number] = FAILED
                elif continue_search(search, number, result, jacobian, settings):
                    put(trial[number], 0, position[number], 0, nq)
                waiting += phase[number] < CONVERGED
        for number in range(WIDTH):
            residual[number] = largest(value[number]) if phase[number] == CONVERGED else np.inf
            for i in range(nq):
                states[i, number] = position[number, i]
        evaluate_at(structure, shared, numbers, states, memory, before, carried, follows, sizes, scratch)
        for mount in range(structure[at.N_MOUNTS]):
            for c in range(3):
                put(memory[structure[at.RECORD] + at.RECORD_SIZE * mount + c], 0, before[3 * mount + c], 0, WIDTH)
        for k in range(structure[at.N_STATES]):
            put(states[first + k], 0, carried[k], 0, WIDTH)
    slopes(structure, shared, numbers, states, memory, free, grams)


@njit
def slopes(structure, shared, numbers, states, memory, free, grams):
    """Write G^T G, G the rates of the mounts' deflections when one free coordinate moves with velocity 1."""
    lay, fix, num, y, work = table(structure), table(shared), rows(numbers), rows(states), rows(memory)
    n, axes, nq = free.size, 3 * structure[at.N_MOUNTS], structure[at.NQ]
    kept = memory[structure[at.RECORD] : structure[at.RECORD] + structure[at.N_MOUNTS] * at.RECORD_SIZE].copy()
    rates = np.empty((n, axes, WIDTH))
    for i in range(n):
        states[nq + free[i]] = 1.0
        deflections(lay, fix, num, y, work)
        states[nq + free[i]] = 0.0
        for axis in range(axes):
            put(memory[structure[at.RECORD] + at.RECORD_SIZE * (axis // 3) + at.RATE + axis % 3], 0, rates[i, axis], 0, WIDTH)
    for i in range(n):
        for j in range(n):
            for number in range(WIDTH):
                total = 0.0
                for axis in range(axes):
                    total += rates[i, axis, number] * rates[j, axis, number]
                grams[number, i, j] = total
    for row in range(kept.shape[0]):
        put(kept[row], 0, memory[structure[at.RECORD] + row], 0, WIDTH)
