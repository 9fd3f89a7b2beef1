"""Force-deflection loops as a picture: of an isolator with its ratings, or of any cyclic tests."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.amplitudes import amplitudes_of, distinct_axes, largest_amplitude
from wirerope_mj.mounts.laws import Law, Loop
from wirerope_mj.mounts.test_rig import cyclic_test
from wirerope_mj.views.plots.plain_figure import PlainFigure

_FRACTIONS = (0.25, 0.5, 1.0)
_RATED = "#d95f0e"
_MOST_LABELS = 8  # in a legend: more would hide the loops
_WEAK = 100.0  # [N], below which forces are read in N


def loops_figure(isolator: Isolator, *, frequency: float = 5.0) -> Figure:
    """Return a figure with one panel for each axis: steady loops at 25, 50 and 100 % of the rated travel.

    The dashed line is the first loading. Orange marks are the rated travel on it and, in compression, the rated static
    load. Without a rated travel the largest loop is 5 % of the height, beyond the gap of a stop,
    or the whole of a table. Axes that share their law share a panel.

    Args:
        isolator: what to draw.
        frequency: of the test [Hz]; without effect on a rate-independent law.
    """
    panels = distinct_axes(isolator)
    figure, subplots = _figure(isolator.name, len(panels))
    for panel, (title, axis, law) in zip(subplots, panels, strict=True):
        loops = cyclic_test(law, amplitudes_of(isolator, axis, _FRACTIONS), frequency=frequency)
        _draw_loops(panel, loops, kilo=True)
        _draw_ratings(panel, isolator, axis, law)
        _dress(panel, axis, title if law.rate_independent else f"{title}, {frequency:g} Hz")
    return figure


def save_loops(isolator: Isolator, path: str | Path, *, frequency: float = 5.0) -> None:
    """Write the picture of `loops_figure`; the file's ending says in which format."""
    _save(loops_figure(isolator, frequency=frequency), Path(path))


def cyclic_tests_figure(tests: Mapping[str, Sequence[Loop]], *, title: str) -> Figure:
    """Return a figure with one panel for each test: its loops in deepening blue, as they were run or measured.

    Args:
        tests: loops by the title of their panel; one that begins with "axial" says that tension is positive.
        title: of the figure.
    """
    figure, subplots = _figure(title, len(tests))
    for panel, (name, loops) in zip(subplots, tests.items(), strict=True):
        kilo = max(float(np.abs(loop.force).max()) for loop in loops) >= _WEAK
        _draw_loops(panel, sorted(loops, key=lambda loop: loop.amplitude), kilo=kilo)
        _dress(panel, name.split()[0].rstrip(","), name, unit="kN" if kilo else "N")
    return figure


def save_cyclic_tests(tests: Mapping[str, Sequence[Loop]], path: str | Path, *, title: str) -> None:
    """Write the picture of `cyclic_tests_figure`; the file's ending says in which format."""
    _save(cyclic_tests_figure(tests, title=title), Path(path))


def _save(figure: Figure, path: Path) -> None:
    """Write a picture whole or not at all."""
    with atomic_file(path) as beside:
        figure.savefig(beside)


def _figure(title: str, panels: int) -> tuple[Figure, list[Any]]:
    figure = PlainFigure(figsize=(5.6 * panels, 4.8), layout="constrained", dpi=120)
    figure.suptitle(title, fontsize=13, fontweight="bold")
    return figure, [figure.add_subplot(1, panels, number + 1) for number in range(panels)]


def _draw_loops(panel: Any, loops: Sequence[Loop], *, kilo: bool) -> None:
    """Draw loops from light to dark blue, each with its amplitude and damping ratio."""
    shades = matplotlib.colormaps["Blues"](np.linspace(0.4, 0.95, len(loops)))
    labelled = set(np.linspace(0, len(loops) - 1, min(len(loops), _MOST_LABELS)).round().astype(int))
    for index, (loop, colour) in enumerate(zip(loops, shades, strict=True)):
        ratio, size = loop.damping_ratio, f"±{_tidy(in_unit(loop.amplitude, 'mm'))} mm"
        label = f"{size}, within the gap" if math.isnan(ratio) else f"{size}, ζ = {in_unit(ratio, '%'):.1f} %"
        force = in_unit(loop.force, "kN") if kilo else loop.force
        panel.plot(
            in_unit(loop.deflection, "mm"), force, color=colour, lw=1.6, label=label if index in labelled else None
        )


def _dress(panel: Any, axis: str, title: str, *, unit: str = "kN") -> None:
    """Give a panel its title, axes, zero lines and legend."""
    panel.set_title(title)
    panel.set_xlabel("deflection [mm], tension positive" if axis == "axial" else "deflection [mm]")
    panel.set_ylabel(f"force [{unit}]")
    panel.axhline(0.0, color="0.6", lw=0.6, zorder=1)
    panel.axvline(0.0, color="0.6", lw=0.6, zorder=1)
    panel.grid(color="0.92", zorder=0)
    panel.set_axisbelow(True)
    panel.margins(0.08)
    panel.legend(fontsize=8, loc="best", framealpha=0.9)


def _draw_ratings(panel: Any, isolator: Isolator, axis: str, law: Law) -> None:
    """Draw the first loading with the rated travel and the rated static load on it."""
    below, above = isolator.rated_travel(axis)
    if law.rate_independent:
        _draw_virgin(panel, law, largest_amplitude(isolator, axis), (below, above))
    if axis == "axial" and isolator.limits.static_load is not None and below is not None:
        _draw_load(panel, law, isolator.limits.static_load, below)


def _draw_virgin(panel: Any, law: Law, largest: float, rated: tuple[float | None, float | None]) -> None:
    """Draw the first loading to both sides and mark the rated travel on it."""
    for sign, limit in zip((-1.0, 1.0), rated, strict=True):
        path = law.trace(sign * np.linspace(0.0, largest, 200))
        panel.plot(in_unit(path.deflection, "mm"), in_unit(path.force, "kN"), "--", color="0.25", lw=1.0)
        if limit is not None:
            end = law.trace([0.0, sign * limit])
            panel.plot(
                in_unit(end.deflection[-1], "mm"), in_unit(end.force[-1], "kN"), "o", color=_RATED, ms=6, zorder=5
            )
    panel.plot([], [], "--", color="0.25", lw=1.0, label="first loading")
    if any(limit is not None for limit in rated):
        panel.plot([], [], "o", color=_RATED, ms=6, label="rated travel")


def _draw_load(panel: Any, law: Law, load: float, travel: float) -> None:
    """Mark where the first loading carries the rated static load, if it does within the rated travel."""
    path = law.trace(-np.linspace(0.0, travel, 2001))
    if -path.force[-1] >= load:
        depth = float(np.interp(load, -path.force, -path.deflection))
        label = f"rated load {in_unit(load, 'kN'):.3g} kN"
        panel.plot(
            -in_unit(depth, "mm"), -in_unit(load, "kN"), "s", color=_RATED, mfc="white", ms=7, zorder=6, label=label
        )


def _tidy(value: float) -> str:
    """Return a number to three digits, or whole, without an exponent."""
    return f"{value:.3g}" if value < 1000.0 else f"{value:.0f}"
