"""The tables of an isolator file: read with every rule checked, written atomically; points of a law also from a CSV file."""

import math
import re
import sys
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import MISSING, fields, replace
from pathlib import Path
from typing import Any

import tomli_w

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.table_files import read_header, rows_in_si
from wirerope_mj.foundation.table_header import Header
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, in_si
from wirerope_mj.mounts.isolator.parts import Bracket, Geometry, Limits, Provenance, Rotation, Spread, Stiffening, Travel
from wirerope_mj.mounts.isolator.validity import MeasuredRange, Validity
from wirerope_mj.mounts.laws import LAWS, Law, LoopCoupling, Parallel, Tabulated

# Quantities of a table and the units in which they may be given.
_UNITS: Mapping[str, Mapping[str, float]] = {
    "deflection": LENGTH_UNITS, "force": FORCE_UNITS, "upper": FORCE_UNITS, "lower": FORCE_UNITS,
    "amplitudes": LENGTH_UNITS, "areas": {"J": 1.0}, "yield_deflection": LENGTH_UNITS,
}  # fmt: skip
_COLUMNS = ("deflection", "force", "upper", "lower")


def curve_in_si(table: Entries, location: str, folder: Path | None) -> Entries:
    """Return the parameters of a tabulated law, all in SI, from those of a file.

    `deflection_mm = [...]` is `deflection` in other units, and `points = "curve.csv"` stands for the columns of that file, in
    `folder`. ModelError names location or file, line and rule of a quantity given twice or of a wrong file of points.
    """
    values: Entries = {}
    for key, value in table.items():
        name, _, unit = key.rpartition("_")
        factor = _UNITS.get(name, {}).get(unit)
        if factor is None and name in _UNITS and unit:
            raise ModelError(f"{location} `{key}` has the unknown unit {unit!r}. Known units: {', '.join(_UNITS[name])}.")
        _set_once(values, key if factor is None else name, _scaled(value, factor), location)
    if (file := values.pop("points", None)) is None:
        return values
    if not isinstance(file, str):
        raise ModelError(f"{location} `points` must be the name of a CSV file beside this one, got {file!r}.")
    if folder is None:
        raise ModelError(f"{location} `points` names a file, but this isolator was not read from a file: give the numbers.")
    try:
        columns = read_curve(folder / file)
    except RecordError as error:
        raise ModelError(f"{location} `points`: {error}") from None
    for name, numbers in columns.items():
        _set_once(values, name, numbers, location)
    return values


def read_curve(path: Path) -> dict[str, list[float]]:
    """Return the columns of a CSV file of points in SI units, each as long as the file has rows.

    The header is such as `deflection_mm,force_kN` or `deflection [mm], upper [N], lower [N]`. RecordError names file and line.
    """
    header = _with_units(read_header(path, kind="curve", example='"deflection_mm,force_N"'))
    for column, name in enumerate(header.names):
        if name not in _COLUMNS or name in header.names[:column]:
            fault = "appears twice" if name in header.names[:column] else "is not known"
            raise RecordError(f'{header.location}: column "{name}" {fault}; a curve has {", ".join(_COLUMNS)}.')
    rows = rows_in_si(header, {column: _UNITS[name] for column, name in enumerate(header.names)})
    return {name: [row[column] for row in rows] for column, name in enumerate(header.names)}


def _with_units(header: Header) -> Header:
    """Return the header with a unit behind an underscore taken for one in brackets."""
    names, units = [], []
    for name, unit in zip(header.names, header.units, strict=True):
        match = re.fullmatch(rf"({'|'.join(_COLUMNS)})_(\S+)", name) if unit is None else None
        names.append(match[1] if match else name)
        units.append(match[2] if match else unit)
    return replace(header, names=tuple(names), units=tuple(units))


def _set_once(values: Entries, name: str, value: object, location: str) -> None:
    """Take a value, or raise ModelError if it is stated already."""
    if name in values:
        raise ModelError(f"{location} `{name}` is stated twice.")
    values[name] = value


def _scaled(value: object, factor: float | None) -> object:
    """Return a number, or each of a list, times a factor; what is no number is left to the law to refuse."""
    if isinstance(value, list):
        return [_scaled(one, factor) for one in value]
    if factor is None or isinstance(value, bool) or not isinstance(value, int | float):
        return value
    return in_si(value, factor)


AXES = ("roll", "shear", "axial")  # Axes of an isolator in the order x (across the bars), y (along the bars), z (axial)
_KEYS = ("name", "coupling", "free")
PARTS = {
    "loop": LoopCoupling, "rotation": Rotation, "stiffening": Stiffening, "bracket": Bracket, "limits": Limits,
    "geometry": Geometry, "provenance": Provenance, "spread": Spread, "validity": Validity,
}  # fmt: skip


