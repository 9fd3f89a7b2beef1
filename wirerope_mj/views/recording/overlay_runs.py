"""Runs that are laid over each other: what they share by name, what only one of them has, and their colours."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.views.recording.frame import Color
from wirerope_mj.views.recording.overlay_apart import Apart, farthest_apart
from wirerope_mj.views.recording.overlay_parts import BASE, Part, Run, has, parts_of
from wirerope_mj.views.recording.paths import AXES
from wirerope_mj.views.recording.poses import frames_of
from wirerope_mj.views.recording.selection import Selection, select

Align = Literal["start", "shock"]

MOST_MOUNTS = 4
"""Mounts of an axis whose histories and loops are drawn: each is a plot of its own, with a line for every run."""

COLORS: tuple[Color, ...] = (
    (78, 160, 240), (255, 150, 50), (90, 205, 110), (245, 110, 190), (180, 145, 245), (235, 215, 80), (70, 210, 215),
    (215, 140, 105),
)  # fmt: skip
"""Of the runs in every view. There are no more runs than colours that can be told apart."""


@dataclass(frozen=True, kw_only=True)
class Overlay:
    """Runs that are laid over each other.

    Attributes:
        runs: the runs; differences are those to the first.
        parts: what two of them or more have: the base first, then the largest peak.
        shared: mounts that two of them or more have, those shown in `ranked`, `shares` the largest of any run.
        alone: parts and mounts that only one of them has, by the run's name.
        apart: where and when what is shared is farthest from the first run, the farthest first.
    """

    runs: tuple[Run, ...]
    parts: tuple[Part, ...]
    shared: Selection
    alone: dict[str, tuple[Part | str, ...]]
    apart: tuple[Apart, ...]

    def having(self, thing: Part | str) -> list[Run]:
        """Return the runs that have a part, or a mount of that name."""
        return [run for run in self.runs if has(run.response, thing)]

    def of_run(self, run: Run) -> Selection:
        """Return the shared mounts that a run has."""
        ranked = {
            axis: tuple(n for n in names if n in run.selection.mounts) for axis, names in self.shared.ranked.items()
        }
        return replace(self.shared, ranked=ranked)


def overlay_of(responses: Mapping[str, Response], align: Align) -> Overlay:
    """Return the runs laid over each other.

    Raises:
        ValueError: there are too few or too many, or `align` is unknown.
        RecordError: they share nothing, or a run has no shock to align.
    """
    if not 2 <= len(responses) <= len(COLORS):
        raise ValueError(f"`responses` must be two to {len(COLORS)}, got {len(responses)}.")
    if align not in get_args(Align):
        raise ValueError(f"`align` must be start or shock, got {align!r}.")
    runs = tuple(
        _run(name, response, _shift(name, responses, align), color)
        for (name, response), color in zip(responses.items(), COLORS, strict=False)
    )
    found = [thing for run in runs for thing in _things(run)]
    several = {thing for thing in found if found.count(thing) > 1}
    if not several:
        raise RecordError(f"{', '.join(responses)}: these runs share no base, body, point or mount to compare.")
    parts = {thing for thing in several if isinstance(thing, Part)}
    mounts = tuple(dict.fromkeys(thing for thing in found if isinstance(thing, str) and thing in several))
    return Overlay(
        runs=runs,
        parts=tuple(sorted(parts, key=lambda part: (part != BASE, -_largest(part, runs), part.name))),
        shared=_shared(runs, mounts),
        apart=farthest_apart(runs, [thing for thing in dict.fromkeys(found) if thing in several]),
        alone={run.name: tuple(thing for thing in _things(run) if thing not in several) for run in runs},
    )


def _run(name: str, response: Response, moved: float, color: Color) -> Run:
    response = _moved(response, moved) if moved else response
    selection = select(response)
    selection = replace(selection, colors=dict.fromkeys(selection.mounts, color))
    return Run(name=name, response=response, moved=moved, color=color, selection=selection, frames=frames_of(response))


def _shift(name: str, responses: Mapping[str, Response], align: Align) -> float:
    """Return by how much a run is moved so that its shock begins with that of the first [s]."""
    if align == "start":
        return 0.0
    first = next(iter(responses))
    for wanted in (name, first):
        if not responses[wanted].events:
            raise RecordError(f"{wanted}: nothing begins in this run; align runs at their start.")
    return responses[first].events[0][0] - responses[name].events[0][0]


def _moved(response: Response, by: float) -> Response:
    """Return the response on a timeline `by` seconds later; its samples stay as they are."""

    def later(peak: Peak) -> Peak:
        return replace(
            peak,
            time=peak.time + by,
            minimum_time=peak.minimum_time + by,
            maximum_time=peak.maximum_time + by,
        )

    peaks = {
        room: {
            name: replace(entry, **{key: later(getattr(entry, key)) for key in entry.__dataclass_fields__})
            for name, entry in getattr(response.peaks, room).items()
        }
        for room in ("bodies", "points", "mounts")
    }
    known = response.peaks.contacts
    contacts = None if known is None else {name: contact.later(by) for name, contact in known.items()}
    return replace(
        response,
        time=response.time + by,
        events=tuple((time + by, text) for time, text in response.events),
        peaks=Peaks(**peaks, contacts=contacts),
    )


def _largest(part: Part, runs: Iterable[Run]) -> float:
    return max(part.peak(run.response).value for run in runs if has(run.response, part))


def _shared(runs: tuple[Run, ...], mounts: tuple[str, ...]) -> Selection:
    """Return mounts of several runs as a selection: the worst of any run first."""
    shares = np.full((len(mounts), 3), np.nan)
    travel = np.zeros((len(mounts), 3))
    acting = np.zeros((len(mounts), 3), dtype=bool)
    for row, name in enumerate(mounts):
        for run in runs:
            if name in run.selection.mounts:
                own, peak = run.selection, run.response.peaks.mounts[name].deflection
                shares[row] = np.fmax(shares[row], own.shares[own.mounts.index(name)])
                travel[row] = np.maximum(travel[row], peak.maximum - peak.minimum)
                acting[row] |= [name in own.ranked[axis] for axis in AXES]
    ranked = {}
    for number, axis in enumerate(AXES):
        order = np.lexsort([-travel[:, number], -np.nan_to_num(shares[:, number])])
        ranked[axis] = tuple(mounts[row] for row in order if acting[row, number])[:MOST_MOUNTS]
    starts, ends = zip(*(run.selection.window for run in runs), strict=True)
    return replace(
        runs[0].selection,
        window=(min(starts), max(ends)),
        shares=shares,
        mounts=mounts,
        ranked=ranked,
        bodies=(),
        points=(),
        colors={},
    )


def _things(run: Run) -> list[Part | str]:
    """Return parts and names of mounts."""
    return [*parts_of(run.response), *run.selection.mounts]
