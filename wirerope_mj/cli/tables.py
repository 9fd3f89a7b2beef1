"""Results on the terminal: a run's verdict as soon as it is known, what was written where, lists of what ships."""

import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from time import perf_counter

from rich.markup import escape

from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.run import numerics_statement, run_content
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.views.terminal import console, print_table, show_answer


def print_questions(kind: str, questions: Mapping[str, str]) -> None:
    columns = Column(kind, align="left"), Column("question", align="text")
    print_table(Table(title="", columns=columns, rows=list(questions.items())))


def run_and_print(scenario: Scenario, folder: Path, *, force: bool, state: bool = False, decks: bool = False) -> None:
    """Simulate a scenario, print peaks and verdicts, write its folder, and print what lies there.

    An error after the verdict carries a note that the verdict holds and that there is no folder.
    """
    from wirerope_mj.runs import write_run

    began, printed = perf_counter(), False

    def show(judged: JudgedRun) -> None:
        nonlocal printed
        out, content, seconds = console(), run_content(judged), perf_counter() - began
        out.print(f"\n[bold]{escape(scenario.name)}[/]  {escape(scenario.motion.description)}")
        show_answer(content, "warnings", *content.sections_of("summary"))
        how = numerics_statement(judged.response.numerics).text
        out.print(f"\n  {escape(how)}; verdict after {seconds:.1f} s")
        sys.stdout.flush()  # into a file or a pipe it would come with the last line
        printed = True

    try:
        watched = sys.stderr.isatty()
        write_run(scenario, folder, force=force, progress=watched, when_judged=show, state=state, decks=decks)
    except BaseException as error:
        if printed:
            error.add_note(f"the peaks and verdicts above hold, but the run was not written to {folder}.")
        raise
    print_written(folder, seconds=perf_counter() - began)


def print_written(folder: Path, *, seconds: float) -> None:
    """Print where the files of a run are, how long all of it took [s], and how they are shown."""
    files = sorted(path.name for path in folder.iterdir() if path.is_file())
    folders = sorted(f"{path.name}/" for path in folder.iterdir() if path.is_dir())
    say_where(f"{folder}/, {seconds:.1f} s in all", [*files, *folders], show=folder)


def say_where(place: str, files: Iterable[str] = (), *, show: Path | None = None, effect: str = "opens the view") -> None:
    """Print where a result was written, the names of its files, and how it is shown."""
    out = console()
    out.print(f"  written to {escape(place)}", soft_wrap=True)
    if names := ", ".join(files):
        out.print(f"  {escape(names)}", soft_wrap=True)
    if show is not None:
        out.print(f"  [bold]wirerope show {escape(str(show))}[/] {effect}", soft_wrap=True)
