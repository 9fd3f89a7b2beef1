"""Values of an instant, as the system's sensors have them, and the memory of peaks and stops: the callback's, in lanes."""

import math

from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.forces import bent, orientation
from wirerope_mj.engine.kernel.links import carried, cross, grow, keep, minus, plus, swung, times, turned, vector
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import some, where
from wirerope_mj.mounts.laws.stop_kernels import ABOVE, BELOW, stop_force

# entries of the clock: instants of the last two steps, how many of them a parabola may use, what begins with this step, and
# which of a channel's three recent vectors is next
TIME_1, TIME_2, HISTORY, EVENT, TURN, CLOCK_SIZE = range(6)


@inlined
def measure(lay, fix, num, y, work, whole):
    """Write accelerations, displacements of points, deflections and forces to VALUES; with `whole` all else that is sampled."""
    o, row, record = lay[at.VALUES], lay[at.FRAMES], lay[at.RECORD]
    for _ in range(lay[at.N_FRAMES]):
        is_point = lay[row + 3]
        if whole or lay[row + 7]:
            k = lay[at.KIN] + at.KIN_SIZE * lay[row]
            r, w, alpha = (
                turned(work, k + at.KIN_R, vector(num, lay[row + 1])), vector(work, k + at.KIN_W), vector(work, k + at.KIN_A),
            )  # fmt: skip
            shapes = lay[row + 8]
            if shapes:
                r = plus(r, turned(work, k + at.KIN_R, bent(lay, shapes, fix, y, 0, 1)))
            position = plus(vector(work, k + at.KIN_O), r)
            keep(work, o + control.ACCELERATION, swung(r, w, alpha, vector(work, k + at.KIN_L)))
            if shapes:
                rate = turned(work, k + at.KIN_R, bent(lay, shapes, fix, y, lay[at.NQ], 0))
                grow(work, o + control.ACCELERATION, times(2.0, cross(w, rate)))
                grow(work, o + control.ACCELERATION, turned(work, k + at.KIN_R, bent(lay, shapes, fix, work, lay[at.RHS], 0)))
            if whole:
                keep(work, o, position)
                q = orientation(lay, lay[row], lay[row + 2], fix, work)
                work[o + 3], work[o + 4], work[o + 5], work[o + 6] = q[0], q[1], q[2], q[3]
                keep(work, o + 7, carried(r, w, vector(work, k + at.KIN_V)))
                if shapes:
                    grow(work, o + 7, turned(work, k + at.KIN_R, bent(lay, shapes, fix, y, lay[at.NQ], 0)))
                keep(work, o + 10, w)
                keep(work, o + 16, alpha)
            if is_point:
                k = lay[at.KIN] + at.KIN_SIZE * lay[row + 4]
                base = plus(vector(work, k + at.KIN_O), turned(work, k + at.KIN_R, vector(num, lay[row + 5])))
                keep(work, o + control.RELATIVE, minus(minus(position, base), vector(fix, lay[row + 6])))
        o += control.POINT_VALUES if is_point else control.KINEMATICS
        row += at.FRAME_COLUMNS
    axis, z = lay[at.AXES], lay[at.NQ] + lay[at.NV]
    for _ in range(lay[at.N_MOUNTS]):
        for c in range(control.MOUNT_VALUES):
            work[o + c] = work[record + c]
        o, record = o + control.MOUNT_VALUES, record + at.RECORD_SIZE
        for _axis in range(3):
            for k in range(lay[axis + 3]):
                if whole:
                    work[o] = y[z + lay[axis + 2] + k]
                o += 1
            axis += at.AXIS_COLUMNS


@inlined
def extreme(t0, y0, t1, y1, t2, y2):
    """Return instant and value of the extreme of the parabola through three points, as `observer.parabola_extreme` does."""
    left, right = (y1 - y0) * (1.0 / (t1 - t0)), (y2 - y1) * (1.0 / (t2 - t1))
    curvature = (right - left) * (1.0 / (t2 - t0))
    stays = (curvature == 0.0) | (y1 == 0.0)
    time = 0.5 * (t0 + t1 - left / where(stays, 1.0, curvature))
    return where(stays, t1, time), where(stays, y1, y0 + (time - t0) * (left + curvature * (time - t1)))


@inlined
def higher(work, value_row, time_row, value, time, condition):
    """Keep a value and its instant where a condition holds and it is above what is kept; returns where."""
    better = condition & (value > work[value_row])
    work[value_row] = where(better, value, work[value_row])
    work[time_row] = where(better, time, work[time_row])
    return better


@inlined
def lower(work, value_row, time_row, value, time, condition):
    """Keep a value and its instant where a condition holds and it is below what is kept."""
    better = condition & (value < work[value_row])
    work[value_row] = where(better, value, work[value_row])
    work[time_row] = where(better, time, work[time_row])


