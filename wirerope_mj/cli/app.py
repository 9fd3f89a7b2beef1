"""Commands of `wirerope`, and how their errors become one message and an exit code."""

import atexit
import gc
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from inspect import getdoc
from signal import SIGTERM, default_int_handler, signal
from threading import current_thread, main_thread
from typing import Any

from cyclopts import App
from cyclopts.exceptions import CycloptsError

from wirerope_mj.cli.options import BAD_INPUT, INTERRUPTED
from wirerope_mj.foundation.errors import (
    AccuracyWarning,
    ClusterWarning,
    ModelWarning,
    RecordWarning,
    StudyWarning,
    WireRopeError,
)
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.foundation.processes import allow_one_beside

# The first line of each command's help.
_SUMMARIES = {
    "new": "Make a model from tables of mounts, masses, stops and points, or from a template: model, plan, statics.",
    "run": "Simulate a scenario into one folder and print its peaks against the limits.",
    "cases": "Simulate the load cases of a job: which case governs each limit, and one document of all of them.",
    "study": (
        "Compute many variants of one system into one folder: what is likely, which inputs matter, which variants are worst."
    ),
    "show": "Open a run, a job, or the worst variants of a study, in the rerun viewer.",
    "replay": (
        "Simulate a run, a job or a study again from its folder alone: whether its numbers agree, which files were altered."
    ),
    "loops": "Test an isolator or a law in a virtual rig: print what its loops measure and draw them.",
    "identify": "Fit a law to records of cyclic tests: an isolator file, what the data fix, and a report.",
    "calibrate": (
        "Bring a model to measured tests: the values that they tell and how well, what they do not tell, a page, a new model."
    ),
    "laws": "Compare laws on records of cyclic tests: which fits, and which holds for amplitudes that it has not seen.",
    "frf": "Compute the frequency response of a model: resonances, folds and jumps, what is stable, and pictures of it.",
    "report": (
        "Make the report of a run, a job or a study: one HTML page that holds everything it shows, and a PDF or DOCX of it."
    ),
    "study-report": "Make the report of a study: one HTML page that holds everything it shows, and a PDF of it.",
    "compare": (
        "Lay two or more runs over each other, a run and measured tests, or two jobs: what differs, and how well they agree."
    ),
    "share": "Write report, recording and viewer of a run as one folder that any web server shows.",
    "explore": "Move sliders in a page of this machine and see verdict, curves and recording change: a what-if.",
    "shock": "Move a model's base or force its payload: pulses, sines, random vibration, records, unbalance, several at once.",
    "fmu": "Write a model as a co-simulation unit of FMI 3, which other programs run as a part of theirs.",
    "export": (
        "Write the samples of a run, or the table of a study, for other programs: CSV, HDF5, MATLAB or XLSX; or a picture."
    ),
    "durability": "Count the cycles of the mounts of a run or a service life, and compare the damage that they do.",
    "comfort": "Print what people feel at bodies and points of a run: weighted acceleration, doses, and limits for ships.",
    "flexible": "Read the modes of a deck or of equipment, check them, and write them as a part that models bend by.",
    "levels": "List files of levels to fill in from a specification, or write one, for `wirerope shock MODEL --levels FILE`.",
    "select": (
        "Choose isolators: simulate every part of the catalogue under all load cases, and rank those that keep the limits."
    ),
    "modes": (
        "Print the modes of a model about its equilibrium: frequencies, damping, shapes, and stability against tipping over."
    ),
    "statics": "Print a model's equilibrium: sag and load of every mount, tilt of the payloads, verdicts on static loads.",
    "isolators": "Show the isolators of the catalogue, fit one from a data sheet, or estimate one from its geometry.",
    "compile": "Compile all kernels for this computer, so that no later command waits for one.",
}
# Where a command stands in this folder if it is not called as its file is; it is imported when it is asked for.
_PLACES = {
    "identify": "identify:identify_records", "laws": "loops:laws", "study-report": "report:study_report",
    "share": "exports:share", "fmu": "exports:fmu", "export": "exports:export", "levels": "new:levels",
    "select": "select:select_app", "isolators": "isolators:isolators_app", "compile": "compile:compile_kernels",
}  # fmt: skip
COMMANDS = {name: (_PLACES.get(name, f"{name}:{name}"), summary) for name, summary in _SUMMARIES.items()}

