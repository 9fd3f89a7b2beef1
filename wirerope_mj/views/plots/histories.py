"""Utilisation of limits, histories and loops of a response as pictures."""

from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.views.colours import LIGHT
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import short
from wirerope_mj.views.selection import NAMED, Selection, main_direction, travel_limits
from wirerope_mj.views.thin import envelope, is_dense

_LONG = 10_000  # samples from which loops are drawn around the largest deflection only
_AROUND = 300  # samples before and after it
_FINE = 1 / 400  # of the largest value: a third of a pixel of a panel
_UNITS = {"deflection": "mm", "force": "kN"}


def save_histories(response: Response, path: str | Path, selection: Selection, *, title: str = "") -> None:
    """Write a picture of what is used of the limits, of accelerations, and of deflections and forces along the main axis."""
    rows = [*(["used"] if selection.used else []), "acceleration", *(_UNITS if selection.axes else ())]
    figure = PlainFigure(figsize=(11.0, 1.0 + 2.6 * len(rows)), dpi=110)
    panels = np.atleast_1d(figure.subplots(len(rows), 1, sharex=True))
    height = float(figure.get_size_inches()[1])
    # Fixed, because to fit them to the texts takes as long as to draw them.
    figure.subplots_adjust(left=0.075, right=0.985, top=1.0 - 0.7 / height, bottom=0.5 / height, hspace=0.12)
    figure.suptitle("\n".join(wrap(title.replace(" s + ", " s +\u00a0"), 105)), fontsize=12, fontweight="bold")
    for name, panel in zip(rows, panels, strict=True):
        if name == "used":
            _used(panel, response, selection)
        elif name == "acceleration":
            _accelerations(panel, response, selection)
        else:
            _mounts(panel, response, selection, name)
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
        panel.legend(fontsize=8, loc="upper right", ncols=2)
    if selection.window[0] < selection.window[1]:
        panels[-1].set_xlim(*selection.window)
    panels[-1].set_xlabel("time [s]")
    figure.savefig(path)


def _used(panel: Any, response: Response, selection: Selection) -> None:
    values = [in_unit(one.course, "%") for one in selection.used]
    labels = [f"{one.subject}: {one.governing.criterion} {in_unit(one.largest, '%'):.0f} %" for one in selection.used]
    _lines(panel, response, values, labels, [_colour(selection, one.subject) for one in selection.used])
    panel.axhline(100.0, color=_hex(LIGHT.limit), ls="--", lw=1.0, label="limit")
    panel.set_ylabel("used of the limit [%]")
    panel.set_ylim(bottom=0.0)


def _accelerations(panel: Any, response: Response, selection: Selection) -> None:
    direction = main_direction(response)
    peaks = [(name, response.bodies[name].acceleration) for name in selection.bodies]
    peaks += [(name, response.points[name].acceleration) for name in selection.points]
    parts = [(name, _along(values, direction)) for name, values in peaks]
    parts.sort(key=lambda part: float(np.abs(part[1]).max()), reverse=True)
    _lines(panel, response, [_along(response.base.acceleration, direction)], ["base"], [_hex(LIGHT.base)])
    names = [name for name, _ in parts]
    _lines(panel, response, [values for _, values in parts], names, [_colour(selection, name) for name in names])
    panel.set_ylabel("acceleration, norm [g]" if direction == "total" else f"acceleration {direction} [g]")


def _mounts(panel: Any, response: Response, selection: Selection, quantity: str) -> None:
    axis = selection.axes[0]
    names, unit = selection.leading[quantity, axis], _UNITS[quantity]
    values = [in_unit(getattr(response.mounts[name], quantity)[:, AXES.index(axis)], unit) for name in names]
    _lines(panel, response, values, list(names), [_colour(selection, name) for name in names])
    panel.set_ylabel(f"{axis} {quantity} [{unit}]")
    if quantity == "deflection":
        worst = selection.ranked[axis][0]
        mount = next(mount for mount in response.scene.mounts if mount.name == worst)
        low, high = panel.get_ylim()
        for limit in dict.fromkeys(in_unit(limit, "mm") for limit in travel_limits(mount, axis)):
            if 1.5 * low < limit < 1.5 * high:  # farther away it would only flatten the curves
                label = f"rated travel of {worst}"
                panel.axhline(limit, color=_hex(LIGHT.limit), ls="--", lw=1.0, label=label)


