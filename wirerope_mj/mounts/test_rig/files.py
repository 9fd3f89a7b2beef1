"""Writing loops to the CSV file of a cyclic test."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS
from wirerope_mj.mounts.laws import Loop


def save_cyclic_test(
    loops: Sequence[Loop],
    path: str | Path,
    *,
    frequency: float | None = None,
    deflection_unit: str = "m",
    force_unit: str = "N",
) -> None:
    """Write loops as a CSV file with units in its header, atomically.

    The columns are loop (1, 2, ...), time if a frequency is given, deflection and force: what a rig records. In m and N,
    numbers are written so that `load_cyclic_test` gives back the same bits; hysteretic states and the law's own work are not
    in the file.

    Args:
        loops: closed cycles, at least one.
        path: file to write; an existing one is replaced.
        frequency: of the test [Hz], for a column of time that starts at 0 in each loop; the samples count as uniform in time.
        deflection_unit: "m", "mm" or "in".
        force_unit: "N", "daN", "kN" or "lbf".

    Raises:
        ValueError: there is no loop, an argument is out of its range, or the file cannot stand there.
    """
    if not loops:
        raise ValueError("`loops` must hold at least one loop.")
    if frequency is not None:
        positive("frequency", frequency)
    metre = LENGTH_UNITS[one_of("deflection_unit", deflection_unit, LENGTH_UNITS)]
    newton = FORCE_UNITS[one_of("force_unit", force_unit, FORCE_UNITS)]
    target = Path(path)
    if target.is_dir() or not target.resolve().parent.is_dir():
        raise ValueError(f"`path` must be a file in a folder that exists, got {str(path)!r}.")
    time = "" if frequency is None else "time [s], "
    lines = [
        "# cyclic test: each loop is one cycle and ends where it began; deflection and force are positive in tension",
        f"loop, {time}deflection [{deflection_unit}], force [{force_unit}]",
    ]
    for number, loop in enumerate(loops, start=1):
        lines.extend(_rows(number, loop, frequency, metre, newton))
    with atomic_file(target) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def _rows(number: int, loop: Loop, frequency: float | None, metre: float, newton: float) -> Iterator[str]:
    """Yield a loop's rows; repr is the shortest text that reads back as the same number."""
    intervals = loop.deflection.size - 1
    for index, (x, force) in enumerate(zip(loop.deflection.tolist(), loop.force.tolist(), strict=True)):
        time = "" if frequency is None else f"{index / (intervals * frequency)!r}, "
        yield f"{number}, {time}{x / metre!r}, {force / newton!r}"
