"""Charts of a study: by what varies of it, and how it was sampled."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa

from wirerope_mj.content.numbers import MINUS
from wirerope_mj.content.panels import BASE, OTHERS, Chart, Curve, Field, Panel, short, with_room
from wirerope_mj.content.study_statements import capital, exceedance_text
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.studies.engines.compute import DONE
from wirerope_mj.studies.results.effects import AZIMUTH, ELEVATION, Effect, SobolIndices
from wirerope_mj.studies.results.measure import (
    Measure,
    drawn_measures,
    exceedance_of,
    finite,
    input_names,
    measure_of,
    quantiles,
    values_of,
)
from wirerope_mj.studies.results.study_summary import QUANTILES, StudySummary
from wirerope_mj.studies.vary.sampling import LISTED, OF_INDICES

# Inputs in one chart: those below explain next to nothing; inputs that are drawn with all their variants.
MOST_BARS, MOST_SCATTERS = 12, 3
_MOST_CHOICES = 60  # bars in one chart
_NAME = 34  # letters of an input's name beside its bar
_ROW = 19.0  # height of a bar with its gap
_BAR = 0.7  # of it, that a bar takes
_TEXT = 2.1  # length of an axis in its longest bar, so that there is room for the text beside it
_CLASSES = 4  # colours of directions that are no grid


def study_charts(summary: StudySummary) -> Iterator[Chart]:
    """Yield the charts of a study, whose ids are the names of their files."""
    result, by = summary.result, summary.by
    table = result.independent
    inputs = [name for name in input_names(table) if len(set(table[name].to_pylist())) > 1]
    names = list(dict.fromkeys([by, *drawn_measures(table)]))[:2]
    several = [name for name in names if finite(values_of(table, name)).size > 1]
    if result.is_sampled and several:
        yield distribution_chart(summary, table, several)
    directions = {AZIMUTH, ELEVATION} == set(inputs)
    if directions:
        yield directions_chart(table, by)
    elif len(inputs) == 1:
        yield from _of_one_input(summary, table, inputs[0], names)
    if result.study.sampling == OF_INDICES:
        if summary.indices:
            yield indices_chart(summary.indices[:2])
        yield from _scatter(summary, table)
    elif summary.effects and len(inputs) > 1 and not directions:
        yield sensitivity_chart(summary)
        yield from _scatter(summary, table)


def distribution_chart(summary: StudySummary, table: pa.Table, names: Sequence[str]) -> Chart:
    """Draw for each measure the fraction of variants that stay below a value, with percentiles and limit."""
    panels = [_distribution(measure_of(name, summary.limits), table) for name in names]
    caption = (
        "Fraction of the variants that stay below a value, with percentiles; dashed: the limit. A percentile is named if "
        "at least five variants lie beyond it."
    )
    panels[1:] = [replace(panel, ylabel="") for panel in panels[1:]]
    return Chart(id="distribution", rows=[panels], height=190.0, caption=caption, alt=caption)


def _distribution(shown: Measure, table: pa.Table) -> Panel:
    values = values_of(table, shown.name)
    known = shown.factor * np.sort(finite(values))
    fractions = 100.0 * np.arange(known.size + 1) / known.size
    places = [
        (shown.factor * value, 100.0 * q)
        for q, value in zip(QUANTILES, quantiles(values, QUANTILES), strict=True)
        if math.isfinite(value)
    ]
    room = float(np.ptp(known)) or abs(float(known[0])) or 1.0
    ends = [known[0], known[-1]] + ([] if shown.limit is None else [shown.factor * shown.limit])
    title = ""
    if shown.limit is not None:
        beyond = exceedance_of(table, shown.name, shown.limit)
        title = f"beyond the limit: {exceedance_text(beyond, beyond.ratio)}"
    return Panel(
        curves=[Curve(x=np.repeat(known, 2), y=np.repeat(fractions, 2)[1:-1], name="variants", kind=0)],
        ylabel="variants below [%]",
        xlabel=shown.label,
        title=title,
        xlimits=_limits(shown),
        dots=places,
        notes=[(x, y - 3.0, f"{y:.0f} %: {x:.3g}", False) for x, y in places],
        xlim=(min(ends) - 0.03 * room, max(ends) + 0.3 * room),  # for the percentiles' names
        ylim=(0.0, 104.0),
        unit="%",
        xunit=shown.unit,
    )


def sensitivity_chart(summary: StudySummary) -> Chart:
    """Draw what the inputs explain of a measure's variance, as bars; pale those that are not significant."""
    effects, shown = summary.effects[:MOST_BARS], measure_of(summary.by)
    sizes = np.array([max(100.0 * one.index, 0.0) for one in effects])
    ways: list[int | str] = [BASE if math.isnan(one.rank) else 0 if one.rank >= 0.0 else 1 for one in effects]
    kinds = [way if one.certain else OTHERS for one, way in zip(effects, ways, strict=True)]
    names: dict[int | str, str] = {0: "rises with the input", 1: "falls", BASE: "has no order", OTHERS: "not significant"}
    end = _TEXT * max(float(sizes.max()), 2.5)
    panel = _bar_panel(
        [summary.labels.get(one.name, one.name) for one in effects],
        [
            Curve(x=sizes[rows], y=-rows.astype(np.float64), name=name, kind=kind, bars=_BAR)
            for kind, name in names.items()
            if (rows := np.flatnonzero([one == kind for one in kinds])).size
        ],
        xlabel="variance that the input explains alone [%]",
        notes=[(size, -row, _effect_text(one), False) for row, (one, size) in enumerate(zip(effects, sizes, strict=True))],
        xlim=(0.0, end),
        xticks=[(tick, f"{tick:g}") for tick in linear_ticks(0.0, min(end, 100.0)).tolist()],
    )
    caption = f"What each input alone explains of the variance of: {shown.text}."
    return _bar_chart("sensitivity", [panel], caption)


