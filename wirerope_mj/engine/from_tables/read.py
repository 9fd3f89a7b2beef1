"""The tables of a model read and checked row by row; its masses perhaps from a CAD program's text."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fnmatch import filter as matching
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from wirerope_mj.engine.flexible.panel import DAMPING
from wirerope_mj.engine.from_tables.cad_list import MOMENTS, PRODUCTS, columns_of_masses, sign_of_products
from wirerope_mj.engine.from_tables.implausible import warn_of_layout, warn_of_masses, warn_of_radians
from wirerope_mj.engine.from_tables.layout import (
    ACTS,
    Box,
    Layout,
    Mass,
    MassProperties,
    Placed,
    Point,
    Sprung,
    StopLaw,
    check_places,
    why_impossible,
)
from wirerope_mj.engine.from_tables.mass_text import POSITIVE, read_mass_text
from wirerope_mj.engine.from_tables.places import ANGLES, DIRECTION, POSITION, axes_of, position_of, site_name
from wirerope_mj.engine.from_tables.sheet import PURE, TEXT, Row, read_sheet
from wirerope_mj.engine.from_tables.totals import without_totals
from wirerope_mj.engine.from_tables.urdf import read_urdf
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError, ModelError, RecordError
from wirerope_mj.foundation.faults import Faults, each
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.mounts.isolator import AXES, Bracket
from wirerope_mj.mounts.vendor_parts import VendorPart, find_isolator, load_isolator

_CENTRE, _CORNER = (tuple(f"{of}_{axis}" for axis in "xyz") for of in ("centre", "corner"))
# depth over which a stop closes softly unless its row says another: that of the stops of the models that ship [m]
_ROUNDING = 1e-3
SIZES = ("size_x", "size_y", "size_z")
_DESCRIBED = (".txt", ".urdf")  # endings of files of masses that are no tables
# of a stop of its own
_FIGURES = {
    **dict.fromkeys(("gap", "gap_up", "gap_across", "rounding"), "length"),
    "stiffness": "stiffness", "damping": "damping", "acts": TEXT, "gap_at": TEXT,
}  # fmt: skip
_BRACKETS = {f"bracket_{axis}": axis for axis in AXES}
# columns of tables with their kinds of quantities: those that must be there, and those that may
COLUMNS = {
    "mounts": (
        {**POSITION, "isolator": TEXT}, {**DIRECTION, **ANGLES, **dict.fromkeys(_BRACKETS, "stiffness")},
    ),
    "masses": (
        {"name": TEXT, "mass": "mass", **{axis: "length" for axis in "xyz"}},
        {
            **dict.fromkeys(SIZES, "length"), **dict.fromkeys((*MOMENTS, *PRODUCTS), "inertia"),
            "frequency": "frequency", "damping": "ratio", "along": TEXT,
        },
    ),
    "stops": (
        {"name": TEXT},
        {**dict.fromkeys("xyz", "length"), "mounts": TEXT, **_FIGURES, "isolator": TEXT, **DIRECTION, **ANGLES},
    ),
    "points": (POSITION, {}),
}  # fmt: skip
# and of those that no form is written of
FURTHER = {
    "forces": (POSITION, {}),
    "envelope": ({"name": TEXT, **dict.fromkeys(SIZES, "length")}, dict.fromkeys((*_CENTRE, *_CORNER), "length")),
}


def read_layout(name: str, tables: Mapping[str, Path], *, products: str = "") -> Layout:
    """Read and check the tables of a model, by their names; tables of mounts and masses are required.

    mounts: name, x, y, z, isolator, and a direction or inclination and azimuth; perhaps bracket_axial, bracket_shear,
    bracket_roll, the stiffness of what a mount is bolted to.

    masses: name, mass, x, y, z of the centre of mass and the inertia about it, or the size_x, size_y, size_z of a box that is
    filled evenly; of a subassembly that rings on its own its frequency, and perhaps damping and along, x, y or z. Or a CAD
    program's text, .txt.

    stops: name, x, y, z, direction, or mounts, at each of which one stands; and gap, stiffness, damping or an isolator; perhaps
    acts (`ACTS`), gap_up, gap_across and gap_at, "unloaded" or "installed".

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
    isolators: dict[str, Path | VendorPart] = {}
    heavy: tuple[Mass, ...] = ()
    with Faults() as faults:
        with faults.apart():
            heavy = read_masses(tables["masses"], products=products)
        with faults.apart():
            points, forces = _read_points(tables, "points"), _read_points(tables, "forces")
            envelope = _read_envelope(tables)
        placed = _read_mounts(tables["mounts"], isolators)
        stopped = _read_stops(tables["stops"], isolators, placed) if "stops" in tables else ()
    for stop in stopped:
        if stop.name in {mount.name for mount in placed}:
            raise RecordError(f'{stop.location}: a mount is called "{stop.name}" too. Give the stop another name.')
    layout = Layout(
        name=name, masses=heavy, mounts=placed, stops=stopped, points=points,
        forces=forces, envelope=envelope, isolators=isolators,
    )  # fmt: skip
    check_places(layout, tables["masses"])
    warn_of_layout(layout)
    return layout


