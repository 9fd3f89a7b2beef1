"""Files that state their columns otherwise than in a row above numbers: MATLAB, Parquet, LabVIEW, records of earthquakes."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.parquet_files import read_table
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.regular_files import encoding_of, regular
from wirerope_mj.foundation.table_header import Header, is_missing
from wirerope_mj.foundation.units import split_unit

_REMEDY = "Export it again, or as CSV."
_HEAD = 200  # lines in which a record says what it is
# names of a scalar that is a sampling rate [Hz], and of one that is an interval [s], in small letters without signs
_RATES = frozenset(("fs", "fsamp", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency", "freqsample", "sr"))
_STEPS = frozenset(
    ["dt", "ts", "deltat", "deltax", "increment", "interval", "sampleinterval", "samplinginterval", "timestep", "xincrement"]
)
_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_LAID = r"[(]\s*(\d+)\s*[xX]?\s*[FfEeGgIi]\s*(\d+)(?:\.\d+)?"  # format of Fortran: numbers in a line, characters of each


def columns_of_array_file(path: Path) -> Header | None:
    """Read a MATLAB or Parquet file, its header without a line; None of others.

    A matrix of MATLAB is so many columns, the fields of a struct are called test.acc, and beside a vector without time a scalar
    fs, or dt, is its rate, or interval.

    Raises:
        RecordError: the file is damaged, of another version, or holds no columns of numbers.
        OSError: the file cannot be read.
    """
    with regular(path).open("rb") as file:
        head = file.read(128)
    if head.startswith(b"PAR1") or path.suffix.lower() == ".parquet":
        table = read_table(path, kind="a Parquet file", remedy=_REMEDY)
        columns = {}
        for name, column in zip(table.column_names, table.columns, strict=True):
            values = column.to_numpy()
            if values.dtype.kind == "M":
                values = (values - values[0]) / np.timedelta64(1, "s") if values.size else values.astype(np.float64)
                name = f"{name} [s]"
            if values.dtype.kind in "fiu":
                columns[str(name)] = values.astype(np.float64)
        return _of_columns(path, columns, {})
    if head.startswith(b"MATLAB") or path.suffix.lower() == ".mat":
        return _matlab(path)
    return None


def _of_columns(path: Path, columns: Mapping[str, Array], scalars: Mapping[str, float]) -> Header:
    """Return the columns that have the most common length; without time among them, with that of a rate or an interval."""
    lengths = [column.size for column in columns.values() if column.size > 1]
    if not lengths:
        held = short(plain(", ".join([*columns, *scalars]))) or "nothing that is a number"
        raise RecordError(f"{path}: the file holds no columns of numbers; it holds {held}. {_REMEDY}")
    usual = max(lengths, key=lengths.count)
    kept = {name: column for name, column in columns.items() if column.size == usual}
    names, units = zip(*map(split_unit, kept), strict=True)
    numbers = np.column_stack(list(kept.values()))
    steps = {name: value for name, value in scalars.items() if _bare(name) in _STEPS and 0.0 < value < math.inf}
    steps |= {name: 1.0 / value for name, value in scalars.items() if _bare(name) in _RATES and 0.0 < value < math.inf}
    timed = any(re.search(r"(?:^|[._ ])(?:time|t|zeit)(?:$|[._ ])", name.lower()) for name in names)
    if len(set(steps.values())) == 1 and not timed:
        step = next(iter(steps.values()))
        names, units = ("time", *names), ("s", *units)
        numbers = np.column_stack([step * np.arange(usual), numbers])
    return Header(path, 0, names, units, content=numbers)


def _bare(name: str) -> str:
    return re.sub(r"[^a-z]", "", name.rpartition(".")[2].lower())


def _matlab(path: Path) -> Header:
    from scipy.io import loadmat

    try:
        content = loadmat(regular(path), simplify_cells=True)
    except OSError as error:
        raise RecordError(f"{path}: the record cannot be read: {why_unread(error)}") from None
    except NotImplementedError:  # version 7.3, which is HDF5
        raise RecordError(f'{path}: MATLAB files of version 7.3 are not read. Save it with "-v7", or as CSV.') from None
    except Exception:  # the reader raises what its parsers raise
        raise RecordError(f"{path}: this is no MATLAB file that can be read. {_REMEDY}") from None
    columns: dict[str, Array] = {}
    scalars: dict[str, float] = {}
    texts: dict[str, list[str]] = {}
    for name, value in _leaves({name: value for name, value in content.items() if not name.startswith("__")}):
        many = isinstance(value, np.ndarray | list) and np.ndim(value) > 0
        if isinstance(value, str) or (many and len(value) and all(isinstance(one, str) for one in value)):
            texts[name] = [value] if isinstance(value, str) else [str(one) for one in value]
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.ndim <= 2:
            values = value.astype(np.float64)
            if values.size == 1:
                scalars[name] = float(values.ravel()[0])
            elif values.size == max(values.shape):
                columns[name] = values.ravel()
            else:
                wide = values.shape[0] < values.shape[1]
                lines = enumerate(values if wide else values.T, 1)
                columns |= {f"{name}({i},:)" if wide else f"{name}(:,{i})": line for i, line in lines}
        elif isinstance(value, int | float):
            scalars[name] = float(value)
    return _of_columns(path, _named_by_texts(columns, texts), scalars)


def _leaves(content: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield what a struct or an array of structs holds, by names such as test.acc or run(2).acc."""
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield from _leaves(value, f"{name}.{key}" if name else str(key))
    elif isinstance(content, np.ndarray | list) and len(content) and all(isinstance(one, Mapping) for one in content):
        for number, one in enumerate(content, 1):
            yield from _leaves(one, f"{name}({number})")
    elif (
        isinstance(content, np.ndarray)
        and content.dtype == object
        and all(isinstance(one, np.ndarray) for one in content.ravel())
    ):
        for number, one in enumerate(content.ravel(), 1):
            yield f"{name}{{{number}}}", one
    else:
        yield name, content


