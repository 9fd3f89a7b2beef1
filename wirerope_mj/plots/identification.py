"""Pictures of a fit: loops, residuals, and measures over the amplitude, measured against fitted."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from wirerope_mj.identification.fitted import FittedLoop

Array = npt.NDArray[np.float64]

_MEASURED, _FITTED = "#08519c", "#d95f0e"
_MOST = 12  # panels of one figure: more cannot be read
_ACROSS = 3
_WEAK = 100.0  # [N], below which forces are read in N
_MARKERS = "osD^vP"


def fit_figure(fits: Sequence[FittedLoop], *, title: str) -> Figure:
    """Return a figure with a panel for each loop, smallest first: measured as dots, fitted as a line.

    Of more than twelve loops, twelve from the smallest to the largest are drawn.

    Args:
        fits: loops of a fit.
        title: of the figure.
    """
    figure, panels = _panels(fits, title, height=3.1)
    for fit, panel in panels:
        weak = float(np.abs(fit.measured).max()) < _WEAK
        unit, size = ("N", 1.0) if weak else ("kN", 1e-3)
        panel.plot(1e3 * fit.deflection, size * fit.measured, "o", color=_MEASURED, ms=3.2, mew=0.0, label="measured")
        panel.plot(1e3 * fit.deflection, size * fit.fitted, color=_FITTED, lw=1.0, label="fitted")
        panel.set_title(f"{_name(fit, fits)}: {100.0 * fit.error:.2g} % of half its range", fontsize=10)
        panel.set_ylabel(f"force [{unit}]")
    panels[0][1].legend(fontsize=8, loc="upper left")
    return figure


def residual_figure(fits: Sequence[FittedLoop], *, title: str) -> Figure:
    """Return a figure with a panel for each loop, smallest first: fitted minus measured force over the deflection.

    Dots are the samples, lines their mean over a ninth of each branch. A law that fits leaves noise, whose mean is zero
    everywhere; what bends is what the law cannot do.

    Args:
        fits: loops of a fit.
        title: of the figure.
    """
    figure, panels = _panels(fits, title, height=2.6, sharey=True)
    for fit, panel in panels:
        start = int(np.argmin(fit.deflection[:-1]))
        path, residual = (np.roll(values[:-1], -start) for values in (1e3 * fit.deflection, 100.0 * fit.residual))
        top = int(np.argmax(path))
        for way, part, colour in (("up", slice(0, top + 1), _MEASURED), ("down", slice(top, None), _FITTED)):
            panel.plot(path[part], residual[part], "o", color=colour, ms=2.5, mew=0.0, alpha=0.4)
            panel.plot(*_running_mean(path[part], residual[part]), color=colour, lw=1.6, label=f"on the way {way}")
        panel.axhline(0.0, color="0.3", lw=0.7, zorder=1)
        panel.set_title(_name(fit, fits), fontsize=10)
        panel.set_ylabel("fitted - measured\n[% of half its range]")
    panels[0][1].legend(fontsize=8, loc="upper left")
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


def _panels(
    fits: Sequence[FittedLoop], title: str, *, height: float, sharey: bool = False
) -> tuple[Figure, list[tuple[FittedLoop, Any]]]:
    """Return a figure with loops and their panels over the deflection."""
    chosen = [fits[i] for i in np.unique(np.linspace(0, len(fits) - 1, min(len(fits), _MOST)).round().astype(int))]
    across = min(len(chosen), _ACROSS)
    down = math.ceil(len(chosen) / across)
    left_out = f" ({len(chosen)} of {len(fits)} loops)" if len(chosen) < len(fits) else ""
    figure = Figure(figsize=(0.6 + 3.7 * across, 0.9 + height * down), layout="constrained", dpi=120)
    figure.suptitle(title + left_out, fontsize=12, fontweight="bold")
    pairs: list[tuple[FittedLoop, Any]] = []
    for place, fit in enumerate(chosen):
        first = pairs[0][1] if sharey and pairs else None
        panel = figure.add_subplot(down, across, place + 1, sharey=first)
        panel.set_xlabel("deflection [mm]")
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
        pairs.append((fit, panel))
    return figure, pairs


def _running_mean(x: Array, y: Array) -> tuple[Array, Array]:
    """Return the mean over a ninth of the samples, where there are as many on both sides."""
    weights = np.full(max(x.size // 9, 1), 1.0 / max(x.size // 9, 1))
    return np.convolve(x, weights, "valid"), np.convolve(y, weights, "valid")


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
