"""Pictures of a study: distributions, effects of the inputs, curves and choices."""

import math
from collections.abc import Callable, Mapping, Sequence
from textwrap import wrap
from types import MappingProxyType
from typing import Any

import numpy as np
import pyarrow as pa
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from wirerope_mj.content.panels import short
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.studies.engines.compute import DONE
from wirerope_mj.studies.results.effects import Effect
from wirerope_mj.studies.results.measure import Measure, measure_of, values_of
from wirerope_mj.studies.results.statements import not_counted, percent
from wirerope_mj.studies.results.statistics import CONFIDENCE, exceedance_of, finite, quantiles
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import BASE, COLOURS, RATED, WIDTH, report_style

QUANTILES = (0.5, 0.9, 0.95, 0.99)

_BELOW = {0.5: -4.0, 0.9: -9.5, 0.95: -8.0, 0.99: -6.0}
"""Offset of a percentile's name from its point [pt]: right of it and below, where no curve that rises goes."""

MOST_BARS = 12
"""Inputs in one picture: those below explain next to nothing."""

MOST_SCATTERS = 3
"""Inputs that are plotted with all their variants."""

_LEAST = 1.9  # height of a picture of few choices, beside which the name of their input stands [in]
_ROOM = 2.1  # length of an axis in its longest bar, so that there is room for the text beside it
_LINE = 36  # letters of a measure's text on one line
_NAME = 34  # letters of an input's name beside its bar


def distribution_figure(
    table: pa.Table, names: Sequence[str], limits: Mapping[str, float] = MappingProxyType({})
) -> Figure:
    """Return for each measure the fraction of variants that stay below a value, with percentiles and limit.

    Args:
        table: of a study whose variants were sampled.
        names: measures with values, one panel each.
        limits: of measures that have none of their own, SI, by name.
    """
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 3.3), layout="constrained")
        panels = np.atleast_1d(figure.subplots(1, len(names), sharey=True))
        for panel, name in zip(panels, names, strict=True):
            _distribution(panel, measure_of(name, limits), table)
        panels[0].set_ylabel("fraction of the variants below [%]")
    return figure


def sensitivity_figure(effects: Sequence[Effect], measure: str, labels: Mapping[str, str]) -> Figure:
    """Return what the inputs explain of a measure's variance, as bars named by `labels`; pale if they may be chance."""
    shown = list(effects[:MOST_BARS])[::-1]
    end = _ROOM * max(*(100.0 * one.index for one in shown), 2.5)
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 1.1 + 0.24 * len(shown)), layout="constrained")
        panel = figure.subplots()
        for row, one in enumerate(shown):
            colour = BASE if math.isnan(one.rank) else COLOURS[0] if one.rank >= 0.0 else COLOURS[1]
            percent_of = max(100.0 * one.index, 0.0)
            panel.barh(row, percent_of, color=colour, alpha=1.0 if one.certain else 0.25, height=0.7)
            panel.annotate(
                _sign(one), (percent_of, row), xytext=(4, 0), textcoords="offset points", va="center", fontsize=7
            )
        panel.set_yticks(range(len(shown)), [shortened(labels.get(one.name, one.name)) for one in shown])
        panel.set_xlim(0.0, end)
        panel.xaxis.set_major_locator(MaxNLocator(6))
        panel.set_xticks([tick for tick in panel.get_xticks() if 0.0 <= tick <= 100.0])
        panel.set_xlim(0.0, end)
        panel.set_xlabel(f"variance that the input explains alone [%]:\n{text_of(measure_of(measure))}")
        calm(panel, axis="x")
    return figure


def scatter_figure(table: pa.Table, names: Sequence[str], measure: str, labels: Mapping[str, str]) -> Figure:
    """Return every variant by a measure over some inputs, named by `labels`, with the means of classes of the input."""
    shown, values = measure_of(measure), values_of(table, measure)
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 2.7), layout="constrained")
        panels = np.atleast_1d(figure.subplots(1, len(names), sharey=True))
        for panel, name in zip(panels, names, strict=True):
            x, y = np.asarray(table[name], dtype=np.float64), shown.factor * values
            panel.plot(
                x,
                y,
                ".",
                ms=max(3.0, 8.0 - math.log2(x.size) / 2.0),
                color=COLOURS[0],
                alpha=0.5,
                mec="none",
                rasterized=True,
            )
            panel.plot(*_means(x, y), color=COLOURS[1], lw=1.5)
            _limit(panel.axhline, shown)
            panel.set_xlabel(shortened(labels.get(name, name)))
            panel.xaxis.set_major_locator(MaxNLocator(5))
            calm(panel)
        panels[0].set_ylabel(_wrapped(shown))
    return figure


def curve_figure(table: pa.Table, name: str, names: Sequence[str], labels: Mapping[str, str]) -> Figure:
    """Return measures over the one number that varies, named by `labels`."""
    x = np.asarray(table[name], dtype=np.float64)
    order = np.argsort(x)
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 3.0), layout="constrained")
        for panel, measure in zip(np.atleast_1d(figure.subplots(1, len(names))), names, strict=True):
            shown = measure_of(measure)
            panel.plot(x[order], shown.factor * values_of(table, measure)[order], "o-", ms=3, color=COLOURS[0])
            _limit(panel.axhline, shown)
            panel.set_xlabel(shortened(labels.get(name, name)))
            panel.set_ylabel(_wrapped(shown))
            panel.set_ylim(bottom=0.0)
            calm(panel)
    return figure