def _effect_text(one: Effect) -> str:
    doubtful = "" if one.certain else " (not significant)"
    trend = "" if math.isnan(one.rank) else f", rank correlation {one.rank:+.2f}".replace("-", MINUS)
    return f"{max(100.0 * one.index, 0.0):.0f} %{doubtful}{trend}"


def _scatter(summary: StudySummary, table: pa.Table) -> Iterator[Chart]:
    numbers = [name for name in summary.ranked_inputs if not pa.types.is_string(table.schema.field(name).type)]
    names = [name for name in numbers if len(np.unique(np.asarray(table[name]))) > 2][:MOST_SCATTERS]
    if names:
        yield scatter_chart(summary, table, names)


def scatter_chart(summary: StudySummary, table: pa.Table, names: Sequence[str]) -> Chart:
    """Draw every variant by a measure over some inputs, with the means of classes of the input."""
    shown = measure_of(summary.by)
    panels = []
    for name in names:
        x, y = np.asarray(table[name], dtype=np.float64), shown.factor * values_of(table, shown.name)
        known = np.isfinite(x) & np.isfinite(y)
        x, y = x[known], y[known]
        at, means = _means(x, y)
        curves = [Curve(x=at, y=means, name="mean", kind=1), Curve(x=x, y=y, name="variants", kind=0, marks=True)]
        xlim = with_room(x, 0.04) if x.size else None
        panels.append(_over_input(curves, shown, summary.labels.get(name, name), xlim=xlim))
    panels[1:] = [replace(panel, ylabel="") for panel in panels[1:]]
    listed = summary.result.study.sampling in LISTED
    mean = "the mean at each value of the input" if listed else "the mean of variants with like values of the input"
    caption = f"{capital(shown.text)} of every variant over the strongest inputs; line: {mean}; dashed: the limit."
    return Chart(id="scatter", rows=[panels], height=170.0, caption=caption, alt=caption)


def _means(x: Array, y: Array) -> tuple[Array, Array]:
    """Return the mean at each value of x; where hardly any value repeats, of each of some classes of equal size."""
    values, classes = np.unique(x, return_inverse=True)
    if 2 * values.size <= x.size:
        return values, np.bincount(classes, weights=y) / np.bincount(classes)
    order = np.argsort(x, kind="stable")
    parts = min(max(round(order.size ** (1.0 / 3.0)), 3), 12)
    rows = [part for part in np.array_split(order, parts) if part.size]
    return np.array([x[part].mean() for part in rows]), np.array([y[part].mean() for part in rows])


def _of_one_input(summary: StudySummary, table: pa.Table, name: str, names: Sequence[str]) -> Iterator[Chart]:
    kind = table.schema.field(name).type
    if not pa.types.is_floating(kind) and table.num_rows <= _MOST_CHOICES:
        yield choices_chart(table, name, names)
    elif not pa.types.is_string(kind):
        yield curve_chart(summary, table, name, names)


def curve_chart(summary: StudySummary, table: pa.Table, name: str, names: Sequence[str]) -> Chart:
    """Draw measures over the one number that varies."""
    x = np.asarray(table[name], dtype=np.float64)
    order, panels = np.argsort(x), []
    for shown in map(measure_of, names):
        y = shown.factor * values_of(table, shown.name)[order]
        known = np.isfinite(y)
        line = Curve(x=x[order][known], y=y[known], name="", kind=0)
        marks = Curve(x=line.x, y=line.y, name="variants", kind=0, marks=True)
        top = max(float(line.y.max(initial=0.0)), 0.0 if shown.limit is None else shown.factor * shown.limit)
        panels.append(_over_input([marks, line], shown, summary.labels.get(name, name), ylim=(0.0, 1.05 * top or 1.0)))
    caption = (
        f"{capital(' and '.join(measure_of(one).text for one in names))} over {name.replace('/', ' ')}; dashed: the limit."
    )
    return Chart(id="curve", rows=[panels], height=190.0, caption=caption, alt=caption)


