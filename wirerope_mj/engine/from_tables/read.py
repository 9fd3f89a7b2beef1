"""The tables of a model read and checked row by row."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from wirerope_mj.engine.from_tables.layout import (
    Box,
    Layout,
    Placed,
    Point,
    StopLaw,
    axes_along,
    check_places,
)
from wirerope_mj.engine.from_tables.masses import SIZES, read_masses
from wirerope_mj.engine.from_tables.sheet import PURE, TEXT, Row, read_sheet
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError, ModelError, RecordError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.mounts.isolator import AXES, Bracket
from wirerope_mj.mounts.vendor_parts import VendorPart, find_isolator, load_isolator

_POSITION = {"name": TEXT, "x": "length", "y": "length", "z": "length"}
_DIRECTION = dict.fromkeys(("direction_x", "direction_y", "direction_z", "bars_x", "bars_y", "bars_z"), PURE)
_ANGLES = {"inclination": "angle", "azimuth": "angle"}
_CENTRE, _CORNER = (tuple(f"{of}_{axis}" for axis in "xyz") for of in ("centre", "corner"))
# depth over which a stop closes softly unless its row says another: that of the stops of the models that ship [m]
_ROUNDING = 1e-3


def read_layout(name: str, tables: Mapping[str, Path], *, products: str = "") -> Layout:
    """Read and check the tables of a model, by their names; those of mounts and masses are needed.

    mounts: name, x, y, z, isolator, and a direction or inclination and azimuth; perhaps bracket_axial, bracket_shear,
    bracket_roll, the stiffness of what a mount is bolted to.

    masses: name, mass, x, y, z of the centre of mass and the inertia about it, or the size_x, size_y, size_z of a box that is
    filled evenly; of a subassembly that rings on its own its frequency, and perhaps damping and along, x, y or z. Or a CAD
    program's text, .txt.

    stops: name, x, y, z, direction, and gap, stiffness, damping or an isolator.

    points, forces: name, x, y, z of points that are observed, and of those at which forces may act.

    envelope: boxes around the payload: name, size_x, size_y, size_z, and centre_x, centre_y, centre_z, or corner_x, corner_y,
    corner_z, the corner that is lowest along each axis.

    Args:
        name: of the payload.
        tables: CSV files, or workbooks with a sheet of the table's name.
        products: "positive" if products of inertia are +sum x y dm, as CAD programs may write them, "tensor" if they are
            elements of the tensor; "" as a text says it, and of a table elements of the tensor.

    Raises:
        RecordError: a table is wrong; says file, row and column.
        ModelError: an isolator's file is wrong.
    """
    if not name or name == "deck" or not all(c.isalnum() or c in "_-." for c in name) or name.startswith("."):
        raise ValueError(
            f'names of a model and its payload must be letters, digits, "_" and "-", and not "deck"; got {short(name)!r}.'
        )
    heavy = read_masses(tables["masses"], products=products)
    isolators: dict[str, Path | VendorPart] = {}
    placed = _read_mounts(tables["mounts"], isolators)
    stopped = _read_stops(tables["stops"], isolators) if "stops" in tables else ()
    for stop in stopped:
        if stop.name in {mount.name for mount in placed}:
            raise RecordError(f'{stop.location}: a mount is called "{stop.name}" too. Give the stop another name.')
    layout = Layout(
        name=name, masses=heavy, mounts=placed, stops=stopped, points=_read_points(tables, "points"),
        forces=_read_points(tables, "forces"), envelope=_read_envelope(tables), isolators=isolators,
    )  # fmt: skip
    check_places(layout, tables["masses"])
    return layout


def _read_mounts(path: Path, isolators: dict[str, Path | VendorPart]) -> tuple[Placed, ...]:
    needed = {**_POSITION, "isolator": TEXT}
    brackets = {f"bracket_{axis}": axis for axis in AXES}
    further = {**_DIRECTION, **_ANGLES, **dict.fromkeys(brackets, "stiffness")}
    rows = read_sheet(path, kind="table of mounts", needed=needed, further=further)
    mounts: list[Placed] = []
    for row in rows:
        name = _site_name(row)
        isolator = _isolator(row, path, isolators)
        stiff = {axis: row.number(column) for column, axis in brackets.items() if row.has(column)}
        try:
            bracket = Bracket(**stiff) if stiff else None
            if bracket is not None:
                replace(load_isolator(isolators[isolator]), bracket=bracket)
        except (ModelError, ValueError) as error:
            raise row.error(f'column "bracket_{next(iter(stiff))}": {error}') from None
        mounts.append(Placed(name, _position(row), _axes(row), isolator, row.location, bracket=bracket))
    return tuple(mounts)


def _read_stops(path: Path, isolators: dict[str, Path | VendorPart]) -> tuple[Placed, ...]:
    figures = {"gap": "length", "stiffness": "stiffness", "damping": "damping", "rounding": "length"}
    rows = read_sheet(
        path, kind="table of stops", needed=_POSITION, further={"isolator": TEXT, **figures, **_DIRECTION, **_ANGLES}
    )
    laws: dict[StopLaw, str] = {}
    stops = []
    for row in rows:
        name = _site_name(row)
        if row.has("isolator"):
            if given := [column for column in figures if row.has(column)]:
                raise row.error(
                    f'"{short(name)}" has an isolator and a {given[0]}; the isolator\'s file says '
                    f'all of it. Leave column "isolator" or column "{given[0]}" empty.'
                )
            law, isolator = None, _isolator(row, path, isolators)
        else:
            gap, stiffness = row.number("gap"), row.number("stiffness")
            damping, rounding = row.number("damping", 0.0), row.number("rounding", _ROUNDING)
            for column, value in (("gap", gap), ("stiffness", stiffness), ("damping", damping), ("rounding", rounding)):
                least = ">" if column in {"stiffness", "rounding"} else ">="
                if not (value > 0.0 if least == ">" else value >= 0.0):
                    raise row.error(f'column "{column}" must be {least} 0, got {value:g} in SI units.')
            law = StopLaw(gap, stiffness, damping, rounding)
            isolator = laws.setdefault(law, f"stop_of_table_{len(laws) + 1}")
        stops.append(Placed(name, _position(row), _axes(row), isolator, row.location, law))
    return tuple(stops)


def _read_points(tables: Mapping[str, Path], kind: str) -> tuple[Point, ...]:
    if kind not in tables:
        return ()
    rows = read_sheet(tables[kind], kind=f"table of {kind}", needed=_POSITION, further={})
    return tuple(Point(_site_name(row), _position(row), row.location) for row in rows)


def _read_envelope(tables: Mapping[str, Path]) -> tuple[Box, ...]:
    if "envelope" not in tables:
        return ()
    places = dict.fromkeys((*_CENTRE, *_CORNER), "length")
    needed = {"name": TEXT, **dict.fromkeys(SIZES, "length")}
    boxes = []
    for row in read_sheet(tables["envelope"], kind="table of the envelope", needed=needed, further=places):
        size = np.array(row.vector(*SIZES))
        if not (size > 0.0).all():
            raise row.error('columns "size_x", "size_y", "size_z" must be > 0.')
        centred, cornered = (any(row.has(column) for column in columns) for columns in (_CENTRE, _CORNER))
        if centred == cornered:
            raise row.error(
                f'a box stands where "centre_x", "centre_y", "centre_z" or "corner_x", "corner_y", "corner_z" '
                f"say, one of the two; {'both are' if centred else 'none is'} filled in."
            )
        centre = np.array(row.vector(*_CENTRE)) if centred else np.array(row.vector(*_CORNER)) + 0.5 * size
        boxes.append(Box(row.text("name"), centre, size))
    return tuple(boxes)


def _site_name(row: Row) -> str:
    name = row.text("name")
    if "/" in name or any(character.isspace() for character in name):
        raise row.error(f'column "name": "{short(name)}" holds a space or "/", which names in a model cannot. Write "_".')
    return name


def _position(row: Row) -> Array:
    return np.array(row.vector("x", "y", "z"))


def _axes(row: Row) -> Array:
    """Return the axes of a mount from its direction, or inclination and azimuth; upright where a row has none of them."""
    vector = [column for column in ("direction_x", "direction_y", "direction_z") if row.has(column)]
    angles = [column for column in ("inclination", "azimuth") if row.has(column)]
    if vector and angles:
        raise row.error(f'columns "{vector[0]}" and "{angles[0]}" both say the direction; leave one empty.')
    axial = np.array([0.0, 0.0, 1.0])
    if vector:
        axial = np.array(row.vector("direction_x", "direction_y", "direction_z"))
        if not axial.any():
            raise row.error('columns "direction_x" to "direction_z" are all zero.')
    elif angles:
        inclination, azimuth = row.number("inclination"), row.number("azimuth", 0.0)
        if not 0.0 <= inclination <= math.pi * (1.0 + 1e-12):
            raise row.error('column "inclination" must lie between 0 and 180 degrees.')
        flat = math.sin(inclination)
        axial = np.array([flat * math.cos(azimuth), flat * math.sin(azimuth), math.cos(inclination)])
    if not any(row.has(column) for column in ("bars_x", "bars_y", "bars_z")):
        return axes_along(axial)
    bars = np.array(row.vector("bars_x", "bars_y", "bars_z"))
    if np.linalg.norm(np.cross(bars, axial)) <= 1e-3 * np.linalg.norm(bars) * np.linalg.norm(axial):
        raise row.error('columns "bars_x" to "bars_z" are zero or along the direction, not across it.')
    return axes_along(axial, bars)


def _isolator(row: Row, path: Path, isolators: dict[str, Path | VendorPart]) -> str:
    """Name a row's isolator and note where it is from: beside the table, the catalogue, or a vendor's table."""
    given = row.text("isolator")
    try:
        found = find_isolator(given, beside=path.parent)
        if isinstance(found, Path):
            found = found.resolve()
        name = found.name if isinstance(found, VendorPart) else found.stem
        if name not in isolators:
            load_isolator(found)
        if any(character.isspace() for character in name):
            raise ModelError(f"{found}: the file's name holds a space, which names in a model cannot. Rename the file.")
    except (ModelError, ConvergenceError) as error:
        raise row.error(f'column "isolator": {error}') from None
    if (first := isolators.setdefault(name, found)) != found:
        raise row.error(f'column "isolator": {found} and {first} have one name. Rename one of them.')
    return name