def _lines(
    panel: Any, response: Response, values: Sequence[Array], labels: Sequence[str], colours: Sequence[str]
) -> None:
    """Draw series, the most important first and in front; what oscillates too often for a line as its envelope."""
    for number, (series, label, colour) in enumerate(zip(values, labels, colours, strict=True)):
        named = number < NAMED
        look = {"lw": 1.2 if named else 0.6, "zorder": 3.0 - 0.01 * number}
        colour = colour if named else "0.8"
        said = short(label) if named else f"{len(values) - NAMED} others" if number == NAMED else None
        tolerance = _FINE * max(float(np.abs(series).max()), 1e-12)
        if is_dense(response.time, series[:, None], tolerance):
            time, low, high = envelope(response.time, series[:, None])
            panel.plot(time, high[:, 0], color=colour, label=said, **look)
            if (low < 0.0).any():
                panel.plot(time, low[:, 0], color=colour, **look)
        else:
            panel.plot(response.time, series, color=colour, label=said, **look)


def save_mount_loops(response: Response, path: str | Path, selection: Selection, *, title: str = "") -> None:
    """Write a picture of the force-deflection loops of the mount that uses most of its limits.

    Of a long response only what surrounds the largest deflection is drawn: thousands of loops would be one blot.
    """
    name = selection.governing or response.scene.isolating[0].name
    entry = next(mount for mount in response.scene.mounts if mount.name == name)
    mount, part = response.mounts[name], slice(None)
    where = ""
    if response.time.size > _LONG:
        middle = int(np.searchsorted(response.time, response.peaks.mounts[name].deflection.time))
        part = slice(max(middle - _AROUND, 0), middle + _AROUND)
        where = f", {response.time[part][0]:.5g} to {response.time[part][-1]:.5g} s"
    deflection, force = in_unit(mount.deflection[part], "mm"), in_unit(mount.force[part], "kN")
    axes = [axis for axis in range(len(AXES)) if force[:, axis].any()] or [AXES.index("axial")]
    figure = PlainFigure(figsize=(1.0 + 4.4 * len(axes), 4.6), dpi=110)
    panels = np.atleast_1d(figure.subplots(1, len(axes)))
    width = float(figure.get_size_inches()[0])
    figure.subplots_adjust(left=0.75 / width, right=1.0 - 0.15 / width, top=0.8, bottom=0.12, wspace=0.24)
    figure.suptitle(f"{title}\n{name}, {entry.isolator}{where}", fontsize=12, fontweight="bold")
    for axis, panel in zip(axes, panels, strict=True):
        panel.plot(deflection[:, axis], force[:, axis], color=_colour(selection, name), lw=0.8)
        panel.plot(deflection[0, axis], force[0, axis], "o", color="0.2", ms=5, label="start")
        panel.set_title(AXES[axis])
        panel.set_xlabel("deflection [mm]")
        panel.set_ylabel("force [kN]")
        panel.grid(color="0.92")
        panel.legend(fontsize=8, loc="upper left")
    figure.savefig(path)


def _along(acceleration: Array, direction: str) -> Array:
    """Return an acceleration (n_t, 3) along an axis, or its size [g], (n_t,)."""
    values = in_unit(acceleration, "g")
    return np.asarray(np.linalg.norm(values, axis=1) if direction == "total" else values[:, "xyz".index(direction)])


def _colour(selection: Selection, name: str) -> str:
    return _hex(selection.colour_on(LIGHT, name))


def _hex(colour: tuple[int, int, int]) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour)
