"""A vendor's values beside those of an isolator's laws, on the same paths, and each value predicted from the others.

The latter is the band of error of an isolator that was fitted to all of them. An axis to which three values or more are fitted
has its law fitted without one of them, and that law's value stands beside the vendor's. Two values fix friction and spring, and
without one of them the other parts of the vendor's table must say how both belong together: the median of their ratios. Values
at 45 degrees are in no fit.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from statistics import median

import numpy as np

from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws import Law
from wirerope_mj.mounts.vendor_parts.by_name import shipped_file
from wirerope_mj.mounts.vendor_parts.curve_fit import curve_values, read_curve_sheet
from wirerope_mj.mounts.vendor_parts.law_values import compression_sag, damping_ratio, secant, virgin_force
from wirerope_mj.mounts.vendor_parts.parts import VendorPart, vendor_parts
from wirerope_mj.mounts.vendor_parts.sheet import AxisValues, ComparedValue, DataSheet, read_datasheet
from wirerope_mj.mounts.vendor_parts.sheet_fit import DIAGONAL, axis_of, diagonal_values, fit_sheet

AXES = ("compression", "shear")


def compare(path: str | Path, isolator: Isolator) -> list[ComparedValue]:
    """Return every value of a data sheet beside the value of the isolator's laws, and its sags under rated load."""
    content = read_toml(path, "data sheet")
    if "curve" in content:
        return curve_values(read_curve_sheet(content, Path(path)), isolator)
    sheet = read_datasheet(path)
    if isolator.axial is None:
        raise ValueError(f"`isolator` must have an axial law, {isolator.name} has not.")
    rows = _axis_values("compression", sheet.compression, isolator.axial, sheet.damping_amplitude)
    half = 0.5 * sheet.compression.travel
    ratio = virgin_force(isolator.axial, half) / abs(virgin_force(isolator.axial, -half))
    rows.append(ComparedValue(axis="compression", name="F(+D/2)/|F(-D/2)|", unit="-", vendor=None, fitted=ratio))
    for name, relaxed in (("virgin sag", False), ("relaxed sag", True)):
        if sheet.static_load is None:
            break
        depth = compression_sag(isolator.axial, sheet.static_load, sheet.compression.travel, relaxed=relaxed)
        rows.append(ComparedValue(axis="compression", name=name, unit="mm", vendor=None, fitted=1e3 * depth))
    for name, values in sheet.across.items():
        law = isolator.roll if name == "roll" else isolator.shear
        if law is not None:
            rows += _axis_values(name.replace(" and", ","), values, law, sheet.damping_amplitude)
    return rows + diagonal_values(sheet.diagonal, isolator)


def _axis_values(axis: str, stated: AxisValues, law: Law, amplitude: float) -> list[ComparedValue]:
    """Compare the values of one axis with its law; the negative side is compression."""
    rows = []
    for value in stated.stated:
        about = 0.0
        if value.unit == "Hz" and axis == "compression":
            load = value.mass * STANDARD_GRAVITY
            about = -compression_sag(law, load, stated.travel, relaxed=True)
        rows.append(value.beside(axis, secant(law, value, about)))
    for name, at in ((f"{1e3 * amplitude:.3g} mm", amplitude), ("D/2", stated.travel / 2.0)):
        ratio = damping_ratio(law, at)
        rows.append(ComparedValue(axis=axis, name=f"damping ratio at {name}", unit="-", vendor=None, fitted=ratio))
    return rows


@dataclass(frozen=True, kw_only=True)
class Band:
    """Values that were left out, and their predictions from the other values."""

    values: tuple[ComparedValue, ...]  # those of the isolator, `fitted` predicted without `vendor`
    # by axis, the error of which nine in ten parts of the vendor's table stay below when one of their two stiffnesses is left
    # out [-]; NaN where the table states too few
    others: dict[str, float]

    @property
    def largest(self) -> float:
        """Largest error in size [-]; NaN if nothing could be left out."""
        return max((abs(row.error) for row in self.values if row.error is not None), default=math.nan)


def left_out(name: str, isolator: Isolator) -> Band:
    """Predict each value of a part from its others, by the name of its file in the catalogue or in a vendor's table."""
    path = catalogue_folder() / "datasheets" / f"{name}.toml"
    part = next((part for part in vendor_parts() if name.lower() in (part.name.lower(), shipped_file(part))), None)
    values: list[ComparedValue] = []
    if path.is_file():
        sheet = read_datasheet(path)
        values += [row for axis in AXES for row in _predict_without(sheet, axis)]
        values += [row for row in compare(path, isolator) if row.axis == DIAGONAL and row.error is not None]
    if part is not None:
        known = {row.axis for row in values}
        values += [row for axis in AXES if axis not in known for row in _predict_by_ratio(part, axis)]
        values += [] if DIAGONAL in known else diagonal_values(axis_of(part, "45"), isolator)
    other_errors = {} if part is None else {axis: _error_quantile(part.series.file, axis) for axis in AXES}
    return Band(values=tuple(values), others=other_errors)


def _predict_without(sheet: DataSheet, axis: str) -> list[ComparedValue]:
    """Predict each fitted value of an axis by the law fitted without that value; empty if the axis has only two."""
    stated: AxisValues | None = getattr(sheet, axis)
    if stated is None or len(stated.fitted) < 3:
        return []
    rows = []
    for value in stated.stated:
        if not value.fitted:
            continue
        without = replace(stated, compared=(*stated.compared, value.key))
        along = axis == AXES[0]
        fitted = fit_sheet(replace(sheet, compression=without) if along else replace(sheet, shear=without))
        law = fitted.axial if along else fitted.shear
        assert law is not None  # of an axis with values
        rows.append(value.beside(axis, secant(law, value)))
    return rows


def _predict_by_ratio(part: VendorPart, axis: str) -> list[ComparedValue]:
    """Predict both stiffnesses of an axis from each other by the median ratio of the table's other parts."""
    stated = part.modes[axis]
    if stated.vibration is None or stated.shock is None or stated.vibration == stated.shock:  # one number, printed twice
        return []
    ratio = median(_ratios(part.series.file, axis, part.name))
    return [
        ComparedValue(axis=axis, name=name, unit="N/mm", vendor=1e-3 * vendor, fitted=1e-3 * computed)
        for name, vendor, computed in (
            ("vibration stiffness", stated.vibration, stated.shock / ratio),
            ("shock stiffness", stated.shock, stated.vibration * ratio),
        )
    ]


def _ratios(file: str, axis: str, without: str = "") -> list[float]:
    """Return shock over vibration stiffness of a table's parts that state both, without one part."""
    modes = [part.modes[axis] for part in vendor_parts() if part.series.file == file and part.name != without]
    both = [(mode.shock, mode.vibration) for mode in modes if mode.shock is not None and mode.vibration is not None]
    return [shock / vibration for shock, vibration in both if shock != vibration]


@cache
def _error_quantile(file: str, axis: str) -> float:
    """Return the error [-] that 90 % of a table's parts stay below if shock over vibration stiffness is the others' median."""
    ratios = np.array(_ratios(file, axis))
    if len(ratios) < 2:
        return math.nan
    errors = [abs(np.median(np.delete(ratios, number)) / ratio - 1.0) for number, ratio in enumerate(ratios)]
    return float(np.quantile(errors, 0.9))
