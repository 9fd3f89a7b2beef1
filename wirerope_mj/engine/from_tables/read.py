"""The tables of a model read and checked row by row."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from wirerope_mj.engine.flexible.panel import DAMPING
from wirerope_mj.engine.from_tables.layout import (
    Box,
    Layout,
    Mass,
    MassProperties,
    Placed,
    Point,
    Sprung,
    StopLaw,
    axes_along,
    check_places,
    why_impossible,
)
from wirerope_mj.engine.from_tables.sheet import PURE, TEXT, Row, read_cad_text, read_sheet
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError, ModelError, RecordError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.mounts.isolator import AXES, Bracket
from wirerope_mj.mounts.vendor_parts import VendorPart, find_isolator, load_isolator

_POSITION = {"name": TEXT, "x": "length", "y": "length", "z": "length"}
_DIRECTION = dict.fromkeys(("direction_x", "direction_y", "direction_z", "bars_x", "bars_y", "bars_z"), PURE)
_ANGLES = {"inclination": "angle", "azimuth": "angle"}
_MOMENTS, _PRODUCTS = ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz")
_SIZES = ("size_x", "size_y", "size_z")
_CENTRE, _CORNER = (tuple(f"{of}_{axis}" for axis in "xyz") for of in ("centre", "corner"))
# depth over which a stop closes softly unless its row says another: that of the stops of the models that ship [m]
_ROUNDING = 1e-3


def read_layout(name: str, tables: Mapping[str, Path], *, positive_products: bool = False) -> Layout:
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
        positive_products: products of inertia are +sum x y dm, as CAD programs may write them; else elements of the tensor.

    Raises:
        RecordError: a table is wrong; says file, row and column.
        ModelError: an isolator's file is wrong.
    """
    if not name or name == "deck" or not all(c.isalnum() or c in "_-." for c in name) or name.startswith("."):
        raise ValueError(
            f'names of a model and its payload must be letters, digits, "_" and "-", and not "deck"; got {short(name)!r}.'
        )
    heavy = _read_masses(tables["masses"], sign=-1.0 if positive_products else 1.0)
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


def _read_masses(path: Path, *, sign: float) -> tuple[Mass, ...]:
    if path.suffix.lower() == ".txt":
        properties = read_cad_text(path, sign=sign)
        if properties.mass <= 0.0:
            raise RecordError(f"{path}: the mass must be > 0, got {properties.mass:g} kg.")
        if why := why_impossible(properties.inertia):
            raise RecordError(f"{path}: no body has these moments of inertia: {why}.")
        return (Mass(path.stem, properties, location=str(path)),)
    needed = {"name": TEXT, "mass": "mass", **{axis: "length" for axis in "xyz"}}
    further = {
        **dict.fromkeys((*_MOMENTS, *_PRODUCTS), "inertia"), **dict.fromkeys(_SIZES, "length"),
        "frequency": "frequency", "damping": "ratio", "along": TEXT,
    }  # fmt: skip
    rows = read_sheet(path, kind="table of masses", needed=needed, further=further)
    return tuple(_mass(row, sign) for row in rows)


def _mass(row: Row, sign: float) -> Mass:
    name, mass = row.text("name"), row.number("mass")
    if mass <= 0.0:
        raise row.error(f'column "mass" of "{short(name)}" must be > 0, got {row.cells["mass"]}.')
    given = [column for column in (*_MOMENTS, *_PRODUCTS) if row.has(column)]
    missing = [column for column in _MOMENTS if column not in given]
    if given and missing:
        raise row.error(
            f'column "{missing[0]}" of "{short(name)}" is empty though "{given[0]}" is given; fill in '
            "ixx, iyy and izz, or size_x, size_y and size_z of a box, or leave all empty: then it is a point mass."
        )
    tensor = np.zeros((3, 3))
    if any(row.has(column) for column in _SIZES):
        tensor = _box(row, name, mass, given)
    elif given:
        tensor[np.diag_indices(3)] = [row.number(column) for column in _MOMENTS]
        for column, (i, j) in zip(_PRODUCTS, ((0, 1), (0, 2), (1, 2)), strict=True):
            tensor[i, j] = tensor[j, i] = sign * row.number(column, 0.0)
    if why := why_impossible(tensor):
        raise row.error(
            f'no body has the inertia in columns "ixx" to "iyz" of "{short(name)}": {why}. It is taken '
            "about the part's own centre of mass."
        )
    properties = MassProperties(mass, np.array(row.vector("x", "y", "z")), tensor)
    return Mass(name, properties, _sprung(row, name), row.location)


