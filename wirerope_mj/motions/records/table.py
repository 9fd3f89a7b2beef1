"""A measured record from a table: its channels, its time, its numbers on the three axes."""

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import ROTATIONS, Direction
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.table_files import (
    LARGEST,
    Stated,
    find_column,
    numbered_rows,
    read_header,
)
from wirerope_mj.foundation.table_header import TIME_COLUMN, Header, clock_time, holds, is_clock_time
from wirerope_mj.foundation.units import ACCELERATION_UNITS, STANDARD_GRAVITY, TIME_UNITS, find_unit, range_of, underscored_unit
from wirerope_mj.motions.records.blocks import Clock, raise_for_bad_line, read_blocks, row_bound
from wirerope_mj.motions.records.reading import Reading, axes_of
from wirerope_mj.motions.records.signals import channel_warnings
from wirerope_mj.motions.records.turning import TURN_UNITS, kind_of, turn_columns, turned_by
from wirerope_mj.motions.records.written import channels_alone, copied_channels, rate_warnings

_BEYOND = 1.2  # times its range, above which no accelerometer shows anything
_AXIS_COLUMN = re.compile(
    r"(?:.*\.)?(?:(?:a|acc|accel|acceleration)[ _]?)?([xyz])(?:[ _-]?(?:axis|dir|direction))?", re.IGNORECASE
)


def table_channels(path: Path, stated: Stated | None = None) -> tuple[str, ...]:
    header, time, _ = _open_table(path, stated=stated)
    return tuple(name for column, name in enumerate(header.names) if column != time and column not in header.unnamed)


def acceleration_channels(path: Path, stated: Stated | None = None) -> tuple[str, ...]:
    """Return the names of the columns whose unit is one of an acceleration; all but the time if no column has one."""
    header, time, _ = _open_table(path, stated=stated)
    found = [name for name, unit in zip(header.names, header.units, strict=True) if find_unit(unit or "", ACCELERATION_UNITS)]
    return tuple(found) or table_channels(path, stated)


def read_record_table(
    path: Path, channels: Mapping[str, Direction] | None, unit: str | None, *, fill: bool = False, turns: bool = False,
    stated: Stated | None = None,
) -> Reading:  # fmt: skip
    """Return the accelerations in the columns of a table, in a file of any kind, and the angular channels of the base.

    Without `channels` they are in the columns named x, y and z, without a `unit` in the header's. With `fill` empty cells and
    NaN are filled with straight lines; else they are an error. With `turns` angular rates or accelerations are read, too: those
    of the `channels`, else of the columns with such a unit that are named after an axis. A text without a header is as
    `stated`, see `read_header`.
    """
    header, time, clock = _open_table(path, channels or (), stated)
    messages: list[str] = []
    if channels is None:
        turning = turn_columns(header, time)
        if turning and not turns:
            named = ", ".join(header.names[column] for column in turning)
            messages.append(f'it holds {named}, which turn nothing: play them with rotation="base" (--rotation base).')
        directions = _axis_columns(header, time, required=not turns) | (turning if turns else {})
    else:
        directions = {find_column(header, name, without=time): direction for name, direction in channels.items()}
    turned = [column for column, direction in directions.items() if str(direction).lstrip("+-") in ROTATIONS]
    if turns and not turned:
        raise RecordError(
            f"{header.location}: no column is an angular rate [deg/s, rad/s] or acceleration [deg/s^2, rad/s^2] about x, y or "
            f'z; the columns are {header.listed(units=True)}. Say which one turns the base, such as channels={{"gx": "roll"}} '
            "(--channels gx=roll)."
        )
    kind = turned_by(header, turned)
    option = 'unit="g" (--unit g)'
    units = [
        unit if unit is not None else header.known_unit(column, ACCELERATION_UNITS, option=option)
        for column in directions if column not in turned
    ]  # fmt: skip
    accelerations = iter(ACCELERATION_UNITS[name] for name in units)
    factors = np.array([
        header.factor(column, TURN_UNITS[kind]) if column in turned else next(accelerations) for column in directions
    ])  # fmt: skip
    columns, axes = [time, *directions], axes_of(directions.values())
    instants, samples, filled = _read_scaled(header, columns, clock, factors[:, np.newaxis] * axes, fill=fill)
    ranges = [range_of(header.units[column]) for column in directions if column not in turned]
    if ranges and None not in ranges:
        require_within_range(header.location, samples[:, :3], max(limit for limit in ranges if limit is not None))
    messages += [
        *filled,
        *_borrowed_time(header, time, list(directions)),
        *rate_warnings(header, instants),
        *channel_warnings([header.names[i] for i in directions], axes, samples),
        *copied_channels(channels_alone([header.names[i] for i in directions], axes, samples)),
    ]
    return Reading(instants, samples, units=tuple(dict.fromkeys(units)), warnings=tuple(messages), turned_by=kind)


