"""Tables of numbers as CSV files, and what goes wrong with such files on their way from a test rig."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

STRANGE = (
    "nan", "NaN", "inf", "-inf", "", " ", "high", "1e300", "-1e300", "1e20", "1e-300", "5e-324", "1e999", "1_0", "0x1f", "1e",
    "--5", "1,5", "1.2.3", "12 mm", "=A1", "#REF!", "1e5e5", "\u0661", "\uff11", "+", ".", "TRUE", '"', '"1"', "1;5", "1\t5",
    "[g]", "\0", "9" * 400,
)  # fmt: skip
"""Cells that are no measured number, or none that anybody meant."""

UNUSABLE = {"inf", "-inf", "1e300", "-1e300", "1e20", "1e999", "9" * 400}
"""Those that Python takes for numbers, and that must be refused in a column that is read, or said."""


@dataclass
class Table:
    """A CSV file before it is written.

    Attributes:
        header: its columns' names with their units.
        rows: cells as text.
        sign: what separates the cells.
        before: lines before the header.
        end: what ends a line.
        encoding: of the file.
    """

    header: list[str]
    rows: list[list[str]]
    sign: str = ","
    before: list[str] = field(default_factory=list)
    end: str = "\n"
    encoding: str = "utf-8"

    def text(self) -> str:
        """Return the file's text."""
        lines = [*self.before, self.sign.join(self.header), *(self.sign.join(row) for row in self.rows)]
        return self.end.join(lines) + self.end

    def content(self) -> bytes:
        """Return the file's bytes."""
        return self.text().encode(self.encoding, errors="replace")


def table_of(names: list[str], columns: list[np.ndarray], sign: str = ",") -> Table:
    """Return numbers as a table with eight digits."""
    return Table(names, [[f"{value:.8g}" for value in row] for row in np.column_stack(columns)], sign)


def a_row(table: Table, rng: np.random.Generator) -> int:
    """Return the index of one of the rows."""
    return int(rng.integers(len(table.rows)))


def decimal_commas(table: Table, rng: np.random.Generator) -> bool | None:
    """Every decimal point becomes a comma; between commas nothing can tell the columns any more."""
    table.rows = [[cell.replace(".", ",") for cell in row] for row in table.rows]
    return False


def decimal_commas_in_a_column(table: Table, rng: np.random.Generator) -> bool | None:
    """The decimal points of one column become commas."""
    column, before = int(rng.integers(len(table.header))), table.text()
    for row in table.rows:
        row[column] = row[column].replace(".", ",")
    return table.text() == before


def decimal_comma_in_a_row(table: Table, rng: np.random.Generator) -> bool | None:
    """The decimal points of one row become commas."""
    index = int(np.argmax(["." in cell for row in table.rows for cell in row])) // len(table.header)
    index = max(index, a_row(table, rng))
    before = table.rows[index]
    table.rows[index] = [cell.replace(".", ",") for cell in before]
    return table.rows[index] == before


def extra_cell(table: Table, rng: np.random.Generator) -> bool | None:
    """One row has a cell more."""
    table.rows[a_row(table, rng)].insert(int(rng.integers(len(table.header) + 1)), str(rng.choice(["", "1", "0.5", "x"])))
    return False


def extra_cells(table: Table, rng: np.random.Generator) -> bool | None:
    """Every row has a cell more, which the header does not name."""
    place = int(rng.integers(len(table.header) + 1))
    for row in table.rows:
        row.insert(place, "1.5")
    return False


def missing_cell(table: Table, rng: np.random.Generator) -> bool | None:
    """One row lacks a cell."""
    table.rows[a_row(table, rng)].pop(int(rng.integers(len(table.header))))
    return False


def missing_cells(table: Table, rng: np.random.Generator) -> bool | None:
    """Every row lacks a cell."""
    place = int(rng.integers(len(table.header)))
    for row in table.rows:
        row.pop(place)
    return False


def other_sign_in_rows(table: Table, rng: np.random.Generator) -> bool | None:
    """The rows are separated by another sign than the header."""
    other = str(rng.choice([sign for sign in ",;\t|" if sign != table.sign]))
    table.rows = [[other.join(row)] for row in table.rows]
    return False


def another_sign(table: Table, rng: np.random.Generator) -> bool | None:
    """The file is separated by semicolons or tabs."""
    table.sign = str(rng.choice([";", "\t"]))
    return True


def decimal_commas_between_semicolons(table: Table, rng: np.random.Generator) -> bool | None:
    """Decimal commas, as a German spreadsheet writes them."""
    decimal_commas(table, rng)
    table.sign = ";"
    return None


def unit_removed(table: Table, rng: np.random.Generator) -> bool | None:
    """A column that is read has no unit."""
    table.header = [name.partition(" [")[0] for name in table.header]
    return False


def wrong_unit(table: Table, rng: np.random.Generator) -> bool | None:
    """Columns have a unit that nobody knows, or that of another quantity."""
    unit = str(rng.choice(["V", "", " ", "parsec", "]", "[", "kg", "m/s^3", "%"]))
    table.header = [f"{name.partition(' [')[0]} [{unit}]" for name in table.header]
    return False


def duplicated_name(table: Table, rng: np.random.Generator) -> bool | None:
    """Two columns have one name."""
    table.header[-1] = table.header[-2]
    return None


