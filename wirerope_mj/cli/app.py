"""Commands of `wirerope`, and how their errors become one message and an exit code."""

import atexit
import gc
import math
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from signal import SIGTERM, default_int_handler, signal
from threading import current_thread, main_thread
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, Parameter
from cyclopts.exceptions import CycloptsError

from wirerope_mj.cli.compare import compare
from wirerope_mj.cli.frf_options import frf
from wirerope_mj.cli.identify_options import identify_records
from wirerope_mj.cli.integers import Integer
from wirerope_mj.cli.isolators import fit_isolator, print_isolator, print_isolators
from wirerope_mj.cli.loops_options import loops
from wirerope_mj.cli.modes import modes
from wirerope_mj.cli.option_errors import option_message
from wirerope_mj.cli.report import report
from wirerope_mj.cli.run import list_scenarios, run_command
from wirerope_mj.cli.screen import without_reader
from wirerope_mj.cli.select_options import select
from wirerope_mj.cli.shock import shock
from wirerope_mj.cli.statics import statics
from wirerope_mj.cli.study import list_studies, study_command
from wirerope_mj.cli.study_report import study_report
from wirerope_mj.foundation.errors import (
    AccuracyWarning,
    ClusterWarning,
    ModelWarning,
    RecordWarning,
    StudyWarning,
    WireRopeError,
)
from wirerope_mj.foundation.plain_text import plain, plain_lines

if TYPE_CHECKING:
    from wirerope_mj.runs import Replay

BAD_INPUT, INTERRUPTED, DIFFERENT = 2, 130, 1
"""Exit codes: an input is wrong; Ctrl-C, as shells count it; a replay gives other numbers."""

atexit.register(gc.freeze)
"""A process that ends need not look through 300,000 objects for circles three times: that takes 0.6 s after a run."""

app = App(
    name="wirerope",
    version=version("wirerope-mj"),
    help="Shock and vibration of equipment and floors on wire-rope isolators.",
    suppress_keyboard_interrupt=False,  # `main` says what was left behind
)
# The scenario's own options are not known before its file is read: everything behind its name is handed on as it is.
run_app = App(name="run", help_flags=[], version_flags=[], suppress_keyboard_interrupt=False)
app.command(run_app)


@run_app.default
def run(*tokens: Annotated[str, Parameter(show=False, allow_leading_hyphen=True)]) -> int:
    """Simulate a scenario into one folder and print its peaks against the limits.

    wirerope run SCENARIO [OPTIONS] [--accuracy A | --timestep SECONDS] [--out FOLDER] [--force]

    SCENARIO is the path of a scenario file or the name of one that ships with the package; `wirerope run --list` shows
    those, and `wirerope run SCENARIO --help` the options of one. The folder is runs/NAME-DATE-TIME unless --out names
    another; a run that is there is replaced only with --force.
    """
    if not tokens or tokens[0] in ("--help", "-h"):
        app.help_print(["run"])
        return 0 if tokens else BAD_INPUT
    if tokens[0] == "--list":
        list_scenarios()
        return 0
    if tokens[0].startswith("-"):
        raise ValueError(f"the scenario comes first: wirerope run SCENARIO {' '.join(tokens)}")
    run_command(tokens[0], tokens[1:])
    return 0


study_app = App(name="study", help_flags=[], version_flags=[], suppress_keyboard_interrupt=False)
app.command(study_app)


@study_app.default
def study(*tokens: Annotated[str, Parameter(show=False, allow_leading_hyphen=True)]) -> int:
    """Compute many variants of one system into one folder: what is likely, which inputs matter, which variants are worst.

    wirerope study STUDY [OPTIONS] [--out FOLDER] [--resume] [--force] [--workers N] [--by MEASURE] [--open-worst K]

    STUDY is the path of a study file or the name of one that ships with the package; `wirerope study --list` shows those,
    and `wirerope study STUDY --help` the options of one. A study that was interrupted is resumed with --resume --out FOLDER.

    wirerope study SCENARIO --vary "NAME = DISTRIBUTION" [--vary ...] [--variants N] [--sampling S] [OPTIONS]

    A scenario that `wirerope run` takes becomes a study by what varies of it; without --vary, all that can vary is listed.
    """
    if not tokens or tokens[0] in ("--help", "-h"):
        app.help_print(["study"])
        return 0 if tokens else BAD_INPUT
    if tokens[0] == "--list":
        list_studies()
        return 0
    if tokens[0].startswith("-"):
        raise ValueError(f"the study comes first: wirerope study STUDY {' '.join(tokens)}")
    study_command(tokens[0], tokens[1:])
    return 0


