"""Commands of `wirerope`, and how their errors become one message and an exit code."""

import ast
import atexit
import gc
import os
import re
import shutil
import sys
import tempfile
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from importlib.metadata import version
from inspect import getdoc
from pathlib import Path
from typing import Any
from uuid import uuid4

from cyclopts import App
from cyclopts.exceptions import CycloptsError

from wirerope_mj.cli.options import BAD_INPUT
from wirerope_mj.foundation.errors import (
    AccuracyWarning,
    ClusterWarning,
    FontWarning,
    ModelWarning,
    RecordWarning,
    StudyWarning,
    WireRopeError,
)
from wirerope_mj.foundation.interrupts import INTERRUPTED, MESSAGE, at_end
from wirerope_mj.foundation.plain_text import plain_lines, short
from wirerope_mj.foundation.processes import allow_one_beside

_NAMES = (
    "new", "check", "run", "cases", "study", "show", "replay", "loops", "identify", "calibrate", "laws", "frf", "report",
    "study-report", "compare", "share", "film", "board", "shock", "fmu", "export", "durability", "comfort",
    "flexible", "levels", "schemas", "select", "modes", "statics", "isolators", "compile",
)  # fmt: skip
# Where a command stands in this folder if it is not called as its file is; it is imported when it is asked for.
_PLACES = {
    "identify": "identify:identify_records", "laws": "loops:laws", "study-report": "report:study_report",
    "share": "exports:share", "film": "exports:film", "fmu": "exports:fmu", "export": "exports:export",
    "levels": "levels:levels_app", "schemas": "new:schemas", "select": "select:select_app",
    "isolators": "isolators:isolators_app", "compile": "compile:compile_kernels",
}  # fmt: skip
# Earlier names of commands: each works for one more minor version and says what it is called now.
_RENAMED = {"explore": "board"}
COMMANDS = {name: _PLACES.get(name, f"{name}:{name}") for name in _NAMES}

# A word that a message quotes is cut where no path is that long; so is a message that no screen holds.
_LONG_WORD, _LONGEST = re.compile(r"\S{600,}"), 10_000
_NEW_OBJECTS = 100_000  # after which garbage is looked for: after 700, as usual, that takes a sixth of what imports take
atexit.register(gc.freeze)
"""A process that ends need not look through 300,000 objects for circles three times: that takes 0.6 s after a run."""

app = App(
    name="wirerope",
    version=lambda: version("wirerope-mj"),
    help="Shock and vibration of equipment and floors on wire-rope isolators.",
    suppress_keyboard_interrupt=False,  # `main` says what was left behind
)


def summary_of(name: str) -> str:
    """Return the first line of a command's docstring, read without importing its file and what that needs."""
    file, _, function = COMMANDS[name].partition(":")
    parts = ast.parse((Path(__file__).parent / f"{file}.py").read_text(encoding="utf-8")).body
    called = function.removesuffix("_app")
    own = next(part for part in parts if isinstance(part, ast.FunctionDef) and part.name == called)
    return (ast.get_docstring(own) or "").partition("\n")[0]


def _add(name: str) -> None:
    """Register a command by its name, with its summary for the list of all commands."""
    if name not in _known:
        _known.add(name)
        app.command(f"wirerope_mj.cli.{COMMANDS[name]}", name=name, help=summary_of(name))


_known: set[str] = set()


def _clear(scratch: str) -> None:
    """Remove a command's temporary files, those of libraries among them, even while another thread still makes some."""
    with suppress(OSError):
        os.rename(scratch, f"{scratch}-gone")  # from here on nothing can be made in it
    shutil.rmtree(f"{scratch}-gone", ignore_errors=True)


def tell_all(name: str) -> None:
    """Give a command its whole docstring as help."""
    _add(name)
    app[name].help = getdoc(app[name].default_command)


@contextmanager
def _warnings_shown() -> Iterator[None]:
    """Print warnings about a model, a record, a response or a study, as one line each on standard error, without code."""
    ours = (ModelWarning, RecordWarning, AccuracyWarning, ClusterWarning, StudyWarning, FontWarning)
    with warnings.catch_warnings():
        for kind in ours:
            warnings.simplefilter("always", kind)
        shown = set[str]()

        def display(message: Warning | str, category: type[Warning], *_location: Any) -> None:
            text = str(message) if issubclass(category, ours) else f"{category.__name__} of a library: {message}"
            if text not in shown:
                shown.add(text)
                _say(f"warning: {text}")

        warnings.showwarning = display  # type: ignore[assignment]
        yield


def _say(message: str) -> None:
    """Print a message on standard error; what it quotes of files and names moves no cursor and colours nothing."""
    words = _LONG_WORD.sub(lambda match: short(match[0]), message)
    print(f"wirerope: {short(plain_lines(words), _LONGEST)}", file=sys.stderr)


def _say_notes(error: BaseException) -> None:
    for note in getattr(error, "__notes__", ()):
        _say(note)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; an error is one message on standard error."""
    if arguments is None:  # no Python that the command starts, libraries included, imports modules of the current folder
        os.environ["PYTHONSAFEPATH"] = "1"
        allow_one_beside()
        gc.set_threshold(_NEW_OBJECTS)
        with suppress(OSError):  # where nothing can be written; commands that need no file run there, too
            scratch = os.path.join(tempfile.gettempdir(), f"wirerope-{uuid4().hex[:12]}")
            at_end(partial(_clear, scratch))  # first: an interrupt may come between
            os.mkdir(scratch, 0o700)
            tempfile.tempdir = scratch
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given and given[0] in _RENAMED:
        _say(f"`wirerope {given[0]}` is called `wirerope {_RENAMED[given[0]]}` since version 0.2, and leaves with 0.3.")
        given[0] = _RENAMED[given[0]]
    try:
        with _warnings_shown():
            if given and given[0] in COMMANDS:
                tell_all(given[0])
            else:
                for name in COMMANDS:
                    _add(name)
            code = app(given, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except KeyboardInterrupt as error:
        _say(MESSAGE)
        for remedy in error.args:  # how it is resumed
            _say(remedy)
        _say_notes(error)
        return INTERRUPTED
    except CycloptsError as error:
        from wirerope_mj.cli.options import option_message

        _say(option_message(error, given))
        return BAD_INPUT
    except MemoryError as error:
        _say(str(error) or "there is not enough memory for this. Ask for less: a shorter duration, fewer variants or workers.")
        return BAD_INPUT
    except (WireRopeError, ValueError, OSError, ImportError) as error:
        from wirerope_mj.foundation.errors import error_text

        _say(error_text(error))
        _say_notes(error)
        return BAD_INPUT
