"""Numbers of a long CSV record, in blocks: a fast path for files that are right, a slow one to name the line that is wrong."""

import math
import warnings
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.csv_units import LARGEST, Header, number_in, parse_number, require_cells
from wirerope_mj.foundation.errors import RecordError

_BLOCK = 50_000  # rows that are read at once: a record may be longer than what fits into memory several times over


def read_blocks(header: Header, columns: Sequence[int], *, missing: bool = False) -> Iterator[Array]:
    """Yield the columns' numbers block by block, (n, n_columns); the first of them is time.

    Every row must have the header's number of cells: in one that has more or fewer, such as one with decimal commas between
    commas, nothing says which number belongs to which column.

    Args:
        header: of the file.
        columns: indices of the columns.
        missing: whether cells behind the time may be empty or NaN; both are NaN then.

    Raises:
        RecordError: a row has another number of cells than the header, or a cell is no number or not finite.
    """
    with header.path.open(encoding="latin-1") as file:  # numbers are ASCII; comments of any encoding are skipped
        for _ in range(header.line):
            file.readline()
        rows = _full_rows(header, file)
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


def most_rows(path: Path) -> int:
    """Return a number of lines that the file does not exceed, whatever its lines end with."""
    rows = 1
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            rows += block.count(b"\n") + block.count(b"\r")
    return rows


def name_bad_line(header: Header, columns: Sequence[int], *, missing: bool = False) -> None:
    """Raise RecordError that names the first line that cannot belong to a record, if there is one."""
    before = -math.inf
    with header.path.open(encoding="utf-8-sig", errors="replace") as lines:
        for number, text in enumerate(lines, start=1):
            if number <= header.line or not text.strip():
                continue
            location = f"{header.path}, line {number}"
            cells = text.rstrip("\r\n").split(header.delimiter)
            require_cells(header, location, cells)
            for column in columns:
                cell = cells[column].strip()
                if cell and cell.lower().lstrip("+-") != "nan":
                    number_in(location, header.names[column], cell)
                elif not missing or column == columns[0]:
                    raise RecordError(_missing_text(location, header.names[column], cell, is_time=column == columns[0]))
            time = float(cells[columns[0]])
            if time <= before:
                fault = "repeats the row before" if time == before else f"comes after {before!r}"
                raise RecordError(f"{location}: time {time!r} {fault}; times must increase from row to row.")
            before = time


def _missing_text(location: str, name: str, cell: str, *, is_time: bool) -> str:
    remedy = (
        "its time is needed"
        if is_time
        else 'have such samples filled with straight lines, gaps="fill" (--gaps fill), or use what lies before or behind'
    )
    return f'{location}: {cell or "an empty cell"} in column "{name}"; {remedy}.'


def _full_rows(header: Header, lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines that are not empty; ValueError at one that has not as many cells as the header has columns."""
    signs = len(header.names) - 1
    for line in lines:
        if line.isspace():
            continue
        if line.count(header.delimiter) != signs:
            raise ValueError("a row has another number of cells than the header")
        yield line


def _number_or_nan(cell: str) -> float:
    return parse_number(cell) if cell.strip() else math.nan
