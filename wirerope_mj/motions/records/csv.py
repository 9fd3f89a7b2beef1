"""A measured record from a CSV file: its channels, and their numbers on the three axes."""

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.csv_units import Header, read_header
from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.units import ACCELERATION_UNITS, TIME_UNITS
from wirerope_mj.motions.records.blocks import most_rows, name_bad_line, read_blocks
from wirerope_mj.motions.records.reading import Reading, axes_of

_AXIS_COLUMN = re.compile(r"(?:(?:a|acc|acceleration)[ _]?)?([xyz])", re.IGNORECASE)


def csv_channels(path: Path) -> tuple[str, ...]:
    """Return the names of all columns but the time."""
    return _header(path).names[1:]


def read_csv(path: Path, channels: Mapping[str, Direction] | None, unit: str | None, *, fill: bool = False) -> Reading:
    """Return the accelerations in the columns of a CSV file.

    Args:
        path: of the file.
        channels: columns and their directions; None: the columns named x, y and z.
        unit: of the accelerations, in place of what the header says; None: the header's.
        fill: whether empty cells and NaN are filled with straight lines; else they are an error.
    """
    header = _header(path)
    directions = _axis_columns(header) if channels is None else _named_columns(header, channels)
    columns, axes = [0, *directions], axes_of(directions.values())
    time_factor = header.factor(0, TIME_UNITS)
    units = [unit if unit is not None else _unit(header, column) for column in directions]
    factors = np.array([ACCELERATION_UNITS[name] for name in units])

    most = most_rows(path)  # memory that is not written to costs nothing: a long record stands in memory once
    time, samples, size = np.empty(most), np.empty((most, 3)), 0
    blocks: Iterable[Array] = read_blocks(header, columns, missing=fill)
    messages: list[str] = []
    if fill:
        blocks, messages = _filled(header, columns, list(blocks))
    for numbers in blocks:
        rows = slice(size, size + len(numbers))
        np.multiply(numbers[:, 0], time_factor, out=time[rows])
        np.matmul(numbers[:, 1:] * factors, axes, out=samples[rows])
        size = rows.stop
    if size < 2:
        raise RecordError(f"{path}: a record needs at least 2 rows of numbers, this one has {size}.")
    time, samples = time[:size], samples[:size]
    if np.any(time[1:] <= time[:-1]):
        name_bad_line(header, columns, missing=fill)
    return Reading(time, samples, tuple(dict.fromkeys(units)), tuple(messages))


def _header(path: Path) -> Header:
    """Return the header of a record, or raise RecordError if its first column is not time."""
    header = read_header(path, kind="record", example='"time [s], z [g]"')
    if header.names[0].lower() not in ("time", "t"):
        raise RecordError(
            f'{header.location}: the first column must be time, as in "time [s], z [g]"; the columns are {header.listed()}.'
        )
    return header


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
