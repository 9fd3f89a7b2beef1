"""Steps through cycles of an excitation, of which nothing is kept but the extremes of every channel."""

import numpy as np

from wirerope_mj.engine.control import layout as control
from wirerope_mj.engine.control.observer import track_component
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.observe import HISTORY, TIME_1, TIME_2
from wirerope_mj.engine.kernel.steps import base_at, forward, observe, place_base, take_step, watch
from wirerope_mj.foundation.jit import inlined, njit
from wirerope_mj.foundation.lanes import lane, rows, spread, table

NO_SAMPLES = np.zeros((0, 0, 0))  # room for the samples that are not wanted


@inlined
def track_base(base, clock, time, motion, which, point):
    """Update the extremes of the base's acceleration, as those of a channel."""
    history = int(clock[HISTORY])
    for c in range(3):
        now = motion[which, point, c]
        track_component(base, 0, c, history, clock[TIME_2], clock[TIME_1], time, now)
        base[control.BEFORE + c], base[control.LAST + c] = base[control.LAST + c], now


@inlined
def close_cycle(lay, work, base, low, high):
    """Take the extremes of the first lane's channels, (n_channels + 1, 3), the base's last, and begin to look for new ones."""
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
            watch(lay, fix, y, work)
            if clock[HISTORY] == 0.0 or clock[TIME_1] != time:
                track_base(base, clock, time, motion, own, point)
                observe(lay, fix, num, y, work, clock, time, out, -1)
            middle, end = base_at(motion, which, True, point + 1), base_at(motion, which, True, point + 2)
            take_step(lay, fix, num, y, work, middle, end, h)
            point += 2
        if closes[segment]:
            time = grid[1, segment]
            forward(lay, fix, num, y, work, base_at(motion, which, True, point))
            watch(lay, fix, y, work)
            track_base(base, clock, time, motion, own, point)
            observe(lay, fix, num, y, work, clock, time, out, -1)
            close_cycle(lay, work, base, low[cycle], high[cycle])
            cycle += 1
            if lane(work[lay[at.FAILED]], 0) != 0.0:
                return cycle
        point = ends[segment]
    return cycle
