"""Values of an instant, as the system's sensors have them, and the memory of peaks and stops: the callback's, in lanes."""

import math

from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.control.peaks import parabola_bounds, track_closing, track_touch, track_travel, track_vector
from wirerope_mj.engine.control.vectors import (
    acceleration_at,
    cross,
    grow,
    keep,
    minus,
    plus,
    times,
    turned,
    turned_back,
    vector,
    velocity_at,
)
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.forces import elastic_motion, orientation
from wirerope_mj.foundation.jit import inlined
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
        is_point = lay[row + at.IS_POINT]
        if whole or lay[row + at.IS_TRACKED]:
            k = lay[at.KIN] + at.KIN_SIZE * lay[row + at.FRAME_LINK]
            r = turned(work, k + at.KIN_R, vector(num, lay[row + at.FRAME_POINT]))
            w, alpha = vector(work, k + at.KIN_W), vector(work, k + at.KIN_A)
            shapes = lay[row + at.FRAME_SHAPES]
            if shapes:
                r = plus(r, turned(work, k + at.KIN_R, elastic_motion(lay, shapes, fix, y, 0, 1)))
            position = plus(vector(work, k + at.KIN_O), r)
            keep(work, o + control.ACCELERATION, acceleration_at(r, w, alpha, vector(work, k + at.KIN_L)))
            if shapes:
                rate = turned(work, k + at.KIN_R, elastic_motion(lay, shapes, fix, y, lay[at.NQ], 0))
                grow(work, o + control.ACCELERATION, times(2.0, cross(w, rate)))
                vibration = turned(work, k + at.KIN_R, elastic_motion(lay, shapes, fix, work, lay[at.RHS], 0))
                grow(work, o + control.ACCELERATION, vibration)
            if whole:
                keep(work, o, position)
                q = orientation(lay, lay[row + at.FRAME_LINK], lay[row + at.FRAME_TURN], fix, work)
                work[o + 3], work[o + 4], work[o + 5], work[o + 6] = q[0], q[1], q[2], q[3]
                keep(work, o + 7, velocity_at(r, w, vector(work, k + at.KIN_V)))
                if shapes:
                    grow(work, o + 7, turned(work, k + at.KIN_R, elastic_motion(lay, shapes, fix, y, lay[at.NQ], 0)))
                keep(work, o + 10, w)
                keep(work, o + 16, alpha)
            if is_point:
                k = lay[at.KIN] + at.KIN_SIZE * lay[row + at.BASE_LINK]
                base = plus(vector(work, k + at.KIN_O), turned(work, k + at.KIN_R, vector(num, lay[row + at.BASE_POINT])))
                apart = minus(position, base)
                if lay[at.ROTATES] >= 0:
                    apart = turned(fix, lay[at.ROTATES], turned_back(work, k + at.KIN_R, apart))
                keep(work, o + control.RELATIVE, minus(apart, vector(fix, lay[row + at.BASE_APART])))
        o += control.POINT_VALUES if is_point else control.KINEMATICS
        row += at.FRAME_COLUMNS
    axis, z = lay[at.AXES], lay[at.NQ] + lay[at.NV]
    for _ in range(lay[at.N_MOUNTS]):
        for c in range(control.MOUNT_VALUES):
            work[o + c] = work[record + c]
        o, record = o + control.MOUNT_VALUES, record + at.RECORD_SIZE
        for _axis in range(3):
            for k in range(lay[axis + at.LAW_STATES]):
                if whole:
                    work[o] = y[z + lay[axis + at.FIRST_STATE] + k]
                o += 1
            axis += at.AXIS_COLUMNS


@inlined
def track_peaks(lay, num, work, clock, time):
    """Update the peaks of all tracked vectors and travels with this step."""
    t0, t1, turn = clock[TIME_2], clock[TIME_1], int(clock[TURN])
    bounds = parabola_bounds(clock[EVENT], clock[HISTORY], t0, t1, time)
    now, last, before = 4 * turn, 4 * ((turn + 2) % 3), 4 * ((turn + 1) % 3)
    channel, m, recent = lay[at.CHANNELS], lay[at.MEMORY], lay[at.RECENT]
    for _ in range(lay[at.N_CHANNELS]):
        j = lay[at.VALUES] + lay[channel]
        size = 0.0 * work[j]
        for c in range(3):
            work[recent + now + c] = work[j + c]
            size = size + work[j + c] * work[j + c]
        work[recent + now + 3] = math.sqrt(size)
        norms = work[recent + before + 3], work[recent + last + 3], work[recent + now + 3]
        track_vector(work, m, recent + before, recent + last, work, recent + now, norms, bounds, t0, t1, time)
        channel, m, recent = channel + 1, m + control.CHANNEL_MEMORY, recent + at.RECENT_SIZE
    row, record, m = lay[at.MOUNTS], lay[at.RECORD], lay[at.TRAVELS]
    for _ in range(lay[at.N_MOUNTS]):
        track_travel(work, m, num, lay[row + at.POINTS] + at.RATED, work, record, bounds, t0, t1, time)
        row, record, m = row + at.MOUNT_COLUMNS, record + at.RECORD_SIZE, m + control.TRAVEL_MEMORY
    clock[TURN] = float((turn + 1) % 3)


@inlined
def tick(clock, time):
    """Remember the instant of this step."""
    clock[HISTORY] = 1.0 if clock[EVENT] != control.SMOOTH else min(clock[HISTORY] + 1.0, 2.0)
    clock[TIME_2], clock[TIME_1], clock[EVENT] = clock[TIME_1], time, control.SMOOTH


@inlined
def track_stops(lay, num, y, work, clock, time):
    """Update the memory of the stops, whose table is STOPS, with the deflections of this step."""
    k, row, z, closing = lay[at.TOUCHED], lay[at.STOPS], lay[at.NQ] + lay[at.NV], lay[at.CLOSINGS]
    if clock[HISTORY] == 0.0:
        for c in range(control.CONTACT_MEMORY * lay[at.N_STOPS]):
            work[k + c] = 0.0
        for c in range(control.CLOSING_MEMORY * lay[at.N_STOPS]):
            work[closing + c] = 0.0
    for _ in range(lay[at.N_STOPS]):
        x, rate = work[lay[at.RECORD] + lay[row + at.STOP_RECORD]], work[lay[at.RECORD] + lay[row + at.STOP_RECORD] + at.RATE]
        p = lay[at.PARAMETERS] + lay[row + at.STOP_PARAMETER]
        below, above = -x - num[p + BELOW], x - num[p + ABOVE]
        depth = max(below, above)
        track_closing(work, k, closing, clock[HISTORY], clock[TIME_1], time, depth, where(below > above, -1.0, 1.0) * rate)
        if some(depth > 0.0):
            w = y[z + lay[row + at.STOP_STATE]] if lay[row + at.STOP_STATE] >= 0 else 0.0 * x
            pull = where(depth > 0.0, stop_force(num, p, x, rate, w), 0.0)
            force = abs(pull)
            track_touch(work, k, clock[HISTORY], clock[TIME_1], time, depth, force, pull * rate, force > 0.0)
        k, row, closing = k + control.CONTACT_MEMORY, row + at.STOP_COLUMNS, closing + control.CLOSING_MEMORY
