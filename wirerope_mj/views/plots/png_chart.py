"""Charts as pictures in files: the panels of a page, drawn by matplotlib."""

from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import to_rgba
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator

from wirerope_mj.content.panels import BASE, LIMIT, OTHERS, Chart, Curve, Panel
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.ticks import log_ticks
from wirerope_mj.views.colours import LIGHT, field_colours, field_key, hexadecimal
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.thin import envelope, is_dense

_WIDTH, _DPI = 11.0, 110  # of a picture [in], [1/in]
_TALL = 88.0  # units of a chart's height to an inch
_LABEL = 0.5  # width of a number at a tick, and twice its height [in]
_FINE = 1 / 400  # of the largest value: a third of a pixel of a panel
_WIDE = 0.5  # of a picture, from which on a legend has two columns
_LEFT, _RIGHT, _TITLE, _LINE, _FOOT = 0.8, 0.15, 0.55, 0.2, 0.05  # room about the panels [in]
_TICKS, _NAME = 0.35, 0.2  # room below a panel, and for the name of its axis [in]
_LETTER = 0.075  # width of a letter of a name, on the average [in]


def save_charts(charts: Sequence[Chart], path: str | Path, *, title: str = "") -> None:
    """Write the panels of charts below each other, under a title, as one PNG, SVG or PDF, whole or not at all."""
    rows = [(chart, row) for chart in charts for row in chart.rows]
    below = [_TICKS + _NAME * any(panel.xlabel for panel in row) for _, row in rows]
    heights = [chart.height / _TALL + under for (chart, _), under in zip(rows, below, strict=True)]
    lines = wrap(title, 105)
    above = _TITLE + _LINE * max(len(lines) - 1, 0)
    height = sum(heights) + above + _FOOT
    figure = PlainFigure(figsize=(_WIDTH, height), dpi=_DPI)
    figure.suptitle("\n".join(lines), fontsize=12, fontweight="bold", y=1.0 - 0.12 / height, va="top")
    # Places are fixed, because to fit them to the texts takes as long as to draw them.
    top = height - above
    for (_, row), tall, under in zip(rows, heights, below, strict=True):
        names = [text for _, text in row[0].yticks]
        room = max(_LEFT, _LETTER * max(map(len, names), default=0) + 0.35)
        width = (_WIDTH - room - _RIGHT - _LEFT * (len(row) - 1)) / len(row)
        for number, panel in enumerate(row):
            left = room + number * (width + _LEFT)
            box = (left / _WIDTH, (top - tall + under) / height, width / _WIDTH, (tall - under - 0.05) / height)
            draw_panel(figure.add_axes(box), panel)
        top -= tall
    figure.savefig(path)


def draw_panel(axes: Axes, panel: Panel) -> None:
    """Draw a panel on axes of matplotlib: curves, the first in front, limits, points and its ranges."""
    for number, curve in enumerate(panel.curves):
        _draw(axes, curve, zorder=3.0 - 0.01 * number, lines=not panel.log)
    if panel.field is not None:
        cells = [[to_rgba(colour or "white") for colour in row] for row in field_colours(panel.field)]
        axes.pcolormesh(panel.field.x, panel.field.y, np.array(cells))
        for colour, text in field_key(panel.field):
            axes.plot([], [], "s", color=colour, label=text)
    _mark(axes, panel)
    for limits, set_limits in ((panel.xlim, axes.set_xlim), (panel.ylim, axes.set_ylim)):
        if limits is not None and limits[0] < limits[1]:
            set_limits(*limits)
    # After the limits: curves that are zero have none on a logarithmic axis.
    axes.set_xscale("log" if "x" in panel.log else "linear")
    axes.set_yscale("log" if "y" in panel.log else "linear")
    _shade(axes, panel)
    extent = axes.get_window_extent()
    if "x" in panel.log:
        _round_ticks(axes.xaxis, *axes.get_xlim(), most=int(extent.width / (_LABEL * axes.figure.dpi)))
    if "y" in panel.log:
        _round_ticks(axes.yaxis, *axes.get_ylim(), most=int(2.0 * extent.height / (_LABEL * axes.figure.dpi)))
    for ticks, set_ticks in ((panel.xticks, axes.set_xticks), (panel.yticks, axes.set_yticks)):
        if ticks:
            set_ticks([place for place, _ in ticks], [text for _, text in ticks])
    axes.set(xlabel=panel.xlabel, ylabel=panel.ylabel)
    axes.set_title(panel.title, loc="left", fontsize=10)
    axes.grid(color="0.92")
    axes.set_axisbelow(True)
    _name(axes, panel)


