"""Runge and Kutta's steps of the variants in all lanes at once, segment by segment, as MuJoCo takes them of one.

Through cycles of an excitation nothing is kept but the extremes of every channel.
"""

import math

import numpy as np

from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.control.peaks import update_component
from wirerope_mj.engine.control.vectors import dot, keep, minus, product, quaternion, times, turned_back, unit, vector
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.forces import apply_mounts, push_base, push_loads
from wirerope_mj.engine.kernel.links import half_turn, place_links, turn_rate
from wirerope_mj.engine.kernel.observe import EVENT, HISTORY, TIME_1, TIME_2, measure, tick, track_peaks, track_stops
from wirerope_mj.engine.kernel.solve import accelerate
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import WIDTH, lane, rows, spread, table, where, with_lane
from wirerope_mj.mounts.laws.registry import MASING, PARALLEL, hold_slips

BEYOND = 1e10  # acceleration beyond which MuJoCo takes a state for invalid (mjMAXVAL), and so does this
NO_SAMPLES = np.zeros((0, 0, 0))  # room for the samples that are not wanted


@njit
def forward(lay, fix, num, y, work, base):
    """Compute motion of the links, forces, rates of the states and accelerations in a state `y`."""
    place_links(lay, fix, y, work)
    push_base(lay, fix, work, base)
    apply_mounts(lay, fix, num, y, work)
    push_loads(lay, fix, num, work)
    accelerate(lay, fix, num, y, work, base)


@inlined
def fail(lay, work, fails, why):
    """Mark the lanes where something fails for the first time."""
    f = lay[at.FAILED]
    work[f] = where(fails & (work[f] == 0.0), why, work[f])


@inlined
def slopes(lay, y, work, weight, first):
    """Write the state's rates at this Runge-Kutta stage to SLOPE, and add them, weighted, to SUM, begun by the first stage."""
    nq, nv, s, total = lay[at.NQ], lay[at.NV], lay[at.SLOPE], lay[at.SUM]
    for dof in range(nv):
        kind = lay[lay[at.DOFS] + at.DOF_COLUMNS * dof + at.DOF_KIND]
        if kind == at.FLOATING and not first:  # the turn since the step's start is what `shift` left in SLOPE
            rate = turn_rate(vector(work, s + dof + 3), vector(y, nq + dof + 3))
            keep(work, s + dof, vector(y, nq + dof))
            keep(work, s + dof + 3, rate)
        elif kind != at.ALONG or first:
            work[s + dof] = y[nq + dof]
        work[s + nv + dof] = work[lay[at.RHS] + dof]
    for k in range(lay[at.N_STATES]):
        work[s + 2 * nv + k] = work[lay[at.RATES] + k]
    for i in range(2 * nv + lay[at.N_STATES]):
        work[total + i] = weight * work[s + i] if first else work[total + i] + weight * work[s + i]


@inlined
def shift(lay, y, work, section, h):
    """Write to `y` the state START plus h times the rates in `section`, where the rotation vectors are left."""
    nq, nv, start = lay[at.NQ], lay[at.NV], lay[at.START]
    for dof in range(nv):
        d = lay[at.DOFS] + at.DOF_COLUMNS * dof
        kind, q = lay[d + at.DOF_KIND], lay[d + at.DOF_QPOS]
        if kind <= at.HINGE:
            y[q] = work[start + q] + h * work[section + dof]
        elif kind == at.FLOATING:
            for c in range(3):
                y[q + c] = work[start + q + c] + h * work[section + dof + c]
            turn = times(h, vector(work, section + dof + 3))
            size = dot(turn, turn)
            keep(work, section + dof + 3, turn)
            c, s = half_turn(size)
            q1 = product(quaternion(work, start + q + 3), (c, s * turn[0], s * turn[1], s * turn[2]))
            y[q + 3], y[q + 4], y[q + 5], y[q + 6] = unit(q1)
            fail(lay, work, size > 1.0, at.WILD)
    for i in range(nv + lay[at.N_STATES]):
        y[nq + i] = work[start + nq + i] + h * work[section + nv + i]


