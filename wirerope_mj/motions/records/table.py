"""A measured record from a CSV file, read in blocks, or from another table: its channels, its numbers on the three axes.

There is a fast path for files that are right, and a slow one to name the line that is wrong.
"""

import math
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.csv_units import (
    LARGEST,
    Header,
    number_in,
    parse_number,
    read_header,
    require_cells,
    with_point,
    with_points,
)
from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.units import ACCELERATION_UNITS, TIME_UNITS
from wirerope_mj.motions.records.reading import Reading, axes_of
from wirerope_mj.motions.records.whole_tables import check_whole_table, is_whole_table, read_whole_table

_BLOCK = 50_000  # rows that are read at once: a record may be longer than what fits into memory several times over
_AXIS_COLUMN = re.compile(r"(?:(?:a|acc|acceleration)[ _]?)?([xyz])", re.IGNORECASE)


def read_blocks(header: Header, columns: Sequence[int], *, missing: bool = False) -> Iterator[Array]:
    """Yield the columns' numbers block by block, (n, n_columns); the first of them is time.

    Every row must have the header's number of cells: in one that has more or fewer, such as one with decimal commas between
    commas, nothing says which number belongs to which column. If `missing`, cells behind the time may be empty or NaN.
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
                        converters=(lambda cell: parse_number(cell) if cell.strip() else math.nan) if missing else None,
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
                cell = cells[column] = with_point(header, location, cells[column].strip())
                if cell and cell.lower().lstrip("+-") != "nan":
                    number_in(location, header.names[column], cell)
                elif not missing or column == columns[0]:
                    remedy = "its time is needed"
                    if column != columns[0]:
                        remedy = 'have such samples filled with straight lines, gaps="fill" (--gaps fill), or use what lies '
                        remedy += "before or behind"
                    found = f'{cell or "an empty cell"} in column "{header.names[column]}"'
                    raise RecordError(f"{location}: {found}; {remedy}.")
            time = float(cells[columns[0]])
            if time <= before:
                fault = "repeats the row before" if time == before else f"comes after {before!r}"
                raise RecordError(f"{location}: time {time!r} {fault}; times must increase from row to row.")
            before = time


def _full_rows(header: Header, lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines that are not empty; ValueError at one that has not as many cells as the header has columns."""
    signs = len(header.names) - 1
    for line in lines:
        if line.isspace():
            continue
        if line.count(header.delimiter) != signs:
            raise ValueError("a row has another number of cells than the header")
        yield with_points(header, line)


def table_channels(path: Path) -> tuple[str, ...]:
    """Return the names of all columns but the time."""
    return _opened(path)[0].names[1:]


def read_record_table(path: Path, channels: Mapping[str, Direction] | None, unit: str | None, *, fill: bool = False) -> Reading:
    """Return the accelerations in the columns of a table: a CSV, MATLAB, XLSX or Parquet file.

    Without `channels` they are in the columns named x, y and z, without a `unit` in the header's. With `fill` empty cells and
    NaN are filled with straight lines; else they are an error.
    """
    header, numbers = _opened(path)
    directions = _axis_columns(header) if channels is None else _named_columns(header, channels)
    units = [unit if unit is not None else _unit(header, column) for column in directions]
    factors = np.array([ACCELERATION_UNITS[name] for name in units])
    axes = axes_of(directions.values())
    time, samples, messages = _in_si(header, numbers, list(directions), factors[:, np.newaxis] * axes, fill=fill)
    return Reading(time, samples, tuple(dict.fromkeys(units)), tuple(messages))


def read_columns(path: Path, names: Sequence[str], *, fill: bool) -> tuple[Reading, tuple[str | None, ...]]:
    """Read columns of a table as they are, (n, n_columns), and the unit that its header gives each, None without one."""
    header, numbers = _opened(path)
    columns = list(_named_columns(header, dict.fromkeys(names, "x")))
    time, samples, messages = _in_si(header, numbers, columns, np.eye(len(columns)), fill=fill)
    units = tuple(header.units[column] for column in columns)
    return Reading(time, samples, (), tuple(messages)), units


