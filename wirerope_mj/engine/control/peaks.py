"""Extremes over all steps of vectors, of mounts' travels and of what touches: of one system, and of several side by side.

Each is refined by the parabola through the three steps around it, never across a corner of the base motion. `u` is the memory,
laid out as in `wirerope_mj.engine.control.layout`: an array of numbers or of lanes.
"""

from wirerope_mj.engine.control import layout as at
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import over, some, where


@inlined
def parabola_bounds(event, history, t0, t1, t2):
    """Return whether this step is the first, whether extremes are refined by parabolas, and factors a, b that bound their rise.

    A parabola through y0, y1, y2 whose middle is extreme rises above it by at most a |y1 - y0| + b |y1 - y2|, with
    a = max(r, 1)^2 / (4 + 4 r), b = a / r and r the ratio of the two steps: only where that could beat what is kept, which is
    seldom, is it drawn. What follows a jump is compared with what was, but no parabola is drawn to it.
    """
    refine = history >= 2.0 and event != at.JUMP
    a = b = 0.0
    if refine:
        ratio = (t2 - t1) / (t1 - t0)
        a = 1.0001 * max(ratio, 1.0) ** 2 / (4.0 + 4.0 * ratio)
        b = a / ratio
    return history == 0.0, refine, a, b


@inlined
def parabola_extreme(t0, y0, t1, y1, t2, y2):
    """Return instant and value of the extreme of the parabola through three points whose middle one is extreme.

    An extreme of exactly zero stays: it belongs to a stop that lets go, whose force rests at zero behind a corner, and a
    parabola across the corner would let it pull.
    """
    left, right = over(y1 - y0, t1 - t0), over(y2 - y1, t2 - t1)
    curvature = over(right - left, t2 - t0)
    stays = (curvature == 0.0) | (y1 == 0.0)
    time = 0.5 * (t0 + t1 - left / where(stays, 1.0, curvature))
    return where(stays, t1, time), where(stays, y1, y0 + (time - t0) * (left + curvature * (time - t1)))


@inlined
def keep_larger(u, value_row, time_row, value, time, condition):
    """Keep a value and its instant in the lanes where a condition holds and it exceeds the kept value; return which."""
    better = condition & (value > u[value_row])
    u[value_row] = where(better, value, u[value_row])
    u[time_row] = where(better, time, u[time_row])
    return better


@inlined
def keep_smaller(u, value_row, time_row, value, time, condition):
    """Keep a value and its instant in the lanes where a condition holds and it is below the kept value."""
    better = condition & (value < u[value_row])
    u[value_row] = where(better, value, u[value_row])
    u[time_row] = where(better, time, u[time_row])


@njit
def update_component(u, low, high, times, refine, t0, y0, t1, y1, t2, y2):
    """Update a component's extremes by the last of three steps and, if `refine`, by the parabola through them.

    Instants stand `times` rows behind the lowest and highest value. NaN, which differs from itself, is not kept.
    """
    always = y2 == y2
    keep_larger(u, high, high + times, y2, t2, always)
    keep_smaller(u, low, low + times, y2, t2, always)
    if refine:
        top = (y1 >= y0) & (y1 >= y2)
        bottom = (y1 <= y0) & (y1 <= y2) & (where(top, 1.0, 0.0) == 0.0)
        time, value = parabola_extreme(t0, y0, t1, y1, t2, y2)
        keep_larger(u, high, high + times, value, time, top)
        keep_smaller(u, low, low + times, value, time, bottom)


@njit
def update_norm(u, m, before, last, s, j, y0, y1, y2, refine, t0, t1, t2):
    """Update a vector's largest norm by three steps, `u[before:]`, `u[last:]`, `s[j:]`, whose norms are y0, y1 and y2."""
    grows = keep_larger(u, m + at.PEAK, m + at.PEAK_TIME, y2, t2, y2 == y2)
    for c in range(3):
        u[m + at.PEAK_VECTOR + c] = where(grows, s[j + c], u[m + at.PEAK_VECTOR + c])
    if not refine:
        return
    time, value = parabola_extreme(t0, y0, t1, y1, t2, y2)
    better = keep_larger(u, m + at.PEAK, m + at.PEAK_TIME, value, time, (y1 >= y0) & (y1 >= y2))
    for c in range(3):
        v0, v1, v2 = u[before + c], u[last + c], s[j + c]
        left = over(v1 - v0, t1 - t0)
        curvature = over(over(v2 - v1, t2 - t1) - left, t2 - t0)
        there = v0 + (time - t0) * (left + curvature * (time - t1))
        u[m + at.PEAK_VECTOR + c] = where(better, there, u[m + at.PEAK_VECTOR + c])


@njit
def begin_channel(u, m, s, j, y2, time):
    """Begin the memory of a tracked vector with its first value and its norm."""
    for c in range(3):
        u[m + at.LOW + c], u[m + at.HIGH + c], u[m + at.PEAK_VECTOR + c] = s[j + c], s[j + c], s[j + c]
        u[m + at.LOW_TIME + c], u[m + at.HIGH_TIME + c] = time, time
    u[m + at.PEAK], u[m + at.PEAK_TIME] = y2, time


