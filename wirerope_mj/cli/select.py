"""`wirerope select`: the catalogue parts that meet a worksheet, and what a simulation says of the best of them."""

import math
import sys
from collections.abc import Mapping

from wirerope_mj.assessment.selection import (
    PartSelection,
    SimulatedShock,
    Worksheet,
    mode_text,
    simulate_candidate,
)
from wirerope_mj.assessment.selection.worksheet import IMPULSE, WORKSHEET_GRAVITY
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.views.terminal import console, print_lines, print_table

NOTHING_FOUND = 1
"""Exit code if no part meets the worksheet."""

_FIRST, _NEAREST = 12, 5
"""Candidates shown unless all are asked for; parts shown with their reasons if none does."""


def select_command(selection: PartSelection, *, rejected: bool, best: int) -> int:
    """Print a selection, and the simulation of its best candidates; return the exit code."""
    simulated, failures = _simulate(selection, best)
    screen = console()
    _print_worksheet(selection.worksheet)
    undecided = sum(part.undecided for part in selection.rejected)
    if selection.candidates:
        print_table(_candidates(selection, simulated, None if rejected else _FIRST))
        _print_notes(selection, simulated, failures)
    elif not undecided:
        screen.print("\n  [bold red]No part of the tables meets it.[/]")
    if undecided:
        screen.print(
            f"\n  [bold]{undecided} parts are not judged[/]: the pulse is far too long to count by its velocity change alone. "
            "Simulate it, in a scenario of its own: wirerope run.",
            soft_wrap=True,
        )
    if selection.rejected and (rejected or not selection.candidates):
        print_table(_rejected(selection, None if rejected else _NEAREST))
    elif selection.rejected:
        rest = len(selection.rejected) - undecided
        screen.print(f"  {rest} parts do not meet it; --all shows every part and says why.")
    return 0 if selection.candidates else NOTHING_FOUND


def _simulate(selection: PartSelection, best: int) -> tuple[dict[str, SimulatedShock], dict[str, str]]:
    """Return the simulated candidates by name, and why others could not be simulated."""
    simulated, failures = {}, {}
    for candidate in selection.candidates[:best]:
        name = candidate.part.name
        if sys.stderr.isatty():
            print(plain(f"simulating {name} .."), file=sys.stderr, flush=True)
        try:
            simulated[name] = simulate_candidate(candidate, selection.worksheet)
        except WireRopeError as error:
            failures[name] = str(error)
    return simulated, failures


def _print_worksheet(sheet: Worksheet) -> None:
    """Print what the mounts must be like."""
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
    screen = console()
    screen.print(f"[bold]Worksheet[/]  {sheet.mass:.6g} kg, g = {sheet.gravity:.6g} m/s^2")
    print_lines(rows)


def _candidates(selection: PartSelection, simulated: Mapping[str, SimulatedShock], most: int | None) -> Table:
    """Return the table of candidates in their order."""
    of = "" if most is None or len(selection.candidates) <= most else f", the first {most}"
    columns = [
        Column("part", align="left"), Column("load", "%", ".0f"), Column("f", "Hz", ".2f"), *_response("travel", "peak"),
        Column("governs", align="left"), *(_response("simul.", "simul.") if simulated else []),
    ]  # fmt: skip
    rows: list[Row] = []
    for one in selection.candidates[:most]:
        governing = Mark("nothing judged", "quiet") if one.governing is None else one.governing.criterion
        mark = "*" if selection.worksheet.amplifies(one.acceleration) else ""
        peak = f"{_g(one.acceleration):.2f}{mark}"
        cells: list[Cell] = [one.part.name, _used(one.utilisation("static load")), one.frequency, one.travel]
        cells += [_used(one.utilisation("rated travel")), peak, _margin(one.margin), governing]
        rows.append([*cells, *(_simulated_cells(simulated.get(one.part.name)) if simulated else [])])
    return Table(title=f"{len(selection.candidates)} parts meet it{of}", columns=columns, rows=rows)