def _in_si(
    header: Header, numbers: Array | None, chosen: Sequence[int], matrix: Array, *, fill: bool
) -> tuple[Array, Array, list[str]]:
    """Return instants [s], (n,), the chosen columns times a matrix (n_columns, k), and what had to be filled."""
    path, columns = header.path, [0, *chosen]
    time_factor = header.factor(0, TIME_UNITS)
    blocks: Iterable[Array]
    if numbers is None:
        most = most_rows(path)  # memory that is not written to costs nothing: a long record stands in memory once
        blocks = read_blocks(header, columns, missing=fill)
    else:
        most, blocks = len(numbers), [numbers[:, columns]]
        names = tuple(header.names[column] for column in columns)
        check_whole_table(path, names, blocks[0], missing=fill)
    time, samples, size = np.empty(most), np.empty((most, matrix.shape[1])), 0
    messages: list[str] = []
    if fill:
        blocks, messages = _filled(header, columns, list(blocks))
    for block in blocks:
        rows = slice(size, size + len(block))
        np.multiply(block[:, 0], time_factor, out=time[rows])
        np.matmul(block[:, 1:], matrix, out=samples[rows])
        size = rows.stop
    if size < 2:
        raise RecordError(f"{path}: a record needs at least 2 rows of numbers, this one has {size}.")
    time, samples = time[:size], samples[:size]
    if np.any(time[1:] <= time[:-1]):
        name_bad_line(header, columns, missing=fill)
    return time, samples, messages


def _opened(path: Path) -> tuple[Header, Array | None]:
    """Return the header of a table, and its numbers if it is read whole; RecordError if its first column is not time."""
    if is_whole_table(path):
        return read_whole_table(path)
    header = read_header(path, kind="record", example='"time [s], z [g]"')
    if header.names[0].lower() not in ("time", "t"):
        raise RecordError(
            f'{header.location}: the first column must be time, as in "time [s], z [g]"; the columns are {header.listed()}.'
        )
    return header, None


def _filled(header: Header, columns: Sequence[int], blocks: list[Array]) -> tuple[list[Array], list[str]]:
    """Return the blocks of numbers with straight lines where samples are missing, joined if there are any, and warnings."""
    if all(np.all(np.isfinite(block)) for block in blocks):
        return blocks, []
    numbers, messages = np.concatenate(blocks), []
    time = numbers[:, 0]
    for column, values in zip(columns[1:], numbers[:, 1:].T, strict=True):
        missing = np.isnan(values)
        if not missing.any():
            continue
        rows = np.flatnonzero(missing)
        text = f'{rows.size} {"sample" if rows.size == 1 else "samples"} missing in column "{header.names[column]}"'
        if missing[0] or missing[-1]:
            raise RecordError(
                f"{header.path}: {text}, also at the {'beginning' if missing[0] else 'end'}, where no straight line can "
                "be drawn. Cut the record there."
            )
        starts = rows[np.flatnonzero(np.diff(rows, prepend=-2) > 1)]
        listed = [f"at {time[row]:.6g} s" for row in starts[:3]] + ["..."] * (starts.size > 3)
        values[missing] = np.interp(time[missing], time[~missing], values[~missing])
        messages.append(f"{text} ({', '.join(listed)}) filled with straight lines.")
    return [numbers], messages


def _unit(header: Header, column: int) -> str:
    header.factor(column, ACCELERATION_UNITS)
    return str(header.units[column])


def _named_columns(header: Header, channels: Mapping[str, Direction]) -> dict[int, Direction]:
    """Return the indices of the columns asked for, with their directions."""
    for name in channels:
        count = header.names[1:].count(name)
        if count != 1:
            fault = f'there is no column "{name}"' if count == 0 else f'there are {count} columns "{name}"'
            raise RecordError(f"{header.location}: {fault}; the columns are {header.listed(1)}.")
    return {header.names.index(name, 1): direction for name, direction in channels.items()}


def _axis_columns(header: Header) -> dict[int, Direction]:
    """Return the indices of the columns that are named after an axis, with their directions."""
    columns: dict[int, Direction] = {}
    for column, name in enumerate(header.names[1:], start=1):
        match = _AXIS_COLUMN.fullmatch(name)
        if not match:
            continue
        axis = match[1].lower()
        if axis in columns.values():
            raise RecordError(
                f'{header.location}: "{name}" is a second column for direction {axis}. '
                f'Choose with channels={{"{name}": "{axis}"}} (--channels {name}={axis}).'
            )
        columns[column] = axis
    if not columns:
        example = header.names[-1] if len(header.names) > 1 else "ch1"
        option = f'"{example}=z"' if " " in example else f"{example}=z"
        alone = " or, with one column, --direction z" if len(header.names) == 2 else ""
        raise RecordError(
            f"{header.location}: no column is named x, y or z; the columns are {header.listed()}. Say which one moves "
            f'the base where, for instance channels={{"{example}": "z"}} (--channels {option}{alone}).'
        )
    return columns
