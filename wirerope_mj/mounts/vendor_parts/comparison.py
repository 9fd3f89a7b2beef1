"""Every value of a data sheet beside that of an isolator's laws, by their own paths."""

from pathlib import Path

from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws import Law, LoopBoucWen
from wirerope_mj.mounts.vendor_parts import law_values
from wirerope_mj.mounts.vendor_parts.curve_fit import curve_values, read_curve_sheet
from wirerope_mj.mounts.vendor_parts.sheet import AxisValues, ComparedValue, read_datasheet

DIAGONAL = "45 degrees"


def compare(path: str | Path, isolator: Isolator) -> list[ComparedValue]:
    """Return every value of a data sheet beside that of the laws of `isolator`, and its sags under rated load."""
    content = read_toml(path, "data sheet")
    if "curve" in content:
        return curve_values(read_curve_sheet(content, Path(path)), isolator)
    sheet = read_datasheet(path)
    if isolator.axial is None:
        raise ValueError(f"`isolator` must have an axial law, {isolator.name} has not.")
    rows = _axis_values("compression", sheet.compression, isolator.axial, sheet.damping_amplitude)
    half = 0.5 * sheet.compression.travel
    ratio = law_values.tension_ratio(isolator.axial, half)
    rows.append(ComparedValue(axis="compression", name="F(+D/2)/|F(-D/2)|", unit="-", vendor=None, fitted=ratio))
    for name, relaxed in (("virgin sag", False), ("relaxed sag", True)):
        if sheet.static_load is None:
            break
        depth = law_values.compression_sag(isolator.axial, sheet.static_load, sheet.compression.travel, relaxed=relaxed)
        rows.append(ComparedValue(axis="compression", name=name, unit="mm", vendor=None, fitted=1e3 * depth))
    for name, values in sheet.across.items():
        law = isolator.roll if name == "roll" else isolator.shear
        if law is not None:
            rows += _axis_values(name.replace(" and", ","), values, law, sheet.damping_amplitude)
    return rows + diagonal_values(sheet.diagonal, isolator)


def diagonal_values(stated: AxisValues | None, isolator: Isolator) -> list[ComparedValue]:
    """Return the values at 45 degrees between compression and roll, which nothing was fitted to, beside the coupled laws'."""
    law = isolator.coupled
    if stated is None or not isinstance(law, LoopBoucWen):
        return []
    # A resonance is about a sag under a load that is not along an axis of the mount: nothing here follows that.
    followed = [value for value in stated.stated if value.unit != "Hz"]
    secants = [law_values.diagonal_secant(law, one.deflection, steady=one.steady) for one in followed]
    return [value.beside(DIAGONAL, secant) for value, secant in zip(followed, secants, strict=True)]


def _axis_values(axis: str, stated: AxisValues, law: Law, amplitude: float) -> list[ComparedValue]:
    """Return the values of one axis; the negative side is compression, and symmetric laws do not mind."""
    rows = []
    for value in stated.stated:
        about = 0.0
        if value.unit == "Hz" and axis == "compression":
            load = value.mass * STANDARD_GRAVITY
            about = -law_values.compression_sag(law, load, stated.travel, relaxed=True)
        rows.append(value.beside(axis, law_values.secant(law, value, about)))
    for name, at in ((f"{1e3 * amplitude:.3g} mm", amplitude), ("D/2", stated.travel / 2.0)):
        ratio = law_values.damping_ratio(law, at)
        rows.append(ComparedValue(axis=axis, name=f"damping ratio at {name}", unit="-", vendor=None, fitted=ratio))
    return rows