def read_table(kind: str, path: Path) -> object:
    """Read and check one table of a model alone; stops at mounts are placed by a table of mounts beside it, if there is one."""
    if kind == "masses":
        return read_masses(path)
    if kind == "mounts":
        return _read_mounts(path, {})
    if kind == "stops":
        mounts = next(path.parent.glob("mounts.*"), None)
        return _read_stops(path, {}, _read_mounts(mounts, {}) if mounts is not None else ())
    return _read_envelope({kind: path}) if kind == "envelope" else _read_points({kind: path}, kind)


def _read_mounts(path: Path, isolators: dict[str, Path | VendorPart]) -> tuple[Placed, ...]:
    needed, further = COLUMNS["mounts"]
    rows = read_sheet(path, kind="table of mounts", needed=needed, further=further)

    def mount_of(row: Row) -> Placed:
        name = site_name(row)
        isolator = _isolator(row, path, isolators)
        stiff = {axis: row.number(column) for column, axis in _BRACKETS.items() if row.has(column)}
        try:
            bracket = Bracket(**stiff) if stiff else None
            if bracket is not None:
                replace(load_isolator(isolators[isolator]), bracket=bracket)
        except (ModelError, ValueError) as error:
            raise row.error(f'column "bracket_{next(iter(stiff))}": {error}') from None
        return Placed(name, position_of(row), axes_of(row), isolator, row.location, bracket=bracket)

    mounts = tuple(each(mount_of, rows))
    warn_of_radians(rows)
    return mounts


def _read_stops(path: Path, isolators: dict[str, Path | VendorPart], mounts: Sequence[Placed]) -> tuple[Placed, ...]:
    """Read the table of stops; those with the same law, stated by gap and stiffness, share the name of an isolator."""
    needed, further = COLUMNS["stops"]
    rows = read_sheet(path, kind="table of stops", needed=needed, further=further)
    laws: dict[tuple[StopLaw, str], str] = {}
    stops: dict[str, Placed] = {}
    for row, name, position, axes in (stop for line in rows for stop in _stop_places(line, mounts)):
        if row.has("isolator"):
            if stated := [column for column in _FIGURES if row.has(column)]:
                raise row.error(
                    f'"{short(name)}" has an isolator and a {stated[0]}; the isolator\'s file says '
                    f'all of it. Leave column "isolator" or column "{stated[0]}" empty.'
                )
            law, isolator = None, _isolator(row, path, isolators)
        else:
            law, rise = _stop_law(row), float(axes[2, 2])
            # beyond 45 degrees a stop acts more across than up or down
            least = -math.sqrt(0.5) if law.gap_across is not None else math.sqrt(0.5)
            if row.has("acts") and rise < least and law.gap != law.gap_up:
                raise row.error(
                    f'"{short(name)}" acts {row.text("acts")}, which is told from a direction that points up (within 45 '
                    f"degrees), and its own {'points down' if rise <= -math.sqrt(0.5) else 'leans more'}: make it upright, or "
                    'leave column "acts" empty; the stop then pushes the payload along its direction.'
                )
            # rest, and with it the isolator, is another at every place
            isolator = laws.setdefault((law, "" if law.rest is None else name), f"stop_of_table_{len(laws) + 1}")
        if name in stops:
            raise row.error(f'the name "{short(name)}" is given twice, first in {stops[name].location}.')
        stops[name] = Placed(name, position, axes, isolator, row.location, law)
    return tuple(stops.values())


