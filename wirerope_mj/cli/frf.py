"""`wirerope frf`: branches of periodic motions and sweeps of a model, as tables on the screen and as one folder."""

import sys
from pathlib import Path
from typing import Literal

from wirerope_mj.cli.options import All, Deck, Force, Model, Numbers, dated
from wirerope_mj.cli.tables import TIMELINE, say_next, say_where
from wirerope_mj.content.response_curve import response_content
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import level_summaries, order_bands
from wirerope_mj.engine.flexible import deck_of
from wirerope_mj.engine.statics import model_warnings
from wirerope_mj.engine.system import load_on_deck
from wirerope_mj.foundation.atomic_files import check_folder
from wirerope_mj.foundation.directions import direction_in
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.runs.analyses import KIND, MARKS, write_frequency_response
from wirerope_mj.views.terminal import print_warnings, show_result

NOT_COMPLETE = 1  # Exit code of a response with a branch that ended before the end of the range
DEFAULT = 1.0  # Level where none is said [m/s^2]: a tenth of a g, as a resonance search on a shaker takes


def frf(
    model: Model,
    *,
    acceleration: Numbers = None,
    acceleration_g: Numbers = None,
    method: Literal["sweep", "continuation", "both"] = "continuation",
    start: float | None = None,
    stop: float | None = None,
    direction: str = "z",
    response_direction: str | None = None,
    payload: str | None = None,
    rate: float = 1.0,
    periods: float = 1,
    largest_step: float = 0.02,
    smallest_step: float = 1e-5,
    smoothing: float | None = None,
    orders: Numbers = None,
    speed_rpm: Numbers = None,
    deck: Deck = None,
    keep: Path | None = None,
    out: Path | None = None,
    every: All = False,
    force: Force = False,
) -> int:
    """Compute the frequency response of a model: resonances, folds and jumps, what is stable, and pictures of it.

    Periodic motions are followed over frequency around folds, with their Floquet multipliers; sweeps up and down show what a
    shaker would see. The folder holds settings, summary, tables, pictures and a recording in which one scrubs along the
    resonance. A branch that ends before the end of the range exits 1.

    Args:
        acceleration: levels of the base's acceleration [m/s^2], one or several; 1 by default.
        acceleration_g: the same in g.
        method: follow periodic motions, sweep up and down, or both beside each other.
        start: lowest frequency [Hz]; from the system's natural frequencies by default.
        stop: highest frequency [Hz].
        direction: along which the base moves: x, y, z or a vector such as 1,0,1.
        response_direction: along which the payload's acceleration is taken; that of the base by default.
        payload: body whose acceleration is shown; the first payload by default.
        rate: of the sweeps [octaves/min].
        periods: of the base after which the motions repeat themselves; 2, 3, .. for subharmonics.
        largest_step: largest relative change of the frequency between two points of a branch.
        smallest_step: smallest one before a branch is given up.
        smoothing: fraction of the mounts' largest velocity over which the continuation smooths the laws; none by default.
        orders: orders of a machine's speed that are shaded in the pictures, such as 0.5 1 2, and held against the resonances.
        speed_rpm: its speed [1/min], or the lowest and the highest.
        keep: folder that keeps the points as they are found: the same command resumes there after it was interrupted.
        out: folder of the result; runs/MODEL-frf-DATE-TIME by default.
    """
    if (orders is None) != (speed_rpm is None):
        raise ValueError("`--orders` and `--speed-rpm` belong together: give both.")
    bands = () if orders is None or speed_rpm is None else order_bands(orders, speed_rpm)
    if acceleration is not None and acceleration_g is not None:
        raise ValueError("give the levels as `--acceleration` [m/s^2] or as `--acceleration-g` [g], not both.")
    in_g = None if acceleration_g is None else [level * STANDARD_GRAVITY for level in acceleration_g]
    options = ResponseOptions(
        accelerations=tuple(in_g or acceleration or [DEFAULT]), method=method, start=start, stop=stop,
        direction=direction_in(direction, "--direction"), payload=payload, rate=rate,
        periods=int(periods) if float(periods).is_integer() else periods,  # type: ignore[arg-type]  # refused by name below
        response_direction=None if response_direction is None else direction_in(response_direction, "--response-direction"),
        largest_step=largest_step, smallest_step=smallest_step, smoothing=smoothing,
    )  # fmt: skip
    system = load_on_deck(model, deck_of(deck) if deck else None)
    print_warnings(model_warnings(system))
    folder = out or dated(f"{system.name}-frf")
    check_folder(folder, force=force, kind=KIND, marks=MARKS)
    watched = sys.stderr.isatty()
    report = _report if watched else None
    result = frequency_response(system, options, name=system.name, report=report, keep=keep, progress=True)
    if watched:
        _report("writing tables, pictures and the recording")
    findings = level_summaries(result)
    content = response_content(result, findings, bands)
    write_frequency_response(result, findings, content, folder, force=force)
    show_result(content, "brief", "answer", "peaks", others=("levels",), every=every)
    say_where(folder, every=every)
    say_next({("show", folder): TIMELINE} if (folder / "run.rrd").is_file() else {})
    return 0 if result.complete else NOT_COMPLETE


def _report(text: str) -> None:
    print(plain(f"{text} .."), file=sys.stderr, flush=True)
