"""Force-deflection loops of an isolator as a picture."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from wirerope_mj.bench import cyclic_test
from wirerope_mj.isolator import Isolator
from wirerope_mj.laws import Law

_SHARES = (0.25, 0.5, 1.0)
_UNRATED_SHARE = 0.05  # of the height, where no travel is rated: small enough for every mount
_UNRATED = 0.005  # [m], where not even the height is known
_COLOURS = ("#9ecae1", "#4292c6", "#08519c")
_RATED = "#d95f0e"


def loops_figure(isolator: Isolator, *, frequency: float = 5.0) -> Figure:
    """Return a figure with one panel for each axis: steady loops at 25, 50 and 100 % of the rated travel.

    The dashed line is the first loading. Orange marks are the rated travel on it and, in compression, the rated static
    load. Without a rated travel the largest loop is 5 % of the height. Axes that share their law share a panel.

    Args:
        isolator: what to draw.
        frequency: of the test [Hz]; without effect on a rate-independent law.
    """
    panels = _panels(isolator)
    figure = Figure(figsize=(5.6 * len(panels), 4.8), layout="constrained", dpi=120)
    figure.suptitle(isolator.name, fontsize=13, fontweight="bold")
    for place, (title, axis, law) in enumerate(panels):
        _draw(figure.add_subplot(1, len(panels), place + 1), isolator, title, axis, law, frequency)
    return figure


def save_loops(isolator: Isolator, path: str | Path, *, frequency: float = 5.0) -> None:
    """Write the picture of `loops_figure`; the file's ending says in which format."""
    loops_figure(isolator, frequency=frequency).savefig(path)


def _panels(isolator: Isolator) -> list[tuple[str, str, Law]]:
    """Return title, axis and law of each panel; roll and shear are one if they are the same in law and rating."""
    present = [(axis, law) for axis, law in isolator.axes.items() if law is not None]
    same = isolator.roll is not None and isolator.roll == isolator.shear
    if same and isolator.rated_travel("roll") == isolator.rated_travel("shear"):
        return [("roll and shear" if axis == "roll" else axis, axis, law) for axis, law in present if axis != "shear"]
    return [(axis, axis, law) for axis, law in present]


def _draw(panel: Any, isolator: Isolator, title: str, axis: str, law: Law, frequency: float) -> None:
    """Draw the loops of one axis."""
    below, above = isolator.rated_travel(axis)
    rated = max((travel for travel in (below, above) if travel is not None), default=None)
    height = isolator.geometry.height if isolator.geometry is not None else None
    largest = rated or (_UNRATED if height is None else _UNRATED_SHARE * height)
    for share, colour in zip(_SHARES, _COLOURS, strict=True):
        loop = cyclic_test(law, share * largest, frequency=frequency)[0]
        label = f"±{_tidy(1e3 * share * largest)} mm, ζ = {100.0 * loop.damping_ratio:.1f} %"
        panel.plot(1e3 * loop.deflection, loop.force / 1e3, color=colour, lw=1.6, label=label)
    if law.rate_independent:
        _draw_virgin(panel, law, largest, (below, above))
    if axis == "axial" and isolator.limits.static_load is not None and below is not None:
        _draw_load(panel, law, isolator.limits.static_load, below)
    panel.set_title(title if law.rate_independent else f"{title}, {frequency:g} Hz")
    panel.set_xlabel("deflection [mm], tension positive" if axis == "axial" else "deflection [mm]")
    panel.set_ylabel("force [kN]")
    panel.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    panel.axvline(0.0, color="0.6", lw=0.6, zorder=0)
    panel.grid(color="0.92", zorder=0)
    panel.set_axisbelow(True)
    panel.margins(0.08)
    panel.legend(fontsize=8, loc="upper left", framealpha=0.9)


def _draw_virgin(panel: Any, law: Law, largest: float, rated: tuple[float | None, float | None]) -> None:
    """Draw the first loading to both sides and mark the rated travel on it."""
    for sign, limit in zip((-1.0, 1.0), rated, strict=True):
        path = law.trace(sign * np.linspace(0.0, largest, 200))
        panel.plot(1e3 * path.deflection, path.force / 1e3, "--", color="0.25", lw=1.0)
        if limit is not None:
            end = law.trace([0.0, sign * limit])
            panel.plot(1e3 * end.deflection[-1], end.force[-1] / 1e3, "o", color=_RATED, ms=6, zorder=5)
    panel.plot([], [], "--", color="0.25", lw=1.0, label="first loading")
    if any(limit is not None for limit in rated):
        panel.plot([], [], "o", color=_RATED, ms=6, label="rated travel")


def _draw_load(panel: Any, law: Law, load: float, travel: float) -> None:
    """Mark where the first loading carries the rated static load, if it does within the rated travel."""
    path = law.trace(-np.linspace(0.0, travel, 2001))
    if -path.force[-1] >= load:
        depth = float(np.interp(load, -path.force, -path.deflection))
        label = f"rated load {load / 1e3:.3g} kN"
        panel.plot(-1e3 * depth, -load / 1e3, "s", color=_RATED, mfc="white", ms=7, zorder=6, label=label)


def _tidy(value: float) -> str:
    """Return a number to three digits without an exponent."""
    return f"{value:.3g}"
