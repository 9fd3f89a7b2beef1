"""The laws of an isolator file, and points of a law in a CSV file."""

from dataclasses import replace
from pathlib import Path

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.schema import schema
from wirerope_mj.foundation.structure import Place, structure
from wirerope_mj.foundation.table_files import read_header, rows_in_si
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
        return structure(Parallel, table, place, {Law: _read_one_of_several})
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


def _read_one_of_several(table: Entries, place: Place) -> Law:
    if "laws" in table:
        raise place.fault("it holds `laws` itself: put all of them into one list.")
    return read_law(table, place)


def law_schema() -> Entries:
    """Return the JSON Schema of the table of an axis, which is `$defs/law` of the file's."""
    schemas: list[Entries] = []
    for name, kind in sorted(LAWS.items()):
        content = schema(kind)
        content["properties"] = {"law": {"const": name}} | content["properties"]
        content["required"] = ["law", *content.get("required", [])]
        if kind is Tabulated:
            content["properties"]["points"] = {"description": "name of a CSV file of the curves", "type": "string"}
            del content["allOf"]
        schemas.append(content)
    laws = {"type": "array", "items": {"$ref": "#/$defs/law"}, "minItems": 1}
    several = {"type": "object", "properties": {"laws": laws}, "required": ["laws"], "additionalProperties": False}
    return {"anyOf": [*schemas, several]}


def read_curve(path: Path) -> dict[str, list[float]]:
    """Return the columns of a CSV file of points in SI units, each as long as the file has rows.

    The header is such as `deflection_mm,force_kN` or `deflection [mm], upper [N], lower [N]`. RecordError names file and line.
    """
    header = read_header(path, kind="curve", example='"deflection_mm,force_N"')
    names, units = list(header.names), list(header.units)
    for column, name in enumerate(header.names):
        known, _, unit = name.partition("_")
        if unit and units[column] is None and known in _COLUMNS:
            names[column], units[column] = known, unit
        if names[column] not in _COLUMNS or names[column] in names[:column]:
            fault = "appears twice" if names[column] in names[:column] else "is not known"
            raise RecordError(f'{header.location}: column "{names[column]}" {fault}; a curve has {", ".join(_COLUMNS)}.')
    header = replace(header, names=tuple(names), units=tuple(units))
    rows = rows_in_si(header, {column: _COLUMNS[name] for column, name in enumerate(names)})
    return {name: [row[column] for row in rows] for column, name in enumerate(names)}
