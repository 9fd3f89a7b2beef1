"""Charts of a study, chosen by its varied inputs and its sampling."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from wirerope_mj.content.blocks import BASE, OTHERS, Chart, Curve, Field, Panel, short, with_room
from wirerope_mj.content.numbers import MINUS
from wirerope_mj.content.study_statements import capital, exceedance_text
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.studies.results.effects import AZIMUTH, ELEVATION, SobolIndices
from wirerope_mj.studies.results.measure import (
    Measure,
    drawn_measures,
    exceedance_of,
    finite,
    input_names,
    is_done,
    measure_of,
    quantiles,
    values_of,
)
from wirerope_mj.studies.results.study_summary import QUANTILES, StudySummary
from wirerope_mj.studies.vary.sampling import LISTED, OF_INDICES

# inputs in one chart of bars, in one of all variants
MOST_BARS, MOST_SCATTERS = 12, 3
_MOST_CHOICES = 60  # bars in one chart
_NAME_LETTERS = 34  # letters of an input's name beside its bar
_ROW = 19.0  # height of a bar with its gap
_BAR = 0.7  # fraction of this height that the bar takes
_TEXT = 2.1  # length of an axis over its longest bar, with room for the text
MOST_STEPS, MOST_DOTS = 4096, 16384  # variants that are drawn one by one: steps of a distribution, dots
_CLASSES = 4  # colours of directions that form no grid


def study_charts(summary: StudySummary) -> Iterator[Chart]:
    """Yield the charts of a study; their ids name their files."""
    result, by = summary.result, summary.by
    table = result.independent
    inputs = [name for name in input_names(table) if pc.any(pc.not_equal(column := table[name], column[0])).as_py()]
    names = list(dict.fromkeys([by, *drawn_measures(table)]))[:2]
    several = [name for name in names if finite(values_of(table, name)).size > 1]
    if result.is_sampled and several:
        yield distribution_chart(summary, table, several)
    directions = {AZIMUTH, ELEVATION} == set(inputs)
    if directions:
        yield directions_chart(table, by)
    elif len(inputs) == 1:
        kind = table.schema.field(inputs[0]).type
        if not pa.types.is_floating(kind) and table.num_rows <= _MOST_CHOICES:
            yield choices_chart(table, inputs[0], names)
        elif not pa.types.is_string(kind):
            yield curve_chart(summary, table, inputs[0], names)
    sensitive = summary.effects and len(inputs) > 1 and not directions
    if result.study.sampling == OF_INDICES:
        if summary.indices:
            yield indices_chart(summary.indices[:2])
    elif sensitive:
        yield sensitivity_chart(summary)
    if result.study.sampling == OF_INDICES or sensitive:
        numbers = [name for name in summary.ranked_inputs if not pa.types.is_string(table.schema.field(name).type)]
        drawn = list(islice((name for name in numbers if np.unique(np.asarray(table[name])).size > 2), MOST_SCATTERS))
        if drawn:
            yield scatter_chart(summary, table, drawn)


def distribution_chart(summary: StudySummary, table: pa.Table, names: Sequence[str]) -> Chart:
    """Draw the fraction of variants below a value of each measure, with percentiles and limit."""
    panels: list[Panel] = []
    for shown in (measure_of(name, summary.limits) for name in names):
        values = values_of(table, shown.name)
        known = shown.factor * np.sort(finite(values))
        steps = np.unique(np.linspace(0, known.size - 1, min(known.size, MOST_STEPS)).round().astype(np.int64))
        fractions = 100.0 * np.append(0, steps + 1) / known.size
        percentiles = zip(QUANTILES, quantiles(values, QUANTILES), strict=True)
        dots = [(shown.factor * value, 100.0 * q) for q, value in percentiles if math.isfinite(value)]
        room = float(np.ptp(known)) or abs(float(known[0])) or 1.0
        ends, title = [known[0], known[-1]], ""
        if shown.limit is not None:
            ends.append(shown.factor * shown.limit)
            beyond = exceedance_of(table, shown.name, shown.limit)
            title = f"beyond the limit: {exceedance_text(beyond, beyond.ratio)}"
        panels.append(Panel(
            [Curve(np.repeat(known[steps], 2), np.repeat(fractions, 2)[1:-1], name="variants", kind=0)],
            "" if panels else "variants below [%]", xlabel=shown.label, title=title, xlimits=_limits(shown),
            exceeded=_exceeded(shown, known), dots=dots,
            notes=[(x, y - 3.0, f"{y:.0f} %: {x:.3g}", False) for x, y in dots],
            xlim=(min(ends) - 0.03 * room, max(ends) + 0.3 * room),  # for the percentiles' names
            ylim=(0.0, 104.0), unit="%", xunit=shown.unit,
        ))  # fmt: skip
    caption = (
        "Fraction of the variants that stay below a value, with percentiles; dashed: the limit. A percentile is named if "
        "at least five variants lie beyond it."
    )
    return Chart(id="distribution", rows=[panels], height=190.0, caption=caption, alt=caption)


def sensitivity_chart(summary: StudySummary) -> Chart:
    """Draw the fraction of a measure's variance that each input explains; those that are not significant in grey."""
    effects = summary.effects[:MOST_BARS]
    sizes = np.array([max(100.0 * effect.index, 0.0) for effect in effects])
    kinds: list[int | str] = []
    notes = []
    for row, (effect, size) in enumerate(zip(effects, sizes, strict=True)):
        trend = "" if math.isnan(effect.rank) else f", rank correlation {effect.rank:+.2f}".replace("-", MINUS)
        notes.append((size, -row, f"{size:.0f} %{'' if effect.certain else ' (not significant)'}{trend}", False))
        way = BASE if math.isnan(effect.rank) else int(effect.rank < 0.0)
        kinds.append(way if effect.certain else OTHERS)
    names: dict[int | str, str] = {0: "rises with the input", 1: "falls", BASE: "has no order", OTHERS: "not significant"}
    end = _TEXT * max(float(sizes.max()), 2.5)
    panel = _bar_panel(
        [summary.labels.get(effect.name, effect.name) for effect in effects],
        [
            Curve(sizes[rows], -rows.astype(np.float64), name=name, kind=kind, bars=_BAR)
            for kind, name in names.items()
            if (rows := np.flatnonzero([of_effect == kind for of_effect in kinds])).size
        ],
        xlabel="variance that the input explains alone [%]",
        notes=notes,
        xlim=(0.0, end),
        xticks=[(tick, f"{tick:g}") for tick in linear_ticks(0.0, min(end, 100.0)).tolist()],
    )
    caption = f"What each input alone explains of the variance of: {measure_of(summary.by).text}."
    return _bar_chart("sensitivity", [panel], caption)


