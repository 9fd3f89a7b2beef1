"""Files of a flexible part: a folder of modes.csv, shapes.csv and points.csv, in SI."""

import csv
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wirerope_mj.engine.flexible.nastran import BULK, EXTERNAL, read_grids
from wirerope_mj.engine.flexible.part import RESIDUAL, FlexiblePart
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.atomic_files import atomic_folder
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import as_named, no_formula, short
from wirerope_mj.foundation.table_files import number_in, read_header, rows_below
from wirerope_mj.foundation.units import LENGTH_UNITS

MODES, SHAPES, POINTS = "modes.csv", "shapes.csv", "points.csv"
MODE_COLUMNS = ("mode", "frequency_Hz", "damping", "participation_x", "participation_y", "participation_z")
_SHAPES = ("point", "mode", "x", "y", "z")
_POINTS = ("point", "x_m", "y_m", "z_m")
KIND = "folder of a flexible part"
_OF_PROGRAMS = (
    f"Of a finite-element program's eigenvectors of unit modal mass the columns are {', '.join(_SHAPES)}, of its modes "
    f"{', '.join(MODE_COLUMNS)}, participation being Phi^T M r of a unit motion of the base; universal files (.unv), OP4, OP2, "
    "punch text (.pch) and .f06 are read, too."
)
MASSES = {"kg": 1.0, "t": 1e3, "g": 1e-3, "lb": 0.45359237}  # units of mass of finite-element models [kg]


def save_flexible(part: FlexiblePart, folder: str | Path, *, force: bool = False) -> None:
    """Write a part as a folder that `load_flexible` reads."""
    names = [f"{number}{RESIDUAL if residual else ''}" for number, residual in enumerate(part.residual, 1)]
    modes = [
        [name, float(f), float(d), *map(float, gamma)]
        for name, f, d, gamma in zip(names, part.frequencies, part.damping, part.participation, strict=True)
    ]
    shapes = [
        [no_formula(point), name, *map(float, row)]
        for point, shape in part.shapes.items()
        for name, row in zip(names, shape, strict=True)
    ]
    points = [[no_formula(name), *map(float, place)] for name, place in part.points.items()]
    with atomic_folder(Path(folder), force=force, kind=KIND, marks=(MODES, SHAPES, POINTS)) as temporary:
        for file, header, rows in ((MODES, MODE_COLUMNS, modes), (SHAPES, _SHAPES, shapes), (POINTS, _POINTS, points)):
            with (temporary / file).open("w", newline="", encoding="utf-8") as stream:
                csv.writer(stream, lineterminator="\n").writerows([header, *rows])


@dataclass(frozen=True, kw_only=True)
class Units:
    """Units of length and mass of a finite-element model, in SI; its second is the second."""

    length: float = 1.0
    mass: float = 1.0


def units_in(text: str) -> Units:
    """Parse "mm,t,s": the units of length, mass and time of a finite-element model; ValueError if it names others."""
    names = [name.strip() for name in text.split(",")]
    if len(names) != 3 or names[0] not in LENGTH_UNITS or names[1] not in MASSES or names[2] != "s":
        raise ValueError(
            f"`--units` are those of length, mass and time, as mm,t,s or m,kg,s, got {text!r}. Lengths: "
            f"{', '.join(LENGTH_UNITS)}; masses: {', '.join(MASSES)}; time: s."
        )
    return Units(length=LENGTH_UNITS[names[0]], mass=MASSES[names[1]])


SI = Units()


def load_flexible(path: str | Path) -> FlexiblePart:
    """Read a flexible part from a folder with modes.csv, shapes.csv and points.csv, in SI.

    modes.csv has the columns mode, frequency_Hz, damping and perhaps participation_x, participation_y, participation_z
    [sqrt(kg)], and one whose name ends in "-residual" is a residual vector; shapes.csv has point, mode, x, y, z [1/sqrt(kg)];
    points.csv point, x_m, y_m, z_m.

    Raises:
        RecordError: a file, a column or a row is missing, twice, or no number; says file and row.
    """
    folder = Path(path)
    return read_flexible(folder / MODES, folder / SHAPES, folder / POINTS)


