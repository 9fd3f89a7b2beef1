"""The numbers of a record's table, block by block; a fast path for files that are right, a slow one to name the wrong row."""

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.table_files import (
    LARGEST,
    is_comment,
    number_in,
    numbered_rows,
    open_rows,
    parse_number,
    require_cells,
    with_point,
)
from wirerope_mj.foundation.table_header import Header, is_missing

_BLOCK = 50_000  # rows that are read at once: a record may be longer than what fits into memory several times over
_FILL = 'have such samples filled with straight lines, gaps="fill" (--gaps fill), or use what lies before or behind'
Clock = Callable[[str], float]  # parser of a cell's clock time: instant [s]


def read_blocks(
    header: Header, columns: Sequence[int], clock: Clock | None = None, *, missing: bool = False
) -> Iterator[Array]:
    """Yield the columns' numbers block by block, (n, n_columns); the first column is time, which a `clock` may parse.

    Every row must have the header's number of cells: in one that has more or fewer, such as one with decimal commas between
    commas, nothing says which number belongs to which column. If `missing`, cells behind the time may be empty or NaN.
    RecordError: a row has another number of cells than the header, or a cell is no number or not finite.
    """
    converters: dict[int | str, Callable[[str], float]] = {}
    if missing:
        converters = dict.fromkeys(columns[1:], lambda cell: math.nan if is_missing(cell.strip()) else parse_number(cell))
    if clock is not None:
        converters[columns[0]] = clock
    plainly = header.content is None and header.delimiter != " " and header.decimal == "."
    delimiter, rows = (header.delimiter, _plain_rows(header)) if plainly else ("\t", _parsed_rows(header))
    while True:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # empty lines, and no line at all at the end
                block = np.loadtxt(
                    rows, delimiter=delimiter, comments=None, usecols=columns, ndmin=2, max_rows=_BLOCK,
                    converters=converters or None,
                )  # fmt: skip
        except ValueError:
            raise_for_bad_line(header, columns, clock, missing=missing)
            raise RecordError(
                f"{header.path}: a row behind the header in line {header.line} holds something else than numbers. Write "
                "it again as plain CSV in UTF-8."
            ) from None
        if not len(block):
            return
        if not np.all(np.abs(block) <= LARGEST):
            raise_for_bad_line(header, columns, clock, missing=missing)
        yield block


def _plain_rows(header: Header) -> Iterator[str]:
    """Yield the lines of numbers; ValueError at a line with another number of cells than the header."""
    signs, delimiter = len(header.names) - 1, header.delimiter
    blank = f' \t\r\n"{delimiter}'
    with open_rows(header) as lines:
        for line in lines:
            if line.count(delimiter) == signs and '"' not in line and line.strip(blank) and not is_comment(line):
                yield line
            elif line.strip(blank) and not is_comment(line):
                cells = header.cells(line)
                if len(cells) != signs + 1 or any(delimiter in cell for cell in cells):
                    raise ValueError("a row has another number of cells than the header")
                yield delimiter.join(cells)


def _parsed_rows(header: Header) -> Iterator[str]:
    """Yield the rows as lines of numbers with decimal points between tabs; ValueError if a row has too few or many."""
    for number, cells in numbered_rows(header):
        if len(cells) != len(header.names):
            raise ValueError("a row has another number of cells than the header")
        yield "\t".join(with_point(header, header.at(number), cell) for cell in cells)


def row_bound(path: Path) -> int:
    """Return an upper bound of the number of lines of a file, whatever its lines end with."""
    rows = 1
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            rows += block.count(b"\n") + block.count(b"\r")
    return rows


def raise_for_bad_line(header: Header, columns: Sequence[int], clock: Clock | None = None, *, missing: bool = False) -> None:
    """Raise RecordError that names the first row that cannot belong to a record, if there is one."""
    before, of_numbers = -math.inf, isinstance(header.content, np.ndarray)
    for number, cells in numbered_rows(header):
        location = f"{header.path}, row {number} of the numbers" if of_numbers else header.at(number)
        require_cells(header, location, cells)
        for column in columns:
            cell = cells[column] = with_point(header, location, cells[column])
            if column == columns[0] and clock is not None:
                try:
                    cells[column] = repr(clock(cell))
                except ValueError:
                    raise RecordError(
                        f'{location}: "{cell}" in column "{header.names[column]}" is no time as above it.'
                    ) from None
            elif not is_missing(cell):
                number_in(location, header.names[column], cell)
            elif not missing or column == columns[0]:
                remedy = "its time is needed" if column == columns[0] else _FILL
                raise RecordError(f'{location}: {cell or "an empty cell"} in column "{header.names[column]}"; {remedy}.')
        time = float(cells[columns[0]])
        if time <= before:
            fault = "repeats the row before" if time == before else f"comes after {before!r}"
            raise RecordError(f"{location}: time {time!r} {fault}; times must increase from row to row.")
        before = time
