"""Reading the CSV file of a measured record: a fast path for the numbers, a slow one to name the line that is wrong."""

import math
import re
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import STANDARD_GRAVITY

TIME_UNITS = {"s": 1.0, "ms": 1e-3}
"""Known units of time and what one of them is in seconds."""

ACCELERATION_UNITS = {
    "m/s^2": 1.0,
    "m/s2": 1.0,
    "m/s²": 1.0,
    "g": STANDARD_GRAVITY,
    "mm/s^2": 1e-3,
    "mm/s2": 1e-3,
    "cm/s^2": 1e-2,
    "cm/s2": 1e-2,
    "gal": 1e-2,
    "in/s^2": 0.0254,
    "ft/s^2": 0.3048,
}
"""Known units of acceleration and what one of them is in m/s^2."""

_BLOCK = 50_000
"""Rows that are read at once: a record may be longer than what fits into memory several times over."""

_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")
"""Characters that no text holds, but for tabs and what ends a line or a page."""

_SIGNS = {",": "commas", ";": "semicolons", "\t": "tabs"}

LARGEST = 1e15
"""Largest number that a record may hold, in its own units: beyond all that was ever measured, or any clock counts, in any known
unit, and integrals of what is left are finite."""


@dataclass(frozen=True)
class Header:
    """The line of a record that names its columns.

    Attributes:
        path: The file.
        line: Number of the header's line, counted from 1.
        delimiter: What separates the cells.
        names: Names of the columns, units taken off.
        units: Their units; None where the header has none.
    """

    path: Path
    line: int
    delimiter: str
    names: tuple[str, ...]
    units: tuple[str | None, ...]

    def listed(self, first: int = 0) -> str:
        """Return the names of the columns, from the number `first` on, as messages list them, and whether they are no text."""
        names = short(", ".join(self.names[first:]))
        return f"{names}; the file is not text in UTF-8, save it as CSV in UTF-8" if "\ufffd" in names else names

    def factor(self, column: int, known: dict[str, float]) -> float:
        """Return what the column's unit is in SI; no unit or an unknown one is a RecordError."""
        name, unit = self.names[column], self.units[column]
        example = next(iter(known))
        if unit is None:
            raise RecordError(
                f'{self.path}, line {self.line}: column "{short(name)}" has no unit. '
                f'Write it behind the name, for instance "{short(name)} [{example}]"; known units: {", ".join(known)}.'
            )
        if unit not in known:
            raise RecordError(
                f'{self.path}, line {self.line}: column "{short(name)}" has the unknown unit "{short(unit)}". '
                f"Known units: {', '.join(known)}."
            )
        return known[unit]


def read_header(path: Path) -> Header:
    """Return the header of a record; lines before it may be empty or begin with #."""
    try:
        with path.open(encoding="utf-8-sig", errors="replace") as lines:
            for number, text in enumerate(lines, start=1):
                if text.strip() and not text.lstrip().startswith("#"):
                    return _time_first(parse_header(path, number, text))
    except FileNotFoundError:
        raise RecordError(f"{path}: no such file. A record is a CSV file of time and acceleration.") from None
    except OSError as error:
        raise RecordError(f"{path}: the record cannot be read: {why_unread(error)}") from None
    raise RecordError(f'{path}: the file is empty. Expected a header such as "time [s], z [g]" and rows of numbers.')


def parse_header(path: Path, line: int, text: str) -> Header:
    """Return the header that a line of names, each with a unit in brackets or without, makes."""
    if _CONTROL.search(text):
        kind = "NUL" if "\0" in text else "control"
        raise RecordError(
            f"{path}, line {line}: the header holds {kind} characters: this is no text, or text in UTF-16. Save it in UTF-8."
        )
    delimiter = next((sign for sign in "\t;" if sign in text), ",")
    names, units = [], []
    for cell in text.split(delimiter):
        match = re.fullmatch(r"(.*?)\s*(?:\[([^\]]*)\])?", cell.strip().strip('"').strip())
        names.append(match[1] if match else cell.strip())
        units.append(match[2].strip() if match and match[2] is not None else None)
    return Header(path, line, delimiter, tuple(names), tuple(units))


def _time_first(header: Header) -> Header:
    """Return the header, or raise RecordError if its first column is not time."""
    path, line = header.path, header.line
    if header.names[0].lower() not in ("time", "t"):
        raise RecordError(
            f'{path}, line {line}: the first column must be time, as in "time [s], z [g]"; '
            f"the columns are {header.listed()}."
        )
    return header