def read_flexible(modes: Path, shapes: Path, points: Path, units: Units = SI) -> FlexiblePart:
    """Read a flexible part from tables as `load_flexible` describes them, in `units`; x_m, y_m, z_m are metres in any case.

    Shapes are normalised to a modal mass of one unit of mass, participations in its root.

    Raises:
        RecordError: as `load_flexible`.
    """
    of_modes = read_rows(modes, (MODE_COLUMNS, MODE_COLUMNS[:3]))
    places = {name: place for name, (_, _, place) in read_points(points, units).items()}
    of_shapes = read_rows(shapes, (_SHAPES,))
    numbers = [row["mode"] for _, row in of_modes]
    _require_once([(where, f"mode {row['mode']}") for where, row in of_modes])
    _require_once([(where, f"point {row['point']}, mode {row['mode']},") for where, row in of_shapes])
    values = {}
    for where, row in of_shapes:
        if row["point"] not in places:
            raise RecordError(f"{where}: point {row['point']!r} is not in {points.name}; say there where it is.")
        if row["mode"] not in numbers:
            raise RecordError(f"{where}: mode {row['mode']!r} is not in {modes.name}; say there its frequency.")
        values[row["point"], row["mode"]] = numbers_of(where, row, _SHAPES[2:]) / math.sqrt(units.mass)
    for point in places:
        if missing := [mode for mode in numbers if (point, mode) not in values]:
            raise RecordError(f"{shapes}: point {point!r} has no row for mode {missing[0]!r}.")
    figures = np.array([numbers_of(where, row, MODE_COLUMNS[1:3]) for where, row in of_modes])
    participation = [numbers_of(where, row, MODE_COLUMNS[3:]) for where, row in of_modes if MODE_COLUMNS[3] in row]
    try:
        return FlexiblePart(
            frequencies=figures[:, 0], damping=figures[:, 1], points=places,
            participation=np.reshape(participation, (-1, 3)) * math.sqrt(units.mass),
            shapes={point: np.array([values[point, mode] for mode in numbers]) for point in places},
            residual=np.array([mode.endswith(RESIDUAL) for mode in numbers]),
        )  # fmt: skip
    except ValueError as error:
        raise RecordError(f"{modes}: {error}") from None


def read_points(path: Path, units: Units, nodes: Collection[int] | None = None) -> dict[str, tuple[str, dict[str, str], Array]]:
    """Read a table of points: by name location in the file, cells and position [m]; columns node and held are optional.

    Of bulk text the points are its grid points, of `nodes` those among them, called by their numbers.
    """
    if path.suffix.lower() in (*BULK, *EXTERNAL):
        grids = read_grids(path)
        if not (kept := [grid for grid in grids if nodes is None or grid in nodes]):
            raise RecordError(f"{path}: none of its {len(grids)} grid points is a node of the eigenvectors. Is it their model?")
        return {str(grid): (str(path), {}, grids[grid] * units.length) for grid in kept}
    plain = (_POINTS, ("point", "x", "y", "z"))
    points: dict[str, tuple[str, dict[str, str], Array]] = {}
    rows = read_rows(
        path, (*plain, *((*names, "held") for names in plain), *((names[0], "node", *names[1:]) for names in plain))
    )
    _require_once([(where, f"point {row['point']}") for where, row in rows])
    for where, row in rows:
        metres = "x_m" in row
        place = numbers_of(where, row, _POINTS[1:] if metres else ("x", "y", "z"))
        points[row["point"]] = where, row, place * (1.0 if metres else units.length)
    return points


def read_rows(path: Path, headers: Sequence[tuple[str, ...]]) -> list[tuple[str, dict[str, str]]]:
    """Read the rows of a table below its header, each with its location; the columns must match one of the headers.

    A unit may stand in brackets, "x [m]" for "x_m"; the order of the columns is free.
    """
    try:
        header = read_header(path, kind="table of a flexible part", example=f'"{", ".join(headers[0])}"')
    except RecordError as error:
        raise (error if path.suffix.lower() == ".csv" else RecordError(f"{error} {_OF_PROGRAMS}")) from None
    names = [name if unit is None else f"{name}_{unit}" for name, unit in zip(header.names, header.units, strict=True)]
    if sorted(names) not in [sorted(columns) for columns in headers]:
        wanted = " or ".join(", ".join(columns) for columns in headers)
        raise RecordError(f"{header.location}: the columns must be {wanted}; got {short(', '.join(names))}. {_OF_PROGRAMS}")
    rows = []
    for _, where, cells in rows_below(header):
        row = {name: as_named(cell) for name, cell in zip(names, cells, strict=True)}
        if empty := next((name for name in ("point", "mode") if not row.get(name, "-")), ""):
            raise RecordError(f'{where}: column "{empty}" is empty.')
        rows.append((where, row))
    if not rows:
        raise RecordError(f"{path}: there is a header and no row below it.")
    return rows


def _require_once(keys: Sequence[tuple[str, str]]) -> None:
    known: set[str] = set()
    for where, key in keys:
        if key in known:
            raise RecordError(f"{where}: {short(key)} stands there twice.")
        known.add(key)


def numbers_of(where: str, row: Mapping[str, str], columns: Sequence[str]) -> Array:
    return np.array([number_in(where, column, row[column]) for column in columns])
