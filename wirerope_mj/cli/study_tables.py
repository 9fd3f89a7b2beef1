"""The screen of a study or a search: its statements, its tables and its files."""

from collections.abc import Sequence

from rich.markup import escape

from wirerope_mj.content.search_tables import front_table
from wirerope_mj.content.study_tables import effects_table, indices_tables, measures_table, worst_table
from wirerope_mj.foundation.tables import Table
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.statements import failures, numbered, statements, travel_statements
from wirerope_mj.studies.results.study_summary import StudySummary
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.views.terminal import console, print_lines, print_table

_WORST, _INPUTS, _EFFECTS, _FRONT = 8, 4, 8, 24  # rows and columns that fit a screen


def print_study(summary: StudySummary, files: Sequence[str]) -> None:
    """Print the results of a study, and the files that it wrote."""
    effects = effects_table(summary, _EFFECTS)
    tables = [
        measures_table(summary),
        *(indices_tables(summary) or ([effects] if effects else [])),
        worst_table(summary, _WORST, inputs=_INPUTS),
    ]
    _print(summary.result, statements(summary.result), tables, files, noun="variant", most=5)


def print_search(result: SearchResult, files: Sequence[str]) -> None:
    """Print the results of a search, and the files that it wrote."""
    lines = travel_statements(result.study.base) if "travel" in result.shown else []
    tables = [front_table(result, _FRONT)] if result.front.num_rows else []
    _print(result, lines, tables, files, noun="design", most=3)


def _print(
    result: StudyResult, lines: Sequence[str], tables: Sequence[Table], files: Sequence[str], *, noun: str, most: int
) -> None:
    out = console()
    out.print(f"\n[bold]{escape(result.study.name)}[/]  {escape(result.message)}")
    print_lines(lines)
    for table in tables:
        out.print()
        print_table(table)
    every = list(failures(result.failed).items())
    for message, numbers in every[:most]:
        out.print(f"  {numbered(numbers, noun)} failed: {escape(message)}", style="red", soft_wrap=True)
    if len(every) > most:
        rest = sum(len(numbers) for _, numbers in every[most:])
        out.print(f"  and {rest} more failed otherwise: see the column `message`", style="red")
    out.print(f"\n  written to {escape(str(result.folder))}/", soft_wrap=True)
    out.print(f"  {escape(', '.join(files))}", soft_wrap=True)
