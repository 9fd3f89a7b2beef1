"""Isolators: ratings of many, and of one its laws, its geometry, where its figures come from, and what its loops measure."""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.numbers import ABSENT, number, with_unit
from wirerope_mj.foundation.tables import Cell, Column, Row, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.estimate import LoopEstimate
from wirerope_mj.mounts.isolator import AXES, Isolator
from wirerope_mj.mounts.isolator.travel import RATINGS
from wirerope_mj.mounts.laws import Law, Parallel, Stop
from wirerope_mj.mounts.laws.stop import largest_gap
from wirerope_mj.mounts.test_rig import cyclic_test
from wirerope_mj.mounts.vendor_parts import VendorPart, shipped_file, vendor_parts
from wirerope_mj.mounts.vendor_parts.left_out import Band
from wirerope_mj.mounts.vendor_parts.sheet import ComparedValue

FREQUENCY = 5.0
"""Of the tests of an isolator [Hz], table and picture alike; without effect on a rate-independent law."""

_FRACTIONS = (0.25, 0.5, 1.0)
_UNRATED = 0.002  # [m], at which an axis without rated travel is measured: small for every mount


def ratings_table(devices: Sequence[Isolator]) -> Table:
    """Tabulate provenance, laws, sizes and ratings of isolators."""
    rows = [(one.name, one.provenance.kind, ", ".join(_laws(one)), *_ratings(one)) for one in devices]
    names = [Column(heading, align="left") for heading in ("isolator", "figures are", "laws")]
    return Table(
        id="isolators",
        title="Isolators and their ratings",
        columns=(*names, *_RATING_COLUMNS),
        rows=rows,
        note=f"{ABSENT}: not stated, and so not judged.",
    )


def catalogue_table(devices: Mapping[str, Isolator]) -> Table:
    """Tabulate sizes and ratings of the isolators of the catalogue by the names of their files."""
    rows = [(name, *_ratings(one), one.provenance.kind) for name, one in devices.items()]
    return Table(
        id="catalogue",
        title="",
        columns=(Column("isolator", align="left"), *_RATING_COLUMNS, Column("figures are", align="left")),
        rows=rows,
        note=f"-: not stated, and so not judged. `wirerope isolators NAME` shows one, `--all` the {len(vendor_parts())} parts "
        "of the vendors' tables, which every command takes by name as well.",
    )


_RATING_COLUMNS = (
    Column("height", "mm", ".4g"), Column("width", "mm", ".4g"), Column("static\nload", "kN", 4),
    *(Column({"compression": "compr."}.get(rating, rating), "mm", ".4g") for rating in RATINGS),
)  # fmt: skip


def _ratings(device: Isolator) -> tuple[float | None, ...]:
    size, limits = device.geometry, device.limits
    sizes = (size.height, size.width) if size else (None, None)
    return *sizes, limits.static_load, *(getattr(limits.travel, rating) for rating in RATINGS)


def _laws(device: Isolator) -> list[str]:
    return list(dict.fromkeys(law.name for law in device.axes.values() if law is not None))


def parts_table(parts: Sequence[VendorPart]) -> Table:
    """Tabulate the parts of the vendors' tables as the vendors state them, and where each one's isolator is from."""
    rows: list[Row] = []
    for part in parts:
        along, across = part.modes["compression"], part.modes["shear"]
        whole = None not in (part.height, part.width, part.rope, along.travel, along.vibration, along.shock)
        made = "shipped" if shipped_file(part) else "fitted" if whole else None
        sizes = [part.height, part.width, part.rope, along.static_load, along.travel, across.travel]
        rows.append((part.name, *sizes, along.vibration, along.shock, made))
    return Table(
        id="vendor-parts",
        title="",
        columns=(
            Column("part", align="left"),
            *(Column(name, "mm", ".4g") for name in ("height", "width", "rope")),
            Column("load", "N", ".0f"),
            *(Column(name, "mm", ".4g") for name in ("compr.", "shear")),
            *(Column(f"{name}\nstiffness", "N/mm", ".4g") for name in ("vibration", "shock")),
            Column("isolator", align="left"),
        ),
        rows=rows,
        note="-: not stated. Load and stiffnesses are those in compression. Isolator: shipped as a file, fitted from the row "
        "when it is asked for, or none where too little is stated; `wirerope isolators PART` says what is "
        "fitted and what assumed.",
    )


def isolator_content(device: Isolator, band: Band | None = None) -> Content:
    """Describe an isolator: where its figures come from, its laws, geometry and band of error, and what its loops measure."""
    return Content(
        title=device.name,
        verdict=provenance_statement(device),
        sections=(
            Section(id="isolator", title="", build=partial(_isolator_blocks, device), depth="summary"),
            Section(id="band", title="", build=lambda: [_band(band)] if band else [], depth="summary"),
            Section(id="measures", title="", build=lambda: [_measures(device)], depth="summary"),
        ),
    )


