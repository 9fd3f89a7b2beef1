"""Content of a part selection: by simulating every part under all load cases, or by the vendors' worksheet."""

import math
import re
from collections import Counter
from collections.abc import Iterator
from functools import partial

from wirerope_mj.assessment.criteria.sampled import steady_interval
from wirerope_mj.assessment.criteria.verdict import SIGMA, STATIC_LOAD, most_used
from wirerope_mj.assessment.selection import IMPULSE, WORKSHEET_GRAVITY, PartSelection, Worksheet, mode_text
from wirerope_mj.content.base import amplified
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.numbers import listed, several, with_unit
from wirerope_mj.content.verdicts import bars_table, used_mark
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left
from wirerope_mj.studies.catalogue import BY, CatalogueSelection
from wirerope_mj.studies.tried_part import CRITERIA, TriedPart

_DIGITS = re.compile(r"\d[\d.e+-]*")  # numbers, without which reasons of several parts are alike
_FIRST, _NEAREST = 12, 5  # parts shown by default: of those that keep every limit, and of those that exceed one
_HEADINGS = {"price": Column("price", "", ".2f"), "mass": Column("mass of\nmounts", "kg", ".2f")}


def catalogue_selection_content(selection: CatalogueSelection, *, every: bool) -> Content:
    """Compose a selection by simulation; all parts are shown if `every`, else the first and those nearest to the limits."""
    tried, meeting = [part for part in selection.tried if not part.reason], selection.meeting
    thing = "part" if len({part.placement for part in tried}) < 2 else "choice"
    counted = f"{several(len(tried), thing)} simulated under {several(len(selection.cases), 'load case')}"
    values = {"met": float(len(meeting)), "not_met": float(len(tried) - len(meeting))}
    if meeting:
        first = meeting[0]
        by = selection.by if selection.by != "margin" else "largest margin"
        keep = "keeps" if len(meeting) == 1 else "keep"
        text = f"{len(meeting)} of {counted} {keep} every limit; first by {by}: {_part_label(first)}, {_critical_text(first)}"
        limited = {measure for measure in CRITERIA if not math.isnan(first.used(measure)[0])}
        unlimited = "acceleration of the payload" if "clearance" in limited else "payload"
        text += "" if "fragility" in limited else f"; {unlimited} not judged: no limit stated"
        for case, motion in selection.cases.items():
            if clause := amplified(first.largest("acceleration*", case), motion):
                text += f"; {clause}, under {case}"
        text += "."
    else:
        beyond = f"; nearest {_part_label(tried[0])}, {_critical_text(tried[0])}" if tried else ""
        text = f"None of {counted} keeps every limit{beyond}." if tried else "No part could be simulated."
    return Content(
        title="Selection of isolators",
        verdict=Statement("headline", text, tone="within" if meeting else "exceeded", values=values),
        sections=(
            Section("brief", "", partial(_brief, selection), "headline"),
            Section("parts", "Parts", partial(_part_blocks, selection, every), "summary"),
        ),
    )


def _brief(selection: CatalogueSelection) -> Iterator[Block]:
    """Yield the best parts as bars, or the nearest and what would keep the limits; parts refused, and what is not judged."""
    rows = []
    for part in (selection.meeting or [part for part in selection.tried if not part.reason])[:_FIRST]:
        used, criterion, case = part.governing
        peak = f"peak {with_unit(part.acceleration, 'g')}, moves {with_unit(part.displacement, 'mm')}"
        under = f", {case}" if case and len(selection.cases) > 1 and criterion != STATIC_LOAD else ""
        rows.append((_part_label(part), f"{criterion}{under}", _finite(used), peak))
    yield bars_table("part", rows)
    if not selection.meeting:
        yield needed_statement(selection)
    yield from _refused(selection, every=False)
    yield Statement("open", items=tuple(_unjudged(selection)), tone="unjudged")


