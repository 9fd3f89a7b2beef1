"""The part of a report about stops and other contacts."""

from wirerope_mj.assessment.criteria import contact_lines, contact_verdicts
from wirerope_mj.foundation.tables import Column, Mark, Table
from wirerope_mj.views.contact_histories import touching
from wirerope_mj.views.plots.report_response import contacts_chart
from wirerope_mj.views.report.content import Block, Paragraph, Picture, Section
from wirerope_mj.views.report.run import FinishedRun
from wirerope_mj.views.verdict_table import TONE

_COLUMNS = (
    Column("stop or pair", align="left"), Column("verdict", align="left"), Column("first touch", "s", "z.4f"),
    Column("touches", form="d"), Column("in all", "ms", "z.1f"), Column("peak force", "kN"), Column("at", "s", "z.4f"),
    Column("depth", "mm", "z.2f"), Column("energy", "J", "z.2f"),
)  # fmt: skip


def contacts_section(run: FinishedRun) -> Section:
    """Return contacts of every pair of geoms that may touch and of every stop; without blocks where there are none."""
    title = "Stops and contacts"
    contacts = run.response.peaks.contacts
    if contacts is None:
        absent = "Contacts were not recorded: the run was made by an older version."
        return Section(title=title, blocks=(Paragraph(text=absent, tone="unjudged"),))
    if not contacts:
        return Section(title=title, blocks=())
    tone = "exceeded" if run.response.peaks.struck else ""
    blocks: list[Block] = [Paragraph(text=line, tone=tone) for line in contact_lines(run.response)]
    if any(contact.touches for contact in contacts.values()):
        blocks += [*_picture(run), _table(run)]
    return Section(title=title, blocks=tuple(blocks))


def _picture(run: FinishedRun) -> list[Picture]:
    """Return the histories of what pressed hardest; nothing where none is known."""
    found = touching(run.response)
    if not found:
        return []
    gaps = " Below them the gaps: below zero the two overlap." if any(one.gap is not None for one in found) else ""
    return [
        Picture(
            image=contacts_chart(found, run.response.time, run.selection.window),
            caption=f"Forces of what presses hardest, at the samples.{gaps}",
            alt="Forces of stops and contacts over time, and their gaps.",
        )
    ]


def _table(run: FinishedRun) -> Table:
    contacts = run.response.peaks.contacts or {}
    rows = []
    for verdict in contact_verdicts(run.response):
        contact = contacts[verdict.subject]
        names = contact.called(verdict.subject), Mark(verdict.verdict, TONE[verdict.verdict])
        touches = contact.first_touch, contact.touches, contact.duration
        rows.append((*names, *touches, contact.force, contact.force_time, contact.penetration, contact.energy))
    return Table(
        title="Pairs that the model declares, others that touched, and the stops of mounts",
        columns=_COLUMNS,
        rows=rows,
        note="Forces are normal forces of all contact points of a pair together, at steps. Depth: how far the two overlap "
        "when pressed, as the model's stiffness of the contact has it; of a mount's stop how far it is pressed beyond its gap. "
        "Energy: what it took up, which the motion has lost once it is open again.",
    )
