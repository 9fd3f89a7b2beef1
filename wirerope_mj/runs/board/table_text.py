"""The text of a table, edited cell by cell: comments, units, order and spacing stay as they are written."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
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
        return {name: cells for name, (_, cells) in self._numbered.items()}

    @cached_property
    def _numbered(self) -> dict[str, tuple[int, dict[str, str]]]:
        """Index of the line and cells of each row."""
        lines = enumerate(self.lines[self.header.last :], start=self.header.last)
        rows = [(number, self.header.cells(line.rstrip("\r\n"))) for number, line in lines if not is_comment(line)]
        named = [(number, dict(zip(self.header.names, cells, strict=False))) for number, cells in rows if any(cells)]
        return {cells["name"]: (number, cells) for number, cells in named}

    def unit(self, column: str) -> str:
        """Return the unit in which a column is written, or would be if it were added; "" of one without."""
        kind = self._quantity(column)
        if kind in (PURE, TEXT):
            return ""
        known = UNITS[kind]
        return self.header.known_unit(self.header.names.index(column), known) if self.has(column) else next(iter(known))

    def has(self, column: str) -> bool:
        return column in self.header.names

    def with_cells(self, row: str, cells: Mapping[str, str | float]) -> "TableText":
        """Write cells of a row, numbers [SI] in the units of their columns.

        A column that the table has not is added if its cell is not empty.
        """
        table = self
        for column, cell in cells.items():
            if cell != "" and not table.has(column):
                table = table._with_column(column)
        number = self._numbered[row][0]
        line = table.lines[number]
        for column, cell in cells.items():
            if table.has(column):
                if not isinstance(cell, str):
                    unit = table.unit(column)
                    value = cell / (UNITS[table._quantity(column)][unit] if unit else 1.0)
                    cell = f"{round(value, _DIGITS) + 0.0:.{_DIGITS}g}".replace(".", table.header.decimal)
                line = _with_cell(line, table.header.delimiter, table.header.names.index(column), cell)
        return replace(table, lines=(*table.lines[:number], line, *table.lines[number + 1 :]))

    def with_row(self, name: str, *, like: str) -> "TableText":
        """Add a row below the last one, a copy of the row `like` but for its name."""
        last, copied = max(number for number, _ in self._numbered.values()), self.lines[self._numbered[like][0]]
        end = "" if self.lines[last].endswith(("\n", "\r")) else "\n"
        copied = _with_cell(copied, self.header.delimiter, self.header.names.index("name"), name)
        copied += "" if copied.endswith(("\n", "\r")) or end else "\n"
        return replace(self, lines=(*self.lines[:last], self.lines[last] + end, copied, *self.lines[last + 1 :]))

    def free_name(self, row: str) -> str:
        """Return a name that no row has: the letters of another row's name and the first free number."""
        stem = row.rstrip("0123456789")
        return next(name for n in range(1, len(self.rows) + 2) if (name := f"{stem}{n}") not in self.rows)

    def without_row(self, name: str) -> "TableText":
        number = self._numbered[name][0]
        return replace(self, lines=self.lines[:number] + self.lines[number + 1 :])

    def _quantity(self, column: str) -> str:
        """Return the quantity in a column, a key of `UNITS`, `PURE` or `TEXT`; RecordError if the table cannot have it."""
        needed, further = {**COLUMNS, **FURTHER}[self.kind]
        known = {**needed, **further}
        if column not in known:
            raise RecordError(f"a table of {self.kind} has no column {short(column)!r}; it may have {', '.join(known)}.")
        return known[column]

    def _with_column(self, column: str) -> "TableText":
        """Add a column behind the last one, with empty cells."""
        header, sign = self.header, self.header.delimiter
        if sign == " ":
            raise RecordError(f"{header.location}: cells that spaces separate cannot be empty; separate them by commas.")
        unit = self.unit(column)
        below = header.last > header.line  # units stand in a row of their own
        heading = column if below else with_unit(column, self._quantity(column))
        missing = {number: len(header.names) - len(cells) for number, cells in self._numbered.values()}
        headings = {header.line - 1: heading} | ({header.last - 1: unit} if below else {})
        lines = list(self.lines)
        for number in (*headings, *missing):
            content, cell = lines[number].rstrip("\r\n"), headings.get(number, "")
            signs = sign * (missing.get(number, 0) + 1) + " " * (sign == "," and bool(cell))
            lines[number] = f"{content.rstrip()}{signs}{cell}{lines[number][len(content) :]}"
        header = replace(header, names=(*header.names, column), units=(*header.units, unit or None))
        return replace(self, lines=tuple(lines), header=header)


def _with_cell(line: str, sign: str, place: int, text: str) -> str:
    """Write a cell of a line between the spaces that stand around it; RecordError if it cannot stand there."""
    if '"' in text or "\n" in text or (sign == " " and not text.strip()):
        raise RecordError(f"{short(text)!r} cannot stand in a cell of this table.")
    content = line.rstrip("\r\n")
    separator = r"\s+" if sign == " " else re.escape(sign)
    parts = re.split(rf'({separator})(?=(?:[^"]*"[^"]*")*[^"]*$)', content)  # cells, and what stands between them
    text = f'"{text}"' if sign in text else text
    parts[2 * place] = re.sub(r"^(\s*).*?(\s*)$", lambda spaces: f"{spaces[1]}{text}{spaces[2]}", parts[2 * place], count=1)
    return "".join(parts) + line[len(content) :]