@inlined
def take_step(lay, fix, num, y, work, middle, end, h):
    """Take one step from a state whose accelerations are computed, with the base's at the step's middle and end."""
    for i in range(lay[at.NQ] + lay[at.NV] + lay[at.N_STATES]):
        work[lay[at.START] + i] = y[i]
    slopes(lay, y, work, 1.0 / 6.0, True)
    n_loads, loads = 6 * lay[at.N_FORCES], lay[at.LOADS]
    for stage in range(1, 4):
        for k in range(n_loads):
            work[loads + k] = work[loads + (2 * n_loads if stage == 3 else n_loads) + k]
        shift(lay, y, work, lay[at.SLOPE], h if stage == 3 else 0.5 * h)
        forward(lay, fix, num, y, work, end if stage == 3 else middle)
        slopes(lay, y, work, 1.0 / 6.0 if stage == 3 else 1.0 / 3.0, False)
    shift(lay, y, work, lay[at.SUM], h)
    left, axis = lay[at.N_SLIPPING], lay[at.AXES]
    while left > 0:  # what the step carried beyond a slider's slip force
        if lay[axis + at.LAW] == MASING or lay[axis + at.LAW] == PARALLEL:
            z = lay[at.NQ] + lay[at.NV] + lay[axis + at.FIRST_STATE]
            hold_slips(lay[axis + at.LAW], num, lay[at.PARAMETERS] + lay[axis + at.FIRST_PARAMETER], y, z)
            left -= 1
        axis += at.AXIS_COLUMNS


@njit
def remaining_clearance(lay, fix, work, row):
    """Return a lower bound of the clearance left between the links of a pair [m], > 0 while they cannot touch.

    The second's geoms have come no closer than its origin has moved in the first's axes, and its axes have turned times their
    reach: |R - R0| is at most the root of the sum of the squares.
    """
    one, other = lay[at.KIN] + at.KIN_SIZE * lay[row], lay[at.KIN] + at.KIN_SIZE * lay[row + 1]
    f = lay[row + 2]
    place = turned_back(work, one + at.KIN_R, minus(vector(work, other + at.KIN_O), vector(work, one + at.KIN_O)))
    moved = minus(place, vector(fix, f))
    turn = 0.0 * place[0]
    for c in range(3):
        axis = (work[other + at.KIN_R + c], work[other + at.KIN_R + 3 + c], work[other + at.KIN_R + 6 + c])
        away = minus(turned_back(work, one + at.KIN_R, axis), (fix[f + 3 + c], fix[f + 6 + c], fix[f + 9 + c]))
        turn = turn + dot(away, away)
    return fix[f + 12] - math.sqrt(dot(moved, moved)) - math.sqrt(turn) * fix[f + 13]


@inlined
def mark_failures(lay, fix, y, work):
    """Mark the lanes whose state is not finite, or reaches a limit or contact that these equations do not hold."""
    size = 0.0 * y[0]
    for dof in range(lay[at.NV]):
        size = size + abs(work[lay[at.RHS] + dof]) + abs(y[lay[at.NQ] + dof])
    fail(lay, work, where(size < BEYOND, 0.0, 1.0) > 0.0, at.WILD)  # of what is no number, too
    for dof in range(lay[at.NV]):
        d = lay[at.DOFS] + at.DOF_COLUMNS * dof
        f = lay[d + at.DOF_FIX]
        if lay[d + at.DOF_KIND] <= at.HINGE and fix[f + at.LOWEST] < fix[f + at.HIGHEST]:
            x = y[lay[d + at.DOF_QPOS]]
            fail(lay, work, (x <= fix[f + at.LOWEST]) | (x >= fix[f + at.HIGHEST]), at.LIMITED)
    row = lay[at.PAIRS]
    for _ in range(lay[at.N_PAIRS]):
        fail(lay, work, remaining_clearance(lay, fix, work, row) <= 0.0, at.TOUCHING)
        row += at.PAIR_COLUMNS


@inlined
def columns_of_base(motion):
    """Return the number of columns of the base: 3, or 6 where it rotates; six for each force follow."""
    return 3 + (motion.shape[2] - 3) % 6


