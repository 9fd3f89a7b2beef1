"""Fit an isolator from a vendor's data sheet.

    python -m wirerope_mj.identification.datasheet DATASHEET.toml OUT.toml

reads the vendor's figures, writes the isolator file and prints every figure beside what the fit gives. What a sheet
holds is described in `wirerope_mj.identification.vendor`; those of the catalogue lie in `models/isolators/datasheets`.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

from wirerope_mj.errors import WireRopeError
from wirerope_mj.identification import figures
from wirerope_mj.identification.shapes import HARDENING_YIELD, NiLaw, Points, Stiffnesses, fit_points, fit_stiffnesses
from wirerope_mj.identification.vendor import DataSheet, read_datasheet
from wirerope_mj.isolator import Geometry, Isolator, Limits, Provenance, Travel
from wirerope_mj.laws import Law
from wirerope_mj.units import STANDARD_GRAVITY


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


def fit_datasheet(path: str | Path) -> Isolator:
    """Return the isolator that reproduces the figures of a data sheet.

    Raises:
        ModelError: the data sheet breaks a rule.
        ConvergenceError: no law has all its figures; says by how much the nearest misses.
    """
    sheet = read_datasheet(path)
    axial, shear = _fit(sheet.compression, sheet.tension_ratio), _fit(sheet.shear, None)
    return Isolator(
        name=sheet.name,
        roll=shear,
        shear=shear,
        axial=axial,
        limits=Limits(
            static_load=sheet.static_load,
            travel=Travel(compression=sheet.compression.travel, shear=sheet.shear.travel, roll=sheet.shear.travel),
        ),
        geometry=Geometry(height=sheet.height, width=sheet.width),
        provenance=Provenance(
            kind="catalogue",
            source=sheet.source,
            fitted_to=_fitted_to(sheet),
            assumed=_assumed(sheet, shear),
            check_45=_check_45(sheet, axial, shear),
        ),
    )


def compare(path: str | Path, isolator: Isolator) -> list[Figure]:
    """Return every figure of a data sheet beside what the laws of `isolator` give, and its sags under rated load."""
    sheet = read_datasheet(path)
    if isolator.axial is None or isolator.shear is None:
        raise ValueError(f"`isolator` must have an axial and a shear law, {isolator.name} has not.")
    rows = _axis_figures("compression", sheet.compression, isolator.axial)
    ratio = figures.tension_ratio(isolator.axial, sheet.compression.travel)
    rows.append(Figure(axis="compression", name="F(+D)/|F(-D)|", unit="-", vendor=None, fitted=ratio))
    for name, relaxed in (("virgin sag", False), ("relaxed sag", True)):
        depth = figures.compression_sag(isolator.axial, sheet.static_load, sheet.compression.travel, relaxed=relaxed)
        rows.append(Figure(axis="compression", name=name, unit="mm", vendor=None, fitted=1e3 * depth))
    rows += _axis_figures("shear, roll", sheet.shear, isolator.shear)
    return rows + diagonal_figures(sheet, isolator.axial, isolator.shear)


def diagonal_figures(sheet: DataSheet, axial: Law, roll: Law) -> list[Figure]:
    """Return the figures at 45 degrees between compression and roll, which nothing was fitted to."""
    vendor = sheet.diagonal
    if vendor is None:
        return []
    if isinstance(vendor, Stiffnesses):
        tangent = figures.diagonal_stiffness(axial, roll, 0.0)
        secant = figures.diagonal_force(axial, roll, vendor.travel) / vendor.travel
        pairs = [("vibration stiffness", "N/mm", vendor.vibration / 1e3, tangent / 1e3)]
        pairs.append(("shock stiffness", "N/mm", vendor.shock / 1e3, secant / 1e3))
    else:
        mass = vendor.static_force / STANDARD_GRAVITY

        def relaxed(deflection: float) -> float:
            return figures.diagonal_force(axial, roll, deflection, relaxed=True)

        depth = figures.sag(relaxed, vendor.static_force, vendor.travel)
        frequency = figures.resonance(figures.diagonal_stiffness(axial, roll, depth), mass)
        static = figures.diagonal_force(axial, roll, vendor.static_deflection)
        shock = figures.diagonal_force(axial, roll, vendor.travel)
        pairs = [("static force", "N", vendor.static_force, static), ("shock force", "N", vendor.shock_force, shock)]
        pairs.append(("resonance", "Hz", vendor.resonance, frequency))
    return [Figure(axis="45 degrees", name=n, unit=u, vendor=v, fitted=f) for n, u, v, f in pairs]


def _fit(stated: Stiffnesses | Points, ratio: float | None) -> NiLaw:
    """Return the law of one axis."""
    return fit_stiffnesses(stated, ratio) if isinstance(stated, Stiffnesses) else fit_points(stated, ratio)


def _axis_figures(axis: str, stated: Stiffnesses | Points, law: Law) -> list[Figure]:
    """Return the figures of one axis; the negative side is compression, and symmetric laws do not mind."""
    if isinstance(stated, Stiffnesses):
        secant = figures.virgin_force(law, -stated.travel) / -stated.travel
        pairs: list[tuple[str, str, float | None, float]] = [
            ("vibration stiffness", "N/mm", stated.vibration / 1e3, figures.relaxed_stiffness(law, 0.0) / 1e3),
            ("shock stiffness", "N/mm", stated.shock / 1e3, secant / 1e3),
        ]
    else:
        depth = figures.compression_sag(law, stated.static_force, stated.travel, relaxed=True)
        tangent = figures.relaxed_stiffness(law, -depth)
        static = -figures.virgin_force(law, -stated.static_deflection)
        pairs = [
            ("static force", "N", stated.static_force, static),
            ("shock force", "N", stated.shock_force, -figures.virgin_force(law, -stated.travel)),
            ("resonance", "Hz", stated.resonance, figures.resonance(tangent, stated.static_force / STANDARD_GRAVITY)),
        ]
    pairs.append(("damping ratio at D/2", "-", None, figures.damping_ratio(law, stated.travel / 2.0)))
    return [Figure(axis=axis, name=n, unit=u, vendor=v, fitted=f) for n, u, v, f in pairs]


def _fitted_to(sheet: DataSheet) -> str:
    """Return the sentence that says what the parameters reproduce."""
    if isinstance(sheet.compression, Stiffnesses):
        return (
            "tangent at the origin = vibration stiffness; virgin secant at the rated travel (axial: in compression) = "
            f"shock stiffness; damping ratio {sheet.damping:g} of the steady loop of half the rated travel about zero"
        )
    return (
        "static and shock force on the virgin path (axial: in compression); resonance of a small vibration about the "
        "sagged, relaxed position (z = 0) under the static load of the axis"
    )


def _assumed(sheet: DataSheet, shear: Law) -> tuple[str, ...]:
    """Return what no source gives, one sentence each."""
    sentences = [
        f"axial: F(+D)/|F(-D)| = {sheet.tension_ratio:g} on the virgin paths, sets c ln b: nobody measured tension",
        "n = 1, gamma = 0 and k2 = 0 on every axis, b = e: the shape of the loop",
        "tension travel is not stated and not judged",
    ]
    if getattr(shear, "k3", 0.0) > 0.0:
        sentences.append(f"shear and roll: z yields at {HARDENING_YIELD:g} of the rated travel, 1/beta, and k3 hardens")
    if sheet.damping is not None:
        sentences.append(f"damping ratio {sheet.damping:g}: {_stated_damping(sheet)}")
    else:
        sentences.append("the width of the loop: the vendor states no damping")
    return (*sentences, *sheet.assumed)


def _stated_damping(sheet: DataSheet) -> str:
    """Return what the vendor says about damping."""
    if sheet.damping_range is None:
        return "the vendor states none"
    return "the vendor states {:g} to {:g} for the whole series".format(*sheet.damping_range)


def _check_45(sheet: DataSheet, axial: Law, roll: Law) -> dict[str, float]:
    """Return the comparison at 45 degrees as the provenance keeps it."""
    units = {"N/mm": "N_per_mm", "N": "N", "Hz": "Hz"}
    table: dict[str, float] = {}
    for row in diagonal_figures(sheet, axial, roll):
        name = row.name.replace(" ", "_")
        if row.vendor is None or row.error is None:
            continue
        table[f"{name}_vendor_{units[row.unit]}"] = float(f"{row.vendor:.6g}")
        table[f"{name}_fitted_{units[row.unit]}"] = float(f"{row.fitted:.6g}")
        table[f"{name}_relative_error"] = round(row.error, 4)
    return table


def print_table(rows: list[Figure]) -> None:
    """Print one line for each figure."""
    print(f"{'axis':<13}{'figure':<24}{'unit':<6}{'vendor':>12}{'fitted':>12}{'error':>10}")
    for row in rows:
        vendor = "" if row.vendor is None else f"{row.vendor:.6g}"
        error = "" if row.error is None else f"{round(100.0 * row.error, 2) + 0.0:+.2f} %"
        print(f"{row.axis:<13}{row.name:<24}{row.unit:<6}{vendor:>12}{row.fitted:>12.6g}{error:>10}")


def main(arguments: list[str] | None = None) -> int:
    """Fit the data sheet named on the command line; return the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m wirerope_mj.identification.datasheet",
        description="Fit an isolator from a vendor's data sheet and print every figure beside what the fit gives.",
    )
    parser.add_argument("datasheet", help="TOML file with the vendor's figures")
    parser.add_argument("out", help="isolator file to write")
    options = parser.parse_args(arguments)
    try:
        isolator = fit_datasheet(options.datasheet)
        isolator.save(options.out)
        print_table(compare(options.datasheet, isolator))
    except (WireRopeError, OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    print(f"written: {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
