"""Stops and other contacts: what was struck when, how often and how hard, and its histories."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.criteria import contact_verdicts
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun, RunResult
from wirerope_mj.content.panels import Curve, Panel, short, stacked
from wirerope_mj.content.selection import or_other
from wirerope_mj.content.verdicts import TONE
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.peaks import ContactPeak
from wirerope_mj.foundation.tables import Column, Mark, Table
from wirerope_mj.foundation.units import in_unit

_COLUMNS = (
    Column("stop or pair", align="text"), Column("first touch", "s", "z.4f"), Column("touches", form="d"),
    Column("in all", "ms", "z.1f"), Column("peak force", "kN", "z.2f"), Column("at", "s", "z.4f"),
    Column("depth", "mm", "z.2f"), Column("energy", "J", "z.2f"), Column("verdict", align="left"),
)  # fmt: skip


def contact_blocks(run: RunResult) -> Iterator[Block]:
    """Yield what touched of the pairs of geoms that may touch and of the stops."""
    contacts = run.response.peaks.contacts
    if contacts is None:
        text = "Contacts were not recorded: the run was made by an older version."
        yield Statement(id="contacts", text=text, tone="unjudged")
    elif any(contact.touches for contact in contacts.values()):
        yield _table(run, contacts)


def contact_history_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield forces and gaps over time of what pressed hardest."""
    panels = contact_panels(run.response, run.selection.window)
    if panels:
        below = " Below them the gaps: below zero the two overlap." if len(panels) > 1 else ""
        yield replace(
            stacked(panels), id="contact-forces", caption=f"Forces of what presses hardest, at the samples.{below}",
            alt="Forces of stops and contacts over time, and their gaps.",
        )  # fmt: skip


def _table(run: RunResult, contacts: Mapping[str, ContactPeak]) -> Table:
    rows = []
    for verdict in contact_verdicts(run.response):
        contact = contacts[verdict.subject]
        if contact.touches:
            touches = contact.first_touch, contact.touches, contact.duration
            sizes = contact.force, contact.force_time, contact.penetration, contact.energy
            judged = Mark(verdict.verdict, TONE[verdict.verdict])
            rows.append((contact.called(verdict.subject), *touches, *sizes, judged))
    untouched = len(contacts) - len(rows)
    return Table(
        id="contacts", title="Stops and contacts that touched", columns=_COLUMNS, rows=rows,
        note="Normal forces of all contact points of a pair together, at steps. Depth: overlap when pressed, as the model's "
        "stiffness of the contact has it; of a mount's stop the travel beyond its gap. Energy: what it took up, which the "
        f"motion has lost once it is open again.{f' {untouched} others never touched.' if untouched else ''}",
    )  # fmt: skip


def contact_panels(response: Response, window: tuple[float, float]) -> list[Panel]:
    """Draw the forces of what touched over time, the largest first, and the gaps of what declares them."""
    alone, known, forces, gaps = {stop.name for stop in response.scene.stops}, response.contacts, [], []
    # Pairs that the model does not declare have peaks alone, and so have stops that act beside other laws of their mount.
    touched = {name: one for name, one in (response.peaks.contacts or {}).items() if one.touches}
    struck = {name: one for name, one in touched.items() if name in known or one.mount in alone}
    for rank, (called, one) in enumerate(sorted(struck.items(), key=lambda item: item[1].force, reverse=True)):
        name, kind = or_other(short(called if called in known else one.called(called)), rank, rank, len(struck))
        force = known[called].force if called in known else np.linalg.norm(response.mounts[one.mount].force, axis=1)
        marked = None if one.force_time is None else (one.force_time, in_unit(one.force, "kN"))
        forces.append(Curve(x=response.time, y=in_unit(force, "kN"), name=name, kind=kind, peak=marked))
        if called in known:
            gaps.append(Curve(x=response.time, y=in_unit(known[called].gap, "mm"), name=name, kind=kind))
    parts = (
        (forces, "force", "Force of stops and contacts [kN]", "kN"),
        (gaps, "gap", "Gap of contacts [mm], below zero pressed", "mm"),
    )
    return [
        Panel(curves=curves, ylabel=f"{what} [{unit}]", title=title, xlim=window, unit=unit)
        for curves, what, title, unit in parts
        if curves
    ]
