"""Files of a flexible part: a folder of modes.csv, shapes.csv and points.csv, in SI."""

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from wirerope_mj.engine.flexible.part import FlexiblePart
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.atomic_files import atomic_folder
from wirerope_mj.foundation.csv_units import number_in
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.regular_files import regular

MODES, SHAPES, POINTS = "modes.csv", "shapes.csv", "points.csv"
_MODES = ("mode", "frequency_Hz", "damping", "participation_x", "participation_y", "participation_z")
_SHAPES = ("point", "mode", "x", "y", "z")
_POINTS = ("point", "x_m", "y_m", "z_m")
KIND = "folder of a flexible part"


def save_flexible(part: FlexiblePart, folder: str | Path, *, force: bool = False) -> None:
    """Write a part as a folder that `load_flexible` reads."""
    modes = [
        [number, float(f), float(d), *map(float, gamma)]
        for number, (f, d, gamma) in enumerate(zip(part.frequencies, part.damping, part.participation, strict=True), 1)
    ]
    shapes = [
        [name, number, *map(float, row)] for name, shape in part.shapes.items() for number, row in enumerate(shape, 1)
    ]
    points = [[name, *map(float, place)] for name, place in part.points.items()]
    with atomic_folder(Path(folder), force=force, kind=KIND, marks=(MODES, SHAPES, POINTS)) as temporary:
        for file, header, rows in ((MODES, _MODES, modes), (SHAPES, _SHAPES, shapes), (POINTS, _POINTS, points)):
            with (temporary / file).open("w", newline="", encoding="utf-8") as stream:
                csv.writer(stream, lineterminator="\n").writerows([header, *rows])


def load_flexible(path: str | Path) -> FlexiblePart:
    """Read a flexible part from a folder with modes.csv, shapes.csv and points.csv, in SI.

    modes.csv has the columns mode, frequency_Hz, damping and perhaps participation_x, participation_y, participation_z
    [sqrt(kg)]; shapes.csv point, mode, x, y, z [1/sqrt(kg)]; points.csv point, x_m, y_m, z_m.

    Raises:
        RecordError: a file, a column or a row is missing, twice, or no number; says file and row.
    """
    folder = Path(path)
    modes = _rows(folder / MODES, _MODES, optional=3)
    numbers = [row["mode"] for _, row in modes]
    places = _rows(folder / POINTS, _POINTS)
    shapes = _rows(folder / SHAPES, _SHAPES)
    _require_once(folder / MODES, [(where, row["mode"]) for where, row in modes], "mode")
    _require_once(folder / POINTS, [(where, row["point"]) for where, row in places], "point")
    _require_once(folder / SHAPES, [(where, f"{row['point']}, mode {row['mode']}") for where, row in shapes], "point")
    found = {(row["point"], row["mode"]): _numbers(where, row, _SHAPES[2:]) for where, row in shapes}
    points = {row["point"]: _numbers(where, row, _POINTS[1:]) for where, row in places}
    for point, mode in found:
        if point not in points:
            raise RecordError(f"{folder / SHAPES}: point {point!r} is not in {POINTS}; say there where it is.")
        if mode not in numbers:
            raise RecordError(
                f"{folder / SHAPES}: mode {mode!r} is not in {MODES}; say there its frequency and damping."
            )
    for point in points:
        if missing := [mode for mode in numbers if (point, mode) not in found]:
            raise RecordError(f"{folder / SHAPES}: point {point!r} has no row for mode {missing[0]!r}.")
    figures = np.array([_numbers(where, row, _MODES[1:]) for where, row in modes])
    try:
        return FlexiblePart(
            frequencies=figures[:, 0], damping=figures[:, 1], participation=figures[:, 2:], points=points,
            shapes={point: np.array([found[point, mode] for mode in numbers]) for point in points},
        )  # fmt: skip
    except ValueError as error:
        raise RecordError(f"{folder}: {error}") from None


def _rows(path: Path, columns: tuple[str, ...], *, optional: int = 0) -> list[tuple[str, dict[str, str]]]:
    """Read the rows of a table below its header, each with its location; the last columns may be left out all together."""
    try:
        text = regular(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise RecordError(f"{path}: this is not text in UTF-8; save it as CSV in UTF-8.") from None
    except OSError as error:
        raise RecordError(
            f"{path}: the table cannot be read: {why_unread(error)} A flexible part is a folder with {MODES}, {SHAPES} and "
            f"{POINTS}."
        ) from None
    lines = [(number, row) for number, row in enumerate(csv.reader(text.splitlines()), 1) if any(map(str.strip, row))]
    header = [name.strip() for name in lines[0][1]] if lines else []
    allowed = (list(columns), list(columns[: len(columns) - optional]))
    if header not in allowed:
        raise RecordError(
            f"{path}, line 1: the columns must be {', '.join(columns)}, in this order; got {', '.join(header)}."
        )
    if len(lines) < 2:
        raise RecordError(f"{path}: there is a header and no row below it.")
    rows = []
    for number, cells in lines[1:]:
        if len(cells) != len(header):
            raise RecordError(f"{path}, line {number}: expected {len(header)} cells, got {len(cells)}.")
        row = dict.fromkeys(columns, "0") | {name: cell.strip() for name, cell in zip(header, cells, strict=True)}
        rows.append((f"{path}, line {number}", row))
    return rows


def _require_once(path: Path, keys: list[tuple[str, str]], what: str) -> None:
    seen: set[str] = set()
    for where, key in keys:
        if key in seen:
            raise RecordError(f"{where}: {what} {key} stands there twice.")
        seen.add(key)


def _numbers(where: str, row: Mapping[str, str], columns: tuple[str, ...]) -> Array:
    return np.array([number_in(where, column, row[column]) for column in columns])