def scatter_chart(summary: StudySummary, table: pa.Table, names: Sequence[str]) -> Chart:
    """Draw a measure of every variant over each of some inputs, with means."""
    shown = measure_of(summary.by)
    panels: list[Panel] = []
    for name in names:
        x, y = np.asarray(table[name], dtype=np.float64), shown.factor * values_of(table, shown.name)
        known = np.isfinite(x) & np.isfinite(y)
        x, y = x[known], y[known]
        at, classes = np.unique(x, return_inverse=True)
        if 2 * at.size <= x.size:
            means = np.bincount(classes, weights=y) / np.bincount(classes)
        else:  # hardly any value repeats: classes of equal size
            order = np.argsort(x, kind="stable")
            rows = [part for part in np.array_split(order, min(max(round(x.size ** (1.0 / 3.0)), 3), 12)) if part.size]
            at, means = np.array([x[part].mean() for part in rows]), np.array([y[part].mean() for part in rows])
        xlim = with_room(x, 0.04) if x.size else None
        if x.size > MOST_DOTS:
            some = np.sort(np.random.default_rng(1).choice(x.size, MOST_DOTS, replace=False))
            x, y = x[some], y[some]
        curves = [Curve(at, means, name="mean", kind=1), Curve(x, y, name="variants", kind=0, marks=True)]
        panel = _input_panel(curves, shown, summary.labels.get(name, name), xlim=xlim)
        panels.append(replace(panel, ylabel="") if panels else panel)
    listed = summary.result.study.sampling in LISTED
    mean = "the mean at each value of the input" if listed else "the mean of variants with like values of the input"
    which = "every variant" if table.num_rows <= MOST_DOTS else f"{MOST_DOTS} variants, chosen at random,"
    caption = f"{capital(shown.text)} of {which} over the strongest inputs; line: {mean}; dashed: the limit."
    return Chart(id="scatter", rows=[panels], height=170.0, caption=caption, alt=caption)


def curve_chart(summary: StudySummary, table: pa.Table, name: str, names: Sequence[str]) -> Chart:
    """Draw measures (results) of the variants over the only varied input, a number."""
    x = np.asarray(table[name], dtype=np.float64)
    order, panels = np.argsort(x), []
    for shown in map(measure_of, names):
        y = shown.factor * values_of(table, shown.name)[order]
        known = np.isfinite(y)
        line = Curve(x[order][known], y[known], name="", kind=0)
        marks = Curve(line.x, line.y, name="variants", kind=0, marks=True)
        top = max(float(line.y.max(initial=0.0)), 0.0 if shown.limit is None else shown.factor * shown.limit)
        panels.append(_input_panel([marks, line], shown, summary.labels.get(name, name), ylim=(0.0, 1.05 * top or 1.0)))
    text = capital(" and ".join(measure_of(measure).text for measure in names))
    caption = f"{text} over {name.replace('/', ' ')}; dashed: the limit."
    return Chart(id="curve", rows=[panels], height=190.0, caption=caption, alt=caption)