def _part_blocks(selection: CatalogueSelection, every: bool) -> Iterator[Block]:
    """Yield load cases, parts that keep every limit, parts that exceed one, those not simulated, and notes."""
    numbered = tuple(f"{number}: {name}" for number, name in enumerate(selection.cases, start=1))
    yield Statement("load-cases", "Load cases", items=numbered, tone="strong")
    meeting, rest = selection.meeting, [part for part in selection.tried if not part.meets and not part.reason]
    if meeting:
        title = f"{several(len(meeting), 'part')} keep{'s' if len(meeting) == 1 else ''} every limit"
        yield _parts_table("candidates", title, selection, meeting, None if every else _FIRST)
    if rest and (every or not meeting):
        title = f"{several(len(rest), 'part')} exceed{'s' if len(rest) == 1 else ''} a limit, the nearest first"
        yield _parts_table("rejected", title, selection, rest, None if every else _NEAREST)
    if rest and meeting and not every:
        beyond = Counter(part.governing[1] for part in rest)
        counted = ", ".join(f"{criterion} {count}" for criterion, count in beyond.most_common())
        text = f"{several(len(rest), 'part')} exceed{'s' if len(rest) == 1 else ''} a limit: {counted}; --all lists them."
        yield Statement("beyond", text, tone="quiet")
    yield from _refused(selection, every=every)
    if not meeting:
        yield needed_statement(selection)
    notes, tried = list(_unjudged(selection)), [part for part in selection.tried if not part.reason]
    if len(tried) > len(meeting):
        notes.append("figures of parts beyond a limit are computed as far as it takes to know that it is exceeded")
    notes.append(
        "the isolators are those of the catalogue, fitted to the vendors' stiffnesses with tension and damping as assumed "
        "there; the payload's side of each mount stays where it is, and the foundation follows the part's height"
    )
    if selection.by in ("price", "mass") and any(math.isnan(selection.figure(part, selection.by)) for part in tried):
        notes.append(f"parts without a {selection.by} in the table come last")
    if meeting:
        notes.append(f"ranked by {selection.by}; --by {', '.join(by for by in BY if by != selection.by)}")
    yield Statement("notes", items=tuple(notes))


def _refused(selection: CatalogueSelection, *, every: bool) -> Iterator[Statement]:
    """State which parts were not simulated, by their reason; how many of each if not `every` part is shown."""
    alike: dict[str, list[TriedPart]] = {}
    for part in selection.tried:
        if part.reason:
            alike.setdefault(part.reason if every else _DIGITS.sub("..", part.reason), []).append(part)
    if alike:
        items = []
        for reason, parts in sorted(alike.items(), key=lambda entry: -len(entry[1])):
            same = len({part.reason for part in parts}) == 1
            counted = ", ".join(part.name for part in parts) if every else len(parts)
            items.append(f"{counted}: {(parts[0].reason if same else reason).rstrip('.')}")
        end = ":" if every else ", by reason; --all lists them:"
        text = f"{several(sum(map(len, alike.values())), 'part')} not simulated to the end{end}"
        yield Statement("refused", text, items=tuple(items))


def needed_statement(selection: CatalogueSelection) -> Statement:
    """State which stiffness, rated load and travel of a mount would keep the limits, or why none would."""
    needed = selection.needed
    if isinstance(needed, Absent):
        return Statement("needed", needed.reason, tone="unjudged")
    soft, stiff = (
        f"{1e-3 * stiffness:.3g} N/mm ({frequency:.3g} Hz, {1e3 * travel:.3g} mm of travel)"
        for stiffness, frequency, travel in zip(needed.stiffness, needed.frequencies, needed.travel, strict=True)
    )
    return Statement(
        "needed",
        f"What would do: {several(needed.mounts, 'mount')}, rated for {with_unit(needed.load, 'N')} each, from {soft} to "
        f"{stiff}: a single mass with {100.0 * needed.damping:g} % damping along each axis, which does not turn, as boxes do; "
        "travel counts from the unloaded geometry.",
        values={
            "least_stiffness_N_per_m": needed.stiffness[0], "largest_stiffness_N_per_m": needed.stiffness[1],
            "load_N": needed.load, "largest_travel_m": needed.travel[0], "travel_m": needed.travel[1],
        },
    )  # fmt: skip