def _mark(axes: Axes, panel: Panel) -> None:
    """Draw limits, notes and points over the curves."""
    low, high = axes.get_ylim()
    for name, level in panel.limits:
        if min(low, 1.5 * low) < level < max(high, 1.5 * high):  # farther away it would only flatten the curves
            axes.axhline(level, color=hexadecimal(LIGHT.limit), ls="--", lw=1.0, label=name)
    for name, level in panel.xlimits:
        axes.axvline(level, color=hexadecimal(LIGHT.limit), ls="--", lw=1.0, label=name)
    for x, y, text, on_left in panel.notes:
        axes.annotate(
            text, (x, y), textcoords="offset points", va="center", fontsize=8, annotation_clip=True, zorder=4.0,
            bbox={"fc": "white", "ec": "none", "alpha": 0.7, "pad": 0.4},
            xytext=(-5 if on_left else 5, 0), ha="right" if on_left else "left",
        )  # fmt: skip
    for x, y in panel.dots:
        axes.plot(x, y, "o", color="0.2", ms=5)


def _name(axes: Axes, panel: Panel) -> None:
    """Write the legend, each name once, where it covers least."""
    named: dict[str, Artist] = {}
    for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
        named.setdefault(label, handle)  # each name once
    named.pop("", None)
    # The emptiest place takes long to find among the samples of a run.
    place: Entries = {"loc": "upper right" if panel.xunit == "s" else "best"}
    place["ncols"] = 2 if axes.get_position().width > _WIDE else 1
    if panel.notes or panel.yticks or panel.field:  # where texts stand among the curves
        place = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "frameon": False, "ncols": 6}
    if named:
        axes.legend(named.values(), named.keys(), fontsize=8, **place)


def _shade(axes: Axes, panel: Panel) -> None:
    """Shade ranges across, with their names at the upper end, each below those that it overlaps."""
    left, right = axes.get_xlim()
    for number, (name, low, high) in enumerate(panel.bands):
        first, last = max(low, left), min(high, right)
        if first <= last:
            over = sum(other[1] <= high and low <= other[2] for other in panel.bands[:number])
            axes.axvspan(first, last, color="0.5", alpha=0.15, lw=1.0 if first == last else 0.0, zorder=1)
            middle = (first * last) ** 0.5 if "x" in panel.log else 0.5 * (first + last)
            axes.annotate(
                name, (middle, 1.0), xycoords=axes.get_xaxis_transform(), xytext=(0.0, -12.0 * (1 + over)),
                textcoords="offset points", ha="center", fontsize=8,
            )  # fmt: skip


def _draw(axes: Axes, curve: Curve, *, zorder: float, lines: bool) -> None:
    """Draw a curve; what oscillates too often for a line as the band that it fills."""
    look: Entries = {"color": curve_colour(curve), "alpha": curve.opacity, "label": curve.name, "zorder": zorder}
    if curve.bars:
        axes.barh(curve.y, curve.x, height=curve.bars, **look)
        if curve.ends is not None:
            reach = np.abs(np.maximum([curve.x - curve.ends[:, 0], curve.ends[:, 1] - curve.x], 0.0))
            axes.errorbar(curve.x, curve.y, xerr=reach, fmt="none", ecolor="0.25", elinewidth=0.9, capsize=2.0, zorder=4.0)
        return
    if curve.marks:
        axes.plot(curve.x, curve.y, ".", ms=4.0 * curve.weight, **look)
        return
    tolerance = _FINE * max(float(np.abs(curve.y).max(initial=0.0)), 1e-12)
    if lines and (np.diff(curve.x) > 0.0).all() and is_dense(curve.x, curve.y[:, None], tolerance):
        time, low, high = envelope(curve.x, curve.y[:, None])
        axes.fill_between(time, low[:, 0], high[:, 0], lw=0.6, **look | {"alpha": 0.45})
    else:
        width = curve.weight * (0.9 if isinstance(curve.kind, str) else 1.2)
        axes.plot(curve.x, curve.y, lw=width, ls=curve.dash or "solid", **look)


def curve_colour(curve: Curve) -> str:
    """Return the colour of a curve on a light ground, as matplotlib takes it."""
    named = {BASE: LIGHT.base, OTHERS: LIGHT.others, LIMIT: LIGHT.limit}
    return hexadecimal(named[curve.kind] if curve.kind in named else LIGHT.series[int(curve.kind)])


def _round_ticks(axis: Axis, low: float, high: float, *, most: int = 12) -> None:
    """Give a logarithmic axis from `low` to `high` at most about `most` ticks at round numbers, written as such."""
    ticks = log_ticks(low, high, most=most)
    axis.set_major_locator(FixedLocator(ticks.tolist()))
    axis.set_major_formatter(FixedFormatter([f"{tick:.6g}" for tick in ticks]))
    axis.set_minor_locator(NullLocator())