def require_within_range(location: str, samples: Array, limit: float) -> None:
    """Raise RecordError unless accelerations are within the range of their sensor, all [m/s^2]."""
    largest = float(np.nanmax(np.abs(samples), initial=0.0))
    if largest > _BEYOND * limit:
        raise RecordError(
            f"{location}: {largest / STANDARD_GRAVITY:.4g} g stands in a column of a sensor whose range is "
            f'{limit / STANDARD_GRAVITY:.4g} g. In which unit are the numbers? Write it in the header, as in "z [m/s^2]".'
        )


def read_columns(path: Path, names: Sequence[str], *, fill: bool) -> tuple[Reading, tuple[str | None, ...]]:
    """Read columns of a table as they are, (n, n_columns), and the unit of each in its header, None without a unit."""
    header, time, clock = _open_table(path, names, kind="test record")
    columns = [find_column(header, name, without=time) for name in names]
    instants, samples, messages = _read_scaled(header, [time, *columns], clock, np.eye(len(columns)), fill=fill)
    units = tuple(header.units[column] for column in columns)
    messages += [*_borrowed_time(header, time, columns), *rate_warnings(header, instants)]
    return Reading(instants, samples, units=(), warnings=tuple(messages)), units


def _borrowed_time(header: Header, time: int, columns: Sequence[int]) -> list[str]:
    """Warn of columns of a file of arrays that are read over the time of another struct or group, since they have none."""
    if not isinstance(header.content, np.ndarray) or header.line:
        return []
    instants = header.content[:, time]
    called = [column for column, name in enumerate(header.names) if column == time or TIME_COLUMN.fullmatch(name)]
    groups = [header.names[one].rpartition(".")[0] for one in called if np.array_equal(header.content[:, one], instants)]
    borrowed = [name for name in (header.names[i] for i in columns) if not any(holds(group, name) for group in groups)]
    if not borrowed:
        return []
    return [
        f"{short(plain(', '.join(borrowed)))} without a time of its own is read over {short(plain(header.names[time]))}, which "
        "stands in another group and has as many samples: are they of one measurement?"
    ]


def _read_scaled(
    header: Header, columns: Sequence[int], clock: Clock | None, matrix: Array, *, fill: bool
) -> tuple[Array, Array, list[str]]:
    """Read instants [s], (n,), samples (n, k), the other columns times `matrix` (n_columns, k), and warnings of filled gaps.

    The first of `columns` is the time, parsed by `clock` where it is given.
    """
    path, content = header.path, header.content
    time_factor = header.factor(columns[0], TIME_UNITS) if clock is None else 1.0
    blocks: Iterable[Array]
    if isinstance(content, np.ndarray):
        capacity, blocks = len(content), [content[:, columns]]
        usable = np.abs(blocks[0]) <= LARGEST
        usable[:, 1:] |= np.isnan(blocks[0][:, 1:]) & fill
        if not usable.all():
            raise_for_bad_line(header, columns, missing=fill)
    else:
        # memory that is not written to costs nothing: a long record stands in memory once
        capacity = row_bound(path) if content is None else len(content)
        blocks = read_blocks(header, columns, clock, missing=fill)
    time, samples, size = np.empty(capacity), np.empty((capacity, matrix.shape[1])), 0
    messages: list[str] = []
    if fill:
        blocks, messages = _fill_gaps(header, columns, list(blocks))
    for block in blocks:
        rows = slice(size, size + len(block))
        np.multiply(block[:, 0], time_factor, out=time[rows])
        np.matmul(block[:, 1:], matrix, out=samples[rows])
        size = rows.stop
    if size < 2:
        raise RecordError(f"{path}: a record needs at least 2 rows of numbers, this one has {size}.")
    time, samples = time[:size], samples[:size]
    if np.any(time[1:] <= time[:-1]):
        raise_for_bad_line(header, columns, clock, missing=fill)
    return time, samples, messages