def _stop_places(row: Row, mounts: Sequence[Placed]) -> list[tuple[Row, str, Array, Array]]:
    """Return name, position and axes of the stop of a row, or of the stops at all mounts that the row names."""
    if not row.has("mounts"):
        return [(row, site_name(row), position_of(row), axes_of(row))]
    patterns = ["*"] if row.text("mounts") == "all" else re.split(r"[,;\s]+", row.text("mounts"))
    if unknown := [short(pattern) for pattern in patterns if not matching([mount.name for mount in mounts], pattern)]:
        raise row.error(f'column "mounts" must be all, or names of mounts such as "m1, m2"; no mount is called "{unknown[0]}".')
    if where := [axis for axis in "xyz" if row.has(axis)]:
        raise row.error(f'"{short(row.text("name"))}" stands at mounts and has {where[0]}: leave one of the two columns empty.')
    turned = any(row.has(column) for column in (*DIRECTION, *ANGLES))
    return [
        (row, f"{site_name(row)}_{mount.name}", mount.position, axes_of(row) if turned else mount.axes)
        for mount in mounts if any(fnmatchcase(mount.name, pattern) for pattern in patterns)
    ]  # fmt: skip


def _stop_law(row: Row) -> StopLaw:
    """Read the law of a stop that states figures of its own; an acting gap that is not stated is taken from column "gap"."""
    acts = row.text("acts") if row.has("acts") else "down"
    gap_at = row.text("gap_at") if row.has("gap_at") else "unloaded"
    for column, word, words in (("acts", acts, tuple(ACTS)), ("gap_at", gap_at, ("unloaded", "installed"))):
        if word not in words:
            raise row.error(f'column "{column}" must be {", ".join(words[:-1])} or {words[-1]}, got "{short(word)}".')
    default = None if acts == "up" and row.has("gap_up") else row.number("gap")
    for column in ("gap", "gap_up", "gap_across"):
        if row.has(column) and column not in ACTS[acts] and not (column == "gap" and default is not None):
            raise row.error(f'"{short(row.text("name"))}" has a {column}, and acts {acts}: leave one of the two columns empty.')
    gaps = {column: row.number(column, default) for column in ACTS[acts]}
    stiffness, damping, rounding = row.number("stiffness"), row.number("damping", 0.0), row.number("rounding", _ROUNDING)
    for column, value in {**gaps, "stiffness": stiffness, "damping": damping, "rounding": rounding}.items():
        least = ">" if column in {"stiffness", "rounding"} else ">="
        if not (value > 0.0 if least == ">" else value >= 0.0):
            raise row.error(f'column "{column}" must be {least} 0, got {value:g} in SI units.')
    return StopLaw(
        gap=gaps.get("gap"), gap_up=gaps.get("gap_up"), gap_across=gaps.get("gap_across"), stiffness=stiffness,
        damping=damping, rounding=rounding, rest=(math.nan, math.nan, math.nan) if gap_at == "installed" else None,
    )  # fmt: skip


def _read_points(tables: Mapping[str, Path], kind: str) -> tuple[Point, ...]:
    if kind not in tables:
        return ()
    rows = read_sheet(tables[kind], kind=f"table of {kind}", needed=POSITION, further={})
    return tuple(Point(site_name(row), position_of(row), row.location) for row in rows)


def _read_envelope(tables: Mapping[str, Path]) -> tuple[Box, ...]:
    if "envelope" not in tables:
        return ()
    needed, further = FURTHER["envelope"]
    boxes = []
    for row in read_sheet(tables["envelope"], kind="table of the envelope", needed=needed, further=further):
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


