"""What `wirerope compare` prints: inputs that differ, peaks side by side, and where and when runs differ."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich import box
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table

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
from wirerope_mj.cli.screen import console

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
        screen.print(_inputs(names, given), "")
    screen.print(_peaks("Peak accelerations [g]", names, acceleration_rows(comparison), times=True), "")
    largest, travel = largest_travel_row(comparison), travel_rows(comparison)
    if largest is not None:
        rows = [largest, *travel[:_MOST_MOUNTS]]
        screen.print(_peaks("Utilisation of the rated travel [%]", names, rows, scale=100.0))
        if len(travel) > _MOST_MOUNTS:
            screen.print(f"  {_MOST_MOUNTS} of {len(travel)} mounts; the recording has them all")
        screen.print()
    elif travel:  # nothing is rated: how far the mounts move is said as it is
        rows = mount_rows(comparison, "deflection", None, 1e-3)[:_MOST_MOUNTS]
        screen.print(_peaks("Largest deflections [mm]", names, rows, times=True), "")
    for line in comparison_lines(comparison):
        screen.print(Padding(escape(line), (0, 0, 0, 2)))
    written = escape(str(target))
    screen.print(f"\n  written to {written}, {target.stat().st_size / 1e6:.1f} MB", soft_wrap=True)
    screen.print(f"  [bold]wirerope show {written}[/] opens the view", soft_wrap=True)


def _inputs(names: Sequence[str], given: Sequence[tuple[str, tuple[str, ...]]]) -> Table:
    table = _table("Inputs that differ")
    for name in names:
        table.add_column(escape(name), overflow="fold")
    for key, values in given:
        table.add_row(escape(key), *(escape(value) for value in values))
    return table


def _peaks(
    title: str, names: Sequence[str], rows: Sequence[PeakRow], *, times: bool = False, scale: float = 1.0
) -> Table:
    table = _table(title)
    for number, name in enumerate(names):
        table.add_column(escape(name), justify="right", overflow="fold")
        if times:
            table.add_column(escape("at [s]"), justify="right", no_wrap=True)
        if number:
            table.add_column(f"to {escape(names[0])}", justify="right", overflow="fold")
    for row in rows:
        cells = [escape(row.label)]
        for number, (value, time, note) in enumerate(zip(row.values, row.times, row.notes, strict=True)):
            known = value is not None and math.isfinite(value)
            cells.append(
                f"[bold]{scale * value:.{0 if note else 2}f}[/] {escape(note)}".strip()
                if known and value is not None
                else "-"
            )
            cells += [f"{time:.4f}" if time is not None and known else "-"] if times else []
            cells += [difference_text(row, number)] if number else []
        table.add_row(*cells)
    return table


def _table(title: str) -> Table:
    """Return a table of one column of names."""
    table = Table(box=box.SIMPLE_HEAD, title=escape(title), title_style="bold", title_justify="left", show_edge=False)
    table.add_column("", no_wrap=True)
    return table
