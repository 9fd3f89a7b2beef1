"""`wirerope durability`: cycles of the mounts of a run, or of a service life of several, and the damage that they do."""

from pathlib import Path
from typing import Literal


def durability(
    source: Path, *, exponent: float | None = None, constant: float | None = None,
    quantity: Literal["deflection", "force"] = "deflection", repetitions: float = 1.0, rows: int = 12,
    equivalent_psd: str | None = None, out: Path | None = None,
) -> int:  # fmt: skip
    """Count the cycles of the mounts of a run or a service life, and compare the damage that they do.

    Damage is Miner's sum with N = C / A^b, A being the amplitude. Nothing is assumed of the material: the exponent b is yours,
    and without its constant C damage is relative, in percent of that of the mount and axis that are damaged most.

    Args:
        source: folder of a run, or a TOML file of a service life: exponent, quantity, constant, and for each [[stage]] its run
            with repetitions or hours.
        exponent: b, the exponent of the fatigue curve; of a service life its file says it.
        constant: C, in metres or newtons to the power b.
        quantity: deflection or force of the mounts.
        repetitions: how often the run happens in a service life.
        rows: mounts and axes that are printed, the worst first.
        equivalent_psd: "rack 3600 s 5 to 80 Hz z": in place of the mounts, the random vibration of that length and those
            frequencies that does the damage of the run at a body, a point or the base along z.
        out: CSV file of that vibration, which --psd of `wirerope shock` takes.
    """
    from wirerope_mj.assessment.durability.cycles import equivalent_vibration
    from wirerope_mj.assessment.durability.mission import Mission, Stage, mission_damage, read_mission
    from wirerope_mj.content.durability import durability_content, equivalent_content
    from wirerope_mj.engine.response import load_response
    from wirerope_mj.foundation.arguments import integer, positive
    from wirerope_mj.foundation.atomic_files import atomic_file
    from wirerope_mj.foundation.errors import RecordError
    from wirerope_mj.foundation.units import in_unit
    from wirerope_mj.views.terminal import show

    if equivalent_psd is not None:
        if exponent is None:
            raise RecordError("`--exponent` of the fatigue curve is missing.")
        found = equivalent_vibration(load_response(source), equivalent_psd, exponent=positive("--exponent", exponent))
        show(equivalent_content(found))
        if out is not None:
            rows_of = [f"{frequency:.6g}, {in_unit(level, 'g²/Hz'):.6g}" for frequency, level in found.points]
            with atomic_file(out) as temporary:
                temporary.write_text("\n".join(["frequency [Hz], psd [g^2/Hz]", *rows_of]) + "\n", encoding="utf-8")
            print(f"written: {out}")
        return 0
    if out is not None:
        raise RecordError("`--out` is of an equivalent vibration: say it with --equivalent-psd.")
    if source.suffix == ".toml":
        if exponent is not None or constant is not None or quantity != "deflection" or repetitions != 1.0:
            raise RecordError(f"{source}: a service life says exponent, constant, quantity and repetitions in its file.")
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
    most = integer("--rows", rows, least=1)
    show(durability_content(mission, mission_damage(mission), rows=most))
    return 0
