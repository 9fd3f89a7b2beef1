"""The tables of an isolator file: read with every rule checked, written atomically."""

import math
import sys
from collections.abc import Callable
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import tomli_w

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.isolator.curves import curve_in_si
from wirerope_mj.mounts.isolator.parts import Geometry, Limits, Provenance, Rotation, Spread, Stiffening, Travel
from wirerope_mj.mounts.isolator.validity import MeasuredRange, Validity
from wirerope_mj.mounts.laws import LAWS, Law, LoopCoupling, Parallel, Tabulated

AXES = ("roll", "shear", "axial")  # Axes of an isolator in the order x (across the bars), y (along the bars), z (axial)
_KEYS = ("name", "coupling", "free")
_PARTS = {
    "loop": LoopCoupling,
    "rotation": Rotation,
    "stiffening": Stiffening,
    "limits": Limits,
    "geometry": Geometry,
    "provenance": Provenance,
    "spread": Spread,
    "validity": Validity,
}


def read_tables(content: dict[str, Any], where: str, folder: Path | None = None) -> dict[str, Any]:
    """Return the arguments of an Isolator from the content of a file in `folder`; ModelError names where, table, key, rule."""
    _require_keys(content, ("name",), (*_KEYS, *AXES, *_PARTS), f"{where}:", "the file")
    arguments: dict[str, Any] = {key: content[key] for key in _KEYS if key in content}
    for name in (*AXES, *_PARTS):
        if name not in content:
            continue
        table, location = content[name], f"{where}: [{name}]"
        if not isinstance(table, dict):
            raise ModelError(f"{location} must be a table, got {table!r}.")
        arguments[name] = read_law(table, location, folder) if name in AXES else _read_part(name, table, location)
    return arguments


def read_law(table: dict[str, Any], location: str, folder: Path | None = None) -> Law:
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


def _read_parallel(table: dict[str, Any], location: str, folder: Path | None) -> Parallel:
    """Return the laws in parallel of an axis table."""
    for key in table:
        if key != "laws":
            raise ModelError(f"{location} `{key}` stands beside `laws`: put it into the table of a law in that list.")
    laws = table["laws"]
    if not isinstance(laws, list) or not all(isinstance(one, dict) for one in laws):
        raise ModelError(f"{location} `laws` must be a list of tables, each with its `law`, got {laws!r}.")
    for index, one in enumerate(laws):
        if "laws" in one:
            raise ModelError(f"{location} laws[{index}] holds `laws` itself: put all of them into one list.")
    try:
        return Parallel(
            laws=tuple(read_law(one, f"{location} laws[{index}]", folder) for index, one in enumerate(laws))
        )
    except ValueError as error:
        raise ModelError(f"{location} {error}") from error


def _read_part(name: str, table: dict[str, Any], location: str) -> Any:
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
    return _make(_PARTS[name], table, location, f"the {name}")


def _range(table: Any, location: str) -> MeasuredRange:
    """Return the range of validity along one axis."""
    if not isinstance(table, dict):
        raise ModelError(f"{location} must be a table of ranges, got {table!r}.")
    range_: MeasuredRange = _make(MeasuredRange, table, location, "a range of validity")
    return range_


def _make(kind: Callable[..., Any], table: dict[str, Any], location: str, title: str) -> Any:
    """Return `kind(**table)` with integers made floats; ModelError for a missing, extra or wrong entry."""
    known = [item.name for item in fields(kind)]  # type: ignore[arg-type]
    required = [
        item.name
        for item in fields(kind)  # type: ignore[arg-type]
        if item.default is MISSING and item.default_factory is MISSING
    ]
    _require_keys(table, required, known, location, title)
    try:
        return kind(**{key: _as_float(value) for key, value in table.items()})
    except ValueError as error:
        raise ModelError(f"{location} {error}") from error


def _as_float(value: Any) -> Any:
    """Return an integer as a float, infinite if it is too large for one; anything else as it is."""
    if type(value) is not int:
        return value
    return float(value) if abs(value) <= sys.float_info.max else math.inf


def _require_keys(table: dict[str, Any], required: Any, known: Any, location: str, title: str) -> None:
    """Raise ModelError unless every required key is there and every key is known."""
    for key in required:
        if key not in table:
            raise ModelError(f"{location} `{key}` is missing; {title} takes {', '.join(known)}.")
    for key in table:
        if key not in known:
            raise ModelError(f"{location} `{key}` is not known; {title} takes {', '.join(known)}.")


def write_toml(content: dict[str, Any], path: Path) -> None:
    """Write `content` as TOML, atomically."""
    text = tomli_w.dumps(content, multiline_strings=True)
    with atomic_file(path) as beside:
        beside.write_text(text, encoding="utf-8")