def _isolator(row: Row, path: Path, isolators: dict[str, Path | VendorPart]) -> str:
    """Find a row's isolator and note its source: a file beside the table, the catalogue, or a vendor's table."""
    text = row.text("isolator")
    try:
        file = find_isolator(text, beside=path.parent)
        if isinstance(file, Path):
            file = file.resolve()
        name = file.name if isinstance(file, VendorPart) else file.stem
        if name not in isolators:
            load_isolator(file)
        if any(character.isspace() for character in name):
            raise ModelError(f"{file}: the file's name holds a space, which names in a model cannot. Rename the file.")
    except (ModelError, ConvergenceError) as error:
        raise row.error(f'column "isolator": {error}') from None
    if (first := isolators.setdefault(name, file)) != file:
        raise row.error(f'column "isolator": {file} and {first} have one name. Rename one of them.')
    return name


def read_masses(path: Path, *, products: str = "") -> tuple[Mass, ...]:
    """Read the masses of a table, or of a CAD program's text, .txt; `products` is the notation of products of inertia.

    Raises:
        RecordError: says file, row and column that are wrong.
    """
    if path.suffix.lower() == ".urdf" and products == POSITIVE:
        raise RecordError(f"{path}: products of inertia in URDF are elements of the tensor: leave --products positive out.")
    if path.suffix.lower() in _DESCRIBED:
        parts = read_urdf(path) if path.suffix.lower() == ".urdf" else read_mass_text(path, products=products)
        masses = tuple(Mass(name, properties, location=str(path)) for name, properties in parts)
    else:
        needed, further = COLUMNS["masses"]
        rows = read_sheet(
            path, kind="table of masses", needed=needed, further={**further, "quantity": PURE}, called=columns_of_masses
        )
        sign = sign_of_products(rows, products)
        masses = tuple(each(lambda row: _mass(row, sign), without_totals(rows)))
    warn_of_masses(masses)
    return masses


def _mass(row: Row, sign: float) -> Mass:
    """Read and check one row of a table of masses; `sign` is that of its products of inertia as elements of the tensor."""
    name, mass = row.text("name"), row.number("mass")
    if row.number("quantity", 1.0) != 1.0:
        raise row.error(
            f'"{short(name)}" is there {row.cells["quantity"]} times, and its row has one place: write a row for each, or '
            "their sum as one part, and leave the column out."
        )
    if mass <= 0.0:
        raise row.error(f'column "mass" of "{short(name)}" must be > 0, got {row.cells["mass"]}.')
    stated = [column for column in (*MOMENTS, *PRODUCTS) if row.has(column)]
    missing = [column for column in MOMENTS if column not in stated]
    if stated and missing:
        raise row.error(
            f'column "{missing[0]}" of "{short(name)}" is empty though "{stated[0]}" is given; fill in '
            "ixx, iyy and izz, or size_x, size_y and size_z of a box, or leave all empty: then it is a point mass."
        )
    tensor = np.zeros((3, 3))
    if any(row.has(column) for column in SIZES):  # a box that is filled evenly
        if stated:
            raise row.error(f'columns "{stated[0]}" and "size_x" of "{short(name)}" both say the inertia; leave one empty.')
        sizes = np.array([row.number(column) for column in SIZES])
        for column, size in zip(SIZES, sizes, strict=True):
            if size < 0.0:
                raise row.error(f'column "{column}" of "{short(name)}" must be >= 0, got {row.cells[column]}.')
        tensor = np.diag(mass / 12.0 * (sizes @ sizes - sizes**2))
    elif stated:
        tensor[np.diag_indices(3)] = [row.number(column) for column in MOMENTS]
        for column, (i, j) in zip(PRODUCTS, ((0, 1), (0, 2), (1, 2)), strict=True):
            tensor[i, j] = tensor[j, i] = sign * row.number(column, 0.0)
    if why := why_impossible(tensor):
        raise row.error(
            f'no body has the inertia in columns "ixx" to "iyz" of "{short(name)}": {why}. It is taken '
            "about the part's own centre of mass."
        )
    properties = MassProperties(mass, np.array(row.vector("x", "y", "z")), tensor)
    return Mass(name, properties, _sprung(row, name), row.location)


def _sprung(row: Row, name: str) -> Sprung | None:
    """Read the spring of a subassembly; None for a mass that is rigidly part of the payload."""
    if not row.has("frequency"):
        if stated := [column for column in ("damping", "along") if row.has(column)]:
            raise row.error(f'"{short(name)}" has a {stated[0]} and no "frequency"; fill in both or none.')
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
