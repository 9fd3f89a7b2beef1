"""The options of `wirerope frf`."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter


def frf(
    model: str,
    *,
    acceleration: Annotated[list[float] | None, Parameter(consume_multiple=True, negative=())] = None,
    acceleration_g: Annotated[list[float] | None, Parameter(consume_multiple=True, negative=())] = None,
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
    orders: Annotated[list[float] | None, Parameter(consume_multiple=True, negative=())] = None,
    speed_rpm: Annotated[list[float] | None, Parameter(consume_multiple=True, negative=())] = None,
    keep: Path | None = None,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Compute the frequency response of a model: resonances, folds and jumps, what is stable, and pictures of it.

    Periodic motions are followed over frequency around folds, with their Floquet multipliers; sweeps up and down show what a
    shaker would see. The folder holds settings, summary, tables, pictures and a recording in which one scrubs along the
    resonance. A branch that ends before the end of the range exits 1.

    Args:
        model: path of an MJCF model with mounts, or the name of one that ships with the package.
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
        force: replace a frequency response that is there.
    """
    from wirerope_mj.cli.frf import frf_command, levels
    from wirerope_mj.dynamics.frequency_response import ResponseOptions
    from wirerope_mj.dynamics.frequency_response.summary import order_bands
    from wirerope_mj.foundation.directions import direction_in

    if (orders is None) != (speed_rpm is None):
        raise ValueError("`--orders` and `--speed-rpm` belong together: give both.")
    bands = () if orders is None or speed_rpm is None else order_bands(orders, speed_rpm)
    options = ResponseOptions(
        accelerations=levels(acceleration, acceleration_g), method=method, start=start, stop=stop,
        direction=direction_in(direction, "--direction"), payload=payload, rate=rate,
        periods=int(periods) if float(periods).is_integer() else periods,  # type: ignore[arg-type]  # refused by name below
        response_direction=None if response_direction is None
        else direction_in(response_direction, "--response-direction"),
        largest_step=largest_step, smallest_step=smallest_step, smoothing=smoothing,
    )  # fmt: skip
    return frf_command(model, options, bands=bands, keep=keep, out=out, force=force)