def choices_chart(table: pa.Table, name: str, names: Sequence[str]) -> Chart:
    """Draw measures of each choice as bars, the largest first by the first measure."""
    order = np.argsort(-np.nan_to_num(values_of(table, names[0]), nan=-1.0), kind="stable")
    chosen = (table[name][int(row)].as_py() for row in order)  # "" where no mount fails
    choices = [f"{one:g}" if isinstance(one, float) else str(one) or "none" for one in chosen]
    failed = np.flatnonzero(np.asarray(table["status"])[order] != DONE)
    panels: list[Panel] = []
    for shown in map(measure_of, names):
        values = np.nan_to_num(shown.factor * values_of(table, shown.name)[order])
        curves = [
            Curve(x=values[rows], y=-rows.astype(np.float64), name="", kind=kind, bars=_BAR)
            for kind, wanted in ((0, False), (BASE, True))
            if (rows := np.flatnonzero([(choice == "none") == wanted for choice in choices])).size
        ]
        panels.append(
            _bar_panel(
                choices if not panels else [""] * len(choices), curves, xlabel=shown.column.title(), xlimits=_limits(shown),
                notes=[(0.0, -float(row), "failed", False) for row in failed],
                xlim=(0.0, 1.05 * max(float(values.max()), *(level for _, level in _limits(shown)), 1e-9)),
            )
        )  # fmt: skip
    text = " and ".join(measure_of(one).text for one in names)
    return _bar_chart(
        "choices", panels, f"{capital(text)} for each choice of {name.replace('/', ' ')}, sorted; dashed: the limit."
    )


def indices_chart(indices: Sequence[SobolIndices]) -> Chart:
    """Draw for one or two measures two bars per factor, first-order and total index, with their intervals."""
    order = [one.name for one in indices[0].factors[:MOST_BARS]]
    panels: list[Panel] = []
    for one in indices:
        by_name = {factor.name: factor for factor in one.factors}
        curves = []
        for label, kind, colour, side in (("alone (first-order index)", "first", 0, 0.2), ("total index", "total", 1, -0.2)):
            curves.append(
                Curve(
                    x=np.array([max(100.0 * getattr(by_name[name], kind), 0.0) for name in order]),
                    y=side - np.arange(len(order), dtype=np.float64), name=label, kind=colour, bars=0.36,
                    ends=np.array([[100.0 * end for end in getattr(by_name[name], f"{kind}_interval")] for name in order]),
                )
            )  # fmt: skip
        ends = np.concatenate([curve.ends for curve in curves if curve.ends is not None])
        xlim = (min(0.0, 1.1 * float(ends.min())), max(10.0, 1.05 * float(ends.max())))
        names = order if not panels else [""] * len(order)
        text = f"variance of {measure_of(one.measure).heading} [%]"
        panels.append(_bar_panel(names, curves, xlabel=text, xlim=xlim))
    few = f" {indices[0].rows} base rows are too few." if any(one.too_few for one in indices) else ""
    caption = (
        "What each factor explains of the variance alone, and with what it does together with others: Sobol's first-order "
        f"and total indices, with intervals of 95 % confidence.{few}"
    )
    return _bar_chart("indices", panels, caption, row=2.0 * _ROW)


