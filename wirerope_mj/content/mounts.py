"""Blocks on the mounts in motion: peaks against ratings, histories, loops, contacts, and the events of the run."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.criteria import (
    COMBINED,
    EXCEEDED,
    NOT_JUDGED,
    WITHIN,
    contact_verdicts,
    mount_peaks,
)
from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.blocks import Block, Chart, Curve, Panel, Statement, short, stacked, with_room
from wirerope_mj.content.events import events_of
from wirerope_mj.content.histories import Line, contact_panels, history_panel, used_panel
from wirerope_mj.content.judged_run import JudgedRun, RunResult
from wirerope_mj.content.numbers import listed
from wirerope_mj.content.selection import MOST_CURVES, Selection, kind_of
from wirerope_mj.content.verdicts import TONE, used_mark
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left
from wirerope_mj.foundation.units import force_unit, in_unit
from wirerope_mj.mounts.isolator import AXES

_LONG_RUN = 10_000  # samples from which loops are drawn around the largest deflection only
_LOOP_SAMPLES = 300  # samples that are drawn before and after it
_ROUNDING = 1e-9  # of the largest force, below which an axis carries none
_SENSES = ("compr.", "tension", "shear", "roll")
# Columns of a mount's extremes by sense
EXTREMES = (
    *left("mount"), *(Column(head, "mm", "z.1f") for head in _SENSES),
    *(Column(head, "kN", "z.2f") for head in _SENSES),
)  # fmt: skip


def mount_blocks(run: RunResult) -> Iterator[Block | None]:
    """Tabulate extremes of every mount by sense (compression, tension, shear, roll), and its utilisation of the ratings."""
    order = [*by_use(run.verdicts), *(mount.name for mount in run.response.scene.mounts)]
    peaks = sorted(mount_peaks(run.response), key=lambda row: order.index(row.name))
    combined = {row.subject: row for row in run.verdicts if row.criterion == COMBINED}
    rated = any(row.utilisation is not None for row in peaks)
    marked = False
    rows: list[Row] = []
    for row in peaks:
        force, all_axes = run.response.peaks.mounts[row.name].force, combined.get(row.name)
        known = run.validity.get(row.name)
        outside = known and known.outside(np.asarray(row.minimum), np.asarray(row.maximum), small=False)
        marked |= bool(outside)
        cells: list[Cell] = [f"{row.name} *" if outside else row.name]
        cells += [min(row.minimum[2], 0.0), max(row.maximum[2], 0.0)]
        cells += [max(row.maximum[axis], -row.minimum[axis]) for axis in (1, 0)]
        cells += [min(float(force.minimum[2]), 0.0), max(float(force.maximum[2]), 0.0)]
        cells += [abs(row.force[axis]) for axis in (1, 0)]
        if rated:
            cells += [used_mark(row.utilisation), row.governing or "-"]
            cells += [used_mark(all_axes.utilisation if all_axes else None)] if combined else []
        exceeded = row.exceeded or (all_axes is not None and all_axes.verdict == EXCEEDED)
        verdict = EXCEEDED if exceeded else WITHIN if row.governing else NOT_JUDGED
        text = f"{verdict}: {row.one_way}" if verdict == NOT_JUDGED and row.one_way else verdict
        rows.append([*cells, Mark(text, TONE[verdict])])
    if not rows:
        return
    columns = [*EXTREMES, *([Column("travel used", "%", "z.0f"), *left("in")] if rated else [])]
    columns += [Column("combined", "%", "z.0f")] if rated and combined else []
    note = "Compression negative, tension positive; shear and roll by size. The most critical mount stands first."
    if marked:
        note += " *: outside the cycles that the isolator was identified from, so that its forces are extrapolated."
    yield Table("mounts", "Peaks of the mounts", [*columns, *left("verdict")], rows, note=note)


def mount_history_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield histories of utilisation, deflection and force, loops of the mount nearest to its limits, and events of the run."""
    rows, selection = mount_peaks(run.response), run.selection
    if not rows:
        return
    names = [used.subject for used in selection.used if used.subject in selection.mounts][:MOST_CURVES]
    order = "that use most of their limits" if names else "in the order of the model"
    names = names or [row.name for row in rows[:MOST_CURVES]]
    if selection.used:
        yield Chart(
            id="used", rows=[[replace(used_panel(run.response, selection), title="", xlabel="time [s]")]], height=190.0,
            caption="What is used of the limits over time, the largest of all criteria of each mount, body or point.",
            alt="Utilisation of limits over time.",
        )  # fmt: skip
    yield _histories_chart("deflection", run.response, names, selection, order)
    yield _histories_chart("force", run.response, names, selection, order)
    yield _loops_chart(run.response, names[0], selection)
    # the few events that tell the course first, the others folded away
    if events := sorted(events_of(run.response, selection), key=lambda event: not event.main):
        yield Table(
            "course", "The course of the run, and below it all other peaks and limits that are passed",
            (Column("at", "s", "z.4f"), Column("event", align="text")),
            [(event.time, Mark(event.text, "exceeded" if event.level == "ERROR" else "")) for event in events],
            shown=max(sum(event.main for event in events), 1),
        )  # fmt: skip


