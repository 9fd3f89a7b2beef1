"""Pictures of a search: its designs with the front, and some of the front's from above and from the side."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.results.measure import Measure, measure_of, values_of
from wirerope_mj.studies.results.statistics import row_of
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import COLOURS, RATED, WIDTH, report_style
from wirerope_mj.views.plots.scene_plan import draw_view
from wirerope_mj.views.plots.study_pictures import StudyPicture

_SHOWN = 4  # designs from above
_NEAREST = 8  # designs that are shown where none is within the limits
_NAMED = 12  # designs of the front with a label
_AROUND = 0.35  # of the extent of the front with the given designs: what is drawn around it
_LEFT = 0.15  # of the picture's width: nearer to its edge labels have no room on the left
_COLUMNS = 4  # of the legend, as many as the picture has room for
_APART = 0.04  # of the picture's height: labels that are nearer would cover each other


def search_pictures(result: SearchResult) -> list[StudyPicture]:
    """Return the pictures of a search; of one that found nothing within its limits, its designs alone."""
    text = " and ".join(measure_of(name).text for name in result.minimise)
    parts = [f"All designs by {text}, some with their numbers of mounts"]
    if result.front.num_rows:
        parts[0] += ". Line: the front, designs within the limits that no other one beats"
    if result.knee is not None:
        parts.append("ring: its knee")
    if result.start:
        parts.append("diamond: the design that was given")
    if not result.feasible.all():
        parts.append("grey: beyond a limit")
    caption = f"{'; '.join(parts)}."
    pictures = [StudyPicture(name="front", figure=front_figure(result), caption=caption)]
    with_mounts = any(column.places_mounts for one in result.study.quantities for column in one.columns)
    if with_mounts and result.front.num_rows:
        caption = (
            "Designs of the front from above and from the side, the given one first: filled marks are mounts, crosses empty "
            "places."
        )
        pictures.append(StudyPicture(name="placements", figure=placements_figure(result), caption=caption))
    return pictures


def front_figure(result: SearchResult) -> Figure:
    """Return all designs by the first two measures that were minimised; of one measure, in the order of the designs."""
    names = result.minimise[:2]
    across, up = (measure_of(names[1]) if len(names) > 1 else None), measure_of(names[0])
    x, y = _values(result, across), _values(result, up)
    within, front = result.feasible, np.asarray(result.front["variant"])
    known = np.isfinite(x) & np.isfinite(y)
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 4.2), layout="constrained")
        panel = figure.subplots()
        for rows, label, colour, alpha in (
            (known & ~within, "beyond a limit", "0.75", 1.0), (within, "within the limits", COLOURS[0], 0.4)
        ):  # fmt: skip
            if rows.any():
                panel.plot(x[rows], y[rows], ".", ms=6, color=colour, alpha=alpha, mec="none", label=label)
        if front.size:
            style = "o-" if len(result.minimise) == 2 else "o"
            panel.plot(x[front], y[front], style, ms=4, color=COLOURS[0], label="front")
        given = np.arange(result.start)
        if given.size:
            panel.plot(x[given], y[given], "D", ms=6, color=COLOURS[1], mec="white", mew=0.6, label="given")
        if result.knee is not None:
            at = x[result.knee], y[result.knee]
            panel.plot(*at, "o", ms=11, mfc="none", color=COLOURS[1], mew=1.3, label="knee of the front")
        for measure, line in ((across, panel.axvline), (up, panel.axhline)):
            if measure is not None and measure.name in result.limits:
                line(measure.factor * result.limits[measure.name], color=RATED, ls="--", lw=1.0, label="limit")
        wanted = np.array(result.chosen if front.size else result.chosen[:_NEAREST], dtype=np.int64)
        _frame(panel, across, up, np.concatenate([wanted, given]), x, y, result.limits)
        _labels(panel, result, front, x, y)
        left_out = _outside(panel, x[known], y[known])
        title = "; ".join(filter(None, [left_out, f"{len(result.failed)} failed" if result.failed else ""]))
        _legend(figure, [panel], title=f"not shown: {title}" if title else None)
    return figure


def placements_figure(result: SearchResult) -> Figure:
    """Return some designs from above and from the side: the given one, and the front's ends, knee and middle."""
    shown = _shown(result)
    with report_style():
        rows, columns = (len(shown) + 1) // 2, min(len(shown), 2)
        figure = PlainFigure(figsize=(WIDTH, 4.4 * rows), layout="constrained")
        panels = figure.subplots(2 * rows, columns, squeeze=False, height_ratios=(2, 1) * rows)
        for panel in panels.ravel():
            panel.set_visible(False)
        for place, variant in enumerate(shown):
            row, column = divmod(place, columns)
            for number, panel in enumerate(panels[2 * row : 2 * row + 2, column]):
                panel.set_visible(True)
                draw_view(panel, result.scene(variant), number, absent=result.absent(variant))
            panels[2 * row, column].set_title(_title(result, variant), fontsize=7.5)
            panels[2 * row + 1, column].set_title("")
        _legend(figure, panels.ravel())
    return figure


