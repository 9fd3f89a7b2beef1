"""A measured record from a universal file: functions at nodal degrees of freedom, dataset 58, as text or binary."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.table_files import LARGEST
from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, LENGTH_UNITS, TIME_UNITS, VELOCITY_UNITS, find_unit
from wirerope_mj.motions.records.reading import Reading, axes_of

_DIRECTION_NAMES = {1: "x", 2: "y", 3: "z", -1: "-x", -2: "-y", -3: "-z"}
_VECTORS: dict[str, Direction] = {"-x": (-1.0, 0.0, 0.0), "-y": (0.0, -1.0, 0.0), "-z": (0.0, 0.0, -1.0)}
_TIME_RESPONSE, _GENERAL, _TIME, _ACCELERATION = 1, 0, 17, 12
_UNKNOWN = (0, 1)  # specific data types "unknown" and "general"
# specific data types of an ordinate that are measured: word behind the name of a channel, and its unit in SI
_MEASURED = {
    _ACCELERATION: ("", "m/s^2"), 11: ("velocity", "m/s"), 8: ("displacement", "m"), 13: ("force", "N"), 9: ("force", "N"),
}  # fmt: skip
_UNITS = ACCELERATION_UNITS | VELOCITY_UNITS | LENGTH_UNITS | FORCE_UNITS
_REAL_TYPES = (2, 4)  # types of ordinate data: single and double precision
_SI = 1  # code of the system of units
# fraction of the interval by which the clocks of two channels may differ: text files carry six digits of it
_SAME_CLOCK = 1e-3
Histories = list[tuple[int, Entries]]  # number and header of each
_CUT = ": it was cut off before the line -1 that ends a dataset. Export or copy it again."
_DAMAGED = " whose header or values are damaged or do not fit each other. Export or copy it again."


def is_uff(path: Path) -> bool:
    """True if the file begins as universal files do, with a line that holds -1 alone."""
    try:
        with regular(path).open("rb") as file:
            lines = file.read(400).split(b"\n")
    except OSError:
        return False
    return next((line.strip() for line in lines if line.strip()), b"") == b"-1"


def _is_complete(path: Path) -> bool:
    """True if the file ends as universal files do, with a line that holds -1 alone."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - 400))
        return file.read().split()[-1:] == [b"-1"]


def uff_channels(path: Path) -> tuple[str, ...]:
    """Return the names of the acceleration histories: response node and direction, as in `12:z` or `12:-x`."""
    return tuple(_names([head for _, head in _histories(path, None)[0]]))


def read_uff(path: Path, channels: Mapping[str, Direction] | None, unit: str | None) -> Reading:
    """Return the time histories of acceleration in a universal file.

    Without `channels`, named as by `uff_channels`, all are read, along their own directions; the default `unit` is that of the
    ordinate's label, then that of dataset 164.
    """
    histories, systems = _histories(path, unit)
    heads = dict(histories)
    if channels is None:
        chosen = _directions_of_single_node(path, histories)
    else:
        names = _names(list(heads.values()))
        places = {_index_of(path, list(heads.values()), names, name): direction for name, direction in channels.items()}
        chosen = {histories[place][0]: direction for place, direction in places.items()}
    units, factors = zip(*(_unit(path, heads[number], unit, systems) for number in chosen), strict=True)
    time, samples = _on_one_clock(path, {number: _name(heads[number]) for number in chosen})
    reading = Reading(time, (samples * factors) @ axes_of(chosen.values()), units=tuple(dict.fromkeys(units)))
    if _is_complete(path):
        return reading
    return reading.warned("the end of this universal file is missing; what was cut off is not read.")


def read_uff_columns(path: Path, names: Sequence[str]) -> tuple[Reading, tuple[str | None, ...]]:
    """Read time histories of a universal file as they are, (n, n_columns), and the unit of each, None where none is stated.

    Histories of acceleration, and those of unknown kind, are called by node and direction, `12:z`; others have their
    quantity behind that, as in `12:z displacement`.
    """
    _, heads, systems = _datasets(path)
    histories = [(n, head) for n, head in heads if _is_in_time(head)]
    if not histories:
        raise RecordError(f"{path}: this universal file holds no complete time history (dataset 58, function type 1).")
    kinds = [int(head.get("ordinate_spec_data_type", 0)) for _, head in histories]
    names_there = _names([head for _, head in histories], [_MEASURED.get(kind, ("",))[0] for kind in kinds])
    chosen, units = dict[int, str](), list[str | None]()
    for name in names:
        place = _index_of(path, [head for _, head in histories], names_there, name)
        (number, head), kind = histories[place], kinds[place]
        chosen[number] = name
        label = _label(head, "ordinate")
        unit: str | None = find_unit(label, _UNITS) or label or None
        if unit is None and kind in _MEASURED and systems and int(systems[-1]["units_code"]) == _SI:
            unit = _MEASURED[kind][1]
        units.append(unit)
    time, samples = _on_one_clock(path, chosen, " Read them as two tests.")
    return Reading(time, samples, units=()), tuple(units)