def directions_chart(table: pa.Table, measure: str) -> Chart:
    """Draw a measure over the directions of the motion as a map of equal areas, with the largest marked."""
    azimuth, elevation = (np.asarray(table[name], dtype=np.float64) for name in (AZIMUTH, ELEVATION))
    shown = measure_of(measure)
    values = shown.factor * values_of(table, measure)
    height = np.sin(np.radians(elevation))  # so that equal areas of the chart are equal areas of the sphere
    grid = _grid(azimuth, elevation, values)
    curves: list[Curve] = []
    if grid is None:
        curves = _classes_of(azimuth, height, values)
    title, dots = "", []
    if np.isfinite(values).any():
        top = int(np.nanargmax(values))
        where = "" if abs(elevation[top]) == 90.0 else f"azimuth {azimuth[top]:.4g}°, "
        title = f"largest: {values[top]:.3g} {shown.unit} at {where}elevation {elevation[top]:.4g}°"
        dots = [(float(azimuth[top]), float(height[top]))]
    ends = min(-180.0, float(azimuth.min())), max(180.0, float(azimuth.max()))
    angles = (-90, -60, -45, -30, -15, 0, 15, 30, 45, 60, 90)
    panel = Panel(
        curves=curves, field=None if grid is None else _field(*grid, shown), ylabel="elevation [°], 90 = up",
        xlabel="azimuth [°], 0 = along x, 90 = along y", title=title.replace("-", MINUS), dots=dots,
        xlim=ends if grid is None else None, ylim=(-1.0, 1.0),
        yticks=[(math.sin(math.radians(angle)), f"{angle}".replace("-", MINUS)) for angle in angles],
        xticks=[
            (float(one), f"{one}".replace("-", MINUS)) for one in range(-180, 361, 45) if ends[0] <= one <= ends[1]
        ],
    )  # fmt: skip
    caption = (
        f"{capital(shown.text)} over the direction in which the base is driven first; equal areas are equal parts of the "
        "sphere; the dot is the largest, red is beyond the limit."
    )
    return Chart(id="directions", rows=[[panel]], height=250.0, caption=caption, alt=caption)


def _classes_of(azimuth: Array, height: Array, values: Array) -> list[Curve]:
    """Return directions that are no grid as dots, in colours for classes of the measure."""
    known = np.isfinite(values)
    edges = np.linspace(values[known].min(), values[known].max(), _CLASSES + 1) if known.any() else np.zeros(_CLASSES + 1)
    place = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, _CLASSES - 1)
    return [
        Curve(
            x=azimuth[rows], y=height[rows], name=f"{edges[number]:.3g} to {edges[number + 1]:.3g}", kind=number, marks=True,
        )
        for number in range(_CLASSES)
        if (rows := known & (place == number)).any()
    ]  # fmt: skip


def _grid(azimuth: Array, elevation: Array, values: Array) -> tuple[Array, Array, Array] | None:
    """Return azimuths, elevations and values (n_elevation, n_azimuth) of a grid around the sphere; None if there is none."""
    # A pole's one value stands under every azimuth, and what is at -180 is at 180, too.
    along, up = np.unique(azimuth), np.unique(elevation)
    if min(along.size, up.size) < 2:
        return None
    grid = np.full((up.size, along.size), np.nan)
    there = np.zeros(grid.shape, dtype=bool)
    cells = np.searchsorted(up, elevation), np.searchsorted(along, azimuth)
    grid[cells], there[cells] = values, True
    for row in np.flatnonzero(np.abs(up) == 90.0):
        if there[row].any():
            grid[row, ~there[row]], there[row] = grid[row, there[row]][0], True
    if not there.all():
        return None
    if along[0] == -180.0 and along[-1] < 180.0:
        along, grid = np.append(along, 180.0), np.column_stack([grid, grid[:, 0]])
    return along, up, grid


def _field(along: Array, up: Array, grid: Array, shown: Measure) -> Field:
    """Return a grid as cells around its directions."""
    between = np.sin(np.radians((up[:-1] + up[1:]) / 2.0))
    ends = np.sin(np.radians(up[[0, -1]]))
    return Field(
        x=np.concatenate(([along[0]], (along[:-1] + along[1:]) / 2.0, [along[-1]])),
        y=np.concatenate(([ends[0]], between, [ends[1]])), values=grid, name=shown.column.title(),
        limit=None if shown.limit is None else shown.factor * shown.limit,
    )  # fmt: skip


def _over_input(curves: Sequence[Curve], shown: Measure, xlabel: str, **how: Any) -> Panel:
    """Return a panel of a measure over an input."""
    limits = _limits(shown)
    return Panel(
        curves=curves, ylabel=shown.column.title(), xlabel=short(plain(xlabel), _NAME), limits=limits, unit=shown.unit,
        xunit="", **how,
    )  # fmt: skip


def _bar_panel(names: Sequence[str], curves: Sequence[Curve], **how: Any) -> Panel:
    """Return a panel of bars, a row for each name, the first on top."""
    ticks = [(-float(row), short(plain(name), _NAME)) for row, name in enumerate(names)]
    return Panel(curves=curves, ylabel="", yticks=ticks, ylim=(0.5 - len(names), 0.5), **how)


def _bar_chart(name: str, panels: Sequence[Panel], caption: str, row: float = _ROW) -> Chart:
    height = row * max(len(panels[0].yticks), 3)
    return Chart(id=name, rows=[panels], height=height, caption=caption, alt=caption)


def _limits(shown: Measure) -> list[tuple[str, float]]:
    return [] if shown.limit is None else [("limit", shown.factor * shown.limit)]
