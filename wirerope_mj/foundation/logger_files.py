"""Texts that state their columns otherwise than in a row above numbers: LabVIEW, records of earthquakes."""

import math
import re
from collections.abc import Mapping, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.regular_files import encoding_of, regular
from wirerope_mj.foundation.table_header import TIME_COLUMN, Header, is_missing
from wirerope_mj.foundation.units import TIME_UNITS, find_unit, split_unit

_REMEDY = "Export it again, or as CSV."
_HEAD = 200  # lines in which a record says what it is
_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_LAID = r"[(]\s*\d+\s*[xX]?\s*[FfEeGgIi]\s*(?P<width>\d+)(?:\.\d+)?"  # format of Fortran: numbers in a line, characters of each


def columns_of_logger(path: Path) -> Header | None:
    """Read a text of LabVIEW (.lvm), PEER (.AT2), CSMIP or COSMOS (.V2), known by its own header; None for other files.

    Raises:
        RecordError: it is one of these and holds something else than its header says.
        OSError: the file cannot be read.
    """
    with regular(path).open(encoding=encoding_of(path), errors="replace") as file:
        head = list(islice(file, _HEAD))
        text = "".join(head)
        if head and head[0].startswith("LabVIEW Measurement"):
            return _labview(path, [*head, *file])
        for begins, read in ((_PEER, _peer), (_VOLUME, _strong_motion)):
            if begins.search(text):
                return read(path, [*head, *file])
    for name, sign in _REFUSED.items():
        if re.search(sign, text, re.MULTILINE):
            raise RecordError(
                f"{path}: this is {name}, which is not read. Write its samples as CSV with a header such as "
                '"time [s], z [m/s^2]".'
            )
    return None


def columns_as_stated(path: Path, columns: str | None, interval: float | None) -> Header:
    """Read a file of numbers without a header whose `columns` are stated, such as "time [s], z [g]"; None reads all columns.

    Without a time among them rows are an `interval` [s] apart, or as the first line says, how many samples follow and their
    interval: "4000 0.005". One column may stand in lines of several numbers.

    Raises:
        RecordError: the file holds something else.
        OSError: the file cannot be read.
    """
    with regular(path).open(encoding=encoding_of(path), errors="replace") as file:
        lines = [
            (number, text)
            for number, text in enumerate(map(str.strip, file), 1)
            if text and not text.startswith(("#", "%", "//"))
        ]
    names, units = zip(*(split_unit(cell.strip()) for cell in columns.split(",")), strict=True) if columns else ((), ())
    rows: list[tuple[int, list[float]]] = []
    for number, text in lines:
        if re.search(r"[;\s]", text) is None:  # commas alone separate cells, or stand in a number
            cells = [text.replace(",", ".")] if len(names) == 1 == text.count(",") else text.split(",")
        elif re.search(r",\s", text):
            cells = re.split(r"\s*,\s*", text)
        else:
            cells = text.replace(",", ".").replace(";", " ").split()
        try:
            rows.append((number, [float(cell) for cell in cells]))
        except ValueError:
            raise RecordError(
                f'{path}, line {number}: "{short(plain(text))}" is no row of numbers. columns= and interval= (--columns, '
                "--interval) are for texts of numbers alone; leave them out where a file has a header."
            ) from None
    timed = any(
        TIME_COLUMN.fullmatch(name) or find_unit(unit or "", TIME_UNITS) for name, unit in zip(names, units, strict=True)
    )
    if timed and interval is not None:
        raise RecordError(f"{path}: {columns} holds a time, and interval= (--interval) states another: leave one of them out.")
    head, size = rows[0][1] if rows else [], sum(len(cells) for _, cells in rows[1:])
    if not timed and len(head) == 2 and head[0] * max(len(names), 1) == size:
        if interval is not None and not math.isclose(interval, head[1], rel_tol=1e-6):
            raise RecordError(
                f"{path}, line {rows[0][0]}: {size} samples {head[1]:g} s apart, and interval= says {interval:g} s."
            )
        interval, rows = head[1], rows[1:]
    if not timed and interval is None:
        raise RecordError(
            f"{path}: no column is the time. Say the seconds from sample to sample by interval= (--interval 0.005), or call a "
            'column so, columns="time [s], z [g]" (--columns).'
        )
    widths = {len(cells) for _, cells in rows}
    width = len(names) or (widths.pop() if len(widths) == 1 else 1)
    if wrong := next((number for number, cells in rows if width > 1 and len(cells) != width), None):
        raise RecordError(
            f"{path}, line {wrong}: there are not {width} numbers here. Say each column once by columns= (--columns)."
        )
    values = np.array([value for _, cells in rows for value in cells]).reshape(-1, width)
    if not names:
        names, units = tuple(f"column {i}" for i in range(1, width + 1)), (None,) * width
    if interval is None:
        return Header(path, 0, names, units, content=values)
    found = {name: (unit, column.tolist()) for name, unit, column in zip(names, units, values.T, strict=True)}
    return _equally_spaced(path, found, len(values), interval, 0)


