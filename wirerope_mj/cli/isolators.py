"""`wirerope isolators`: the catalogue, one isolator, an isolator from a data sheet, blank or not, or from its geometry."""

import warnings
from pathlib import Path
from typing import Literal

from cyclopts import App

from wirerope_mj.cli.options import Flag, Force, Integer

isolators_app = App(name="isolators")


@isolators_app.default
def isolators(
    name: str | None = None,
    *,
    all: Flag = False,  # noqa: A002  # the option's name
    out: Path | None = None,
) -> int:
    """Show the isolators of the catalogue, fit one from a data sheet, or estimate one from its geometry.

    `wirerope isolators fit DATASHEET OUT` makes an isolator file from a vendor's data sheet, and `wirerope isolators estimate`
    one from the geometry alone.

    Args:
        name: isolator of the catalogue, part of a vendor's table such as CB1500-30, or the path of an isolator file; without it
            the whole catalogue.
        all: list the parts of the vendors' tables instead, each of which is a name, too.
        out: where the picture of the loops is written (.png, .svg, .pdf).
    """
    from wirerope_mj.content.catalogue import catalogue_table, isolator_content, parts_table
    from wirerope_mj.foundation.errors import ModelWarning
    from wirerope_mj.foundation.resources import catalogue_folder
    from wirerope_mj.mounts.isolator.implausible import isolator_warnings
    from wirerope_mj.mounts.vendor_parts import find_isolator, load_isolator, vendor_parts
    from wirerope_mj.mounts.vendor_parts.comparison import left_out
    from wirerope_mj.mounts.vendor_parts.parts import VendorPart
    from wirerope_mj.views.terminal import print_table, show

    if name is None:
        if out is not None:
            raise ValueError("`--out` writes the picture of one isolator; name it: wirerope isolators NAME --out FILE")
        files = sorted(catalogue_folder().glob("*.toml"))
        shipped = {path.stem: load_isolator(path) for path in files} if not all else {}
        print_table(parts_table(list(vendor_parts())) if all else catalogue_table(shipped))
        return 0
    if out is not None:
        check_picture(out)
    given = Path(name)
    path = given if given.is_file() else find_isolator(name, beside=catalogue_folder())
    device = load_isolator(path)
    for text in isolator_warnings(device):
        warnings.warn(text, ModelWarning, stacklevel=1)
    known = isinstance(path, VendorPart) or path.parent == catalogue_folder()
    part = path.name if isinstance(path, VendorPart) else path.stem
    show(isolator_content(device, left_out(part, device) if known else None))
    if out is not None:
        from wirerope_mj.content.cyclic_tests import isolator_chart
        from wirerope_mj.views.pictures import save_pictures

        save_pictures([isolator_chart(device)], out, title=device.name)
        say_written(out)
    return 0


@isolators_app.command
def fit(datasheet: Path, out: Path) -> int:
    """Fit an isolator from a vendor's data sheet and print every value of the sheet beside that of the fit.

    A sheet of three figures, stiffness, load and travel, is enough: what it leaves open is assumed as the parts in the vendors'
    tables have it, with a band that is printed and that the isolator's file keeps. `wirerope isolators blank` writes such a
    sheet to fill in.

    Args:
        datasheet: TOML file with the vendor's values, or with `curve = "shock"` or `"static"` and force-deflection curves.
        out: isolator file to write.
    """
    from wirerope_mj.content.catalogue import fitted_table, short_fit_content
    from wirerope_mj.foundation.errors import ConvergenceError, ModelError
    from wirerope_mj.mounts.vendor_parts.comparison import compare
    from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet
    from wirerope_mj.mounts.vendor_parts.short_sheet import fit_short, read_short_sheet
    from wirerope_mj.views.terminal import print_table, show

    if (sheet := read_short_sheet(datasheet)) is not None:
        try:
            fitted = fit_short(sheet)
            content = short_fit_content(fitted)
        except ValueError as error:
            raise ModelError(f"{datasheet}: {error}") from None
        except ConvergenceError as error:
            raise ConvergenceError(f"{datasheet}: {error}") from None
        fitted.isolator.save(out)
        show(content)
    else:
        device = fit_datasheet(datasheet)
        device.save(out)
        print_table(fitted_table(compare(datasheet, device)))
    say_written(out)
    return 0


