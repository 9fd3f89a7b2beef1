"""`wirerope durability`: cycles of the mounts of a run, or of a service life of several, and the damage that they do."""

from pathlib import Path
from typing import Literal


def durability(
    source: Path,
    *,
    exponent: float | None = None,
    constant: float | None = None,
    quantity: Literal["deflection", "force"] = "deflection",
    repetitions: float = 1.0,
    rows: int = 12,
) -> int:
    """Count the cycles of the mounts of a run or a service life, and compare the damage that they do.

    Damage is Miner's sum with N = C / A^b, A being the amplitude. Nothing is assumed of the material: the exponent b is yours,
    and without its constant C damage is relative, in parts of that of the worst mount and axis.

    Args:
        source: folder of a run, or a TOML file of a service life: exponent, quantity, constant, and for each [[stage]] its run
            with repetitions or hours.
        exponent: b, the exponent of the fatigue curve; of a service life its file says it.
        constant: C, in metres or newtons to the power b.
        quantity: deflection or force of the mounts.
        repetitions: how often the run happens in a service life.
        rows: mounts and axes that are printed, the worst first.
    """
    from wirerope_mj.foundation.arguments import integer, positive
    from wirerope_mj.foundation.errors import RecordError
    from wirerope_mj.foundation.tables import Cell, Column, Table
    from wirerope_mj.runs.mission import Mission, Stage, mission_damage, read_mission
    from wirerope_mj.views.terminal import print_table

    if source.suffix == ".toml":
        if exponent is not None or constant is not None or quantity != "deflection" or repetitions != 1.0:
            raise RecordError(
                f"{source}: a service life says exponent, constant, quantity and repetitions in its file."
            )
        mission = read_mission(source)
    else:
        if exponent is None:
            raise RecordError("`--exponent` of the fatigue curve is missing.")
        mission = Mission(
            stages=(Stage(run=source, repetitions=positive("--repetitions", repetitions)),),
            exponent=positive("--exponent", exponent),
            quantity=quantity,
            constant=None if constant is None else positive("--constant", constant),
        )
    damages = mission_damage(mission)
    worst = max((one.total for one in damages), default=0.0)
    unit = "mm" if mission.quantity == "deflection" else "kN"
    known, several = mission.constant is not None, len(mission.stages) > 1
    table: list[list[Cell]] = []
    for one in damages[: integer("--rows", rows, least=1)]:
        amplitude = (
            (one.total * (mission.constant or 1.0) / one.cycles) ** (1.0 / mission.exponent) if one.cycles else 0.0
        )
        cells: list[Cell] = [one.mount, one.axis, one.cycles, one.largest_range, amplitude]
        cells += [one.total] if known else []
        cells.append(one.total / worst if worst else None)
        cells += [part / one.total if one.total else None for part in one.stages] if several else []
        table.append(cells)
    columns = [
        Column("mount", align="left"), Column("axis", align="left"), Column("cycles", form=".1f"),
        Column("largest range", unit, ".3g"), Column("equivalent amplitude", unit, ".3g"),
        *([Column("damage", form=".3g")] if known else []), Column("damage of the worst", "%", ".3g"),
        *([Column(f"by {stage.run.name}", "%", ".3g") for stage in mission.stages] if several else []),
    ]  # fmt: skip
    method = f"Rainflow cycles of the {mission.quantity} (ASTM E1049), open ones as halves"
    note = f"{method}; exponent {mission.exponent:g}; {len(damages)} counted."
    if any(stage.hours is not None for stage in mission.stages):
        note += " Hours are of the vibration from start to end; of random vibration without rise and fall."
    if known:
        note += f" The worst lasts {1.0 / worst:.3g} such lives." if worst else ""
    names = " + ".join(_often(stage.repetitions, stage.hours, stage.run.name) for stage in mission.stages)
    print_table(Table(title=f"Cycles in {names}", columns=columns, rows=table, note=note))
    return 0


def _often(repetitions: float | None, hours: float | None, name: str) -> str:
    return f"{hours:g} h of {name}" if repetitions is None else f"{repetitions:g} x {name}"
