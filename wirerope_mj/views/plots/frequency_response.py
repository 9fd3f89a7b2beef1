"""Frequency responses as pictures: amplitude and transmissibility over frequency on logarithmic axes."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from wirerope_mj.dynamics.frequency_response.curve import BranchCurve
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary, OrderBand
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import COLOURS, round_ticks

_MARKS = {"fold": "o", "period doubling": "s", "Neimark-Sacker": "D", "symmetry breaking": "X"}
_MARKED = 24
"""Marks along an envelope: enough to tell its way, few enough to see the branch below."""


def save_amplitudes(
    findings: Sequence[LevelSummary], path: Path, *, title: str, what: str, bands: Sequence[OrderBand] = ()
) -> None:
    """Write a picture of the payload's largest acceleration over frequency, all levels; `what` says whose it is."""
    figure = _figure(findings, title, f"largest acceleration of {what} [m/s²]", lambda level: 1.0, bands)
    figure.savefig(path)


def save_transmissibilities(
    findings: Sequence[LevelSummary], path: Path, *, title: str, what: str, bands: Sequence[OrderBand] = ()
) -> None:
    """Write a picture of the same over the base's acceleration."""
    figure = _figure(findings, title, f"transmissibility of {what} [-]", lambda level: 1.0 / level, bands)
    figure.savefig(path)


def colour_of(number: int) -> str:
    """Return the colour of a level, by its number."""
    return COLOURS[number % len(COLOURS)]


def _figure(
    findings: Sequence[LevelSummary],
    title: str,
    label: str,
    factor: Callable[[float], float],
    bands: Sequence[OrderBand],
) -> Figure:
    """Return a figure; `factor` of a level is what amplitudes are multiplied by."""
    figure = PlainFigure(figsize=(11.0, 6.6), layout="constrained", dpi=120)
    figure.suptitle(title, fontsize=12, fontweight="bold")
    panel = figure.add_subplot()
    panel.set_xscale("log")
    panel.set_yscale("log")
    drawn: list[Array] = []
    for number, summary in enumerate(findings):
        drawn += _level(panel, summary, colour_of(number), factor(summary.level.acceleration))
    _backbone(panel, findings, factor)
    _dress(panel, np.concatenate(drawn, axis=1), label)
    _draw_bands(panel, bands)
    figure.legend(handles=_legend(findings), loc="outside right upper", fontsize=9, frameon=False)
    return figure


def _draw_bands(panel: Any, bands: Sequence[OrderBand]) -> None:
    """Shade the frequencies of a machine's orders that lie in the range, each with its name at the upper edge."""
    left, right = panel.get_xlim()
    for number, band in enumerate(bands):
        low, high = max(band.low, left), min(band.high, right)
        if low > high:
            continue
        panel.axvspan(low, high, color="0.5", alpha=0.15, lw=1.0 if low == high else 0.0, zorder=1)
        overlapped = sum(other.low <= band.high and band.low <= other.high for other in bands[:number])
        height = 0.985 - 0.035 * overlapped
        panel.text(
            (low * high) ** 0.5, height, band.label, transform=panel.get_xaxis_transform(), ha="center", va="top",
            fontsize=9, color="0.25",
        )  # fmt: skip


def _level(panel: Any, summary: LevelSummary, colour: str, factor: float) -> list[Array]:
    """Draw a level; return frequency and value of what was drawn, (2, n) each."""
    drawn = []
    for way, sweep in summary.level.sweeps.items():
        f, a = sweep.frequency, factor * sweep.amplitude
        panel.plot(f, a, color=colour, lw=0.6, alpha=0.6, zorder=2)
        marks = _evenly(f, _MARKED, 0.0 if way == "up" else 0.5)
        marker = "^" if way == "up" else "v"
        panel.plot(f[marks], a[marks], marker, color=colour, ms=4, mfc="none", mew=0.7, zorder=2)
        drawn.append(np.stack([f, a]))
    branch, curve = summary.level.branch, summary.curve
    if branch is None or curve is None:
        return drawn
    for stable, part in segments(curve):
        style = {"ls": "-", "lw": 1.7} if stable else {"ls": (0, (3.0, 2.0)), "lw": 1.4}
        panel.plot(curve.frequency[part], factor * curve.amplitude[part], color=colour, zorder=3, **style)
    for event in branch.bifurcations:
        at = (event.frequency, factor * event.amplitude)
        panel.plot(*at, _MARKS[event.kind], color=colour, mfc="white", ms=7, mew=1.3, zorder=5)
    return [*drawn, np.stack([curve.frequency, factor * curve.amplitude])]


