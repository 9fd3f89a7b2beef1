"""`wirerope frf`: branches of periodic motions and sweeps of a model, as tables on the screen and as one folder."""

import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from rich.markup import escape

from wirerope_mj.cli.frf_tables import print_response
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import OrderBand, level_summaries, order_statements
from wirerope_mj.engine.statics import model_warnings
from wirerope_mj.engine.system import load_system
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.runs.folder import check_target
from wirerope_mj.runs.frequency_response import KIND, MARKS, write_frequency_response
from wirerope_mj.views.terminal import console, print_lines, print_warnings

NOT_COMPLETE = 1
"""Exit code of a response with a branch that ended before the end of the range."""

DEFAULT = 1.0
"""Level where none is said [m/s^2]: a tenth of a g, as a resonance search on a shaker takes."""


def frf_command(
    model: str,
    options: ResponseOptions,
    *,
    bands: Sequence[OrderBand],
    keep: Path | None,
    out: Path | None,
    force: bool,
) -> int:
    """Compute a frequency response, write its folder, print its peaks and events; return the exit code."""
    system = load_system(model)
    print_warnings(model_warnings(system))
    folder = out or Path("runs") / f"{system.name}-frf-{datetime.now():%Y%m%d-%H%M%S}"
    check_target(folder, force=force, kind=KIND, marks=MARKS)
    watched = sys.stderr.isatty()
    report = _report if watched else None
    result = frequency_response(system, options, name=system.name, report=report, keep=keep, progress=watched)
    if watched:
        _report("writing tables, pictures and the recording")
    findings = level_summaries(result)
    write_frequency_response(result, findings, folder, force=force, bands=bands)
    print_response(result, findings)
    print_lines([*order_statements(bands, findings)])
    _print_written(folder)
    return 0 if result.complete else NOT_COMPLETE


def levels(acceleration: Sequence[float] | None, acceleration_g: Sequence[float] | None) -> tuple[float, ...]:
    """Return the levels [m/s^2] of the two options, of which one may be given."""
    if acceleration is not None and acceleration_g is not None:
        raise ValueError("give the levels as `--acceleration` [m/s^2] or as `--acceleration-g` [g], not both.")
    if acceleration_g is not None:
        return tuple(level * STANDARD_GRAVITY for level in acceleration_g)
    return (DEFAULT,) if acceleration is None else tuple(acceleration)


def _report(text: str) -> None:
    """Say what is being done on standard error."""
    print(plain(f"{text} .."), file=sys.stderr, flush=True)


def _print_written(folder: Path) -> None:
    screen = console()
    files = sorted(path.name for path in folder.iterdir() if path.is_file())
    screen.print(f"\n  written to {escape(str(folder))}/", soft_wrap=True)
    screen.print(f"  {', '.join(files)}, model/", soft_wrap=True)
    if "run.rrd" in files:
        screen.print(f"  [bold]wirerope show {escape(str(folder))}[/] opens the view", soft_wrap=True)
