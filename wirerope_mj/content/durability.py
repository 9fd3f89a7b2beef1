"""Content on durability: cycles of mounts over a service life, their damage, and a vibration of equal damage."""

from collections.abc import Sequence

from wirerope_mj.assessment.durability.cycles import EquivalentVibration
from wirerope_mj.assessment.durability.mission import Mission, MountDamage
from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.foundation.tables import Column, Row, Table, left

_SHOWN_ROWS = 12  # rows of a density that are shown at once


def durability_content(mission: Mission, damages: Sequence[MountDamage], *, rows: int) -> Content:
    """Compose the damage of a service life: the most damaged mount, its life, and a table of at most `rows`."""
    names = " + ".join(
        f"{stage.hours:g} h of {stage.run.name}" if stage.repetitions is None else f"{stage.repetitions:g} x {stage.run.name}"
        for stage in mission.stages
    )
    worst = damages[0] if damages else None
    if worst is None or not worst.total:
        verdict = Statement("most-damaged", "Nothing is damaged: no cycle was counted.", values={"damage": 0.0})
    else:
        text, values = f"Most damaged: {_damage_label(worst)}", dict[str, float | str | None](where=_damage_label(worst))
        if mission.constant is None:
            text += ". Its life is not known: damage is relative, because no constant of the fatigue curve was given."
            tone = "unjudged"
        else:
            life = 1.0 / worst.total
            text += f": damage {worst.total:.3g} in one such life; it lasts {life:.3g} such lives."
            tone, values = "exceeded" if worst.total > 1.0 else "within", values | {"damage": worst.total, "lives": life}
        verdict = Statement("most-damaged", text, tone=tone, values=values)
    return Content(
        title=f"Durability: {names}",
        verdict=verdict,
        sections=(Section("durability", "", lambda: [_damage_table(mission, damages, rows), verdict], "summary"),),
    )


def equivalent_content(vibration: EquivalentVibration) -> Content:
    """Compose the content of a random vibration that does the same fatigue damage as a run."""
    (least_at, least), (most_at, most) = vibration.extremes
    rise, fall = vibration.ramps
    played = (
        f"in the least damaging of {vibration.playings} playings, each with phases of its own" if vibration.playings
        else "in the mean of many playings"
    )  # fmt: skip
    text = (
        f"{with_unit(vibration.rms, 'm/s^2')} rms for {with_unit(vibration.duration, 's')}, with a rise of "
        f"{with_unit(rise, 's')} and a fall of {with_unit(fall, 's')} in it, along {vibration.along} do the damage that the "
        f"run does at {vibration.subject}, to oscillators of Q = {vibration.q:g} with the exponent {vibration.exponent:g}: "
        f"at least {least:#.3g} times that of the run, at {least_at:.3g} Hz, and at most {most:#.3g} times, at {most_at:.3g} "
        f"Hz, on {len(vibration.damage)} lines from {vibration.points[0][0]:.4g} to {vibration.points[-1][0]:.4g} Hz, {played}."
    )
    verdict = Statement(
        "equivalent", text,
        values={
            "rms_m_s2": vibration.rms, "duration_s": vibration.duration, "least_damage": least, "least_damage_hz": least_at,
            "most_damage": most, "most_damage_hz": most_at, "rise_s": rise, "fall_s": fall, "playings": vibration.playings,
        },
    )  # fmt: skip
    table = Table(
        "equivalent-psd", "Power spectral density, straight on logarithmic axes", rows=vibration.points, shown=_SHOWN_ROWS,
        columns=(Column("frequency", "Hz", ".4g"), Column("density", "g²/Hz", ".4g")),
    )  # fmt: skip
    return Content(
        title=f"Vibration in place of the run at {vibration.subject}", verdict=verdict,
        sections=(Section("equivalent", "", lambda: [verdict, table], "summary"),),
    )  # fmt: skip


def _damage_table(mission: Mission, damages: Sequence[MountDamage], most: int) -> Table:
    """Tabulate cycles, equivalent amplitude and damage of mounts along their axes, at most `most`."""
    unit = "mm" if mission.quantity == "deflection" else "kN"
    worst = damages[0] if damages else None
    known, several = mission.constant is not None, len(mission.stages) > 1
    rows: list[Row] = []
    for damage in damages[:most]:
        mean = damage.total * (mission.constant or 1.0) / damage.cycles if damage.cycles else 0.0
        relative = damage.total / worst.total if worst and worst.total else None
        amount = (damage.total, 1.0 / damage.total if damage.total else None) if known else ()
        stages = [part / damage.total if damage.total else None for part in damage.stages] if several else []
        amplitude = mean ** (1.0 / mission.exponent)
        rows.append((damage.mount, damage.axis, damage.cycles, damage.largest_range, amplitude, *amount, relative, *stages))
    note = f"Rainflow cycles of the {mission.quantity} (ASTM E1049), open ones as halves; exponent {mission.exponent:g}; "
    note += f"{len(damages)} mounts and axes counted. Equivalent amplitude: of as many equal cycles that do the same damage."
    if any(stage.hours is not None for stage in mission.stages):
        note += " Hours are of steady vibration: without rise, fall and what follows."
    columns = (
        *left("mount", "axis"), Column("cycles", form=".6g"),
        Column("largest\nrange", unit, ".3g"), Column("equivalent\namplitude", unit, ".3g"),
        *((Column("damage", form=".3g"), Column("lasts\n[lives]", form=".3g")) if known else ()),
        Column(f"damage over that\nof {_damage_label(worst)}" if worst else "damage", "%", ".3g"),
        *(Column(f"by {stage.run.name}", "%", ".3g") for stage in mission.stages if several),
    )  # fmt: skip
    return Table("damage", "Cycles and damage of the mounts", columns, rows, note=note)


def _damage_label(damage: MountDamage) -> str:
    return f"{damage.mount} {damage.axis}"
