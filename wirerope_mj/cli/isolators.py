"""`wirerope isolators`: the catalogue as a table, and one isolator with its loops."""

from pathlib import Path
from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table

from wirerope_mj.cli.screen import console
from wirerope_mj.foundation.atomic_files import check_place as check_writable
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.isolator import AXES, Isolator, find_isolator, load_isolator
from wirerope_mj.mounts.laws import Law, Parallel
from wirerope_mj.mounts.laws.stop import largest_gap
from wirerope_mj.mounts.test_rig import cyclic_test
from wirerope_mj.mounts.vendor_parts.comparison import compare
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet

_SHARES = (0.25, 0.5, 1.0)
_FREQUENCY = 5.0
"""Of the tests [Hz], table and picture alike; without effect on a rate-independent law."""

_UNRATED = 0.002
"""Deflection at which an axis without rated travel is measured [m]: small for every mount."""


def print_isolators() -> None:
    """Print what the isolators of the catalogue are rated for."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("isolator", no_wrap=True)
    table.add_column("name")
    for name in ("load\n[N]", "compr.\n[mm]", "tension\n[mm]", "shear\n[mm]", "roll\n[mm]"):
        table.add_column(escape(name), justify="right")
    table.add_column("kind")
    for path in sorted(catalogue_folder().glob("*.toml")):
        isolator = load_isolator(path)
        travel = isolator.limits.travel
        rated = [_number(v, 1e3) for v in (travel.compression, travel.tension, travel.shear, travel.roll)]
        table.add_row(
            escape(path.stem),
            escape(isolator.name),
            _number(isolator.limits.static_load, 1.0),
            *rated,
            isolator.provenance.kind,
        )
    console().print(table, "- not rated: not judged. `wirerope isolators NAME` shows one.")


def print_isolator(name: str, out: Path | None) -> None:
    """Print parameters of an isolator and what its steady loops measure; write their picture to `out` if it is given."""
    if out is not None:
        check_place(out)
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
    for line in _joint_lines(isolator):
        screen.print(f"  {escape(line)}")
    for sentence in isolator.provenance.assumed:
        screen.print(f"  assumed: {escape(sentence)}")
    screen.print(_measures(isolator))
    if out is not None:
        from wirerope_mj.views.plots.loops import save_loops

        save_loops(isolator, out, frequency=_FREQUENCY)
        screen.print(f"written: {escape(str(out))}", soft_wrap=True)


def fit_isolator(datasheet: Path, out: Path) -> None:
    """Write the isolator of a data sheet and print every value of the sheet beside that of the fit."""
    isolator = fit_datasheet(datasheet)
    isolator.save(out)
    print(f"{'axis':<13}{'value':<26}{'unit':<6}{'vendor':>12}{'fitted':>12}{'error':>10}")
    for row in compare(datasheet, isolator):
        vendor = "" if row.vendor is None else f"{row.vendor:.6g}"
        error = "" if row.error is None else f"{round(100.0 * row.error, 2) + 0.0:+.2f} %"
        print(f"{row.axis:<13}{row.name:<26}{row.unit:<6}{vendor:>12}{row.fitted:>12.6g}{error:>10}")
    print(plain(f"written: {out}"))


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
    """Return what steady loops about zero at 25, 50 and 100 % of the rated travel measure, unrated ones behind the gap."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("axis")
    for name in (
        "amplitude [mm]",
        "of rated [%]",
        "secant stiffness [kN/m]",
        "energy per cycle [J]",
        "damping ratio [%]",
    ):
        table.add_column(escape(name), justify="right")
    for axis in AXES:
        law = isolator.axes[axis]
        if law is None:
            continue
        rated = max((travel for travel in isolator.rated_travel(axis) if travel is not None), default=None)
        gap = largest_gap(law)
        for share in _SHARES:
            wanted = gap + share * _UNRATED if rated is None else share * rated
            amplitude = min(wanted, share * law.finite_travel)
            loop = cyclic_test(law, amplitude, frequency=_FREQUENCY)[0]
            values = (1e-3 * loop.secant_stiffness, loop.dissipated_energy, 100.0 * loop.damping_ratio)
            part = "-" if rated is None else f"{100 * amplitude / rated:.0f}"
            table.add_row(axis, f"{1e3 * amplitude:.3g}", part, *[f"{value:.4g}" for value in values])
    return table


def describe(law: Law) -> str:
    """Return a law's name and parameters in words, those of several one after the other."""
    if isinstance(law, Parallel):
        return " and ".join(describe(one) for one in law.components)
    values = law.to_dict()
    words = [f"{key} = {_value(value)}" for key, value in values.items() if key != "law"]
    return f"{values['law']}: {', '.join(words)}"


def _value(value: Any) -> str:
    """Return a parameter in words: a number, a list of them, or a choice."""
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return f"{value:.6g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value).lower()


def check_place(out: Path) -> None:
    """Raise ValueError or RecordError unless a picture can be written as `out`."""
    if out.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise ValueError(f"`--out` must end with .png, .svg or .pdf, got {str(out)!r}.")
    if not out.resolve().parent.is_dir():
        raise ValueError(f"`--out`: there is no folder {str(out.resolve().parent)!r}.")
    check_writable(out)


def _number(value: float | None, scale: float) -> str:
    return "-" if value is None else f"{scale * value:.4g}"
