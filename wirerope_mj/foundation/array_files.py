"""Files of arrays, read by the libraries of their makers: MATLAB, HDF5, NumPy, Parquet, TDMS, WAV, records of seismology."""

import math
import re
import warnings
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.parquet_files import read_table
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.table_header import TIME_COLUMN, Header, holds
from wirerope_mj.foundation.units import FREQUENCY_UNITS, TIME_UNITS, find_unit, split_unit

_REMEDY = "Export it again, or as CSV."
# names of a scalar that is a sampling rate [Hz], and of one that is an interval [s], in small letters without signs
_RATES = frozenset(("fs", "fsamp", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency", "freqsample", "sr"))
_STEPS = frozenset(
    ["dt", "ts", "deltat", "deltax", "increment", "interval", "sampleinterval", "samplinginterval", "timestep", "xincrement"]
)
_STARTS = frozenset(("t", "start", "starttime", "tstart", "toffset", "startoffset"))  # of what begins later: t0 among them
_TOGETHER = 0.1  # of a sample, by which channels may begin after each other: clocks write microseconds, or less
_CALIBRATIONS = {"gain", "sensitivity", "calibration", "calib", "scale"}
_HDF5 = b"\x89HDF\r\n"
# how records begin that obspy reads: miniSEED, GSE2, IRIS' texts, K-NET and KiK-net; SAC is known by its ending
_SEISMIC = re.compile(rb"\d{6}[DRQM][ \0]|MS\x03|WID2 |TIMESERIES |Origin Time\s")


def columns_of_array_file(path: Path, wanted: Collection[str] = ()) -> Header | None:
    """Read a file of arrays as columns; None for other files.

    A matrix is so many columns, the fields of a struct or of a group are called test.acc, and beside a vector without time a
    scalar fs, or dt, is its rate, or interval: its own, else that of the struct or group which holds it. A WAV file has
    fractions of its full scale. Of columns of several lengths those that are as long as the `wanted` ones are read, else those
    of the most common length; `Header.left_out` names the others.

    Raises:
        RecordError: the file is damaged or holds no columns of numbers, the columns have different instants, or the library
            that reads it is missing.
        OSError: the file cannot be read.
    """
    with regular(path).open("rb") as file:
        head = file.read(1024)
    ending = path.suffix.lower()
    if head.startswith(b"PAR1") or ending == ".parquet":
        table = read_table(path, kind="a Parquet file", remedy=_REMEDY)
        columns = {}
        for name, column in zip(table.column_names, table.columns, strict=True):
            values = column.to_numpy()
            if values.dtype.kind == "M":
                values = (values - values[0]) / np.timedelta64(1, "s") if values.size else values.astype(np.float64)
                name = f"{name} [s]"
            if values.dtype.kind in "fiu":
                columns[str(name)] = values.astype(np.float64)
        return _select_columns(path, columns, {}, wanted, left_out=())
    if _HDF5 in (head[:6], head[512:518]):
        kind, read, library = "HDF5", _hdf5, "h5py"
    elif head.startswith(b"MATLAB") or ending == ".mat":
        kind, read, library = "MATLAB", _matlab, "scipy"
    elif head.startswith(b"TDSm"):
        kind, read, library = "TDMS", _tdms, "nptdms"
    elif head.startswith(b"RIFF") and head[8:12] == b"WAVE":
        kind, read, library = "WAV", _wav, "scipy"
    elif head.startswith(b"PK") and ending == ".npz":
        kind, read, library = "NumPy", _npz, "numpy"
    elif _SEISMIC.match(head) or ending == ".sac":
        kind, read, library = "seismic", _seismic, "obspy"
    else:
        return None
    try:
        with warnings.catch_warnings(action="ignore"):  # of libraries, and of what the file holds beside its samples
            import_module(library)
            content = read(path)
    except ImportError:
        raise RecordError(
            f'{path}: this is a {kind} file, which {library} reads: pip install "wirerope-mj[loggers]"; or export it as CSV.'
        ) from None
    except RecordError:
        raise
    except Exception as error:  # libraries raise what their parsers raise
        if isinstance(error, OSError) and error.errno is not None:
            raise RecordError(f"{path}: the record cannot be read: {why_unread(error)}") from None
        raise RecordError(f"{path}: this is no {kind} file that can be read. {_REMEDY}") from None
    return _columns_of_variables(path, content, wanted)


def _select_columns(
    path: Path, columns: Mapping[str, Array], scalars: Mapping[str, float], wanted: Collection[str], left_out: Sequence[str]
) -> Header:
    """Select the wanted columns, or those of the most common length; where time is missing it is made from their rate."""
    lengths = {name: column.size for name, column in columns.items() if column.size > 1}
    if not lengths:
        content = short(plain(", ".join([*columns, *scalars]))) or "nothing that is a number"
        raise RecordError(f"{path}: the file holds no columns of numbers; it holds {content}. {_REMEDY}")
    asked = [name for name in lengths if {name, split_unit(name)[0], split_unit(name)[0].rpartition(".")[2]} & {*wanted}]
    among = [lengths[name] for name in asked or lengths]
    usual = max(among, key=lambda length: (among.count(length), length))
    if asked and len(set(among)) > 1:
        sizes = ", ".join(f"{split_unit(name)[0]} {lengths[name]}" for name in asked)
        raise RecordError(f"{path}: the columns have different numbers of samples, {short(plain(sizes))}. Use a file for each.")
    timed = {name for name in columns if lengths.get(name) == usual and TIME_COLUMN.fullmatch(split_unit(name)[0])}
    kept = [name for name in columns if lengths.get(name) == usual and (not asked or name in asked or name in timed)]
    # what has a rate of its own is not over the time of another struct or group
    groups = {name.rpartition(".")[0] for name in timed}
    alone = [name for name in kept if name not in timed and not any(holds(group, name) for group in groups)]
    rated = [name for name in alone if timed and _own_steps(split_unit(name)[0], scalars)]
    if (own := {*asked} - timed) and own <= {*rated}:
        kept, timed = [name for name in kept if name not in timed], set()
    elif rated and asked:
        raise RecordError(
            f"{path}: {_listed(rated)} has a rate of its own and is not over {_listed(sorted(timed))}. "
            "Choose channels of one group by channels= (--channels), or use a file for each."
        )
    elif rated:
        kept = [name for name in kept if name not in rated]
    names, units = zip(*map(split_unit, kept), strict=True)
    numbers = np.column_stack([columns[name] for name in kept])
    if not timed:
        steps = {_step(name, scalars) for name in names}
        starts = {min(_nearest(name, scalars, ("start",)), default=0.0) for name in names}
        if len(steps) > 1:
            raise RecordError(
                f"{path}: the columns {_listed(names)} have different rates, or some have none. Choose those "
                "of one rate by channels= (--channels), or use a file for each."
            )
        if None not in steps:
            (step,) = steps
            assert step is not None
            if max(starts) - min(starts) > _TOGETHER * step:
                raise RecordError(
                    f"{path}: the columns {_listed(names)} begin up to {max(starts) - min(starts):.6g} s after "
                    "each other. Use a file for each, with `start` (--start), or write them over one time."
                )
            names, units = ("time", *names), ("s", *units)
            numbers = np.column_stack([step * np.arange(usual), numbers])
    other_names = tuple(
        split_unit(name)[0] for name in lengths if lengths[name] != usual or (name in rated and name not in kept)
    )
    return Header(path, 0, names, units, content=numbers, left_out=(*other_names, *left_out))


def _step(column: str, scalars: Mapping[str, float]) -> float | None:
    """Return the interval of a column [s] that scalars state; None without one, or if several differ."""
    steps = _own_steps(column, scalars)
    if not steps:  # said elsewhere, as info.fs
        steps = {value for name, value in scalars.items() if _bare(name) in _STEPS and 0.0 < value < math.inf}
        steps |= {1.0 / value for name, value in scalars.items() if _bare(name) in _RATES and 0.0 < value < math.inf}
    return steps.pop() if len(steps) == 1 else None


def _listed(names: Sequence[str]) -> str:
    return short(plain(", ".join(split_unit(name)[0] for name in names)))


def _own_steps(column: str, scalars: Mapping[str, float]) -> set[float]:
    """Return the intervals [s] that scalars state of a column, or of the struct or group that holds it."""
    positive = {name: value for name, value in scalars.items() if 0.0 < value < math.inf}
    return _nearest(column, positive, _STEPS) | {1.0 / value for value in _nearest(column, positive, _RATES)}


def _nearest(column: str, scalars: Mapping[str, float], called: Collection[str]) -> set[float]:
    """Return the scalars `called` so in the struct or group of a column, else in the next one around it that has any."""
    place = column
    while True:
        values = {value for name, value in scalars.items() if name.rpartition(".")[0] == place and _bare(name) in called}
        if values or not place:
            return values
        place = place.rpartition(".")[0]


def _bare(name: str) -> str:
    return re.sub(r"[^a-z]", "", name.rpartition(".")[2].lower())


def _matlab(path: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat

    return {name: value for name, value in loadmat(path, simplify_cells=True).items() if not name.startswith("__")}


def _npz(path: Path) -> Mapping[str, Any]:
    with np.load(path, allow_pickle=False) as file:
        return dict(file)


def _hdf5(path: Path) -> Mapping[str, Any]:
    """Read the datasets of an HDF5 file, of MATLAB 7.3 too; attributes may say unit, rate or interval."""
    import h5py

    def content(group: Any) -> dict[str, Any]:
        members: dict[str, Any] = {}
        for name, member in group.items():
            if name.startswith("#"):  # what MATLAB's cells refer to
                continue
            if isinstance(member, h5py.Group):
                members[name] = content(member)
                continue
            attributes = {key.lower(): value for key, value in member.attrs.items()}
            values = np.asarray(member)
            if (as_matlab := attributes.get("matlab_class")) is not None:
                values = values.T  # columns first
                if as_matlab == b"char":
                    members[name] = "".join(map(chr, values.ravel()))
                    continue
            if attributes.keys() & {"scale_factor", "add_offset"}:
                values = values * attributes.get("scale_factor", 1.0) + attributes.get("add_offset", 0.0)
            elif values.dtype.kind in "iu" and (factors := attributes.keys() & _CALIBRATIONS):
                raise RecordError(
                    f"{path}: {member.name} holds counts, and its {min(factors)} is not applied. Store values in their unit."
                )
            unit = _text(attributes.get("units", attributes.get("unit", "")))
            members[f"{name} [{unit}]" if unit else name] = values
            members |= {f"{name}.{key}": value for key, value in _intervals(path, attributes).items()}
        return members | _intervals(path, {key.lower(): value for key, value in group.attrs.items()})

    with h5py.File(path) as file:
        return content(file)


def _text(value: Any) -> str:
    """Return the text of an attribute: bytes, a text, or an array of one of these."""
    value = value.ravel()[0] if isinstance(value, np.ndarray) and value.size == 1 else value
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def _intervals(path: Path, attributes: Mapping[str, Any]) -> dict[str, float]:
    """Read rates [Hz], intervals and starts [s] from attributes; a unit may stand beside each, as dt_unit."""
    intervals: dict[str, float] = {}
    for key, value in attributes.items():
        known = FREQUENCY_UNITS if _bare(key) in _RATES else TIME_UNITS if _bare(key) in _STEPS | _STARTS else None
        if known is None or np.size(value) != 1:
            continue
        said = next((_text(attributes[f"{key}_{word}"]) for word in ("unit", "units") if f"{key}_{word}" in attributes), "")
        unit = find_unit(said, known) if said else next(iter(known))
        if unit is None:
            raise RecordError(f"{path}: {short(plain(key))} is in {short(plain(said))}; known units: {', '.join(known)}.")
        with suppress(ValueError):
            intervals["start" if _bare(key) in _STARTS else key] = float(np.ravel(value)[0]) * known[unit]
    return intervals


def _tdms(path: Path) -> Mapping[str, Any]:
    """Read the channels of a TDMS file by group, with their units, intervals [s] and starts [s]."""
    from nptdms import TdmsFile

    content: dict[str, dict[str, Any]] = {}
    for group in TdmsFile.read(path).groups():
        for channel in group.channels():
            unit = channel.properties.get("unit_string") or channel.properties.get("NI_UnitDescription") or ""
            values = np.asarray(channel[:])
            if values.dtype.kind == "M":
                values, unit = (values - values[:1]) / np.timedelta64(1, "s"), "s"
            named = content.setdefault(group.name, {})
            named[f"{channel.name} [{unit}]" if unit else channel.name] = values
            if step := channel.properties.get("wf_increment"):
                over = str(channel.properties.get("wf_xunit_string") or "s")
                if (known := find_unit(over, TIME_UNITS)) is None:
                    raise RecordError(f'{path}: channel {channel.name} is over "{short(plain(over))}" and not over time.')
                began = channel.properties.get("wf_start_time", np.datetime64(0, "us")) - np.datetime64(0, "us")
                named[f"{channel.name}.increment"] = float(step) * TIME_UNITS[known]
                offset = float(channel.properties.get("wf_start_offset", 0.0)) * TIME_UNITS[known]
                named[f"{channel.name}.start"] = began / np.timedelta64(1, "s") + offset
    return content if len(content) > 1 else next(iter(content.values()), {})


def _wav(path: Path) -> Mapping[str, Any]:
    from scipy.io import wavfile

    rate, samples = wavfile.read(path)
    if samples.dtype.kind in "iu":
        full = 2.0 ** (8 * samples.dtype.itemsize - 1)
        samples = samples / full - (samples.dtype.kind == "u")
    return {"channel": samples, "fs": float(rate)}


def _seismic(path: Path) -> Mapping[str, Any]:
    """Read the channels of a record of seismology by obspy, with their starts [s] and their interval [s]."""
    from obspy import read

    traces = read(str(path))
    names = [trace.stats.channel or trace.id for trace in traces]
    if len({*names}) < len(names):
        raise RecordError(f"{path}: channel {max(names, key=names.count)} is there in several pieces. Use one without gaps.")
    if len({(trace.stats.npts, trace.stats.delta) for trace in traces}) > 1:
        raise RecordError(f"{path}: its channels have other instants than each other. Use a file for each.")
    scaled = traces[0].stats._format == "KNET"  # counts, and their factor in m/s^2
    columns = {
        f"{name} [m/s^2]" if scaled else name: np.asarray(trace.data) * (trace.stats.calib if scaled else 1.0)
        for name, trace in zip(names, traces, strict=True)
    }
    if not scaled and any(trace.stats.calib != 1.0 for trace in traces):
        raise RecordError(
            f"{path}: its calibration, {traces[0].stats.calib:g}, is not applied. Store its values in their unit."
        )
    starts = {f"{name}.start": float(trace.stats.starttime.timestamp) for name, trace in zip(names, traces, strict=True)}
    return {**columns, **starts, "dt": float(traces[0].stats.delta)}


def _columns_of_variables(path: Path, content: Mapping[str, Any], wanted: Collection[str]) -> Header:
    """Sort the variables of a file into columns (vectors, and lines of matrices), scalars and lists of names, and select."""
    columns: dict[str, Array] = {}
    scalars: dict[str, float] = {}
    texts: dict[str, list[str]] = {}
    left_out: list[str] = []
    for name, value in _leaves(content):
        many = isinstance(value, np.ndarray | list) and np.ndim(value) > 0
        # an empty text of MATLAB's is an array of none
        if isinstance(value, str) or (
            many and len(value) and all(isinstance(entry, str) or not np.size(entry) for entry in value)
        ):
            texts[name] = [value] if isinstance(value, str) else [entry if isinstance(entry, str) else "" for entry in value]
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.ndim <= 2:
            values = value.astype(np.float64)
            if values.size == 1:
                scalars[name] = float(values.ravel()[0])
            elif values.size == max(values.shape):
                columns[name] = values.ravel()
            else:
                wide, (bare, unit) = values.shape[0] < values.shape[1], split_unit(name)
                end = f" [{unit}]" if unit else ""
                lines = enumerate(values if wide else values.T, 1)
                columns |= {f"{bare}({i},:){end}" if wide else f"{bare}(:,{i}){end}": line for i, line in lines}
        elif isinstance(value, int | float | np.number):
            scalars[name] = float(value)
        elif many and np.size(value) > 1:
            left_out.append(split_unit(name)[0])
    return _select_columns(path, _label_columns(columns, texts), scalars, wanted, left_out)


def _leaves(content: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the leaves of a struct or an array of structs, by names such as test.acc or run(2).acc."""
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield from _leaves(value, f"{name}.{key}" if name else str(key))
    elif (
        isinstance(content, np.ndarray | list)
        and np.ndim(content)
        and len(content)
        and all(isinstance(entry, Mapping) for entry in content)
    ):
        for number, entry in enumerate(content, 1):
            yield from _leaves(entry, f"{name}({number})")
    elif (
        isinstance(content, np.ndarray)
        and content.dtype == object
        and all(isinstance(cell, np.ndarray) for cell in content.ravel())
    ):
        for number, cell in enumerate(content.ravel(), 1):
            yield f"{name}{{{number}}}", cell
    else:
        yield name, content


def _label_columns(columns: Mapping[str, Array], texts: Mapping[str, Sequence[str]]) -> dict[str, Array]:
    """Label the columns of each matrix by the only list of names of its width, with units from the only list of units.

    The vectors of a file are labelled as one matrix, if their names are those of the list with `_` for signs that MATLAB's
    names cannot have.
    """
    members: dict[str, list[str]] = {}  # columns by matrix, vectors under ""
    for name in columns:
        members.setdefault(name.rpartition("(")[0] if name.endswith(")") else "", []).append(name)
    labels: dict[str, dict[str, str]] = {}  # labels of the columns by matrix
    for matrix, member in members.items():
        of_width = {name: list(map(str.strip, text)) for name, text in texts.items() if len(text) == len(member)}
        units = {name: text for name, text in of_width.items() if "unit" in name.lower()}
        names = {name: text for name, text in of_width.items() if name not in units and len(set(text)) == len(member)}
        if not matrix:
            in_letters = {name: [re.sub(r"\W", "_", label) for label in text] for name, text in names.items()}
            names = {name: text for name, text in names.items() if in_letters[name] == member != text}
        if len(names) == 1:
            (called,) = names.values()
            (stated,) = units.values() if len(units) == 1 else [[""] * len(member)]
            headings = [f"{name} [{unit}]" if unit else name for name, unit in zip(called, stated, strict=True)]
            labels[matrix] = dict(zip(member, headings, strict=True))
    several = sum(map(bool, labels)) > 1  # then labels begin with the matrix, so that none repeats
    renamed = {
        name: f"{matrix}.{heading}" if several and matrix else heading
        for matrix, headings in labels.items()
        for name, heading in headings.items()
    }
    return {renamed.get(name, name): column for name, column in columns.items()}
