"""CSV files with units in their header: names, units and factors of the columns, rows, numbers, and the line that is wrong."""

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, UNITS, VELOCITY_UNITS, in_si

# Largest number that a file may hold, in its own units: beyond all that was ever measured, or any clock counts, in any known
# unit, and integrals of what is left are finite.
LARGEST = 1e15
# Characters that no text holds, but for tabs and what ends a line or a page.
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")

_DELIMITERS = {"\t": "tabs", ";": "semicolons", ",": "commas"}
# what in parentheses behind a name is a unit, as "Disp. (in)"; anything in brackets is meant as one
_UNITS = {unit for units in (*UNITS.values(), ACCELERATION_UNITS, FORCE_UNITS, VELOCITY_UNITS) for unit in units}
_DECIMAL = re.compile(r"[-+]?\d*([.,])\d+(?:[eE][-+]?\d+)?")
_SWAPPED = str.maketrans(",.", ".,")
_ABOVE = 100  # lines in which a header may stand below what a rig or a logger says of itself


@dataclass(frozen=True)
class Header:
    """The line of a CSV file that names its columns."""

    path: Path  # of the file
    line: int  # number of the header's line, counted from 1
    delimiter: str  # between the cells
    names: tuple[str, ...]  # of the columns, units taken off
    units: tuple[str | None, ...]  # of the columns; None where the header has none
    decimal: str = "."  # or a comma, where other signs separate the cells
    sheet: str = ""  # of a workbook

    @property
    def location(self) -> str:
        """File and line, or sheet and row, as messages begin."""
        return (
            f"{self.path}, sheet {short(plain(self.sheet))}, row {self.line}"
            if self.sheet
            else f"{self.path}, line {self.line}"
        )

    def listed(self, first: int = 0, *, units: bool = False) -> str:
        """Return the columns' names from number `first` on, as messages list them, and whether they are no text."""
        written = [f"{name} [{unit}]" if units and unit else name for name, unit in zip(self.names, self.units, strict=True)]
        names = short(", ".join(written[first:]))
        return f"{names}; the file is not text in UTF-8, save it as CSV in UTF-8" if "\ufffd" in names else names

    def factor(self, column: int, known: Mapping[str, float]) -> float:
        """Return the value of the column's unit in SI; RecordError if it has none, or one that is not known."""
        name, unit = short(self.names[column]), self.units[column]
        if unit is None:
            raise RecordError(
                f'{self.location}: column "{name}" has no unit. Write it behind the name, for instance '
                f'"{name} [{next(iter(known))}]"; known units: {", ".join(known)}.'
            )
        if unit in known:
            return known[unit]
        raise RecordError(
            f'{self.location}: column "{name}" has the unknown unit "{short(unit)}". Known units: {", ".join(known)}.'
        )


def read_header(path: Path, *, kind: str, example: str) -> Header:
    """Read the header of a CSV file, the first line that is neither empty nor begins with #, below metadata if there are any.

    Metadata are lines of text above a line with two units. Cells that are separated by semicolons or tabs may hold decimal
    commas. Messages say what the file should be, `kind`, as "cyclic test", and show an `example` of its header.

    Raises:
        RecordError: the file cannot be read, is empty or no text.
    """
    try:
        with regular(path).open(encoding="utf-8-sig", errors="replace") as file:
            header = first_header(_parsed(path, n, text) for n, text in enumerate(file, start=1) if _is_content(text))
            if header is not None and header.delimiter != ",":
                file.seek(0)
                return replace(header, decimal=_decimal_sign(header, file))
    except FileNotFoundError:
        raise RecordError(f"{path}: no such file. A {kind} is a CSV file with a header such as {example}.") from None
    except OSError as error:
        raise RecordError(f"{path}: the {kind} cannot be read: {why_unread(error)}") from None
    if header is None:
        raise RecordError(f"{path}: the file is empty. Expected a header such as {example} and rows of numbers.")
    return header


def first_header(rows: Iterable[Header]) -> Header | None:
    """Return the first row with two units among the rows of text that a table begins with, else its first row."""
    first = None
    for row in rows:
        first = first or row
        if sum(unit is not None for unit in row.units) >= 2:
            return row
        numbers = all(re.fullmatch(r"[-+.,\deE]*", name) for name in row.names)
        if row.line > _ABOVE or (numbers and len(row.names) > 1):
            break
    return first


def _decimal_sign(header: Header, lines: Iterable[str]) -> str:
    """Return the sign of the first number below a header that has decimals."""
    for text in itertools.islice(lines, header.line, None):
        for cell in text.split(header.delimiter):
            if match := _DECIMAL.fullmatch(_bare(cell)):
                return match[1]
    return "."


