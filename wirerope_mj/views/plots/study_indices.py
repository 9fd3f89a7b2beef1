"""Sobol's indices of a study, as bars with their intervals."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.studies.results.indices import SobolIndices
from wirerope_mj.studies.results.measure import measure_of
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import BASE, COLOURS, WIDTH, report_style
from wirerope_mj.views.plots.study import text_of

MOST_FACTORS = 12
"""Factors in one picture, the strongest by total index."""

_NAME = 26  # letters of a factor's name beside its bars
_HEIGHT = 0.36  # of a bar; two of them and a gap make one


def indices_figure(indices: Sequence[SobolIndices]) -> Figure:
    """Return for each measure two bars per factor, first-order and total index, with their intervals.

    Args:
        indices: of one or two measures of a study; the first one gives the order of the factors.
    """
    order = [one.name for one in indices[0].factors[:MOST_FACTORS]][::-1]
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 1.35 + 0.36 * len(order)), layout="constrained")
        panels = np.atleast_1d(figure.subplots(1, len(indices), sharey=True))
        for panel, one in zip(panels, indices, strict=True):
            _bars(panel, one, order)
        panels[0].set_yticks(range(len(order)), [_name(name) for name in order])
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=3, frameon=False)
    return figure


def _bars(panel: Any, indices: SobolIndices, order: Sequence[str]) -> None:
    by_name = {one.name: one for one in indices.factors}
    kinds = (
        ("alone (first-order index)", "first", COLOURS[0], 0.5),
        ("with what it does together with others (total index)", "total", BASE, -0.5),
    )
    for label, kind, colour, side in kinds:
        heights = [row + side * _HEIGHT for row in range(len(order))]
        values = np.array([100.0 * getattr(by_name[name], kind) for name in order])
        ends = np.array([[100.0 * end for end in getattr(by_name[name], f"{kind}_interval")] for name in order])
        panel.barh(heights, np.maximum(values, 0.0), color=colour, height=_HEIGHT, label=label)
        # The percentiles of a bootstrap need not enclose the estimate.
        reach = np.abs(np.maximum([values - ends[:, 0], ends[:, 1] - values], 0.0))
        panel.errorbar(values, heights, xerr=reach, fmt="none", ecolor="0.25", elinewidth=0.9, capsize=2.0)
    panel.axvline(0.0, color="0.6", lw=0.8)
    panel.set_xlim(right=max(panel.get_xlim()[1], 10.0))
    panel.xaxis.set_major_locator(MaxNLocator(5))
    panel.set_xlabel(f"fraction of the variance [%]:\n{text_of(measure_of(indices.measure))}")
    panel.grid(color="0.92", axis="x")
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)


def _name(name: str) -> str:
    name = plain(name)
    return name if len(name) <= _NAME else f"{name[: _NAME // 2 - 1]}…{name[-_NAME // 2 :]}"
