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
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, in_si
from wirerope_mj.mounts.isolator.curves import read_curve
from wirerope_mj.mounts.vendor_parts.toml_table import FORCE, LENGTH, Pairs, TomlTable

KINDS = ("static", "shock")
_SIDES = ("compression", "tension", "shear", "roll")  # Kinds of curves, and the tables of a sheet


@dataclass(frozen=True, kw_only=True)
class Side:
    """Values of one direction, in SI units and positive: curves from (0, 0), areas, damping ratios, travel."""

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
    table = TomlTable(content, f"{path}:")
    curve = table.text("curve")
    if curve not in KINDS:
        raise ModelError(f"{path}: `curve` must be one of {', '.join(KINDS)}, got {curve!r}.")
    sides = {
        name: _side(TomlTable(table.entries.pop(name), f"{path}: [{name}]"), path.parent)
        for name in _SIDES
        if name in table.entries
    }
    for name, side in sides.items():
        if curve not in side.curves:
            raise ModelError(
                f"{path}: [{name}] states no {curve} curve, which `curve` asks for: `{curve}_mm_N` is missing."
            )
    if not {"compression", "shear", "roll"} & set(sides):
        raise ModelError(f"{path}: a table of curves is missing: [compression], [shear] or [roll].")
    if "tension" in sides and ("compression" not in sides or sides["tension"].areas or sides["tension"].damping):
        raise ModelError(f"{path}: [tension] goes with [compression], where areas and damping ratios stand.")
    sheet = CurveSheet(
        name=table.text("name"),
        source=table.text("source"),
        curve=curve,
        sides=sides,
        yield_deflection=table.optional_quantity("yield_deflection", LENGTH) or 0.0,
        static_load=table.optional_quantity("static_load", FORCE),
        height=table.optional_quantity("height", LENGTH),
        width=table.optional_quantity("width", LENGTH),
        assumed=table.texts("assumed"),
    )
    table.require_empty()
    return sheet


def _side(table: TomlTable, folder: Path) -> Side:
    curves = {kind: points for kind in KINDS if (points := _points(table, kind, folder))}
    areas = _scaled(table.pairs("areas_mm_J"), 1e-3, 1.0)
    damping = _scaled(table.pairs("damping_mm"), 1e-3, 1.0)
    if areas and damping:
        raise ModelError(f"{table.location} give `areas_mm_J` or `damping_mm`, not both.")
    travel = table.optional_quantity("travel", LENGTH)
    table.require_empty()
    return Side(curves=curves, areas=areas, damping=damping, travel=travel)


def _points(table: TomlTable, kind: str, folder: Path) -> Pairs:
    """Take the points of one curve, in SI units."""
    if kind not in table.entries:
        for length in LENGTH:
            for force in FORCE:
                if rows := table.pairs(f"{kind}_{length}_{force}"):
                    return _scaled(rows, LENGTH_UNITS[length], FORCE_UNITS[force])
        return []
    location = f"{table.location} `{kind}`"
    if not isinstance(file := table.entries.pop(kind), str):
        raise ModelError(f"{location} is the name of a CSV file; points have their units in their key, `{kind}_mm_N`.")
    try:
        columns = read_curve(folder / file)
    except RecordError as error:
        raise ModelError(f"{location}: {error}") from None
    if set(columns) != {"deflection", "force"}:
        raise ModelError(f"{location}: {file} must have the columns deflection and force.")
    rows = [row for row in zip(columns["deflection"], columns["force"], strict=True) if row != (0.0, 0.0)]
    if any(min(row) <= 0.0 for row in rows):
        raise ModelError(
            f"{location}: {file}: points must be > 0, those of compression too: the table names the direction."
        )
    return rows


def _scaled(rows: Pairs, first: float, second: float) -> Pairs:
    return [(in_si(x, first), in_si(y, second)) for x, y in rows]
