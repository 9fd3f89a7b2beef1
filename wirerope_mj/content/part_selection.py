"""Parts that are chosen: by simulating every part under all load cases, or by the vendors' worksheet."""

import math
from collections.abc import Iterator
from functools import partial

from wirerope_mj.assessment.criteria.verdict import STATIC_LOAD, most_used
from wirerope_mj.assessment.selection import PartSelection, Worksheet, mode_text
from wirerope_mj.assessment.selection.worksheet import IMPULSE, WORKSHEET_GRAVITY
from wirerope_mj.content.base import amplified
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.numbers import listed, several
from wirerope_mj.content.verdicts import used_mark
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
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
        text = f"{len(meeting)} of {counted} keep every limit; first by {by}: {_called(first)}, {_critical(first)}"
        limited = {measure for measure in CRITERIA if not math.isnan(first.used(measure)[0])}
        what = "acceleration of the payload" if "clearance" in limited else "payload"
        text += "" if "fragility" in limited else f"; {what} not judged: no limit stated"
        for case, motion in selection.cases.items():
            if said := amplified(first.largest("acceleration*", case), motion):
                text += f"; {said}, under {case}"
        text += "."
    else:
        nearest = next((one for one in tried), None)
        beyond = "" if nearest is None else f"; nearest {_called(nearest)}, {_critical(nearest)}"
        text = f"None of {counted} keeps every limit{beyond}." if tried else "No part could be simulated."
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
        "largest displacement of a point from its modelled place along x, y or z, as --travel limits it.",
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


def selection_content(selection: PartSelection, *, every: bool) -> Content:
    """Compose what a worksheet says; `every`: whether parts that do not meet it are shown with the reasons."""
    return Content(
        title="Selection of isolators",
        verdict=_verdict(selection),
        sections=(
            Section("worksheet", "Worksheet", lambda: (_worksheet(selection.worksheet),), "summary"),
            Section("parts", "Parts", lambda: _worksheet_parts(selection, every), "summary"),
        ),
    )


def _verdict(selection: PartSelection) -> Statement:
    met, rest = len(selection.candidates), len(selection.rejected)
    undecided = sum(part.undecided for part in selection.rejected)
    values = {"met": float(met), "not_met": float(rest - undecided), "not_judged": float(undecided)}
    shown = [f"{several(met, 'part')} meet{'s' if met == 1 else ''} it"] if met else []
    if rest > undecided:
        shown.append(f"{rest - undecided} do not" if met else f"{several(rest - undecided, 'part')} do not meet it")
    if undecided:
        shown.append(f"{undecided} are not judged")
    unlimited = "; acceleration of the payload not judged: no limit stated" if selection.worksheet.fragility is None else ""
    text = f"{', '.join(shown)}{unlimited}." if met or undecided else "No part of the tables meets it."
    tone = "within" if met else "unjudged" if undecided else "exceeded"
    return Statement(id="headline", text=text, tone=tone, values=values)


def _worksheet(sheet: Worksheet) -> Statement:
    """Return what the mounts must be like."""
    rows = [f"{sheet.load:.1f} N on each of {sheet.mounts} mounts, {_loading(sheet.loading)}"]
    rows.append(f"velocity change {sheet.velocity:.3f} m/s, {_loading(sheet.direction)}")
    if sheet.largest_frequency is not None and sheet.largest_vibration_stiffness is not None:
        stiffness = 1e-3 * sheet.largest_vibration_stiffness
        rows.append(
            f"natural frequency at most {sheet.largest_frequency:.2f} Hz ({sheet.disturbance:.4g} Hz / "
            f"{sheet.isolation_ratio:.4g}): vibration stiffness at most {stiffness:.0f} N/mm"
        )
    if sheet.smallest_travel is not None and sheet.largest_shock_stiffness is not None:
        rows.append(
            f"{_g(sheet.fragility):.4g} g need at least {1e3 * sheet.smallest_travel:.1f} mm of travel: shock stiffness at "
            f"most {1e-3 * sheet.largest_shock_stiffness:.0f} N/mm"
        )
    if sheet.travel is not None:
        rows.append(f"room for {1e3 * sheet.travel:.4g} mm")
    text = f"Worksheet: {sheet.mass:.6g} kg, g = {sheet.gravity:.6g} m/s^2"
    return Statement(id="worksheet", text=text, items=tuple(rows), tone="strong")


