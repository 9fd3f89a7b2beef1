"""The part of a report about stops and other contacts."""

from wirerope_mj.assessment.criteria import contact_lines, contact_verdicts
from wirerope_mj.views.report.content import Block, Mark, Paragraph, Section, Table
from wirerope_mj.views.report.display import ABSENT, fixed, shown
from wirerope_mj.views.report.judged import TONE
from wirerope_mj.views.report.run import FinishedRun


def contacts_section(run: FinishedRun) -> Section:
    """Return what became of every pair of geoms that may touch and of every stop; without blocks where there are none."""
    title = "Stops and contacts"
    contacts = run.response.peaks.contacts
    if contacts is None:
        absent = "Contacts were not recorded: the run was made by an older version."
        return Section(title=title, blocks=(Paragraph(text=absent, tone="unjudged"),))
    if not contacts:
        return Section(title=title, blocks=())
    tone = "exceeded" if run.response.peaks.struck else ""
    blocks: list[Block] = [Paragraph(text=line, tone=tone) for line in contact_lines(run.response)]
    return Section(title=title, blocks=(*blocks, _table(run)))


def _table(run: FinishedRun) -> Table:
    contacts = run.response.peaks.contacts or {}
    rows = []
    for verdict in contact_verdicts(run.response):
        contact = contacts[verdict.subject]
        times = [ABSENT if t is None else fixed(t, 4) for t in (contact.first_touch, contact.force_time)]
        rows.append(
            (
                contact.called(verdict.subject),
                Mark(content=verdict.verdict, tone=TONE[verdict.verdict]),
                times[0],
                str(contact.touches),
                fixed(1e3 * contact.duration, 1),
                shown(contact.force, "N"),
                times[1],
                fixed(1e3 * contact.penetration, 2),
            )
        )
    return Table(
        caption="Pairs that the model declares, others that touched, and the stops of mounts",
        head=(
            "stop or pair",
            "verdict",
            "first touch [s]",
            "touches",
            "in all [ms]",
            "peak force [kN]",
            "at [s]",
            "depth [mm]",
        ),
        align="llrrrrrr",
        rows=tuple(rows),
        note="Forces are normal forces of all contact points of a pair together, at steps. Depth: how far the two overlap "
        "when pressed, as the model's stiffness of the contact has it; of a mount's stop how far it is pressed beyond its gap.",
    )
