"""`wirerope loops`: a cyclic test of an isolator or a law: its measures as a table, its loops as a picture and as a file."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.markup import escape

from wirerope_mj.cli.isolators import check_picture, describe
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.foundation.tables import Cell, Column, Table
from wirerope_mj.foundation.toml_file import toml_content
from wirerope_mj.mounts.isolator import Isolator, Limits, Travel, read_law
from wirerope_mj.mounts.isolator.amplitudes import amplitudes_of, distinct_axes
from wirerope_mj.mounts.laws import EnhancedDryFriction, Hysteresis, Law, Loop
from wirerope_mj.mounts.test_rig import cyclic_test, hardening_overlap, save_cyclic_test, softening_to_hardening
from wirerope_mj.mounts.vendor_parts import VendorPart, find_isolator, load_isolator
from wirerope_mj.views.terminal import console, print_lines, print_table

_FRACTIONS = (0.05, 0.1, 0.25, 0.5, 1.0)
"""Default amplitudes as fractions of the rated travel: enough to see where softening ends."""

_COLUMNS = (
    Column("axis", align="left"),
    Column("amplitude", "mm", ".4g"),
    Column("secant\nstiffness", "kN/m", ".4g"),
    Column("energy\nper cycle", "J", ".4g"),
    Column("damping\nratio", "%", ".4g"),
    Column("tangent after\nlargest defl.", "kN/m", "z.4g"),
    Column("tangent after\nsmallest defl.", "kN/m", "z.4g"),
    Column("cycles\nto close"),
)


def print_loops(
    source: str,
    amplitudes: Sequence[float] | None,
    *,
    operating_point: float,
    axis: str | None,
    frequency: float,
    cycles: int | None,
    out: Path | None,
    csv: Path | None,
) -> None:
    """Test an isolator or a law cyclically, print measures of its loops, draw them, and write them if asked. In SI units."""
    isolator, stem, rated = _load(source, axis)
    picture = Path(f"{stem}-loops.png") if out is None else out
    check_picture(picture)
    laws = _chosen(isolator, axis)
    if csv is not None:
        _check_csv(csv, laws)
    if amplitudes is None and not rated:
        raise ValueError(f"{source} is a law without a rated travel: say at which `--amplitudes` [mm] to test it.")
    for size in amplitudes or ():
        positive("--amplitudes", 1e3 * size, unit="mm")
    tests = {}
    for title, (one, law) in laws.items():
        sizes = amplitudes if amplitudes is not None else amplitudes_of(isolator, one, _FRACTIONS)
        tests[title] = cyclic_test(law, sizes, operating_point=operating_point, frequency=frequency, cycles=cycles)
    _print(isolator, {title: law for title, (_, law) in laws.items()}, tests, operating_point, frequency)
    _write(isolator, laws, tests, frequency, picture, csv)


def _load(source: str, axis: str | None) -> tuple[Isolator, str, bool]:
    """Return the isolator, a name for its files, and whether it may have ratings; a law file is an isolator of one axis."""
    given = Path(source)
    path = given if given.is_file() else find_isolator(source, beside=catalogue_folder())
    if isinstance(path, VendorPart):
        return load_isolator(path), path.name, True
    try:
        content = toml_content(path)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return load_isolator(path), path.stem, True  # says what is wrong with the file
    if "law" in content or "laws" in content:
        law = read_law(content, f"{path}:", path.parent)
        axes: dict[str, Any] = {axis or "axial": law}
        # A law file has no ratings; a law that ends somewhere says so itself when a test leads there.
        end = law.finite_travel if law.needs_rating and law.finite_travel < math.inf else None
        ends = None if end is None else math.nextafter(end, 0.0)
        travel = Travel(compression=ends, tension=ends, shear=ends, roll=ends)
        return Isolator(name=path.stem, limits=Limits(travel=travel), **axes), path.stem, False
    return load_isolator(path), path.stem, True


def _chosen(isolator: Isolator, axis: str | None) -> dict[str, tuple[str, Law]]:
    """Return axis and law by title of what is tested."""
    if axis is None:
        return {title: (one, law) for title, one, law in distinct_axes(isolator)}
    law = isolator.axes[axis]
    if law is None:
        present = ", ".join(name for name, other in isolator.axes.items() if other is not None)
        raise ValueError(f"`--axis {axis}`: {isolator.name} has no force on this axis, only on {present}.")
    return {axis: (axis, law)}


def _check_csv(csv: Path, laws: Mapping[str, tuple[str, Law]]) -> None:
    """Raise ValueError unless the loops can be written as `csv`."""
    if len(laws) > 1:
        raise ValueError(f"`--csv` holds the loops of one axis: name it with --axis; here are {', '.join(laws)}.")
    if csv.is_dir():
        raise ValueError(f"`--csv` must be a file, got the folder {str(csv)!r}.")
    if not csv.resolve().parent.is_dir():
        raise ValueError(f"`--csv`: there is no folder {str(csv.resolve().parent)!r}.")


def _print(
    isolator: Isolator,
    laws: Mapping[str, Law],
    tests: Mapping[str, list[Loop]],
    operating_point: float,
    frequency: float,
) -> None:
    """Print parameters, measures of every loop, and those of all loops of an axis."""
    screen = console()
    about = "" if operating_point == 0.0 else f", about {1e3 * operating_point:.4g} mm"
    rate = "" if all(law.rate_independent for law in laws.values()) else f", at {frequency:g} Hz"
    screen.print(f"[bold]{escape(isolator.name)}[/]{about}{rate}")
    for title, law in laws.items():
        screen.print(f"  {title}: {escape(describe(law))}")
        if isinstance(law, Hysteresis | EnhancedDryFriction) and law.z_max < math.inf:
            form = law.normalised
            screen.print(
                f"  {title}, normalised: z_max = {form.z_max:.6g} N, x_y = {1e3 * form.x_y:.6g} mm, "
                f"sigma = {form.sigma:.6g}, n = {form.n:.6g}",
                soft_wrap=True,
            )
    rows = [[title, *_row(loop, laws[title])] for title, loops in tests.items() for loop in loops]
    print_table(Table(title="", columns=_COLUMNS, rows=rows))
    for title, loops in tests.items():
        print_lines(f"{title}: {text}" for text in _findings(loops))


def _row(loop: Loop, law: Law) -> list[Cell]:
    """Return a loop's measures; a rate-dependent force turns round smoothly and has no tangent to state."""
    tangents = loop.tangents_at_reversal if law.rate_independent else (None, None)
    closed = f"{loop.cycles}" if loop.closure <= 1e-10 else f"{loop.cycles}, open by {loop.closure:.1g}"
    return [
        loop.amplitude, loop.secant_stiffness, loop.dissipated_energy, loop.damping_ratio, *tangents, closed,
    ]  # fmt: skip


