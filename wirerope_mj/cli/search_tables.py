"""What a search prints: how it went, and the designs of its front."""

from collections.abc import Sequence

from rich.markup import escape

from wirerope_mj.cli.screen import console
from wirerope_mj.cli.study_tables import empty, print_failed, print_files, shown_number
from wirerope_mj.studies.results.findings import measure_of
from wirerope_mj.studies.results.sentences import travel_sentences
from wirerope_mj.studies.search.result import GENERATION, SearchResult

_ROWS = 24
_FAILED = 3  # messages of failed designs


def print_search(result: SearchResult, files: Sequence[str]) -> None:
    """Print what a search found, and the files that it wrote."""
    out = console()
    out.print(f"\n[bold]{escape(result.study.name)}[/]  {escape(result.message)}")
    for line in travel_sentences(result.study.base) if "travel" in result.shown else []:
        out.print(f"  {escape(line)}", soft_wrap=True)
    if result.front.num_rows:
        out.print()
        out.print(_front(result))
    print_failed(result, "design", _FAILED)
    print_files(result, files)


def _front(result: SearchResult) -> object:
    measures = [measure_of(name) for name in result.shown]
    title = "The front: designs within the limits that no other one beats"
    heads = [measure.name + (f" [{measure.unit}]" if measure.unit != "-" else "") for measure in measures]
    listing = empty(title, ("design", *heads, "generation", ""))
    rows = result.table.slice(0, result.start).to_pylist() + result.front.to_pylist()
    for row in list({row["variant"]: row for row in rows}.values())[:_ROWS]:
        values = [shown_number(measure.factor * row[measure.name]) for measure in measures]
        listing.add_row(str(row["variant"]), *values, str(row[GENERATION]), result.word(row["variant"]))
    return listing
