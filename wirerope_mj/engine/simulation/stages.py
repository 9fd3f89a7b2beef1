"""The base motion for the steps of a grid, segment by segment."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.engine.control.layout import SMOOTH
from wirerope_mj.engine.control.observer import parabola_extreme
from wirerope_mj.engine.response.peaks import Peak
from wirerope_mj.engine.simulation.grid import SAME_TIME, Grid
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions import BaseMotion

POINTS = 4096
"""Instants at which a motion is evaluated at once: large enough for NumPy, small enough for the memory of many motions."""


@dataclass(frozen=True, kw_only=True)
class Segment:
    """The base in one segment, as `Stages` has it: positions and rates (n_driven,), accelerations (2 steps + 1, 3)."""

    number: int
    positions: Array
    rates: Array
    accelerations: Array


@dataclass(frozen=True, kw_only=True)
class Stages:
    """The base in segments that follow each other.

    At a corner, velocity and accelerations are those inside the segment.

    Attributes:
        first: number of the first segment.
        positions, rates: of the driven slides at the start of every segment, as the motion has them, (n, n_driven).
        accelerations: of the base at all half steps, 2 steps + 1 for every segment, one segment after the other, (n_points, 3).
        ends: where a segment's accelerations end among them, (n,).
    """

    first: int
    positions: Array
    rates: Array
    accelerations: Array
    ends: npt.NDArray[np.int64]

    def segments(self, begin: int = 0, end: int | None = None) -> Iterator[Segment]:
        """Yield the segments from `begin` to `end`, counted from the first."""
        ends = [0, *self.ends.tolist()]
        for segment in range(len(ends) - 1)[begin:end]:
            yield Segment(
                number=self.first + segment,
                positions=self.positions[segment],
                rates=self.rates[segment],
                accelerations=self.accelerations[ends[segment] : ends[segment + 1]],
            )


class StageTables:
    """The base motion segment by segment, evaluated block by block, and the extremes of its acceleration so far.

    Attributes:
        peak: Peak of the base acceleration, both limits of a jump included; a step grid would miss the left one.
    """

    def __init__(self, motion: BaseMotion, drive: Array) -> None:
        """Prepare for the segments of grids; `drive` gives slides from base vectors, (n_driven, 3)."""
        self._motion, self._drive = motion, drive
        nothing = np.zeros(3)
        self.peak = Peak(
            value=0.0, time=0.0, vector=nothing,
            minimum=nothing, minimum_time=nothing, maximum=nothing, maximum_time=nothing,
        )  # fmt: skip

    def blocks(self, grid: Grid) -> Iterator[Stages]:
        """Yield all segments of a grid, many at once; where they are parted depends on the number of steps alone."""
        points = 2 * grid.steps + 1
        total, first = np.cumsum(points), 0
        while first < points.size:
            before = int(total[first - 1]) if first else 0
            last = max(int(np.searchsorted(total, before + POINTS, side="right")), first + 1)
            yield self._stages(grid, first, slice(first, last))
            first = last

    def segments(self, grid: Grid) -> Iterator[Segment]:
        """Yield every segment of a grid."""
        for stages in self.blocks(grid):
            yield from stages.segments()

    def _stages(self, grid: Grid, first: int, block: slice) -> Stages:
        points = 2 * grid.steps[block] + 1
        ends = np.cumsum(points)
        which = np.repeat(np.arange(points.size), points)
        fraction = (np.arange(which.size) - (ends - points)[which]) / (points - 1)[which]
        start, stop = grid.start[block], grid.stop[block]
        low = start + np.where(grid.event[block] != SMOOTH, SAME_TIME, 0.0)
        high = stop - np.where(grid.corner_after[block], SAME_TIME, 0.0)
        times = np.clip(start[which] + (stop - start)[which] * fraction, low[which], high[which])
        accelerations = self._motion.acceleration(times)
        self.peak = _larger(self.peak, times, accelerations)
        return Stages(
            first=first,
            positions=along_slides(self._drive, self._motion.displacement(start)),
            rates=along_slides(self._drive, self._motion.velocity(low)),
            accelerations=accelerations,
            ends=ends,
        )


def along_slides(drive: Array, vectors: Array) -> Array:
    """Return what base vectors (n, 3) are for the driven slides, (n, n_driven).

    Not a matrix product: its rounding depends on how many vectors are multiplied at once.
    """
    x, y, z = vectors[:, :, np.newaxis].transpose(1, 0, 2)
    return x * drive[:, 0] + y * drive[:, 1] + z * drive[:, 2]


def _larger(peak: Peak, times: Array, vectors: Array) -> Peak:
    """Return the peak of what `peak` has seen and of `vectors` (n, 3) at `times` (n,)."""
    kept = np.concatenate([[True], np.diff(times) > 0.0])  # neighbouring segments share their ends
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
