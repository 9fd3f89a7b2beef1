"""Comparison of runs: shared components and mounts by name, verdicts, peaks, and the differences of histories."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from wirerope_mj.assessment.criteria import COMBINED, MountPeak, Verdict, judge, mount_peaks
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError


@dataclass(frozen=True, kw_only=True)
class ComparedRun:
    """A compared run: its response on the common timeline, and its verdicts."""

    name: str  # of the run in every output
    response: Response  # its response, on the timeline that all runs share
    moved: float  # shift of its own timeline to the common one [s]
    verdicts: tuple[Verdict, ...]  # verdicts on the run


@dataclass(frozen=True, kw_only=True, order=True)
class Component:
    """A base, body or point whose accelerations are compared; the base's name may differ from run to run."""

    kind: Literal["base", "body", "point"]
    name: str

    @property
    def label(self) -> str:
        return f"point {self.name}" if self.kind == "point" else self.name

    def acceleration(self, response: Response) -> Array:
        """Look up the component's acceleration in a response [m/s^2], (n_t, 3)."""
        if self.kind == "base":
            return response.base.acceleration
        return (response.points if self.kind == "point" else response.bodies)[self.name].acceleration

    def peak(self, response: Response) -> Peak:
        peaks = response.peaks
        if self.kind == "point":
            return peaks.points[self.name].acceleration
        return peaks.bodies[response.scene.base if self.kind == "base" else self.name].acceleration


BASE = Component(kind="base", name="base")
Subject = Component | str  # A component, or a mount by its name


def subjects_of(response: Response) -> list[Subject]:
    """List the base, if there is one, the other bodies, the points, and the mounts that are no stops."""
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


def difference(subject: Subject, first: ComparedRun, other: ComparedRun) -> tuple[Array, Array]:
    """Compute the norm of the difference of two histories, (n,), at the first run's instants within both runs [s], (n,).

    Instants come first. The histories are accelerations [m/s^2] of a component or deflections [m] of a mount; the other run
    is interpolated linearly between its samples.
    """
    time = first.response.time
    start, end = max(time[0], other.response.time[0]), min(time[-1], other.response.time[-1])
    both = (time >= start) & (time <= end)
    time, values = time[both], _history(subject, first.response)[both]
    instants, second = other.response.time, _history(subject, other.response)
    if not np.array_equal(instants, time):
        second = np.column_stack([np.interp(time, instants, second[:, axis]) for axis in range(3)])
    return time, np.linalg.norm(second - values, axis=1)


def identical(a: Response, b: Response) -> bool:
    """Check whether every sample and every peak of two responses agree bit by bit."""
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


Align = Literal["start", "shock"]


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Runs, the components and mounts that they share, and the differences of their histories from the first run's."""

    runs: tuple[ComparedRun, ...]  # the runs; differences are those to the first
    # components of two runs or more, or of the only run: the base first, then by falling peak
    components: tuple[Component, ...]
    mounts: tuple[str, ...]  # names of the mounts of two runs or more, or of the only run
    alone: dict[str, tuple[Subject, ...]]  # components and mounts of one run only, by the run's name
    # largest difference of each shared component and mount from the first run, the largest first
    differences: tuple[HistoryDifference, ...]


