"""What the payload and the mounts do, as pictures: accelerations, deflections and loops."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from wirerope_mj.plots.report_image import (
    BASE,
    COLOURS,
    RATED,
    WIDTH,
    Array,
    dress,
    legend_above,
    line,
    report_style,
    round_ticks,
    thinned,
)
from wirerope_mj.response import Response
from wirerope_mj.response.columns import column_of
from wirerope_mj.units import STANDARD_GRAVITY
from wirerope_mj.verdicts import AXES

MOST = 3
"""Lines of bodies or mounts in one panel: more cannot be told apart."""

_LONG = 10_000  # samples from which loops are drawn around the largest deflection only
_AROUND = 300  # samples before and after it


def accelerations_figure(response: Response, names: Sequence[str], base: tuple[Array, Array]) -> Figure:
    """Return the accelerations of the base and of some bodies or points along x, y and z over time.

    Args:
        response: of the system.
        names: bodies or points, at most `MOST` of them.
        base: instants [s] and acceleration (n_t, 3) of the base [m/s^2].
    """
    with report_style():
        figure = Figure(figsize=(WIDTH, 4.3), layout="constrained")
        panels = figure.subplots(3, 1, sharex=True)
        for axis, panel in enumerate(panels):
            line(panel, base[0], base[1][:, axis] / STANDARD_GRAVITY, "base", BASE)
            for name, colour in zip(names[:MOST], COLOURS, strict=False):
                values = acceleration_along(response, name, axis) / STANDARD_GRAVITY
                line(panel, response.time, values, short(name), colour)
            dress(panel, ylabel=f"acceleration {'xyz'[axis]} [g]")
        panels[-1].set_xlabel("time [s]")
        legend_above(figure, *panels)
    return figure


def deflections_figure(response: Response, names: Sequence[str]) -> Figure:
    """Return the deflections of some mounts along roll, shear and axial over time, with the ratings of the first."""
    travel = next(mount.travel for mount in response.scene.mounts if mount.name == names[0])
    with report_style():
        figure = Figure(figsize=(WIDTH, 4.3), layout="constrained")
        panels = figure.subplots(3, 1, sharex=True)
        for axis, panel in enumerate(panels):
            for name, colour in zip(names[:MOST], COLOURS, strict=False):
                values = 1e3 * column_of(response, f"mounts/{name}/deflection/{AXES[axis]}")
                line(panel, response.time, values, short(name), colour)
            _rate(panel, travel, AXES[axis])
            dress(panel, ylabel=f"{AXES[axis]} [mm]")
        panels[-1].set_xlabel("time [s]")
        legend_above(figure, *panels)
    return figure


def mount_loops_figure(response: Response, name: str) -> Figure:
    """Return force over deflection of a mount, a panel for each axis that carries a force; see `loop_rows`."""
    rows = loop_rows(response, name)
    deflection, force = (
        np.stack([factor * column_of(response, f"mounts/{name}/{part}/{axis}")[rows] for axis in AXES], axis=1)
        for part, factor in (("deflection", 1e3), ("force", 1e-3))
    )
    axes = [axis for axis in range(len(AXES)) if force[:, axis].any()] or [AXES.index("axial")]
    with report_style():
        figure = Figure(figsize=(WIDTH, 2.7 if len(axes) > 1 else 3.6), layout="constrained")
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
        figure = Figure(figsize=(WIDTH, 3.2), layout="constrained")
        panel = figure.subplots()
        for name, colour in (("base", BASE), *zip(names[:MOST], COLOURS, strict=False)):
            size = np.zeros(response.time.size)
            for axis in directions:
                size += acceleration_along(response, name, axis) ** 2
            found = thinned(frequency, np.sqrt(size) / STANDARD_GRAVITY)
            panel.plot(*found, color=colour, label=short(name))
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
    return column_of(response, f"{room}/acceleration/{'xyz'[axis]}")


def short(name: str) -> str:
    """Return a name as it fits a legend, and in which matplotlib finds no formula."""
    return (name if len(name) <= 28 else f"{name[:27]}…").replace("$", r"\$")


def _rate(panel: Any, travel: dict[str, float], axis: str) -> None:
    """Mark the rated travel of an axis."""
    below, above = ("compression", "tension") if axis == "axial" else (axis, axis)
    label: str | None = "rated travel"
    for limit, sign in ((below, -1.0), (above, 1.0)):
        if limit in travel:
            panel.axhline(sign * 1e3 * travel[limit], color=RATED, ls="--", lw=0.9, label=label)
            label = None