def _findings(loops: Sequence[Loop]) -> list[str]:
    """Return measures of the loops of an axis together, as far as their number allows."""
    texts = []
    amplitudes = {loop.amplitude for loop in loops}
    if len(amplitudes) >= 2 and max(loop.damping_ratio for loop in loops) > 1e-9:
        try:
            overlap = hardening_overlap(loops)
            texts.append(f"hardening overlap {overlap:.3f} (0: all amplitudes load along one path in tension)")
        except ValueError as error:
            texts.append(f"no hardening overlap: {error}")
    if len(amplitudes) >= 3:
        texts.append(softening_to_hardening(loops).message)
    return texts


def _write(
    isolator: Isolator,
    laws: Mapping[str, tuple[str, Law]],
    tests: Mapping[str, list[Loop]],
    frequency: float,
    picture: Path,
    csv: Path | None,
) -> None:
    """Write picture and file and print their paths."""
    from wirerope_mj.views.plots.loops import save_cyclic_tests

    titled = {
        title if law.rate_independent else f"{title}, {frequency:g} Hz": tests[title]
        for title, (_, law) in laws.items()
    }
    save_cyclic_tests(titled, picture, title=isolator.name)
    screen = console()
    screen.print(f"written: {escape(str(picture))}", soft_wrap=True)
    if csv is not None:
        save_cyclic_test(next(iter(tests.values())), csv, frequency=frequency)
        screen.print(f"written: {escape(str(csv))}", soft_wrap=True)