@njit
def begin_channel(work, m, recent, time):
    """Begin a channel's memory with its first vector."""
    for c in range(3):
        y2 = work[recent + c]
        work[m + control.LOW + c], work[m + control.HIGH + c], work[m + control.PEAK_VECTOR + c] = y2, y2, y2
        work[m + control.LOW_TIME + c], work[m + control.HIGH_TIME + c] = time, time
    work[m + control.PEAK], work[m + control.PEAK_TIME] = work[recent + 3], time


@njit
def update_component(work, low, high, times, refine, t0, y0, t1, y1, t2, y2):
    """Update lowest and highest value of a component, their instants `times` rows behind them."""
    always = y2 == y2
    higher(work, high, high + times, y2, t2, always)
    lower(work, low, low + times, y2, t2, always)
    if refine:
        top = (y1 >= y0) & (y1 >= y2)
        bottom = (y1 <= y0) & (y1 <= y2) & (where(top, 1.0, 0.0) == 0.0)
        time, value = extreme(t0, y0, t1, y1, t2, y2)
        higher(work, high, high + times, value, time, top)
        lower(work, low, low + times, value, time, bottom)


@njit
def update_norm(work, m, first, second, third, refine, t0, t1, t2):
    """Update the peak of the norm with the vectors of three steps, their norms behind them."""
    y0, y1, y2 = work[first + 3], work[second + 3], work[third + 3]
    grows = higher(work, m + control.PEAK, m + control.PEAK_TIME, y2, t2, y2 == y2)
    for c in range(3):
        work[m + control.PEAK_VECTOR + c] = where(grows, work[third + c], work[m + control.PEAK_VECTOR + c])
    if not refine:
        return
    time, value = extreme(t0, y0, t1, y1, t2, y2)
    better = higher(work, m + control.PEAK, m + control.PEAK_TIME, value, time, (y1 >= y0) & (y1 >= y2))
    for c in range(3):
        v0, v1, v2 = work[first + c], work[second + c], work[third + c]
        left = (v1 - v0) * (1.0 / (t1 - t0))
        curvature = ((v2 - v1) * (1.0 / (t2 - t1)) - left) * (1.0 / (t2 - t0))
        there = v0 + (time - t0) * (left + curvature * (time - t1))
        work[m + control.PEAK_VECTOR + c] = where(better, there, work[m + control.PEAK_VECTOR + c])


@njit
def update_travel(work, m, judged, refine, t0, t1, y2, t2):
    """Update the farthest travel of a mount along all axes at once, and the farthest that is judged."""
    higher(work, m + control.FARTHEST, m + control.FARTHEST_TIME, y2, t2, y2 == y2)
    higher(work, m + control.JUDGED, m + control.JUDGED_TIME, y2, t2, judged)
    if refine:
        y0, y1 = work[m + control.TRAVEL_BEFORE], work[m + control.TRAVEL_LAST]
        time, value = extreme(t0, y0, t1, y1, t2, y2)
        top = (y1 >= y0) & (y1 >= y2)
        higher(work, m + control.FARTHEST, m + control.FARTHEST_TIME, value, time, top)
        higher(work, m + control.JUDGED, m + control.JUDGED_TIME, value, time, top & (work[m + control.WAS_JUDGED] > 0.0))


@inlined
def track_travels(lay, num, work, a, b, refine, begins, t0, t1, time):
    """Update the travel of every mount along all axes at once, as the callback does; `a`, `b` are of `track_peaks`."""
    row, record, m = lay[at.MOUNTS], lay[at.RECORD], lay[at.TRAVELS]
    for _ in range(lay[at.N_MOUNTS]):
        p = lay[row + at.POINTS] + 9
        roll, shear, axial = work[record], work[record + 1], work[record + 2]
        along = where(axial < 0.0, num[p + 2], num[p + 3])
        y2 = num[p] * roll * roll + num[p + 1] * shear * shear + along * axial * axial
        judged = (axial == 0.0) | (along > 0.0)
        if begins:
            work[m + control.FARTHEST], work[m + control.JUDGED] = y2, where(judged, y2, -1.0)
            work[m + control.FARTHEST_TIME], work[m + control.JUDGED_TIME] = time, time
        else:
            y0, y1 = work[m + control.TRAVEL_BEFORE], work[m + control.TRAVEL_LAST]
            if some(max(y2, y1 + a * abs(y1 - y0) + b * abs(y1 - y2)) > work[m + control.JUDGED]):
                update_travel(work, m, judged, refine, t0, t1, y2, time)
        work[m + control.TRAVEL_BEFORE], work[m + control.TRAVEL_LAST] = work[m + control.TRAVEL_LAST], y2
        work[m + control.WAS_JUDGED] = where(judged, 1.0, 0.0)
        row, record, m = row + at.MOUNT_COLUMNS, record + at.RECORD_SIZE, m + control.TRAVEL_MEMORY


