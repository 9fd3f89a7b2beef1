"""Pictures of a fit: loops, residuals, and measures over the amplitude, measured against fitted."""

import math
from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from wirerope_mj.identification.fitted import FittedLoop

_MEASURED, _FITTED = "#08519c", "#d95f0e"
_MOST = 12  # panels of one figure: more cannot be read
_ACROSS = 3
_WEAK = 100.0  # [N], below which forces are read in N
_MARKERS = "osD^vP"


def fit_figure(fits: Sequence[FittedLoop], *, title: str) -> Figure:
    """Return a figure with a panel for each loop, smallest first: measured blue, fitted orange.

    Of more than twelve loops, twelve from the smallest to the largest are drawn.

    Args:
        fits: loops of a fit.
        title: of the figure.
    """
    chosen = [fits[i] for i in np.unique(np.linspace(0, len(fits) - 1, min(len(fits), _MOST)).round().astype(int))]
    across = min(len(chosen), _ACROSS)
    down = math.ceil(len(chosen) / across)
    left_out = f" ({len(chosen)} of {len(fits)} loops)" if len(chosen) < len(fits) else ""
    figure = Figure(figsize=(0.6 + 3.7 * across, 0.9 + 3.1 * down), layout="constrained", dpi=120)
    figure.suptitle(title + left_out, fontsize=12, fontweight="bold")
    for place, fit in enumerate(chosen):
        panel = figure.add_subplot(down, across, place + 1)
        weak = float(np.abs(fit.measured).max()) < _WEAK
        unit, size = ("N", 1.0) if weak else ("kN", 1e-3)
        panel.plot(1e3 * fit.deflection, size * fit.measured, color=_MEASURED, lw=0.9, label="measured")
        panel.plot(1e3 * fit.deflection, size * fit.fitted, color=_FITTED, lw=1.3, label="fitted")
        panel.set_title(f"{_name(fit, fits)}: {100.0 * fit.error:.2g} % of half its range", fontsize=10)
        panel.set_xlabel("deflection [mm]")
        panel.set_ylabel(f"force [{unit}]")
        panel.grid(color="0.92")
        if place == 0:
            panel.legend(fontsize=8, loc="upper left")
    return figure


def residual_figure(fits: Sequence[FittedLoop], *, title: str) -> Figure:
    """Return a figure of fitted minus measured force over the deflection: on the way up, and on the way down.

    Deflections count from the operating point, over the amplitude, so that loops of all sizes lie above each other. A law that
    fits leaves noise; what bends together is what the law cannot do.

    Args:
        fits: loops of a fit.
        title: of the figure.
    """
    figure = Figure(figsize=(10.6, 4.6), layout="constrained", dpi=120)
    figure.suptitle(title, fontsize=12, fontweight="bold")
    panels = figure.subplots(1, 2, sharey=True)
    shades = matplotlib.colormaps["viridis_r"](np.linspace(0.1, 1.0, len(fits)))
    labelled = set(np.linspace(0, len(fits) - 1, min(len(fits), 8)).round().astype(int))
    for index, (fit, colour) in enumerate(zip(fits, shades, strict=True)):
        share = (fit.deflection - fit.operating_point) / fit.amplitude
        bottom = int(np.argmin(share[:-1]))
        share, residual = np.roll(share[:-1], -bottom), 100.0 * np.roll(fit.residual[:-1], -bottom)
        top = int(np.argmax(share))
        label = _name(fit, fits) if index in labelled else None
        panels[0].plot(share[: top + 1], residual[: top + 1], color=colour, lw=1.0, label=label)
        panels[1].plot(np.append(share[top:], share[0]), np.append(residual[top:], residual[0]), color=colour, lw=1.0)
    for panel, way in zip(panels, ("on the way up", "on the way down"), strict=True):
        panel.set_title(way, fontsize=10)
        panel.set_xlabel("deflection from the operating point / amplitude [-]")
        panel.axhline(0.0, color="0.4", lw=0.7)
        panel.grid(color="0.92")
    panels[0].set_ylabel("fitted - measured force\n[% of half the loop's range]")
    figure.legend(fontsize=8, loc="outside right upper")
    return figure


def measures_figure(fits: Sequence[FittedLoop], *, title: str) -> Figure:
    """Return a figure of energy per cycle and secant stiffness over the amplitude: measured as marks, fitted as crosses.

    Operating points have their own marks. Fitted values stand at the measured amplitudes, where they were compared.

    Args:
        fits: loops of a fit.
        title: of the figure.
    """
    figure = Figure(figsize=(10.2, 4.4), layout="constrained", dpi=120)
    figure.suptitle(title, fontsize=12, fontweight="bold")
    energy, stiffness = figure.subplots(1, 2)
    points = _operating_points(fits)
    for point, marker in zip(points, (_MARKERS * len(points))[: len(points)], strict=True):
        group = [fit for fit in fits if _point(fit, fits) == point]
        about = "" if len(points) == 1 else f" about {point:g} mm"
        _draw(energy, group, "energy", 1.0, marker, about)
        _draw(stiffness, group, "secant_stiffness", 1e-3, marker, about)
    energy.set_yscale("log")
    energy.set_ylabel("energy per cycle [J]")
    stiffness.set_ylabel("secant stiffness [kN/m]")
    stiffness.set_ylim(bottom=0.0)
    for panel in (energy, stiffness):
        panel.set_xscale("log")
        panel.set_xlabel("amplitude [mm]")
        panel.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        panel.xaxis.set_major_formatter(ScalarFormatter())
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.grid(color="0.92", which="both")
        panel.set_axisbelow(True)
        panel.margins(x=0.08)
    energy.legend(fontsize=8)
    return figure


def _draw(panel: Any, group: Sequence[FittedLoop], measure: str, size: float, marker: str, about: str) -> None:
    """Draw a measure of loops about one operating point."""
    amplitudes = [1e3 * fit.amplitude for fit in group]
    measured = [size * getattr(fit, measure)(fit.measured) for fit in group]
    fitted = [size * getattr(fit, measure)(fit.fitted) for fit in group]
    panel.plot(amplitudes, fitted, "-x", color=_FITTED, lw=1.0, ms=7, label=f"fitted{about}", zorder=3)
    panel.plot(amplitudes, measured, marker, color=_MEASURED, mfc="none", ms=7, label=f"measured{about}", zorder=4)


def _operating_points(fits: Sequence[FittedLoop]) -> list[float]:
    return sorted({_point(fit, fits) for fit in fits})


def _point(fit: FittedLoop, fits: Sequence[FittedLoop]) -> float:
    """Return a loop's operating point [mm], to 2 % of the largest amplitude, as no rig holds it better beside noise."""
    step = 20.0 * max(other.amplitude for other in fits)
    return float(f"{step * round(1e3 * fit.operating_point / step):.3g}") + 0.0


def _name(fit: FittedLoop, fits: Sequence[FittedLoop]) -> str:
    """Return amplitude and, where there are several, operating point in words."""
    about = "" if len(_operating_points(fits)) == 1 else f" about {_point(fit, fits):g}"
    return f"±{1e3 * fit.amplitude:.3g}{about} mm"