def _open_table(
    path: Path, names: Iterable[str] = (), stated: Stated | None = None, kind: str = "record"
) -> tuple[Header, int, Clock | None]:
    """Open a table: return its header, the index of the time column for channels `names`, and a parser of clock times or None.

    RecordError: no column is the time, or several may be.
    """
    asked = [name.rpartition("#")[0] or name for name in names]
    header = read_header(path, kind=kind, example='"time [s], z [g]"', columns=asked, stated=stated)
    _, first = next(iter(numbered_rows(header)), (0, [""] * len(header.names)))
    clocks = [column for column, cell in enumerate(first[: len(header.names)]) if is_clock_time(cell)]
    called = [column for column, name in enumerate(header.names) if TIME_COLUMN.fullmatch(name)]
    of_unit = [column for column, unit in enumerate(header.units) if unit is not None and find_unit(unit, TIME_UNITS)]
    exactly = [column for column in called if header.names[column].lower() in ("time", "t")]
    structs = {name.rpartition(".")[0] for name in names}
    beside = [column for column in called if {header.names[column].rpartition(".")[0]} == structs]
    content = header.content
    if isinstance(content, np.ndarray) and all(np.array_equal(content[:, i], content[:, called[0]]) for i in called):
        called = called[:1]
    found = next((columns for columns in (called, exactly, beside, clocks, of_unit) if len(columns) == 1), None)
    if found is None:
        several = [header.names[column] for column in called or of_unit]
        fault = f"{len(several)} columns may be the time" if several else "no column is the time"
        raise RecordError(
            f'{header.location}: {fault}; one alone is called time or t, or has a unit of time, as in "time [s], z [g]"; the '
            f"columns are {header.listed(units=True)}."
        )
    (column,) = found
    if column not in clocks:
        return header, column, None
    return header, column, _seconds_since(header, first[column])


def _seconds_since(header: Header, first: str) -> Clock:
    """Return a parser of clock times [s] since midnight before the first, with the order of day and month that fits all."""
    began: dict[bool, int] = {}  # the first day, by whether days stand before months
    for day_first in (False, True):
        with suppress(ValueError):
            began[day_first] = clock_time(first, day_first=day_first)[0]
    if not began:
        raise RecordError(f'{header.location}: "{short(plain(first))}" below it is no instant of any clock.')

    def seconds(cell: str) -> float:
        since: dict[bool, tuple[int, float]] = {}
        for day_first, day in began.items():
            with suppress(ValueError):
                today, second = clock_time(cell.strip(), day_first=day_first)
                since[day_first] = today - day, second
        if not since:
            raise ValueError(cell)
        if len({days for days, _ in since.values()}) > 1:  # a record goes on from day to day, not from month to month
            since = dict([min(since.items(), key=lambda entry: abs(entry[1][0]))])
        for day_first in began.keys() - since.keys():
            del began[day_first]
        days, second = next(iter(since.values()))
        return 86400.0 * days + second

    return seconds


def _fill_gaps(header: Header, columns: Sequence[int], blocks: list[Array]) -> tuple[list[Array], list[str]]:
    """Fill samples missing in blocks of rows with straight lines; return the blocks, joined if any is missing, and warnings."""
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


def moves_a_base(header: Header) -> bool:
    """Tell whether a record has a column that is called after an axis, so that a base is moved by it without `channels`."""
    return any(_AXIS_COLUMN.fullmatch(underscored_unit(name, ACCELERATION_UNITS)[0]) for name in header.names)


def _axis_columns(header: Header, time: int, *, required: bool = True) -> dict[int, Direction]:
    """Return the directions of the columns named after an axis, by index; RecordError if none is and one is `required`."""
    columns: dict[int, Direction] = {}
    if lost := [name for name in header.left_out if _AXIS_COLUMN.fullmatch(underscored_unit(name, ACCELERATION_UNITS)[0])]:
        raise RecordError(
            f"{header.location}: {short(plain(', '.join(lost)))} has another number of samples than the other columns, or "
            "holds no numbers. Choose columns of one length by channels= (--channels), or use a file for each."
        )
    for column, name in enumerate(header.names):
        match = _AXIS_COLUMN.fullmatch(name) or _AXIS_COLUMN.fullmatch(underscored_unit(name, ACCELERATION_UNITS)[0])
        if not match or column == time or kind_of(header.units[column]):
            continue
        axis = match[1].lower()
        if axis in columns.values():
            chosen = f"{name}#{header.names[: column + 1].count(name)}" if header.names.count(name) > 1 else name
            raise RecordError(
                f'{header.location}: "{name}" is a second column for direction {axis}. '
                f'Choose with channels={{"{chosen}": "{axis}"}} (--channels {chosen}={axis}).'
            )
        columns[column] = axis
    if not columns and required:
        listed = [column for column in range(len(header.names)) if column != time]
        accelerations = [column for column in listed if find_unit(header.units[column] or "", ACCELERATION_UNITS)]
        example = next((header.names[column] for column in (*accelerations, *listed)), "ch1")
        option = f'"{example}=z"' if " " in example else f"{example}=z"
        alone = " or, with one column, --direction z" if len(header.names) == 2 else ""
        raise RecordError(
            f"{header.location}: no column is named x, y or z; the columns are {header.listed()}. Say which one moves "
            f'the base where, for instance channels={{"{example}": "z"}} (--channels {option}{alone}).'
        )
    return columns
