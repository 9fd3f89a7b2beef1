"""What the page is told of a run and the one before it: content as JSON, in the units that are displayed."""

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
_CHANNELS = 4  # that were measured, of which the page draws curves
_POINTS = 1500  # Points of a curve on the page: two for every pixel of its width, so that no peak is lost


def answer(now: ShownRun, before: ShownRun | None, tests: Sequence[Measured] = ()) -> Entries:
    """Return verdict, tables and curves of a run beside those of the one before it and of tests, as JSON takes them."""
    runs = [now] if before is None else [before, now]
    comparison = compare_runs({run.name: run.response for run in runs}, verdicts={run.name: run.verdicts for run in runs})
    tables = chain([figures_table(comparison), accelerations_table(comparison)], travel_tables(comparison))
    told, agreeing = _told(now), [[correlate(run.response, test) for test in tests] for run in runs]
    told["lines"] += [f"{one.name}: {one.statement}" for one in agreeing[-1]]
    panels = [*_measured_panels(agreeing, runs), *_panels(runs)]
    return {
        "now": told, "before": None if before is None else _told(before), "tables": [_table(table) for table in tables],
        "curves": json_values([_curve(panel, runs) for panel in panels]),
    }  # fmt: skip


def _measured_panels(agreeing: Sequence[Sequence[Correlation]], runs: Sequence[ShownRun]) -> Iterator[Panel]:
    """Yield the first channels that were measured on the payload, with what the runs say there."""
    channels = [[one for test in tests for one in test.responses][:_CHANNELS] for tests in agreeing]
    for of_runs in zip(*channels, strict=True):
        own = [channel_panel(one, run.name) for one, run in zip(of_runs, runs, strict=True)]
        curves = [own[-1].curves[1], *(panel.curves[0] for panel in own)]
        yield replace(own[-1], curves=curves, title=f"{own[-1].title} {own[-1].ylabel}")


def _told(run: ShownRun) -> Entries:
    said = headline(run.verdicts)
    origin = "" if run.exact else " (the step is that of the first run)"
    return {
        "name": run.name, "number": run.number, "values": dict(run.values), "changes": dict(run.changes),
        "motion": run.motion, "headline": said.text, "tone": said.tone,
        "lines": [
            line for block in answer_blocks(run) if block for line in (*filter(None, [block.text]), *block.items)
        ],
        "warnings": list(run.warnings), "exact": run.exact, "seconds": run.seconds,
        "step": f"{numerics_statement(run.response.numerics).text}{origin}.",
    }  # fmt: skip


def _table(table: Table) -> Entries:
    """Return a table as text and tone of its cells, the first rows of a long one."""
    return {
        "id": table.id, "title": table.title, "note": table.note,
        "columns": [{"title": column.title(), "align": column.align} for column in table.columns],
        "rows": table.marks(absent=ABSENT, minus=MINUS)[:_ROWS],
    }  # fmt: skip


def _panels(runs: list[ShownRun]) -> list[Panel]:
    """Return the worst mount along its governing axis, and the acceleration that is most critical, or largest, in all runs."""
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
    """Return the mount that uses most of its rated travel; where nothing is rated, the one that deflects farthest."""
    if not rows or rows[0].utilisation is not None:
        return rows[0] if rows else None
    return max(rows, key=lambda row: float(np.abs([row.minimum, row.maximum]).max()))


def _curve(panel: Panel, runs: list[ShownRun]) -> Entries:
    """Return a panel as the page draws it, the earlier run first: the later one is drawn over it."""
    lines = []
    for curve in panel.curves:
        rows = rows_of_extremes(curve.y[:, np.newaxis], _POINTS)
        role = "measured" if curve.name == "measured" else "now" if curve.name == runs[-1].name else "before"
        x, y = in_unit(curve.x[rows], "ms"), curve.y[rows]
        lines.append({"role": role, "name": curve.name, "x": _short(x), "y": _short(y)})
    return {
        "title": panel.title, "unit": panel.unit, "limits": [level for _, level in panel.limits],
        "limit": panel.limits[0][0] if panel.limits else "", "lines": lines,
    }  # fmt: skip


def _short(values: Iterable[float]) -> list[float]:
    """Return values with five digits, as many as a picture shows."""
    return [float(f"{value:.5g}") for value in values]
