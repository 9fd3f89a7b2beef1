"""The time grid of a simulation, known before it starts."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.control.layout import CORNER, JUMP, MAX_STEPS, SMOOTH
from wirerope_mj.control.observer import parabola_extreme
from wirerope_mj.excitation import BaseMotion
from wirerope_mj.response.peaks import Peak

Array = npt.NDArray[np.float64]

SAME_TIME = 1e-10
"""Instants closer than this are one [s]; also how far a corner's one-sided limits are evaluated from it."""

BLOCK = 2048
"""Pieces whose base accelerations are evaluated at once: large enough for NumPy, small enough for long runs' memory."""


@dataclass(frozen=True, kw_only=True)
class Grid:
    """Pieces of equal steps that never straddle a sample or a corner of the motion.

    Attributes:
        start, stop: ends of every piece [s], (n_p,).
        steps: number of steps in every piece, (n_p,).
        sampled: whether the piece starts at a sample instant, (n_p,).
        event: SMOOTH, CORNER or JUMP of the motion at the piece's start, (n_p,).
        corner_after: whether the motion has a corner at the piece's end, (n_p,).
        sample_times: sample instants [s], (n_t,); the last may be the end of the last piece.
    """

    start: Array
    stop: Array
    steps: npt.NDArray[np.int64]
    sampled: npt.NDArray[np.bool_]
    event: Array
    corner_after: npt.NDArray[np.bool_]
    sample_times: Array

    @property
    def largest_step(self) -> float:
        """Largest step [s]."""
        return float(((self.stop - self.start) / self.steps).max()) if self.start.size else 0.0


def time_grid(*, start: float, duration: float, sample_rate: float, timestep: float, motion: BaseMotion) -> Grid:
    """Return the grid from `start` to `start + duration` [s].

    Sample instants k / sample_rate are joined with the motion's corners; each interval is cut into equal steps <= timestep.
    """
    end = start + duration
    first = int(np.ceil((start - SAME_TIME) * sample_rate))
    last = int(np.floor((end + SAME_TIME) * sample_rate))
    samples = np.arange(first, last + 1) / sample_rate
    corners = motion.corners
    corners = corners[(corners >= start - SAME_TIME) & (corners <= end + SAME_TIME)]
    # Samples first: where an instant is both, it must carry the sample's exact time.
    instants = np.concatenate([samples, corners, [start, end]])
    order = np.argsort(instants, kind="stable")
    times, is_sample = instants[order], order < samples.size
    is_corner = (order >= samples.size) & (order < samples.size + corners.size)
    group = np.concatenate([[0], np.cumsum(np.diff(times) > SAME_TIME)])
    n_groups = int(group[-1]) + 1
    breaks, sampled, corner = np.zeros(n_groups), np.zeros(n_groups, dtype=bool), np.zeros(n_groups, dtype=bool)
    breaks[group[::-1]] = times[::-1]  # the first of a group
    breaks[group[is_sample]] = times[is_sample]
    sampled[group[is_sample]], corner[group[is_corner]] = True, True
    event = np.where(corner, CORNER, SMOOTH)
    for time, _ in motion.velocity_jumps:
        event[np.abs(breaks - time) <= SAME_TIME] = JUMP
    return _cut(breaks, sampled, event, timestep)


