"""A table of a model: a CSV file, or the first sheet of an XLSX file, with units in its header."""

import math
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.budget import require_memory
from wirerope_mj.foundation.csv_units import (
    Header,
    header_of_cells,
    number_in,
    read_header,
    require_cells,
    rows_below,
)
from wirerope_mj.foundation.errors import BudgetError, RecordError, why_unread
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, in_si

_POUND = 0.45359237
# units of each kind of quantity, in SI; an inch is 25.4 mm, a pound 0.45359237 kg (both exact)
UNITS: dict[str, Mapping[str, float]] = {
    "length": {"mm": 1e-3, "m": 1.0, "cm": 1e-2, "in": LENGTH_UNITS["in"]},
    "mass": {"kg": 1.0, "t": 1e3, "g": 1e-3, "lb": _POUND},
    "inertia": {
        "kg m^2": 1.0, "kg m2": 1.0, "kg m²": 1.0, "kg*m^2": 1.0, "kg mm^2": 1e-6, "kg mm2": 1e-6, "kg*mm^2": 1e-6,
        "t m^2": 1e3, "g mm^2": 1e-9, "lb in^2": _POUND * LENGTH_UNITS["in"] ** 2,
    },
    "angle": {"deg": math.pi / 180.0, "°": math.pi / 180.0, "rad": 1.0},
    "stiffness": {
        f"{force}/{length}": newtons / metres
        for force, newtons in FORCE_UNITS.items() for length, metres in (("m", 1.0), ("mm", 1e-3))
    } | {"MN/m": 1e6},
    "damping": {"N s/m": 1.0, "kN s/m": 1e3, "N s/mm": 1e3},
}  # fmt: skip

# bytes of memory for one of a sheet's XML: a cell of five bytes becomes a text and its place in a list
_UNPACKED = 20.0
PURE, TEXT = "number", "text"  # kinds of columns that need no unit


@dataclass(frozen=True)
class Row:
    """A row of a table: its cells as texts, by the names of the columns.

    Attributes:
        location: file and line or row, as messages begin.
        cells: texts; a column that is not in the table is not here.
        kinds: of quantity, by column.
        factors: of the columns' units, in SI.
    """

    location: str
    cells: Mapping[str, str]
    kinds: Mapping[str, str]
    factors: Mapping[str, float]

    def has(self, column: str) -> bool:
        """Return whether the cell is there and not empty."""
        return bool(self.cells.get(column, ""))

    def text(self, column: str) -> str:
        """Return the text of a cell; RecordError if it is empty or holds what cannot be seen."""
        text = self.cells.get(column, "")
        if not text:
            raise RecordError(f'{self.location}: column "{column}" is empty.')
        if plain(text) != text:
            raise RecordError(f'{self.location}: column "{column}" holds characters that cannot be seen.')
        return text

    def number(self, column: str, default: float | None = None) -> float:
        """Return the value of a cell in SI, the default where it is empty; RecordError if it is no finite number."""
        if not self.has(column):
            if default is not None:
                return default
            raise RecordError(f'{self.location}: column "{column}" is empty; a number is needed.')
        value = number_in(self.location, column, self.cells[column])
        if self.kinds[column] == "angle":  # to twelve digits, as `in_si` rounds, a right angle would not be one
            return value * self.factors[column]
        return in_si(value, self.factors[column])

    def vector(self, *columns: str) -> tuple[float, float, float]:
        """Return the values of three columns in SI."""
        x, y, z = (self.number(column) for column in columns)
        return x, y, z


def read_sheet(path: Path, *, kind: str, needed: Mapping[str, str], further: Mapping[str, str]) -> list[Row]:
    """Return the rows of a table; their names are checked to be there once each.

    Args:
        path: CSV file, or XLSX file whose first sheet is read.
        kind: of the table, for messages: "table of mounts".
        needed: kind of quantity of each column that must be there: a key of `UNITS`, "number" or "text".
        further: the same of columns that may be there.

    Raises:
        RecordError: says file, row and column that are wrong.
    """
    example = ", ".join(_with_unit(name, quantity) for name, quantity in needed.items())
    if path.suffix.lower() in {".xlsx", ".xlsm"}:
        header, cells = _excel(path, kind=kind, example=example)
    else:
        header = read_header(path, kind=kind, example=f'"{example}"')
        cells = ((location, row) for _, location, row in rows_below(header))
    known = {**needed, **further}
    factors = _factors(header, needed, known)
    rows = [Row(location, dict(zip(header.names, row, strict=True)), known, factors) for location, row in cells]
    if not rows:
        raise RecordError(f"{path}: the {kind} has a header and no rows.")
    _require_distinct(rows)
    return rows


