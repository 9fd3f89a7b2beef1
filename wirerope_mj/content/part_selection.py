"""Content of the vendors' worksheet: its demands, the parts that meet them, and why the others do not."""

import math
from collections.abc import Iterator

from wirerope_mj.assessment.criteria.verdict import most_used
from wirerope_mj.assessment.selection import PartSelection, Worksheet, mode_text
from wirerope_mj.assessment.selection.worksheet import IMPULSE, WORKSHEET_GRAVITY
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.numbers import several
from wirerope_mj.content.verdicts import used_mark
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table

# Candidates shown unless all are asked for; parts shown with their reasons if none meets the worksheet.
_FIRST, _NEAREST = 12, 5


def selection_content(selection: PartSelection, *, every: bool) -> Content:
    """Compose what a worksheet says; `every`: whether parts that do not meet it are shown with the reasons."""
    return Content(
        title="Selection of isolators",
        verdict=_verdict(selection),
        sections=(
            Section("worksheet", "Worksheet", lambda: (_worksheet(selection.worksheet),), "summary"),
            Section("parts", "Parts", lambda: _parts(selection, every), "summary"),
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
    text = f"{', '.join(shown)}." if met or undecided else "No part of the tables meets it."
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


def _parts(selection: PartSelection, every: bool) -> Iterator[Block]:
    if selection.candidates:
        yield _candidates(selection, None if every else _FIRST)
        yield Statement(id="notes", items=tuple(_notes(selection)))
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


def _notes(selection: PartSelection) -> Iterator[str]:
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
