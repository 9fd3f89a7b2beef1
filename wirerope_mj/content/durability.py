"""Cycles of the mounts of a run or a service life, the damage that they do, and what is damaged most."""

from collections.abc import Sequence

from wirerope_mj.assessment.durability.cycles import EquivalentVibration
from wirerope_mj.assessment.durability.mission import Mission, MountDamage
from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.foundation.tables import Column, Row, Table

_FEW = 12  # rows of a density that are shown at once


def durability_content(mission: Mission, damages: Sequence[MountDamage], *, rows: int) -> Content:
    """Describe the damage of a service life, the largest first: what is damaged most, how long it lasts, a table of `rows`."""
    names = " + ".join(
        f"{one.hours:g} h of {one.run.name}" if one.repetitions is None else f"{one.repetitions:g} x {one.run.name}"
        for one in mission.stages
    )
    worst = _worst(mission, damages)
    return Content(
        title=f"Durability: {names}",
        verdict=worst,
        sections=(Section("durability", "", lambda: [_table(mission, damages, rows), worst], "summary"),),
    )


def equivalent_content(found: EquivalentVibration) -> Content:
    """Describe the random vibration that does the damage of a history: its rms value, and its density."""
    (least_at, least), (most_at, most) = found.extremes
    rise, fall = found.ramps
    played = (
        f"in the least damaging of {found.playings} playings, each with phases of its own" if found.playings
        else "in the mean of many playings"
    )  # fmt: skip
    text = (
        f"{with_unit(found.rms, 'm/s^2')} rms for {with_unit(found.duration, 's')}, with a rise of {with_unit(rise, 's')} and "
        f"a fall of {with_unit(fall, 's')} in it, along {found.along} do the damage that the "
        f"run does at {found.subject}, to oscillators of Q = {found.q:g} with the exponent {found.exponent:g}: "
        f"at least {least:#.3g} times that of the run, at {least_at:.3g} Hz, and at most {most:#.3g} times, at {most_at:.3g} "
        f"Hz, on {len(found.damage)} lines from {found.points[0][0]:.4g} to {found.points[-1][0]:.4g} Hz, {played}."
    )
    verdict = Statement(
        id="equivalent", text=text,
        values={
            "rms_m_s2": found.rms, "duration_s": found.duration, "least_damage": least, "least_damage_hz": least_at,
            "most_damage": most, "most_damage_hz": most_at, "rise_s": rise, "fall_s": fall, "playings": found.playings,
        },
    )  # fmt: skip
    table = Table(
        id="equivalent-psd", title="Power spectral density, straight on logarithmic axes", rows=found.points, shown=_FEW,
        columns=(Column("frequency", "Hz", ".4g"), Column("density", "g²/Hz", ".4g")),
    )  # fmt: skip
    return Content(
        title=f"Vibration in place of the run at {found.subject}", verdict=verdict,
        sections=(Section("equivalent", "", lambda: [verdict, table], "summary"),),
    )  # fmt: skip


def _worst(mission: Mission, damages: Sequence[MountDamage]) -> Statement:
    """Return what is damaged most, and how often it lasts where the fatigue curve has a constant."""
    worst = damages[0] if damages else None
    if worst is None or not worst.total:
        return Statement(id="most-damaged", text="Nothing is damaged: no cycle was counted.", values={"damage": 0.0})
    text = f"Most damaged: {_called(worst)}"
    if mission.constant is None:
        text += ". Its life is not known: damage is relative, because no constant of the fatigue curve was given."
        return Statement(id="most-damaged", text=text, tone="unjudged", values={"where": _called(worst)})
    life = 1.0 / worst.total
    text += f": damage {worst.total:.3g} in one such life; it lasts {life:.3g} such lives."
    values: dict[str, float | str | None] = {"where": _called(worst), "damage": worst.total, "lives": life}
    return Statement(id="most-damaged", text=text, tone="exceeded" if worst.total > 1.0 else "within", values=values)


def _table(mission: Mission, damages: Sequence[MountDamage], most: int) -> Table:
    unit = "mm" if mission.quantity == "deflection" else "kN"
    worst = damages[0] if damages else None
    known, several = mission.constant is not None, len(mission.stages) > 1
    rows: list[Row] = []
    for one in damages[:most]:
        mean = one.total * (mission.constant or 1.0) / one.cycles if one.cycles else 0.0
        relative = one.total / worst.total if worst and worst.total else None
        amount = (one.total, 1.0 / one.total if one.total else None) if known else ()
        stages = [part / one.total if one.total else None for part in one.stages] if several else []
        amplitude = mean ** (1.0 / mission.exponent)
        rows.append((one.mount, one.axis, one.cycles, one.largest_range, amplitude, *amount, relative, *stages))
    note = f"Rainflow cycles of the {mission.quantity} (ASTM E1049), open ones as halves; exponent {mission.exponent:g}; "
    note += f"{len(damages)} mounts and axes counted. Equivalent amplitude: of as many equal cycles that do the same damage."
    if any(stage.hours is not None for stage in mission.stages):
        note += " Hours are of steady vibration: without rise, fall and what follows."
    columns = (
        Column("mount", align="left"), Column("axis", align="left"), Column("cycles", form=".6g"),
        Column("largest\nrange", unit, ".3g"), Column("equivalent\namplitude", unit, ".3g"),
        *((Column("damage", form=".3g"), Column("lasts\n[lives]", form=".3g")) if known else ()),
        Column(f"damage over that\nof {_called(worst)}" if worst else "damage", "%", ".3g"),
        *(Column(f"by {stage.run.name}", "%", ".3g") for stage in mission.stages if several),
    )  # fmt: skip
    return Table(id="damage", title="Cycles and damage of the mounts", columns=columns, rows=rows, note=note)


def _called(one: MountDamage) -> str:
    return f"{one.mount} {one.axis}"
