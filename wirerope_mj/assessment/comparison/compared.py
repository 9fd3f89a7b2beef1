"""Runs beside each other: what they share by name, and how their histories differ."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from wirerope_mj.assessment.criteria import Verdict
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class ComparedRun:
    """One of the runs."""

    name: str  # of the run in every output
    response: Response  # its response, on the timeline that all runs share
    moved: float  # by how much it was moved to that timeline [s]
    verdicts: tuple[Verdict, ...]  # on it


@dataclass(frozen=True, kw_only=True, order=True)
class Component:
    """Something whose acceleration is compared: the base, which every run may call as it likes, a body or a point."""

    kind: Literal["base", "body", "point"]
    name: str

    @property
    def label(self) -> str:
        """Name in plots and tables."""
        return f"point {self.name}" if self.kind == "point" else self.name

    def acceleration(self, response: Response) -> Array:
        """Return its acceleration [m/s^2], (n_t, 3)."""
        if self.kind == "base":
            return response.base.acceleration
        return (response.points if self.kind == "point" else response.bodies)[self.name].acceleration

    def peak(self, response: Response) -> Peak:
        """Return the peak of its acceleration."""
        peaks = response.peaks
        if self.kind == "point":
            return peaks.points[self.name].acceleration
        return peaks.bodies[response.scene.base if self.kind == "base" else self.name].acceleration


BASE = Component(kind="base", name="base")
Subject = Component | str  # A component, or a mount by its name


def subjects_of(response: Response) -> list[Subject]:
    """Return the base, if there is one, the other bodies, the points, and the mounts that are no stops."""
    base = response.scene.base
    return [
        *([BASE] if base in response.peaks.bodies else []),
        *(Component(kind="body", name=name) for name in response.peaks.bodies if name != base),
        *(Component(kind="point", name=name) for name in response.peaks.points),
        *(mount.name for mount in response.scene.isolating),
    ]


_BLOCK = 64  # columns that are compared at once


@dataclass(frozen=True, kw_only=True)
class HistoryDifference:
    """Largest difference of two histories."""

    subject: Subject  # component or mount
    run: str  # the other run; the histories are compared with those of the first
    value: float  # largest norm of the difference [m/s^2] or [m]
    time: float  # its instant [s]
    ratio: float  # to the first run's peak; NaN if that is zero


def largest_differences(runs: Sequence[ComparedRun], subjects: Iterable[Subject]) -> tuple[HistoryDifference, ...]:
    """Return the largest difference of every other run to the first, for each subject of the first, the largest first."""
    first, *others = runs
    own = subjects_of(first.response)
    entries = []
    for subject in subjects:
        for run in others if subject in own else ():
            if subject not in subjects_of(run.response):
                continue
            time, distance = difference(subject, first, run)
            if time.size:
                row = int(distance.argmax())
                peaks = first.response.peaks.mounts
                peak = peaks[subject].deflection if isinstance(subject, str) else subject.peak(first.response)
                value = float(distance[row])
                ratio = value / peak.value if peak.value else np.nan
                entries.append(
                    HistoryDifference(subject=subject, run=run.name, value=value, time=float(time[row]), ratio=ratio)
                )
    return tuple(sorted(entries, key=lambda entry: -np.nan_to_num(entry.ratio)))


def difference(subject: Subject, first: ComparedRun, other: ComparedRun) -> tuple[Array, Array]:
    """Return instants of the first run that both have [s], (n,), and the norm of the difference there, (n,).

    Accelerations [m/s^2] of a component, deflections [m] of a mount; the other run is taken linearly between its samples.
    """
    start, end = (pick(first.response.time[row], other.response.time[row]) for pick, row in ((max, 0), (min, -1)))
    time = first.response.time
    both = (time >= start) & (time <= end)
    time, values = time[both], _history(subject, first.response)[both]
    there, theirs = other.response.time, _history(subject, other.response)
    if np.array_equal(there, time):
        return time, np.linalg.norm(theirs - values, axis=1)
    between = np.column_stack([np.interp(time, there, theirs[:, axis]) for axis in range(3)])
    return time, np.linalg.norm(between - values, axis=1)


def identical(a: Response, b: Response) -> bool:
    """Return whether every sample and every peak of two responses has the same bits."""
    names = a.samples.names
    if names != b.samples.names or a.time.size != b.time.size or not a.peaks.same_as(b.peaks):
        return False
    return all(
        a.samples.columns(first, min(first + _BLOCK, len(names))).tobytes()
        == b.samples.columns(first, min(first + _BLOCK, len(names))).tobytes()
        for first in range(0, len(names), _BLOCK)
    )


def _history(subject: Subject, response: Response) -> Array:
    return response.mounts[subject].deflection if isinstance(subject, str) else subject.acceleration(response)
