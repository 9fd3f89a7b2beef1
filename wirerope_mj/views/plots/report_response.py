"""Pictures of payload and mounts in a report: accelerations, deflections and loops."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import SIDES
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import (
    BASE,
    COLOURS,
    RATED,
    WIDTH,
    Array,
    crest,
    dress,
    legend_above,
    level,
    report_style,
    round_ticks,
    short,
    thinned,
)

MOST = 3
"""Lines of bodies or mounts in one panel: more cannot be told apart."""

_LONG = 10_000  # samples from which loops are drawn around the largest deflection only
_AROUND = 300  # samples before and after it
_ROUNDING = 1e-9  # of the largest force, below which an axis carries none
_NOTHING = 1e-6  # g or mm: an axis on which nothing is larger has no panel


class Line(NamedTuple):
    """A line of a panel."""

    name: str
    colour: str
    time: Array
    values: Array


def accelerations_figure(response: Response, names: Sequence[str], base: tuple[Array, Array]) -> Figure:
    """Return the accelerations of the base and of some bodies or points over time, a panel for each axis with any.

    Args:
        response: of the system.
        names: bodies or points, at most `MOST` of them.
        base: instants [s] and acceleration (n_t, 3) of the base [m/s^2].
    """
    lines: list[list[Line]] = []
    for axis in range(3):
        drawn = [Line("base", BASE, *thinned(base[0], in_unit(base[1][:, axis], "g")))]
        for name, colour in zip(names[:MOST], COLOURS, strict=False):
            values = in_unit(acceleration_along(response, name, axis), "g")
            drawn.append(Line(short(name), colour, *thinned(response.time, values)))
        lines.append(drawn)
    return _histories(lines, [f"acceleration\nalong {axis} [g]" for axis in "xyz"])


def deflections_figure(response: Response, names: Sequence[str]) -> Figure:
    """Return the deflections of some mounts over time, a panel for each axis with any, with the ratings of the first."""
    travel = next(mount.travel for mount in response.scene.mounts if mount.name == names[0])
    lines = [
        [
            Line(
                short(name),
                colour,
                *thinned(response.time, in_unit(response.column(f"mounts/{name}/deflection/{axis}"), "mm")),
            )
            for name, colour in zip(names[:MOST], COLOURS, strict=False)
        ]
        for axis in AXES
    ]
    return _histories(lines, [f"{axis} [mm]" for axis in AXES], [_ratings(travel, axis) for axis in AXES])


def mount_loops_figure(response: Response, name: str) -> Figure:
    """Return force over deflection of a mount, a panel for each axis that carries a force; see `loop_rows`."""
    rows = loop_rows(response, name)
    deflection, force = (
        np.stack([factor * response.column(f"mounts/{name}/{part}/{axis}")[rows] for axis in AXES], axis=1)
        for part, factor in (("deflection", 1e3), ("force", 1e-3))
    )
    largest = np.abs(force).max(axis=0)
    axes = np.flatnonzero(largest > _ROUNDING * largest.max()).tolist() or [AXES.index("axial")]
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 2.7 if len(axes) > 1 else 3.6), layout="constrained")
        for axis, panel in zip(axes, np.atleast_1d(figure.subplots(1, len(axes))), strict=True):
            panel.plot(deflection[:, axis], force[:, axis], color=COLOURS[0], lw=0.7)
            panel.plot(deflection[0, axis], force[0, axis], "o", color="0.2", ms=3.5)
            panel.set_title(AXES[axis])
            panel.set_xlabel("deflection [mm]")
            panel.grid(color="0.92")
            panel.set_axisbelow(True)
        figure.axes[0].set_ylabel("force [kN]")
    return figure


def sweep_figure(response: Response, names: Sequence[str], frequency: Any, directions: Sequence[int]) -> Figure:
    """Return accelerations over the frequency of a sweep, as far from zero as they reach.

    Args:
        response: of a swept base.
        names: bodies or points.
        frequency: of the base at every sample [Hz], (n_t,).
        directions: axes along which the base moves, 0 = x; their norm is drawn.
    """
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 3.2), layout="constrained")
        panel = figure.subplots()
        for name, colour in (("base", BASE), *zip(names[:MOST], COLOURS, strict=False)):
            size = np.zeros(response.time.size)
            for axis in directions:
                size += acceleration_along(response, name, axis) ** 2
            panel.plot(*crest(frequency, in_unit(np.sqrt(size), "g")), color=colour, label=short(name))
        panel.set_xscale("log")
        panel.set_xlabel("frequency of the base [Hz]")
        round_ticks(panel.xaxis, *panel.get_xlim())
        dress(panel, ylabel="acceleration [g]")
        legend_above(figure, panel)
    return figure


def loop_rows(response: Response, name: str) -> slice:
    """Return which samples of a mount make its loops: all, or of a long response those around its largest deflection."""
    if response.time.size <= _LONG:
        return slice(None)
    middle = int(np.searchsorted(response.time, response.peaks.mounts[name].deflection.time))
    return slice(max(middle - _AROUND, 0), middle + _AROUND)


def acceleration_along(response: Response, name: str, axis: int) -> Array:
    """Return the sampled acceleration of a body, a point or the "base" along an axis, 0 = x [m/s^2], (n_t,)."""
    room = "base" if name == "base" else f"bodies/{name}" if name in response.bodies else f"points/{name}"
    return response.column(f"{room}/acceleration/{'xyz'[axis]}")


def _histories(lines: list[list[Line]], names: list[str], marks: list[list[float]] | None = None) -> Figure:
    """Return a panel below the other for each list of lines that are not all zero, at least one; marks are dashed."""
    kept = [
        index for index, drawn in enumerate(lines) if any(np.abs(line.values).max() > _NOTHING for line in drawn)
    ] or [2]
    with report_style():
        figure = PlainFigure(
            figsize=(WIDTH, 0.7 + 1.2 * len(kept) + (0.9 if len(kept) == 1 else 0.0)), layout="constrained"
        )
        panels = np.atleast_1d(figure.subplots(len(kept), 1, sharex=True))
        for index, panel in zip(kept, panels, strict=True):
            for number, drawn in enumerate(lines[index]):
                panel.plot(
                    drawn.time, drawn.values, color=drawn.colour, label=drawn.name, zorder=level(number, drawn.colour)
                )
            for mark in marks[index] if marks else []:
                panel.axhline(mark, color=RATED, ls="--", lw=0.9, label="rated travel", zorder=2.9)
            dress(panel, ylabel=names[index])
        panels[-1].set_xlabel("time [s]")
        legend_above(figure, *panels)
    return figure


def _ratings(travel: dict[str, float], axis: str) -> list[float]:
    """Return the rated travels of an axis below and above zero [mm], as far as there are any."""
    return [
        sign * in_unit(travel[rating], "mm")
        for rating, sign in zip(SIDES[axis], (-1.0, 1.0), strict=True)
        if rating in travel
    ]