def segments(curve: BranchCurve) -> list[tuple[bool, slice]]:
    """Return the segments of a curve that are alike in stability, each with the first point of the next."""
    changes = np.flatnonzero(np.diff(curve.stable)) + 1
    ends = [0, *changes.tolist(), curve.stable.size - 1]
    return [(bool(curve.stable[a]), slice(a, b + 1)) for a, b in zip(ends[:-1], ends[1:], strict=True) if b > a]


def _evenly(frequency: Array, number: int, shift: float) -> npt.NDArray[np.int64]:
    """Return about `number` rows that stand evenly along a logarithmic axis."""
    along = np.log(frequency)
    low, high = sorted((along[0], along[-1]))
    wanted = low + (np.arange(number) + shift) / number * (high - low)
    return np.unique([int(np.abs(along - at).argmin()) for at in wanted])


def _backbone(panel: Any, findings: Sequence[LevelSummary], factor: Callable[[float], float]) -> None:
    """Draw the line through the highest peaks of all levels."""
    tops = _tops(findings)
    if len(tops) > 1:
        f, a = np.array([[f, factor(level) * a] for level, f, a in tops]).T
        panel.plot(f, a, color="0.25", lw=1.0, ls=(0, (1.0, 1.5)), marker=".", ms=5, zorder=4)


def _tops(findings: Sequence[LevelSummary]) -> list[tuple[float, float, float]]:
    """Return level, frequency and amplitude of the highest peak of every level that has one inside the range."""
    return [
        (summary.level.acceleration, summary.peaks[0].frequency, summary.peaks[0].amplitude)
        for summary in findings
        if summary.peaks and not summary.peaks[0].at_edge
    ]


def _dress(panel: Any, drawn: Array, label: str) -> None:
    """Give the axes ranges that hold everything, round numbers, and names."""
    for axis, values, room in ((panel.xaxis, drawn[0], 1.01), (panel.yaxis, drawn[1], 1.12)):
        low, high = values.min() / room, values.max() * room
        round_ticks(axis, low, high)
        (panel.set_xlim if axis is panel.xaxis else panel.set_ylim)(low, high)
    panel.set_xlabel("frequency of the base [Hz]")
    panel.set_ylabel(label)
    panel.grid(color="0.9")
    panel.set_axisbelow(True)


def _legend(findings: Sequence[LevelSummary]) -> list[Line2D]:
    """Return entries for what is there: levels first, then lines, then marks."""
    entries = [
        Line2D([], [], color=colour_of(n), lw=2.5, label=f"{summary.level.acceleration:.4g} m/s²")
        for n, summary in enumerate(findings)
    ]
    curves = [summary.curve for summary in findings if summary.curve is not None]
    grey: dict[str, Any] = {"color": "0.35"}
    if any(curve.stable.any() for curve in curves):
        entries.append(Line2D([], [], lw=1.7, label="stable motion", **grey))
    if any(not curve.stable.all() for curve in curves):
        entries.append(Line2D([], [], lw=1.4, ls=(0, (3.0, 2.0)), label="unstable motion", **grey))
    if len(_tops(findings)) > 1:
        entries.append(Line2D([], [], lw=1.0, ls=(0, (1.0, 1.5)), marker=".", label="backbone", **grey))
    for way, marker in (("up", "^"), ("down", "v")):
        if any(way in summary.level.sweeps for summary in findings):
            entries.append(Line2D([], [], lw=0.6, marker=marker, mfc="none", ms=5, label=f"sweep {way}", **grey))
    kinds = {event.kind for summary in findings if summary.level.branch for event in summary.level.branch.bifurcations}
    marks = [(kind, mark) for kind, mark in _MARKS.items() if kind in kinds]
    return entries + [Line2D([], [], ls="", marker=m, mfc="white", ms=7, label=kind, **grey) for kind, m in marks]
