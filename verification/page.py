"""The results as text: a table for the screen, and the page docs/verification.md."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from verification.runner import FAILED, NOT_RUN, OUTSIDE, WITHIN, Result

HEAD = Path(__file__).with_name("README.md")
ROUNDING = 1e-12
"""Errors below it are rounding, whose digits differ from machine to machine."""

KINDS = {
    "numerics": "Numerics: the same equations, solved by others",
    "published": "Published values",
    "measured": "Measured tests: predicted from other tests of the same device",
    "plausibility": "Plausibility: isolator files against vendors' and laboratories' statements",
}
INTRODUCTIONS = {
    "numerics": "An error here is an error of this library or of the reference.",
    "published": "Values that others printed, compared within the digits that they printed.",
    "measured": "A law is fitted to some tests of a device, and others are calculated without looking at them. The files are "
    "other people's: `--data FOLDER` says where they are, and without it these cases are not run.",
    "plausibility": "What vendors and laboratories say of such isolators, or what their programs find for a rack, beside what "
    "the isolator files give here: the difference measures the files, not the integration. Some bounds are "
    "loose.",
}


def error_text(error: float) -> str:
    """Return an error with two digits; rounding without them."""
    return "< 1e-12" if error < ROUNDING else f"{error:.1e}"


def number(value: float) -> str:
    """Return a value with six digits."""
    return f"{value:.6g}"


def print_table(results: Sequence[Result]) -> None:
    """Print one line for each result."""
    table = Table("case", "reference", "ours", "unit", "error", "bound", "", box=None, pad_edge=False)
    table.columns[0].no_wrap = True
    for result in results:
        found = result.comparison
        values = (
            (number(found.reference), number(found.ours), found.unit, error_text(found.error)) if found else ("", "", "", "")
        )
        table.add_row(result.case.name, *values, f"{result.case.bound:.1e}", result.status)
    console = Console(width=max(Console().width, 110))
    console.print(table)
    for result in results:
        if result.comparison:
            print("".join(f"{line}\n" for line in result.comparison.lines), end="")
        if result.note:
            console.print(f"{result.case.name}: {_status(result)}", markup=False)
    console.print(_counts(results))


def write_page(results: Sequence[Result], path: Path) -> None:
    """Write the page of all results to `path`: the hand-written head, a table for each kind, then every case."""
    lines = [HEAD.read_text(encoding="utf-8").rstrip(), "", "## Results", "", _counts(results)]
    for kind, title in KINDS.items():
        chosen = [result for result in results if result.case.kind == kind]
        if chosen:
            lines += ["", f"### {title}", "", INTRODUCTIONS[kind], "", *_summary(chosen)]
    lines += ["", "## Every case", ""]
    for result in results:
        lines += _section(result)
    path.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


def _status(result: Result) -> str:
    """Return the status with its note."""
    return f"{result.status}: {result.note}" if result.note else result.status


def _counts(results: Sequence[Result]) -> str:
    """Return how many cases ended in which way."""
    numbers = {status: sum(result.status == status for result in results) for status in (WITHIN, OUTSIDE, FAILED, NOT_RUN)}
    ends = ", ".join(f"{count} {status}" for status, count in numbers.items() if count)
    return f"{len(results)} cases: {ends}. Errors below 1e-12 are rounding and are not resolved further."


def _summary(results: Sequence[Result]) -> list[str]:
    """Return a table with one line for each case."""
    lines = ["| case | reference | ours | unit | values | error | bound | |", "|---|---|---|---|---|---|---|---|"]
    for result in results:
        found, case = result.comparison, result.case
        cells = (
            f"{number(found.reference)} | {number(found.ours)} | {found.unit} | {found.values} | {error_text(found.error)}"
            if found
            else " | | | |"
        )
        lines.append(f"| [{case.name}](#{case.name}) | {cells} | {case.bound:.1e} | {_status(result)} |")
    return lines


def _section(result: Result) -> list[str]:
    """Return the description of one case."""
    case, found = result.case, result.comparison
    lines = [
        f"### {case.name}",
        "",
        f"{case.title}. {case.compares}",
        "",
        f"- Source: {case.source}",
        f"- Date of the reference: {case.date}",
        f"- Bound: {case.bound:.1e}: {case.reason}",
        f"- Result: {_status(result)}" + (f", error {error_text(found.error)}" if found else ""),
        "",
    ]
    if found and found.lines:
        lines += ["```text", *found.lines, "```", ""]
    if found and found.details:
        lines += ["| | reference | ours | error |", "|---|---|---|---|"]
        lines += [f"| {row[0]} | {number(row[1])} | {number(row[2])} | {error_text(row[3])} |" for row in found.details]
        lines.append("")
    return lines