atexit.register(gc.freeze)
"""A process that ends need not look through 300,000 objects for circles three times: that takes 0.6 s after a run."""

app = App(
    name="wirerope",
    version=lambda: version("wirerope-mj"),
    help="Shock and vibration of equipment and floors on wire-rope isolators.",
    suppress_keyboard_interrupt=False,  # `main` says what was left behind
)
for _name, (_place, _summary) in COMMANDS.items():
    app.command(f"wirerope_mj.cli.{_place}", name=_name, help=_summary)


def tell_all(name: str) -> None:
    """Have the help of one command say all that its docstring says.

    The line in `COMMANDS`, for the list of all commands, which imports none of them, would stand there alone.
    """
    _, _, rest = (getdoc(app[name].default_command) or "").partition("\n")
    app[name].help = f"{COMMANDS[name][1]}\n{rest}"


@contextmanager
def _warnings_shown() -> Iterator[None]:
    """Print warnings about a model, a record, a response or a study, as one line each on standard error, without code."""
    ours = (ModelWarning, RecordWarning, AccuracyWarning, ClusterWarning, StudyWarning)
    with warnings.catch_warnings():
        for kind in ours:
            warnings.simplefilter("always", kind)
        others, shown = warnings.showwarning, set[str]()

        def display(message: Warning | str, category: type[Warning], *location: Any) -> None:
            if issubclass(category, ours):
                if str(message) not in shown:
                    shown.add(str(message))
                    _say(f"warning: {message}")
            else:
                others(message, category, *location)

        warnings.showwarning = display  # type: ignore[assignment]
        yield


def _say(message: str) -> None:
    """Print a message on standard error; what it quotes of files and names moves no cursor and colours nothing."""
    print(f"wirerope: {plain_lines(message)}", file=sys.stderr)


def _say_notes(error: BaseException) -> None:
    """Print what was added to an error on its way: what holds all the same."""
    for note in getattr(error, "__notes__", ()):
        _say(note)


def _open_closed_streams() -> None:
    """Send to nowhere what goes to a standard stream that is closed; else the next file that is opened would take its place."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
    if sys.stdout is None:
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115 - for the life of the process
    if sys.stderr is None:
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; an error is one message on standard error."""
    if current_thread() is main_thread():  # a batch system ends a job as Ctrl-C does: nothing may be left behind
        signal(SIGTERM, default_int_handler)
    if arguments is None:  # no Python that the command starts, libraries included, imports modules of the current folder
        os.environ["PYTHONSAFEPATH"] = "1"
        allow_one_beside()
    _open_closed_streams()
    given = list(sys.argv[1:] if arguments is None else arguments)
    try:
        with _warnings_shown():
            if given and given[0] in COMMANDS:
                tell_all(given[0])
            code = app(given, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except BrokenPipeError:  # the interpreter must not flush into it again
        from wirerope_mj.views.terminal import without_reader

        without_reader()
        return 0
    except KeyboardInterrupt as error:
        _say("interrupted; no half-written result was left behind.")
        for remedy in error.args:  # how it is resumed
            _say(remedy)
        _say_notes(error)
        return INTERRUPTED
    except CycloptsError as error:
        from wirerope_mj.cli.options import option_message

        _say(option_message(error, given))
        return BAD_INPUT
    except (WireRopeError, ValueError, OSError) as error:
        from wirerope_mj.foundation.errors import error_text

        _say(error_text(error))
        _say_notes(error)
        return BAD_INPUT
