"""Loads on the deck: sums of the mounts' forces, area by area, and the loads of their bolts."""

from collections.abc import Iterator, Sequence

from wirerope_mj.assessment.criteria.foundation import AreaForce, area_forces, bolt_loads, standing
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.model import mounts_and_stops
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.foundation.tables import Column, Table

_MOST = 10  # bolts that are shown at once


def deck_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield the forces on the deck, all and on each area that the model names, and those on bolts."""
    if not run.response.scene.mounts:
        return
    areas = area_forces(run.response)
    yield _areas(areas) if len(areas) > 1 else _sentence(run, areas[0])
    bolts = _bolts(run)
    if bolts.rows:
        yield bolts


def _sentence(run: JudgedRun, whole: AreaForce) -> Statement:
    sizes = [
        f"{with_unit(force, 'kN', digits=3)} {where} at {time:.4f} s"
        for force, where, time in (
            (whole.down, "downwards", whole.down_time), (whole.up, "upwards", whole.up_time),
            (whole.across, "horizontally", whole.across_time),
        )
    ]  # fmt: skip
    count = mounts_and_stops(standing(run.response.scene))
    text = (
        f"All {count} that stand on it together, weight included: {with_unit(whole.at_rest, 'kN', digits=3)} at the beginning; "
        f"at most {', '.join(sizes)}. Contacts of geoms are not among them."
    )
    return Statement(id="deck", text=text)


def _areas(areas: Sequence[AreaForce]) -> Table:
    columns = (
        Column("mounts on", align="left"), Column("mounts\nand stops", form="d"), Column("at rest", "kN", 3),
        Column("down", "kN", 3), Column("at", "s", "z.4f"), Column("up", "kN", 3), Column("at", "s", "z.4f"),
        Column("horizontally", "kN", 3), Column("at", "s", "z.4f"),
    )  # fmt: skip
    rows = [
        (one.name or "the whole deck", one.mounts, one.at_rest, one.down, one.down_time, one.up, one.up_time, one.across,
         one.across_time)
        for one in areas
    ]  # fmt: skip
    return Table(
        id="deck",
        title="Sums of the mounts' forces on what carries them",
        columns=columns,
        rows=rows,
        note="At the samples, weight included, in the world's axes: downwards, upwards where the mounts pull, horizontally. "
        "Contacts of geoms are not among them.",
    )


def _bolts(run: JudgedRun) -> Table:
    columns = (
        Column("mount", align="left"), Column("bolts", form="d"), Column("tension of one", "kN", 3), Column("at", "s", "z.4f"),
        Column("shear of one", "kN", 3), Column("at", "s", "z.4f"),
    )  # fmt: skip
    rows = [
        (one.mount, one.bolts, one.tension, one.tension_time, one.shear, one.shear_time)
        for one in bolt_loads(run.response)
    ]
    return Table(
        id="bolts",
        title="Largest loads of a bolt on the base side",
        columns=columns,
        rows=rows,
        note="A rigid plate, the force across acting at half the isolator's height; without prying and preload.",
        shown=_MOST,
    )
