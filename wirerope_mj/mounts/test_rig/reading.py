"""CSV files of cyclic tests: writing, and reading, with errors that name the line."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.table_files import number_in, numbered_rows, read_header, rows_below
from wirerope_mj.foundation.table_header import Header, is_clock_time
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, STANDARD_GRAVITY, TIME_UNITS, find_unit
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.mounts.test_rig.passive import is_noise, no_cycle_text, require_passive
from wirerope_mj.mounts.test_rig.turning import rms_noise


def save_cyclic_test(
    loops: Sequence[Loop], path: str | Path, *, frequency: float | None = None, deflection_unit: str = "m",
    force_unit: str = "N",
) -> None:  # fmt: skip
    """Write loops as a CSV file with units in its header, atomically.

    The columns are loop (1, 2, ...), time if a frequency is given, deflection and force: what a rig records. In m and N,
    numbers are written so that `load_cyclic_test` gives back the same bits; hysteretic states and the law's own work are not
    in the file.

    Args:
        loops: closed cycles, at least one.
        path: file to write; an existing one is replaced.
        frequency: of the test [Hz], for a column of time that starts at 0 in each loop; the samples count as uniform in time.
        deflection_unit: "m", "mm", "cm", "um", "in" or "ft".
        force_unit: "N", "daN", "kN", "lbf", "kip" or "kgf".

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
        intervals = loop.deflection.size - 1
        # repr is the shortest text that reads back as the same number
        for index, (x, force) in enumerate(zip(loop.deflection.tolist(), loop.force.tolist(), strict=True)):
            instant = "" if frequency is None else f"{index / (intervals * frequency)!r}, "
            lines.append(f"{number}, {instant}{x / metre!r}, {force / newton!r}")
    with atomic_file(target) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


_EXAMPLE = '"loop, time [s], deflection [mm], force [kN]"'
_NAMES = {
    "loop": ("loop",), "amplitude": ("amplitude",), "time": ("time", "t"),
    "deflection": ("deflection", "displacement", "disp", "disp."), "force": ("force", "load"),
}  # fmt: skip
# words within the names that rigs give these quantities, and their units
_WORDS = {
    "deflection": (
        re.compile(r"deflect|displ|\bdisp\b|stroke|travel|position|extension|lvdt|weg|verformung|hub", re.I),
        LENGTH_UNITS,
    ),
    "force": (re.compile(r"force|load|kraft|last", re.I), FORCE_UNITS),
    "time": (re.compile(r"\btime\b|zeit", re.I), TIME_UNITS),
}
_LARGEST_AMPLITUDE = 1.0  # [m], beyond any travel of a wire rope isolator; a millimetre taken for a metre is a thousand times
# secant stiffness [N/m]: of 77 vendors' parts the softest has 1900, the stiffest 3.5e6; of rubber stops 2e7; kN for N is 1000
_SOFTEST, _STIFFEST = 500.0, 1e9
_FASTEST = 2000.0  # acceleration of a cycle [m/s^2]: rigs reach a tenth of it; s for ms is a million times as much
_FEWEST = 8  # samples: fewer are no loop
_LEG = 0.2  # fraction of the range that counts as going back: above any noise that leaves a loop to be seen
# times that a loop may be larger or smaller than its stated amplitude: rigs miss theirs by a fifth, from peak to peak it is
# twice, mixed units are 1000 times
_NOMINAL, _PEAK_TO_PEAK = 1.6, 2.5
# samples that stand alone, and how many times as far off the middle as nearly all others
_ALONE, _FAR_OFF = 3, 30.0


@dataclass
class Samples:
    """Rows of one loop: numbers in SI units, and the line of the file in which each row stands."""

    label: str
    amplitude: float | None
    lines: list[int] = field(default_factory=list)
    time: list[float] = field(default_factory=list)
    deflection: list[float] = field(default_factory=list)
    force: list[float] = field(default_factory=list)


