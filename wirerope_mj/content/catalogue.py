"""Contents of the catalogue: shipped isolators, vendors' parts, one isolator with its loop measures, fits and estimates."""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.content.cyclic_tests import measures_table
from wirerope_mj.content.isolator import RATING_COLUMNS, isolator_blocks, provenance_statement, ratings
from wirerope_mj.content.numbers import listed
from wirerope_mj.foundation.tables import Column, Row, Table, left
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.estimate import LoopEstimate
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.structural_codes import StructuralExport
from wirerope_mj.mounts.vendor_parts import VendorPart, shipped_file, vendor_parts
from wirerope_mj.mounts.vendor_parts.comparison import Band
from wirerope_mj.mounts.vendor_parts.sheet import ComparedValue
from wirerope_mj.mounts.vendor_parts.short_sheet import INSIDE, ShortFit


def catalogue_table(devices: Mapping[str, Isolator]) -> Table:
    rows = [(name, *ratings(device), device.provenance.kind) for name, device in devices.items()]
    return Table(
        "catalogue", "",
        (*left("isolator"), *RATING_COLUMNS, *left("figures are")), rows,
        note=f"-: not stated, and so not judged. `wirerope isolators NAME` shows one, `--all` the {len(vendor_parts())} parts "
        "of the vendors' tables, which every command takes by name as well.",
    )  # fmt: skip


def parts_table(parts: Sequence[VendorPart]) -> Table:
    """Tabulate the vendors' parts with their stated values, and the origin of the isolator of each."""
    rows: list[Row] = []
    for part in parts:
        along, across = part.modes["compression"], part.modes["shear"]
        complete = None not in (part.height, part.width, part.rope, along.travel, along.vibration, along.shock)
        origin = "shipped" if shipped_file(part) else "fitted" if complete else None
        sizes = [part.height, part.width, part.rope, along.static_load, along.travel, across.travel]
        rows.append((part.name, *sizes, along.vibration, along.shock, origin))
    return Table(
        "vendor-parts", "",
        (
            *left("part"), *(Column(name, "mm", ".4g") for name in ("height", "width", "rope")),
            Column("load", "N", ".0f"), *(Column(name, "mm", ".4g") for name in ("compr.", "shear")),
            *(Column(f"{name}\nstiffness", "N/mm", ".4g") for name in ("vibration", "shock")),
            *left("isolator"),
        ),
        rows,
        note="-: not stated. Load and stiffnesses are those in compression. Isolator: shipped as a file, fitted from the row "
        "when it is asked for, or none where too little is stated; `wirerope isolators PART` says what is "
        "fitted and what assumed.",
    )  # fmt: skip


def isolator_content(device: Isolator, band: Band | None = None) -> Content:
    """Compose the content of an isolator; `band` compares each value of the vendor with a fit to the others."""

    def band_of_error() -> Iterator[Statement]:
        if band is None or not band.values:
            return
        lines = tuple(
            f"{row.axis}: {row.name} {row.vendor:.4g} {row.unit}, from the rest {row.fitted:.4g} ({100.0 * row.error:+.0f} %)"
            for row in band.values
            if row.vendor is not None and row.error is not None
        )
        table_errors = [f"{axis} {100.0 * error:.0f} %" for axis, error in band.others.items() if math.isfinite(error)]
        others = f"; nine in ten parts of the vendor's table stay below {', '.join(table_errors)}" if table_errors else ""
        text = f"Band of error by leaving out: {100.0 * band.largest:.0f} %{others}."
        yield Statement("band", text, items=lines, values={"largest": band.largest})

    return Content(
        title=device.name,
        verdict=provenance_statement(device),
        sections=(
            Section("isolator", "", partial(isolator_blocks, device), "summary"),
            Section("band", "", band_of_error, "summary"),
            Section("measures", "", lambda: [measures_table(device)], "summary"),
        ),
    )


def fitted_table(compared: Sequence[ComparedValue]) -> Table:
    columns = [
        *(Column(name, align="left") for name in ("axis", "value", "unit")),
        *(Column(name, form=".6g") for name in ("vendor", "fitted")),
        Column("error", "%", "+z.2f"),
    ]
    rows = [[row.axis, row.name, row.unit, row.vendor, row.fitted, row.error] for row in compared]
    return Table("fitted", "", columns, rows)


def short_fit_content(fit: ShortFit) -> Content:
    """Describe the isolator of a data sheet of few figures, with the bands of the figures that the sheet leaves open."""
    rows = [(row.axis, row.name, row.unit, row.fitted, low, high) for row, low, high in fit.bands()]
    columns = [
        *left("axis", "value", "unit"),
        Column("fitted", form=".4g"),
        Column("from", form=".4g"),
        Column("to", form=".4g"),
    ]
    moved = [
        f'`--vary "{" & ".join(one.factors)} = Uniform({one.low / one.value:.2g}, {one.high / one.value:.2g})"`'
        for one in fit.assumed.values() if one.factors
    ]  # fmt: skip
    note = (
        f"From, to: {100.0 * INSIDE:.0f} % band of what the sheet does not state: each figure moved alone to the ends of its "
        "band, and the changes added as squares." + (f" A study moves it by {listed(moved)}." if moved else "")
    )
    stated = fit.isolator.provenance
    assumed = [f"Assumed: {item.rstrip('.')}." for item in stated.assumed]
    open_figures = listed([one.name for one in fit.assumed.values()])
    text = (
        f"Fitted to the sheet's figures; assumed, each with a band: {open_figures}." if open_figures else "Nothing is assumed."
    )
    return Content(
        title=fit.isolator.name,
        verdict=Statement("short-fit", text, tone="unjudged" if open_figures else ""),
        sections=(
            Section("fitted", "", lambda: [Statement("fitted-to", f"Fitted to: {stated.fitted_to}.")], "summary"),
            Section("bands", "", lambda: [Table("bands", "", columns, rows, note=note)], "summary"),
            Section(
                "assumed", "", lambda: [Statement("assumed", "What the sheet does not state:", items=tuple(assumed))], "summary"
            ),
        ),
    )