def provenance_statement(device: Isolator) -> Statement:
    """Return where an isolator's figures come from, its stops and stiffening, and what is assumed."""
    stated = device.provenance
    text = f"{device.name}: {stated.kind} figures. "
    text += f"Source: {stated.source.rstrip('.')}. " if stated.source else "No source is stated. "
    text += f"Fitted to: {stated.fitted_to.rstrip('.')}." if stated.fitted_to else "Nothing is said of a fit."
    text += "".join(_stop_words(axis, law) for axis, law in device.axes.items() if law is not None)
    if device.stiffening is not None:
        text += f" Stiffened by its first cycles, {device.stiffening.description}."
    assumed = tuple(f"Assumed: {item.rstrip('.')}." for item in stated.assumed)
    return Statement(id=f"source-{device.name}", text=text, items=assumed)


def _band(band: Band) -> Statement | None:
    """Say what the rest says of each value that is left out, and the band of error that follows."""
    if not band.values:
        return None
    left = tuple(
        f"{row.axis}: {row.name} {row.vendor:.4g} {row.unit}, from the rest {row.fitted:.4g} ({100.0 * row.error:+.0f} %)"
        for row in band.values
        if row.vendor is not None and row.error is not None
    )
    of_table = [f"{axis} {100.0 * error:.0f} %" for axis, error in band.others.items() if math.isfinite(error)]
    nine = f"; nine in ten parts of the vendor's table stay below {', '.join(of_table)}" if of_table else ""
    text = f"Band of error by leaving out: {100.0 * band.largest:.0f} %{nine}."
    return Statement(id="band", text=text, items=left, values={"largest": band.largest})


def _stop_words(axis: str, law: Law) -> str:
    """Return where the stops on an axis close and how stiff they are, "" without one."""
    text = ""
    for stop in [part for part in law.components if isinstance(part, Stop)]:
        sides = ((stop.gap_below, "below"), (stop.gap_above, "above"))
        gaps = " and ".join(f"{with_unit(gap, 'm')} {side}" for gap, side in sides if gap is not None)
        if stop.k is None:
            force = f"points up to {with_unit(stop.forces[-1], 'N')} at {with_unit(stop.depths[-1], 'm')} beyond it"
        elif stop.exponent == 1.0:
            force = f"{with_unit(stop.k, 'kN/m')} beyond it"
        else:
            force = f"exponent {number(stop.exponent)} beyond it"
        text += f" Stop, {axis}: gap {gaps}, {force}."
    return text


def _isolator_blocks(device: Isolator) -> Iterator[Block]:
    yield provenance_statement(device)
    laws = [f"{axis}: {'no force' if law is None else law_text(law)}" for axis, law in device.axes.items()]
    yield Statement(id="laws", text="Laws, in SI units:", items=(*laws, *_joint_lines(device)))
    if device.geometry is not None:
        sizes = {"height": device.geometry.height, "width": device.geometry.width, "bar": device.geometry.bar}
        known = ", ".join(f"{name} {in_unit(size, 'mm'):.4g} mm" for name, size in sizes.items() if size is not None)
        if known:
            text = f"Envelope: {known}; a mount's position in a table is its mid-height."
            yield Statement(id="envelope", text=text)


def law_text(law: Law) -> str:
    """Return a law's name and parameters as text, those of several one after the other."""
    if isinstance(law, Parallel):
        return " and ".join(law_text(one) for one in law.components)
    values = law.to_dict()
    parameters = [f"{key} = {_value(value)}" for key, value in values.items() if key != "law"]
    return f"{values['law']}: {', '.join(parameters)}"


def _value(value: Any) -> str:
    """Return a parameter as text: a number, a list of them, or a choice."""
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return f"{value:.6g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value).lower()


def _joint_lines(device: Isolator) -> Iterator[str]:
    """Yield what couples the axes, the rotational stiffness, and stiffening."""
    if device.coupling is not None:
        both = " and ".join(AXES[axis] for axis in device.coupled_axes)
        yield f"coupling: {device.coupling}, {both} share one hysteretic force"
    if device.loop is not None:
        values = device.loop.to_dict()
        rows = "; ".join(", ".join(f"{value:.6g}" for value in row) for row in values.pop("coefficients"))
        ends = ", ".join(f"{name} = {value:.6g}" for name, value in values.items())
        yield f"loop: {ends}, coefficients = [{rows}] J"
    if device.rotation is not None:
        stiffness = ", ".join(f"{axis} = {value:.6g}" for axis, value in device.rotation.to_dict().items())
        yield f"rotation: {stiffness} N m/rad"
    if device.stiffening is not None:
        yield f"stiffening: {device.stiffening.description}, which the table does not count"