@inlined
def base_at(motion, which, together, point):
    """Return every lane's accelerations of the base, and of its roll, pitch and yaw, at the instant number `point`."""
    i = which[0]
    x, y, z = spread(motion[i, point, 0]), spread(motion[i, point, 1]), spread(motion[i, point, 2])
    roll = pitch = yaw = spread(0.0)
    turns = columns_of_base(motion) == 6
    if turns:
        roll, pitch, yaw = spread(motion[i, point, 3]), spread(motion[i, point, 4]), spread(motion[i, point, 5])
    if not together:
        for number in range(1, WIDTH):
            i = which[number]
            x = with_lane(x, number, motion[i, point, 0])
            y = with_lane(y, number, motion[i, point, 1])
            z = with_lane(z, number, motion[i, point, 2])
            if turns:
                roll = with_lane(roll, number, motion[i, point, 3])
                pitch = with_lane(pitch, number, motion[i, point, 4])
                yaw = with_lane(yaw, number, motion[i, point, 5])
    return x, y, z, roll, pitch, yaw


@inlined
def load(lay, memory, motion, which, point, instant):
    """Write every lane's forces and moments at a point to an instant of LOADS: now, the step's middle or its end."""
    n, first = 6 * lay[at.N_FORCES], columns_of_base(motion)
    if motion.shape[2] > first:
        for k in range(n):
            for number in range(WIDTH):
                memory[lay[at.LOADS] + instant * n + k, number] = motion[which[number], point, first + k]


@inlined
def place_base(lay, fix, y, which, positions, rates, segment):
    """Set positions and rates of the base's slides to those of each lane's motion at the start of a segment."""
    for dof in range(lay[at.NV]):
        d = lay[at.DOFS] + at.DOF_COLUMNS * dof
        driven = lay[d + at.DOF_DRIVEN]
        if driven >= 0:
            for number in range(WIDTH):
                motion = which[number]
                y[lay[d + at.DOF_QPOS], number] = fix[lay[d + at.DOF_FIX] + at.ORIGIN] + positions[motion, segment, driven]
                y[lay[at.NQ] + dof, number] = rates[motion, segment, driven]


@inlined
def observe(lay, fix, num, y, work, clock, time, out, sample):
    """Update peaks and stops with this instant, and write its values to `out`, (n_kept, n_samples, n_values), if sampled."""
    measure(lay, fix, num, y, work, sample >= 0)
    track_stops(lay, num, y, work, clock, time)
    track_peaks(lay, num, work, clock, time)
    tick(clock, time)
    if sample >= 0:
        for i in range(lay[at.N_VALUES]):
            value = work[lay[at.VALUES] + i]
            for number in range(out.shape[0]):
                out[number, sample, i] = lane(value, number)


@njit
def advance(structure, shared, numbers, states, memory, clock, which, grid, positions, rates, motion, ends, out, sample):
    """Step all lanes through the segments of a grid and return the number of samples so far.

    Args:
        structure: `lay` of the equations.
        shared: `fix` of the equations.
        numbers: `num` of the lanes, (n_num, WIDTH).
        states: qpos, qvel and act of the lanes, (n_state, WIDTH).
        memory: working memory of the lanes, (n_work, WIDTH).
        clock: (CLOCK_SIZE,), see `observe`.
        which: motion of every lane, (WIDTH,).
        grid: starts, stops, numbers of steps, whether sampled, and events of the segments, (5, n_segments). One without a step
            is an instant that is observed, such as the last of all.
        positions: of the driven slides at the starts, (n_motions, n_segments, n_driven).
        rates: of the driven slides there, (n_motions, n_segments, n_driven).
        motion: accelerations of the base at all half steps, (n_motions, n_points, 3), and of roll, pitch and yaw where it
            rotates, (n_motions, n_points, 6); behind them forces and moments at the sites for them, if any act, six of each.
        ends: where a segment's accelerations end among them, (n_segments,).
        out: takes the samples of the first lanes, (n_kept, n_samples, n_values).
        sample: number of samples taken before.
    """
    lay, fix, num, y, work = table(structure), table(shared), rows(numbers), rows(states), rows(memory)
    together = True
    for number in range(1, WIDTH):
        together = together and which[number] == which[0]
    point = 0
    for segment in range(grid.shape[1]):
        start, steps = grid[0, segment], int(grid[2, segment])
        h = (grid[1, segment] - start) / max(steps, 1)
        place_base(lay, fix, states, which, positions, rates, segment)
        clock[EVENT] = grid[4, segment]
        for step in range(max(steps, 1)):
            load(lay, memory, motion, which, point, 0)
            forward(lay, fix, num, y, work, base_at(motion, which, together, point))
            mark_failures(lay, fix, y, work)
            sampled = step == 0 and grid[3, segment] != 0.0
            observe(lay, fix, num, y, work, clock, start + step * h, out, sample if sampled else -1)
            sample += 1 if sampled else 0
            if steps == 0:
                break
            load(lay, memory, motion, which, point + 1, 1)
            load(lay, memory, motion, which, point + 2, 2)
            middle, end = base_at(motion, which, together, point + 1), base_at(motion, which, together, point + 2)
            take_step(lay, fix, num, y, work, middle, end, h)
            point += 2
        point = ends[segment]
    return sample