def load_cyclic_test(path: str | Path) -> list[Loop]:
    """Read the loops of a measured cyclic test, in the order of the file.

    The file is CSV (separated by comma, semicolon or tab) with a header such as "loop, time [s], deflection [mm],
    force [kN]"; lines that are empty or begin with # are skipped. Deflection (or displacement) in m, mm, cm or in and force (or
    load) in N, daN, kN or lbf must be there, positive in tension. Rows with the same value of `loop`, or of `amplitude`, a
    length, where there is no `loop`, are one loop; without both the file is one loop. A time [s or ms] must increase within
    each loop and is not kept; other columns are not read.

    A loop is one cycle that ends where it began. If its last sample stands one step before the first, the first is repeated at
    the end, so that the area is that of a closed loop. A record of several cycles is refused: `load_cycles` cuts those up.
    What a file does not say is marked so in the loops: z is NaN, there are no internal states, `cycles` is 0; `closure` is
    the distance between the last force of the file and the first over the force range, work is summed by the trapezoid rule.

    Raises:
        RecordError: names file and line, what stands there and what is expected.
    """
    loops = []
    for samples in read_rows(Path(path)):
        location = f"{path}, lines {samples.lines[0]} to {samples.lines[-1]}"
        x, force = np.array(samples.deflection), np.array(samples.force)
        if x.size < _FEWEST:
            raise RecordError(f"{location}: loop {samples.label} has {x.size} samples; a cycle needs at least {_FEWEST}.")
        extent = float(np.ptp(x))
        if extent == 0.0:
            raise RecordError(f"{location}: the deflection of loop {samples.label} never changes.")
        require_nominal(samples, extent / 2.0, location)
        # How often the deflection runs up or down: two or three times in one cycle.
        legs, direction, turn = 0, 0, x[0]
        for value in x:
            if direction != 0 and (value - turn) * direction > 0.0:
                turn = value
            elif abs(value - turn) > _LEG * extent:
                direction = 1 if value > turn else -1
                legs, turn = legs + 1, value
        gap, steps = abs(float(x[-1] - x[0])), np.abs(np.diff(x))
        try:
            require_likely(extent / 2.0, 0.5 * float(np.ptp(force)), location)
            if is_noise(x, rms_noise(x)):
                raise ValueError(f"{location}: {no_cycle_text(x)}")
            if legs > 3 or (gap > _LEG * extent and gap > 1.5 * steps.max()):
                fault = f"its deflection runs to and fro {legs} times" if legs > 3 else "its last sample is far from its first"
                raise ValueError(
                    f"{location}: loop {samples.label} is not one cycle: {fault}. `load_cycles` reads records of several "
                    'cycles, amplitudes and operating points; or number the cycles in a column "loop"; each ends where it '
                    "began."
                )
            loop = Loop.from_samples(x, force)
            require_passive(loop, location)
        except ValueError as error:
            raise RecordError(str(error)) from None
        if gap > 0.5 * min(steps[0], steps[-1]):
            closed = Loop.from_samples(np.append(x, x[0]), np.append(force, force[0]))
            loop = replace(closed, closure=loop.closure)
        loops.append(loop)
    return loops


def read_rows(path: Path) -> list[Samples]:
    """Read the rows of a cyclic test, those of one loop together; RecordError with file and line."""
    header = read_header(path, kind="cyclic test", example=_EXAMPLE)
    columns: dict[str, int] = {}  # of each quantity
    for quantity, names in _NAMES.items():
        indices = [index for index, name in enumerate(header.names) if name.lower() in names]
        if len(indices) > 1:
            cells = " and ".join(f'"{header.names[index]} [{header.units[index] or ""}]"' for index in indices)
            raise RecordError(
                f"{header.location}: {quantity} stands in the columns {cells}; one quantity has one column and one unit."
            )
        if indices:
            columns[quantity] = indices[0]
    for quantity, (words, known) in _WORDS.items():
        if quantity in columns:
            continue
        left = [i for i in range(len(header.names)) if i not in columns.values() and i not in header.unnamed]
        of_unit = [i for i in left if header.units[i] is not None and find_unit(header.units[i] or "", known)]
        called = [i for i in of_unit if words.search(header.names[i])]
        without = [i for i in left if header.units[i] is None and words.search(header.names[i])]
        likely = called or ([] if quantity == "time" else of_unit or without)
        if len(likely) == 1:
            columns[quantity] = likely[0]
        elif quantity != "time":
            fault = f'there is no column "{quantity}"'
            if likely:
                listed, unit = " and ".join(f'"{header.names[i]}"' for i in likely), header.units[likely[0]]
                fault = f'{listed} may all be the {quantity}: call the one that is meant "{quantity} [{unit}]"'
            raise RecordError(
                f"{header.location}: {fault}. The columns are {header.listed()}; expected a header such as {_EXAMPLE}."
            )
    if "time" in columns:
        _, first = next(iter(numbered_rows(header)), (0, header.names))
        if columns["time"] < len(first) and is_clock_time(first[columns["time"]]):
            del columns["time"]  # of the day: nothing that loops need
    groups = _group(header, columns)
    if not groups:
        raise RecordError(f"{path}: there are no rows behind the header in line {header.line}.")
    return groups


