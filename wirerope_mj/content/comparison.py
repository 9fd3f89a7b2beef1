"""Content of a comparison of runs: the better run, differing inputs and histories, and peaks side by side."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.comparison import (
    BASE,
    Comparison,
    Component,
    HistoryDifference,
    PeakRow,
    Subject,
    acceleration_rows,
    combined_rows,
    identical,
    largest_of,
    mount_rows,
    travel_rows,
)
from wirerope_mj.assessment.criteria import COMBINED, EXCEEDED, STRUCK, WITHIN
from wirerope_mj.assessment.criteria.verdict import TRAVEL, against_limit, most_used
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.credibility import compared_credibility_blocks
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import listed, several, with_unit
from wirerope_mj.content.verdicts import acceleration_limits, headline, used_mark
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left
from wirerope_mj.foundation.units import STANDARD_GRAVITY, force_unit
from wirerope_mj.mounts.isolator import AXES

# Inputs of each run, by the run's name: names of inputs and their values as text
Inputs = Mapping[str, Mapping[str, str]]

# The two measures of a mount's travel: each axis against its rating, and all axes at once (in-house rule)
SINGLE, TOGETHER = "Travel along single axes", "Combined travel"
_MOST_MOUNTS = 8  # mounts that are shown at once: those that use most of their rated travel in any run
_WIDEST = 24  # characters of an input that still fit into a column beside others
_DIFFERENT_INSTANT = 1.0  # difference above which the instants of two shocks are reported [ms]
_LONGEST_IN_MS = 10.0  # instant from which seconds are written instead of milliseconds [s]


def comparison_content(comparison: Comparison, inputs: Inputs, judged: Mapping[str, JudgedRun] | None = None) -> Content:
    """Compose the comparison of runs: the better run, differences, peaks side by side, and credibility of `judged` runs."""

    def headlines() -> Iterator[Block]:
        for run in comparison.runs:
            statement = headline(run.verdicts)
            yield replace(statement, id=f"headline-{run.name}", text=f"{run.name}: {statement.text}")

    def mounts() -> Iterator[Block]:
        for quantity, unit in (("deflection", "mm"), ("force", "kN")):
            for axis, along in reversed(list(enumerate(AXES))):
                if rows := [row for row in mount_rows(comparison, quantity, axis) if any(row.values)]:
                    yield _peaks_table(f"{quantity}-{along}", f"Largest {along} {quantity}", comparison, rows, (unit, "z.2f"))

    return Content(
        title=" and ".join(run.name for run in comparison.runs),
        verdict=better_run(comparison),
        sections=(
            Section("headlines", "", headlines, "headline"),
            Section("differences", "What differs", lambda: _summary(comparison, inputs), "headline"),
            Section("findings", "", lambda: [findings(comparison)], "headline"),
            Section("accelerations", "Peak accelerations", lambda: [accelerations_table(comparison)], "summary"),
            Section("travel", "Mounts", lambda: travel_tables(comparison), "summary"),
            Section("components", "Along the axes", lambda: (accelerations_table(comparison, axis) for axis in range(3))),
            Section("mounts", "Deflections and forces", mounts),
            Section("apart", "Farthest apart", lambda: _difference_blocks(comparison)),
            Section("credibility", "How far this can be relied on", lambda: compared_credibility_blocks(judged or {})),
        ),
    )


def findings(comparison: Comparison) -> Statement:
    return Statement("findings", items=tuple(comparison_lines(comparison)))


def figures_table(comparison: Comparison) -> Table:
    """Tabulate the main figures of the runs: exceeded checks, struck stops, and largest peaks."""

    def largest(label: str, row: PeakRow | None, column: Column) -> list[Row]:
        if row is None:
            return []
        cells: list[Cell] = [label]
        for value, note in zip(row.values, row.notes, strict=True):
            text = f"{column.text(value)} {note}".strip()
            cells.append(Mark(text, used_mark(value).tone) if column.unit == "%" and _is_finite(value) else text)
        return [cells]

    rows: list[Row] = []
    counts = [[sum(row.verdict == which for row in run.verdicts) for which in (EXCEEDED, WITHIN)] for run in comparison.runs]
    if any(over + within for over, within in counts):
        marks = [Mark(f"{over} of {over + within}", "exceeded" if over else "") for over, within in counts]
        rows.append(("checks exceeded", *(mark if sum(count) else None for mark, count in zip(marks, counts, strict=True))))
    stops = [[row.contact for row in run.verdicts if row.contact] for run in comparison.runs]
    if any(stops):
        struck = (f"{of_run.count(STRUCK)} of {len(of_run)}" if of_run else None for of_run in stops)
        rows.append(("stops, contacts struck", *struck))
    peaks = [row for row in acceleration_rows(comparison) if row.label != BASE.label]
    rows += largest("peak acceleration [g]", largest_of(peaks), Column("", "g", "z.2f"))
    ratio = Column("", "%", "z.0f")
    rows += largest(f"{SINGLE.lower()} [% used]", largest_of(travel_rows(comparison)), ratio)
    rows += largest(f"{TOGETHER.lower()} [% used]", largest_of(combined_rows(comparison)), ratio)
    if force := largest_of([row for axis in range(3) for row in mount_rows(comparison, "force", axis)]):
        unit = force_unit(max(abs(value) for value in force.values if value is not None and math.isfinite(value)))
        rows += largest(f"largest force of a mount [{unit}]", force, Column("", unit))
    columns = (*left(""), *(Column(run.name, align="text") for run in comparison.runs))
    return Table("figures", "Side by side", columns, rows)


def accelerations_table(comparison: Comparison, axis: int | None = None) -> Table:
    """Tabulate peak accelerations along an axis, or magnitudes with their utilisation of limits."""
    rows, along = acceleration_rows(comparison, axis), "" if axis is None else "xyz"[axis]
    name, title = (f"accelerations-{along}", f"Peak accelerations along {along}") if along else _ACCELERATIONS
    table = _peaks_table(name, title, comparison, rows, ("g", "z.2f"), times=True)
    limits = [acceleration_limits(run.verdicts) for run in comparison.runs]
    if along or not any(limits):
        return table
    columns, body = list(table.columns), [list(row) for row in table.rows]
    columns += [Column(f"{run.name}, used" if len(limits) > 1 else "used", "%", "z.0f") for run in comparison.runs]
    columns += [Column("limit", "g"), *left("of")]
    for row, cells in zip(rows, body, strict=True):
        verdicts = [of_run.get(row.label.removeprefix("point ")) for of_run in limits]
        cells += [used_mark(verdict.utilisation if verdict else None) for verdict in verdicts]
        stated = next(filter(None, verdicts), None)
        cells += [stated.limit, stated.criterion.axis] if stated else [None, ""]
    return replace(table, columns=columns, rows=body)


def travel_tables(comparison: Comparison) -> Iterator[Table]:
    """Yield what is used of rated travels, along single axes and combined; the largest deflections if none is rated."""
    single = travel_rows(comparison)
    if any(_is_finite(value) for row in single for value in row.values):
        yield _peaks_table(
            "travel-single", f"{SINGLE}, % of the rating used", comparison, single, ("%", "z.0f"), shown=_MOST_MOUNTS
        )
        if combined := combined_rows(comparison):
            title = f"{TOGETHER}, % of the ellipsoid through the ratings used (in-house rule)"
            yield _peaks_table("travel-combined", title, comparison, combined, ("%", "z.0f"), shown=_MOST_MOUNTS)
    elif single:
        rows = mount_rows(comparison, "deflection", None)
        yield _peaks_table(
            "deflections", "Largest deflections", comparison, rows, ("mm", "z.2f"), times=True, shown=_MOST_MOUNTS
        )


_ACCELERATIONS = "accelerations", "Peak accelerations"  # id and title of the table of magnitudes


def _summary(comparison: Comparison, inputs: Inputs) -> Iterator[Block]:
    """Yield the main figures, and the inputs that differ: short values in a table, long values in a list."""
    yield figures_table(comparison)
    if differing := different_inputs(comparison, inputs):
        names = [run.name for run in comparison.runs]
        columns = (*left(""), *(Column(name, align="text") for name in names))
        short = [(key, *values) for key, values in differing if max(map(len, values)) <= _WIDEST]
        yield Table("inputs", "Inputs that differ", columns, short)
        long = [(key, zip(names, values, strict=True)) for key, values in differing if max(map(len, values)) > _WIDEST]
        items = [f"{key}: {'; '.join(f'{name}: {value}' for name, value in pairs)}" for key, pairs in long]
        yield Statement("long-inputs", items=tuple(items))


def _difference_blocks(comparison: Comparison) -> Iterator[Block]:
    """Yield for each run its largest differences from the first run."""
    first = comparison.runs[0].name
    columns = (*left(""), Column("farthest apart"), Column("at", "ms", "z.1f"), Column(f"of {first}'s peak"))
    for run in comparison.runs[1:]:
        entries = [entry for entry in comparison.differences if entry.run == run.name and entry.value > 0.0]
        title = f"{run.name} against {first}"
        if entries:
            rows = [(subject_label(entry.subject), size_text(entry), entry.time, ratio_text(entry)) for entry in entries]
            yield Table(f"apart-{run.name}", title, columns, rows)
        else:
            yield Statement(f"apart-{run.name}", f"{title}: histories do not differ.")


def _peaks_table(
    name: str, title: str, comparison: Comparison, rows: Sequence[PeakRow], unit_and_form: tuple[str, str], *,
    times: bool = False, shown: int | None = None,
) -> Table:  # fmt: skip
    """Tabulate peaks of all runs with their differences from the first run, with their instants if `times`."""
    first = comparison.runs[0].name
    unit, form = unit_and_form
    noted = any(note for row in rows for note in row.notes)
    columns = left("")
    for number, run in enumerate(comparison.runs):
        columns += [Column(run.name, unit, form), *(left("in") if noted else [])]
        columns += [Column("at", "s", "z.4f")] if times else []
        columns += [Column(f"to {first}")] if number else []
    body: list[Row] = []
    for row in rows:
        cells: list[Cell] = [row.label]
        for number, (value, time, note) in enumerate(zip(row.values, row.times, row.notes, strict=True)):
            cells.append(used_mark(value if _is_finite(value) else None) if unit == "%" else Mark(value, "strong"))
            cells += [note] if noted else []
            cells += [time if _is_finite(value) else None] if times else []
            cells += [difference_text(row, number)] if number else []
        body.append(cells)
    return Table(name, title, columns, body, shown=shown)


def _is_finite(value: float | None) -> bool:
    return value is not None and bool(np.isfinite(value))


def difference_text(row: PeakRow, number: int) -> str:
    """Write the difference of a run to the first: "=", "+12.3 %", or "-" where it is unknown."""
    difference = row.difference(number)
    if difference is None:
        return "-"
    return "=" if row.values[number] == row.values[0] else f"{100.0 * difference:+.1f} %"


def different_inputs(comparison: Comparison, inputs: Inputs) -> list[tuple[str, tuple[str, ...]]]:
    """List the inputs that differ: name, and its value in each run ("-" where it is missing)."""
    keys = dict.fromkeys(key for run in comparison.runs for key in inputs.get(run.name, {}))
    rows = [(key, tuple(inputs.get(run.name, {}).get(key, "-") for run in comparison.runs)) for key in keys]
    return [(key, values) for key, values in rows if len(set(values)) > 1]


def better_run(comparison: Comparison) -> Statement:
    """State the better run: fewest exceeded checks, then smallest utilisation of the most critical limit.

    Where a run has no judged limit, the smallest peak acceleration of the payload decides.
    """
    first, *others = comparison.runs
    names = [run.name for run in comparison.runs]
    if others and all(identical(first.response, run.response) for run in others):
        return Statement("better", "The runs are identical: none is better.", values={"better": None})
    # Loads at rest tell nothing of the motions, unless nothing else is judged.
    timed = {run.name: most_used(row for row in run.verdicts if row.time is not None) for run in comparison.runs}
    used = {run.name: row for run in comparison.runs if (row := timed[run.name] or most_used(run.verdicts))}
    if len(used) < len(names):
        rows = [row for row in acceleration_rows(comparison) if row.label != BASE.label and None not in row.values]
        if not rows:
            return Statement("better", "No limit is stated: none is better.", values={"better": None})
        best = names[int(np.argmin(np.array(rows[0].values, dtype=np.float64)))]
        sizes = "; ".join(f"{name}: {with_unit(value, 'g')}" for name, value in zip(names, rows[0].values, strict=True))
        text = f"Limits are not stated in every run; {best} has the smallest peak acceleration of {rows[0].label}. {sizes}."
        return Statement("better", text, values={"better": best})
    exceeded = {run.name: sum(row.verdict == EXCEEDED for row in run.verdicts) for run in comparison.runs}
    ranks = {name: (exceeded[name], used[name].utilisation or 0.0) for name in names}
    best = min(names, key=ranks.__getitem__)
    checks = {name: f"{several(over, 'check')} exceeded, " if over else "" for name, over in exceeded.items()}
    parts = [f"{name}: {checks[name]}most critical {against_limit(used[name])}" for name in names]
    tie = list(ranks.values()).count(ranks[best]) > 1
    text = "None is better" if tie else f"{best} is better"
    return Statement("better", f"{text}. {'; '.join(parts)}.", values={"better": None if tie else best})


def comparison_lines(comparison: Comparison) -> list[str]:
    """Describe how runs differ from the first, a line each: shock instants, histories, exceeded travel, unshared parts."""
    first, *others = comparison.runs
    lines = [f"{run.name} is moved by {1e3 * run.moved:+.4g} ms to the shock of {first.name}." for run in others if run.moved]
    for run in others:
        if first.response.events and run.response.events:
            apart = 1e3 * (run.response.events[0][0] - first.response.events[0][0])
            if abs(apart) > _DIFFERENT_INSTANT:
                late = f"{abs(apart):.4g} ms {'later' if apart > 0.0 else 'earlier'}"
                lines.append(
                    f"The base of {run.name} moves {late} than that of {first.name}: --align shock lays both shocks together."
                )
        if identical(first.response, run.response):
            lines.append(f"{run.name} and {first.name} are identical: every sample and every peak has the same bits.")
            continue
        entries = [entry for entry in comparison.differences if entry.run == run.name]
        for entry in entries:
            if entry.subject == BASE:
                lines.append(
                    f"{run.name}: the acceleration of the base differs from that of {first.name} by up to {size_text(entry)}, "
                    f"at {_instant_text(entry)}."
                    if entry.value
                    else f"{run.name}: the base moves as that of {first.name} does."
                )
        riding = [entry for entry in entries if entry.subject != BASE and np.isfinite(entry.ratio)]
        for kind, what in ((Component, "accelerations"), (str, "deflections")):
            for entry in [entry for entry in riding if isinstance(entry.subject, kind)][:1]:
                lines.append(
                    f"{run.name}: {what} differ most from those of {first.name} at {subject_label(entry.subject)}: by "
                    f"{size_text(entry)} at {_instant_text(entry)}, {ratio_text(entry)} of {first.name}'s peak."
                    if entry.value
                    else f"{run.name}: {what} are those of {first.name}, bit for bit."
                )
    for criterion, what in ((TRAVEL, SINGLE), (COMBINED.kind, TOGETHER)):
        over = {
            run.name: [row.subject for row in run.verdicts if row.criterion.kind == criterion and row.verdict == EXCEEDED]
            for run in comparison.runs
        }
        if len(set(map(frozenset, over.values()))) > 1:
            by_run = "; ".join(f"{name}: {listed([*dict.fromkeys(names)]) or 'none'}" for name, names in over.items())
            lines.append(f"{what} exceeds 100 %: {by_run}.")
    for name, subjects in comparison.alone.items():
        if subjects:
            kinds: dict[tuple[str, str], list[str]] = {("body", "bodies"): [], ("point", "points"): [], ("mount", "mounts"): []}
            for subject in subjects:
                mount, point = isinstance(subject, str), not isinstance(subject, str) and subject.kind == "point"
                key = ("mount", "mounts") if mount else ("point", "points") if point else ("body", "bodies")
                kinds[key].append(subject if isinstance(subject, str) else subject.name)
            parts = [f"{kind[len(names) > 1]} {listed(names)}" for kind, names in kinds.items() if names]
            lines.append(f"Only in {name}: {'; '.join(parts)}.")
    return lines


def subject_label(subject: Subject) -> str:
    return f"mount {subject}" if isinstance(subject, str) else subject.label


def size_text(entry: HistoryDifference) -> str:
    """Write the largest difference of two histories, of a mount in mm, else in g."""
    mount = isinstance(entry.subject, str)
    return f"{1e3 * entry.value:.3g} mm" if mount else f"{entry.value / STANDARD_GRAVITY:.3g} g"


def ratio_text(entry: HistoryDifference) -> str:
    """Write a largest difference in percent of the first run's peak; "-" where that is 0."""
    return f"{100 * entry.ratio:.3g} %" if np.isfinite(entry.ratio) else "-"


def _instant_text(entry: HistoryDifference) -> str:
    return f"{1e3 * entry.time:.1f} ms" if entry.time < _LONGEST_IN_MS else f"{entry.time:.2f} s"
