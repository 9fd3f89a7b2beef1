"""Runs that are compared: aligned in time, with what they share by name and what only one of them has."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

from wirerope_mj.assessment.comparison.compared import BASE, ComparedRun, Component, Subject, subjects_of
from wirerope_mj.assessment.comparison.histories import HistoryDifference, largest_differences
from wirerope_mj.assessment.criteria import Verdict, judge
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.errors import RecordError

Align = Literal["start", "shock"]


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Runs and what they have in common; one alone has everything.

    Attributes:
        runs: the runs; differences are those to the first.
        components: what two of them or more have, or the only one: the base first, then the largest peak.
        mounts: names of the mounts that two of them or more have, or the only one.
        alone: components and mounts that only one of them has, by the run's name.
        differences: where and when what is shared differs most from the first run, the largest first.
    """

    runs: tuple[ComparedRun, ...]
    components: tuple[Component, ...]
    mounts: tuple[str, ...]
    alone: dict[str, tuple[Subject, ...]]
    differences: tuple[HistoryDifference, ...]


def compare_runs(
    responses: Mapping[str, Response],
    align: Align = "start",
    verdicts: Mapping[str, Sequence[Verdict]] | None = None,
) -> Comparison:
    """Compare responses by name with the first of them.

    Args:
        responses: by the names of the runs.
        align: "start": all begin together, as they were simulated; "shock": their first events fall together.
        verdicts: on each; those that `judge` returns by default.

    Raises:
        ValueError: `align` is unknown.
        RecordError: they share nothing, or a run has no shock to align.
    """
    one_of("align", align, get_args(Align))
    subjects = {name: subjects_of(response) for name, response in responses.items()}
    every = [subject for of_run in subjects.values() for subject in of_run]
    shared = [subject for subject in dict.fromkeys(every) if every.count(subject) >= min(2, len(responses))]
    if not shared:
        raise RecordError(f"{', '.join(responses)}: these runs share no base, body, point or mount to compare.")
    known = verdicts or {name: judge(response) for name, response in responses.items()}
    runs = tuple(_aligned(name, responses, align, known[name]) for name in responses)
    largest = {
        subject: max(subject.peak(run.response).value for run in runs if subject in subjects[run.name])
        for subject in shared
        if isinstance(subject, Component)
    }
    return Comparison(
        runs=runs,
        components=tuple(sorted(largest, key=lambda one: (one != BASE, -largest[one], one.name))),
        mounts=tuple(subject for subject in shared if isinstance(subject, str)),
        alone={name: tuple(one for one in of_run if one not in shared) for name, of_run in subjects.items()},
        differences=largest_differences(runs, shared),
    )


def _aligned(name: str, responses: Mapping[str, Response], align: Align, verdicts: Sequence[Verdict]) -> ComparedRun:
    """Return a run, moved so that its shock begins with that of the first if that is asked for."""
    response, moved = responses[name], 0.0
    if align == "shock":
        first = next(iter(responses))
        for wanted in (name, first):
            if not responses[wanted].events:
                raise RecordError(f"{wanted}: nothing begins in this run; align runs at their start.")
        moved = responses[first].events[0][0] - response.events[0][0]
    response = _moved(response, moved) if moved else response
    return ComparedRun(name=name, response=response, moved=moved, verdicts=tuple(verdicts))


def _moved(response: Response, by: float) -> Response:
    """Return the response on a timeline `by` seconds later; its samples stay as they are."""
    peaks = {
        kind: {
            name: replace(entry, **{key: getattr(entry, key).later(by) for key in entry.__dataclass_fields__})
            for name, entry in getattr(response.peaks, kind).items()
        }
        for kind in ("bodies", "points", "mounts")
    }
    known, travelled = response.peaks.contacts, response.peaks.travels
    contacts = None if known is None else {name: contact.later(by) for name, contact in known.items()}
    travels = None if travelled is None else {name: travel.later(by) for name, travel in travelled.items()}
    return replace(
        response,
        time=response.time + by,
        events=tuple((time + by, text) for time, text in response.events),
        peaks=Peaks(**peaks, contacts=contacts, travels=travels),
    )