def _parts_table(
    name: str, title: str, selection: CatalogueSelection, parts: list[TriedPart] | tuple[TriedPart, ...], most: int | None
) -> Table:  # fmt: skip
    """Tabulate parts with their most critical limit, peaks and sizes; at most `most` are shown at once."""
    placed = len({part.placement for part in selection.tried if part.placement}) > 1
    extra = [by for by in ("price", "mass") if any(by in stated for stated in selection.stated.values())]
    random = any(not math.isnan(part.largest("three_sigma")) for part in parts)
    columns = [
        *left("part"), *(left("mounts") if placed else []), Column("used", "%", "z.0f"),
        *left("most critical"), Column("case"), Column("static\nload", "%", "z.0f"),
        Column("travel", "%", "z.0f"), Column("peak", "g", ".1f"),
        *([Column("3 sigma", "g", ".1f")] if random else []), Column("moves", "mm", ".1f"),
        Column("height", "mm", ".0f"), *(_HEADINGS[by] for by in extra),
    ]  # fmt: skip
    cases = list(selection.cases)
    rows: list[Row] = []
    for part in parts:
        used, criterion, case = part.governing
        number = str(cases.index(case) + 1) if case and criterion != STATIC_LOAD else ""
        cells: list[Cell] = [part.name, *([part.placement] if placed else [])]
        cells += [used_mark(_finite(used)), criterion, number]
        cells += [used_mark(_finite(part.used(measure)[0])) for measure in ("static_load", "travel")]
        cells += [part.acceleration, *([part.largest("three_sigma")] if random else [])]
        cells += [part.displacement, selection.figure(part, "height")]
        rows.append([*cells, *(selection.figure(part, by) for by in extra)])
    return Table(
        name, title, columns, rows, shown=most,
        note="Used: of the limit that is the most critical over all load cases. Peak: largest of any body or point. Moves: "
        "largest displacement of a point from its modelled position along x, y or z, as --travel limits it.",
    )  # fmt: skip


def _unjudged(selection: CatalogueSelection) -> Iterator[str]:
    """Yield what was not judged over all simulated parts, and why: no limit, no rating, or vibration that is not stationary."""
    tried = [part for part in selection.tried if not part.reason]
    for measure, criterion in CRITERIA.items():
        if measure == "sigma":
            continue
        missing = [part.name for part in tried if math.isnan(part.used(measure)[0])]
        if missing and len(missing) == len(tried):
            yield f"{criterion}: no limit, not judged"
        elif missing:
            yield f"{criterion}: not rated by the vendor, not judged: {listed(missing)}"
    if selection.room is not None:
        yield "length of the mounts along their bars: not stated, so that the room is judged without it"
    vibrations = [case for case, motion in selection.cases.items() if steady_interval(motion.to_dict())[1] > -math.inf]
    unjudged = [case for case in vibrations if all(math.isnan(part.largest("sigma", case)) for part in tried)]
    if unjudged and not all(math.isnan(part.used("fragility")[0]) for part in tried):
        why = "the base does more than vibrate at random, or not for long enough"
        yield f"{SIGMA} under {listed(unjudged)}: not judged, since {why}"


def _part_label(part: TriedPart) -> str:
    return f"{part.mounts} {part.name}"


def _critical_text(part: TriedPart) -> str:
    """Write the utilisation, criterion and load case of a part's most critical limit."""
    used, criterion, case = part.governing
    under = f" under {case}" if criterion != STATIC_LOAD else ""
    return f"{100.0 * used:.0f} % of {criterion}{under}" if criterion else "nothing judged"


def _finite(value: float) -> float | None:
    return None if math.isnan(value) else value


def selection_content(selection: PartSelection, *, every: bool) -> Content:
    """Compose a selection by the vendors' worksheet; all parts are shown if `every`, the rejected ones with reasons."""
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
    return Content(
        title="Selection of isolators",
        verdict=Statement("headline", text, tone=tone, values=values),
        sections=(
            Section("worksheet", "Worksheet", lambda: (_worksheet_statement(selection.worksheet),), "summary"),
            Section("parts", "Parts", lambda: _worksheet_parts(selection, every), "summary"),
        ),
    )


def _worksheet_statement(sheet: Worksheet) -> Statement:
    """State what the worksheet demands: load on a mount, velocity change, and bounds of stiffness and travel."""
    rows = [f"{sheet.load:.1f} N on each of {sheet.mounts} mounts, {_loading_text(sheet.loading)}"]
    rows.append(f"velocity change {sheet.velocity:.3f} m/s, {_loading_text(sheet.direction)}")
    if sheet.largest_frequency is not None and sheet.largest_vibration_stiffness is not None:
        stiffness = 1e-3 * sheet.largest_vibration_stiffness
        rows.append(
            f"natural frequency at most {sheet.largest_frequency:.2f} Hz ({sheet.disturbance:.4g} Hz / "
            f"{sheet.isolation_ratio:.4g}): vibration stiffness at most {stiffness:.0f} N/mm"
        )
    if sheet.smallest_travel is not None and sheet.largest_shock_stiffness is not None:
        rows.append(
            f"{_in_g(sheet.fragility):.4g} g need at least {1e3 * sheet.smallest_travel:.1f} mm of travel: shock stiffness at "
            f"most {1e-3 * sheet.largest_shock_stiffness:.0f} N/mm"
        )
    if sheet.travel is not None:
        rows.append(f"room for {1e3 * sheet.travel:.4g} mm")
    text = f"Worksheet: {sheet.mass:.6g} kg, g = {sheet.gravity:.6g} m/s^2"
    return Statement("worksheet", text, items=tuple(rows), tone="strong")


