"""Data sheets of vendors that state force-deflection curves: a static one, a shock one, or both, to each axis.

A sheet that has the key `curve` is one of these: `curve = "shock"` says which of its curves the laws follow, the other is
compared. It has the tables [compression], [tension], [shear] and [roll] that the vendor states, all numbers > 0:

    static_mm_N, shock_mm_daN    [[deflection, force], ...] from rest, without the point (0, 0); or static, shock = "points.csv"
    areas_mm_J                   [[amplitude, area], ...] of closed cycles about zero; or
    damping_mm                   [[amplitude, damping ratio], ...]; neither: no hysteresis
    travel_mm                    rated; the end of the curve by default

and beside them `name`, `source`, `yield_deflection_mm` (where there is hysteresis), and if they are stated `height_mm`,
`width_mm`, `static_load_N`, `assumed`. Without [tension] the curve of compression is mirrored, without [roll] that of shear is
taken.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS
from wirerope_mj.mounts.identification.vendor import FORCE, LENGTH, Reader
from wirerope_mj.mounts.isolator.curves import read_curve

KINDS = ("static", "shock")
_SIDES = ("compression", "tension", "shear", "roll")
"""Kinds of curves, and the tables of a sheet."""

Pairs = list[tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class Side:
    """What a sheet states of one direction, in SI units and positive: curves from (0, 0), areas, damping ratios, travel."""

    curves: Mapping[str, Pairs]
    areas: Pairs
    damping: Pairs
    travel: float | None


@dataclass(frozen=True, kw_only=True)
class CurveSheet:
    """A vendor's curves, in SI units; `curve` is the kind that the laws follow."""

    name: str
    source: str
    curve: str
    sides: Mapping[str, Side]
    yield_deflection: float
    static_load: float | None
    height: float | None
    width: float | None
    assumed: tuple[str, ...]


def read_curve_sheet(content: Mapping[str, Any], path: Path) -> CurveSheet:
    """Return the sheet of a file's content; ModelError names file, table, key and rule."""
    read, table, place = Reader(str(path)), dict(content), f"{path}:"
    curve = read.text(table, "curve", place)
    if curve not in KINDS:
        raise ModelError(f"{place} `curve` must be one of {', '.join(KINDS)}, got {curve!r}.")
    sides = {name: _side(read, table.pop(name), f"{path}: [{name}]", path.parent) for name in _SIDES if name in table}
    for name, side in sides.items():
        if curve not in side.curves:
            raise ModelError(
                f"{path}: [{name}] states no {curve} curve, which `curve` asks for: `{curve}_mm_N` is missing."
            )
    if not {"compression", "shear", "roll"} & set(sides):
        raise ModelError(f"{place} a table of curves is missing: [compression], [shear] or [roll].")
    if "tension" in sides and ("compression" not in sides or sides["tension"].areas or sides["tension"].damping):
        raise ModelError(f"{path}: [tension] goes with [compression], where areas and damping ratios stand.")
    sheet = CurveSheet(
        name=read.text(table, "name", place),
        source=read.text(table, "source", place),
        curve=curve,
        sides=sides,
        yield_deflection=read.optional(table, "yield_deflection", LENGTH, place) or 0.0,
        static_load=read.optional(table, "static_load", FORCE, place),
        height=read.optional(table, "height", LENGTH, place),
        width=read.optional(table, "width", LENGTH, place),
        assumed=read.sentences(table, "assumed", place),
    )
    read.require_empty(table, place)
    return sheet


def _side(read: Reader, content: Any, place: str, folder: Path) -> Side:
    """Return one table of a sheet."""
    if not isinstance(content, dict):
        raise ModelError(f"{place} must be a table, got {content!r}.")
    table = dict(content)
    curves = {kind: points for kind in KINDS if (points := _points(read, table, kind, place, folder))}
    areas = _in_si(read.pairs(table, "areas_mm_J", place), 1e-3, 1.0)
    damping = _in_si(read.pairs(table, "damping_mm", place), 1e-3, 1.0)
    if areas and damping:
        raise ModelError(f"{place} give `areas_mm_J` or `damping_mm`, not both.")
    travel = read.optional(table, "travel", LENGTH, place)
    read.require_empty(table, place)
    return Side(curves=curves, areas=areas, damping=damping, travel=travel)


def _points(read: Reader, table: dict[str, Any], kind: str, place: str, folder: Path) -> Pairs:
    """Take the points of one curve out of the table, in SI units."""
    if kind in table:
        if not isinstance(file := table.pop(kind), str):
            raise ModelError(
                f"{place} `{kind}` is the name of a CSV file; points have their units in their key, `{kind}_mm_N`."
            )
        try:
            columns = read_curve(folder / file)
        except RecordError as error:
            raise ModelError(f"{place} `{kind}`: {error}") from None
        if set(columns) != {"deflection", "force"}:
            raise ModelError(f"{place} `{kind}`: {file} must have the columns deflection and force.")
        rows = list(zip(columns["deflection"], columns["force"], strict=True))
        rows = [row for row in rows if row != (0.0, 0.0)]
        if any(min(row) <= 0.0 for row in rows):
            raise ModelError(
                f"{place} `{kind}`: {file}: points must be > 0, those of compression too: the table names the direction."
            )
        return rows
    for length in LENGTH:
        for force in FORCE:
            if f"{kind}_{length}_{force}" in table:
                rows = read.pairs(table, f"{kind}_{length}_{force}", place)
                return _in_si(rows, LENGTH_UNITS[length], FORCE_UNITS[force])
    return []


def _in_si(rows: Pairs, first: float, second: float) -> Pairs:
    """Return pairs times what their units are in SI; 6.8 mm are 0.0068 m, not 0.006799999999999999 m."""
    return [(float(f"{x * first:.12g}"), float(f"{y * second:.12g}")) for x, y in rows]