@inlined
def track_vector(u, m, before, last, s, j, norms, bounds, t0, t1, t2):
    """Update the peaks of a tracked vector with its value `s[j:]`; the last two stand in `u[before:]` and `u[last:]`."""
    begins, refine, a, b = bounds
    for c in range(3):
        y0, y1, y2 = u[before + c], u[last + c], s[j + c]
        above = a * abs(y1 - y0) + b * abs(y1 - y2)
        low, high = m + at.LOW + c, m + at.HIGH + c
        if some((max(y2, y1 + above) > u[high]) | (min(y2, y1 - above) < u[low])) and not begins:
            update_component(u, low, high, at.LOW_TIME - at.LOW, refine, t0, y0, t1, y1, t2, y2)
    y0, y1, y2 = norms
    if begins:
        begin_channel(u, m, s, j, y2, t2)
    elif some(max(y2, y1 + a * abs(y1 - y0) + b * abs(y1 - y2)) > u[m + at.PEAK]):
        update_norm(u, m, before, last, s, j, y0, y1, y2, refine, t0, t1, t2)


@njit
def update_travel(u, m, judged, refine, t0, t1, y2, t2):
    """Update a mount's largest combined travel, and the largest at instants that are judged."""
    keep_larger(u, m + at.FARTHEST, m + at.FARTHEST_TIME, y2, t2, y2 == y2)
    keep_larger(u, m + at.JUDGED, m + at.JUDGED_TIME, y2, t2, judged)
    if refine:
        y0, y1 = u[m + at.TRAVEL_BEFORE], u[m + at.TRAVEL_LAST]
        time, value = parabola_extreme(t0, y0, t1, y1, t2, y2)
        top = (y1 >= y0) & (y1 >= y2)
        keep_larger(u, m + at.FARTHEST, m + at.FARTHEST_TIME, value, time, top)
        keep_larger(u, m + at.JUDGED, m + at.JUDGED_TIME, value, time, top & (u[m + at.WAS_JUDGED] > 0.0))


@inlined
def track_travel(u, m, rated, p, x, record, bounds, t0, t1, t2):
    """Update a mount's largest combined travel, the sum of (deflection / rated)^2, with its deflection `x[record:]`.

    `rated[p:]` are the ratings as in the table of mounts. An instant is not judged while the mount moves along its axis in the
    way that is not rated.
    """
    begins, refine, a, b = bounds
    roll, shear, axial = x[record], x[record + 1], x[record + 2]
    along = where(axial < 0.0, rated[p + 2], rated[p + 3])
    y2 = rated[p] * roll * roll + rated[p + 1] * shear * shear + along * axial * axial
    judged = (axial == 0.0) | (along > 0.0)
    if begins:
        u[m + at.FARTHEST], u[m + at.JUDGED] = y2, where(judged, y2, -1.0)
        u[m + at.FARTHEST_TIME], u[m + at.JUDGED_TIME] = t2, t2
    else:
        y0, y1 = u[m + at.TRAVEL_BEFORE], u[m + at.TRAVEL_LAST]
        if some(max(y2, y1 + a * abs(y1 - y0) + b * abs(y1 - y2)) > u[m + at.JUDGED]):
            update_travel(u, m, judged, refine, t0, t1, y2, t2)
    u[m + at.TRAVEL_BEFORE], u[m + at.TRAVEL_LAST] = u[m + at.TRAVEL_LAST], y2
    u[m + at.WAS_JUDGED] = where(judged, 1.0, 0.0)


@njit
def track_closing(u, k, m, history, before, time, depth, speed):
    """Update the largest closing speed of a stop [m/s] by its depth [m], < 0 while open, and the depth's rate `speed`.

    `u[k:]` is its memory of touches, before `track_touch` takes up this step, `u[m:]` that of speeds. At the touch, between two
    steps, the speed is that of a straight line over time.
    """
    last = u[m + at.LAST_SPEED] if history > 0.0 else speed
    path = 0.5 * (speed + last) * (time - before)  # from the last step to this one
    fresh = (u[k + at.TOUCHES] == 0.0) | (u[k + at.LAST_TOUCH] < before)
    passed = where(fresh & (path > depth), over(depth, path), 0.0)  # since the touch
    keep_larger(u, m + at.CLOSING, m + at.CLOSING_TIME, speed, time, depth > 0.0)
    touched = speed + passed * (last - speed)
    keep_larger(u, m + at.CLOSING, m + at.CLOSING_TIME, touched, time - passed * (time - before), depth > 0.0)
    u[m + at.LAST_SPEED] = speed


@njit
def track_touch(u, k, history, before, time, depth, force, power, pushes):
    """Update the memory of a contact or stop, which `pushes` at this step: depth [m], force [N], absorbed power [W].

    `before` is the instant of the last step. The work is the sum of power times step: the trapezoidal rule, as a touch begins
    and ends without a force.
    """
    if history > 0.0:
        u[k + at.WORK] += power * (time - before)
    fresh = pushes & (u[k + at.TOUCHES] == 0.0)
    last, again = u[k + at.LAST_TOUCH], pushes & (u[k + at.TOUCHES] > 0.0)
    stays = again & (last == before) if before < time else again & (last > time)
    back = again & (last < before)
    u[k + at.TOUCHED_FOR] += where(stays, time - before, 0.0)
    u[k + at.FIRST_TOUCH] = where(fresh, time, u[k + at.FIRST_TOUCH])
    u[k + at.FROM_START] = where(fresh, 1.0 if history == 0.0 else 0.0, u[k + at.FROM_START])
    u[k + at.TOUCHES] += where(fresh | back, 1.0, 0.0)
    u[k + at.LAST_TOUCH] = where(pushes, time, last)
    keep_larger(u, k + at.FORCE_PEAK, k + at.FORCE_TIME, force, time, pushes)
    keep_larger(u, k + at.DEPTH, k + at.DEPTH_TIME, depth, time, pushes)