def read_tables(content: Entries, where: str, folder: Path | None = None) -> Entries:
    """Return the arguments of an Isolator from the content of a file in `folder`; ModelError names where, table, key, rule."""
    _require_keys(content, ("name",), (*_KEYS, *AXES, *PARTS), f"{where}:", "the file")
    arguments: Entries = {key: content[key] for key in _KEYS if key in content}
    for name in (*AXES, *PARTS):
        if name not in content:
            continue
        table, location = content[name], f"{where}: [{name}]"
        if not isinstance(table, dict):
            raise ModelError(f"{location} must be a table, got {table!r}.")
        arguments[name] = read_law(table, location, folder) if name in AXES else _read_part(name, table, location)
    return arguments


def read_law(table: Entries, location: str, folder: Path | None = None) -> Law:
    """Return the law, or the several `laws`, that an axis table of a file in `folder` describes.

    ModelError names `location`, key and rule.
    """
    if "laws" in table:
        return _read_parallel(table, location, folder)
    kind = LAWS.get(table["law"]) if isinstance(table.get("law"), str) else None
    if kind is None:
        known = ", ".join(sorted(LAWS))
        problem = f"there is no law {table['law']!r}" if "law" in table else "`law` is missing"
        raise ModelError(f"{location} {problem}; the laws are {known}.")
    parameters = {key: value for key, value in table.items() if key != "law"}
    if kind is Tabulated:
        parameters = curve_in_si(parameters, location, folder)
    return _make(kind, parameters, location, f"law {kind.name}")


def _read_parallel(table: Entries, location: str, folder: Path | None) -> Parallel:
    """Return the laws in parallel of an axis table."""
    for key in table:
        if key != "laws":
            raise ModelError(f"{location} `{key}` stands beside `laws`: put it into the table of a law in that list.")
    laws, inside = table["laws"], f"{location} laws"
    if not isinstance(laws, list) or not all(isinstance(one, dict) for one in laws):
        raise ModelError(f"{location} `laws` must be a list of tables, each with its `law`, got {laws!r}.")
    for index, one in enumerate(laws):
        if "laws" in one:
            raise ModelError(f"{inside}[{index}] holds `laws` itself: put all of them into one list.")
    try:
        return Parallel(laws=tuple(read_law(one, f"{inside}[{number}]", folder) for number, one in enumerate(laws)))
    except ValueError as error:
        raise ModelError(f"{location} {error}") from error


def _read_part(name: str, table: Entries, location: str) -> object:
    """Return what the table of this name describes."""
    if name == "provenance" and "kind" not in table:
        raise ModelError(f"{location} `kind` is missing: say where the parameters come from.")
    if name == "limits" and "travel" in table:  # a table of its own
        if not isinstance(table["travel"], dict):
            raise ModelError(f"{location} `travel` must be a table of deflections, got {table['travel']!r}.")
        table = {**table, "travel": _make(Travel, table["travel"], f"{location} travel:", "travel")}
    if name == "validity":  # a table for each axis
        _require_keys(table, (), AXES, location, "the validity")
        table = {axis: _range(one, f"{location[:-1]}.{axis}]") for axis, one in table.items()}
    return _make(PARTS[name], table, location, f"the {name}")


def _range(table: object, location: str) -> object:
    """Return the range of validity along one axis."""
    if not isinstance(table, dict):
        raise ModelError(f"{location} must be a table of ranges, got {table!r}.")
    return _make(MeasuredRange, table, location, "a range of validity")


def _make(kind: Callable[..., Any], table: Entries, location: str, title: str) -> Any:
    """Return `kind(**table)` with integers made floats; ModelError for a missing, extra or wrong entry."""
    items = fields(kind)  # type: ignore[arg-type]
    required = [item.name for item in items if item.default is item.default_factory is MISSING]
    _require_keys(table, required, [item.name for item in items], location, title)
    try:
        return kind(**{key: _as_float(value) for key, value in table.items()})
    except ValueError as error:
        raise ModelError(f"{location} {error}") from error


def _as_float(value: object) -> object:
    """Return an integer as a float, infinite if it is too large for one; anything else as it is."""
    if type(value) is not int:
        return value
    return float(value) if abs(value) <= sys.float_info.max else math.inf


def _require_keys(table: Entries, required: Iterable[str], known: Collection[str], location: str, title: str) -> None:
    """Raise ModelError unless every required key is there and every key is known."""
    for key in required:
        if key not in table:
            raise ModelError(f"{location} `{key}` is missing; {title} takes {', '.join(known)}.")
    for key in table:
        if key not in known:
            raise ModelError(f"{location} `{key}` is not known; {title} takes {', '.join(known)}.")


def write_toml(content: Entries, path: Path) -> None:
    """Write `content` as TOML, atomically."""
    text = tomli_w.dumps(content, multiline_strings=True)
    with atomic_file(path) as beside:
        beside.write_text(text, encoding="utf-8")
