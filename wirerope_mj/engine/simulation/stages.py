"""The base motion for the steps of a grid, segment by segment, its peaks, and windows of it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import ClassVar

import numpy as np

from wirerope_mj.engine.control.layout import SMOOTH
from wirerope_mj.engine.control.peaks import parabola_extreme
from wirerope_mj.engine.response.peaks import Peak
from wirerope_mj.engine.simulation.grid import SAME_TIME, Grid
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, ArrayLike, Entries, Integers
from wirerope_mj.motions import BaseMotion

# instants at which a motion is evaluated at once: large enough for NumPy, small enough for the memory of many motions
POINTS = 4096


class RunningPeak:
    """Running extremes of a vector's norm and components over blocks of instants; zero before the first block."""

    def __init__(self) -> None:
        self._norm = (0.0, 0.0)  # value and instant, as in the next two
        self._lows, self._highs = [(0.0, 0.0)] * 3, [(0.0, 0.0)] * 3
        self._vector = np.zeros(3)

    def add(self, times: Array, vectors: Array) -> None:
        """Add vectors (n, 3) at ascending instants (n,) [s]; neighbouring instants may coincide."""
        components = np.ascontiguousarray(vectors.T)
        x, y, z = components
        norms = np.sqrt(x * x + y * y + z * z)
        largest = int(norms.argmax())
        norm = _extreme(times, norms, largest)
        if norm[0] > self._norm[0]:
            self._norm = norm
            self._vector = norm[0] * (components[:, largest] / max(float(norms[largest]), 1e-300))
        for axis, component in enumerate(components):
            low = _extreme(times, component, int(component.argmin()))
            high = _extreme(times, component, int(component.argmax()))
            if low[0] < self._lows[axis][0]:
                self._lows[axis] = low
            if high[0] > self._highs[axis][0]:
                self._highs[axis] = high

    @property
    def peak(self) -> Peak:
        """Peak of the vector over all blocks of instants so far."""
        (minimum, minimum_time), (maximum, maximum_time) = (np.transpose(ends) for ends in (self._lows, self._highs))
        value, time = self._norm
        return Peak(
            value=value, time=time, vector=self._vector,
            minimum=minimum, minimum_time=minimum_time, maximum=maximum, maximum_time=maximum_time,
        )  # fmt: skip


def _extreme(times: Array, values: Array, i: int) -> tuple[float, float]:
    """Return value and instant of the extreme at index i, refined by a parabola unless a corner stands beside it."""
    value, time = values.item(i), times.item(i)
    before, after = i - 1, i + 1
    while after < times.size and times.item(after) == time:  # segments share their ends
        after += 1
    while before >= 0 and times.item(before) == time:
        before -= 1
    if before < 0 or after == times.size:
        return value, time
    earlier, later = times.item(before), times.item(after)
    if 0.1 < (later - time) / (time - earlier) < 10.0:  # the two limits of a corner stand 2e-10 s apart
        time, value = parabola_extreme(earlier, values.item(before), time, value, later, values.item(after))
    return value, time


@dataclass(frozen=True, kw_only=True)
class Segment:
    """Base motion in a segment: positions and rates at its start, (n_driven,), accelerations at half steps, (2 steps + 1, 3).

    At the same half steps `turns` are the second derivatives of roll, pitch and yaw, (2 steps + 1, 3), and `forces` forces and
    moments on the payload, (2 steps + 1, n_forces, 6), or nothing.
    """

    number: int
    positions: Array
    rates: Array
    accelerations: Array
    turns: Array
    forces: Array


