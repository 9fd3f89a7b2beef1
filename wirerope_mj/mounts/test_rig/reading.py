"""Reading measured loops from the CSV file of a cyclic test; whatever is wrong with it is named with its line."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.csv_units import LARGEST, TIME_UNITS, Header, parse_header, parse_number, require_cells
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.mounts.test_rig.files import DEFLECTION_UNITS, FORCE_UNITS
from wirerope_mj.mounts.test_rig.noise import is_noise, no_cycle_text
from wirerope_mj.mounts.test_rig.passive import require_passive
from wirerope_mj.mounts.test_rig.turning import rms_noise

_EXAMPLE = '"loop, time [s], deflection [mm], force [kN]"'
_NAMES = {
    "loop": ("loop",),
    "amplitude": ("amplitude",),
    "time": ("time", "t"),
    "deflection": ("deflection", "displacement"),
    "force": ("force", "load"),
}
_MOST = (
    1.0  # [m], beyond the travel of any wire rope isolator, while a millimetre taken for a metre is a thousand times
)
_FEWEST = 8  # samples: fewer are no loop
_LEG = 0.2  # share of the range that counts as going back: above any noise that leaves a loop to be seen
_NOMINAL = 2.0  # times that a loop may be larger or smaller than its stated amplitude: mixed units are 1000 times


@dataclass
class Samples:
    """What the rows of one loop say; numbers in SI units, and the line of the file in which each row stands."""

    label: str
    amplitude: float | None
    lines: list[int] = field(default_factory=list)
    time: list[float] = field(default_factory=list)
    deflection: list[float] = field(default_factory=list)
    force: list[float] = field(default_factory=list)


def read_cyclic_test(path: str | Path) -> list[Loop]:
    """Return the loops of a measured cyclic test, in the order of the file.

    The file is CSV (separated by comma, semicolon or tab) with a header such as "loop, time [s], deflection [mm],
    force [kN]"; lines that are empty or begin with # are skipped. Deflection (or displacement) in m or mm and force (or load)
    in N or kN must be there, positive in tension. Rows with the same value of `loop`, or of `amplitude` [m or mm] where there
    is no `loop`, are one loop; without both the file is one loop. A time [s or ms] must increase within each loop and is
    not kept; other columns are not read.

    A loop is one cycle that ends where it began. If its last sample stands one step before the first, the first is repeated at
    the end, so that the area is that of a closed loop. A record of several cycles is refused: `read_cycles` cuts those up.
    What a file does not say is marked so in the loops: z is NaN, there are no internal states, `cycles` is 0; `closure` is
    the distance between the last force of the file and the first over the force range, work is summed by the trapezoid rule.

    Raises:
        RecordError: names file and line, what stands there and what is expected.
    """
    return [_loop(Path(path), samples) for samples in read_rows(Path(path))]


def read_rows(path: Path) -> list[Samples]:
    """Return the rows of a cyclic test, those of one loop together, or raise RecordError with file and line."""
    lines = said_lines(path, "cyclic test", _EXAMPLE)
    header, columns = _header(path, lines)
    groups = _group(header, columns, lines)
    if not groups:
        raise RecordError(f"{path}: there are no rows behind the header in line {header.line}.")
    return groups


def said_lines(path: Path, what: str, example: str) -> list[tuple[int, str]]:
    """Return number and text of every line that says something; RecordError if there is none, with a header as an example."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except FileNotFoundError:
        raise RecordError(f"{path}: no such file. A {what} is a CSV file with the columns {example}.") from None
    except OSError as error:
        raise RecordError(f"{path}: the {what} cannot be read: {why_unread(error)}") from None
    rows = enumerate(text.splitlines(), start=1)
    said = [(number, line) for number, line in rows if line.strip() and not line.lstrip().startswith("#")]
    if not said:
        raise RecordError(f"{path}: the file is empty. Expected a header such as {example} and rows of numbers.")
    return said


def _header(path: Path, lines: list[tuple[int, str]]) -> tuple[Header, dict[str, int]]:
    """Return the header and which column holds which quantity."""
    number, text = lines.pop(0)
    header = parse_header(path, number, text)
    names = header.names
    columns: dict[str, int] = {}
    for quantity, words in _NAMES.items():
        found = [index for index, name in enumerate(names) if name.lower() in words]
        if len(found) > 1:
            cells = " and ".join(f'"{text.split(header.delimiter)[index].strip()}"' for index in found)
            raise RecordError(
                f"{path}, line {number}: {quantity} stands in the columns {cells}; one quantity has one column and one unit."
            )
        if found:
            columns[quantity] = found[0]
    for quantity in ("deflection", "force"):
        if quantity not in columns:
            raise RecordError(
                f'{path}, line {number}: there is no column "{quantity}". The columns are {header.listed()}; '
                f"expected a header such as {_EXAMPLE}."
            )
    return header, columns