@inlined
def track_peaks(lay, num, work, clock, time):
    """Update all channels with the values of this step.

    A parabola through y0, y1, y2 whose middle is extreme rises above it by at most a |y1 - y0| + b |y1 - y2|, with
    a = max(r, 1)^2 / (4 + 4 r), b = a / r and r the ratio of the two steps: only where that could beat what is kept, which is
    seldom, is it drawn.
    """
    event, history = clock[EVENT], clock[HISTORY]
    if event == control.JUMP and history > 1.0:
        history = 1.0  # what follows a jump is compared with what was, but no parabola is drawn to it
    refine, begins, t0, t1 = history >= 2.0, history == 0.0, clock[TIME_2], clock[TIME_1]
    a = b = 0.0
    if refine:
        ratio = (time - t1) / (t1 - t0)
        a = 1.0001 * max(ratio, 1.0) ** 2 / (4.0 + 4.0 * ratio)
        b = a / ratio
    turn = int(clock[TURN])
    now, last, before = 4 * turn, 4 * ((turn + 2) % 3), 4 * ((turn + 1) % 3)
    channel, m, recent = lay[at.CHANNELS], lay[at.MEMORY], lay[at.RECENT]
    for _ in range(lay[at.N_CHANNELS]):
        j = lay[at.VALUES] + lay[channel]
        size = 0.0 * work[j]
        for c in range(3):
            y2, y1, y0 = work[j + c], work[recent + last + c], work[recent + before + c]
            work[recent + now + c] = y2
            size = size + y2 * y2
            above = a * abs(y1 - y0) + b * abs(y1 - y2)
            low, high = m + control.LOW + c, m + control.HIGH + c
            if some((max(y2, y1 + above) > work[high]) | (min(y2, y1 - above) < work[low])) and not begins:
                update_component(work, low, high, control.LOW_TIME - control.LOW, refine, t0, y0, t1, y1, time, y2)
        y2, y1, y0 = math.sqrt(size), work[recent + last + 3], work[recent + before + 3]
        work[recent + now + 3] = y2
        if begins:
            begin_channel(work, m, recent + now, time)
        elif some(max(y2, y1 + a * abs(y1 - y0) + b * abs(y1 - y2)) > work[m + control.PEAK]):
            update_norm(work, m, recent + before, recent + last, recent + now, refine, t0, t1, time)
        channel, m, recent = channel + 1, m + control.CHANNEL_MEMORY, recent + at.RECENT_SIZE
    track_travels(lay, num, work, a, b, refine, begins, t0, t1, time)
    clock[TURN] = float((turn + 1) % 3)


@inlined
def tick(clock, time):
    """Remember the instant of this step."""
    clock[HISTORY] = 1.0 if clock[EVENT] != control.SMOOTH else min(clock[HISTORY] + 1.0, 2.0)
    clock[TIME_2], clock[TIME_1], clock[EVENT] = clock[TIME_1], time, control.SMOOTH


@njit
def touch(work, k, clock, time, depth, pull, rate):
    """Update the memory of a stop where it pushes: its restoring force [N] at a depth [m], and the deflection's rate [m/s]."""
    force, before = abs(pull), clock[TIME_1]
    pushes = force > 0.0
    if clock[HISTORY] > 0.0:
        work[k + control.WORK] += pull * rate * (time - before)
    fresh = pushes & (work[k + control.TOUCHES] == 0.0)
    last, again = work[k + control.LAST_TOUCH], pushes & (work[k + control.TOUCHES] > 0.0)
    stays = again & (last == before) if before < time else again & (last > time)
    back = again & (last < before)
    work[k + control.TOUCHED_FOR] += where(stays, time - before, 0.0)
    work[k + control.FIRST_TOUCH] = where(fresh, time, work[k + control.FIRST_TOUCH])
    work[k + control.FROM_START] = where(fresh, 1.0 if clock[HISTORY] == 0.0 else 0.0, work[k + control.FROM_START])
    work[k + control.TOUCHES] += where(fresh | back, 1.0, 0.0)
    work[k + control.LAST_TOUCH] = where(pushes, time, last)
    higher(work, k + control.FORCE_PEAK, k + control.FORCE_TIME, force, time, pushes)
    higher(work, k + control.DEPTH, k + control.DEPTH_TIME, depth, time, pushes)


@inlined
def track_stops(lay, num, y, work, clock, time):
    """Update the memory of all stops with the deflections of this step; STOPS names axis and component of each."""
    k, row, z = lay[at.TOUCHED], lay[at.STOPS], lay[at.NQ] + lay[at.NV]
    if clock[HISTORY] == 0.0:
        for c in range(control.CONTACT_MEMORY * lay[at.N_STOPS]):
            work[k + c] = 0.0
    for _ in range(lay[at.N_STOPS]):
        x, rate = work[lay[at.RECORD] + lay[row]], work[lay[at.RECORD] + lay[row] + 6]
        p = lay[at.PARAMETERS] + lay[row + 1]
        depth = max(-x - num[p + BELOW], x - num[p + ABOVE])
        if some(depth > 0.0):
            w = y[z + lay[row + 2]] if lay[row + 3] else 0.0 * x
            touch(work, k, clock, time, depth, where(depth > 0.0, stop_force(num, p, x, rate, w), 0.0), rate)
        k, row = k + control.CONTACT_MEMORY, row + 4
