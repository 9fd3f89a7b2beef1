"""Every figure of a data sheet beside what an isolator gives, by the laws' own paths."""

from dataclasses import dataclass
from pathlib import Path

from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.identification import figures
from wirerope_mj.mounts.identification.curve_fit import curve_figures
from wirerope_mj.mounts.identification.curve_sheet import read_curve_sheet
from wirerope_mj.mounts.identification.sheet import AxisFigures, DataSheet, Stated
from wirerope_mj.mounts.identification.vendor import read_datasheet
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws import Law, LoopBoucWen


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One figure: where it holds, its name and unit, what the vendor states (None: nothing) and what the law gives."""

    axis: str
    name: str
    unit: str
    vendor: float | None
    fitted: float

    @property
    def error(self) -> float | None:
        """Relative error of the fitted value; None where the vendor states nothing."""
        return None if self.vendor is None else self.fitted / self.vendor - 1.0


def compare(path: str | Path, isolator: Isolator) -> list[Figure]:
    """Return every figure of a data sheet beside what the laws of `isolator` give, and its sags under rated load."""
    content = read_toml(path, "data sheet")
    if "curve" in content:
        stated = curve_figures(read_curve_sheet(content, Path(path)), isolator)
        return [Figure(axis=a, name=n, unit=u, vendor=value, fitted=fitted) for a, n, u, value, fitted in stated]
    sheet = read_datasheet(path)
    if isolator.axial is None:
        raise ValueError(f"`isolator` must have an axial law, {isolator.name} has not.")
    rows = _axis_figures("compression", sheet.compression, isolator.axial, sheet.damping_amplitude)
    half = 0.5 * sheet.compression.travel
    ratio = figures.tension_ratio(isolator.axial, half)
    rows.append(Figure(axis="compression", name="F(+D/2)/|F(-D/2)|", unit="-", vendor=None, fitted=ratio))
    for name, relaxed in (("virgin sag", False), ("relaxed sag", True)):
        if sheet.static_load is None:
            break
        depth = figures.compression_sag(isolator.axial, sheet.static_load, sheet.compression.travel, relaxed=relaxed)
        rows.append(Figure(axis="compression", name=name, unit="mm", vendor=None, fitted=1e3 * depth))
    if sheet.shear is not None and isolator.shear is not None:
        name = "shear" if sheet.roll_of_loop else "shear, roll"
        rows += _axis_figures(name, sheet.shear, isolator.shear, sheet.damping_amplitude)
    return rows + diagonal_figures(sheet, isolator)


def diagonal_figures(sheet: DataSheet, isolator: Isolator) -> list[Figure]:
    """Return the figures at 45 degrees between compression and roll, which nothing was fitted to."""
    law = isolator.coupled
    if sheet.diagonal is None or not isinstance(law, LoopBoucWen):
        return []
    rows = []
    for stated in sheet.diagonal.stated:
        if stated.unit == "Hz":
            continue  # about a sag under a load that is not along an axis of the mount: nothing here follows that
        secant = figures.diagonal_secant(law, stated.secant.deflection, steady=stated.secant.steady)
        rows.append(_row("45 degrees", stated, secant))
    return rows


def _row(axis: str, stated: Stated, stiffness: float) -> Figure:
    """Return a figure of the sheet beside the secant stiffness [N/m] of a law."""
    vendor, fitted = stated.shown(stated.secant.stiffness), stated.shown(stiffness)
    return Figure(axis=axis, name=stated.name, unit=stated.unit, vendor=vendor, fitted=fitted)


def _axis_figures(axis: str, stated: AxisFigures, law: Law, amplitude: float) -> list[Figure]:
    """Return the figures of one axis; the negative side is compression, and symmetric laws do not mind."""
    rows = []
    for figure in stated.stated:
        about = 0.0
        if figure.unit == "Hz" and axis == "compression":
            load = figure.mass * STANDARD_GRAVITY
            about = -figures.compression_sag(law, load, stated.travel, relaxed=True)
        rows.append(_row(axis, figure, figures.secant(law, figure.secant, about)))
    for name, at in (
        (f"damping ratio at {1e3 * amplitude:.3g} mm", amplitude),
        ("damping ratio at D/2", stated.travel / 2.0),
    ):
        rows.append(Figure(axis=axis, name=name, unit="-", vendor=None, fitted=figures.damping_ratio(law, at)))
    return rows


def print_table(rows: list[Figure]) -> None:
    """Print one line for each figure."""
    print(f"{'axis':<13}{'figure':<26}{'unit':<6}{'vendor':>12}{'fitted':>12}{'error':>10}")
    for row in rows:
        vendor = "" if row.vendor is None else f"{row.vendor:.6g}"
        error = "" if row.error is None else f"{round(100.0 * row.error, 2) + 0.0:+.2f} %"
        print(f"{row.axis:<13}{row.name:<26}{row.unit:<6}{vendor:>12}{row.fitted:>12.6g}{error:>10}")