def _sprung(row: Row, name: str) -> Sprung | None:
    """Return how a subassembly stands in the payload; None of a mass that is part of it."""
    if not row.has("frequency"):
        if given := [column for column in ("damping", "along") if row.has(column)]:
            raise row.error(f'"{short(name)}" has a {given[0]} and no "frequency"; fill in both or none.')
        return None
    frequency, damping = row.number("frequency"), row.number("damping", DAMPING)
    axis = row.text("along") if row.has("along") else "z"
    if frequency <= 0.0 or not 0.0 <= damping < 1.0 or axis not in ("x", "y", "z"):
        raise row.error(
            f'a subassembly has a "frequency" > 0, a "damping" from 0 to below 100 % and moves "along" x, y or '
            f"z; got {frequency:g} Hz, {100.0 * damping:g} % and {short(axis)}."
        )
    if "/" in name or any(character.isspace() for character in name) or name == "deck":
        raise row.error(f'"{short(name)}" is a body of its own and needs a name without spaces and "/".')
    return Sprung(frequency, damping, axis)


def _box(row: Row, name: str, mass: float, moments: Sequence[str]) -> Array:
    """Return the tensor of inertia of a box that is filled evenly [kg m^2]."""
    if moments:
        raise row.error(f'columns "{moments[0]}" and "size_x" of "{short(name)}" both say the inertia; leave one empty.')
    sizes = np.array([row.number(column) for column in _SIZES])
    for column, size in zip(_SIZES, sizes, strict=True):
        if size < 0.0:
            raise row.error(f'column "{column}" of "{short(name)}" must be >= 0, got {row.cells[column]}.')
    return np.diag(mass / 12.0 * (sizes @ sizes - sizes**2))


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
            law = _stop_law(row)
            isolator = laws.setdefault(law, f"stop_of_table_{len(laws) + 1}")
        stops.append(Placed(name, _position(row), _axes(row), isolator, row.location, law))
    return tuple(stops)


def _stop_law(row: Row) -> StopLaw:
    gap, stiffness = row.number("gap"), row.number("stiffness")
    damping, rounding = row.number("damping", 0.0), row.number("rounding", _ROUNDING)
    for column, value, fine in (
        ("gap", gap, gap >= 0.0), ("stiffness", stiffness, stiffness > 0.0),
        ("damping", damping, damping >= 0.0), ("rounding", rounding, rounding > 0.0),
    ):  # fmt: skip
        if not fine:
            least = ">" if column in {"stiffness", "rounding"} else ">="
            raise row.error(f'column "{column}" must be {least} 0, got {value:g} in SI units.')
    return StopLaw(gap, stiffness, damping, rounding)


def _read_points(tables: Mapping[str, Path], kind: str) -> tuple[Point, ...]:
    if kind not in tables:
        return ()
    rows = read_sheet(tables[kind], kind=f"table of {kind}", needed=_POSITION, further={})
    return tuple(Point(_site_name(row), _position(row), row.location) for row in rows)


def _read_envelope(tables: Mapping[str, Path]) -> tuple[Box, ...]:
    if "envelope" not in tables:
        return ()
    places = dict.fromkeys((*_CENTRE, *_CORNER), "length")
    needed = {"name": TEXT, **dict.fromkeys(_SIZES, "length")}
    boxes = []
    for row in read_sheet(tables["envelope"], kind="table of the envelope", needed=needed, further=places):
        size = np.array(row.vector(*_SIZES))
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
