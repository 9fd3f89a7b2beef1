"""The laws of an isolator file, and points of a law in a CSV file; isolator files are written atomically."""

import re
from dataclasses import replace
from pathlib import Path

import tomli_w

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.schema import schema
from wirerope_mj.foundation.structure import Place, structure
from wirerope_mj.foundation.table_files import read_header, rows_in_si
from wirerope_mj.foundation.table_header import Header
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS
from wirerope_mj.mounts.laws import LAWS, Law, Parallel, Tabulated

AXES = ("roll", "shear", "axial")  # Axes of an isolator in the order x (across the bars), y (along the bars), z (axial)
_COLUMNS = {"deflection": LENGTH_UNITS, "force": FORCE_UNITS, "upper": FORCE_UNITS, "lower": FORCE_UNITS}


def read_law(table: Entries, place: Place) -> Law:
    """Return the law, or the several `laws` in parallel, that the table of an axis describes.

    A tabulated law may name a file of its `points`, which stands for the columns of that file. ModelError names file, line,
    table, key and rule.
    """
    if not isinstance(table, dict):
        raise place.fault(f"it must be a table, got {quoted(table)}.")
    if "laws" in table:
        return structure(Parallel, table, place, {Law: _read_alone})
    kind = LAWS.get(table["law"]) if isinstance(table.get("law"), str) else None
    if kind is None:
        problem = f"there is no `law` {quoted(table['law'])}" if "law" in table else "`law` is missing"
        raise place.fault(f"{problem}; the laws are {', '.join(sorted(LAWS))}.")
    parameters = {key: value for key, value in table.items() if key != "law"}
    if kind is Tabulated and (file := parameters.pop("points", None)) is not None:
        if not isinstance(file, str):
            raise place.fault(f"`points` must be the name of a CSV file beside this one, got {quoted(file)}.")
        if not isinstance(place.file, Path):
            raise place.fault("`points` names a file, but this isolator was not read from a file: give the numbers.")
        try:
            columns = read_curve(place.file.parent / file)
        except RecordError as error:
            raise place.fault(f"`points`: {error}") from None
        if twice := [name for name in parameters if name.split("_")[0] in columns]:
            raise place.fault(f"`{twice[0]}` is stated twice, here and in `points`.")
        parameters |= columns
    return structure(kind, parameters, place)


def _read_alone(table: Entries, place: Place) -> Law:
    if "laws" in table:
        raise place.fault("it holds `laws` itself: put all of them into one list.")
    return read_law(table, place)


def law_schema() -> Entries:
    """Return the JSON Schema of the table of an axis, which is `$defs/law` of the file's."""
    found: list[Entries] = []
    for name, kind in sorted(LAWS.items()):
        content = schema(kind)
        keys = content["properties"]
        for key in keys:
            keys[key] |= {"unit": kind.units[key]} if key in kind.units else {}
            keys[key] |= {"minimum": 0} if key in kind.not_negative else {}
            keys[key] |= {"exclusiveMinimum": 0} if key in kind.above_zero else {}
        content["properties"] = {"law": {"const": name}} | keys
        content["required"] = ["law", *content.get("required", [])]
        if kind is Tabulated:
            content["properties"]["points"] = {"description": "name of a CSV file of the curves", "type": "string"}
            del content["allOf"]
        found.append(content)
    laws = {"type": "array", "items": {"$ref": "#/$defs/law"}, "minItems": 1}
    several = {"type": "object", "properties": {"laws": laws}, "required": ["laws"], "additionalProperties": False}
    return {"anyOf": [*found, several]}


def read_curve(path: Path) -> dict[str, list[float]]:
    """Return the columns of a CSV file of points in SI units, each as long as the file has rows.

    The header is such as `deflection_mm,force_kN` or `deflection [mm], upper [N], lower [N]`. RecordError names file and line.
    """
    header = _with_units(read_header(path, kind="curve", example='"deflection_mm,force_N"'))
    for column, name in enumerate(header.names):
        if name not in _COLUMNS or name in header.names[:column]:
            fault = "appears twice" if name in header.names[:column] else "is not known"
            raise RecordError(f'{header.location}: column "{name}" {fault}; a curve has {", ".join(_COLUMNS)}.')
    rows = rows_in_si(header, {column: _COLUMNS[name] for column, name in enumerate(header.names)})
    return {name: [row[column] for row in rows] for column, name in enumerate(header.names)}


def _with_units(header: Header) -> Header:
    """Return the header with a unit behind an underscore taken for one in brackets."""
    names, units = [], []
    for name, unit in zip(header.names, header.units, strict=True):
        match = re.fullmatch(rf"({'|'.join(_COLUMNS)})_(\S+)", name) if unit is None else None
        names.append(match[1] if match else name)
        units.append(match[2] if match else unit)
    return replace(header, names=tuple(names), units=tuple(units))


def write_toml(content: Entries, path: Path) -> None:
    """Write `content` as TOML, atomically."""
    text = tomli_w.dumps(content, multiline_strings=True)
    with atomic_file(path) as beside:
        beside.write_text(text, encoding="utf-8")
