"""Texts of several runs: their differences in a few lines, and the peaks side by side as tables."""

from collections.abc import Sequence
from typing import TypeGuard

import numpy as np

from wirerope_mj.assessment.comparison import (
    Inputs,
    PeakRow,
    acceleration_rows,
    comparison_lines,
    difference_text,
    different_inputs,
    largest_travel_row,
    mount_rows,
    travel_rows,
)
from wirerope_mj.assessment.comparison.sentences import ratio_text, size_text, subject_label
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.tables import Cell, Column, Row, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.drawn_runs import Overlay
from wirerope_mj.views.recording.markdown_tables import markdown_table
from wirerope_mj.views.recording.paths import AXES, entity

PEAKS, SUMMARY, STUDY = "peaks", "differences", "study"
PEAK_TEXTS = {"accelerations": "Accelerations", "mounts": "Mounts", "apart": "Farthest apart"}
"""Texts with the tables below /peaks: entities and titles."""

_WIDEST = 24
"""Characters of an input that still fit into a column; the viewer breaks no line in a table."""


def overlay_texts(overlay: Overlay, inputs: Inputs, tables: Sequence[Table]) -> dict[str, str]:
    """Return the differences, the tables of peaks and those of a study as Markdown, by their entities."""
    study = {entity(STUDY): "\n\n".join(map(markdown_table, tables))} if tables else {}
    return study | {
        entity(SUMMARY): summary_markdown(overlay, inputs),
        entity(PEAKS, "accelerations"): acceleration_tables(overlay),
        entity(PEAKS, "mounts"): mount_tables(overlay),
        entity(PEAKS, "apart"): apart_tables(overlay),
    }


def summary_markdown(overlay: Overlay, inputs: Inputs) -> str:
    """Return the inputs that differ, the largest peaks, and where and when the runs differ."""
    names = [run.name for run in overlay.runs]
    given = different_inputs(overlay, inputs)
    differing = [(key, *values) for key, values in given if max(map(len, values)) <= _WIDEST]
    long = [
        f"{key}: {'; '.join(f'{n}: {v}' for n, v in zip(names, values, strict=True))}"
        for key, values in given
        if max(map(len, values)) > _WIDEST
    ]
    parts = ["### What differs"]
    peaks = [(f"{row.label}, peak [g]", *_values(row, "{:.2f}")) for row in acceleration_rows(overlay)[:2]]
    travel = largest_travel_row(overlay)
    if travel is not None:
        used = [f"{in_unit(value, '%'):.0f}" if _known(value) else "-" for value in travel.values]
        peaks.append(("most of rated travel [%]", *used))
    columns = [Column(align="left"), *map(Column, names)]
    parts.append(markdown_table(Table(title="", columns=columns, rows=[*differing, *peaks])))
    parts.append("\n".join(f"- {markdown(line)}" for line in (*comparison_lines(overlay), *long)))
    return "\n\n".join(part for part in parts if part)


def acceleration_tables(overlay: Overlay) -> str:
    """Return the peak accelerations side by side: norms, then components."""
    tables = [_peak_table("Peak accelerations [g]", overlay, acceleration_rows(overlay), ".2f", times=True)]
    for number, axis in enumerate("xyz"):
        rows = acceleration_rows(overlay, number)
        tables.append(_peak_table(f"Along {axis} [g]", overlay, rows, ".2f", times=True))
    return "\n\n".join(tables)


def mount_tables(overlay: Overlay) -> str:
    """Return the mounts' utilisation of their rated travel, their deflections and forces, side by side."""
    tables = []
    travel = [row for row in travel_rows(overlay) if any(_known(value) for value in row.values)]
    if travel:
        tables.append(_peak_table("Utilisation of the rated travel [%]", overlay, travel, ".0f", scale=100.0))
    for quantity, unit, name in (("deflection", 1e-3, "mm"), ("force", 1e3, "kN")):
        for number, axis in reversed(list(enumerate(AXES))):
            rows = [row for row in mount_rows(overlay, quantity, number, unit) if any(row.values)]
            if rows:
                tables.append(_peak_table(f"Largest {axis} {quantity} [{name}]", overlay, rows, ".2f"))
    return "\n\n".join(tables) or "There are no mounts."


def apart_tables(overlay: Overlay) -> str:
    """Return where and when the histories of each run are farthest from those of the first."""
    first = overlay.runs[0].name
    parts = []
    for run in overlay.runs[1:]:
        own = [entry for entry in overlay.differences if entry.run == run.name and entry.value > 0.0]
        rows = [(subject_label(e.subject), size_text(e), e.time, ratio_text(e)) for e in own]
        columns = (
            Column(align="left"),
            Column("farthest apart"),
            Column("at", "ms", ".1f"),
            Column(f"of {first}'s peak"),
        )
        table = markdown_table(Table(title="", columns=columns, rows=rows))
        parts.append(f"### {markdown(run.name)} against {markdown(first)}\n{table or 'Histories do not differ.'}")
    return "\n\n".join(parts)


def _peak_table(
    title: str, overlay: Overlay, rows: Sequence[PeakRow], form: str, *, times: bool = False, scale: float = 1.0
) -> str:
    columns, first = [Column(align="left")], overlay.runs[0].name
    for number, run in enumerate(overlay.runs):
        columns += [Column(run.name), *([Column("at", "ms", ".1f")] if times else [])]
        columns += [Column(f"to {first}")] if number else []
    body: list[Row] = []
    for row in rows:
        cells: list[Cell] = [row.label]
        for number, (value, time, note) in enumerate(zip(row.values, row.times, row.notes, strict=True)):
            shown = format(scale * value, form) if _known(value) else "-"
            cells += [f"{shown} {note}".strip(), *([time] if times else [])]
            cells += [difference_text(row, number)] if number else []
        body.append(cells)
    return markdown_table(Table(title=title, columns=columns, rows=body))


def _values(row: PeakRow, form: str) -> list[str]:
    return [form.format(value) if _known(value) else "-" for value in row.values]


def _known(value: float | None) -> TypeGuard[float]:
    return value is not None and bool(np.isfinite(value))