def _with_unit(name: str, quantity: str) -> str:
    return name if quantity in {PURE, TEXT} else f"{name} [{next(iter(UNITS[quantity]))}]"


def _factors(header: Header, needed: Mapping[str, str], known: Mapping[str, str]) -> dict[str, float]:
    """Return the factor of each column's unit; RecordError if a column is unknown, missing, there twice or without unit."""
    for name in header.names:
        if name not in known:
            hint = ", ".join(_with_unit(*item) for item in known.items())
            raise RecordError(f'{header.location}: unknown column "{short(plain(name))}". Known columns: {hint}.')
        if header.names.count(name) > 1:
            raise RecordError(f'{header.location}: column "{name}" stands there twice.')
    for name, quantity in needed.items():
        if name not in header.names:
            raise RecordError(
                f'{header.location}: column "{_with_unit(name, quantity)}" is missing. '
                f"The header has {header.listed()}."
            )
    factors = {}
    for number, name in enumerate(header.names):
        plain_kind = known[name] in {PURE, TEXT}
        if plain_kind and header.units[number] not in {None, "", "-", "1"}:
            raise RecordError(f'{header.location}: column "{name}" has no unit; write "{name}".')
        factors[name] = 1.0 if plain_kind else header.factor(number, UNITS[known[name]])
    return factors


def _require_distinct(rows: list[Row]) -> None:
    seen: dict[str, str] = {}
    for row in rows:
        name = row.text("name")
        if name in seen:
            raise RecordError(f'{row.location}: the name "{short(name)}" is given twice, first in {seen[name]}.')
        seen[name] = row.location


def _excel(path: Path, *, kind: str, example: str) -> tuple[Header, Iterator[tuple[str, list[str]]]]:
    """Return header and rows of an XLSX file's first sheet, as texts; empty rows and those that begin with # are skipped."""
    filled = _filled(path)
    if not filled:
        raise RecordError(f"{path}: the first sheet is empty. A {kind} has a header such as {example}.")
    (first, names), *below = filled
    while names and not names[-1]:
        names = names[:-1]
    header = header_of_cells(path, first, names)

    def rows() -> Iterator[tuple[str, list[str]]]:
        for number, cells in below:
            location = f"{path}, row {number}"
            row = (
                cells[: len(names)] + [""] * (len(names) - len(cells)) + [cell for cell in cells[len(names) :] if cell]
            )
            require_cells(header, location, row)
            yield location, row

    return header, rows()


def _filled(path: Path) -> list[tuple[int, list[str]]]:
    """Read number and texts of the rows that hold something and do not begin with #."""
    try:
        import openpyxl
    except ImportError:
        raise RecordError(
            f"{path}: XLSX files are read by openpyxl, which is not installed: pip install 'wirerope-mj[xlsx]', "
            "or save the sheet as CSV."
        ) from None
    try:
        with regular(path).open("rb") as file:
            with zipfile.ZipFile(file) as parts:
                size = sum(part.file_size for part in parts.infolist())
            require_memory(f"{path}, unpacked,", _UNPACKED * size, "Save its first sheet as CSV.")
            sheet = openpyxl.load_workbook(file, read_only=True, data_only=True).worksheets[0]
            sheet.reset_dimensions()  # those of the file would fill all rows up to its farthest cell
            rows = enumerate(sheet.iter_rows(values_only=True), start=1)
            texts = ((number, [_as_text(value) for value in row]) for number, row in rows if set(row) - {None})
            return [(number, row) for number, row in texts if any(row) and not row[0].startswith("#")]
    except BudgetError:
        raise
    except OSError as error:
        raise RecordError(f"{path}: the table cannot be read: {why_unread(error)}") from None
    except Exception:  # openpyxl raises what its parsers of zip and XML raise
        raise RecordError(f"{path}: this is no XLSX file that can be read. Save it again, or as CSV.") from None


def _as_text(value: Any) -> str:
    if value is None:
        return ""
    return repr(value) if isinstance(value, float) else str(value).strip()
