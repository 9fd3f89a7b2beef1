"""Output of `wirerope compare`: inputs that differ, peaks side by side, and where and when runs differ."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.markup import escape
from rich.padding import Padding

from wirerope_mj.assessment.comparison import (
    Comparison,
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
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.views.terminal import console, print_table

_MOST_MOUNTS = 8
"""Mounts that are printed: those that use most of their rated travel in any run."""


def print_comparison(comparison: Comparison, inputs: Inputs, headlines: Mapping[str, str], target: Path) -> None:
    """Print the headline of every run, what differs between them, and where the recording is."""
    screen = console()
    names = [run.name for run in comparison.runs]
    screen.print(f"\n[bold]{escape(' and '.join(names))}[/]\n")
    lines = [f"{name}: {headline}" for name, headline in headlines.items() if headline]
    for line in lines:
        screen.print(Padding(escape(line), (0, 0, 0, 2)))
    if lines:
        screen.print()
    given = different_inputs(comparison, inputs)
    if given:
        columns = [Column(align="left"), *(Column(name, align="text") for name in names)]
        print_table(Table(title="Inputs that differ", columns=columns, rows=[(key, *values) for key, values in given]))
        screen.print()
    print_table(_peaks("Peak accelerations [g]", names, acceleration_rows(comparison), times=True))
    screen.print()
    largest, travel = largest_travel_row(comparison), travel_rows(comparison)
    if largest is not None:
        rows = [largest, *travel[:_MOST_MOUNTS]]
        print_table(_peaks("Utilisation of the rated travel [%]", names, rows, scale=100.0))
        if len(travel) > _MOST_MOUNTS:
            screen.print(f"  {_MOST_MOUNTS} of {len(travel)} mounts; the recording has them all")
        screen.print()
    elif travel:  # nothing is rated: how far the mounts move is said as it is
        rows = mount_rows(comparison, "deflection", None, 1e-3)[:_MOST_MOUNTS]
        print_table(_peaks("Largest deflections [mm]", names, rows, times=True))
        screen.print()
    for line in comparison_lines(comparison):
        screen.print(Padding(escape(line), (0, 0, 0, 2)))
    written = escape(str(target))
    screen.print(f"\n  written to {written}, {target.stat().st_size / 1e6:.1f} MB", soft_wrap=True)
    screen.print(f"  [bold]wirerope show {written}[/] opens the view", soft_wrap=True)


def _peaks(
    title: str, names: Sequence[str], rows: Sequence[PeakRow], *, times: bool = False, scale: float = 1.0
) -> Table:
    columns = [Column(align="left")]
    for number, name in enumerate(names):
        columns += [
            Column(name),
            *([Column("at", "s")] if times else []),
            *([Column(f"to {names[0]}")] if number else []),
        ]
    body: list[Row] = []
    for row in rows:
        cells: list[Cell] = [row.label]
        for number, (value, time, note) in enumerate(zip(row.values, row.times, row.notes, strict=True)):
            known = value is not None and math.isfinite(value)
            text = f"{scale * value:.{0 if note else 2}f} {note}".strip() if known and value is not None else "-"
            cells.append(Mark(text, "strong" if known else ""))
            cells += [f"{time:.4f}" if time is not None and known else "-"] if times else []
            cells += [difference_text(row, number)] if number else []
        body.append(cells)
    return Table(title=title, columns=columns, rows=body)
