"""Pictures of a fit: loops, residuals, and measures over the amplitude, measured against fitted."""

import math
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter, ScalarFormatter

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.result import FittedLoop
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import COLOURS

_MEASURED, _FITTED = "#08519c", "#d95f0e"
_MOST = 12  # panels of one figure: more cannot be read
_ACROSS = 3
_WEAK = 100.0  # [N], below which forces are read in N
_MARKERS = "osD^vP"
_BESIDE = 5  # operating points beside each other below the picture
_LETTERS = 8.5  # of a bold title in an inch


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
    panels[0][1].legend(fontsize=8, loc="best")  # a stop has its knee where other loops leave room
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
        for way, branch, colour in (("up", slice(0, top + 1), _MEASURED), ("down", slice(top, None), _FITTED)):
            panel.plot(path[branch], residual[branch], "o", color=colour, ms=2.5, mew=0.0, alpha=0.4)
            panel.plot(*_running_mean(path[branch], residual[branch]), color=colour, lw=1.6, label=f"on the way {way}")
        panel.axhline(0.0, color="0.3", lw=0.7, zorder=1)
        panel.set_title(_name(fit, fits), fontsize=10)
        panel.set_ylabel("fitted - measured\n[% of half its range]")
    panels[0][1].legend(fontsize=8, loc="upper left")
    return figure


def measures_figure(fits: Sequence[FittedLoop], *, title: str) -> Figure:
    """Return a figure of energy per cycle and secant stiffness over the amplitude: measured as marks, fitted as crosses.

    Each operating point has a mark and a colour of its own. Fitted values stand at the measured amplitudes, where they were
    compared.

    Args:
        fits: loops of a fit.
        title: of the figure.
    """
    figure = PlainFigure(figsize=(10.2, 4.4), layout="constrained", dpi=120)
    _entitle(figure, title)
    energy, stiffness = figure.subplots(1, 2)
    groups = _groups(fits)
    for index, group in enumerate(groups):
        marker = _MARKERS[index % len(_MARKERS)]
        colours = (_MEASURED, _FITTED) if len(groups) == 1 else 2 * (COLOURS[index % len(COLOURS)],)
        about = "" if len(groups) == 1 else f" about {_millimetres(group)} mm"
        _draw(energy, group, "energy", 1.0, marker, colours, about)
        _draw(stiffness, group, "secant_stiffness", 1e-3, marker, colours, about)
    if any(fit.energy(fit.measured) > 0.0 for fit in fits):  # that of a device without loss is noise of either sign
        energy.set_yscale("log")
        energy.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        energy.yaxis.set_major_formatter(FormatStrFormatter("%g"))  # that of logarithmic axes writes formulas
        energy.yaxis.set_minor_formatter(NullFormatter())
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
    if len(groups) == 1:
        energy.legend(fontsize=8)
    else:
        lines = energy.get_legend_handles_labels()
        figure.legend(*lines, fontsize=8, loc="outside lower center", ncols=min(len(groups), _BESIDE))
    return figure


def _panels(
    fits: Sequence[FittedLoop], title: str, *, height: float, sharey: bool = False
) -> tuple[Figure, list[tuple[FittedLoop, Any]]]:
    """Return a figure with loops and their panels over the deflection."""
    chosen = [fits[i] for i in np.unique(np.linspace(0, len(fits) - 1, min(len(fits), _MOST)).round().astype(int))]
    across = min(len(chosen), _ACROSS)
    down = math.ceil(len(chosen) / across)
    left_out = f" ({len(chosen)} of {len(fits)} loops)" if len(chosen) < len(fits) else ""
    figure = PlainFigure(figsize=(0.6 + 3.7 * across, 0.9 + height * down), layout="constrained", dpi=120)
    _entitle(figure, title + left_out)
    pairs: list[tuple[FittedLoop, Any]] = []
    for index, fit in enumerate(chosen):
        first = pairs[0][1] if sharey and pairs else None
        panel = figure.add_subplot(down, across, index + 1, sharey=first)
        panel.set_xlabel("deflection [mm]")
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
        pairs.append((fit, panel))
    return figure, pairs


def _running_mean(x: Array, y: Array) -> tuple[Array, Array]:
    """Return the mean over a ninth of the samples, where there are as many on both sides."""
    weights = np.full(max(x.size // 9, 1), 1.0 / max(x.size // 9, 1))
    return np.convolve(x, weights, "valid"), np.convolve(y, weights, "valid")


def _draw(
    panel: Any, group: Sequence[FittedLoop], measure: str, size: float, marker: str, colours: Sequence[str], about: str
) -> None:
    """Draw a measure of loops about one operating point, measured and fitted in their colours."""
    amplitudes = [1e3 * fit.amplitude for fit in group]
    measured = [size * getattr(fit, measure)(fit.measured) for fit in group]
    fitted = [size * getattr(fit, measure)(fit.fitted) for fit in group]
    panel.plot(amplitudes, fitted, "-x", color=colours[1], lw=1.0, ms=7, label=f"fitted{about}", zorder=3)
    panel.plot(amplitudes, measured, marker, color=colours[0], mfc="none", ms=7, label=f"measured{about}", zorder=4)


def _entitle(figure: Figure, title: str) -> None:
    """Write a title over a figure, on as many lines as it needs."""
    lines = textwrap.wrap(title, int(_LETTERS * figure.get_figwidth()), break_on_hyphens=False)
    figure.suptitle("\n".join(lines), fontsize=12, fontweight="bold")


def _groups(fits: Sequence[FittedLoop]) -> list[list[FittedLoop]]:
    """Return the loops of each operating point, from compression to tension.

    Points within 2 % of the largest amplitude are one, as no rig holds them better beside noise.
    """
    step = 0.02 * max(fit.amplitude for fit in fits)
    groups: list[list[FittedLoop]] = []
    for fit in sorted(fits, key=lambda fit: fit.operating_point):
        if groups and fit.operating_point - groups[-1][0].operating_point <= step:
            groups[-1].append(fit)
        else:
            groups.append([fit])
    return [sorted(group, key=lambda fit: fit.amplitude) for group in groups]


def _millimetres(group: Sequence[FittedLoop]) -> str:
    """Return the mean operating point of a group in mm; a thousandth of its largest amplitude is noise."""
    least = 1e-3 * max(1e3 * fit.amplitude for fit in group)
    mean = 1e3 * float(np.mean([fit.operating_point for fit in group]))
    return f"{least * round(mean / least):.3g}" if abs(mean) > least else "0"


def _name(fit: FittedLoop, fits: Sequence[FittedLoop]) -> str:
    """Return amplitude and, where there are several, operating point as text."""
    groups = _groups(fits)
    own = next(group for group in groups if any(fit is other for other in group))
    about = "" if len(groups) == 1 else f" about {_millimetres(own)}"
    return f"±{1e3 * fit.amplitude:.3g}{about} mm"