def choices_figure(table: pa.Table, name: str, names: Sequence[str]) -> Figure:
    """Return measures of each choice as bars, the largest first by the first measure."""
    names_of = [_name_of(choice) for choice in table[name].to_pylist()]
    order = np.argsort(np.nan_to_num(values_of(table, names[0]), nan=-1.0), kind="stable")
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, max(1.1 + 0.2 * len(names_of), _LEAST)), layout="constrained")
        panels = np.atleast_1d(figure.subplots(1, len(names), sharey=True))
        failed = np.asarray(table["status"])[order] != DONE
        for panel, measure in zip(panels, names, strict=True):
            shown = measure_of(measure)
            values = shown.factor * values_of(table, measure)[order]
            colours = [BASE if names_of[row] == "none" else COLOURS[0] for row in order]
            panel.barh(range(len(names_of)), np.nan_to_num(values), color=colours, height=0.7)
            for row in np.flatnonzero(failed):
                panel.annotate("failed", (0.0, row), xytext=(4, 0), textcoords="offset points", va="center", fontsize=7)
            _limit(panel.axvline, shown)
            panel.set_xlabel(_wrapped(shown))
            calm(panel, axis="x")
        panels[0].set_yticks(range(len(names_of)), [shortened(names_of[row]) for row in order])
        panels[0].set_ylabel(shortened(name))
    return figure


def _distribution(panel: Any, shown: Measure, table: pa.Table) -> None:
    values = values_of(table, shown.name)
    known = shown.factor * np.sort(finite(values))
    fractions = 100.0 * np.arange(1, known.size + 1) / known.size
    panel.step(known, fractions, where="post", color=COLOURS[0], lw=1.4)
    for q, value in zip(QUANTILES, quantiles(values, QUANTILES), strict=True):
        if math.isfinite(value):
            x = shown.factor * value
            panel.plot(x, 100.0 * q, "o", ms=3.5, color=COLOURS[0])
            panel.annotate(
                f"{100.0 * q:.0f} %: {x:.3g}", (x, 100.0 * q), xytext=(6, _BELOW[q]), textcoords="offset points",
                ha="left", va="center", fontsize=7, bbox={"fc": "white", "ec": "none", "alpha": 0.7, "pad": 0.4},
            )  # fmt: skip
    _limit(panel.axvline, shown)
    if shown.limit is not None:
        beyond = exceedance_of(table, shown.name, shown.limit)
        bounds = f"{percent(beyond.low)} to {percent(beyond.high)} at {percent(CONFIDENCE)} confidence"
        text = f"beyond the limit: {beyond.count} of {beyond.n} variants{not_counted(beyond)}\n{bounds}"
        panel.set_title(text, loc="left", color=RATED if beyond.count else "0.2", fontweight="normal")
    panel.set_xlabel(_wrapped(shown))
    panel.set_ylim(0.0, 104.0)
    left, right = panel.get_xlim()
    panel.set_xlim(left, right + 0.22 * (right - left))  # room for the percentiles' names
    calm(panel)


def _means(x: Array, y: Array) -> tuple[Array, Array]:
    """Return the mean at each value of x; where hardly any value repeats, of each of some classes of equal size."""
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    values, classes = np.unique(x, return_inverse=True)
    if 2 * values.size <= x.size:
        return values, np.bincount(classes, weights=y) / np.bincount(classes)
    order = np.argsort(x, kind="stable")
    parts = min(max(round(order.size ** (1.0 / 3.0)), 3), 12)
    rows = [part for part in np.array_split(order, parts) if part.size]
    return np.array([x[part].mean() for part in rows]), np.array([y[part].mean() for part in rows])


def _limit(draw: Callable[..., Any], shown: Measure) -> None:
    if shown.limit is not None:
        draw(shown.factor * shown.limit, color=RATED, ls="--", lw=1.2)


def _sign(one: Effect) -> str:
    doubtful = "" if one.certain else " (not surely above chance)"
    trend = "" if math.isnan(one.rank) else f", rank correlation {one.rank:+.2f}".replace("-", "\N{MINUS SIGN}")
    return f"{max(100.0 * one.index, 0.0):.0f} %{doubtful}{trend}"


def _name_of(choice: Any) -> str:
    """Return one of some choices; that of the mount that fails is "" where none does."""
    return f"{choice:g}" if isinstance(choice, float) else str(choice) or "none"


def shortened(name: str, most: int = _NAME) -> str:
    """Return a name of at most so many letters, without its middle."""
    name = plain(name)
    return name if len(name) <= most else f"{name[: most // 2 - 1]}…{name[-most // 2 :]}"


def _wrapped(shown: Measure) -> str:
    return f"{text_of(shown)} [{shown.unit}]"


def text_of(shown: Measure) -> str:
    """Return a measure's text on lines that fit an axis, of which body or mount on a line of its own."""
    text, *rest = shown.text.rsplit(", ", 1) if "/" in shown.name else [shown.text]
    return "\n".join(wrap(text, _LINE)) + "".join(f",\n{short(one)}" for one in rest)


def calm(panel: Any, *, axis: str = "both") -> None:
    """Give a panel a pale grid and no frame above and on the right."""
    panel.grid(color="0.92", axis=axis)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)
