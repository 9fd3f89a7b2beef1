"""`wirerope durability`: cycles of the mounts of a run."""

from pathlib import Path
from typing import Literal


def durability(
    folder: Path,
    *,
    exponent: float,
    quantity: Literal["deflection", "force"] = "deflection",
    repetitions: float = 1.0,
    rows: int = 12,
) -> int:
    """Count the cycles of a run's mounts by the rainflow method, and compare the damage that they do.

    Damage is Miner's sum with N = C / A^b. Nothing is assumed of the material: the exponent b is yours, and without its
    constant C damage is relative, in parts of that of the worst mount and axis. The equivalent amplitude is that of as many
    equal cycles.

    Args:
        folder: folder of a run.
        exponent: b, the exponent of the fatigue curve.
        quantity: deflection or force of the mounts.
        repetitions: how often the run happens in a service life.
        rows: mounts and axes that are printed, the worst first.
    """
    from wirerope_mj.assessment.durability import mount_cycles
    from wirerope_mj.cli.screen import print_table
    from wirerope_mj.engine.response import load_response
    from wirerope_mj.foundation.arguments import integer, positive
    from wirerope_mj.foundation.tables import Cell, Column, Table

    positive("--exponent", exponent)
    times = positive("--repetitions", repetitions)
    counted = mount_cycles(load_response(folder), quantity=quantity)
    damages = {id(one): one.cycles.damage(exponent) for one in counted}
    worst = max(damages.values(), default=0.0)
    counted.sort(key=lambda one: -damages[id(one)])
    unit = "mm" if quantity == "deflection" else "kN"
    table: list[list[Cell]] = [
        [
            one.mount, one.axis, one.cycles.total * times, float(one.cycles.ranges.max(initial=0.0)),
            one.cycles.equivalent_amplitude(exponent), damages[id(one)] / worst if worst else None,
        ]
        for one in counted[: integer("--rows", rows, least=1)]
    ]  # fmt: skip
    columns = (
        Column("mount", align="left"), Column("axis", align="left"), Column("cycles", form=".1f"),
        Column("largest range", unit, ".3g"), Column("equivalent amplitude", unit, ".3g"),
        Column("damage of the worst", "%", ".3g"),
    )  # fmt: skip
    method = f"Rainflow cycles of the {quantity} (ASTM E1049), open ones as halves"
    note = f"{method}; exponent {exponent:g}; {len(counted)} counted."
    print_table(Table(title=f"Cycles in {times:g} x {folder.name}", columns=columns, rows=table, note=note))
    return 0