def _group(header: Header, columns: dict[str, int]) -> list[Samples]:
    """Group the rows loop by loop, in SI units."""
    known = {"time": TIME_UNITS, "amplitude": LENGTH_UNITS, "deflection": LENGTH_UNITS, "force": FORCE_UNITS}
    factors = {name: header.factor(columns[name], units) for name, units in known.items() if name in columns}
    key = next((name for name in ("loop", "amplitude") if name in columns), None)
    groups: dict[str, Samples] = {}
    samples = None
    for line, location, cells in rows_below(header):
        texts = {name: (header.names[columns[name]], cells[columns[name]]) for name in factors}
        values = {name: factors[name] * number_in(location, *text) for name, text in texts.items()}
        label = cells[columns[key]] if key else "1"
        if samples is None or label != samples.label:
            if label in groups:
                raise RecordError(
                    f"{location}: {key} {short(label)} goes on here after another; its rows ended in line "
                    f"{groups[label].lines[-1]}. "
                    'Rows of one loop stand together; give a repeated amplitude its own number in a column "loop".'
                )
            samples = groups[label] = Samples(label, amplitude=values.get("amplitude"))
        if "time" in values and samples.time and values["time"] <= samples.time[-1]:
            raise RecordError(f"{location}: time must increase from row to row of a loop, got {cells[columns['time']]}.")
        samples.lines.append(line)
        for name in ("time", "deflection", "force"):
            if name in values:
                getattr(samples, name).append(values[name])
    return list(groups.values())


def require_likely(amplitude: float, force: float, location: str, *, stop: bool = False) -> None:
    """Raise ValueError if half ranges of deflection [m] and force [N] are beyond any isolator's: probably wrong units.

    A bare bump stop (`stop`) may have no force at all.
    """
    if amplitude > _LARGEST_AMPLITUDE:
        raise ValueError(
            f"{location}: an amplitude of {amplitude:.4g} m is beyond any isolator of wire rope; are the deflections in mm "
            "where metres are said or expected?"
        )
    stiffness = force / amplitude
    if (0.0 < stiffness < _SOFTEST and not stop) or stiffness > _STIFFEST:
        word, units = ("softer", "kN where N is") if stiffness < _SOFTEST else ("stiffer", "N where kN is")
        raise ValueError(
            f"{location}: +-{force:.4g} N at +-{1e3 * amplitude:.4g} mm are {1e-3 * stiffness:.4g} N/mm, "
            f"{word} than any isolator; are the forces in {units} said or expected, or the deflections in another unit?"
        )


def require_slower(amplitude: float, period: float, location: str) -> None:
    """Raise ValueError if a cycle of an amplitude [m] and a period [s] is faster than any rig: probably wrong units of time."""
    acceleration = amplitude * (2.0 * np.pi / period) * (2.0 * np.pi / period)
    if acceleration > _FASTEST:
        raise ValueError(
            f"{location}: +-{1e3 * amplitude:.4g} mm at {1.0 / period:.4g} Hz are {acceleration / STANDARD_GRAVITY:.3g} g, "
            'beyond any rig: is column "time" in s where the header says ms?'
        )


def require_nominal(samples: Samples, amplitude: float, location: str) -> None:
    """Raise RecordError if an amplitude [m] is far from the amplitude that its rows state: probably wrong units."""
    if samples.amplitude is not None and not 1.0 / _NOMINAL < samples.amplitude / amplitude < _NOMINAL:
        twice = _NOMINAL <= samples.amplitude / amplitude < _PEAK_TO_PEAK
        raise RecordError(
            f"{location}: the amplitude is {1e3 * samples.amplitude:.6g} mm but the deflections run over "
            f"+-{1e3 * amplitude:.5g} mm; "
            + (
                "is it from peak to peak? An amplitude is half of that."
                if twice
                else "do the two columns have the units that the header says?"
            )
        )


def require_like_samples(samples: Samples, path: Path) -> None:
    """Raise RecordError if a sample of deflection or force is off by so much that it is no sample of a cycle."""
    for name, values in (("deflection", np.array(samples.deflection)), ("force", np.array(samples.force))):
        off = np.abs(values - np.median(values))
        usual = float(np.quantile(off, 0.99)) if off.size > 100 * _ALONE else math.inf
        alone = np.flatnonzero(off > _FAR_OFF * usual) if usual > 0.0 else np.zeros(0, int)
        if 0 < alone.size <= _ALONE:
            unit, factor = ("mm", 1e3) if name == "deflection" else ("N", 1.0)
            raise RecordError(
                f"{path}, line {samples.lines[alone[0]]}: a {name} of {factor * values[alone[0]]:.6g} {unit} stands alone "
                f"among others within {factor * usual:.4g} {unit} of their middle: is a digit wrong, or was the sample lost? "
                "Correct or leave out the line."
            )