def compare_runs(
    responses: Mapping[str, Response], align: Align = "start", verdicts: Mapping[str, Sequence[Verdict]] | None = None
) -> Comparison:
    """Compare named responses: shared components and mounts, and differences of histories from the first response.

    `align` "start" lets all begin together, as they were simulated; with "shock" their first events fall together.
    Verdicts are those that `judge` returns, if they are not given. ValueError if `align` is unknown; RecordError if the
    responses share no component and no mount, or a run has no shock to align.
    """
    one_of("align", align, get_args(Align))
    subjects = {name: subjects_of(response) for name, response in responses.items()}
    every = [subject for of_run in subjects.values() for subject in of_run]
    shared = [subject for subject in dict.fromkeys(every) if every.count(subject) >= min(2, len(responses))]
    if not shared:
        raise RecordError(f"{', '.join(responses)}: these runs share no base, body, point or mount to compare.")
    known = verdicts or {name: judge(response) for name, response in responses.items()}
    runs, first = [], next(iter(responses))
    for name, response in responses.items():
        moved = 0.0
        if align == "shock":
            for named in (name, first):
                if not responses[named].events:
                    raise RecordError(f"{named}: nothing begins in this run; align runs at their start.")
            moved = responses[first].events[0][0] - response.events[0][0]
        aligned = _shifted(response, moved) if moved else response
        runs.append(ComparedRun(name=name, response=aligned, moved=moved, verdicts=tuple(known[name])))
    largest = {
        subject: max(subject.peak(run.response).value for run in runs if subject in subjects[run.name])
        for subject in shared
        if isinstance(subject, Component)
    }
    differences, peaks = [], runs[0].response.peaks.mounts
    for subject in (subject for subject in shared if subject in subjects[first]):
        for run in (run for run in runs[1:] if subject in subjects[run.name]):
            time, distance = difference(subject, runs[0], run)
            if time.size:
                row = int(distance.argmax())
                peak = peaks[subject].deflection if isinstance(subject, str) else subject.peak(runs[0].response)
                value = float(distance[row])
                ratio = value / peak.value if peak.value else np.nan
                entry = HistoryDifference(subject=subject, run=run.name, value=value, time=float(time[row]), ratio=ratio)
                differences.append(entry)
    return Comparison(
        runs=tuple(runs),
        components=tuple(sorted(largest, key=lambda component: (component != BASE, -largest[component], component.name))),
        mounts=tuple(subject for subject in shared if isinstance(subject, str)),
        alone={name: tuple(subject for subject in of_run if subject not in shared) for name, of_run in subjects.items()},
        differences=tuple(sorted(differences, key=lambda entry: -np.nan_to_num(entry.ratio))),
    )