@inlined
def track_base(base, clock, time, motion, which, point):
    """Update the extremes of the base's acceleration, as those of a channel."""
    low, high, times = control.LOW, control.HIGH, control.LOW_TIME - control.LOW
    for c in range(3):
        y0, y1, y2 = base[control.BEFORE + c], base[control.LAST + c], motion[which, point, c]
        if clock[HISTORY] == 0.0:
            base[low + c], base[low + times + c], base[high + c], base[high + times + c] = y2, time, y2, time
        update_component(base, low + c, high + c, times, clock[HISTORY] >= 2.0, clock[TIME_2], y0, clock[TIME_1], y1, time, y2)
        base[control.BEFORE + c], base[control.LAST + c] = y1, y2


@inlined
def close_cycle(lay, work, base, low, high):
    """Write the first lane's extremes of this cycle, (n_channels + 1, 3), the base's last, and begin those of the next."""
    n, m = lay[at.N_CHANNELS], lay[at.MEMORY]
    for channel in range(n):
        for c in range(3):
            low[channel, c], high[channel, c] = lane(work[m + control.LOW + c], 0), lane(work[m + control.HIGH + c], 0)
            work[m + control.LOW + c], work[m + control.HIGH + c] = spread(np.inf), spread(-np.inf)
        m += control.CHANNEL_MEMORY
    for c in range(3):
        low[n, c], high[n, c] = base[control.LOW + c], base[control.HIGH + c]
        base[control.LOW + c], base[control.HIGH + c] = np.inf, -np.inf


@njit
def advance_cycles(
    structure, shared, numbers, states, memory, clock, which, grid, positions, rates, motion, ends, closes, base, low,
    high, cycle, out,
):  # fmt: skip
    """Step all lanes, of which the first counts, through segments and return the number of cycles so far.

    A cycle's last instant belongs to it alone and is not seen again as the first of the next. Ends with the first cycle in
    which the first lane fails.

    All is as in `wirerope_mj.engine.kernel.steps.advance`, with these differences: `grid` holds starts, stops and numbers of
    steps of segments in which the motion, that of the first lane, is smooth, (3, n_segments), and `closes` whether a cycle ends
    with them, (n_segments,); `base` is the memory of the base's acceleration, (CHANNEL_MEMORY,), as that of a channel; `low`
    and `high` take the extremes of every cycle, (n_cycles, n_channels + 1, 3), the base's last; `cycle` is the number of cycles
    before, and `out` is `NO_SAMPLES`.
    """
    lay, fix, num, y, work = table(structure), table(shared), rows(numbers), rows(states), rows(memory)
    own, point = which[0], 0
    for segment in range(grid.shape[1]):
        start, steps = grid[0, segment], int(grid[2, segment])
        h = (grid[1, segment] - start) / steps
        place_base(lay, fix, states, which, positions, rates, segment)
        for step in range(steps):
            time = start + step * h
            forward(lay, fix, num, y, work, base_at(motion, which, True, point))
            mark_failures(lay, fix, y, work)
            if clock[HISTORY] == 0.0 or clock[TIME_1] != time:
                track_base(base, clock, time, motion, own, point)
                observe(lay, fix, num, y, work, clock, time, out, -1)
            middle, end = base_at(motion, which, True, point + 1), base_at(motion, which, True, point + 2)
            take_step(lay, fix, num, y, work, middle, end, h)
            point += 2
        if closes[segment]:
            time = grid[1, segment]
            forward(lay, fix, num, y, work, base_at(motion, which, True, point))
            mark_failures(lay, fix, y, work)
            track_base(base, clock, time, motion, own, point)
            observe(lay, fix, num, y, work, clock, time, out, -1)
            close_cycle(lay, work, base, low[cycle], high[cycle])
            cycle += 1
            if lane(work[lay[at.FAILED]], 0) != 0.0:
                return cycle
        point = ends[segment]
    return cycle