def _open(path: Path) -> Any:
    import pyuff  # here, because few records are universal files

    return pyuff.UFF(str(path))


def _histories(path: Path, unit: str | None) -> tuple[Histories, list[Entries]]:
    """Return number and header of each history of acceleration, and the datasets 164 with their system of units."""
    kinds, heads, systems = _datasets(path)
    histories = []
    for n, head in heads:
        kind = int(head.get("ordinate_spec_data_type", 0))
        known = unit or find_unit(_label(head, "ordinate"), ACCELERATION_UNITS)
        if _is_in_time(head) and (kind == _ACCELERATION or (kind in _UNKNOWN and known)):
            histories.append((n, head))
    if not histories and not _is_complete(path):
        raise RecordError(f"{path}: this universal file holds no complete time history of an acceleration{_CUT}")
    if not histories:
        raise RecordError(
            f"{path}: this universal file holds no time history of an acceleration (dataset 58, function type 1); its "
            f"datasets are {', '.join(str(kind) for kind in kinds)}. If an ordinate is called general or unknown, "
            'say its unit, for instance unit="m/s^2" (--unit).'
        )
    return histories, systems


def _datasets(path: Path) -> tuple[list[int], Histories, list[Entries]]:
    """Return the types of all datasets, number and header of each dataset 58 (histories), and the datasets 164 (units)."""
    try:
        file = _open(path)
        kinds = [int(kind) for kind in file.get_set_types()]
        heads = [(n, file.read_sets(n, header_only=True)) for n, kind in enumerate(kinds) if kind == 58]
        systems = [file.read_sets(n) for n, kind in enumerate(kinds) if kind == 164]
    except Exception:  # the reader knows no other class, and does not say what it met
        raise RecordError(f"{path}: this universal file cannot be read, it has a dataset{_DAMAGED}") from None
    if not kinds:
        raise RecordError(f"{path}: this universal file holds no complete dataset{_CUT}")
    return kinds, heads, systems


def _is_in_time(head: Entries) -> bool:
    """True if a header is of a history of real numbers over time, along an axis and not about one."""
    kind, over = (int(head.get(k, 0)) for k in ("func_type", "abscissa_spec_data_type"))
    in_time = kind == _TIME_RESPONSE or (kind == _GENERAL and over == _TIME)
    turns = abs(int(head.get("rsp_dir", 0))) > 3
    return in_time and int(head.get("ord_data_type", 0)) in _REAL_TYPES and not turns


def _unit(path: Path, head: Entries, unit: str | None, systems: list[Entries]) -> tuple[str, float]:
    """Return the unit of a history as text, and its factor to m/s^2."""
    label = unit if unit is not None else _label(head, "ordinate")
    if found := find_unit(label, ACCELERATION_UNITS):
        return found, ACCELERATION_UNITS[found]
    if label:
        raise RecordError(
            f'{path}: {_name(head)} has the unknown unit "{label}". Say which is meant, for instance unit="g" (--unit g); '
            f"known units: {', '.join(ACCELERATION_UNITS)}."
        )
    if not systems:
        raise RecordError(
            f"{path}: neither {_name(head)} nor a dataset 164 says the unit of the accelerations. Say it, for instance "
            f'unit="m/s^2" (--unit); known units: {", ".join(ACCELERATION_UNITS)}.'
        )
    code, length = int(systems[-1]["units_code"]), float(systems[-1]["length"])  # units of length in a metre
    if not 1.0 / LARGEST < length < LARGEST or (code == _SI and abs(length - 1.0) > 1e-6):
        raise RecordError(
            f"{path}: dataset 164 contradicts itself: units code {code}, but {length:g} units of length in a metre. "
            'Say the unit of the accelerations, for instance unit="m/s^2" (--unit).'
        )
    return ("m/s^2" if length == 1.0 else f"1/{length:g} m/s^2"), 1.0 / length


def _label(head: Entries, axis: str) -> str:
    text = str(head.get(f"{axis}_axis_units_lab", "")).strip().strip("[]()").strip()
    return "" if text.lower() == "none" else text