def _group(header: Header, columns: dict[str, int], lines: list[tuple[int, str]]) -> list[Samples]:
    """Return the rows loop by loop, in SI units."""
    known = {"time": TIME_UNITS, "amplitude": DEFLECTION_UNITS, "deflection": DEFLECTION_UNITS, "force": FORCE_UNITS}
    factors = {name: header.factor(columns[name], known[name]) for name in known if name in columns}
    key = next((name for name in ("loop", "amplitude") if name in columns), None)
    groups: dict[str, Samples] = {}
    samples = None
    for number, where, cells in rows_behind(header, lines):
        values = {
            name: factor * number_in(where, header.names[columns[name]], cells[columns[name]])
            for name, factor in factors.items()
        }
        label = cells[columns[key]] if key else "1"
        if samples is None or label != samples.label:
            if label in groups:
                raise RecordError(
                    f"{where}: {key} {short(label)} goes on here after another; its rows ended in line "
                    f"{groups[label].lines[-1]}. "
                    'Rows of one loop stand together; give a repeated amplitude its own number in a column "loop".'
                )
            samples = groups[label] = Samples(label, values.get("amplitude"))
        if "time" in values and samples.time and values["time"] <= samples.time[-1]:
            raise RecordError(f"{where}: time must increase from row to row of a loop, got {cells[columns['time']]}.")
        samples.lines.append(number)
        for name in ("time", "deflection", "force"):
            if name in values:
                getattr(samples, name).append(values[name])
    return list(groups.values())


def rows_behind(header: Header, lines: list[tuple[int, str]]) -> Iterator[tuple[int, str, list[str]]]:
    """Yield line number, where it is in words, and the cells of every row."""
    for number, text in lines:
        where = f"{header.path}, line {number}"
        if "[" in text:
            raise RecordError(
                f'{where}: "{short(text.strip())}" looks like a second header after that in line {header.line}. '
                "A file has one header and one unit for each quantity: convert the rows, or use two files."
            )
        cells = [cell.strip().strip('"').strip() for cell in text.split(header.delimiter)]
        require_cells(header, where, cells)
        yield number, where, cells


def number_in(where: str, name: str, cell: str) -> float:
    """Return the finite number in a cell."""
    try:
        value = parse_number(cell)
    except ValueError:
        hint = ""
        if re.fullmatch(r"[-+.\deE]+\s*[a-zA-Zµ]+", cell):
            hint = " Units stand in the header only, one for each column."
        elif "," in cell:
            hint = " Decimals are written with a point."
        raise RecordError(f'{where}: "{short(cell)}" in column "{short(name)}" is not a number.{hint}') from None
    if not abs(value) <= LARGEST:
        raise RecordError(
            f'{where}: {cell} in column "{name}" is no measured value; cut or repair the loop before it is used.'
        )
    return value


def _loop(path: Path, samples: Samples) -> Loop:
    """Return the loop of one cycle's samples."""
    place = f"{path}, lines {samples.lines[0]} to {samples.lines[-1]}"
    x, force = np.array(samples.deflection), np.array(samples.force)
    if x.size < _FEWEST:
        raise RecordError(f"{place}: loop {samples.label} has {x.size} samples; a cycle needs at least {_FEWEST}.")
    extent = float(np.ptp(x))
    if extent == 0.0:
        raise RecordError(f"{place}: the deflection of loop {samples.label} never changes.")
    require_nominal(samples, extent / 2.0, place)
    try:
        require_likely(extent / 2.0, place)
    except ValueError as error:
        raise RecordError(str(error)) from None
    if is_noise(x, rms_noise(x)):
        raise RecordError(f"{place}: {no_cycle_text(x)}")
    gap, steps = abs(float(x[-1] - x[0])), np.abs(np.diff(x))
    legs = _legs(x, _LEG * extent)
    if legs > 3 or (gap > _LEG * extent and gap > 1.5 * steps.max()):
        found = f"its deflection runs to and fro {legs} times" if legs > 3 else "its last sample is far from its first"
        raise RecordError(
            f"{place}: loop {samples.label} is not one cycle: {found}. "
            "`read_cycles` reads records of several cycles, amplitudes and operating points; or number the cycles in a column "
            '"loop"; each ends where it began.'
        )
    loop = Loop.from_samples(x, force)
    try:
        require_passive(loop, place)
    except ValueError as error:
        raise RecordError(str(error)) from None
    if gap <= 0.5 * min(steps[0], steps[-1]):
        return loop
    return replace(Loop.from_samples(np.append(x, x[0]), np.append(force, force[0])), closure=loop.closure)


def require_likely(amplitude: float, place: str) -> None:
    """Raise ValueError if an amplitude [m] is none of an isolator: millimetres that count as metres, most likely."""
    if amplitude > _MOST:
        raise ValueError(
            f"{place}: an amplitude of {amplitude:.4g} m is beyond any isolator of wire rope; are the deflections in mm where "
            "metres are said or expected?"
        )


def require_nominal(samples: Samples, amplitude: float, place: str) -> None:
    """Raise RecordError if an amplitude [m] is far from the one that its rows state: units, most likely."""
    if samples.amplitude is not None and not 1.0 / _NOMINAL < samples.amplitude / amplitude < _NOMINAL:
        raise RecordError(
            f"{place}: the amplitude is {1e3 * samples.amplitude:.6g} mm but the deflections run over "
            f"+-{1e3 * amplitude:.5g} mm; do the two columns have the units that the header says?"
        )


def _legs(deflection: Array, threshold: float) -> int:
    """Return how often the deflection runs up or down by more than `threshold`: 2 or 3 in one cycle."""
    legs, direction = 0, 0
    turn = deflection[0]
    for value in deflection:
        if direction != 0 and (value - turn) * direction > 0.0:
            turn = value
        elif abs(value - turn) > threshold:
            direction = 1 if value > turn else -1
            legs, turn = legs + 1, value
    return legs
