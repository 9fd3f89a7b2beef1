"""Data sheets of vendors that state force-deflection curves, static ones or shock ones or both, and isolators that follow them.

A sheet that has the key `curve` is one of these. What its keys mean stands at the fields of `CurveSheet` and `Side`.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal, cast

import numpy as np

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ConvergenceError, ModelError, RecordError
from wirerope_mj.foundation.structure import In, Key, Place, structure
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS
from wirerope_mj.mounts.isolator import Geometry, Isolator, Limits, Provenance, Travel
from wirerope_mj.mounts.isolator.tables import read_curve
from wirerope_mj.mounts.laws import Tabulated
from wirerope_mj.mounts.test_rig import cyclic_test
from wirerope_mj.mounts.vendor_parts import law_values
from wirerope_mj.mounts.vendor_parts.sheet import ComparedValue, Force, Length, Pairs

KINDS = ("static", "shock")
_FAR = 20.0  # times that a rated travel may be longer or shorter than its curve: inches are 25.4 mm
_SIDES = ("compression", "tension", "shear", "roll")  # Kinds of curves, and the tables of a sheet


Curve = Annotated[Pairs, In({
    f"{length}_{force}": (LENGTH_UNITS[length], FORCE_UNITS[force]) for length in ("mm", "in") for force in ("N", "daN", "kN")
})]  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Side:
    """Curves of one direction, and the hysteresis along it; neither areas nor damping ratios: none."""

    static: Curve = ()  #: [[deflection, force], ...] from rest, without the point (0, 0)
    static_file: Annotated[str, Key("static")] | None = None  #: name of a CSV file of such points beside the sheet
    shock: Curve = ()  #: as `static`
    shock_file: Annotated[str, Key("shock")] | None = None
    areas: Annotated[Pairs, In({"mm_J": (1e-3, 1.0)})] = ()  #: [[amplitude, area], ...] of closed cycles about zero
    damping: Annotated[Pairs, In({"mm": (1e-3, 1.0)})] = ()  #: [[amplitude, damping ratio], ...]
    travel: Length | None = None  #: rated; the end of the curve by default

    @property
    def curves(self) -> dict[str, Pairs]:
        return {kind: points for kind in KINDS if (points := getattr(self, kind))}

    def __post_init__(self) -> None:
        if self.areas and self.damping:
            raise ValueError("give `areas_mm_J` or `damping_mm`, not both.")
        end = max((points[-1][0] for points in self.curves.values()), default=self.travel)
        if self.travel and end and not 1.0 / _FAR < self.travel / end < _FAR:
            ends = f"`travel` is {1e3 * self.travel:.6g} mm and the curve ends at {1e3 * end:.6g} mm"
            raise ValueError(f"{ends}; is its unit another?")


@dataclass(frozen=True, kw_only=True)
class CurveSheet:
    """A vendor's force-deflection curves of one isolator."""

    curve: Literal["static", "shock"]  #: which of the curves the laws follow; the other is compared
    name: str
    source: str
    compression: Side | None = None
    tension: Side | None = None  #: absent: the curve of compression, mirrored
    shear: Side | None = None
    roll: Side | None = None  #: absent: the curve of shear
    yield_deflection: Length = 0.0  #: where there is hysteresis
    static_load: Force | None = None
    height: Length | None = None
    width: Length | None = None
    assumed: tuple[str, ...] = ()

    @property
    def sides(self) -> dict[str, Side]:
        return {name: side for name in _SIDES if (side := getattr(self, name)) is not None}

    def __post_init__(self) -> None:
        if not {"compression", "shear", "roll"} & set(self.sides):
            raise ValueError("a table of curves is missing: [compression], [shear] or [roll].")
        for name, side in self.sides.items():
            if self.curve not in side.curves:
                kind = self.curve
                raise ValueError(f"[{name}] states no {kind} curve, which `curve` asks for: `{kind}_mm_N` is missing.")
        if self.tension and (not self.compression or self.tension.areas or self.tension.damping):
            raise ValueError("[tension] goes with [compression], where areas and damping ratios stand.")


def read_curve_sheet(content: Entries, path: Path) -> CurveSheet:
    """Read a curve sheet from a file's content; ModelError names file, line, table, key and rule."""
    return structure(CurveSheet, content, Place(path), {Side: _side})


def _side(table: Entries, place: Place) -> Side:
    """Return the curves of one side from its table, read from CSV files where it names them."""
    side = structure(Side, table, place)
    for kind in KINDS:
        if file := getattr(side, f"{kind}_file"):
            try:
                columns = read_curve(place.folder / file)
            except RecordError as error:
                raise place.fault(f"`{kind}`: {error}") from None
            if set(columns) != {"deflection", "force"}:
                raise place.fault(f"`{kind}`: {file} must have the columns deflection and force.")
            rows = tuple(row for row in zip(columns["deflection"], columns["force"], strict=True) if row != (0.0, 0.0))
            if any(min(row) <= 0.0 for row in rows):
                raise place.fault(
                    f"`{kind}`: {file}: points must be > 0, those of compression too: the table names the direction."
                )
            read: Entries = {kind: rows, f"{kind}_file": None}
            side = replace(side, **read)
    return side


# Of the deflections of a table along its axis.
_SIGNS = {"compression": -1.0, "tension": 1.0, "shear": 1.0, "roll": 1.0}
_CLOSE = 1e-10  # Relative error of a damping ratio at which the search for its area ends


