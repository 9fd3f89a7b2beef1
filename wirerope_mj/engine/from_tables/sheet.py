"""A table of a model: a CSV file, or a sheet of an XLSX file, with units in its header."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.table_files import number_in, read_header, rows_below
from wirerope_mj.foundation.table_header import Header
from wirerope_mj.foundation.units import UNITS, in_si

PURE, TEXT = "number", "text"  # kinds of columns that need no unit
BESIDE = "beside"  # column that is not read


@dataclass(frozen=True)
class Row:
    """A row of a table: its cells as texts, by the names of the columns."""

    location: str  # file and line or row, as messages begin
    cells: Mapping[str, str]  # texts; a column that is not in the table is not here
    kinds: Mapping[str, str]  # of quantity, by column
    factors: Mapping[str, float]  # of the columns' units, in SI
    written: Mapping[str, str]  # the columns' names in the file

    def error(self, text: str) -> RecordError:
        """Build an error that begins with the location of this row."""
        return RecordError(f"{self.location}: {text}")

    def has(self, column: str) -> bool:
        return bool(self.cells.get(column, ""))

    def text(self, column: str) -> str:
        """Return the text of a cell; RecordError if it is empty or holds invisible characters."""
        text = self.cells.get(column, "")
        if not text:
            raise self.error(f'column "{column}" is empty.')
        if plain(text) != text:
            raise self.error(f'column "{column}" holds characters that cannot be seen.')
        return text

    def number(self, column: str, default: float | None = None) -> float:
        """Return the value of a cell in SI, the default where it is empty; RecordError if it is no finite number."""
        if not self.has(column):
            if default is not None:
                return default
            raise self.error(f'column "{column}" is empty; a number is needed.')
        value = number_in(self.location, column, self.cells[column])
        if self.kinds[column] == "angle":  # to twelve digits, as `in_si` rounds, a right angle would not be one
            return value * self.factors[column]
        return in_si(value, self.factors[column])

    def vector(self, *columns: str) -> tuple[float, float, float]:
        """Return the values of three columns in SI."""
        x, y, z = (self.number(column) for column in columns)
        return x, y, z


def read_sheet(
    path: Path, *, kind: str, needed: Mapping[str, str], further: Mapping[str, str],
    called: Callable[[Sequence[str]], tuple[str, ...]] = tuple,
) -> list[Row]:  # fmt: skip
    """Read the rows of a table; of a workbook, from the sheet that the last word of `kind` names.

    `needed` and `further` say the kind of quantity of each column that must and may be there: a key of `UNITS`, "number" or
    "text". `called` translates the names of the columns in the file into ours; those that become `BESIDE` are skipped.

    Raises:
        RecordError: says file, row and column that are wrong.
    """
    example = ", ".join(with_unit(name, quantity) for name, quantity in needed.items())
    header = read_header(path, kind=kind, example=f'"{example}"', sheet=kind.split()[-1])
    header, names = replace(header, names=called(header.names)), header.names
    known = {**needed, **further}
    cells = [(location, row) for _, location, row in rows_below(header)]
    empty = {i for i in header.unnamed if not any(row[i] for _, row in cells)}
    empty |= {i for i, name in enumerate(header.names) if name == BESIDE}
    factors = _factors(header, needed, known, empty)
    rows = [
        Row(
            location,
            {name: row[i] for i, name in enumerate(header.names) if i not in empty},
            known,
            factors,
            dict(zip(header.names, names, strict=True)),
        )
        for location, row in cells
    ]
    if not rows:
        raise RecordError(f"{path}: the {kind} has a header and no rows.")
    first: dict[str, str] = {}
    for row in rows:
        if (name := row.text("name")) in first:
            raise row.error(f'the name "{short(name)}" is given twice, first in {first[name]}.')
        first[name] = row.location
    return rows


def with_unit(name: str, quantity: str) -> str:
    return name if quantity in {PURE, TEXT} else f"{name} [{next(iter(UNITS[quantity]))}]"


def _factors(header: Header, needed: Mapping[str, str], known: Mapping[str, str], empty: set[int]) -> dict[str, float]:
    """Return the factor of each column's unit; RecordError if a column is unknown, missing, there twice or without unit.

    Columns that are empty and have no name are not looked at.
    """
    for number, name in enumerate(header.names):
        if number in empty:
            continue
        if number in header.unnamed:
            raise RecordError(f"{header.location}: {name} has no name and holds something. Name it, or empty it.")
        if name not in known:
            hint = ", ".join(with_unit(*item) for item in known.items())
            raise RecordError(f'{header.location}: unknown column "{short(plain(name))}". Known columns: {hint}.')
        if header.names.count(name) > 1:
            raise RecordError(f'{header.location}: column "{name}" stands there twice.')
    if missing := [with_unit(name, quantity) for name, quantity in needed.items() if name not in header.names]:
        listed = ", ".join(f'"{name}"' for name in missing)
        raise RecordError(
            f"{header.location}: {f'columns {listed} are' if missing[1:] else f'column {listed} is'} missing. "
            f"The header has {header.listed(units=True)}."
        )
    factors = {}
    for number, name in enumerate(header.names):
        if number in empty:
            continue
        plain_kind = known[name] in {PURE, TEXT}
        if plain_kind and header.units[number] not in {None, "", "-", "1"}:
            raise RecordError(f'{header.location}: column "{name}" has no unit; write "{name}".')
        factors[name] = 1.0 if plain_kind else header.factor(number, UNITS[known[name]])
    return factors
