"""What a comparison of runs says: which is better and why, what differs, and peaks side by side, by both rulers of travel."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.comparison import (
    BASE,
    Comparison,
    PeakRow,
    acceleration_rows,
    combined_rows,
    largest_of,
    mount_rows,
    travel_rows,
)
from wirerope_mj.assessment.criteria import EXCEEDED, STRUCK, WITHIN
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.comparison_findings import (
    Inputs,
    better_run,
    comparison_lines,
    difference_text,
    different_inputs,
    ratio_text,
    size_text,
    subject_label,
)
from wirerope_mj.content.credibility import compared_credibility_blocks
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.verdicts import acceleration_limits, headline, used_mark
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import force_unit
from wirerope_mj.mounts.isolator import AXES

_MOST_MOUNTS = 8  # Mounts that are shown at once: those that use most of their rated travel in any run
_WIDEST = 24  # Characters of an input that still fit into a column beside others
# The two rulers of a mount's travel: each axis against its rating, and all axes at once (in-house rule).
SINGLE, TOGETHER = "Travel along single axes", "Combined travel"


def comparison_content(comparison: Comparison, inputs: Inputs, judged: Mapping[str, JudgedRun] | None = None) -> Content:
    """Compose what a comparison says: which run is better, what differs, and peaks side by side.

    Of runs whose systems are known, `judged`, also how far they can be relied on.
    """
    return Content(
        title=" and ".join(run.name for run in comparison.runs), verdict=better_run(comparison),
        sections=(
            Section("headlines", "", lambda: _headlines(comparison), "headline"),
            Section("differences", "What differs", lambda: _summary(comparison, inputs), "headline"),
            Section("findings", "", lambda: [findings(comparison)], "headline"),
            Section("accelerations", "Peak accelerations", lambda: [accelerations_table(comparison)], "summary"),
            Section("travel", "Mounts", lambda: travel_tables(comparison), "summary"),
            Section("components", "Along the axes", lambda: (accelerations_table(comparison, axis) for axis in range(3))),
            Section("mounts", "Deflections and forces", lambda: _mounts(comparison)),
            Section("apart", "Farthest apart", lambda: _apart(comparison)),
            Section(
                "credibility", "How far this can be relied on",
                lambda: compared_credibility_blocks(judged) if judged else (),
            ),
        ),
    )  # fmt: skip


def findings(comparison: Comparison) -> Statement:
    """Say in sentences what differs, where and when."""
    return Statement(id="findings", items=tuple(comparison_lines(comparison)))


def figures_table(comparison: Comparison) -> Table:
    """Tabulate the few figures by which runs are compared, a column for each run."""
    rows: list[Row] = []
    counts = [[sum(row.verdict == which for row in run.verdicts) for which in (EXCEEDED, WITHIN)] for run in comparison.runs]
    if any(over + within for over, within in counts):
        cells = [
            Mark(f"{over} of {over + within}", "exceeded" if over else "") if over + within else None for over, within in counts
        ]
        rows.append(("checks exceeded", *cells))
    stops = [[row.contact for row in run.verdicts if row.contact] for run in comparison.runs]
    if any(stops):
        rows.append(("stops, contacts struck", *(f"{one.count(STRUCK)} of {len(one)}" if one else None for one in stops)))
    peaks = [row for row in acceleration_rows(comparison) if row.label != BASE.label]
    rows += _largest("peak acceleration [g]", largest_of(peaks), Column("", "g", "z.2f"))
    ratio = Column("", "%", "z.0f")
    rows += _largest(f"{SINGLE.lower()} [% used]", largest_of(travel_rows(comparison)), ratio, used=True)
    rows += _largest(f"{TOGETHER.lower()} [% used]", largest_of(combined_rows(comparison)), ratio, used=True)
    forces = [row for axis in range(3) for row in mount_rows(comparison, "force", axis)]
    if force := largest_of(forces):
        unit = force_unit(max(abs(value) for value in force.values if value is not None and math.isfinite(value)))
        rows += _largest(f"largest force of a mount [{unit}]", force, Column("", unit))
    columns = (Column(align="left"), *(Column(run.name, align="text") for run in comparison.runs))
    return Table(id="figures", title="Side by side", columns=columns, rows=rows)


def accelerations_table(comparison: Comparison, axis: int | None = None) -> Table:
    """Tabulate peak accelerations, sizes or along an axis; of the sizes also what is used of the most critical limit."""
    rows, where = acceleration_rows(comparison, axis), "" if axis is None else "xyz"[axis]
    title = f"Peak accelerations along {where}" if where else "Peak accelerations"
    table = _peaks(f"accelerations{where and '-'}{where}", title, comparison, rows, ("g", "z.2f"), times=True)
    limits = [acceleration_limits(run.verdicts) for run in comparison.runs]
    if where or not any(limits):
        return table
    columns, body = list(table.columns), [list(row) for row in table.rows]
    columns += [Column(f"{run.name}, used" if len(limits) > 1 else "used", "%", "z.0f") for run in comparison.runs]
    columns += [Column("limit", "g"), Column("of", align="left")]
    for row, cells in zip(rows, body, strict=True):
        found = [of_run.get(row.label.removeprefix("point ")) for of_run in limits]
        stated = next((one for one in found if one), None)
        cells += [used_mark(one.utilisation if one else None) for one in found]
        cells += [stated.limit if stated else None, stated.criterion.axis if stated else ""]
    return replace(table, columns=columns, rows=body)


def travel_tables(comparison: Comparison) -> Iterator[Table]:
    """Yield what mounts use of their rated travel by both rulers; where nothing is rated, how far they move."""
    single = travel_rows(comparison)
    if any(_known(value) for row in single for value in row.values):
        for name, title, rows in (
            ("travel-single", f"{SINGLE}, % of the rating used", single),
            (
                "travel-combined",
                f"{TOGETHER}, % of the ellipsoid through the ratings used (in-house rule)",
                combined_rows(comparison),
            ),
        ):
            if rows:
                yield _peaks(name, title, comparison, rows, ("%", "z.0f"), shown=_MOST_MOUNTS)
    elif single:
        rows = mount_rows(comparison, "deflection", None)
        yield _peaks("deflections", "Largest deflections", comparison, rows, ("mm", "z.2f"), times=True, shown=_MOST_MOUNTS)


def _headlines(comparison: Comparison) -> Iterator[Block]:
    for run in comparison.runs:
        one = headline(run.verdicts)
        yield replace(one, id=f"headline-{run.name}", text=f"{run.name}: {one.text}")


def _summary(comparison: Comparison, inputs: Inputs) -> Iterator[Block]:
    names = [run.name for run in comparison.runs]
    yield figures_table(comparison)
    given = different_inputs(comparison, inputs)
    if given:
        columns = (Column(align="left"), *(Column(name, align="text") for name in names))
        short = [(key, *values) for key, values in given if max(map(len, values)) <= _WIDEST]
        yield Table(id="inputs", title="Inputs that differ", columns=columns, rows=short)
        items = [
            f"{key}: {'; '.join(f'{name}: {value}' for name, value in zip(names, values, strict=True))}"
            for key, values in given
            if max(map(len, values)) > _WIDEST
        ]
        yield Statement(id="long-inputs", items=tuple(items))


def _mounts(comparison: Comparison) -> Iterator[Block]:
    for quantity, unit in (("deflection", "mm"), ("force", "kN")):
        for axis, along in reversed(list(enumerate(AXES))):
            rows = [row for row in mount_rows(comparison, quantity, axis) if any(row.values)]
            if rows:
                title = f"Largest {along} {quantity}"
                yield _peaks(f"{quantity}-{along}", title, comparison, rows, (unit, "z.2f"))


def _apart(comparison: Comparison) -> Iterator[Block]:
    first = comparison.runs[0].name
    columns = (Column(align="left"), Column("farthest apart"), Column("at", "ms", "z.1f"), Column(f"of {first}'s peak"))
    for run in comparison.runs[1:]:
        own = [entry for entry in comparison.differences if entry.run == run.name and entry.value > 0.0]
        rows = [(subject_label(e.subject), size_text(e), e.time, ratio_text(e)) for e in own]
        title = f"{run.name} against {first}"
        if rows:
            yield Table(id=f"apart-{run.name}", title=title, columns=columns, rows=rows)
        else:
            yield Statement(id=f"apart-{run.name}", text=f"{title}: histories do not differ.")


def _peaks(
    name: str, title: str, comparison: Comparison, rows: Sequence[PeakRow], look: tuple[str, str], *,
    times: bool = False, shown: int | None = None,
) -> Table:  # fmt: skip
    """Tabulate a peak of every run with its instant where asked, and how it differs from that of the first."""
    first = comparison.runs[0].name
    unit, form = look
    noted = any(note for row in rows for note in row.notes)
    columns = [Column(align="left")]
    for number, run in enumerate(comparison.runs):
        columns += [Column(run.name, unit, form), *([Column("in", align="left")] if noted else [])]
        columns += [Column("at", "s", "z.4f")] if times else []
        columns += [Column(f"to {first}")] if number else []
    body: list[Row] = []
    for row in rows:
        cells: list[Cell] = [row.label]
        for number, (value, time, note) in enumerate(zip(row.values, row.times, row.notes, strict=True)):
            cells.append(used_mark(value if _known(value) else None) if unit == "%" else Mark(value, "strong"))
            cells += [note] if noted else []
            cells += [time if _known(value) else None] if times else []
            cells += [difference_text(row, number)] if number else []
        body.append(cells)
    return Table(id=name, title=title, columns=columns, rows=body, shown=shown)


def _largest(label: str, row: PeakRow | None, look: Column, *, used: bool = False) -> list[Row]:
    """Return a row with the largest value of each run and whose it is; none where no run has one."""
    if row is None:
        return []
    cells: list[Cell] = [label]
    for value, note in zip(row.values, row.notes, strict=True):
        text = f"{look.text(value)} {note}".strip()
        cells.append(Mark(text, used_mark(value).tone) if used and _known(value) else text)
    return [cells]


def _known(value: float | None) -> bool:
    return value is not None and bool(np.isfinite(value))
