"""`wirerope isolators`: the catalogue as a table, and one isolator with its loops."""

import math
from pathlib import Path
from typing import Any

from rich.markup import escape

from wirerope_mj.cli.screen import console, print_table
from wirerope_mj.foundation.atomic_files import check_writable
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.foundation.tables import Cell, Column, Table
from wirerope_mj.mounts.isolator import AXES, Isolator
from wirerope_mj.mounts.laws import Law, Parallel
from wirerope_mj.mounts.laws.stop import largest_gap
from wirerope_mj.mounts.test_rig import cyclic_test
from wirerope_mj.mounts.vendor_parts import find_isolator, load_isolator, shipped_file, vendor_parts
from wirerope_mj.mounts.vendor_parts.comparison import compare
from wirerope_mj.mounts.vendor_parts.left_out import Band, left_out
from wirerope_mj.mounts.vendor_parts.parts import VendorPart
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet

_FRACTIONS = (0.25, 0.5, 1.0)
_FREQUENCY = 5.0
"""Of the tests [Hz], table and picture alike; without effect on a rate-independent law."""

_UNRATED = 0.002
"""Deflection at which an axis without rated travel is measured [m]: small for every mount."""


def print_isolators() -> None:
    """Print the ratings of the isolators of the catalogue."""
    rows = []
    for path in sorted(catalogue_folder().glob("*.toml")):
        isolator = load_isolator(path)
        limits, travel = isolator.limits, isolator.limits.travel
        height = isolator.geometry.height if isolator.geometry is not None else None
        rated = [limits.static_load, travel.compression, travel.tension, travel.shear, travel.roll]
        rows.append([path.stem, isolator.name, height, *rated, isolator.provenance.kind])
    columns = [
        Column("isolator", align="left"),
        Column("name", align="text"),
        Column("height", "mm", ".4g"),
        Column("load", "N", ".4g"),
        *(Column(name, "mm", ".4g") for name in ("compr.", "tension", "shear", "roll")),
        Column("kind", align="left"),
    ]
    note = (
        "- not rated: not judged. `wirerope isolators NAME` shows one, `--all` the "
        f"{len(vendor_parts())} parts of the vendors' tables, which every command takes by name as well."
    )
    print_table(Table(title="", columns=columns, rows=rows, note=note))


def print_parts() -> None:
    """Print the parts of the vendors' tables as the vendors state them, and where each one's isolator is from."""
    columns = [
        Column("part", align="left"),
        *(Column(name, "mm", ".4g") for name in ("height", "width", "rope")),
        Column("load", "N", ".4g"),
        *(Column(name, "mm", ".4g") for name in ("compr.", "shear")),
        *(Column(f"{name} stiffness", "N/mm", ".4g") for name in ("vibration", "shock")),
        Column("isolator", align="text"),
    ]
    rows: list[list[Cell]] = []
    for part in vendor_parts():
        along, across = part.modes["compression"], part.modes["shear"]
        whole = None not in (part.height, part.width, part.rope, along.travel, along.vibration, along.shock)
        made = shipped_file(part) or ("fitted from this row" if whole else "too little stated")
        sizes = [part.height, part.width, part.rope, along.static_load, along.travel, across.travel]
        rows.append([part.name, *sizes, along.vibration, along.shock, made])
    note = "- not stated. Load, stiffnesses: in compression. `wirerope isolators PART` says what is fitted and what assumed."
    print_table(Table(title="", columns=columns, rows=rows, note=note))


def print_isolator(name: str, out: Path | None) -> None:
    """Print parameters of an isolator and measures of its steady loops; write their picture to `out` if it is given."""
    if out is not None:
        check_picture(out)
    given = Path(name)
    path = given if given.is_file() else find_isolator(name, beside=catalogue_folder())
    isolator = load_isolator(path)
    screen = console()
    screen.print(
        f"[bold]{escape(isolator.name)}[/]  {escape(f'{isolator.provenance.kind}: {isolator.provenance.source}')}"
    )
    for axis in AXES:
        law = isolator.axes[axis]
        if law is None:
            screen.print(f"  {axis}: no force")
            continue
        screen.print(f"  {axis}: {escape(describe(law))}")
    for line in (*_envelope_lines(isolator), *_joint_lines(isolator)):
        screen.print(f"  {escape(line)}")
    for text in isolator.provenance.assumed:
        screen.print(f"  assumed: {escape(text)}")
    if isinstance(path, VendorPart) or path.parent == catalogue_folder():
        for text in _band_lines(left_out(path.name if isinstance(path, VendorPart) else path.stem, isolator)):
            screen.print(f"  {escape(text)}")
    print_table(_measures(isolator))
    if out is not None:
        from wirerope_mj.views.plots.loops import save_loops

        save_loops(isolator, out, frequency=_FREQUENCY)
        screen.print(f"written: {escape(str(out))}", soft_wrap=True)