def _values(result: SearchResult, measure: Measure | None) -> Array:
    """Return a measure of all designs in the unit in which it is shown; without one, their numbers."""
    if measure is None:
        return np.arange(result.table.num_rows, dtype=np.float64)
    return measure.factor * values_of(result.table, measure.name)


def _frame(
    panel: Any, across: Measure | None, up: Measure, shown: npt.NDArray[np.int64], x: Array, y: Array,
    limits: dict[str, float],
) -> None:  # fmt: skip
    """Show the front and the given designs with some room around, but not what lies far away."""
    for measure, values, bounds in ((across, x, panel.set_xlim), (up, y, panel.set_ylim)):
        ends = values[shown][np.isfinite(values[shown])]
        if measure is None or ends.size == 0:
            continue
        if measure.name in limits:
            ends = np.append(ends, measure.factor * limits[measure.name])
        room = _AROUND * (np.ptp(ends) or abs(ends[0]) or 1.0)
        bounds(max(ends.min() - room, 0.0 if ends.min() >= 0.0 else -np.inf), ends.max() + room)
    panel.set_xlabel("design" if across is None else across.label)
    panel.set_ylabel(up.label)
    panel.grid(color="0.93")
    panel.set_axisbelow(True)


def _labels(panel: Any, result: SearchResult, front: npt.NDArray[np.int64], x: Array, y: Array) -> None:
    """Name designs of the front, and those that were given, by their number of mounts, where there is room."""
    mounts = np.asarray(result.table["mounts"])
    halo = [withStroke(linewidth=2.0, foreground="white")]
    first = [*range(result.start), *([] if result.knee is None else [result.knee])]
    heights: list[float] = []
    for variant in [*first, *front[[0, -1]], *front] if front.size else first:
        position = panel.transAxes.inverted().transform(panel.transData.transform((x[variant], y[variant])))
        if not np.isfinite(position).all() or any(abs(position[1] - other) < _APART for other in heights):
            continue
        if len(heights) == _NAMED:
            return
        heights.append(position[1])
        label = f"{mounts[variant]:.0f} mounts" + (f", design {variant}" if variant in first else "")
        # Below and to the left of a front there is nothing; beyond the given design there is room on the right.
        left = position[0] > _LEFT and variant >= result.start
        panel.annotate(
            label, (x[variant], y[variant]), xytext=(-7, -7) if left else (8, 2), textcoords="offset points", fontsize=7,
            ha="right" if left else "left", path_effects=halo, annotation_clip=True,
        )  # fmt: skip


def _legend(figure: Figure, panels: Iterable[Any], *, title: str | None = None) -> None:
    """Say below the figure what the marks of its panels are."""
    marks: dict[str, Any] = {}
    for panel in panels:
        handles, labels = panel.get_legend_handles_labels()
        marks |= dict(zip(labels, handles, strict=True))
    figure.legend(
        marks.values(), marks.keys(), loc="outside lower center", ncols=min(len(marks), _COLUMNS), frameon=False, title=title,
        title_fontsize=7,
    )  # fmt: skip


def _outside(panel: Any, x: Array, y: Array) -> str:
    (left, right), (low, high) = panel.get_xlim(), panel.get_ylim()
    count = int(((x < left) | (x > right) | (y < low) | (y > high)).sum())
    return f"{count} designs farther out" if count else ""


def _shown(result: SearchResult) -> list[int]:
    """Return the designs that are drawn from above."""
    front = result.front["variant"].to_pylist()
    wanted = list(dict.fromkeys([*range(min(result.start, 1)), *result.chosen]))[:_SHOWN]
    return sorted(wanted, key=lambda one: (one >= result.start, front.index(one) if one in front else -1))


def _title(result: SearchResult, variant: int) -> str:
    row = row_of(result.table, variant)
    parts = [f"{row['mounts']:.0f} mounts"]
    for name in result.minimise:
        measure = measure_of(name)
        if name != "mounts":
            parts.append(f"{name} {measure.factor * row[name]:.3g} {measure.unit}")
    remark = result.remark(variant)
    return f"design {variant}{f' ({remark})' if remark else ''}\n{', '.join(parts)}"