@dataclass(frozen=True, kw_only=True)
class Stages:
    """Base motion in consecutive segments, at the stages (half steps) of their Runge-Kutta steps.

    At a corner, velocity and accelerations are those inside the segment.
    """

    first: int  # number of the first segment
    positions: Array  # of the driven slides at the start of every segment, as the motion has them, (n, n_driven)
    rates: Array
    # of the base at all half steps, 2 steps + 1 for every segment, one segment after the other, (n_points, 3)
    accelerations: Array
    turns: Array  # second derivatives of roll, pitch, yaw at the same instants, (n_points, 3); (0,) where it has no hinges
    # forces and moments at the sites for them, at the same instants, (n_points, n_forces, 6), or (0,) without any
    forces: Array
    ends: Integers  # where a segment's accelerations end among them, (n,)


def along_slides(drive: Array, vectors: Array) -> Array:
    """Map vectors of the base's motion (n, 3) to coordinates of its driven slides, (n, n_driven).

    Not a matrix product: its rounding depends on how many vectors are multiplied at once.
    """
    x, y, z = vectors[:, :, np.newaxis].transpose(1, 0, 2)
    return x * drive[:, 0] + y * drive[:, 1] + z * drive[:, 2]


@dataclass(frozen=True)
class Drive:
    """Matrices that map a base motion to the coordinates of the base's slides and hinges."""

    slides: Array  # `Tables.drive`, (n_driven, 3)
    hinges: Array  # `Tables.turning`, (n_driven, 3)

    def positions(self, motion: BaseMotion, times: Array) -> Array:
        """Return the driven coordinates [m or rad] at the times, (n_t, n_driven)."""
        moved = along_slides(self.slides, motion.displacement(times))
        return moved + along_slides(self.hinges, motion._angles(times, 0)) if motion.rotates else moved

    def rates(self, motion: BaseMotion, times: Array) -> Array:
        """Return the rates of the driven coordinates at the times, (n_t, n_driven)."""
        moved = along_slides(self.slides, motion.velocity(times))
        return moved + along_slides(self.hinges, motion._angles(times, 1)) if motion.rotates else moved

    def turns(self, motion: BaseMotion, times: Array) -> Array:
        """Return the second derivatives of roll, pitch and yaw at the times, (n_t, 3); (0,) where the base has no hinges."""
        return motion._angles(times, 2) if self.hinges.any() else np.empty(0)


def drive_of(system: System) -> Drive:
    return Drive(system.assembly.tables.drive, system.assembly.tables.turning)


class StageTables:
    """Base motion at the half steps of all Runge-Kutta steps, tabulated block by block, and its peak acceleration so far."""

    def __init__(self, motion: BaseMotion, drive: Drive, sites: Sequence[str] = ()) -> None:
        """Prepare the tables of a base motion; forces may act at `sites`."""
        self._motion, self._drive, self._running = motion, drive, RunningPeak()
        self._sites = sites if motion.loaded_sites else ()

    @property
    def peak(self) -> Peak:
        """Peak of the base acceleration, both limits of a jump included; a step grid would miss the left one."""
        return self._running.peak

    def blocks(self, grid: Grid) -> Iterator[Stages]:
        """Yield the base motion in all segments of a grid, many segments at once."""
        points = 2 * grid.steps + 1
        total, first, begin, end = np.cumsum(points), 0, 0, 0
        low = grid.start + np.where(grid.event != SMOOTH, SAME_TIME, 0.0)
        high = grid.stop - np.where(grid.corner_after, SAME_TIME, 0.0)
        while first < points.size:
            before = int(total[first - 1]) if first else 0
            last = max(int(np.searchsorted(total, before + POINTS, side="right")), first + 1)
            if last > end:  # starts of many blocks at once: a motion costs about the same for a few as for many
                begin, end = first, first + POINTS
                positions = self._drive.positions(self._motion, grid.start[begin:end])
                rates = self._drive.rates(self._motion, low[begin:end])
            block = slice(first, last)
            times = _half_steps(grid.start[block], grid.stop[block], points[block], low[block], high[block])
            accelerations = self._motion.acceleration(times)
            self._running.add(times, accelerations)
            yield Stages(
                first=first, positions=positions[first - begin : last - begin],
                rates=rates[first - begin : last - begin], accelerations=accelerations,
                turns=self._drive.turns(self._motion, times), forces=loads_at(self._motion, self._sites, times),
                ends=total[block] - before,
            )  # fmt: skip
            first = last

    def segments(self, grid: Grid) -> Iterator[Segment]:
        for stages in self.blocks(grid):
            ends = [0, *stages.ends.tolist()]
            for number, (begin, end) in enumerate(pairwise(ends)):
                yield Segment(
                    number=stages.first + number, positions=stages.positions[number], rates=stages.rates[number],
                    accelerations=stages.accelerations[begin:end], turns=stages.turns[begin:end],
                    forces=stages.forces[begin:end],
                )  # fmt: skip


