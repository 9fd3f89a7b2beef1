"""The text of a table, edited cell by cell: comments, units, order and spacing stay as they are written."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from wirerope_mj.engine.from_tables.read import COLUMNS, FURTHER
from wirerope_mj.engine.from_tables.sheet import PURE, TEXT, with_unit
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.table_files import is_comment, read_header
from wirerope_mj.foundation.table_header import Header
from wirerope_mj.foundation.units import UNITS

_DIGITS = 9  # of a number that is written: a micrometre of a kilometre in mm


@dataclass(frozen=True)
class TableText:
    """A table as text: its lines, with what ends them, and its header."""

    kind: str  # of the table, a key of `COLUMNS` or `FURTHER`
    lines: tuple[str, ...]
    header: Header

    @classmethod
    def read(cls, kind: str, path: Path) -> "TableText":
        """Read a table; RecordError as `read_header` raises it, or if it is no text."""
        header = read_header(path, kind=f"table of {kind}", example="name", sheet=kind)
        if header.sheet or header.content is not None:
            raise RecordError(f"{path}: the board edits tables in CSV alone; save this one as CSV beside the others.")
        with path.open(encoding=header.encoding, newline="") as file:
            return cls(kind, tuple(file.read().splitlines(keepends=True)), header)

    @property
    def text(self) -> str:
        return "".join(self.lines)

    @property
    def rows(self) -> dict[str, dict[str, str]]:
        """Cells by row and column, as they are written."""
        return {cells["name"]: cells for _, cells in self._numbered()}

    def unit(self, column: str) -> str:
        """Return the unit in which a column is written, or would be; "" of one without."""
        kind = self._quantity(column)
        if kind in (PURE, TEXT):
            return ""
        known = UNITS[kind]
        return self.header.known_unit(self.header.names.index(column), known) if self.has(column) else next(iter(known))

    def has(self, column: str) -> bool:
        return column in self.header.names

    def value(self, row: str, column: str) -> float:
        """Return the value of a cell [SI]; ValueError if it is no number."""
        unit = self.unit(column)
        number = float(self.rows[row][column].replace(self.header.decimal, "."))
        return number * (UNITS[self._quantity(column)][unit] if unit else 1.0)

    def written(self, column: str, value: float) -> str:
        """Write a value [SI] in the unit of a column."""
        unit = self.unit(column)
        value /= UNITS[self._quantity(column)][unit] if unit else 1.0
        return f"{round(value, _DIGITS) + 0.0:.{_DIGITS}g}".replace(".", self.header.decimal)

    def with_cells(self, row: str, cells: Mapping[str, str]) -> "TableText":
        """Write cells of a row; a column that the table has not is added if its cell is not empty."""
        table = self
        for column, text in cells.items():
            if not table.has(column):
                if not text:
                    continue
                table = table._with_column(column)
            number = next(number for number, known in table._numbered() if known["name"] == row)
            place = table.header.names.index(column)
            table = table._with_line(number, _with_cell(table.lines[number], table.header.delimiter, place, text))
            row = text if column == "name" else row
        return table

    def with_row(self, name: str, cells: Mapping[str, str], *, like: str) -> "TableText":
        """Add a row below the last one, a copy of the row `like` but for its name and some cells."""
        numbers = {known["name"]: number for number, known in self._numbered()}
        last, copied = max(numbers.values()), self.lines[numbers[like]]
        end = "" if self.lines[last].endswith(("\n", "\r")) else "\n"
        copied = _with_cell(copied, self.header.delimiter, self.header.names.index("name"), name)
        copied += "" if copied.endswith(("\n", "\r")) or end else "\n"
        lines = (*self.lines[:last], self.lines[last] + end, copied, *self.lines[last + 1 :])
        return replace(self, lines=lines).with_cells(name, cells)

    def free_name(self, row: str) -> str:
        """Return the first name with the letters of a row's that no row has."""
        stem = row.rstrip("0123456789")
        return next(name for n in range(1, len(self.rows) + 2) if (name := f"{stem}{n}") not in self.rows)

    def without_row(self, name: str) -> "TableText":
        numbers = {number for number, known in self._numbered() if known["name"] == name}
        return replace(self, lines=tuple(line for number, line in enumerate(self.lines) if number not in numbers))

    def _numbered(self) -> Iterator[tuple[int, dict[str, str]]]:
        """Yield number of the line, from 0, and cells of each row by column."""
        for number, line in enumerate(self.lines[self.header.last :], start=self.header.last):
            if not is_comment(line) and any(cells := self.header.cells(line.rstrip("\r\n"))):
                yield number, dict(zip(self.header.names, cells, strict=False))

    def _quantity(self, column: str) -> str:
        needed, further = {**COLUMNS, **FURTHER}[self.kind]
        known = {**needed, **further}
        if column not in known:
            raise RecordError(f"a table of {self.kind} has no column {short(column)!r}; it may have {', '.join(known)}.")
        return known[column]

    def _with_line(self, number: int, text: str) -> "TableText":
        return replace(self, lines=(*self.lines[:number], text, *self.lines[number + 1 :]))

    def _with_column(self, column: str) -> "TableText":
        """Add a column behind the last one, with empty cells."""
        header, sign = self.header, self.header.delimiter
        if sign == " ":
            raise RecordError(f"{header.location}: cells that spaces separate cannot be empty; separate them by commas.")
        unit = self.unit(column)
        below = header.last > header.line  # units stand in a row of their own
        name = column if below else with_unit(column, self._quantity(column))
        table = self._with_line(header.line - 1, _longer(self.lines[header.line - 1], sign, name))
        if below:
            table = table._with_line(header.last - 1, _longer(table.lines[header.last - 1], sign, unit))
        for number, cells in self._numbered():
            missing = len(header.names) - len(cells)
            table = table._with_line(number, _longer(table.lines[number], sign * (missing + 1), ""))
        return replace(table, header=replace(header, names=(*header.names, column), units=(*header.units, unit or None)))


def _longer(line: str, sign: str, text: str) -> str:
    """Add a cell to a line."""
    content = line.rstrip("\r\n")
    return f"{content.rstrip()}{sign}{' ' * (sign == ',' and bool(text))}{text}{line[len(content) :]}"


def _with_cell(line: str, sign: str, place: int, text: str) -> str:
    """Write a cell of a line between the spaces that stand around it; RecordError if it cannot stand there."""
    if '"' in text or "\n" in text or (sign == " " and not text.strip()):
        raise RecordError(f"{short(text)!r} cannot stand in a cell of this table.")
    if sign in text:
        text = f'"{text}"'
    content = line.rstrip("\r\n")
    apart = r"\s+" if sign == " " else re.escape(sign)
    ends = [match.span() for match in re.finditer(rf'{apart}(?=(?:[^"]*"[^"]*")*[^"]*$)', content)]
    first = ends[place - 1][1] if place else 0
    last = ends[place][0] if place < len(ends) else len(content)
    old = content[first:last]
    lead, trail = old[: len(old) - len(old.lstrip())], old[len(old.rstrip()) :] if old.strip() else ""
    return f"{content[:first]}{lead}{text}{trail}{content[last:]}{line[len(content) :]}"