def _cut(breaks: Array, sampled: npt.NDArray[np.bool_], event: Array, timestep: float) -> Grid:
    """Return the pieces between `breaks`, long intervals divided so that one stage table serves each piece."""
    length = np.diff(breaks)
    # One part in 1e9: a step that fits but for rounding must not cost another one.
    steps = np.maximum(np.ceil(length / timestep * (1.0 - 1e-9)), 1).astype(np.int64)
    pieces = -(-steps // MAX_STEPS)
    steps_per_piece = -(-steps // pieces)
    which = np.repeat(np.arange(length.size), pieces)
    place = np.arange(which.size) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    start = breaks[which] + length[which] * (place / pieces[which])
    is_first, is_last = place == 0, place == pieces[which] - 1
    stop = np.where(is_last, breaks[which + 1], breaks[which] + length[which] * ((place + 1) / pieces[which]))
    ends_at_corner = event[1:] != SMOOTH
    return Grid(
        start=start,
        stop=stop,
        steps=steps_per_piece[which],
        sampled=sampled[which] & is_first,
        event=np.where(is_first, event[which], SMOOTH),
        corner_after=ends_at_corner[which] & is_last,
        sample_times=breaks[sampled],
    )


@dataclass(frozen=True, kw_only=True)
class Piece:
    """The base in one piece: at its start displacement and velocity (3,), at its half steps accelerations (2 steps + 1, 3).

    At a corner, velocity and accelerations are those inside the piece.
    """

    number: int
    displacement: Array
    velocity: Array
    accelerations: Array


class StageTables:
    """The base motion piece by piece, evaluated block by block, and the extremes of its acceleration so far.

    Attributes:
        peak: Peak of the base acceleration, both limits of a jump included; a step grid would miss the left one.
    """

    def __init__(self, grid: Grid, motion: BaseMotion) -> None:
        self._grid, self._motion = grid, motion
        nothing = np.zeros(3)
        self.peak = Peak(
            value=0.0, time=0.0, vector=nothing,
            minimum=nothing, minimum_time=nothing, maximum=nothing, maximum_time=nothing,
        )  # fmt: skip

    def __iter__(self) -> Iterator[Piece]:
        """Yield every piece."""
        grid = self._grid
        for first in range(0, grid.start.size, BLOCK):
            block = slice(first, first + BLOCK)
            points = 2 * grid.steps[block] + 1
            ends = np.cumsum(points)
            which = np.repeat(np.arange(points.size), points)
            place = (np.arange(which.size) - (ends - points)[which]) / (points - 1)[which]
            start, stop = grid.start[block], grid.stop[block]
            low = start + np.where(grid.event[block] != SMOOTH, SAME_TIME, 0.0)
            high = stop - np.where(grid.corner_after[block], SAME_TIME, 0.0)
            times = np.clip(start[which] + (stop - start)[which] * place, low[which], high[which])
            accelerations = self._motion.acceleration(times)
            self.peak = _larger(self.peak, times, accelerations)
            displacement, velocity = self._motion.displacement(start), self._motion.velocity(low)
            for piece in range(points.size):
                yield Piece(
                    number=first + piece,
                    displacement=displacement[piece],
                    velocity=velocity[piece],
                    accelerations=accelerations[ends[piece] - points[piece] : ends[piece]],
                )


def _larger(peak: Peak, times: Array, vectors: Array) -> Peak:
    """Return the peak of what `peak` has seen and of `vectors` (n, 3) at `times` (n,)."""
    kept = np.concatenate([[True], np.diff(times) > 0.0])  # neighbouring pieces share their ends
    times, vectors = times[kept], vectors[kept]
    norms = np.linalg.norm(vectors, axis=1)
    value, time = _extreme(times, norms)
    lows = [_extreme(times, -component) for component in vectors.T]
    highs = [_extreme(times, component) for component in vectors.T]
    low, high = -np.array([v for v, _ in lows]), np.array([v for v, _ in highs])
    lower, higher, grows = low < peak.minimum, high > peak.maximum, value > peak.value
    direction = vectors[int(np.argmax(norms))] / max(float(norms.max()), 1e-300)
    return Peak(
        value=value if grows else peak.value,
        time=time if grows else peak.time,
        vector=value * direction if grows else peak.vector,
        minimum=np.where(lower, low, peak.minimum),
        minimum_time=np.where(lower, [t for _, t in lows], peak.minimum_time),
        maximum=np.where(higher, high, peak.maximum),
        maximum_time=np.where(higher, [t for _, t in highs], peak.maximum_time),
    )


def _extreme(times: Array, values: Array) -> tuple[float, float]:
    """Return the largest value and its instant, refined by a parabola unless a corner stands beside it."""
    i = int(np.argmax(values))
    if 0 < i < values.size - 1:
        before, after = times[i] - times[i - 1], times[i + 1] - times[i]
        if 0.1 < after / before < 10.0:  # the two limits of a corner stand 2e-10 s apart
            time, value = parabola_extreme(
                times[i - 1], values[i - 1], times[i], values[i], times[i + 1], values[i + 1]
            )
            return float(value), float(time)
    return float(values[i]), float(times[i])