def structural_content(export: StructuralExport) -> Content:
    """Compose what the file for a structural code states of an isolator, and what its tables and constants leave out."""
    rows: list[Row] = []
    for table in export.tables:
        loop, (small, whole) = table.loop, table.secants
        damper = table.viscous(export.frequency)
        cells = (table.points[0, 0], table.points[-1, 0], len(table.points), table.missed, loop.secant_stiffness, small, whole)
        rows.append((table.axis, *cells, table.loss_factor, damper, loop.dissipated_energy, table.width))
    columns = (
        *left("axis"), Column("table\nfrom", "mm", ".4g"), Column("to", "mm", ".4g"), Column("points", form=".0f"),
        Column("misses\ncurve by", "%", ".2g"), Column("secant", "N/mm", ".4g"), Column("secant at\na tenth", "N/mm", ".4g"),
        Column("at all", "N/mm", ".4g"), Column("loss\nfactor", form=".4g"), Column("damper", "N s/m", ".4g"),
        Column("energy\nleft out", "J", ".4g"), Column("force\noff by", "%", ".3g"),
    )  # fmt: skip
    note = (
        f"Secant, loss factor, damper (at {export.frequency:.4g} Hz), energy: of a closed cycle of "
        f"{in_unit(export.amplitude, 'mm'):.4g} mm; the table is elastic and leaves that energy out. Secant at a tenth, at "
        "all: of cycles of that part of the table's range, on its shorter side. Misses the curve, force off: in parts of the "
        "largest force, of the lines between points, and of that cycle from the table."
    )
    return Content(
        title=f"{export.isolator.name} for {export.code}, {export.units.replace('-', ', ')}",
        verdict=Statement("structural", "Tables and constants approximate the loops.", tone="unjudged"),
        sections=(
            Section("structural", "", lambda: [Table("structural", "", columns, rows, note=note)], "summary"),
            Section("remarks", "", lambda: [Statement("remarks", "The file says:", items=export.remarks)], "summary"),
        ),
    )


def estimate_content(estimate: LoopEstimate) -> Content:
    """Tabulate the values estimated from an isolator's geometry, with the errors of such estimates for known parts."""
    rows = [("compression", "static load", "N", "static load")]
    for mode, direction in {"compression": "compression", "45": "45 degrees", "shear": "shear, roll"}.items():
        rows.append((direction, "travel", "mm", f"{mode} travel"))
        rows.append((direction, "vibration stiffness", "N/mm", f"{mode} vibration"))
        rows.append((direction, "shock stiffness", "N/mm", f"{mode} shock"))
    cells: list[Row] = []
    for direction, label, unit, name in rows:
        band = estimate.bands[name]
        factors = [None if error is None else 1.0 + error for error in (band.within, band.worst, band.other)]
        cells.append((direction, f"{label} [{unit}]", f"{in_unit(estimate.values[name], unit):.4g}", *factors))
    errors = ("80 % of Enidine's\nwithin a factor", "worst\nfactor", "80 % of VMC's\nwithin a factor")
    columns = [*left("direction", "value"), Column("estimate"), *(Column(heading, form=".2f") for heading in errors)]
    return Content(
        title="Estimate from the geometry",
        verdict=Statement("estimated", "All values are estimated; nothing was measured.", tone="unjudged"),
        sections=(
            Section("estimate", "", lambda: [Table("estimate", "", columns, cells)], "summary"),
            Section("remarks", "", partial(_estimate_remarks, estimate), "summary"),
        ),
    )


def _estimate_remarks(estimate: LoopEstimate) -> Iterator[Statement]:
    """Yield the errors of the estimate, an assumed bar, and the rotational stiffnesses."""
    left_out = (
        "each estimated without itself"
        if estimate.left_out == "part"
        else "each estimated without all parts of its rope, because no part has the rope asked for"
    )
    text = (
        f"Errors are those of the same estimate for the 50 parts of Enidine's table, {left_out}, and for VMC's parts, which it "
        "never saw; a factor of 1.2 means 1 / 1.2 to 1.2 times. Vibration stiffness in shear is the shock stiffness, as in "
        "Enidine's table. None of this was measured."
    )
    yield Statement("estimate-errors", text)
    if estimate.bar_assumed:
        bar = f"{in_unit(estimate.bar, 'mm'):.3g} mm"
        text = f"Bars of {bar} are assumed, as Enidine's parts of this rope have; --bar gives others."
        yield Statement("estimate-bar", text)
    stiffnesses = zip(("roll", "shear", "axial"), estimate.rotation, strict=True)
    known = [f"{value:.4g} about the {axis} axis" for axis, value in stiffnesses if math.isfinite(value)]
    hint = "" if estimate.bar_length is not None else " The others need --bar-length."
    text = (
        f"Rotational stiffness of small vibration about mid-height [N m/rad]: {', '.join(known)}; no vendor states any to "
        f"compare with.{hint}"
    )
    yield Statement("estimate-rotation", text)
