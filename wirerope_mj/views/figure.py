"""Charts of results on matplotlib's axes, for notebooks: the curves, words and colours of the report."""

from collections.abc import Sequence
from math import lcm
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from wirerope_mj.content.blocks import OTHERS, Chart, Panel, stacked
from wirerope_mj.content.cyclic_tests import isolator_chart, loops_chart
from wirerope_mj.content.histories import TOTAL, run_histories
from wirerope_mj.content.response_curve import amplitude_chart
from wirerope_mj.content.selection import select
from wirerope_mj.content.spectrum_charts import power_densities_chart, shock_spectra_chart
from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.summary import level_summaries
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.ticks import log_ticks
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.views.colours import LIGHT, field_colours, field_key, hexadecimal

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
from wirerope_mj.views.plots.svg_chart import number_text

_WIDTH, _PANEL = 8.0, 2.4  # inches: of a figure, and the height of a panel of 140 units of a page
_DASHES = {"": "-", "dashed": "--", "dotted": ":"}
Spectrum: TypeAlias = ShockResponseSpectrum | PowerSpectralDensity
Drawable: TypeAlias = Panel | Chart | Response | Isolator | Loop | Sequence[Loop] | FrequencyResponse | Spectrum


def draw(result: Drawable, ax: "Axes | None" = None) -> "Figure":
    """Draw a result as the report draws it, with matplotlib.

    Args:
        result: a response (accelerations and deflections over time), loops of a cyclic test, an isolator (its steady loops
            and ratings), a frequency response, a shock response spectrum, a power spectral density; or a `Chart` or a `Panel`
            of `wirerope_mj.content`.
        ax: axes to draw on, for what has one panel; None for a new figure with all panels.

    Returns:
        The figure.

    Raises:
        ValueError: several panels do not fit the axes that were given, or nothing is known to draw of such a thing.
    """
    chart = chart_of(result)
    if ax is not None:
        if (count := sum(map(len, chart.rows))) != 1:
            raise ValueError(f"`ax` takes one panel, and this chart has {count}; leave `ax` out.")
        _draw(chart.rows[0][0], ax)
        figure = ax.get_figure(root=True)
        assert figure is not None  # whatever has axes
        return figure
    from matplotlib import pyplot as plt

    height = _PANEL * max(chart.height / 140.0, 1.0) * len(chart.rows)
    figure = plt.figure(figsize=(_WIDTH, height), layout="constrained")
    columns = lcm(*map(len, chart.rows))
    grid = figure.add_gridspec(len(chart.rows), columns)
    for number, row in enumerate(chart.rows):
        wide = columns // len(row)
        for place, panel in enumerate(row):
            _draw(panel, figure.add_subplot(grid[number, wide * place : wide * (place + 1)]))
    return figure


def chart_of(result: Drawable) -> Chart:
    """Build the chart that the report has of a result; ValueError if the report has no chart of it."""
    if isinstance(result, Chart):
        return result
    if isinstance(result, Panel):
        return Chart(rows=[[result]])
    if isinstance(result, Response):
        panels = run_histories(result, select(result)).items()
        return stacked([panel for (kind, *axis), panel in panels if kind in ("acceleration", "deflection") and axis != [TOTAL]])
    if isinstance(result, Isolator):
        return isolator_chart(result)
    if isinstance(result, FrequencyResponse):
        return amplitude_chart(result, level_summaries(result))
    if isinstance(result, ShockResponseSpectrum):
        return shock_spectra_chart({"": result})
    if isinstance(result, PowerSpectralDensity):
        return power_densities_chart({"density": result})
    loops = [result] if isinstance(result, Loop) else list(result) if isinstance(result, Sequence) else []
    if loops and all(isinstance(loop, Loop) for loop in loops):
        return loops_chart({"": loops})
    raise ValueError(f"nothing is known to draw of a {type(result).__name__}; see `help(wr.draw)` for what can be drawn.")


def _draw(panel: Panel, axes: "Axes") -> None:
    """Draw a panel on axes, with the same curves in front as on a page."""
    from matplotlib.colors import to_rgba
    from matplotlib.ticker import NullFormatter

    if panel.field is not None:
        cells = [[to_rgba(colour or "none") for colour in row] for row in field_colours(panel.field)]
        axes.pcolormesh(panel.field.x, panel.field.y, np.array(cells), zorder=0)
        for colour, name in field_key(panel.field):
            axes.fill_between([], [], color=colour, label=name)
    for name, low, high in panel.bands:
        axes.axvspan(low, high, color="0.5", alpha=0.18, label=name)
    for order, curve in enumerate(reversed(panel.curves)):
        colour = hexadecimal(LIGHT.others if curve.kind == OTHERS else LIGHT.of(curve.kind))
        style: dict[str, Any] = {"color": colour, "alpha": curve.opacity, "label": curve.name, "zorder": 2.0 + 0.01 * order}
        if curve.bars:
            spans = None if curve.ends is None else np.abs(curve.ends.T - curve.x)
            axes.barh(curve.y, curve.x, height=curve.bars, xerr=spans, **style)
        elif curve.marks:
            axes.plot(curve.x, curve.y, linestyle="", marker="o", markersize=3.0 * curve.weight, **style)
        else:
            axes.plot(curve.x, curve.y, linestyle=_DASHES[curve.dash], linewidth=1.3 * curve.weight, **style)
    for levels, draw in ((panel.limits, axes.axhline), (panel.xlimits, axes.axvline)):
        for name, level in levels:
            colour = hexadecimal(LIGHT.of(panel.kind_of_limit(name)))
            draw(level, color=colour, linestyle="--", linewidth=1.0, label=name)
    for x, y in panel.dots:
        axes.plot(x, y, "o", color="0.2", markersize=4)
    for x, y, note, on_left in panel.notes:
        axes.annotate(
            note, (x, y), xytext=(-4 if on_left else 4, 0), textcoords="offset points", ha="right" if on_left else "left",
            va="center", fontsize="small", parse_math=False,
        )  # fmt: skip
    scales = {f"{axis}scale": "log" for axis in panel.log}
    limits = {"xlim": panel.xlim, "ylim": panel.ylim}
    axes.set(**scales, **{name: ends for name, ends in limits.items() if ends is not None})
    axes.set(xlabel=panel.xlabel, ylabel=panel.ylabel, title=panel.title)
    for name, given, axis in (("x", panel.xticks, axes.xaxis), ("y", panel.yticks, axes.yaxis)):
        low, high = axis.get_view_interval()
        ticks = given or [(tick, number_text(tick)) for tick in (log_ticks(low, high).tolist() if name in panel.log else ())]
        if ticks:
            axis.set_ticks([position for position, _ in ticks], labels=[text for _, text in ticks])
            axis.set_minor_formatter(NullFormatter())
    axes.grid(alpha=0.3)
    handles, labels = axes.get_legend_handles_labels()
    named = {label: handle for handle, label in zip(handles[::-1], labels[::-1], strict=True) if label}
    written = axes.legend(named.values(), named.keys(), fontsize="small").get_texts() if named else []
    for text in (axes.title, axes.xaxis.label, axes.yaxis.label, *written):
        text.set_parse_math(False)  # a dollar sign in a name begins no formula
