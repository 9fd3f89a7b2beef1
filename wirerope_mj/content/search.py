"""Content of a design search: its Pareto front in a table and a chart, and some of its designs as scenes."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from wirerope_mj.content.blocks import OTHERS, Block, Chart, Content, Curve, Note, Panel, SceneView, Section, Statement
from wirerope_mj.content.numbers import number, several
from wirerope_mj.content.study import failed_blocks, numerics_table, rested_first, study_facts, study_question, varied_table
from wirerope_mj.content.study_statements import travel_statements
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.tables import Column, Table, left
from wirerope_mj.studies.results.measure import COMBINED, Measure, input_names, measure_of, row_of, values_of
from wirerope_mj.studies.search.result import GENERATION, SearchResult

_SHOWN, _EMPTY = 24, 12  # designs shown at once; names listed of mounts that are not fitted
_DRAWN, _NEAREST = 4, 8  # designs drawn as scenes; designs in the chart if all exceed limits
_NAMED = 12  # designs of the front with a label
_MARGIN = 0.35  # around the front and the given designs, as a fraction of their extent
_EDGE = 0.05  # the same around all designs
_WIDEST_LINEAR = 20.0  # ratio of the largest to the least value from which an axis with all designs is logarithmic
_LABEL_DISTANCE = 0.05  # least vertical distance of labels, as a fraction of the chart's height
_LABEL_WIDTH = 0.15  # room of a label on the left of its design, as a fraction of the chart's width


def search_content(result: SearchResult) -> Content:
    """Compose the content of a complete search: answer, objectives and limits, front and designs."""
    study, count = result.study, result.front.num_rows
    text = f"{several(count, 'design')} on the front, within the limits" if count else "No design within the limits was found"
    values = {"front": float(count)} if count else {}

    def answer() -> Iterator[Block]:
        notes = travel_statements(study.base) if "travel" in result.shown and COMBINED not in result.shown else []
        yield Statement("answer", " ".join([result.message, *notes]))
        yield from failed_blocks(result, "design")

    def objectives() -> Iterator[Block]:
        items = [f"Least: {measure_of(name).text}." for name in result.minimise]
        for name, largest in result.limits.items():
            measure = measure_of(name)
            items.append(f"Limit: {measure.text} at most {number(measure.factor * largest)} {measure.unit}.")
        yield Statement("objectives", items=tuple(items))
        yield varied_table(study)

    return Content(
        title=study.name.replace("_", " ").capitalize(),
        facts=study_facts(result, "Designs", str(result.inputs["search"]["optimiser"])),
        question=study_question(result, "search"),
        verdict=rested_first(Statement("headline", text, tone="within" if count else "exceeded", values=values), study),
        sections=(
            Section("answer", "", answer, "headline"),
            Section("sought", "Objectives and limits", objectives),
            Section("results", "Results", lambda: _results(result), "summary"),
            Section("numerics", "Numerics and versions", lambda: (numerics_table(result),)),
        ),
    )


def _results(result: SearchResult) -> Iterator[Block]:
    """Yield the chart and tables of the front, and some of its designs as scenes where the search places mounts."""
    yield front_chart(result)
    front = result.front["variant"].to_pylist()
    if not front:
        return
    if any(column.places_mounts for varied in result.study.quantities for column in varied.columns):
        # the given design, and the front's ends, knee and middle
        variants = list(dict.fromkeys([*range(min(result.start, 1)), *result.chosen]))[:_DRAWN]
        for variant in sorted(variants, key=lambda n: (n >= result.start, front.index(n) if n in front else -1)):
            row = row_of(result.table, variant)
            measures = [measure_of(name) for name in result.minimise if name != "mounts"]
            parts = [f"{row['mounts']:.0f} mounts"]
            parts += [f"{measure.heading} {measure.factor * row[measure.name]:.3g} {measure.unit}" for measure in measures]
            remark = f" ({remark})" if (remark := result.remark(variant)) else ""
            caption = f"Design {variant}{remark}: {', '.join(parts)}; marks are mounts, crosses empty positions."
            scene, absent = result.scene(variant), tuple(result.absent(variant))
            yield SceneView(id=f"placement-{variant}", scene=scene, caption=caption, absent=absent)
    yield front_table(result)
    yield designs_table(result)


def front_table(result: SearchResult, most: int | None = None) -> Table:
    """Tabulate the designs that were given to the search, and those of the Pareto front."""
    measures = [measure_of(name) for name in result.shown]
    designs = {row["variant"]: row for row in result.table.slice(0, result.start).to_pylist() + result.front.to_pylist()}
    rows = []
    for variant, row in list(designs.items())[:most]:
        values = (row[measure.name] for measure in measures)
        rows.append((str(variant), *values, str(row[GENERATION]), result.remark(variant)))
    columns = [*left("design"), *(measure.column for measure in measures), Column("generation"), *left("")]
    return Table(
        "front-designs", "The front: designs within the limits that no other one beats", columns, rows, shown=_SHOWN,
        note="Other designs of the search may come close to these, and better ones may exist: an evolution proves nothing.",
    )  # fmt: skip


def designs_table(result: SearchResult) -> Table:
    """Tabulate the mounts that are not fitted and other inputs of each design of the front."""
    others = [name for name in input_names(result.table) if not name.endswith("/fitted")]
    rows = []
    for row in result.front.to_pylist():
        absent = result.absent(row["variant"])
        names = ", ".join(absent[:_EMPTY]) + (f" and {len(absent) - _EMPTY} more" if len(absent) > _EMPTY else "")
        values = (f"{row[name]:.4g}" if isinstance(row[name], float) else str(row[name]) for name in others)
        inputs = ", ".join(f"{name} {value}" for name, value in zip(others, values, strict=True))
        rows.append((str(row["variant"]), names or "none", inputs or "-"))
    columns = [*left("design"), *(Column(head, align="text") for head in ("positions without a mount", "other inputs"))]
    return Table("designs", "These designs", columns, rows, shown=_SHOWN)


def front_chart(result: SearchResult) -> Chart:
    """Draw all designs by the first two measures that are minimised, or by the only one in the order of the designs."""
    names = result.minimise[:2]
    across, up = (measure_of(names[1]) if len(names) > 1 else None), measure_of(names[0])
    x, y = (
        np.arange(result.table.num_rows, dtype=np.float64)
        if measure is None
        else measure.factor * values_of(result.table, measure.name)
        for measure in (across, up)
    )
    within, front, given = result.feasible, np.asarray(result.front["variant"]), np.arange(result.start)
    known = np.isfinite(x) & np.isfinite(y)
    knee = np.array([] if result.knee is None else [result.knee], dtype=np.int64)
    curves = [
        Curve(x[rows], y[rows], name=name, kind=kind, marks=True)
        for name, kind, rows in (
            ("knee of the front", 2, knee), ("given", 1, given), ("front", 0, front),
            ("within the limits", 3, np.flatnonzero(known & within)),
            ("beyond a limit", OTHERS, np.flatnonzero(known & ~within)),
        )
        if rows.size
    ]  # fmt: skip
    if front.size > 1 and len(result.minimise) == 2:
        curves.append(Curve(x[front], y[front], name="", kind=0))
    wanted = np.array(result.chosen if front.size else result.chosen[:_NEAREST], dtype=np.int64)
    shown = np.concatenate([wanted, given])
    xlim, ylim = (
        _axis_range(values[shown], None if measure is None else result.limits.get(measure.name), measure)
        for measure, values in ((across, x), (up, y))
    )
    failed = f"{len(result.failed)} failed designs are not drawn" if result.failed else ""
    panel = Panel(
        curves, up.column.title(), xlabel="design" if across is None else across.label,
        limits=_limit_levels(result, up), xlimits=[] if across is None else _limit_levels(result, across),
        notes=_labels(result, front, (x, y), (xlim, ylim)), xlim=xlim, ylim=ylim, title=failed, unit=up.unit,
        xunit="" if across is None else across.unit,
    )  # fmt: skip
    panels = [panel]
    outside = known & ((x < xlim[0]) | (x > xlim[1]) | (y < ylim[0]) | (y > ylim[1]))
    if outside.any():
        drawn = int(known.sum())
        log = "x" * (across is not None and _spreads(x[known])) + "y" * _spreads(y[known])
        xlim, ylim = (
            (0.9 * values[known].min(), 1.1 * values[known].max())
            if axis in log
            else _axis_range(values[known], None, None, margin=_EDGE)
            for axis, values in (("x", x), ("y", y))
        )
        title = "; ".join(filter(None, (f"all {several(drawn, 'design')}", failed)))
        panels = [
            replace(panel, title=f"{int((known & ~outside).sum())} of {several(drawn, 'design')}"),
            replace(panel, title=title, notes=(), xlim=xlim, ylim=ylim, log=log),
        ]
    text = " and ".join(measure_of(name).text for name in result.minimise)
    front_text = " Line: the front, designs within the limits that no other one beats." if front.size else ""
    caption = f"All designs by {text}, some with their numbers of mounts.{front_text}"
    height = 260.0 if len(panels) == 1 else 200.0
    return Chart(id="front", rows=[[panel] for panel in panels], height=height, caption=caption, alt=caption)


def _spreads(values: Array) -> bool:
    """Tell whether values are positive and so far apart that their axis is logarithmic."""
    return bool(values.min() > 0.0 and values.max() > _WIDEST_LINEAR * values.min())


def _limit_levels(result: SearchResult, measure: Measure) -> list[tuple[str, float]]:
    return [("limit", measure.factor * result.limits[measure.name])] if measure.name in result.limits else []


def _axis_range(values: Array, limit: float | None, measure: Measure | None, *, margin: float = _MARGIN) -> tuple[float, float]:
    """Compute the range of an axis around values and limit, from 0 on unless values are negative."""
    ends = values[np.isfinite(values)]
    ends = ends if ends.size else np.zeros(1)
    if measure is not None and limit is not None:
        ends = np.append(ends, measure.factor * limit)
    room = margin * float(np.ptp(ends) or abs(ends[0]) or 1.0)
    low = float(ends.min()) - room
    return (max(low, 0.0) if ends.min() >= 0.0 else low), float(ends.max()) + room


def _labels(
    result: SearchResult, front: Integers, at: tuple[Array, Array], limits: tuple[tuple[float, float], tuple[float, float]]
) -> list[Note]:
    """Label given designs and designs of the front with their number of mounts, as far as labels do not overlap."""
    mounts, notes, heights = np.asarray(result.table["mounts"]), list[Note](), list[float]()
    first = [*range(result.start), *([] if result.knee is None else [result.knee])]
    for variant in [*first, *front[[0, -1]], *front] if front.size else first:
        x, y = at[0][variant], at[1][variant]
        across, up = ((value - low) / (high - low) for value, (low, high) in zip((x, y), limits, strict=True))
        inside = 0.0 <= across <= 1.0 and 0.0 <= up <= 1.0
        if not inside or len(notes) == _NAMED or any(abs(up - height) < _LABEL_DISTANCE for height in heights):
            continue
        heights.append(up)
        label = f"{mounts[variant]:.0f} mounts" + (f", design {variant}" if variant in first else "")
        # On the left of a front there is room; beyond the given design on the right.
        notes.append((float(x), float(y), label, across > _LABEL_WIDTH and variant >= result.start))
    return notes