def choices_chart(table: pa.Table, name: str, names: Sequence[str]) -> Chart:
    """Draw measures (results) as bars for each choice of the only varied input, the largest first."""
    order = np.argsort(-np.nan_to_num(values_of(table, names[0]), nan=-1.0), kind="stable")
    chosen = (table[name][int(row)].as_py() for row in order)  # "" where no mount fails
    choices = [f"{value:g}" if isinstance(value, float) else str(value) or "none" for value in chosen]
    failed = np.flatnonzero(~is_done(table)[order])
    panels: list[Panel] = []
    for shown in map(measure_of, names):
        values = np.nan_to_num(shown.factor * values_of(table, shown.name)[order])
        curves = [
            Curve(values[rows], -rows.astype(np.float64), name="", kind=kind, bars=_BAR)
            for kind, nominal in ((0, False), (BASE, True))
            if (rows := np.flatnonzero([(choice == "none") == nominal for choice in choices])).size
        ]
        panels.append(
            _bar_panel(
                choices if not panels else [""] * len(choices), curves, xlabel=shown.column.title(), xlimits=_limits(shown),
                exceeded=_exceeded(shown, values),
                notes=[(0.0, -float(row), "failed", False) for row in failed],
                xlim=(0.0, 1.05 * max(float(values.max()), *(level for _, level in _limits(shown)), 1e-9)),
            )
        )  # fmt: skip
    text = " and ".join(measure_of(measure).text for measure in names)
    return _bar_chart(
        "choices", panels, f"{capital(text)} for each choice of {name.replace('/', ' ')}, sorted; dashed: the limit."
    )


def indices_chart(indices: Sequence[SobolIndices]) -> Chart:
    """Draw first-order and total index of each factor, with intervals."""
    order = [factor.name for factor in indices[0].factors[:MOST_BARS]]
    panels: list[Panel] = []
    for of_measure in indices:
        by_name = {factor.name: factor for factor in of_measure.factors}
        curves, intervals = [], []
        for label, kind, colour, side in (("alone (first-order index)", "first", 0, 0.2), ("total index", "total", 1, -0.2)):
            sizes = np.array([max(100.0 * getattr(by_name[name], kind), 0.0) for name in order])
            ends = np.array([[100.0 * end for end in getattr(by_name[name], f"{kind}_interval")] for name in order])
            rows = side - np.arange(len(order), dtype=np.float64)
            curves.append(Curve(sizes, rows, name=label, kind=colour, bars=0.36, ends=ends))
            intervals.append(ends)
        xlim = (min(0.0, 1.1 * float(np.min(intervals))), max(10.0, 1.05 * float(np.max(intervals))))
        names = order if not panels else [""] * len(order)
        text = f"variance of {measure_of(of_measure.measure).heading} [%]"
        panels.append(_bar_panel(names, curves, xlabel=text, xlim=xlim))
    few = f" {indices[0].rows} base rows are too few." if any(of_measure.too_few for of_measure in indices) else ""
    caption = (
        "What each factor explains of the variance alone, and with what it does together with others: Sobol's first-order "
        f"and total indices, with intervals of 95 % confidence.{few}"
    )
    return _bar_chart("indices", panels, caption, row=2.0 * _ROW)


