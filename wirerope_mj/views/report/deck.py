"""The part of a report about what the deck bears: sums of the mounts' forces, area by area, and the loads of their bolts."""

from collections.abc import Sequence

from wirerope_mj.assessment.criteria.foundation import AreaForce, area_forces, bolt_loads
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.views.display import with_unit
from wirerope_mj.views.report.content import Block, Folded, Paragraph, Section
from wirerope_mj.views.report.run import FinishedRun

_MOST = 10  # bolts that are shown at once


def deck_section(run: FinishedRun) -> Section:
    """Return the forces on the deck, all and on each area that the model names, and those on bolts."""
    title = "What the deck bears"
    if not run.response.scene.mounts:
        return Section(title=title, blocks=())
    areas = area_forces(run.response)
    blocks: list[Block] = [_areas(areas)] if len(areas) > 1 else [Paragraph(text=_sentence(areas[0]))]
    bolts = _bolts(run)
    if bolts.rows:
        blocks.append(Folded(table=bolts, shown=_MOST))
    return Section(title=title, blocks=tuple(blocks))


def _sentence(whole: AreaForce) -> str:
    sizes = [
        f"{with_unit(force, 'kN', digits=3)} {where} at {time:.4f} s"
        for force, where, time in (
            (whole.down, "downwards", whole.down_time), (whole.up, "upwards", whole.up_time),
            (whole.across, "level", whole.across_time),
        )
    ]  # fmt: skip
    return (
        f"All {whole.mounts} mounts that stand on it together, weight included: {with_unit(whole.at_rest, 'kN', digits=3)} at "
        f"the beginning; at most {', '.join(sizes)}. Contacts of geoms are not among them."
    )


def _areas(areas: Sequence[AreaForce]) -> Table:
    columns = (
        Column("mounts on", align="left"), Column("mounts", form="d"), Column("at rest", "kN", 3),
        Column("down", "kN", 3), Column("at", "s", "z.4f"), Column("up", "kN", 3), Column("at", "s", "z.4f"),
        Column("level", "kN", 3), Column("at", "s", "z.4f"),
    )  # fmt: skip
    rows = [
        (one.name or "the whole deck", one.mounts, one.at_rest, one.down, one.down_time, one.up, one.up_time, one.across,
         one.across_time)
        for one in areas
    ]  # fmt: skip
    return Table(
        title="Sums of the mounts' forces on what carries them",
        columns=columns,
        rows=rows,
        note="At the samples, weight included, in the world's axes: downwards, upwards (where the mounts pull), and level. "
        "Contacts of geoms are not among them.",
    )


def _bolts(run: FinishedRun) -> Table:
    columns = (
        Column("mount", align="left"), Column("bolts", form="d"), Column("tension of one", "kN", 3), Column("at", "s", "z.4f"),
        Column("shear of one", "kN", 3), Column("at", "s", "z.4f"),
    )  # fmt: skip
    rows = [
        (one.mount, one.bolts, one.tension, one.tension_time, one.shear, one.shear_time)
        for one in bolt_loads(run.response)
    ]
    return Table(
        title="Largest loads of a bolt on the base side",
        columns=columns,
        rows=rows,
        note="A rigid plate, the force across acting at half the isolator's height; without prying and preload.",
    )
