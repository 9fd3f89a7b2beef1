"""Force-deflection loops of periodic motions along a resonance, level by level."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

from wirerope_mj.dynamics.frequency_response.curve import along_resonance, busiest_loops
from wirerope_mj.dynamics.periodic import Branch, PeriodicOrbit
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.views.plots.plain_figure import PlainFigure

_MOST = 4  # panels: from the lowest level to the highest
_WEAK = 1000.0  # [N], below which forces are read in N


def save_resonance_loops(branches: Sequence[Branch], path: Path, *, title: str) -> None:
    """Write a picture of the loop that takes most energy at some points along the resonance, one panel for each level."""
    indices = np.unique(np.linspace(0, len(branches) - 1, min(len(branches), _MOST)).round().astype(int))
    chosen = [branches[i] for i in indices]
    across = 2 if len(chosen) == 4 else len(chosen)
    down = -(-len(chosen) // across)
    figure = PlainFigure(figsize=(0.6 + 5.4 * across, 1.0 + 4.9 * down), layout="constrained", dpi=120)
    mount, axis = busiest_loops(chosen[-1].orbit(chosen[-1].peak).response)[0]
    device = branches[0].system.mounts[mount].isolator.name
    figure.suptitle(f"{title}\n{mount}, {device}, {AXES[axis]}", fontsize=12, fontweight="bold")
    for number, branch in enumerate(chosen):
        _draw(figure.add_subplot(down, across, number + 1), branch, mount, axis)
    figure.savefig(path)


def _draw(panel: Any, branch: Branch, mount: str, axis: int) -> None:
    points = along_resonance(branch)
    orbits = [branch.orbit(point) for point in points]
    force = [orbit.response.mounts[mount].force[:, axis] for orbit in orbits]
    weak = max(float(np.abs(series).max()) for series in force) < _WEAK
    top = points.index(branch.peak)
    for number, (orbit, series) in enumerate(zip(orbits, force, strict=True)):
        deflection = in_unit(orbit.response.mounts[mount].deflection[:, axis], "mm")
        panel.plot(
            deflection, series if weak else in_unit(series, "kN"), color=_colour(number, top, len(points)),
            lw=1.8 if number == top else 1.2, ls="-" if orbit.stable else (0, (3.0, 2.0)), label=_label(orbit, number == top),
        )  # fmt: skip
    panel.set_title(f"{abs(float(branch.acceleration[0])):.4g} m/s²", fontsize=11)
    panel.set_xlabel("deflection [mm], tension positive" if AXES[axis] == "axial" else "deflection [mm]")
    panel.set_ylabel(f"force [{'N' if weak else 'kN'}]")
    panel.grid(color="0.92")
    panel.set_axisbelow(True)
    panel.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3, frameon=False)


def _colour(number: int, top: int, count: int) -> Any:
    """Return blue before the peak and orange behind it, deeper near it, and black at the peak."""
    if number == top:
        return "black"
    before = number < top
    away = (top - number) / max(top, 1) if before else (number - top) / max(count - 1 - top, 1)
    return matplotlib.colormaps["Blues" if before else "Oranges"](0.95 - 0.4 * away)


def _label(orbit: PeriodicOrbit, highest: bool) -> str:
    suffix = " highest" if highest else ""
    return f"{orbit.frequency:.4g} Hz{suffix}" + ("" if orbit.stable else ", unstable")