@isolators_app.command
def export(
    name: str, out: Path, *, amplitude_mm: float, frequency: float | None = None,
    damping: Literal["structural", "viscous"] | None = None, units: Literal["N-m-kg", "N-mm-t"] = "N-m-kg",
    force: Force = False,
) -> int:  # fmt: skip
    """Write an isolator for a structural code: static curves as tables, stiffness and damping of cycles of one amplitude.

    The ending of OUT names the code: .bdf, .dat, .nas Nastran (CBUSH, PBUSH, PBUSHT), .inp Abaqus (connector), .mac Ansys
    (COMBIN39, COMBIN14). Tables are elastic: file and terminal say what energy they leave out, and how far secants differ.

    Args:
        name: isolator of the catalogue, part of a vendor's table, or the path of an isolator file.
        out: file to write.
        amplitude_mm: of the cycles of which stiffness and damping are [mm].
        frequency: of viscous damping [Hz]; by default the natural frequency of the axial stiffness under the rated load.
        damping: structural, a loss factor, or viscous, a damper; by default structural, of Ansys viscous.
        units: of the file: newtons, metres, kilograms, or newtons, millimetres, tonnes.
    """
    from wirerope_mj.content.catalogue import structural_content
    from wirerope_mj.foundation.arguments import positive
    from wirerope_mj.foundation.atomic_files import atomic_file, check_writable
    from wirerope_mj.foundation.resources import catalogue_folder
    from wirerope_mj.mounts.isolator.structural_codes import export_structural
    from wirerope_mj.mounts.vendor_parts import find_isolator, load_isolator
    from wirerope_mj.views.terminal import show

    given = Path(name)
    device = load_isolator(given if given.is_file() else find_isolator(name, beside=catalogue_folder()))
    size = positive("--amplitude-mm", amplitude_mm, unit="mm") / 1e3
    pace = None if frequency is None else positive("--frequency", frequency, unit="Hz")
    made = export_structural(device, out, amplitude=size, frequency=pace, damping=damping, units=units)
    check_writable(out, force=force)
    with atomic_file(out) as temporary:
        temporary.write_text(made.text(), encoding="utf-8")
    show(structural_content(made))
    say_written(out)
    return 0


@isolators_app.command
def blank(out: Path, *, force: Force = False) -> int:
    """Write a data sheet to fill in: stiffness, load and travel, and what else may be stated, each with what is assumed if not.

    wirerope isolators blank sheet.toml, edit it, wirerope isolators fit sheet.toml isolator.toml

    Args:
        out: file to write, ending in .toml.
    """
    from wirerope_mj.foundation.schema import blank_form
    from wirerope_mj.mounts.vendor_parts.short_sheet import ShortSheet

    title = (
        f"A data sheet of an isolator: `wirerope isolators fit {out.name} ISOLATOR.toml` makes an isolator of it.\n"
        "Units stand in the keys: travel_in, static_load_lbf, stiffness_lb_per_in are read as well as mm, N and N/mm."
    )
    write_form(blank_form(ShortSheet, title=title), out, force=force)
    return 0


@isolators_app.command
def estimate(
    *, height: float, width: float, rope: float, loops: Integer, bar: float | None = None, bar_length: float | None = None,
    out: Path | None = None,
) -> int:  # fmt: skip
    """Estimate an isolator without data sheet from its geometry, with the errors that such estimates make of known parts.

    Args:
        height: unloaded, over both bars [mm].
        width: over the ropes, across the bars [mm].
        rope: diameter [mm].
        loops: number of full loops.
        bar: thickness of one bar [mm]; as known parts of this rope have it by default.
        bar_length: over which the loops are spread evenly [mm], for the rotational stiffness.
        out: isolator file to write; it says that all is estimated.
    """
    from wirerope_mj.content.catalogue import estimate_content
    from wirerope_mj.foundation.arguments import positive
    from wirerope_mj.foundation.atomic_files import check_writable
    from wirerope_mj.mounts.estimate import estimate_loop, estimated_isolator
    from wirerope_mj.views.terminal import show

    given = {"height": height, "width": width, "rope": rope, "bar": bar, "bar_length": bar_length}
    lengths = {
        name: None if size is None else positive(f"--{name.replace('_', '-')}", size, unit="mm") / 1e3
        for name, size in given.items()
    }
    if out is not None:
        if out.suffix != ".toml":
            raise ValueError(f"`--out` must end with .toml, got {str(out)!r}.")
        check_writable(out)
    estimated = estimate_loop(**lengths, loops=loops)  # type: ignore[arg-type]  # the required ones are given
    show(estimate_content(estimated))
    if out is not None:
        estimated_isolator(estimated).save(out)
        say_written(out)
    return 0


def check_picture(out: Path) -> None:
    """Raise ValueError or RecordError unless a picture can be written as `out`."""
    from wirerope_mj.foundation.atomic_files import check_writable

    if out.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise ValueError(f"`--out` must end with .png, .svg or .pdf, got {str(out)!r}.")
    check_writable(out)


def write_form(text: str, out: Path, *, force: bool) -> None:
    """Write a blank form and say where it is; ValueError or RecordError unless it can be written."""
    from wirerope_mj.foundation.atomic_files import atomic_file, check_writable

    if out.suffix != ".toml":
        raise ValueError(f"a blank form must end with .toml, got {str(out)!r}.")
    check_writable(out, force=force)
    with atomic_file(out) as temporary:
        temporary.write_text(text, encoding="utf-8")
    say_written(out)


def say_written(path: Path) -> None:
    """Print where a file was written."""
    from wirerope_mj.foundation.plain_text import plain

    print(plain(f"written: {path}"))
