"""Runs as they are drawn, one alone or several over each other: colours, selections and frames."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.assessment.comparison import Align, ComparedRun, Comparison, compare_runs
from wirerope_mj.assessment.comparison.compared import Subject, subjects_of
from wirerope_mj.content.selection import Selection, select
from wirerope_mj.engine.response import Response
from wirerope_mj.views.colours import DARK, Color
from wirerope_mj.views.recording.paths import AXES, root_of
from wirerope_mj.views.recording.poses import Frame, frames_of
from wirerope_mj.views.recording.scene import ARROW

MOST_MOUNTS = 4
"""Mounts of an axis whose histories and loops are drawn: each is a plot of its own, with a line for every run."""

COLORS: tuple[Color, ...] = (*DARK.series, (236, 218, 152), (190, 109, 108))
"""Of the runs in every view. There are no more runs than colours that can be told apart."""


@dataclass(frozen=True, kw_only=True)
class DrawnRun(ComparedRun):
    """A run as it is drawn; its name is "" if it is alone.

    Attributes:
        color: of its lines, mounts and ghosts among several runs.
        selection: what a recording of its own shows; among several runs mounts have the run's colour.
        frames: of its bodies.
    """

    color: Color
    selection: Selection
    frames: dict[str, Frame]

    @property
    def root(self) -> str:
        """Entity below which its scene and its samples stand."""
        return root_of(self.name)

    @property
    def names(self) -> tuple[str, ...]:
        """Last part of its own entities in what all runs share: none if it is alone."""
        return (self.name,) if self.name else ()


@dataclass(frozen=True, kw_only=True)
class Overlay(Comparison):
    """Runs that are laid over each other.

    Attributes:
        runs: as they are drawn.
        shared: mounts that two of them or more have, those shown in `ranked`, `utilisations` the largest of any run.
    """

    runs: tuple[DrawnRun, ...]
    shared: Selection

    def having(self, subject: Subject) -> list[DrawnRun]:
        """Return the runs that have a component, or a mount of that name."""
        return [run for run in self.runs if subject in subjects_of(run.response)]


def run_alone(response: Response, selection: Selection) -> DrawnRun:
    """Return a run that has a recording of its own, and what of it is shown."""
    return DrawnRun(
        name="",
        response=response,
        moved=0.0,
        color=ARROW,
        selection=selection,
        frames=frames_of(response),
    )


def overlay_of(responses: Mapping[str, Response], align: Align) -> Overlay:
    """Return the runs laid over each other.

    Raises:
        ValueError: there are too few or too many, or `align` is unknown.
        RecordError: they share nothing, or a run has no shock to align.
    """
    if not 2 <= len(responses) <= len(COLORS):
        raise ValueError(f"`responses` must be two to {len(COLORS)}, got {len(responses)}.")
    comparison = compare_runs(responses, align)
    runs = tuple(_overlaid(run, color) for run, color in zip(comparison.runs, COLORS, strict=False))
    return Overlay(**vars(comparison) | {"runs": runs, "shared": _shared(runs, comparison.mounts)})


def _overlaid(run: ComparedRun, color: Color) -> DrawnRun:
    selection = select(run.response)
    selection = replace(selection, run_color=color)
    return DrawnRun(**vars(run), color=color, selection=selection, frames=frames_of(run.response))


def _shared(runs: tuple[DrawnRun, ...], mounts: tuple[str, ...]) -> Selection:
    """Return mounts of several runs as a selection: the worst of any run first."""
    utilisations = np.full((len(mounts), 3), np.nan)
    travel = np.zeros((len(mounts), 3))
    acting = np.zeros((len(mounts), 3), dtype=bool)
    for row, name in enumerate(mounts):
        for run in runs:
            if name in run.selection.mounts:
                own, peak = run.selection, run.response.peaks.mounts[name].deflection
                utilisations[row] = np.fmax(utilisations[row], own.utilisations[own.mounts.index(name)])
                travel[row] = np.maximum(travel[row], peak.maximum - peak.minimum)
                acting[row] |= [name in own.ranked[axis] for axis in AXES]
    ranked = {}
    for number, axis in enumerate(AXES):
        order = np.lexsort([-travel[:, number], -np.nan_to_num(utilisations[:, number])])
        ranked[axis] = tuple(mounts[row] for row in order if acting[row, number])[:MOST_MOUNTS]
    starts, ends = zip(*(run.selection.window for run in runs), strict=True)
    return replace(
        runs[0].selection,
        window=(min(starts), max(ends)),
        utilisations=utilisations,
        mounts=mounts,
        ranked=ranked,
        bodies=(),
        points=(),
        used=(),
        numbers={},
    )
