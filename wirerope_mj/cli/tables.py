"""Output of a run on the terminal, and where its files are; and lists of what ships."""

from collections.abc import Mapping
from pathlib import Path

from rich.markup import escape

from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.run import numerics_statement, run_content
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.views.terminal import console, print_headline, print_table, show


def print_questions(kind: str, questions: Mapping[str, str]) -> None:
    """Print what ships with the package: names of scenarios or studies and the question of each."""
    columns = Column(kind, align="left"), Column("question", align="text")
    print_table(Table(title="", columns=columns, rows=list(questions.items())))


def print_verdict(scenario: Scenario, judged: JudgedRun, *, seconds: float) -> None:
    """Print peaks against limits, the answer, how it was computed, and how long that took [s]."""
    out, content = console(), run_content(judged)
    out.print(f"\n[bold]{escape(scenario.name)}[/]  {escape(scenario.motion.description)}")
    show(content, "warnings", *content.sections_of("summary"))
    print_headline(content.verdict)
    show(content, "answer")
    out.print(f"\n  {escape(numerics_statement(judged.response.numerics).text)}; verdict after {seconds:.1f} s")


def print_written(folder: Path, *, seconds: float) -> None:
    """Print where the files of a run are, how long all of it took [s], and how they are shown."""
    out = console()
    files = sorted(path.name for path in folder.iterdir() if path.is_file())
    folders = sorted(f"{path.name}/" for path in folder.iterdir() if path.is_dir())
    shown = escape(str(folder))
    out.print(f"  written to {shown}/, {seconds:.1f} s in all", soft_wrap=True)
    out.print(f"  {', '.join([*files, *folders])}", soft_wrap=True)
    out.print(f"  [bold]wirerope show {shown}[/] opens the view", soft_wrap=True)