def _response(travel: str, peak: str) -> list[Column]:
    return [
        Column(travel, "mm", ".1f"), Column("of rated", "%", ".0f"), Column(f"{peak}\n[g]"), Column("margin", "%", "+.0f"),
    ]  # fmt: skip


def _simulated_cells(run: SimulatedShock | None) -> list[Cell]:
    if run is None:
        return [""] * 4
    return [run.travel, _used(run.travel_utilisation), f"{_g(run.acceleration):.2f}", _margin(run.margin)]


def _rejected(selection: PartSelection, most: int | None) -> Table:
    """Return the table of parts that do not meet the worksheet, nearest first."""
    shown = selection.rejected[:most]
    of = "" if len(shown) == len(selection.rejected) else f", the nearest {len(shown)}"
    undecided = " or are not judged" if any(part.undecided for part in selection.rejected) else ""
    return Table(
        title=f"{len(selection.rejected)} parts do not meet it{undecided}{of}",
        columns=(Column("part", align="left"), Column("margin", "%", "+.0f"), Column("why", align="text")),
        rows=[[part.part.name, _margin(part.margin), "; ".join(part.reasons)] for part in shown],
    )


def _print_notes(
    selection: PartSelection, simulated: Mapping[str, SimulatedShock], failures: Mapping[str, str]
) -> None:
    """Print what the table rests on."""
    sheet = selection.worksheet
    notes = [f"{name} is not simulated: {reason}" for name, reason in failures.items()]
    stiff = sum(sheet.amplifies(one.acceleration) for one in selection.candidates)
    if stiff:
        notes.append(
            f"* by the worksheet {stiff} of them pass on more than the pulse's own peak of {_g(sheet.peak):.4g} g: too stiff "
            "to isolate this shock, whatever the margin"
        )
    if sheet.fragility is None:
        notes.append("without --fragility the part that passes on least, the softest that fits, comes first")
    longest = max(one.impulse for one in selection.candidates)
    if not all(one.impulse_holds for one in selection.candidates):
        notes.append(
            f"the pulse is long for some parts (natural frequency x length up to {longest:.3f}, the rule holds below "
            f"{IMPULSE:g}): their travel and acceleration are on the safe side"
        )
    elif sheet.shock.duration > 0.0:
        notes.append(
            f"natural frequency x length of the pulse is below {IMPULSE:g} for each: its velocity change alone counts"
        )
    if any(one.unrated for one in selection.candidates):
        notes.append("- is not rated by the vendor: not judged; those parts come last")
    for value, option in (
        (sheet.fragility, "--fragility"),
        (sheet.travel, "--travel"),
        (sheet.disturbance, "--disturbance-rpm"),
    ):
        if value is None:
            notes.append(f"{option} is not given: not judged")
    notes.append(
        f"every command takes a part by its name: wirerope isolators {selection.candidates[0].part.name}, or in the column "
        "isolator of a table of mounts for wirerope new"
    )
    if simulated and "45" in (sheet.loading, sheet.direction):
        notes.append(
            "fitted along the axes alone, the parts are 40 to 60 % stiffer at 45 degrees than the vendor states for shock"
        )
    if simulated:
        notes.append(
            "simulated: the isolator file of a part, else one fitted from its row with tension and damping as assumed for the "
            "catalogue; first swing and rebound; travel from the settled position, its utilisation from the unloaded position, "
            "sag included"
        )
    print_lines(notes)


def _margin(value: float) -> Mark:
    return Mark(value, "exceeded" if value < 0.0 else "" if math.isfinite(value) else "quiet")


def _used(utilisation: float | None) -> Mark:
    return Mark(utilisation, "quiet" if utilisation is None else "")


def _g(value: float | None) -> float:
    return math.nan if value is None else value / WORKSHEET_GRAVITY


def _loading(mode: str) -> str:
    """Return a mode as the worksheet is printed."""
    return "in shear or roll" if mode == "shear" else mode_text(mode)
