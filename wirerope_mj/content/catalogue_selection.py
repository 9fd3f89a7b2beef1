"""Content of a selection by simulation: parts that keep every limit, what is most critical of each, why others do not."""

import math
from collections.abc import Iterator
from functools import partial

from wirerope_mj.assessment.criteria.verdict import STATIC_LOAD
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.numbers import listed, several
from wirerope_mj.content.verdicts import used_mark
from wirerope_mj.foundation.tables import Cell, Column, Row, Table
from wirerope_mj.studies.catalogue import BY, CRITERIA, CatalogueSelection, TriedPart

_FIRST, _NEAREST = 12, 5  # parts shown unless all are asked for: those that keep every limit, those that do not
_HEADINGS = {"price": Column("price", "", ".2f"), "mass": Column("mass of\nmounts", "kg", ".2f")}


def catalogue_selection_content(selection: CatalogueSelection, *, every: bool) -> Content:
    """Compose what a simulated selection says; `every`: whether all parts are shown, and not the first and the nearest."""
    tried, meeting = [one for one in selection.tried if not one.reason], selection.meeting
    thing = "part" if len({one.placement for one in tried}) < 2 else "choice"
    counted = f"{several(len(tried), thing)} simulated under {several(len(selection.cases), 'load case')}"
    values = {"met": float(len(meeting)), "not_met": float(len(tried) - len(meeting))}
    if meeting:
        first = meeting[0]
        by = selection.by if selection.by != "margin" else "largest margin"
        text = f"{len(meeting)} of {counted} keep every limit; first by {by}: {_called(first)}, {_critical(first)}."
    else:
        nearest = next((one for one in tried), None)
        beyond = "" if nearest is None else f"; nearest {_called(nearest)}, {_critical(nearest)}"
        text = f"None of {counted} keeps every limit{beyond}."
    return Content(
        title="Selection of isolators",
        verdict=Statement(id="headline", text=text, tone="within" if meeting else "exceeded", values=values),
        sections=(Section("parts", "Parts", partial(_parts, selection, every), "summary"),),
    )


def _parts(selection: CatalogueSelection, every: bool) -> Iterator[Block]:
    numbered = tuple(f"{number}: {name}" for number, name in enumerate(selection.cases, start=1))
    yield Statement(id="load-cases", text="Load cases", items=numbered, tone="strong")
    meeting, rest = selection.meeting, [one for one in selection.tried if not one.meets and not one.reason]
    if meeting:
        title = f"{several(len(meeting), 'part')} keep{'s' if len(meeting) == 1 else ''} every limit"
        yield _table("candidates", title, selection, meeting, None if every else _FIRST)
    if rest and (every or not meeting):
        title = f"{several(len(rest), 'part')} exceed{'s' if len(rest) == 1 else ''} a limit, the nearest first"
        yield _table("rejected", title, selection, rest, None if every else _NEAREST)
    yield Statement(id="notes", items=tuple(_notes(selection)))


def _table(
    name: str, title: str, selection: CatalogueSelection, parts: list[TriedPart] | tuple[TriedPart, ...], most: int | None
) -> Table:  # fmt: skip
    """Tabulate parts in their order."""
    placed = len({one.placement for one in selection.tried if one.placement}) > 1
    extra = [by for by in ("price", "mass") if any(by in own for own in selection.stated.values())]
    columns = [
        Column("part", align="left"), *([Column("mounts", align="left")] if placed else []), Column("used", "%", "z.0f"),
        Column("most critical", align="left"), Column("case"), Column("static\nload", "%", "z.0f"),
        Column("travel", "%", "z.0f"), Column("peak", "g", ".1f"), Column("moves", "mm", ".1f"),
        Column("height", "mm", ".0f"), *(_HEADINGS[by] for by in extra),
    ]  # fmt: skip
    cases = list(selection.cases)
    rows: list[Row] = []
    for one in parts:
        used, criterion, case = one.governing
        number = str(cases.index(case) + 1) if case and criterion != STATIC_LOAD else ""
        cells: list[Cell] = [one.name, *([one.placement] if placed else []), used_mark(_known(used)), criterion, number]
        cells += [used_mark(_known(one.used(measure)[0])) for measure in ("static_load", "travel")]
        cells += [one.acceleration, one.displacement, selection.figure(one, "height")]
        rows.append([*cells, *(selection.figure(one, by) for by in extra)])
    return Table(
        id=name, title=title, columns=columns, rows=rows, shown=most,
        note="Used: of the limit that is the most critical over all load cases. Peak: largest of any body or point. Moves: "
        "largest displacement of a point from its modelled place.",
    )  # fmt: skip


def _notes(selection: CatalogueSelection) -> Iterator[str]:
    """Yield what the table rests on, and what it leaves open."""
    tried = [one for one in selection.tried if not one.reason]
    for measure, criterion in CRITERIA.items():
        missing = [one.name for one in tried if math.isnan(one.used(measure)[0])]
        if missing and len(missing) == len(tried):
            yield f"{criterion}: no limit, not judged"
        elif missing:
            yield f"{criterion}: not rated by the vendor, not judged: {listed(missing)}"
    for why, names in _reasons(selection).items():
        yield f"not simulated: {listed(names)}: {why}"
    if len(tried) > len(selection.meeting):
        yield "figures of parts beyond a limit are computed as far as it takes to be certain that it is exceeded"
    yield (
        "the isolators are those of the catalogue, fitted to the vendors' stiffnesses with tension and damping as assumed "
        "there; the payload's side of each mount stays in its place, and the foundation follows the part's height"
    )
    if selection.by in ("price", "mass") and any(math.isnan(selection.figure(one, selection.by)) for one in tried):
        yield f"parts without a {selection.by} in the table come last"
    if selection.meeting:
        others = ", ".join(by for by in BY if by != selection.by)
        yield f"ranked by {selection.by}; --by {others}"


def _reasons(selection: CatalogueSelection) -> dict[str, list[str]]:
    reasons: dict[str, list[str]] = {}
    for one in selection.tried:
        if one.reason:
            reasons.setdefault(one.reason.rstrip("."), []).append(one.name)
    return reasons


def _called(one: TriedPart) -> str:
    return f"{one.mounts} {one.name}"


def _critical(one: TriedPart) -> str:
    used, criterion, case = one.governing
    under = f" under {case}" if criterion != STATIC_LOAD else ""
    return f"{100.0 * used:.0f} % of {criterion}{under}" if criterion else "nothing judged"


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
