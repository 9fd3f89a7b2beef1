"""Points of a tabulated law in an isolator file: lists with a unit in their key, or a CSV file with units in its header."""

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.csv_units import Header, number_in, read_header, rows_below
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, in_si

# Quantities of a table and the units in which they may be given.
_UNITS: Mapping[str, Mapping[str, float]] = {
    "deflection": LENGTH_UNITS, "force": FORCE_UNITS, "upper": FORCE_UNITS, "lower": FORCE_UNITS,
    "amplitudes": LENGTH_UNITS, "areas": {"J": 1.0}, "yield_deflection": LENGTH_UNITS,
}  # fmt: skip
_COLUMNS = ("deflection", "force", "upper", "lower")


def curve_in_si(table: Mapping[str, Any], location: str, folder: Path | None) -> dict[str, Any]:
    """Return the parameters of a tabulated law, all in SI, from those of a file.

    `deflection_mm = [...]` is `deflection` in other units, and `points = "curve.csv"` stands for the columns of that file,
    in `folder`.

    Raises:
        ModelError: a quantity is given twice, or the file of points is wrong; names the location or file, line and rule.
    """
    values: dict[str, Any] = {}
    for key, value in table.items():
        name, _, unit = key.rpartition("_")
        factor = _UNITS.get(name, {}).get(unit)
        if factor is None and name in _UNITS and unit:
            raise ModelError(
                f"{location} `{key}` has the unknown unit {unit!r}. Known units: {', '.join(_UNITS[name])}."
            )
        _set_once(values, key if factor is None else name, _scaled(value, factor), location)
    if (file := values.pop("points", None)) is None:
        return values
    if not isinstance(file, str):
        raise ModelError(f"{location} `points` must be the name of a CSV file beside this one, got {file!r}.")
    if folder is None:
        raise ModelError(
            f"{location} `points` names a file, but this isolator was not read from a file: give the numbers."
        )
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
    factors: dict[str, float] = {}
    for column, name in enumerate(header.names):
        if name not in _COLUMNS or name in factors:
            fault = "appears twice" if name in factors else "is not known"
            raise RecordError(f'{header.location}: column "{name}" {fault}; a curve has {", ".join(_COLUMNS)}.')
        factors[name] = header.factor(column, _UNITS[name])
    columns: dict[str, list[float]] = {name: [] for name in factors}
    for _, location, cells in rows_below(header):
        for (name, factor), cell in zip(factors.items(), cells, strict=True):
            columns[name].append(in_si(number_in(location, name, cell), factor))
    return columns


def _with_units(header: Header) -> Header:
    """Return the header with a unit behind an underscore taken for one in brackets."""
    names, units = [], []
    for name, unit in zip(header.names, header.units, strict=True):
        match = re.fullmatch(rf"({'|'.join(_COLUMNS)})_(\S+)", name) if unit is None else None
        names.append(match[1] if match else name)
        units.append(match[2] if match else unit)
    return replace(header, names=tuple(names), units=tuple(units))


def _set_once(values: dict[str, Any], name: str, value: Any, location: str) -> None:
    """Take a value, or raise ModelError if it is stated already."""
    if name in values:
        raise ModelError(f"{location} `{name}` is stated twice.")
    values[name] = value


def _scaled(value: Any, factor: float | None) -> Any:
    """Return a number, or each of a list, times a factor; what is no number is left to the law to refuse."""
    if isinstance(value, list):
        return [_scaled(one, factor) for one in value]
    if factor is None or isinstance(value, bool) or not isinstance(value, int | float):
        return value
    return in_si(value, factor)
