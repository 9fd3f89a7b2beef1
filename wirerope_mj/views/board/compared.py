"""A run beside the one before it and beside tests: what differs, and their curves, as HTML for the right column."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from wirerope_mj.assessment.comparison import compare_runs
from wirerope_mj.assessment.correlation import correlate
from wirerope_mj.assessment.criteria import MountPeak, body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.verdict import ACCELERATION, most_used
from wirerope_mj.content.blocks import Block, Chart, Panel, Statement
from wirerope_mj.content.comparison import accelerations_table, figures_table, travel_tables
from wirerope_mj.content.correlation import channel_panel
from wirerope_mj.content.histories import TOTAL, Line, history_panel, subject_called
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Measured
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import RATINGS

_ROWS = 8  # of a table: those that a reader compares; the report of a run has them all
_CHANNELS = 4  # measured channels whose curves are drawn


def compared_blocks(runs: Mapping[str, RunResult], tests: Sequence[Measured] = ()) -> Iterator[Block]:
    """Yield tables and curves of a run, the last one, beside the run before it and tests."""
    if len(runs) > 1:
        comparison = compare_runs(
            {name: run.response for name, run in runs.items()}, verdicts={name: run.verdicts for name, run in runs.items()}
        )
        for table in chain([figures_table(comparison), accelerations_table(comparison)], travel_tables(comparison)):
            yield replace(table, shown=min(_ROWS, len(table.rows)))
    name, now = list(runs.items())[-1]
    correlations = [correlate(now.response, test) for test in tests]
    if correlations:
        lines = [f"{test.name}: {test.statement}" for test in correlations]
        yield Statement("tests", items=tuple(lines))
    channels = [channel for test in correlations for channel in test.responses][:_CHANNELS]
    panels = [replace(panel, title=f"{panel.title} {panel.ylabel}") for panel in (channel_panel(c, name) for c in channels)]
    panels += _panels(runs) if len(runs) > 1 else []
    if panels:
        yield Chart(
            id="compared", rows=[[panel] for panel in panels], height=150.0, caption="Now, before, and as measured.",
            alt="Histories now, before, and as measured.",
        )  # fmt: skip


def _panels(runs: Mapping[str, RunResult]) -> list[Panel]:
    """Draw the worst mount along its governing axis, and the most critical, or else largest, acceleration in all runs."""
    panels, last = [], list(runs.values())[-1]
    now = last.response
    window = float(now.time[0]), float(now.time[-1])
    mount = _worst_mount(mount_peaks(now))
    if mount is not None:
        peaks = np.abs([mount.minimum, mount.maximum])
        axis = RATINGS[mount.governing][0] if mount.governing else int(peaks.max(axis=0).argmax())
        lines = [
            Line(response=run.response, subject=mount.name, name=name, kind=rank)
            for rank, (name, run) in enumerate(runs.items())
        ]
        panels.append(history_panel("deflection", AXES[axis], lines, window, part=mount.name))
    worst = most_used(row for row in last.verdicts if row.criterion.kind == ACCELERATION)
    name = worst.subject if worst else next((row.name for row in body_peaks(now) if row.kind != "base"), "")
    if name:
        part, along = subject_called(now, name), (worst.criterion.axis if worst else "") or TOTAL
        lines = [
            Line(response=run.response, subject=part, name=called, kind=rank) for rank, (called, run) in enumerate(runs.items())
        ]
        panel = history_panel("acceleration", along, lines, window, part=name)
        limit = in_unit(worst.limit, "g") if worst and worst.limit is not None else None
        levels = [] if limit is None else [limit] if along == TOTAL else [-limit, limit]
        panels.append(replace(panel, limits=[("limit", level) for level in levels]))
    return panels


def _worst_mount(rows: list[MountPeak]) -> MountPeak | None:
    """Find the mount with the largest utilisation of travel, or without ratings with the largest deflection."""
    if not rows or rows[0].utilisation is not None:
        return rows[0] if rows else None
    return max(rows, key=lambda row: float(np.abs([row.minimum, row.maximum]).max()))