def rows_below(header: Header) -> Iterator[tuple[int, str, list[str]]]:
    """Yield line number, file and line for messages, and the cells of every row; empty lines and comments are skipped."""
    with header.path.open(encoding="utf-8-sig", errors="replace") as file:
        for line, text in enumerate(file, start=1):
            if line <= header.line or not _is_content(text):
                continue
            location = f"{header.path}, line {line}"
            if "[" in text:
                raise RecordError(
                    f'{location}: "{short(text.strip())}" looks like a second header after that in line {header.line}. '
                    "A file has one header and one unit for each quantity: convert the rows, or use two files."
                )
            cells = [_bare(cell) for cell in text.split(header.delimiter)]
            require_cells(header, location, cells)
            yield line, location, [with_point(header, location, cell) for cell in cells]


def rows_in_si(header: Header, units: Sequence[Mapping[str, float]]) -> list[tuple[float, ...]]:
    """Read the numbers below a header in SI; `units` are those that each column may have."""
    factors = [header.factor(number, known) for number, known in enumerate(units)]
    names = header.names
    return [
        tuple(in_si(number_in(place, *column), factor) for *column, factor in zip(names, cells, factors, strict=True))
        for _, place, cells in rows_below(header)
    ]


def with_points(header: Header, text: str) -> str:
    """Return a line of numbers with decimal points; a point in one with decimal commas makes what is no number."""
    return text if header.decimal == "." else text.translate(_SWAPPED)


def with_point(header: Header, location: str, cell: str) -> str:
    """Return a cell, its number with a decimal point; RecordError if the file's decimal sign is another."""
    match = _DECIMAL.fullmatch(cell) if header.decimal == "," else None
    if match is None:
        return cell
    if match[1] == ".":
        raise RecordError(
            f'{location}: "{short(cell)}" has a point and numbers above it have decimal commas. Write all with the same sign.'
        )
    return cell.replace(",", ".")


def require_cells(header: Header, location: str, cells: Sequence[str]) -> None:
    """Raise RecordError unless a row has as many cells as the header has columns."""
    count, columns = len(cells), len(header.names)
    if count == columns:
        return
    message = f"{location}: {count} cells where the header has {columns} columns."
    if count > columns and header.delimiter == ",":
        message += " Decimals are written with a point: here every comma separates two cells."
    elif count == 1 and (other := next((sign for sign in ";\t," if sign in cells[0]), None)):
        message += (
            f" The header's cells are separated by {_DELIMITERS[header.delimiter]}, those of this row by {_DELIMITERS[other]}."
        )
    raise RecordError(message)


def parse_number(cell: str) -> float:
    """Return the number in a cell; ValueError also for 1_000 and digits of other scripts, which Python takes."""
    if "_" in cell or not cell.isascii():
        raise ValueError(cell)
    return float(cell)


def number_in(location: str, name: str, cell: str) -> float:
    """Return the finite number in a cell of the column `name`; RecordError if it is none."""
    try:
        value = parse_number(cell)
    except ValueError:
        hint = ""
        if re.fullmatch(r"[-+.\deE]+\s*[a-zA-Zµ]+", cell):
            hint = " Units stand in the header only, one for each column."
        elif "," in cell:
            hint = " Decimals are written with a point, or all with a comma where semicolons or tabs separate the cells."
        raise RecordError(f'{location}: "{short(cell)}" in column "{short(name)}" is not a number.{hint}') from None
    if not abs(value) <= LARGEST:
        raise RecordError(
            f'{location}: {cell} in column "{name}" is no measured value; cut or repair the file before it is used.'
        )
    return value


def _is_content(text: str) -> bool:
    return bool(text.strip()) and not text.lstrip().startswith("#")


def _bare(cell: str) -> str:
    return cell.strip().strip('"').strip()


def _parsed(path: Path, line: int, text: str) -> Header:
    """Return the header that a line of names, each with a unit in brackets or without, makes."""
    if _CONTROL.search(text):
        kind = "NUL" if "\0" in text else "control"
        raise RecordError(
            f"{path}, line {line}: the header holds {kind} characters: this is no text, or text in UTF-16. Save it in UTF-8."
        )
    delimiter = next((sign for sign in _DELIMITERS if sign in text), ",")
    return header_of_cells(path, line, text.split(delimiter), delimiter)


def header_of_cells(path: Path, line: int, cells: Sequence[str], delimiter: str = "", sheet: str = "") -> Header:
    """Return the header that cells make, each a name with a unit in brackets or parentheses, or without."""
    names, units = [], []
    for cell in cells:
        bare = _bare(cell)
        match = re.fullmatch(r"(.*?)\s*(?:\[([^\]]*)\])?", bare)
        rounded = re.fullmatch(r"(.*?)\s*\(([^()]*)\)", bare)
        if rounded and rounded[2].strip() in _UNITS:
            match = rounded
        names.append(match[1] if match else cell.strip())
        units.append(match[2].strip() if match and match[2] is not None else None)
    return Header(path, line, delimiter, tuple(names), tuple(units), sheet=sheet)