def _measures(device: Isolator) -> Table:
    """Tabulate steady loops about zero at 25, 50 and 100 % of the rated travel, unrated ones beyond the gap."""
    rows: list[list[Cell]] = []
    for axis, law in device.axes.items():
        if law is None:
            continue
        rated = max((travel for travel in device.rated_travel(axis) if travel is not None), default=None)
        for fraction in _FRACTIONS:
            wanted = largest_gap(law) + fraction * _UNRATED if rated is None else fraction * rated
            amplitude = min(wanted, fraction * law.finite_travel)
            loop = cyclic_test(law, amplitude, frequency=FREQUENCY)[0]
            used = None if rated is None else amplitude / rated
            rows.append([axis, amplitude, used, loop.secant_stiffness, loop.dissipated_energy, loop.damping_ratio])
    columns = (
        Column("axis", align="left"), Column("amplitude", "mm", ".3g"), Column("of rated", "%", ".0f"),
        Column("secant\nstiffness", "kN/m", ".4g"), Column("energy\nper cycle", "J", ".4g"),
        Column("damping\nratio", "%", ".4g"),
    )  # fmt: skip
    return Table(id="measures", title="Steady loops about zero", columns=columns, rows=rows)


def fitted_table(compared: Sequence[ComparedValue]) -> Table:
    """Tabulate every value of a data sheet beside that of the isolator that was fitted to it."""
    columns = [
        *(Column(name, align="left") for name in ("axis", "value", "unit")),
        *(Column(name, form=".6g") for name in ("vendor", "fitted")),
        Column("error", "%", "+z.2f"),
    ]
    rows = [[row.axis, row.name, row.unit, row.vendor, row.fitted, row.error] for row in compared]
    return Table(id="fitted", title="", columns=columns, rows=rows)


def estimate_content(estimate: LoopEstimate) -> Content:
    """Describe an isolator without data sheet: estimated values beside the errors of such estimates, and what is assumed."""
    return Content(
        title="Estimate from the geometry",
        verdict=Statement(id="estimated", text="All values are estimated; nothing was measured.", tone="unjudged"),
        sections=(
            Section(id="estimate", title="", build=lambda: [_estimate_table(estimate)], depth="summary"),
            Section(id="remarks", title="", build=partial(_estimate_remarks, estimate), depth="summary"),
        ),
    )


def _estimate_table(estimate: LoopEstimate) -> Table:
    values = estimate.values
    rows = [("compression", "static load", "N", values.static_load, "static load")]
    for mode, direction in {"compression": "compression", "45": "45 degrees", "shear": "shear, roll"}.items():
        rows.append((direction, "travel", "mm", values.travel[mode], f"{mode} travel"))
        rows.append((direction, "vibration stiffness", "N/mm", values.vibration[mode], f"{mode} vibration"))
        rows.append((direction, "shock stiffness", "N/mm", values.shock[mode], f"{mode} shock"))
    cells: list[Row] = []
    for direction, label, unit, value, name in rows:
        band = estimate.bands[name]
        factors = [None if error is None else 1.0 + error for error in (band.within, band.worst, band.other)]
        cells.append((direction, f"{label} [{unit}]", f"{in_unit(value, unit):.4g}", *factors))
    names = Column("direction", align="left"), Column("value", align="left"), Column("estimate")
    errors = ("80 % of Enidine's\nwithin a factor", "worst\nfactor", "80 % of VMC's\nwithin a factor")
    return Table(
        id="estimate", title="", columns=(*names, *(Column(heading, form=".2f") for heading in errors)), rows=cells
    )


def _estimate_remarks(estimate: LoopEstimate) -> Iterator[Statement]:
    """Yield the source of the errors, the assumptions, and the rotational stiffness."""
    without = (
        "each estimated without itself"
        if estimate.left_out == "part"
        else "each estimated without all parts of its rope, because no part has the rope asked for"
    )
    text = (
        f"Errors are those of the same estimate for the 50 parts of Enidine's table, {without}, and for VMC's parts, which it "
        "never saw; a factor of 1.2 means 1 / 1.2 to 1.2 times. Vibration stiffness in shear is the shock stiffness, as in "
        "Enidine's table. None of this was measured."
    )
    yield Statement(id="estimate-errors", text=text)
    if estimate.bar_assumed:
        bar = f"{in_unit(estimate.bar, 'mm'):.3g} mm"
        text = f"Bars of {bar} are assumed, as Enidine's parts of this rope have; --bar gives others."
        yield Statement(id="estimate-bar", text=text)
    about = zip(("roll", "shear", "axial"), estimate.rotation, strict=True)
    known = [f"{value:.4g} about the {axis} axis" for axis, value in about if math.isfinite(value)]
    more = "" if estimate.bar_length is not None else " The others need --bar-length."
    text = (
        f"Rotational stiffness of small vibration about mid-height [N m/rad]: {', '.join(known)}; no vendor states any to "
        f"compare with.{more}"
    )
    yield Statement(id="estimate-rotation", text=text)