def _shifted(response: Response, by: float) -> Response:
    """Shift the timeline of a response by `by` seconds; its samples stay as they are."""
    peaks = {
        kind: {
            name: replace(entry, **{key: getattr(entry, key).later(by) for key in entry.__dataclass_fields__})
            for name, entry in getattr(response.peaks, kind).items()
        }
        for kind in ("bodies", "points", "mounts")
    }
    contacts, travels = response.peaks.contacts, response.peaks.travels
    contacts = None if contacts is None else {name: contact.later(by) for name, contact in contacts.items()}
    travels = None if travels is None else {name: travel.later(by) for name, travel in travels.items()}
    return replace(
        response, time=response.time + by, events=tuple((time + by, text) for time, text in response.events),
        peaks=Peaks(**peaks, contacts=contacts, travels=travels),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class PeakRow:
    """Peak of a component or mount in every run, in the order of the runs; None for a run without it."""

    label: str  # name of the component or mount
    values: tuple[float | None, ...]  # in SI, utilisations as ratios
    times: tuple[float | None, ...]  # instants [s]; NaN where the peak has none
    notes: tuple[str, ...]  # text beside each value, such as the kind of travel

    def difference(self, number: int) -> float | None:
        """Compute run `number`'s peak over the first run's, minus 1; None if one is missing or the first is zero."""
        first, value = self.values[0], self.values[number]
        if first is None or value is None or not np.isfinite([first, value]).all() or (first == 0.0 != value):
            return None
        return 0.0 if value == first else value / first - 1.0


def acceleration_rows(comparison: Comparison, axis: int | None = None) -> list[PeakRow]:
    """Collect peak accelerations [m/s^2], norms or along an axis: of shared components, then of components of a single run."""
    alone = [subject for of_run in comparison.alone.values() for subject in of_run if isinstance(subject, Component)]
    responses = [(run.response, subjects_of(run.response)) for run in comparison.runs]
    return [
        _peak_row(component.label, [component.peak(run) if component in known else None for run, known in responses], axis)
        for component in (*comparison.components, *alone)
    ]


def mount_rows(comparison: Comparison, quantity: str, axis: int | None) -> list[PeakRow]:
    """Collect the peak "deflection" [m] or "force" [N] of the mounts, the mount that uses most travel first."""
    mounts = [run.response.peaks.mounts for run in comparison.runs]
    return [
        _peak_row(name, [getattr(peaks[name], quantity) if name in peaks else None for peaks in mounts], axis)
        for name in _mounts_of_runs(comparison)
    ]


def _peak_row(label: str, peaks: list[Peak | None], axis: int | None) -> PeakRow:
    """Make a row of each run's largest norm with its instant, or along an axis of the extreme farther from zero."""
    values, times = [], []
    for peak in peaks:
        value, time = (None, None) if peak is None else (peak.value, peak.time)
        if peak is not None and axis is not None:
            low, high = float(peak.minimum[axis]), float(peak.maximum[axis])
            value, time = max(high, -low), float((peak.maximum_time if high >= -low else peak.minimum_time)[axis])
        values.append(value)
        times.append(time)
    return PeakRow(label=label, values=tuple(values), times=tuple(times), notes=("",) * len(peaks))


def travel_rows(comparison: Comparison) -> list[PeakRow]:
    """Collect the largest utilisation of a rated travel of every mount, the largest first; NaN where no travel is rated."""
    rows = []
    for label, peaks in _mounts_of_runs(comparison).items():
        used = [None if peak is None else np.nan if peak.utilisation is None else peak.utilisation for peak in peaks]
        notes = tuple("" if peak is None else peak.governing for peak in peaks)
        rows.append(PeakRow(label=label, values=tuple(used), times=(np.nan,) * len(peaks), notes=notes))
    return rows


def combined_rows(comparison: Comparison) -> list[PeakRow]:
    """Collect the utilisation of combined travel, all axes at once, of every mount, the largest first."""
    by_run = [
        {row.subject: row for row in run.verdicts if row.criterion == COMBINED and row.utilisation is not None}
        for run in comparison.runs
    ]
    rows = []
    for name in _mounts_of_runs(comparison):
        verdicts = [known.get(name) for known in by_run]
        if any(verdicts):
            values = tuple(row.utilisation if row else None for row in verdicts)
            times = tuple(row.time if row else None for row in verdicts)
            rows.append(PeakRow(label=name, values=values, times=times, notes=("",) * len(verdicts)))
    return sorted(rows, key=lambda row: -max(value or 0.0 for value in row.values))


def largest_of(rows: Sequence[PeakRow]) -> PeakRow | None:
    """Find the largest value of any row in each run, with the row's label as note; None if no row has a value."""
    best: list[PeakRow | None] = []
    for number in range(len(rows[0].values) if rows else 0):
        sizes = [-np.inf if (value := row.values[number]) is None or np.isnan(value) else value for row in rows]
        best.append(rows[int(np.argmax(sizes))] if max(sizes) > -np.inf else None)
    if not any(best):
        return None
    pairs = list(enumerate(best))
    return PeakRow(
        label="largest of any",
        values=tuple(row.values[n] if row else None for n, row in pairs),
        times=tuple(row.times[n] if row else None for n, row in pairs),
        notes=tuple(", ".join(filter(None, (row.label, row.notes[n]))) if row else "" for n, row in pairs),
    )


def _mounts_of_runs(comparison: Comparison) -> dict[str, list[MountPeak | None]]:
    """Collect the peaks of every mount in every run; the largest utilisation in any run first, unrated mounts last."""
    by_run = [{peak.name: peak for peak in mount_peaks(run.response)} for run in comparison.runs]
    names = [mount.name for run in comparison.runs for mount in run.response.scene.isolating]
    mounts = {name: [peaks.get(name) for peaks in by_run] for name in dict.fromkeys(names)}

    def largest(name: str) -> float:
        used = [-1.0 if peak is None or peak.utilisation is None else peak.utilisation for peak in mounts[name]]
        return max(used)

    return {name: mounts[name] for name in sorted(mounts, key=largest, reverse=True)}
