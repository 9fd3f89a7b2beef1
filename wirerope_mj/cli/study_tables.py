"""What a study prints: its measures, the inputs that matter, and the worst variants."""

import math
from collections.abc import Sequence
from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from wirerope_mj.cli.screen import console
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.answer import QUANTILES, Answer
from wirerope_mj.studies.results.findings import CONFIDENCE, failures, numbered, percent
from wirerope_mj.studies.results.indices import SobolIndices
from wirerope_mj.studies.results.sentences import sentences
from wirerope_mj.studies.results.varied import HEAD, varied_of
from wirerope_mj.studies.study import Study

_WORST = 8  # variants in the table of the worst
_INPUTS = 4  # columns of inputs beside a variant
_INFLUENCES = 8
_LONG = 14  # letters of a heading that stands on two lines
_FAILED = 5  # messages of failed variants


def print_study(answer: Answer, files: Sequence[str]) -> None:
    """Print what a study answers, and the files that it wrote."""
    out, result = console(), answer.result
    out.print(f"\n[bold]{escape(result.study.name)}[/]  {escape(result.message)}")
    for line in sentences(result):
        out.print(f"  {escape(line)}", soft_wrap=True)
    out.print()
    out.print(_measures(answer))
    for listing in [*map(_indices, answer.indices)] or [_influences(answer)] * bool(answer.influences):
        out.print()
        out.print(listing)
    out.print()
    out.print(_worst(answer))
    print_failed(result)
    print_files(result, files)


def print_varied(study: Study) -> None:
    """Print what varies, before it is computed: kinds and units, what the model says, and the distributions."""
    listing = empty(f"What varies in {study.name}", HEAD)
    for column in listing.columns:
        column.justify, column.no_wrap = "left", False
    for one in varied_of(study):
        listing.add_row(*map(escape, one.cells))
    console().print(listing)


def print_failed(result: StudyResult, thing: str = "variant", most: int = _FAILED) -> None:
    """Print why variants failed, those of the same message together."""
    every = list(failures(result).items())
    for message, numbers in every[:most]:
        console().print(f"  {numbered(numbers, thing)} failed: {escape(message)}", style="red", soft_wrap=True)
    if len(every) > most:
        rest = sum(len(numbers) for _, numbers in every[most:])
        console().print(f"  and {rest} more failed otherwise: see the column `message`", style="red")


def print_files(result: StudyResult, files: Sequence[str]) -> None:
    """Print which files were written."""
    console().print(f"\n  written to {escape(str(result.folder))}/", soft_wrap=True)
    console().print(f"  {escape(', '.join(files))}", soft_wrap=True)


def _measures(answer: Answer) -> Table:
    title = "Measures and their percentiles, as far as five variants lie beyond them" if answer.drawn else "Measures"
    shown = [f"{100.0 * q:.0f} %" for q in QUANTILES] if answer.drawn else ["smallest", "median"]
    listing = empty(title, ("measure", *shown, "largest", "variant", "limit", "beyond it"))
    for one in answer.figures:
        figures = [*(one.quantiles if answer.drawn else (one.smallest, one.median)), one.largest]
        limit = ["", ""]
        if one.beyond is not None and one.limit is not None:
            limit = [shown_number(one.limit), one.beyond_words]
        name = f"{one.measure.name} [{one.measure.unit}]"
        listing.add_row(escape(name), *map(shown_number, figures), str(one.variant), *limit)
    return listing


def _indices(found: SobolIndices) -> Table:
    what = f"What explains the variance of {found.measure}"
    few = f"; {found.rows} base rows are too few" if found.too_few else ""
    title = f"{what}; Sobol's indices with {percent(CONFIDENCE)} intervals{few}"
    listing = empty(title, ("factor", "alone", "", "with others", ""))
    for one in found.factors:
        cells = []
        for index, (low, high) in ((one.first, one.first_interval), (one.total, one.total_interval)):
            cells += [f"{100.0 * index:z.1f} %", f"{100.0 * low:z.1f} to {100.0 * high:z.1f} %"]
        listing.add_row(escape(one.name), *cells)
    return listing


def _influences(answer: Answer) -> Table:
    title = f"What the inputs explain alone of the variance of {answer.by}"
    listing = empty(title, ("input", "share", "", "rank correlation"))
    for one in answer.influences[:_INFLUENCES]:
        rank = "" if math.isnan(one.rank) else f"{one.rank:+.2f}"
        certain = "" if one.certain else "[dim]may be chance[/]"
        listing.add_row(escape(one.name), f"{max(100.0 * one.share, 0.0):.1f} %", certain, rank)
    return listing


def _worst(answer: Answer) -> Table:
    heads = [f"{measure.name} [{measure.unit}]" for measure in answer.measures]
    heads += [answer.labels[name] for name in answer.inputs(_INPUTS)]
    without = f"; without {', '.join(answer.left_out)}" if answer.left_out else ""
    listing = empty(f"Worst variants by {answer.by}{without}", ("variant", *map(_two_lines, heads)))
    for one in answer.worst(_WORST, inputs=_INPUTS):
        listing.add_row(
            str(one.variant), *map(shown_number, one.values), *(escape(_input(value)) for value in one.inputs)
        )
    return listing


def _input(value: Any) -> str:
    return shown_number(value) if isinstance(value, float) else str(value) or "none"


def _two_lines(name: str) -> str:
    """Return a heading on two lines if it is long: "mount/m16/", "axial/k1"."""
    parts = name.replace(" [", "/[").split("/")
    if len(name) <= _LONG or len(parts) < 2:
        return name
    half = len(parts) // 2
    first = "/".join(parts[:half]) + ("" if parts[half].startswith("[") else "/")
    return f"{first}\n{'/'.join(parts[half:]).replace('/[', ' [')}"


def shown_number(value: float) -> str:
    """Return a number as a cell; a dash where there is none."""
    return f"{value:.4g}" if math.isfinite(value) else "-"


def empty(title: str, head: Sequence[str]) -> Table:
    """Return a table with headings alone."""
    whole = Text(plain(title), style="bold", no_wrap=True, overflow="ignore")  # may be wider than its table
    table = Table(box=box.SIMPLE_HEAD, title=whole, title_justify="left", title_style="none", show_edge=False)
    for place, name in enumerate(head):
        table.add_column(escape(name), justify="right" if place else "left", no_wrap=True)
    return table