def _worksheet_parts(selection: PartSelection, every: bool) -> Iterator[Block]:
    if selection.candidates:
        yield _candidates(selection, None if every else _FIRST)
        yield Statement(id="notes", items=tuple(_worksheet_notes(selection)))
    if any(part.undecided for part in selection.rejected):
        text = "The pulse is far too long to count by its velocity change alone: wirerope select --shock simulates it."
        yield Statement(id="undecided", text=text, tone="unjudged")
    if selection.rejected and (every or not selection.candidates):
        yield _rejected(selection, None if every else _NEAREST)


def _candidates(selection: PartSelection, most: int | None) -> Table:
    """Tabulate the candidates in their order."""
    columns = [
        Column("part", align="left"), Column("load", "%", "z.0f"), Column("f", "Hz", ".2f"), Column("travel", "mm", ".1f"),
        Column("of rated", "%", "z.0f"), Column("peak\n[g]"), Column("used", "%", "z.0f"),
        Column("most critical", align="left"),
    ]  # fmt: skip
    rows: list[Row] = []
    for one in selection.candidates:
        critical = Mark("nothing judged", "quiet") if one.governing is None else str(one.governing.criterion)
        peak = f"{_g(one.acceleration):.2f}{'*' if selection.worksheet.amplifies(one.acceleration) else ''}"
        worst = most_used(one.verdicts)
        cells: list[Cell] = [one.part.name, used_mark(one.utilisation("static load")), one.frequency, one.travel]
        cells += [used_mark(one.utilisation("rated travel")), peak, used_mark(worst.utilisation if worst else None)]
        cells.append(critical)
        rows.append(cells)
    title = f"{several(len(rows), 'part')} meet{'s' if len(rows) == 1 else ''} it"
    note = "Used: of the limit that is the most critical."
    return Table(id="candidates", title=title, columns=columns, rows=rows, note=note, shown=most)


def _rejected(selection: PartSelection, most: int | None) -> Table:
    """Tabulate the parts that do not meet the worksheet, nearest first."""
    undecided = " or are not judged" if any(part.undecided for part in selection.rejected) else ""
    return Table(
        id="rejected", title=f"{several(len(selection.rejected), 'part')} do not meet it{undecided}",
        columns=(Column("part", align="left"), Column("used", "%", "z.0f"), Column("why", align="text")),
        rows=[
            [
                part.part.name, used_mark(None if math.isnan(part.margin) else 1.0 / (1.0 + part.margin)),
                "; ".join(part.reasons),
            ]
            for part in selection.rejected
        ],
        shown=most,
    )  # fmt: skip


def _worksheet_notes(selection: PartSelection) -> Iterator[str]:
    """Yield what the table rests on."""
    sheet = selection.worksheet
    stiff = sum(sheet.amplifies(one.acceleration) for one in selection.candidates)
    if stiff:
        yield (
            f"* by the worksheet {stiff} of them pass on more than the pulse's own peak of {_g(sheet.peak):.4g} g: too stiff "
            "to isolate this shock, whatever is used of the limits"
        )
    if sheet.fragility is None:
        yield "without --fragility the part that passes on least, the softest that fits, comes first"
    longest = max(one.impulse for one in selection.candidates)
    if not all(one.impulse_holds for one in selection.candidates):
        yield (
            f"the pulse is long for some parts (natural frequency x length up to {longest:.3f}, the rule holds below "
            f"{IMPULSE:g}): their travel and acceleration are on the safe side"
        )
    elif sheet.shock.duration > 0.0:
        yield f"natural frequency x length of the pulse is below {IMPULSE:g} for each: its velocity change alone counts"
    if any(one.unrated for one in selection.candidates):
        yield "- is not rated by the vendor: not judged; those parts come last"
    options = ((sheet.fragility, "--fragility"), (sheet.travel, "--travel"), (sheet.disturbance, "--disturbance-rpm"))
    yield from (f"{option} is not given: not judged" for value, option in options if value is None)
    yield (
        f"every command takes a part by its name: wirerope isolators {selection.candidates[0].part.name}, or in the column "
        "isolator of a table of mounts for wirerope new"
    )
    yield "closed formulas of a guided mass: wirerope select simulates every part in the places of the mounts"


def _g(value: float | None) -> float:
    return math.nan if value is None else value / WORKSHEET_GRAVITY


def _loading(mode: str) -> str:
    """Return a mode as the worksheet is printed."""
    return "in shear or roll" if mode == "shear" else mode_text(mode)
