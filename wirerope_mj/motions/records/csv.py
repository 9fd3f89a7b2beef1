"""A measured record from a CSV file: which columns are meant, and their numbers on the three axes."""

import re
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.csv_units import (
    ACCELERATION_UNITS,
    TIME_UNITS,
    Header,
    most_rows,
    name_bad_line,
    read_blocks,
    read_header,
)
from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.motions.records.reading import Reading, axes_of

_AXIS_COLUMN = re.compile(r"(?:(?:a|acc|acceleration)[ _]?)?([xyz])", re.IGNORECASE)


def csv_channels(path: Path) -> tuple[str, ...]:
    """Return the names of all columns but the time."""
    return read_header(path).names[1:]


def read_csv(path: Path, channels: Mapping[str, Direction] | None, unit: str | None, *, fill: bool = False) -> Reading:
    """Return what the columns of a CSV file hold.

    Args:
        path: The file.
        channels: Columns and their directions; None: the columns named x, y and z.
        unit: Of the accelerations, in place of what the header says; None: the header's.
        fill: Whether empty cells and NaN are filled with straight lines; else they are an error.
    """
    header = read_header(path)
    directions = _axis_columns(header) if channels is None else _named_columns(header, channels)
    columns, axes = [0, *directions], axes_of(directions.values())
    time_factor = header.factor(0, TIME_UNITS)
    units = [unit if unit is not None else _unit(header, column) for column in directions]
    factors = np.array([ACCELERATION_UNITS[name] for name in units])

    most = most_rows(path)  # memory that is not written to costs nothing: a long record stands in memory once
    time, samples, size = np.empty(most), np.empty((most, 3)), 0
    blocks = read_blocks(header, columns, missing=fill)
    for numbers in _filled(header, columns, list(blocks)) if fill else blocks:
        part = slice(size, size + len(numbers))
        np.multiply(numbers[:, 0], time_factor, out=time[part])
        np.matmul(numbers[:, 1:] * factors, axes, out=samples[part])
        size = part.stop
    if size < 2:
        raise RecordError(f"{path}: a record needs at least 2 rows of numbers, this one has {size}.")
    time, samples = time[:size], samples[:size]
    if np.any(time[1:] <= time[:-1]):
        name_bad_line(header, columns, missing=fill)
    return Reading(time=time, samples=samples, units=tuple(dict.fromkeys(units)))


def _filled(header: Header, columns: Sequence[int], blocks: list[Array]) -> list[Array]:
    """Return the blocks of numbers, joined and with straight lines where samples are missing, if there are any."""
    if all(np.all(np.isfinite(block)) for block in blocks):
        return blocks
    numbers = np.concatenate(blocks)
    time = numbers[:, 0]
    for column, values in zip(columns[1:], numbers[:, 1:].T, strict=True):
        missing = np.isnan(values)
        if not missing.any():
            continue
        places = np.flatnonzero(missing)
        words = (
            f'{places.size} {"sample" if places.size == 1 else "samples"} missing in column "{header.names[column]}"'
        )
        if missing[0] or missing[-1]:
            raise RecordError(
                f"{header.path}: {words}, also at the {'beginning' if missing[0] else 'end'}, where no straight line can "
                "be drawn. Cut the record there."
            )
        starts = places[np.flatnonzero(np.diff(places, prepend=-2) > 1)]
        listed = [f"at {time[place]:.6g} s" for place in starts[:3]] + ["..."] * (starts.size > 3)
        values[missing] = np.interp(time[missing], time[~missing], values[~missing])
        warnings.warn(
            f"{header.path}: {words} ({', '.join(listed)}) filled with straight lines.", RecordWarning, stacklevel=4
        )
    return [numbers]


def _unit(header: Header, column: int) -> str:
    header.factor(column, ACCELERATION_UNITS)
    return str(header.units[column])


def _named_columns(header: Header, wanted: Mapping[str, Direction]) -> dict[int, Direction]:
    """Return the column numbers of the channels asked for, with their directions."""
    for name in wanted:
        found = header.names[1:].count(name)
        if found != 1:
            fault = f'there is no column "{name}"' if found == 0 else f'there are {found} columns "{name}"'
            raise RecordError(f"{header.path}, line {header.line}: {fault}; the columns are {header.listed(1)}.")
    return {header.names.index(name, 1): direction for name, direction in wanted.items()}


def _axis_columns(header: Header) -> dict[int, Direction]:
    """Return the numbers of the columns that are named after an axis, with their directions."""
    found: dict[int, Direction] = {}
    for column, name in enumerate(header.names[1:], start=1):
        match = _AXIS_COLUMN.fullmatch(name)
        if not match:
            continue
        if match[1].lower() in found.values():
            raise RecordError(
                f'{header.path}, line {header.line}: "{name}" is a second column for direction {match[1].lower()}. '
                f'Choose with channels={{"{name}": "{match[1].lower()}"}} (--channels {name}={match[1].lower()}).'
            )
        found[column] = match[1].lower()
    if not found:
        example = header.names[-1] if len(header.names) > 1 else "ch1"
        alone = " or, with one column, --direction z" if len(header.names) == 2 else ""
        raise RecordError(
            f"{header.path}, line {header.line}: no column is named x, y or z; the columns are "
            f"{header.listed()}. Say which one moves the base where, for instance "
            f'channels={{"{example}": "z"}} (--channels {_quoted(example + "=z")}{alone}).'
        )
    return found


def _quoted(text: str) -> str:
    return f'"{text}"' if " " in text else text
