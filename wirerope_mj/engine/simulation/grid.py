"""The time grid of a simulation, known before it starts."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count

import numpy as np

from wirerope_mj.engine.control.layout import CORNER, JUMP, MAX_STEPS, SMOOTH
from wirerope_mj.foundation.arrays import Array, Booleans, Integers
from wirerope_mj.motions import BaseMotion

# instants closer than this are one [s]; also how far a corner's one-sided limits are evaluated from it
SAME_TIME = 1e-10

# instants of a grid that are made at once: runs up to this long have one block, and longer ones need no more memory
BLOCK = 1 << 15


@dataclass(frozen=True, kw_only=True)
class Grid:
    """Segments of equal steps that never straddle a sample or a corner of the motion."""

    start: Array  # ends of every segment [s], (n_p,)
    stop: Array
    steps: Integers  # number of steps in every segment, (n_p,)
    sampled: Booleans  # whether the segment starts at a sample instant, (n_p,)
    event: Array  # SMOOTH, CORNER or JUMP of the motion at the segment's start, (n_p,)
    corner_after: Booleans  # whether the motion has a corner at the segment's end, (n_p,)

    @classmethod
    def empty(cls) -> "Grid":
        none, no = np.zeros(0), np.zeros(0, dtype=bool)
        return cls(start=none, stop=none, steps=np.zeros(0, dtype=np.int64), sampled=no, event=none, corner_after=no)

    def with_events_of(self, motion: BaseMotion) -> "Grid":
        return replace(self, event=_events(motion, self.start), corner_after=_events(motion, self.stop) != SMOOTH)

    @property
    def largest_step(self) -> float:
        """Largest step [s]."""
        return float(((self.stop - self.start) / self.steps).max()) if self.start.size else 0.0


@dataclass(frozen=True, kw_only=True)
class TimeGrid:
    """The segments of a whole run, made block by block: a record may have millions of corners."""

    start: float  # ends of the run [s]
    stop: float
    sample_rate: float  # of the samples [Hz]
    timestep: float  # largest step [s]
    motion: BaseMotion  # whose events the segments carry
    corners: Array  # instants at which segments end, those of the motion among them [s], (n_c,)
    sample_times: Array  # sample instants [s], (n_t,); the last may be the end of the last segment

    def blocks(self) -> Iterator[Grid]:
        """Yield the segments of the run in consecutive blocks."""
        samples, corners = self.sample_times, self.corners
        low, high = np.searchsorted(corners, [self.start - SAME_TIME, self.stop + SAME_TIME])
        corners = corners[low:high]
        i = j = 0
        instants, sampled = np.zeros(0), np.zeros(0, dtype=bool)  # where segments begin and end
        while i < samples.size or j < corners.size or not instants.size:
            for size in count(BLOCK):  # up to where instants that are one stay together
                rest = [float(times[k + size]) for times, k in ((samples, i), (corners, j)) if k + size < times.size]
                limit = min(rest, default=np.inf)
                i_next, j_next = int(np.searchsorted(samples, limit)), int(np.searchsorted(corners, limit))
                before = max([*samples[i:i_next][-1:], *corners[j:j_next][-1:]], default=-np.inf)
                if limit - before > 2.0 * SAME_TIME:
                    break
            ends = [self.start] if not instants.size else []
            ends += [self.stop] if i_next == samples.size and j_next == corners.size else []
            breaks = _breaks(samples[i:i_next], corners[j:j_next], np.array(ends))
            instants, sampled = (np.concatenate(parts) for parts in zip((instants, sampled), breaks, strict=True))
            start, stop, steps, interval = divide_intervals(instants, self.timestep)
            event = _events(self.motion, np.append(start, stop[-1:]))  # each but the last ends where the next one starts
            is_first = np.diff(interval, prepend=-1) != 0
            yield Grid(
                start=start, stop=stop, steps=steps, sampled=sampled[interval] & is_first, event=event[:-1],
                corner_after=event[1:] != SMOOTH,
            )  # fmt: skip
            instants, sampled, i, j = instants[-1:], sampled[-1:], i_next, j_next


def time_grid(
    *, start: float, duration: float, sample_rate: float, timestep: float, motion: BaseMotion,
    corners: Sequence[float] | Array = (),
) -> TimeGrid:  # fmt: skip
    """Return the grid from `start` to `start + duration` [s].

    Sample instants k / sample_rate are joined with the motion's corners and with `corners` [s], at which segments end
    although the motion is smooth there; each interval is cut into equal steps <= timestep.
    """
    end = start + duration
    first = int(np.ceil((start - SAME_TIME) * sample_rate))
    last = int(np.floor((end + SAME_TIME) * sample_rate))
    samples = np.arange(first, last + 1) / sample_rate
    return TimeGrid(
        start=start, stop=end, sample_rate=sample_rate, timestep=timestep, motion=motion, sample_times=samples,
        corners=merge_instants(motion.corners, np.asarray(corners, dtype=np.float64)),
    )  # fmt: skip


def merge_instants(*corners: Array) -> Array:
    """Merge several arrays of instants [s] in order, without repetitions."""
    some = [instants for instants in corners if instants.size]
    return np.unique(np.concatenate(some)) if len(some) > 1 else some[0] if some else np.zeros(0)


def _breaks(samples: Array, corners: Array, ends: Array) -> tuple[Array, Booleans]:
    """Merge the instants [s] of samples, corners and the run's ends, and tell which of them are sampled, (n,) each."""
    # Samples first: where an instant is both, it must carry the sample's exact time.
    instants = np.concatenate([samples, corners, ends])
    order = np.argsort(instants, kind="stable")
    times, is_sample = instants[order], order < samples.size
    group = np.concatenate([[0], np.cumsum(np.diff(times) > SAME_TIME)])
    n_groups = int(group[-1]) + 1
    breaks, sampled = np.zeros(n_groups), np.zeros(n_groups, dtype=bool)
    breaks[group[::-1]] = times[::-1]  # the first of a group
    breaks[group[is_sample]] = times[is_sample]
    sampled[group[is_sample]] = True
    return breaks, sampled


def _events(motion: BaseMotion, times: Array) -> Array:
    """Classify instants [s] of a motion as SMOOTH, CORNER or JUMP, (n,)."""
    corners = motion.corners
    next_one = np.searchsorted(corners, times - SAME_TIME)
    near = np.append(corners, np.inf)[next_one] <= times + SAME_TIME
    event = np.where(near, CORNER, SMOOTH)
    for time, _ in motion.velocity_jumps:
        event[np.abs(times - time) <= SAME_TIME] = JUMP
    return event


def divide_intervals(instants: Array, timestep: float, *, least: int = 1) -> tuple[Array, Array, Integers, Integers]:
    """Cut the intervals between instants [s] into equal steps, and long intervals into segments of at most `MAX_STEPS` steps.

    Returns start and stop [s], number of steps, and interval of every segment, (n_p,) each.
    """
    length = np.diff(instants)
    # One part in 1e9: a step that fits but for rounding must not cost another one.
    steps = np.maximum(np.ceil(length / timestep * (1.0 - 1e-9)), least).astype(np.int64)
    segments = -(-steps // MAX_STEPS)
    interval = np.repeat(np.arange(length.size), segments)
    number = np.arange(interval.size) - np.repeat(np.cumsum(segments) - segments, segments)
    start = instants[interval] + length[interval] * (number / segments[interval])
    return start, np.append(start[1:], instants[1:][-1:]), (-(-steps // segments))[interval], interval