_REFUSED = {
    "a record of ITACA or ESM": r"^SAMPLING_INTERVAL_S:",
    "a text of SMC (USGS)": r"^[12] (?:UN)?CORRECTED ACCELEROGRAM",
}
_PEER = re.compile(r"TIME (?:SERIES|HISTORY) IN UNITS OF[\s\S]*?^.*\bNPTS\b", re.IGNORECASE | re.MULTILINE)
_VOLUME = re.compile(
    rf"^\s*(?P<count>\d+) (?:points of (?P<kind>\w+) data equally spaced at\s*(?P<step>{_NUMBER})\s*sec, in "
    rf"(?P<unit>[^\s(]+?)\.?\s*|(?P<cosmos_kind>\w+) pts, approx\s*(?P<length>{_NUMBER}) secs, "
    rf"units=\s*(?P<cosmos_unit>[^\s(,]+)[^\n]*?Format=\s*){_LAID}",
    re.IGNORECASE | re.MULTILINE,
)


def _peer(path: Path, lines: list[str]) -> Header:
    """Read a record of PEER: "NPTS= 400, DT= 0.001 SEC" below "ACCELERATION TIME SERIES IN UNITS OF G", and numbers."""
    stated = next(i for i, line in enumerate(lines) if re.search(r"\bNPTS\b", line, re.IGNORECASE))
    heading = re.search(r"(\w+) TIME (?:SERIES|HISTORY) IN UNITS OF\s+(\S+)", "".join(lines[: stated + 1]), re.IGNORECASE)
    counts = re.search(rf"NPTS\s*=?\s*(\d+)\s*,\s*DT\s*=?\s*{_NUMBER}", lines[stated], re.IGNORECASE) or re.match(
        rf"\s*(\d+)\s+{_NUMBER}\s+NPTS", lines[stated], re.IGNORECASE
    )
    if heading is None or counts is None:
        raise RecordError(f'{path}, line {stated + 1}: a record of PEER states "NPTS= 400, DT= 0.001 SEC" here. {_REMEDY}')
    values = [
        _value(path, number, cell) for number, line in enumerate(lines[stated + 1 :], stated + 2) for cell in line.split()
    ]
    return _equally_spaced(path, {heading[1].lower(): (heading[2], values)}, int(counts[1]), float(counts[2]), stated + 1)


def _strong_motion(path: Path, lines: list[str]) -> Header:
    """Read the channels of a record of CSMIP or COSMOS, Volume 2: so many values in a line, each so many characters wide."""
    columns: dict[str, tuple[str | None, list[float]]] = {}
    channels, step, size, first, number = 0, math.nan, 0, 0, 0
    while number < len(lines):
        match = _VOLUME.match(lines[number])
        number += 1
        if match is None:
            continue
        quantity, unit = (match["kind"] or match["cosmos_kind"]).lower(), match["unit"] or match["cosmos_unit"]
        channels += quantity.startswith("acc")
        count, width, values = int(match["count"]), int(match["width"]), list[float]()
        stated = match["step"]
        interval = float(stated) if stated else _interval_in_header(path, lines[: number - 1], count, float(match["length"]))
        if columns and (interval, count) != (step, size):
            raise RecordError(f"{path}, line {number}: this channel has other instants than the first. Use a file for each.")
        step, size, first = interval, count, first or number
        while len(values) < count and number < len(lines):
            line = lines[number].rstrip("\r\n")
            number += 1
            values += [_value(path, number, line[i : i + width]) for i in range(0, len(line.rstrip()), width)]
        known = {"acc": "acceleration", "vel": "velocity", "dis": "displacement"}.get(quantity[:3], quantity)
        columns[known if channels < 2 else f"{known} {channels}"] = unit, values
    if channels > 1:
        columns = {f"{name} 1" if " " not in name else name: values for name, values in columns.items()}
    return _equally_spaced(path, columns, size, step, first)


def _interval_in_header(path: Path, above: Sequence[str], count: int, lasts: float) -> float:
    """Return the interval of a COSMOS record [s]: number 34 of its real header [ms], if it agrees with the duration."""
    starts = [i for i, line in enumerate(above) if re.match(r"\s*\d+\s+Real-header", line, re.IGNORECASE)]
    start = starts[-1] if starts else len(above)
    layout = re.search(_LAID, above[start]) if start < len(above) else None
    width = int(layout["width"]) if layout else 1
    values = [line[i : i + width] for line in above[start + 1 : start + 41] for i in range(0, len(line.rstrip()), width)]
    step = float(values[33]) / 1e3 if len(values) > 33 and re.fullmatch(rf"\s*{_NUMBER}\s*", values[33]) else math.nan
    if not abs(step * count - lasts) <= 1.0 + 0.01 * lasts:  # it is printed in whole seconds
        raise RecordError(f"{path}: this record of COSMOS does not state its interval where others do. {_REMEDY}")
    return step