def _name(head: Entries) -> str:
    node, end = int(head.get("rsp_node", 0)), _DIRECTION_NAMES.get(int(head.get("rsp_dir", 0)))
    return f"{node}:{end}" if end else f"{node}"


def _names(heads: Sequence[Entries], quantities: Sequence[str] | None = None) -> list[str]:
    """Return the names of histories; of several with one node and direction `1:z#1`, `1:z#2`, in the order of the file."""
    words = quantities if quantities is not None else [""] * len(heads)
    bare = [f"{_name(head)} {word}".strip() for head, word in zip(heads, words, strict=True)]
    return [f"{name}#{bare[: i + 1].count(name)}" if bare.count(name) > 1 else name for i, name in enumerate(bare)]


def _index_of(path: Path, heads: Sequence[Entries], names: Sequence[str], name: str) -> int:
    """Return the index of the history with a name; of several at one node, `1:z#2` or, by its ID line, `1:z#run 2`."""
    if name in names:
        return names.index(name)
    bare, _, line = name.partition("#")
    lines = [[str(head.get(key, "")).strip() for key in ("id1", "id2", "id3", "id4", "id5")] for head in heads]
    several = [i for i, other in enumerate(names) if other.partition("#")[0] == bare]
    by_line = [i for i in several if line and line in lines[i]]
    if len(by_line) == 1:
        return by_line[0]
    listed = ", ".join(f"{other} ({lines[i][0]})" if "#" in other and lines[i][0] else other for i, other in enumerate(names))
    fault = f'there is no history "{name}"'
    if several and not line:
        fault = f'there are {len(several)} histories "{name}", choose one by its number or its ID line'
    raise RecordError(f"{path}: {fault}; the file holds {plain(short(listed, 600))}.")


def _directions_of_single_node(path: Path, histories: Histories) -> dict[int, Direction]:
    """Return the direction of every history by its number; RecordError unless all have one node and different axes.

    Names are `node:direction`, as in "12:-z", or `node:direction#n` where several have one node and direction.
    """
    names = _names([head for _, head in histories])
    directions = [name.partition(":")[2].partition("#")[0] for name in names]
    nodes = {name.partition(":")[0] for name in names}
    axes = {direction.lstrip("-") for direction in directions}
    if len(nodes) > 1 or not all(directions) or len(axes) < len(directions):
        axis = (directions[0] or "z").lstrip("-")
        raise RecordError(
            f"{path}: which of {', '.join(names)} move the base? Name one for each direction, for instance "
            f'channels={{"{names[0]}": "{axis}"}} (--channels {names[0]}={axis}).'
        )
    return {n: _VECTORS.get(direction, direction) for (n, _), direction in zip(histories, directions, strict=True)}


def _values(path: Path, number: int, name: str) -> tuple[Array, Array]:
    """Return instants [s] and values of a history; RecordError if it is cut off or not finite."""
    try:
        content = _open(path).read_sets(number)
    except Exception:  # the reader knows no other class, and does not say what it met
        raise RecordError(f"{path}: {name} cannot be read, its dataset is one{_DAMAGED}") from None
    count = int(content["num_pts"])
    time, values = np.asarray(content["x"], dtype=float)[:count], np.asarray(content["data"], dtype=float)[:count]
    if values.size < count or count < 2:
        raise RecordError(f"{path}: {name} holds {values.size} values where its header says {count}; 2 at least.")
    if not (np.all(np.abs(values) <= LARGEST) and np.all(np.abs(time) <= LARGEST) and np.all(time[1:] > time[:-1])):
        raise RecordError(
            f"{path}: {name} has a value or a time that is not finite or beyond {LARGEST:.0e}, or its times do not increase."
        )
    unit = find_unit(_label(content, "abscissa") or "s", TIME_UNITS)
    if unit is None:
        raise RecordError(
            f'{path}: the time of {name} has the unknown unit "{_label(content, "abscissa")}"; known: {", ".join(TIME_UNITS)}.'
        )
    return time * TIME_UNITS[unit], values


def _on_one_clock(path: Path, chosen: Mapping[int, str], remedy: str = "") -> tuple[Array, Array]:
    """Read histories, given by number: instants [s], (n,), and values (n, n_histories); RecordError where instants differ."""
    time, columns = np.zeros(0), list[Array]()
    for number, name in chosen.items():
        clock, values = _values(path, number, name)
        time = time if columns else clock
        if time.size != clock.size or np.max(np.abs(time - clock)) > _SAME_CLOCK * (time[1] - time[0]):
            first = next(iter(chosen.values()))
            raise RecordError(f"{path}: {name} is sampled at other instants than {first}.{remedy}")
        columns.append(values)
    return time, np.column_stack(columns)