def read_blocks(header: Header, columns: Sequence[int], *, missing: bool = False) -> Iterator[Array]:
    """Yields the columns' numbers block by block, shape (n, n_columns); the first of them is time.

    Every row must have the header's number of cells: in one that has more or fewer, such as one with decimal commas between
    commas, nothing says which number belongs to which column.

    Args:
        header: Of the file.
        columns: Numbers of the columns.
        missing: Whether cells behind the time may be empty or NaN; both are NaN then.

    Raises:
        RecordError: A row has another number of cells than the header, or a cell is no number or not finite.
    """
    with header.path.open(encoding="latin-1") as file:  # numbers are ASCII; comments of any encoding are skipped
        for _ in range(header.line):
            file.readline()
        rows = _whole_rows(header, file)
        while True:
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", UserWarning)  # empty lines, and no line at all at the end
                    block = np.loadtxt(
                        rows, delimiter=header.delimiter, comments=None, usecols=columns, ndmin=2, max_rows=_BLOCK,
                        converters=_number_or_nan if missing else None,
                    )  # fmt: skip
            except ValueError:
                name_bad_line(header, columns, missing=missing)
                raise RecordError(
                    f"{header.path}: a row behind the header in line {header.line} holds something else than numbers. Write "
                    "it again as plain CSV in UTF-8."
                ) from None
            if not len(block):
                return
            if not np.all(np.abs(block) <= LARGEST):
                name_bad_line(header, columns, missing=missing)
            yield block


def _whole_rows(header: Header, lines: Iterable[str]) -> Iterator[str]:
    """Yields the lines that say something; ValueError at one that has not as many cells as the header has columns."""
    signs = len(header.names) - 1
    for line in lines:
        if line.isspace():
            continue
        if line.count(header.delimiter) != signs:
            raise ValueError("a row has another number of cells than the header")
        yield line


def require_cells(header: Header, where: str, cells: Sequence[str]) -> None:
    """Raises a RecordError unless a row has as many cells as the header has columns.

    Args:
        header: Of the file.
        where: The row stands, in words.
        cells: Of the row.
    """
    count, columns = len(cells), len(header.names)
    if count == columns:
        return
    message = f"{where}: {count} cells where the header has {columns} columns."
    if count > columns and header.delimiter == ",":
        message += " Decimals are written with a point: here every comma separates two cells."
    elif count == 1 and (sign := next((sign for sign in ";\t," if sign in cells[0]), None)):
        message += (
            f" The header's cells are separated by {_SIGNS[header.delimiter]}, those of this row by {_SIGNS[sign]}."
        )
    raise RecordError(message)


def most_rows(path: Path) -> int:
    """Return a number of lines that the file does not exceed, whatever its lines end with."""
    rows = 1
    with path.open("rb") as file:
        while part := file.read(1 << 20):
            rows += part.count(b"\n") + part.count(b"\r")
    return rows


def name_bad_line(header: Header, columns: Sequence[int], *, missing: bool = False) -> None:
    """Raises a RecordError that names the first line that cannot belong to a record, if there is one."""
    before = -math.inf
    with header.path.open(encoding="utf-8-sig", errors="replace") as lines:
        for number, text in enumerate(lines, start=1):
            if number <= header.line or not text.strip():
                continue
            where = f"{header.path}, line {number}"
            cells = text.rstrip("\r\n").split(header.delimiter)
            require_cells(header, where, cells)
            numbers = [
                _number(where, header.names[column], cells[column].strip(), missing=missing and place > 0)
                for place, column in enumerate(columns)
            ]
            time = numbers[0]
            if time <= before:
                fault = "repeats the row before" if time == before else f"comes after {before!r}"
                raise RecordError(f"{where}: time {time!r} {fault}; times must increase from row to row.")
            before = time


def _number_or_nan(cell: str) -> float:
    return parse_number(cell) if cell.strip() else math.nan


def parse_number(cell: str) -> float:
    """Return the number in a cell, or raises ValueError; 1_000 and digits of other scripts, which Python takes, are none."""
    if "_" in cell or not cell.isascii():
        raise ValueError(cell)
    return float(cell)


def _number(where: str, name: str, cell: str, *, missing: bool) -> float:
    if not cell or cell.lower().lstrip("+-") == "nan":
        if missing:
            return math.nan
        fill = (
            "its time is needed"
            if name.lower() in ("time", "t")
            else 'have such samples filled with straight lines, gaps="fill" (--gaps fill), or use what lies before or behind'
        )
        raise RecordError(f'{where}: {cell or "an empty cell"} in column "{name}"; {fill}.')
    try:
        value = parse_number(cell)
    except ValueError:
        hint = " Decimals are written with a point." if "," in cell else ""
        raise RecordError(f'{where}: "{short(cell)}" in column "{short(name)}" is not a number.{hint}') from None
    if not abs(value) <= LARGEST:
        raise RecordError(
            f'{where}: {cell} in column "{name}" is no measured value; cut or repair the record before it is used.'
        )
    return value