def _worksheet_parts(selection: PartSelection, every: bool) -> Iterator[Block]:
    """Yield the parts that meet the worksheet with remarks, and the rejected parts with reasons."""
    if selection.candidates:
        rows: list[Row] = []
        for part in selection.candidates:
            critical = Mark("nothing judged", "quiet") if part.governing is None else str(part.governing.criterion)
            peak = f"{_in_g(part.acceleration):.2f}{'*' if selection.worksheet.amplifies(part.acceleration) else ''}"
            worst = most_used(part.verdicts)
            cells: list[Cell] = [part.part.name, used_mark(part.utilisation("static load")), part.frequency, part.travel]
            cells += [used_mark(part.utilisation("rated travel")), peak, used_mark(worst.utilisation if worst else None)]
            rows.append([*cells, critical])
        columns = [
            *left("part"), Column("load", "%", "z.0f"), Column("f", "Hz", ".2f"), Column("travel", "mm", ".1f"),
            Column("of rated", "%", "z.0f"), Column("peak\n[g]"), Column("used", "%", "z.0f"), *left("most critical"),
        ]  # fmt: skip
        title = f"{several(len(rows), 'part')} meet{'s' if len(rows) == 1 else ''} it"
        note = "Used: of the limit that is the most critical."
        yield Table("candidates", title, columns, rows, note=note, shown=None if every else _FIRST)
        yield Statement("notes", items=tuple(_worksheet_notes(selection)))
    undecided = any(part.undecided for part in selection.rejected)
    if undecided:
        text = "The pulse is far too long to count by its velocity change alone: wirerope select --shock simulates it."
        yield Statement("undecided", text, tone="unjudged")
    if selection.rejected and (every or not selection.candidates):
        unjudged = " or are not judged" if undecided else ""
        ratios = [None if math.isnan(part.margin) else 1.0 / (1.0 + part.margin) for part in selection.rejected]
        yield Table(
            "rejected", f"{several(len(selection.rejected), 'part')} do not meet it{unjudged}",
            (*left("part"), Column("used", "%", "z.0f"), Column("why", align="text")),
            [
                (part.part.name, used_mark(ratio), "; ".join(part.reasons))
                for part, ratio in zip(selection.rejected, ratios, strict=True)
            ],
            shown=None if every else _NEAREST,
        )  # fmt: skip


def _worksheet_notes(selection: PartSelection) -> Iterator[str]:
    """Yield remarks on stiff parts, long pulses, and limits and options that are not judged."""
    sheet = selection.worksheet
    stiff = sum(sheet.amplifies(part.acceleration) for part in selection.candidates)
    if stiff:
        yield (
            f"* by the worksheet {stiff} of them pass on more than the pulse's own peak of {_in_g(sheet.peak):.4g} g: too "
            "stiff to isolate this shock, whatever is used of the limits"
        )
    if sheet.fragility is None:
        yield "without --fragility the part that passes on least, the softest that fits, comes first"
    longest = max(part.impulse for part in selection.candidates)
    if not all(part.impulse_holds for part in selection.candidates):
        yield (
            f"the pulse is long for some parts (natural frequency x length up to {longest:.3f}, the rule holds below "
            f"{IMPULSE:g}): their travel and acceleration are on the safe side"
        )
    elif sheet.shock.duration > 0.0:
        yield f"natural frequency x length of the pulse is below {IMPULSE:g} for each: its velocity change alone counts"
    if any(part.unrated for part in selection.candidates):
        yield "- is not rated by the vendor: not judged; those parts come last"
    options = ((sheet.fragility, "--fragility"), (sheet.travel, "--travel"), (sheet.disturbance, "--disturbance-rpm"))
    yield from (f"{option} is not given: not judged" for value, option in options if value is None)
    yield (
        f"every command takes a part by its name: wirerope isolators {selection.candidates[0].part.name}, or in the column "
        "isolator of a table of mounts for wirerope new"
    )
    yield "closed formulas of a guided mass: wirerope select simulates every part at the positions of the mounts"


def _in_g(value: float | None) -> float:
    return math.nan if value is None else value / WORKSHEET_GRAVITY


def _loading_text(mode: str) -> str:
    return "in shear or roll" if mode == "shear" else mode_text(mode)
