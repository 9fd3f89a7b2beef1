"""The base motion for the steps of a grid, piece by piece."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.control.layout import SMOOTH
from wirerope_mj.control.observer import parabola_extreme
from wirerope_mj.excitation import BaseMotion
from wirerope_mj.response.peaks import Peak
from wirerope_mj.simulation.grid import SAME_TIME, Grid

Array = npt.NDArray[np.float64]

BLOCK = 2048
"""Pieces whose base accelerations are evaluated at once: large enough for NumPy, small enough for long runs' memory."""


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

    def __init__(self, motion: BaseMotion) -> None:
        self._motion = motion
        nothing = np.zeros(3)
        self.peak = Peak(
            value=0.0, time=0.0, vector=nothing,
            minimum=nothing, minimum_time=nothing, maximum=nothing, maximum_time=nothing,
        )  # fmt: skip

    def pieces(self, grid: Grid) -> Iterator[Piece]:
        """Yield every piece of a grid."""
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
