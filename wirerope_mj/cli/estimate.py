"""`wirerope isolators estimate`: the figures of an isolator without data sheet, beside the errors of such estimates."""

import math
from pathlib import Path

from rich import box
from rich.markup import escape
from rich.table import Table

from wirerope_mj.cli.screen import console
from wirerope_mj.foundation.atomic_files import check_writable
from wirerope_mj.mounts.estimate import LoopEstimate, estimate_loop, estimated_isolator

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
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"`--{option}` must be a finite number > 0 [mm], got {value:g}.")
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
    screen.print(figures_table(estimate))
    for sentence in sentences(estimate):
        screen.print(escape(sentence))
    if out is not None:
        estimated_isolator(estimate).save(out)
        screen.print(f"written: {escape(str(out))}", soft_wrap=True)


def figures_table(estimate: LoopEstimate) -> Table:
    """Return every estimated figure beside the errors of such estimates."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("direction", "figure"):
        table.add_column(name)
    headings = ("estimate", "80 % of Enidine's\nwithin a factor", "worst\nfactor", "80 % of VMC's\nwithin a factor")
    for heading in headings:
        table.add_column(escape(heading), justify="right")
    figures = estimate.figures
    rows = [("compression", "static load [N]", figures.static_load, "static load")]
    for mode, words in _MODES.items():
        rows.append((words, "travel [mm]", 1e3 * figures.travel[mode], f"{mode} travel"))
        rows.append((words, "vibration stiffness [N/mm]", 1e-3 * figures.vibration[mode], f"{mode} vibration"))
        rows.append((words, "shock stiffness [N/mm]", 1e-3 * figures.shock[mode], f"{mode} shock"))
    for words, label, value, name in rows:
        band = estimate.bands[name]
        other = "-" if band.other is None else f"{1.0 + band.other:.2f}"
        errors = (f"{1.0 + band.within:.2f}", f"{1.0 + band.worst:.2f}", other)
        table.add_row(words, escape(label), f"{value:.4g}", *errors)
    return table


def sentences(estimate: LoopEstimate) -> list[str]:
    """Return what the estimate assumes, how its errors were found, and the rotational stiffness."""
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
    about = dict(zip(("roll", "shear", "axial"), estimate.rotation, strict=True))
    known = [f"{value:.4g} about the {axis} axis" for axis, value in about.items() if math.isfinite(value)]
    more = "" if estimate.bar_length is not None else " The others need --bar-length."
    lines.append(
        f"Rotational stiffness of small vibration about mid-height [N m/rad]: {', '.join(known)}; no vendor states any to "
        f"compare with.{more}"
    )
    return lines