def _histories_chart(quantity: str, response: Response, names: Sequence[str], selection: Selection, order: str) -> Chart:
    lines = [Line(response=response, subject=name, name=name, kind=kind_of(selection, name)) for name in names[:MOST_CURVES]]
    return replace(
        stacked([history_panel(quantity, axis, lines, selection.window) for axis in AXES]),
        id=f"{quantity}s",
        caption=f"{quantity.capitalize()}s of the mounts {order}: {listed(list(names))}. Axial is positive in tension.",
        alt=f"Histories of the {quantity}s of {listed(list(names))} along roll, shear and axial.",
    )


def _loops_chart(response: Response, name: str, selection: Selection) -> Chart:
    """Draw loops of a mount along its loaded axes; of a long run those around the largest deflection."""
    rows = slice(None)
    if response.time.size > _LONG_RUN:
        middle = int(np.searchsorted(response.time, response.peaks.mounts[name].deflection.time))
        rows = slice(max(middle - _LOOP_SAMPLES, 0), middle + _LOOP_SAMPLES)
    deflection, force = (
        np.stack([response.column(f"mounts/{name}/{part}/{axis}")[rows] for axis in AXES], axis=1)
        for part in ("deflection", "force")
    )
    unit = force_unit(float(np.abs(force).max()))
    largest = np.abs(force).max(axis=0)
    axes = np.flatnonzero(largest > _ROUNDING * largest.max()).tolist() or [AXES.index("axial")]
    row = []
    for axis in axes:
        x, y = in_unit(deflection[:, axis], "mm"), in_unit(force[:, axis], unit)
        row.append(Panel(
            [Curve(x, y, name=short(name), kind=kind_of(selection, name))],
            f"force [{unit}]" if axis == axes[0] else "", xlabel="deflection [mm]", title=AXES[axis],
            dots=[(float(x[0]), float(y[0]))], xlim=with_room(x), unit=unit, xunit="mm",
        ))  # fmt: skip
    isolator = next(mount.isolator for mount in response.scene.mounts if mount.name == name)
    time = response.time[rows]
    interval = "" if rows == slice(None) else f" from {time[0]:.5g} to {time[-1]:.5g} s"
    return Chart(
        id="loops", rows=[row], height=190.0,
        caption=f"Force over deflection of {name} ({isolator}){interval}; the dot is where it begins.",
        alt=f"Loops of {name}.",
    )  # fmt: skip


_CONTACT_COLUMNS = (
    Column("stop or pair", align="text"), Column("first touch", "s", "z.4f"), Column("touches", form="d"),
    Column("in all", "ms", "z.1f"), Column("closing\nspeed", "m/s", 3), Column("peak force", "kN", "z.2f"),
    Column("at", "s", "z.4f"), Column("depth", "mm", "z.2f"), Column("energy", "J", "z.2f"), *left("verdict"),
)  # fmt: skip


def contact_blocks(run: RunResult) -> Iterator[Block]:
    """Tabulate the stops and contact pairs that touched, with force, depth and energy."""
    contacts = run.response.peaks.contacts
    if contacts is None:
        yield Statement("contacts", "Contacts were not recorded: the run was made by an older version.", tone="unjudged")
        return
    rows = []
    for verdict in contact_verdicts(run.response):
        contact = contacts[verdict.subject]
        if contact.touches:
            touches = contact.first_touch, contact.touches, contact.duration
            sizes = contact.closing_speed, contact.force, contact.force_time, contact.penetration, contact.energy
            judged = Mark(verdict.verdict, TONE[verdict.verdict])
            rows.append((contact.called(verdict.subject), *touches, *sizes, judged))
    untouched = f" {len(contacts) - len(rows)} others never touched." if len(contacts) > len(rows) else ""
    if rows:
        yield Table(
            "contacts", "Stops and contacts that touched", _CONTACT_COLUMNS, rows,
            note="Normal forces of all contact points of a pair together, at steps. Depth: overlap when pressed, as the "
            "model's stiffness of the contact has it; of a mount's stop the travel beyond its gap. Closing speed: the largest "
            "at which a mount's stop is pressed, that of the touch among them. Energy: what it took up, "
            f"which the motion has lost once it is open again.{untouched}",
        )  # fmt: skip


def contact_history_blocks(run: JudgedRun) -> Iterator[Block]:
    panels = contact_panels(run.response, run.selection.window)
    if panels:
        below = " Below them the gaps: below zero the two overlap." if len(panels) > 1 else ""
        yield replace(
            stacked(panels), id="contact-forces", caption=f"Forces of what presses hardest, at the samples.{below}",
            alt="Forces of stops and contacts over time, and their gaps.",
        )  # fmt: skip