def fit_curves(content: Entries, path: Path) -> Isolator:
    """Return the isolator whose laws follow the chosen curves of a sheet; ModelError names file, table and rule."""
    sheet = read_curve_sheet(content, path)
    sides, assumed = sheet.sides, list(sheet.assumed)
    laws: Entries = {}
    for axis, name in (("axial", "compression"), ("shear", "shear"), ("roll", "roll")):
        if name == "roll" and name not in sides and "shear" in sides:
            laws["roll"] = laws["shear"]
            assumed.append("roll: the curve of shear; the sheet has none")
        if name not in sides:
            continue
        try:
            laws[axis] = _law(sheet, sides[name], sides.get("tension") if axis == "axial" else None)
        except (ConvergenceError, ValueError) as error:
            raise ModelError(f"{path}: [{name}] {error}") from None
        if not (sides[name].areas or sides[name].damping):
            assumed.append(f"{axis}: no hysteresis; the sheet states neither areas nor damping")
    if "compression" in sides and "tension" not in sides:
        assumed.append("axial: tension mirrors the curve of compression, and its travel is not judged")
    rated = {name: side.travel or side.curves[sheet.curve][-1][0] for name, side in sides.items()}
    if "shear" in rated:
        rated.setdefault("roll", rated["shear"])
    fitted = []
    for name, side in sheet.sides.items():
        end, force = side.curves[sheet.curve][-1]
        text = f"{name}: the {sheet.curve} curve, {force:.5g} N at its end, {1e3 * end:.4g} mm"
        text += "".join(f", area {area:.5g} J at {1e3 * a:.4g} mm" for a, area in side.areas)
        text += "".join(f", damping ratio {zeta:.4g} at {1e3 * a:.4g} mm" for a, zeta in side.damping)
        fitted.append(text)
    provenance = Provenance(kind="catalogue", source=sheet.source, fitted_to="; ".join(fitted), assumed=tuple(assumed))
    try:
        isolator = Isolator(
            name=sheet.name, limits=Limits(static_load=sheet.static_load, travel=Travel(**rated)),
            geometry=Geometry(height=sheet.height, width=sheet.width) if sheet.height or sheet.width else None,
            provenance=provenance, **laws,
        )  # fmt: skip
    except ValueError as error:
        raise ModelError(f"{path}: {error}") from None
    other_kind = next(kind for kind in KINDS if kind != sheet.curve)
    other_values = [row for row in curve_values(sheet, isolator) if row.name.startswith(other_kind)]
    rows = [f"{row.axis} {row.name} {row.vendor:.5g} N, here {row.fitted:.5g} N" for row in other_values]
    fitted_to = provenance.fitted_to + (f". Not fitted: {'; '.join(rows)}" if rows else "")
    return replace(isolator, provenance=replace(provenance, fitted_to=fitted_to))


def curve_values(sheet: CurveSheet, isolator: Isolator) -> list[ComparedValue]:
    """Compare every point, area and damping ratio of the sheet with the law."""
    rows = []

    def add(name: str, text: str, unit: str, stated: float, fitted: float) -> None:
        rows.append(ComparedValue(axis=name, name=text, unit=unit, vendor=stated, fitted=fitted))

    for name, side in sheet.sides.items():
        # the laws that `fit_curves` made of the sheet
        law, sign = cast("Tabulated", isolator.axes["axial" if name in ("compression", "tension") else name]), _SIGNS[name]
        for kind, points in side.curves.items():
            for x, force in points:
                if x <= law.travel_ends[int(sign > 0.0)]:
                    fitted = sign * law_values.virgin_force(law, sign * x)
                    add(name, f"{kind} force at {1e3 * x:.4g} mm", "N", force, fitted)
        for a, area in side.areas:
            add(name, f"area at {1e3 * a:.4g} mm", "J", area, cyclic_test(law, a)[0].dissipated_energy)
        for a, ratio in side.damping:
            add(name, f"damping ratio at {1e3 * a:.4g} mm", "-", ratio, law_values.damping_ratio(law, a))
    return rows


def _law(sheet: CurveSheet, side: Side, tension: Side | None) -> Tabulated:
    """Return the law of one axis; without a side of `tension` it is mirrored."""
    points = [(0.0, 0.0), *side.curves[sheet.curve]]
    if tension is not None:
        points = [(-x, -f) for x, f in points[:0:-1]] + [(0.0, 0.0), *tension.curves[sheet.curve]]
    deflection, force = ([row[column] for row in points] for column in (0, 1))
    values: Entries = {"deflection": deflection, "force": force, "symmetric": tension is None}
    stated = np.array(side.areas or side.damping).reshape(-1, 2).T
    law = Tabulated(**values)
    if not stated.size:
        return law
    if stated[0].max() > law.finite_travel:
        raise ValueError(
            f"areas and damping ratios are of cycles about zero; one of {1e3 * stated[0].max():.4g} mm leads beyond the end of "
            f"the curve, {1e3 * law.finite_travel:.4g} mm."
        )
    values |= {"amplitudes": stated[0], "yield_deflection": sheet.yield_deflection}
    if side.areas:
        return Tabulated(**values, areas=stated[1])
    # 2 pi zeta K A^2 with the curve's secant, corrected by what cycles of the law measure.
    ranges = [float(np.ptp(law.trace([0.0, a, -a]).force[1:])) for a, _ in side.damping]
    areas = [2.0 * np.pi * zeta * 0.5 * size * a for (a, zeta), size in zip(side.damping, ranges, strict=True)]
    for _ in range(50):
        law = Tabulated(**values, areas=areas)
        ratios = [zeta / law_values.damping_ratio(law, a) for a, zeta in side.damping]
        if max(abs(ratio - 1.0) for ratio in ratios) < _CLOSE:
            return replace(law, areas=tuple(float(f"{area:.12g}") for area in areas))
        areas = [area * ratio for area, ratio in zip(areas, ratios, strict=True)]
    raise ConvergenceError(f"no areas give the damping ratios {[zeta for _, zeta in side.damping]} with this curve.")
