"""`wirerope isolators estimate`: the values of an isolator without data sheet, beside the errors of such estimates."""

import math
from pathlib import Path

from rich.markup import escape

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.atomic_files import check_writable
from wirerope_mj.foundation.tables import Cell, Column, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.estimate import LoopEstimate, estimate_loop, estimated_isolator
from wirerope_mj.views.terminal import console, print_table

_MODES = {"compression": "compression", "45": "45 degrees", "shear": "shear, roll"}


def estimate_command(
    *,
    height: float,
    width: float,
    rope: float,
    loops: int,
    bar: float | None,
    bar_length: float | None,
    out: Path | None,
) -> None:
    """Print the estimate of an isolator, lengths in mm, and write its file to `out` if it is given."""
    lengths = {"height": height, "width": width, "rope": rope, "bar": bar, "bar-length": bar_length}
    for option, value in lengths.items():
        if value is not None:
            positive(f"--{option}", value, unit="mm")
    if out is not None:
        if out.suffix != ".toml":
            raise ValueError(f"`--out` must end with .toml, got {str(out)!r}.")
        check_writable(out)
    estimate = estimate_loop(
        height=1e-3 * height,
        width=1e-3 * width,
        rope=1e-3 * rope,
        loops=loops,
        bar=None if bar is None else 1e-3 * bar,
        bar_length=None if bar_length is None else 1e-3 * bar_length,
    )
    screen = console()
    print_table(values_table(estimate))
    for text in remarks(estimate):
        screen.print(escape(text))
    if out is not None:
        estimated_isolator(estimate).save(out)
        screen.print(f"written: {escape(str(out))}", soft_wrap=True)


def values_table(estimate: LoopEstimate) -> Table:
    """Return every estimated value beside the errors of such estimates."""
    errors = ("80 % of Enidine's\nwithin a factor", "worst\nfactor", "80 % of VMC's\nwithin a factor")
    columns = [Column("direction", align="left"), Column("value", align="left"), Column("estimate")]
    values = estimate.values
    rows = [("compression", "static load", "N", values.static_load, "static load")]
    for mode, direction in _MODES.items():
        rows.append((direction, "travel", "mm", values.travel[mode], f"{mode} travel"))
        rows.append((direction, "vibration stiffness", "N/mm", values.vibration[mode], f"{mode} vibration"))
        rows.append((direction, "shock stiffness", "N/mm", values.shock[mode], f"{mode} shock"))
    cells: list[list[Cell]] = []
    for direction, label, unit, value, name in rows:
        band = estimate.bands[name]
        factors = [None if error is None else 1.0 + error for error in (band.within, band.worst, band.other)]
        cells.append([direction, f"{label} [{unit}]", f"{in_unit(value, unit):.4g}", *factors])
    return Table(title="", columns=[*columns, *(Column(heading, form=".2f") for heading in errors)], rows=cells)


def remarks(estimate: LoopEstimate) -> list[str]:
    """Return the assumptions of the estimate, the source of its errors, and the rotational stiffness."""
    without = (
        "each estimated without itself"
        if estimate.left_out == "part"
        else "each estimated without all parts of its rope, because no part has the rope asked for"
    )
    lines = [
        f"Errors are those of the same estimate for the 50 parts of Enidine's table, {without}, and for VMC's parts, which it "
        "never saw; a factor of 1.2 means 1 / 1.2 to 1.2 times. Vibration stiffness in shear is the shock stiffness, as in "
        "Enidine's table. None of this was measured.",
    ]
    if estimate.bar_assumed:
        lines.append(
            f"Bars of {1e3 * estimate.bar:.3g} mm are assumed, as Enidine's parts of this rope have; --bar gives others."
        )
    about = zip(("roll", "shear", "axial"), estimate.rotation, strict=True)
    known = [f"{value:.4g} about the {axis} axis" for axis, value in about if math.isfinite(value)]
    more = "" if estimate.bar_length is not None else " The others need --bar-length."
    lines.append(
        f"Rotational stiffness of small vibration about mid-height [N m/rad]: {', '.join(known)}; no vendor states any to "
        f"compare with.{more}"
    )
    return lines
