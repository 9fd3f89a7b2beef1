"""A run on the screen: its verdict as soon as it is known, then the folder that holds it."""

import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.views.terminal import without_reader

if TYPE_CHECKING:
    from wirerope_mj.content.judged_run import JudgedRun


def run_and_print(scenario: Scenario, folder: Path, *, force: bool, state: bool = False) -> None:
    """Simulate a scenario, print peaks and verdicts, write its folder, and print what lies there.

    An error after the verdict carries a note that the verdict holds and that there is no folder.
    """
    from wirerope_mj.cli.tables import print_verdict, print_written
    from wirerope_mj.runs import write_run

    began, printed = perf_counter(), False

    def show(judged: "JudgedRun") -> None:
        nonlocal printed
        try:
            print_verdict(scenario, judged, seconds=perf_counter() - began)
            sys.stdout.flush()  # into a file or a pipe it would come with the last line
        except BrokenPipeError:  # the folder is still wanted
            without_reader()
        printed = True

    try:
        write_run(scenario, folder, force=force, progress=sys.stderr.isatty(), when_judged=show, state=state)
    except BaseException as error:
        if printed:
            error.add_note(f"the peaks and verdicts above hold, but the run was not written to {folder}.")
        raise
    print_written(folder, seconds=perf_counter() - began)