def distinct_motions(motions: Sequence[BaseMotion]) -> tuple[list[BaseMotion], list[int]]:
    """Return the distinct motion objects, each to be evaluated once, and the index of each given motion among them."""
    distinct = {id(motion): motion for motion in motions}
    numbers = {key: number for number, key in enumerate(distinct)}
    return list(distinct.values()), [numbers[id(motion)] for motion in motions]


def events_key(motion: BaseMotion) -> tuple[bytes, tuple[float, ...]]:
    """Return a key that is equal for motions with the same corners and velocity jumps, and so the same time grid."""
    return motion.corners.tobytes(), tuple(time for time, _ in motion.velocity_jumps)


def loads_at(motion: BaseMotion, sites: Sequence[str], times: Array) -> Array:
    """Return forces [N] and moments [N m] at the sites, along their axes, (n_times, n_sites, 6); (0,) without a site."""
    if not sites:
        return np.empty(0)
    return np.stack([motion.load(site, times) for site in sites], axis=1)


def _half_steps(start: Array, stop: Array, points: Integers, low: Array, high: Array) -> Array:
    """Return the instants of all half steps, one segment after the other, kept between each segment's `low` and `high`."""
    if (points == points[0]).all():  # as in most blocks: the same with rows for segments, and four times as fast
        fraction = np.arange(float(points[0])) / (points[0] - 1)
        rows = start[:, np.newaxis] + (stop - start)[:, np.newaxis] * fraction
        return np.minimum(np.maximum(rows, low[:, np.newaxis]), high[:, np.newaxis]).ravel()
    number = np.arange(float(points.sum())) - np.repeat(np.cumsum(points) - points, points)
    begin, length, last, least, most = (part.repeat(points) for part in (start, stop - start, points - 1, low, high))
    return np.minimum(np.maximum(begin + length * (number / last), least), most)


@dataclass(frozen=True, eq=False)
class Later(BaseMotion):
    """`motion` whose time begins at the instant `at` [s]; it is stepped through and never stored."""

    motion: BaseMotion
    at: float
    kind: ClassVar[str] = "later"

    @property
    def duration(self) -> float:  # type: ignore[override]
        return self.motion.end - self.at

    def _derivative(self, t: Array, order: int) -> Array:
        return self.motion._derivative(t + self.at, order)

    def _angles(self, t: Array, order: int) -> Array:
        return self.motion._angles(t + self.at, order)

    @property
    def rotates(self) -> bool:
        return self.motion.rotates

    @property
    def centre(self) -> tuple[float, float, float]:
        return self.motion.centre

    @property
    def corners(self) -> Array:
        return self.motion.corners - self.at

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        return tuple((time - self.at, jump) for time, jump in self.motion.velocity_jumps)

    @property
    def loaded_sites(self) -> tuple[str, ...]:
        return self.motion.loaded_sites

    def load(self, site: str, time: ArrayLike) -> Array:
        return self.motion.load(site, np.asarray(time) + self.at)

    # of a window, which is only stepped through, these say nothing
    description, events, shortest_time, directions = "", (), math.inf, np.eye(3)

    def _parameters(self, files: Mapping[Path, str]) -> Entries:
        raise NotImplementedError("a window of a motion is not stored")