def duplicated_column(table: Table, rng: np.random.Generator) -> bool | None:
    """A column comes twice."""
    column = int(rng.integers(len(table.header)))
    for row in [table.header, *table.rows]:
        row.append(row[column])
    return None


def no_header(table: Table, rng: np.random.Generator) -> bool | None:
    """The file begins with its first row."""
    table.header = table.rows.pop(0)
    return False


def second_header(table: Table, rng: np.random.Generator) -> bool | None:
    """The header comes again amid the rows."""
    table.rows.insert(a_row(table, rng), list(table.header))
    return False


def strange_header(table: Table, rng: np.random.Generator) -> bool | None:
    """A name is nonsense."""
    table.header[int(rng.integers(len(table.header)))] = str(
        rng.choice(["", "[", "]", "[]", "x [g", "\ufffd", "time", "x" * 5000, "a]b[c"])
    )
    return None


def columns_in_another_order(table: Table, rng: np.random.Generator) -> bool | None:
    """The columns are shuffled, with their names."""
    order = rng.permutation(len(table.header))
    table.header = [table.header[place] for place in order]
    table.rows = [[row[place] for place in order] for row in table.rows]
    return None


def strange_cell(table: Table, rng: np.random.Generator) -> bool | None:
    """One cell is no number, or none that anybody meant."""
    cell, column = str(rng.choice(STRANGE)), int(rng.integers(len(table.header)))
    table.rows[a_row(table, rng)][column] = cell
    return False if cell in UNUSABLE - {"1e20"} else None


def strange_column(table: Table, rng: np.random.Generator) -> bool | None:
    """A column holds the same nonsense, or the same number, all along."""
    column, cell = int(rng.integers(len(table.header))), str(rng.choice([*STRANGE, "0", "-0.0", "7"]))
    for row in table.rows:
        row[column] = cell
    return None


def doubled_row(table: Table, rng: np.random.Generator) -> bool | None:
    """A row comes twice."""
    index = a_row(table, rng)
    table.rows.insert(index, list(table.rows[index]))
    return None


def lost_rows(table: Table, rng: np.random.Generator) -> bool | None:
    """Rows in the middle are lost."""
    first = 1 + a_row(table, rng) // 2
    del table.rows[first : first + int(rng.integers(1, 20))]
    return None


def shuffled_rows(table: Table, rng: np.random.Generator) -> bool | None:
    """The rows are in any order."""
    table.rows = [table.rows[place] for place in rng.permutation(len(table.rows))]
    return None


def reversed_rows(table: Table, rng: np.random.Generator) -> bool | None:
    """The last row comes first."""
    table.rows.reverse()
    return None


def few_rows(table: Table, rng: np.random.Generator) -> bool | None:
    """Hardly a row is left, or none."""
    count = int(rng.integers(4))
    table.rows = table.rows[:count]
    return False if count < 2 else None


def comments_and_blanks(table: Table, rng: np.random.Generator) -> bool | None:
    """Comments before the header, empty lines, and lines that end as on another system."""
    table.before = ["# rig 3, \u00b5-sensor", "", "#"]
    table.end = str(rng.choice(["\n", "\r\n", "\n\n", "\r"]))
    return True


def another_encoding(table: Table, rng: np.random.Generator) -> bool | None:
    """The file has a byte order mark, or is in UTF-16."""
    table.encoding = str(rng.choice(["utf-8-sig", "utf-16", "utf-16-le", "utf-32", "latin-1"]))
    return True if table.encoding in ("utf-8-sig", "latin-1") else None


DAMAGE: tuple[Callable[[Table, np.random.Generator], bool | None], ...] = (
    decimal_commas, decimal_commas_in_a_column, decimal_comma_in_a_row, extra_cell, extra_cells, missing_cell, missing_cells,
    other_sign_in_rows, another_sign, decimal_commas_between_semicolons, unit_removed, wrong_unit, duplicated_name,
    duplicated_column, no_header, second_header, strange_header, columns_in_another_order, strange_cell, strange_cell,
    strange_column, doubled_row, lost_rows, shuffled_rows, reversed_rows, few_rows, comments_and_blanks, another_encoding,
)  # fmt: skip
"""Each changes a table and returns whether it is valid still: True, the same numbers; False, to be refused; None, who knows."""


def damaged_bytes(content: bytes, rng: np.random.Generator) -> tuple[str, bytes]:
    """Return what happened to a file's bytes, and what is left of them."""
    kind = str(rng.choice(["truncated", "byte changed", "bytes changed", "bytes lost", "NUL bytes", "rubbish behind", "empty"]))
    data = bytearray(content)
    place = int(rng.integers(len(data)))
    if kind == "truncated":
        del data[place:]
    elif kind in ("byte changed", "bytes changed"):
        for here in rng.integers(len(data), size=1 if kind == "byte changed" else 30):
            data[int(here)] = int(rng.integers(256))
    elif kind == "bytes lost":
        del data[place : place + int(rng.integers(1, 200))]
    elif kind == "NUL bytes":
        data[place : place + 16] = bytes(16)
    elif kind == "rubbish behind":
        data += rng.bytes(100)
    else:
        data.clear()
    return kind, bytes(data)