def fit_isolator(datasheet: Path, out: Path) -> None:
    """Write the isolator of a data sheet and print every value of the sheet beside that of the fit."""
    isolator = fit_datasheet(datasheet)
    isolator.save(out)
    columns = [
        *(Column(name, align="left") for name in ("axis", "value", "unit")),
        *(Column(name, form=".6g") for name in ("vendor", "fitted")),
        Column("error", "%", "+z.2f"),
    ]
    compared = compare(datasheet, isolator)
    rows = [[row.axis, row.name, row.unit, row.vendor, row.fitted, row.error] for row in compared]
    print_table(Table(title="", columns=columns, rows=rows))
    print(plain(f"written: {out}"))


def _band_lines(band: Band) -> list[str]:
    """Return lines on the values that were left out, what the rest says of them, and the band of error that follows."""
    if not band.values:
        return []
    lines = [
        f"left out, {row.axis}: {row.name} {row.vendor:.4g} {row.unit}, from the rest {row.fitted:.4g} "
        f"({100.0 * row.error:+.0f} %)"
        for row in band.values
        if row.vendor is not None and row.error is not None
    ]
    of_table = [f"{axis} {100.0 * error:.0f} %" for axis, error in band.others.items() if math.isfinite(error)]
    nine = f"; nine in ten parts of the vendor's table stay below {', '.join(of_table)}" if of_table else ""
    return [*lines, f"band of error by leaving out: {100.0 * band.largest:.0f} %{nine}"]


def _envelope_lines(isolator: Isolator) -> list[str]:
    """Return a line for height, width and bar where they are known."""
    if isolator.geometry is None:
        return []
    sizes = {"height": isolator.geometry.height, "width": isolator.geometry.width, "bar": isolator.geometry.bar}
    known = ", ".join(f"{name} {1e3 * size:.4g} mm" for name, size in sizes.items() if size is not None)
    return [f"envelope: {known}; a mount's position in a table is its mid-height"] if known else []


def _joint_lines(isolator: Isolator) -> list[str]:
    """Return a line for the coupling of axes and those for the rotational stiffness and for stiffening, where there are any."""
    lines = []
    if isolator.coupling is not None:
        both = " and ".join(AXES[axis] for axis in isolator.coupled_axes)
        lines.append(f"coupling: {isolator.coupling}, {both} share one hysteretic force")
    if isolator.loop is not None:
        values = isolator.loop.to_dict()
        rows = "; ".join(", ".join(f"{value:.6g}" for value in row) for row in values.pop("coefficients"))
        ends = ", ".join(f"{name} = {value:.6g}" for name, value in values.items())
        lines.append(f"loop: {ends}, coefficients = [{rows}] J")
    if isolator.rotation is not None:
        stiffness = ", ".join(f"{axis} = {value:.6g}" for axis, value in isolator.rotation.to_dict().items())
        lines.append(f"rotation: {stiffness} N m/rad")
    if isolator.stiffening is not None:
        lines.append(f"stiffening: {isolator.stiffening.description}, which the table does not count")
    return lines


def _measures(isolator: Isolator) -> Table:
    """Return measures of steady loops about zero at 25, 50 and 100 % of the rated travel, unrated ones behind the gap."""
    columns = [
        Column("axis", align="left"),
        Column("amplitude", "mm", ".3g"),
        Column("of rated", "%", ".0f"),
        Column("secant stiffness", "kN/m", ".4g"),
        Column("energy per cycle", "J", ".4g"),
        Column("damping ratio", "%", ".4g"),
    ]
    rows: list[list[Cell]] = []
    for axis in AXES:
        law = isolator.axes[axis]
        if law is None:
            continue
        rated = max((travel for travel in isolator.rated_travel(axis) if travel is not None), default=None)
        for fraction in _FRACTIONS:
            wanted = largest_gap(law) + fraction * _UNRATED if rated is None else fraction * rated
            amplitude = min(wanted, fraction * law.finite_travel)
            loop = cyclic_test(law, amplitude, frequency=_FREQUENCY)[0]
            used = None if rated is None else amplitude / rated
            rows.append([axis, amplitude, used, loop.secant_stiffness, loop.dissipated_energy, loop.damping_ratio])
    return Table(title="", columns=columns, rows=rows)


def describe(law: Law) -> str:
    """Return a law's name and parameters as text, those of several one after the other."""
    if isinstance(law, Parallel):
        return " and ".join(describe(one) for one in law.components)
    values = law.to_dict()
    parameters = [f"{key} = {_value(value)}" for key, value in values.items() if key != "law"]
    return f"{values['law']}: {', '.join(parameters)}"


def _value(value: Any) -> str:
    """Return a parameter as text: a number, a list of them, or a choice."""
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return f"{value:.6g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value).lower()


def check_picture(out: Path) -> None:
    """Raise ValueError or RecordError unless a picture can be written as `out`."""
    if out.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise ValueError(f"`--out` must end with .png, .svg or .pdf, got {str(out)!r}.")
    if not out.resolve().parent.is_dir():
        raise ValueError(f"`--out`: there is no folder {str(out.resolve().parent)!r}.")
    check_writable(out)
