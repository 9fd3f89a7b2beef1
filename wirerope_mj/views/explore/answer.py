"""The answer for the page on a run and the run before it: content as JSON values, in displayed units."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from wirerope_mj.assessment.comparison import compare_runs
from wirerope_mj.assessment.correlation import Correlation, correlate
from wirerope_mj.assessment.criteria import MountPeak, Verdict, body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.verdict import ACCELERATION
from wirerope_mj.content.blocks import Panel
from wirerope_mj.content.comparison import accelerations_table, figures_table, travel_tables
from wirerope_mj.content.correlation import channel_panel
from wirerope_mj.content.histories import TOTAL, Line, history_panel, subject_called
from wirerope_mj.content.numbers import ABSENT, MINUS
from wirerope_mj.content.run import numerics_statement
from wirerope_mj.content.verdicts import answer_blocks, headline
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.summary import json_values
from wirerope_mj.foundation.tables import Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Measured
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import RATINGS
from wirerope_mj.views.explore.recorder import ShownRun
from wirerope_mj.views.thin import rows_of_extremes

_ROWS = 8  # Rows of a table: those that a reader compares; the report of a run has them all
_CHANNELS = 4  # measured channels whose curves the page draws
_POINTS = 1500  # Points of a curve on the page: two for every pixel of its width, so that no peak is lost


def answer(now: ShownRun, before: ShownRun | None, tests: Sequence[Measured] = ()) -> Entries:
    """Compose verdict, tables and curves of a run beside those of the run before it and of tests, as JSON values."""
    runs = [now] if before is None else [before, now]
    comparison = compare_runs({run.name: run.response for run in runs}, verdicts={run.name: run.verdicts for run in runs})
    tables = chain([figures_table(comparison), accelerations_table(comparison)], travel_tables(comparison))
    entries, correlations = _run_entries(now), [[correlate(run.response, test) for test in tests] for run in runs]
    entries["lines"] += [f"{test.name}: {test.statement}" for test in correlations[-1]]
    panels = [*_measured_panels(correlations, runs), *_panels(runs)]
    return {
        "now": entries, "before": None if before is None else _run_entries(before),
        "tables": [_table_entries(table) for table in tables],
        "curves": json_values([_panel_entries(panel, runs) for panel in panels]),
    }  # fmt: skip


def _measured_panels(correlations: Sequence[Sequence[Correlation]], runs: Sequence[ShownRun]) -> Iterator[Panel]:
    """Yield panels of the first channels measured on the payload, each with the curves of the runs."""
    channels = [[channel for test in tests for channel in test.responses][:_CHANNELS] for tests in correlations]
    for of_runs in zip(*channels, strict=True):
        panels = [channel_panel(channel, run.name) for channel, run in zip(of_runs, runs, strict=True)]
        curves = [panels[-1].curves[1], *(panel.curves[0] for panel in panels)]  # the measured curve in front
        yield replace(panels[-1], curves=curves, title=f"{panels[-1].title} {panels[-1].ylabel}")


def _run_entries(run: ShownRun) -> Entries:
    verdict = headline(run.verdicts)
    origin = "" if run.exact else " (the step is that of the first run)"
    return {
        "name": run.name, "number": run.number, "values": dict(run.values), "changes": dict(run.changes),
        "motion": run.motion, "headline": verdict.text, "tone": verdict.tone,
        "lines": [
            line for block in answer_blocks(run) if block for line in (*filter(None, [block.text]), *block.items)
        ],
        "warnings": list(run.warnings), "exact": run.exact, "seconds": run.seconds,
        "step": f"{numerics_statement(run.response.numerics).text}{origin}.",
    }  # fmt: skip


def _table_entries(table: Table) -> Entries:
    """Convert a table to texts and tones of its cells, at most `_ROWS` rows."""
    return {
        "id": table.id, "title": table.title, "note": table.note,
        "columns": [{"title": column.title(), "align": column.align} for column in table.columns],
        "rows": table.marks(absent=ABSENT, minus=MINUS)[:_ROWS],
    }  # fmt: skip


def _panels(runs: list[ShownRun]) -> list[Panel]:
    """Draw the worst mount along its governing axis, and the most critical, or else largest, acceleration in all runs."""
    panels, now = [], runs[-1].response
    window = float(now.time[0]), float(now.time[-1])
    mount = _worst_mount(mount_peaks(now))
    if mount is not None:
        axis = (
            RATINGS[mount.governing][0] if mount.governing else int(np.abs([mount.minimum, mount.maximum]).max(axis=0).argmax())
        )
        lines = [Line(response=run.response, subject=mount.name, name=run.name, kind=rank) for rank, run in enumerate(runs)]
        panels.append(history_panel("deflection", AXES[axis], lines, window, part=mount.name))
    judged = [row for row in runs[-1].verdicts if row.criterion.kind == ACCELERATION and row.utilisation is not None]
    worst: Verdict | None = max(judged, key=lambda row: row.utilisation or 0.0, default=None)
    name = worst.subject if worst else next((row.name for row in body_peaks(now) if row.kind != "base"), "")
    if name:
        part, along = subject_called(now, name), (worst.criterion.axis if worst else "") or TOTAL
        lines = [Line(response=run.response, subject=part, name=run.name, kind=rank) for rank, run in enumerate(runs)]
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


def _panel_entries(panel: Panel, runs: list[ShownRun]) -> Entries:
    """Convert a panel to JSON values, the earlier run first, so that the later run is drawn over it."""
    lines = []
    for curve in panel.curves:
        rows = rows_of_extremes(curve.y[:, np.newaxis], _POINTS)
        role = "measured" if curve.name == "measured" else "now" if curve.name == runs[-1].name else "before"
        x, y = in_unit(curve.x[rows], "ms"), curve.y[rows]
        lines.append({"role": role, "name": curve.name, "x": _rounded(x), "y": _rounded(y)})
    return {
        "title": panel.title, "unit": panel.unit, "limits": [level for _, level in panel.limits],
        "limit": panel.limits[0][0] if panel.limits else "", "lines": lines,
    }  # fmt: skip


def _rounded(values: Iterable[float]) -> list[float]:
    """Round values to five digits, as many as a picture shows."""
    return [float(f"{value:.5g}") for value in values]