def _named_by_texts(columns: Mapping[str, Array], texts: Mapping[str, Sequence[str]]) -> dict[str, Array]:
    """Return the columns of a matrix, called as the one list of names beside it says, with the units of another."""
    matrices = dict.fromkeys(name.rpartition("(")[0] for name in columns if name.endswith(")"))
    called_alike: dict[str, dict[str, str]] = {}  # by matrix
    for matrix in matrices:
        members = [name for name in columns if name.rpartition("(")[0] == matrix]
        of_width = {name: list(map(str.strip, text)) for name, text in texts.items() if len(text) == len(members)}
        units = {name: text for name, text in of_width.items() if "unit" in name.lower()}
        names = {name: text for name, text in of_width.items() if name not in units and len(set(text)) == len(members)}
        if len(names) == 1:
            (called,) = names.values()
            (stated,) = units.values() if len(units) == 1 else [[""] * len(members)]
            headings = [f"{name} [{unit}]" if unit else name for name, unit in zip(called, stated, strict=True)]
            called_alike[matrix] = dict(zip(members, headings, strict=True))
    several = len(called_alike) > 1  # of which none may take the place of another
    renamed = {
        name: f"{matrix}.{heading}" if several else heading
        for matrix, headings in called_alike.items()
        for name, heading in headings.items()
    }
    return {renamed.get(name, name): column for name, column in columns.items()}


