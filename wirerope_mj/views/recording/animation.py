"""Periodic motions of a branch joined into one response, and the timelines of their recording."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import rerun as rr

from wirerope_mj.dynamics.frequency_response.summary import LevelSummary, along_branch
from wirerope_mj.dynamics.periodic import Branch, PeriodicOrbit
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.histories import MemorySamples
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.directions import unit_vector
from wirerope_mj.views.recording.paths import POINT, TIMELINE, Columns, Stream, nanoseconds

MOST_POINTS = 60  # motions of a branch that are recorded: small steps, a small file
ROWS = 36  # Rows of a period of the base: ten degrees each


@dataclass(frozen=True, kw_only=True)
class Strip:
    """Periodic motions at one excitation level, in order along its response curve (branch)."""

    number: int  # index of the level
    branch: Branch
    points: Integers  # which points of the branch, (n,); a short branch has some of them several times
    orbits: tuple[PeriodicOrbit, ...]  # the motion at each of these points

    @property
    def level(self) -> float:
        """Acceleration of the base [m/s^2]."""
        return abs(float(self.branch.acceleration[0]))

    @property
    def frequency(self) -> Array:
        """Frequency of the base at every motion [Hz], (n,)."""
        return self.branch.frequency[self.points]

    @property
    def amplitude(self) -> Array:
        """Largest acceleration of the payload at every motion [m/s^2], (n,)."""
        return self.branch.amplitude[self.points]


@dataclass(frozen=True, kw_only=True)
class Animation:
    """The periodic motions of one level in succession, one repetition of each."""

    strip: Strip
    starts: Array  # instant at which each motion begins [s], (n,)
    response: Response  # all in succession; its peaks are those of the largest amplitude


def strips_of(findings: list[LevelSummary]) -> list[Strip]:
    """Choose periodic motions along the response curve of every level, at most `MOST_POINTS` of each."""
    strips = []
    for number, summary in enumerate(findings):
        branch, curve = summary.level.branch, summary.curve
        if branch is not None and curve is not None:
            points = along_branch(branch, curve, MOST_POINTS)
            known = {int(i): branch.orbit(int(i)) for i in np.unique(points)}  # with its response, once computed
            orbits = tuple(known[int(i)] for i in points)
            strips.append(Strip(number=number, branch=branch, points=points, orbits=orbits))
    return strips


def animation_of(strip: Strip) -> Animation:
    """Join the periodic motions of one level into one response, one repetition of each after the other.

    Each ends at the largest acceleration of the payload, which the scene then shows at every point of the branch.
    """
    rows = ROWS * strip.branch.periods
    blocks, starts, start = [], [], 0.0
    for orbit in strip.orbits:
        samples = orbit.response.samples
        acceleration = orbit.response.bodies[strip.branch.payload].acceleration[: orbit.steps]
        largest = int(np.argmax(np.abs(acceleration @ unit_vector(strip.branch.response_direction))))
        phases = np.arange(rows) / rows
        chosen = (largest + np.round((phases + 1.0 / rows) * orbit.steps).astype(np.int64)) % orbit.steps
        block = samples.columns(0, len(samples.names))[chosen]
        block[:, 0] = start + phases * orbit.duration
        blocks.append(block)
        starts.append(start)
        start += orbit.duration
    whole = with_values(strip.orbits[int(np.argmax(strip.amplitude))].response, np.concatenate(blocks))
    return Animation(strip=strip, starts=np.array(starts), response=whole)


def with_values(like: Response, values: Array) -> Response:
    """Replace the samples of a response by values (n_t, n_columns); columns, scene and peaks stay."""
    samples = MemorySamples(names=like.samples.names, values=values)
    return replace(like, time=values[:, 0].copy(), **like.plan.parts(samples), events=(), samples=samples)


# Timelines over the branch: the number of the motion, and its frequency in integer millihertz, as rerun takes integers alone.
# Where a branch folds, the point distinguishes its motions.
FREQUENCY = "frequency_mHz"


def at_points(animation: Animation, strip: Strip) -> list[rr.TimeColumn]:
    """Make the index of a level's motions on all timelines: their numbers, frequencies [mHz] and instants."""
    columns = [rr.TimeColumn(name, sequence=numbers) for name, numbers in _numbers(strip).items()]
    return [*columns, rr.TimeColumn(TIMELINE, duration=nanoseconds(animation.starts))]


class Along(Stream):
    """A recording stream that puts what is sent in time also on timelines of motions: their number, frequency or mode.

    `starts` are the instants [s] at which the motions begin, `numbers` their numbers on these timelines.
    """

    def __init__(self, rec: Stream, starts: Array, numbers: Mapping[str, Integers]) -> None:
        super().__init__(rec)
        self._numbers = numbers
        self._starts = nanoseconds(starts).astype(np.int64)

    def send_columns(self, path: str, index: list[rr.TimeColumn], columns: Columns) -> None:
        time = index[0].as_arrow_array().cast("int64").to_numpy()
        motion = np.clip(np.searchsorted(self._starts, time, side="right") - 1, 0, None)
        more = [rr.TimeColumn(name, sequence=numbers[motion]) for name, numbers in self._numbers.items()]
        self._rec.send_columns(path, [*index, *more], columns)


def timelines(rec: Stream, animation: Animation) -> Along:
    return Along(rec, animation.starts, _numbers(animation.strip))


def _numbers(strip: Strip) -> dict[str, Integers]:
    """Number a level's motions on the timelines: by point of the branch, and by frequency [mHz]."""
    return {POINT: np.arange(strip.points.size), FREQUENCY: np.round(1e3 * strip.frequency).astype(np.int64)}