def _value(path: Path, line: int, cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        raise RecordError(
            f'{path}, line {line}: "{short(plain(cell.strip()))}" is not a number of this record. {_REMEDY}'
        ) from None


def _equally_spaced(
    path: Path, columns: Mapping[str, tuple[str | None, list[float]]], count: int, step: float, line: int
) -> Header:
    """Return columns, with a time in steps of `step` [s] as the first; RecordError unless each has `count` values."""
    for name, (_, values) in columns.items():
        if len(values) != count:
            raise RecordError(
                f"{path}: {name} has {len(values)} values where line {line} says {count}. Export or copy it again."
            )
    if not 0.0 < step < math.inf:
        raise RecordError(f"{path}, line {line}: the interval between samples must be > 0 s, got {step:g}.")
    numbers = np.column_stack([step * np.arange(count), *(values for _, values in columns.values())])
    units = [unit for unit, _ in columns.values()]
    return Header(path, line, ("time", *columns), ("s", *units), last=line, content=numbers)


def _labview(path: Path, lines: list[str]) -> Header:
    """Read a LabVIEW measurement file: a header, then a segment with its own and a row of names that begins with X_Value."""
    said = dict(re.split(r"[\t,]", line.rstrip("\r\n"), maxsplit=1) for line in lines[:_HEAD] if re.match(r"\w+[\t,]", line))
    separator = "," if said.get("Separator", "Tab").strip().lower().startswith("comma") else "\t"
    point = said.get("Decimal_Separator", ".").strip()[:1] or "."
    heads = [number for number, line in enumerate(lines) if line.startswith("X_Value")]
    if not heads:
        raise RecordError(f'{path}: this LabVIEW file has no row of names, "X_Value ..", above numbers. {_REMEDY}')
    if len(heads) > 1:
        raise RecordError(
            f"{path}: this LabVIEW file (.lvm) holds {len(heads)} measurements one after the other, below the lines "
            f"{heads[0] + 1}, {heads[1] + 1}{', ..' if heads[2:] else ''}. Copy the one that is meant, and its header, into a "
            "file of its own."
        )
    names = [cell.strip() for cell in lines[heads[0]].rstrip("\r\n").split(separator)]
    while names[-1] in ("", "Comment"):
        names.pop()
    segment = {cells[0]: cells[1:] for cells in (line.rstrip("\r\n").split(separator) for line in lines[: heads[0]])}
    mode = said.get("X_Columns", "No").strip().lower()
    rows = []
    for number, line in enumerate(lines[heads[0] + 1 :], heads[0] + 2):
        cells = [cell.strip() for cell in line.rstrip("\r\n").split(separator)][: len(names)]
        if not any(cells):
            continue
        cells += [""] * (len(names) - len(cells))
        rows.append([math.nan if is_missing(cell) else _value(path, number, cell.replace(point, ".")) for cell in cells])
    numbers = np.array(rows, dtype=np.float64).reshape(-1, len(names))
    places = [i for i, name in enumerate(names) if name != "X_Value"]
    times = [i for i, name in enumerate(names) if name == "X_Value"]
    labels = [unit.strip() or None for unit in segment.get("Y_Unit_Label", [])]
    while labels and labels[-1] is None:
        labels.pop()
    # A cell stands for each column behind the first, empty for those of time; some programs leave these cells out.
    cells_of = range(len(places)) if len(times) > 1 and None not in labels else [place - 1 for place in places]
    units = [labels[cell] if cell < len(labels) else None for cell in cells_of]

    def stated(key: str) -> list[float]:
        return [_value(path, heads[0], cell.replace(point, ".")) for cell in segment.get(key, []) if cell.strip()]

    starts, steps = stated("X0"), stated("Delta_X")
    if mode == "no" or np.isnan(numbers[:, 0]).all():
        if not steps or len(set(steps)) > 1 or len(set(starts)) > 1:
            raise RecordError(f"{path}: channels of this LabVIEW file have different or no X0 and Delta_X. {_REMEDY}")
        time = (starts or [0.0])[0] + steps[0] * np.arange(len(numbers))
    elif len(times) > 1 and any(not np.array_equal(numbers[:, i], numbers[:, times[0]], equal_nan=True) for i in times):
        raise RecordError(f"{path}: the channels of this LabVIEW file (.lvm) have different times. Use a file for each.")
    else:
        time = numbers[:, times[0]]
    kept = np.column_stack([time, numbers[:, places]])
    called, at = [names[i] for i in places], heads[0] + 1
    return Header(path, at, ("time", *called), ("s", *units), last=at, content=kept)
