"""Results on the terminal: a run's verdict as soon as it is known, what was written where, lists of what ships."""

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter

from rich.markup import escape

from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.run import numerics_statement, run_content
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.runs.page import REPORT
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.views.terminal import console, print_lines, print_table, show, show_result

TIMELINE, DOCUMENT = "opens the timeline", "makes a document of it"  # what commands do with a result


def print_questions(kind: str, questions: Mapping[str, str]) -> None:
    """Print what ships of a kind, by name, with the question that each answers."""
    columns = Column(kind, align="left"), Column("question", align="text")
    print_table(Table(title="", columns=columns, rows=list(questions.items())))


def run_and_print(
    scenario: Scenario, folder: Path, *, force: bool, every: bool, state: bool = False, decks: bool = False
) -> None:  # fmt: skip
    """Simulate a scenario, print its verdict and criteria, or every table, write its folder, and print what lies there.

    An error after the verdict carries a note that the verdict holds and that there is no folder.
    """
    from wirerope_mj.runs import write_run

    began, printed = perf_counter(), False

    def show_verdict(judged: JudgedRun) -> None:
        nonlocal printed
        content = run_content(judged)
        show(content, "warnings")
        show_result(content, "brief", others=(*content.sections_of("summary"), "answer"), every=every)
        if every:
            how = numerics_statement(judged.response.numerics).text
            print_lines([f"{how}; verdict after {perf_counter() - began:.1f} s"])
        sys.stdout.flush()  # into a file or a pipe it would come with the last line
        printed = True

    try:
        write_run(scenario, folder, force=force, progress=True, when_judged=show_verdict, state=state, decks=decks)
    except BaseException as error:
        if printed:
            error.add_note(f"the peaks and verdicts above hold, but the run was not written to {folder}.")
        raise
    print_written(folder, seconds=perf_counter() - began, every=every)


def print_written(folder: Path, *, seconds: float, every: bool) -> None:
    """Print where the files of a run are, how long all of it took [s], and what to do next."""
    say_where(folder, seconds=seconds, every=every)
    say_next({("show", folder): TIMELINE, ("report", folder, "--pdf"): DOCUMENT})


def say_where(folder: Path, *, seconds: float | None = None, every: bool) -> None:
    """Print where a result was written, with its page, and how long that took [s]; where asked, the names of all files."""
    page = f"{REPORT}, with every table" if (folder / REPORT).is_file() else ""
    took = "" if seconds is None else f"; {seconds:.1f} s in all"
    print()
    print_lines([f"written to {folder}/{page}{took}"])
    if every:  # what begins with a dot another process is writing just now
        print_lines([", ".join(sorted(f"{path.name}{'/' * path.is_dir()}" for path in folder.glob("[!.]*")))])


def say_next(commands: Mapping[tuple[str | Path, ...], str], *, again: str = "") -> None:
    """Print commands that go on from a result, each with what it does, as a shell takes them; or options of the same one."""
    texts = {f"wirerope {shlex.join(map(str, words))}": effect for words, effect in commands.items()}
    texts |= {f"the same with {again}": "prints every table"} if again else {}
    longest = max(map(len, texts), default=0)
    for text, effect in texts.items():
        console().print(f"  [bold]{escape(text)}[/]{' ' * (longest - len(text))}  {effect}", soft_wrap=True)