@app.command
def show(folder: Path, *, web: Annotated[bool, Parameter(negative=())] = False) -> int:
    """Open a run, or the worst variants of a study, in the rerun viewer.

    Args:
        folder: folder of a run, or of a study whose worst variants --open-worst wrote, or a .rrd file.
        web: show it in a browser of this machine instead of a window.
    """
    from wirerope_mj.runs.checksums import warn_of_alterations
    from wirerope_mj.views.recording import show as show_recording

    warn_of_alterations(folder)
    show_recording(folder, web=web)
    return 0


@app.command
def replay(folder: Path) -> int:
    """Simulate a run again from its folder alone and say whether the numbers agree and which files were altered.

    Compared are all stored numbers: samples, peaks, states, and those of summary.json. The exit code is 0, or 1 if they do not
    agree or a file was altered or removed since the run was written.

    Args:
        folder: folder of a run.
    """
    from wirerope_mj.runs import replay as replay_run

    result = replay_run(folder, progress=sys.stderr.isatty())
    print(plain(f"{folder}: {_replayed(result)}"))
    if result.alterations is None:
        print("There is no checksums.txt here: what else was altered since the run was written is not known.")
    else:
        print(plain(result.alterations.text or "No file was altered since the run was written."))
    return 0 if result.agrees and result.intact else DIFFERENT


def _replayed(result: "Replay") -> str:
    """Return a sentence on whether the numbers are the same."""
    if result.identical:
        return "every stored number is bit-identical: samples, peaks, states and summary."
    if math.isinf(result.largest_difference):
        return f"{result.column} is not what is computed from the folder; the numbers do not agree."
    cause = "rounding, as of another processor" if result.agrees else "the numbers do not agree"
    return f"largest difference {result.largest_difference:.3g}, relative to the peak, in {result.column}; {cause}."


app.command(loops)
app.command(identify_records, name="identify")
app.command(frf)
app.command(report)
app.command(study_report)
app.command(compare)
app.command(shock)
app.command(select)
app.command(modes)
app.command(statics)

isolators_app = App(
    name="isolators",
    help="Show the isolators of the catalogue, fit one from a data sheet, or estimate one from its geometry.",
)
app.command(isolators_app)


@isolators_app.default
def isolators(name: str | None = None, *, out: Path | None = None) -> int:
    """Show the catalogue, or one isolator: its parameters, what its loops measure, and their picture.

    `wirerope isolators fit DATASHEET OUT` makes an isolator file from a vendor's data sheet, and `wirerope isolators estimate`
    one from the geometry alone.

    Args:
        name: isolator of the catalogue, or the path of an isolator file; without it the whole catalogue.
        out: where the picture of the loops is written (.png, .svg, .pdf).
    """
    if name is None:
        if out is not None:
            raise ValueError("`--out` writes the picture of one isolator; name it: wirerope isolators NAME --out FILE")
        print_isolators()
    else:
        print_isolator(name, out)
    return 0


@isolators_app.command
def fit(datasheet: Path, out: Path) -> int:
    """Fit an isolator from a vendor's data sheet and print every value of the sheet beside that of the fit.

    Args:
        datasheet: TOML file with the vendor's values, or with `curve = "shock"` or `"static"` and force-deflection curves.
        out: isolator file to write.
    """
    fit_isolator(datasheet, out)
    return 0


@isolators_app.command
def estimate(
    *,
    height: float,
    width: float,
    rope: float,
    loops: Integer,
    bar: float | None = None,
    bar_length: float | None = None,
    out: Path | None = None,
) -> int:
    """Estimate an isolator without data sheet from its geometry, with the errors that such estimates make of known parts.

    Args:
        height: unloaded, over both bars [mm].
        width: over the ropes, across the bars [mm].
        rope: diameter [mm].
        loops: number of full loops.
        bar: thickness of one bar [mm]; as known parts of this rope have it by default.
        bar_length: over which the loops are spread evenly [mm], for the rotational stiffness.
        out: isolator file to write; it says that all is estimated.
    """
    from wirerope_mj.cli.estimate import estimate_command

    estimate_command(height=height, width=width, rope=rope, loops=loops, bar=bar, bar_length=bar_length, out=out)
    return 0


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


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; an error is one message on standard error."""
    if current_thread() is main_thread():  # a batch system ends a job as Ctrl-C does: nothing may be left behind
        signal(SIGTERM, default_int_handler)
    given = list(sys.argv[1:] if arguments is None else arguments)
    try:
        with _warnings_shown():
            code = app(given, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except BrokenPipeError:  # the interpreter must not flush into it again
        without_reader()
        return 0
    except KeyboardInterrupt as error:
        _say("interrupted; no half-written result was left behind.")
        for remedy in error.args:  # how it is resumed
            _say(remedy)
        _say_notes(error)
        return INTERRUPTED
    except CycloptsError as error:
        _say(option_message(error, given))
        return BAD_INPUT
    except (WireRopeError, ValueError, OSError) as error:
        _say(str(error))
        _say_notes(error)
        return BAD_INPUT
