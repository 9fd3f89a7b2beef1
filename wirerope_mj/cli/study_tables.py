"""What a study prints: its measures, the inputs that matter, and the worst variants."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from rich import box
from rich.markup import escape
from rich.table import Table

from wirerope_mj.cli.tables import console
from wirerope_mj.study.findings import (
    chance,
    headlines,
    input_label,
    input_names,
    measure_of,
    percent,
    quantiles,
    random_study,
    row_of,
    sentences,
    values_of,
    worst,
)
from wirerope_mj.study.result import StudyResult
from wirerope_mj.study.sensitivity import Influence

QUANTILES = (0.5, 0.9, 0.95, 0.99)

WORST = 8
"""Variants in the table of the worst."""

_INPUTS = 4  # columns of inputs beside a variant
_INFLUENCES = 8
_LONG = 14  # letters of a heading that stands on two lines
_FAILED = 5  # messages of failed variants


def print_study(result: StudyResult, by: str, found: Sequence[Influence], files: Sequence[str]) -> None:
    """Print what a study found; `found` is what its inputs do to the measure `by`."""
    out, table = console(), result.table
    out.print(f"\n[bold]{escape(result.study.name)}[/]  {escape(result.message)}")
    out.print(_measures(result, by))
    out.print()
    for line in sentences(result):
        out.print(f"  {escape(line)}", soft_wrap=True)
    if found:
        out.print()
        out.print(_influences(found, by))
    out.print()
    out.print(_worst(table, by, found))
    failed = result.failed
    for number, message in list(failed.items())[:_FAILED]:
        out.print(f"  variant {number} failed: {escape(message)}", style="red")
    if len(failed) > _FAILED:
        out.print(f"  and {len(failed) - _FAILED} more failed: see the column `message`", style="red")
    out.print(f"\n  written to {result.folder}/", soft_wrap=True)
    out.print(f"  {', '.join(files)}", soft_wrap=True)


def _measures(result: StudyResult, by: str) -> Table:
    table, drawn = result.table, random_study(result)
    title = "Measures and their percentiles, as far as five variants lie beyond them" if drawn else "Measures"
    shown = [f"{100.0 * q:.0f} %" for q in QUANTILES] if drawn else ["smallest", "median"]
    listing = _empty(title, ("measure", *shown, "largest", "variant", "limit", "beyond it"))
    for name in dict.fromkeys([by, *headlines(table)]):
        measure, values = measure_of(name), values_of(table, name)
        figures = quantiles(values, QUANTILES) if drawn else [np.nanmin(values), np.nanmedian(values)]
        cells = [_number(measure.factor * float(value)) for value in [*figures, np.nanmax(values)]]
        limit = ["", ""]
        if measure.limit is not None:
            beyond = chance(values, measure.limit)
            share = f" ({percent(beyond.count / beyond.n)})" if drawn else ""
            limit = [_number(measure.factor * measure.limit), f"{beyond.count} of {beyond.n}{share}"]
        listing.add_row(escape(measure.label), *cells, str(worst(table, name, 1)[0]), *limit)
    return listing


def _influences(found: Sequence[Influence], by: str) -> Table:
    title = f"What the inputs explain alone of the variance of: {measure_of(by).words}"
    listing = _empty(title, ("input", "share", "rank correlation", ""))
    for one in found[:_INFLUENCES]:
        rank = "" if math.isnan(one.rank) else f"{one.rank:+.2f}"
        certain = "" if one.certain else "[dim]may be chance[/]"
        listing.add_row(escape(one.name), f"{max(100.0 * one.share, 0.0):.1f} %", rank, certain)
    return listing


def _worst(table: pa.Table, by: str, found: Sequence[Influence]) -> Table:
    measures = list(dict.fromkeys([by, *headlines(table)]))
    inputs = shown_inputs(table, found)
    title = f"Worst variants by {by}"
    heads = [*(f"{name} [{measure_of(name).unit}]" for name in measures), *map(input_label, inputs)]
    listing = _empty(title, ("variant", *map(_two_lines, heads)))
    for number in worst(table, by, WORST):
        row = row_of(table, number)
        values = [_number(measure_of(name).factor * row[name]) for name in measures]
        listing.add_row(str(number), *values, *(escape(shown_input(row[name])) for name in inputs))
    return listing


def shown_inputs(table: pa.Table, found: Sequence[Influence], most: int = _INPUTS) -> list[str]:
    """Return the inputs that are told of a variant: the strongest first."""
    return list(dict.fromkeys([*(one.name for one in found), *input_names(table)]))[:most]


def shown_input(value: Any) -> str:
    """Return an input's value as a cell."""
    return _number(value) if isinstance(value, float) else str(value) or "none"


def _two_lines(name: str) -> str:
    """Return a heading on two lines if it is long: "mount/m16/", "axial/k1"."""
    parts = name.replace(" [", "/[").split("/")
    if len(name) <= _LONG or len(parts) < 2:
        return name
    half = len(parts) // 2
    first = "/".join(parts[:half]) + ("" if parts[half].startswith("[") else "/")
    return f"{first}\n{'/'.join(parts[half:]).replace('/[', ' [')}"


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else "-"


def _empty(title: str, head: Sequence[str]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, title=escape(title), title_style="bold", title_justify="left", show_edge=False)
    for place, name in enumerate(head):
        table.add_column(escape(name), justify="right" if place else "left", no_wrap=True)
    return table