def columns_of_logger(path: Path) -> Header | None:
    """Read a text of LabVIEW (.lvm), PEER (.AT2), CSMIP or COSMOS (.V2), known by what it says of itself; None of others.

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


_REFUSED = {
    "a record of K-NET or KiK-net": r"^Sampling Freq\(Hz\)\s+\d+ ?Hz",
    "a record of ITACA or ESM": r"^SAMPLING_INTERVAL_S:",
    "a text of SMC (USGS)": r"^[12] (?:UN)?CORRECTED ACCELEROGRAM",
}
_PEER = re.compile(r"TIME (?:SERIES|HISTORY) IN UNITS OF[\s\S]*?^.*\bNPTS\b", re.IGNORECASE | re.MULTILINE)
_VOLUME = re.compile(
    rf"^\s*(\d+) (?:points of (\w+) data equally spaced at\s*{_NUMBER}\s*sec, in ([^\s(]+?)\.?\s*"
    rf"|(\w+) pts, approx\s*{_NUMBER} secs, units=\s*([^\s(,]+)[^\n]*?Format=\s*){_LAID}",
    re.IGNORECASE | re.MULTILINE,
)


def _peer(path: Path, lines: list[str]) -> Header:
    """Read a record of PEER: "NPTS= 400, DT= 0.001 SEC" below "ACCELERATION TIME SERIES IN UNITS OF G", and numbers."""
    stated = next(i for i, line in enumerate(lines) if re.search(r"\bNPTS\b", line, re.IGNORECASE))
    what = re.search(r"(\w+) TIME (?:SERIES|HISTORY) IN UNITS OF\s+(\S+)", "".join(lines[: stated + 1]), re.IGNORECASE)
    counts = re.search(rf"NPTS\s*=?\s*(\d+)\s*,\s*DT\s*=?\s*{_NUMBER}", lines[stated], re.IGNORECASE) or re.match(
        rf"\s*(\d+)\s+{_NUMBER}\s+NPTS", lines[stated], re.IGNORECASE
    )
    if what is None or counts is None:
        raise RecordError(f'{path}, line {stated + 1}: a record of PEER states "NPTS= 400, DT= 0.001 SEC" here. {_REMEDY}')
    values = [
        _value(path, number, cell) for number, line in enumerate(lines[stated + 1 :], stated + 2) for cell in line.split()
    ]
    return _equally_spaced(path, {what[1].lower(): (what[2], values)}, int(counts[1]), float(counts[2]), stated + 1)


def _strong_motion(path: Path, lines: list[str]) -> Header:
    """Read the channels of a record of CSMIP or COSMOS, Volume 2: so many values in a line, each so many characters wide."""
    found: dict[str, tuple[str | None, list[float]]] = {}
    channels, step, count, first = 0, math.nan, 0, 0
    number = 0
    while number < len(lines):
        match = _VOLUME.match(lines[number])
        number += 1
        if match is None:
            continue
        what, unit = (match[2] or match[5]).lower(), match[4] or match[7]
        channels += what.startswith("acc")
        interval = (
            float(match[3]) if match[3] else _interval_in_header(path, lines[: number - 1], int(match[1]), float(match[6]))
        )
        if found and (interval != step or int(match[1]) != count):
            raise RecordError(f"{path}, line {number}: this channel has other instants than the first. Use a file for each.")
        step, count, first = interval, int(match[1]), first or number
        width, values = int(match[9]), list[float]()
        while len(values) < count and number < len(lines):
            line = lines[number].rstrip("\r\n")
            number += 1
            values += [_value(path, number, line[i : i + width]) for i in range(0, len(line.rstrip()), width)]
        known = {"acc": "acceleration", "vel": "velocity", "dis": "displacement"}.get(what[:3], what)
        found[known if channels < 2 else f"{known} {channels}"] = unit, values
    if channels > 1:
        found = {f"{name} 1" if " " not in name else name: values for name, values in found.items()}
    return _equally_spaced(path, found, count, step, first)


def _interval_in_header(path: Path, above: Sequence[str], count: int, lasts: float) -> float:
    """Return the interval of a record of COSMOS [s]: number 34 of its real header, in ms, which fits how long it lasts."""
    starts = [i for i, line in enumerate(above) if re.match(r"\s*\d+\s+Real-header", line, re.IGNORECASE)]
    start = starts[-1] if starts else len(above)
    layout = re.search(_LAID, above[start]) if start < len(above) else None
    width = int(layout[2]) if layout else 1
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
    """Return columns with their time before them; RecordError unless each has so many values."""
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