def directions_chart(table: pa.Table, measure: str) -> Chart:
    """Draw a measure over the directions of the motion as a map of equal areas."""
    azimuth, elevation = (np.asarray(table[name], dtype=np.float64) for name in (AZIMUTH, ELEVATION))
    shown = measure_of(measure)
    values = shown.factor * values_of(table, measure)
    height = np.sin(np.radians(elevation))  # so that equal areas of the chart are equal areas of the sphere
    grid = _grid(azimuth, elevation, values)
    curves = [] if grid is not None else _classes_of(azimuth, height, values)
    field = None
    if grid is not None:  # cells around the directions
        along, up, cells = grid
        limit = None if shown.limit is None else shown.factor * shown.limit
        across = np.concatenate(([along[0]], (along[:-1] + along[1:]) / 2.0, [along[-1]]))
        heights = np.sin(np.radians(np.concatenate(([up[0]], (up[:-1] + up[1:]) / 2.0, [up[-1]]))))
        field = Field(x=across, y=heights, values=cells, name=shown.column.title(), limit=limit)
    title, dots = "", []
    if np.isfinite(values).any():
        top = int(np.nanargmax(values))
        where = "" if abs(elevation[top]) == 90.0 else f"azimuth {azimuth[top]:.4g}°, "
        title = f"largest: {values[top]:.3g} {shown.unit} at {where}elevation {elevation[top]:.4g}°"
        dots = [(float(azimuth[top]), float(height[top]))]
    ends = min(-180.0, float(azimuth.min())), max(180.0, float(azimuth.max()))
    angles = (-90, -60, -45, -30, -15, 0, 15, 30, 45, 60, 90)
    panel = Panel(
        curves, field=field, ylabel="elevation [°], 90 = up",
        xlabel="azimuth [°], 0 = along x, 90 = along y", title=title.replace("-", MINUS), dots=dots,
        xlim=ends if grid is None else None, ylim=(-1.0, 1.0),
        yticks=[(math.sin(math.radians(angle)), f"{angle}".replace("-", MINUS)) for angle in angles],
        xticks=[
            (float(angle), f"{angle}".replace("-", MINUS))
            for angle in range(-180, 361, 45) if ends[0] <= angle <= ends[1]
        ],
    )  # fmt: skip
    caption = (
        f"{capital(shown.text)} over the direction in which the base is driven first; equal areas are equal parts of the "
        "sphere; the dot is the largest, red is beyond the limit."
    )
    return Chart(id="directions", rows=[[panel]], height=250.0, caption=caption, alt=caption)


def _classes_of(azimuth: Array, height: Array, values: Array) -> list[Curve]:
    """Draw directions that form no grid as dots, coloured by the class (quarter of the range) in which the value lies."""
    known = np.isfinite(values)
    edges = np.linspace(values[known].min(), values[known].max(), _CLASSES + 1) if known.any() else np.zeros(_CLASSES + 1)
    place = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, _CLASSES - 1)
    return [
        Curve(
            azimuth[rows], height[rows], name=f"{edges[number]:.3g} to {edges[number + 1]:.3g}", kind=number, marks=True,
        )
        for number in range(_CLASSES)
        if (rows := known & (place == number)).any()
    ]  # fmt: skip


def _grid(azimuth: Array, elevation: Array, values: Array) -> tuple[Array, Array, Array] | None:
    """Find azimuths, elevations [deg] and values on their grid (n_elevation, n_azimuth); None if directions form no grid."""
    # A pole has one value for every azimuth; -180 is 180, too.
    along, up = np.unique(azimuth), np.unique(elevation)
    if min(along.size, up.size) < 2:
        return None
    grid = np.full((up.size, along.size), np.nan)
    known = np.zeros(grid.shape, dtype=bool)
    cells = np.searchsorted(up, elevation), np.searchsorted(along, azimuth)
    grid[cells], known[cells] = values, True
    for row in np.flatnonzero(np.abs(up) == 90.0):
        if known[row].any():
            grid[row, ~known[row]], known[row] = grid[row, known[row]][0], True
    if not known.all():
        return None
    if along[0] == -180.0 and along[-1] < 180.0:
        along, grid = np.append(along, 180.0), np.column_stack([grid, grid[:, 0]])
    return along, up, grid


def _input_panel(curves: Sequence[Curve], shown: Measure, xlabel: str, **how: Any) -> Panel:
    limits = _limits(shown)
    return Panel(
        curves, shown.column.title(), xlabel=short(plain(xlabel), _NAME_LETTERS), limits=limits, unit=shown.unit,
        exceeded=_exceeded(shown, np.concatenate([curve.y for curve in curves])), xunit="", **how,
    )  # fmt: skip


def _bar_panel(names: Sequence[str], curves: Sequence[Curve], **how: Any) -> Panel:
    ticks = [(-float(row), short(plain(name), _NAME_LETTERS)) for row, name in enumerate(names)]
    return Panel(curves, "", yticks=ticks, ylim=(0.5 - len(names), 0.5), **how)


def _bar_chart(name: str, panels: Sequence[Panel], caption: str, row: float = _ROW) -> Chart:
    height = row * max(len(panels[0].yticks), 3)
    return Chart(id=name, rows=[panels], height=height, caption=caption, alt=caption)


def _limits(shown: Measure) -> list[tuple[str, float]]:
    return [] if shown.limit is None else [("limit", shown.factor * shown.limit)]


def _exceeded(shown: Measure, values: Array) -> tuple[str, ...]:
    return tuple(name for name, level in _limits(shown) if (values > level).any())
