"""Tables of measured columns that are read whole: MATLAB, XLSX and Parquet files, as a header and numbers."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.csv_units import LARGEST, Header, first_header, header_of_cells, number_in
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.parquet_files import read_table
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.xlsx_rows import xlsx_rows

_TIME = re.compile(r"(?:time|t)(?:_(m?s))?", re.IGNORECASE)
_REMEDY = "Export it again, or as CSV."


def is_whole_table(path: Path) -> bool:
    """Return whether a file's ending is that of a MATLAB, XLSX or Parquet file."""
    return path.suffix.lower() in _READERS


def read_whole_table(path: Path) -> tuple[Header, Array]:
    """Read all columns of numbers, (n, n_columns), NaN where a cell is empty, and their header; time is the first of them.

    A unit stands in brackets behind a column's name, or nowhere. The time is the column "time" or "t", also "time_s".
    RecordError: the file cannot be read, or has no time.
    """
    header, columns = _READERS[path.suffix.lower()](path)
    times = [number for number, name in enumerate(header.names) if _TIME.fullmatch(name)]
    if len(times) != 1:
        raise RecordError(
            f'{header.location}: one column must be the time, called "time [s]" or "t [s]", got {len(times) or "none"}; '
            f"the columns are {header.listed()}."
        )
    order = [times[0], *(number for number in range(len(header.names)) if number != times[0])]
    match = _TIME.fullmatch(header.names[times[0]])
    units = [header.units[number] for number in order]
    units[0] = units[0] or (match[1] if match else None)
    names = tuple(header.names[number] for number in order)
    return Header(path, header.line, "", names, tuple(units)), columns[:, order]


def check_whole_table(path: Path, names: Sequence[str], numbers: Array, *, missing: bool) -> None:
    """Raise RecordError that names row and column of what cannot belong to a record, in numbers whose first column is time."""
    usable = np.abs(numbers) <= LARGEST
    if missing:
        usable[:, 1:] |= np.isnan(numbers[:, 1:])
    if not usable.all():
        row, column = np.argwhere(~usable)[0]
        raise RecordError(
            f'{path}: {numbers[row, column]} in column "{names[column]}", row {row + 1} of the numbers, is no '
            'measured value. Cut or repair the file, or have gaps filled with straight lines, gaps="fill" (--gaps fill).'
        )
    late = np.flatnonzero(np.diff(numbers[:, 0]) <= 0.0)
    if late.size:
        row = int(late[0]) + 1
        raise RecordError(
            f"{path}: time {numbers[row, 0]!r} in row {row + 1} of the numbers comes after {numbers[row - 1, 0]!r}; "
            "times must increase from row to row."
        )


def _of_columns(path: Path, columns: Mapping[str, Array]) -> tuple[Header, Array]:
    """Return the columns that have the most common length, with their header."""
    lengths = [column.size for column in columns.values() if column.size > 1]
    if not lengths:
        raise RecordError(f"{path}: the file holds no columns of numbers. {_REMEDY}")
    usual = max(lengths, key=lengths.count)
    kept = {name: column for name, column in columns.items() if column.size == usual}
    return header_of_cells(path, 1, list(kept)), np.column_stack(list(kept.values()))


def _parquet(path: Path) -> tuple[Header, Array]:
    table = read_table(path, kind="a Parquet file", remedy=_REMEDY)
    columns = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        values = column.to_numpy()
        if values.dtype.kind in "fiu":
            columns[str(name)] = values.astype(np.float64)
    return _of_columns(path, columns)


def _mat(path: Path) -> tuple[Header, Array]:
    from scipy.io import loadmat

    try:
        content = loadmat(regular(path))
    except OSError as error:
        raise RecordError(f"{path}: the record cannot be read: {why_unread(error)}") from None
    except NotImplementedError:  # version 7.3, which is HDF5
        raise RecordError(f'{path}: MATLAB files of version 7.3 are not read. Save it with "-v7", or as CSV.') from None
    except Exception:  # the reader raises what its parsers raise
        raise RecordError(f"{path}: this is no MATLAB file that can be read. {_REMEDY}") from None
    columns = {}
    for name, values in content.items():
        if isinstance(values, np.ndarray) and values.dtype.kind in "fiu" and values.size == max(values.shape, default=0):
            columns[name] = values.ravel().astype(np.float64)
    return _of_columns(path, columns)


def _xlsx(path: Path) -> tuple[Header, Array]:
    sheet, filled = xlsx_rows(path)
    header = first_header(header_of_cells(path, row, [cell for cell in cells if cell], sheet=sheet) for row, cells in filled)
    below = [(row, cells) for row, cells in filled if header is not None and row > header.line]
    if header is None or not below:
        raise RecordError(f'{path}: the first sheet must hold a header such as "time [s], A1 [g]" and rows of numbers.')
    width = len(header.names)
    numbers = np.full((len(below), width), np.nan)
    for values, (row, cells) in zip(numbers, below, strict=True):
        for column, cell in enumerate(cells[:width]):
            if cell:
                values[column] = number_in(replace(header, line=row).location, header.names[column], cell)
    return header, numbers


_READERS = {".mat": _mat, ".parquet": _parquet, ".xlsx": _xlsx, ".xlsm": _xlsx}
