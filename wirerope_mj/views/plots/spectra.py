"""Shock response spectra on the four-way paper of shock engineers, and power spectral densities."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wirerope_mj.content.panels import BASE, Curve, Panel
from wirerope_mj.content.selection import COLOURS
from wirerope_mj.content.spectra import POWER_DECADES, spectrum_panel
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.png_chart import curve_colour, draw_panel


def four_way_figure(spectra: Mapping[str, ShockResponseSpectrum], *, title: str = "") -> Figure:
    """Return pseudo-velocity over frequency with the diagonals of equal displacement [mm] and equal acceleration [g].

    On this paper a shock is a trapezoid: its displacement on the left, its velocity change at the top, its acceleration on
    the right. Displacements are read exactly; accelerations are 2 pi f times the pseudo-velocity, which the absolute
    acceleration exceeds a little where there is damping. Of the spectra, each of one acceleration, "base" is grey.
    """
    curves = _curves(spectra, lambda one: (one.frequencies, one.pseudo_velocity))
    figure, axes = _figure(spectrum_panel(curves, f"pseudo-velocity{_q(spectra)} [m/s]", "m/s"), title, (7.6, 7.2))
    axes.set_aspect("equal")  # a decade is as long on both axes: the diagonals are at 45 degrees
    _diagonals(axes)
    return figure


def shock_spectra_figure(
    spectra: Mapping[str, ShockResponseSpectrum], *, title: str = "", test: tuple[ArrayLike, ArrayLike] | None = None
) -> Figure:
    """Return the largest absolute accelerations (maximax) over frequency, "base" in grey.

    `test` are frequencies [Hz] and accelerations [m/s^2] of a test spectrum to be drawn beside them.
    """
    curves = _curves(spectra, lambda one: (one.frequencies, in_unit(one.maximax, "g")))
    if test is not None:
        f, a = (np.asarray(part, dtype=np.float64) for part in test)
        kind = len(curves) % COLOURS
        curves.append(Curve(x=f, y=in_unit(a, "g"), name="test spectrum", kind=kind, dash="dashed"))
    return _figure(spectrum_panel(curves, f"SRS{_q(spectra)}: peak acceleration [g]", "g"), title)[0]


def density_figure(densities: Mapping[str, PowerSpectralDensity], *, title: str = "") -> Figure:
    """Return power spectral densities over frequency, with their rms; the band is one standard error wide on both sides."""
    curves = _curves(densities, lambda one: (one.frequency[1:], one.density[..., 1:] / STANDARD_GRAVITY**2))
    names = [f"{name}: {in_unit(float(one.rms), 'g'):.3g} g rms" for name, one in densities.items()]
    curves = [replace(curve, name=name) for curve, name in zip(curves, names, strict=True)]
    figure, axes = _figure(spectrum_panel(curves, "PSD [g²/Hz]", "g²/Hz", decades=POWER_DECADES), title)
    for curve, density in zip(curves, densities.values(), strict=True):
        low, high = curve.y * max(1.0 - density.standard_error, 1e-3), curve.y * (1.0 + density.standard_error)
        axes.fill_between(curve.x, low, high, color=curve_colour(curve), alpha=0.15, lw=0.0)
    return figure


def save_four_way(spectra: Mapping[str, ShockResponseSpectrum], path: str | Path, *, title: str = "") -> None:
    """Write `four_way_figure` as a picture; the ending of `path` says of which kind."""
    # Equal decades leave empty paper above and below.
    four_way_figure(spectra, title=title).savefig(path, bbox_inches="tight")


def save_shock_spectra(
    spectra: Mapping[str, ShockResponseSpectrum], path: str | Path, *, title: str = "",
    test: tuple[ArrayLike, ArrayLike] | None = None,
) -> None:  # fmt: skip
    """Write `shock_spectra_figure` as a picture; the ending of `path` says of which kind."""
    shock_spectra_figure(spectra, title=title, test=test).savefig(path)


def save_densities(densities: Mapping[str, PowerSpectralDensity], path: str | Path, *, title: str = "") -> None:
    """Write `density_figure` as a picture; the ending of `path` says of which kind."""
    density_figure(densities, title=title).savefig(path)


def _curves(spectra: Mapping[str, Any], values_of: Callable[[Any], tuple[Array, Array]]) -> list[Curve]:
    """Return the curves of spectra of one acceleration each; the base is grey, and no colour is lost to it."""
    others, curves = [name for name in spectra if name != BASE], []
    for name, spectrum in spectra.items():
        x, y = values_of(spectrum)
        if y.ndim != 1:
            raise ValueError(f"the spectrum {name!r} must be of one acceleration, got the shape {y.shape}.")
        number = 0 if name == BASE else others.index(name)
        dash, kind = "dashed" if number >= COLOURS else "", BASE if name == BASE else number % COLOURS
        curves.append(Curve(x=x, y=y, name=name, kind=kind, dash=dash))
    return curves


def _q(spectra: Mapping[str, ShockResponseSpectrum]) -> str:
    q = {spectrum.q for spectrum in spectra.values()}
    return f", Q = {q.pop():g}" if len(q) == 1 else ""


def _figure(panel: Panel, title: str, size: tuple[float, float] = (9.0, 5.4)) -> tuple[Figure, Axes]:
    figure = PlainFigure(figsize=size, layout="constrained", dpi=120)
    if title:
        figure.suptitle(title, fontsize=12, fontweight="bold")
    first, last = min(float(one.x[0]) for one in panel.curves), max(float(one.x[-1]) for one in panel.curves)
    axes = figure.add_subplot()
    draw_panel(axes, replace(panel, xlim=(first, last) if first < last else (first / 2.0, 2.0 * last)))
    return figure, axes


def _diagonals(panel: Axes) -> None:
    """Draw and label the lines of equal displacement, rising, and of equal acceleration, falling."""
    (f0, f1), (v0, v1) = panel.get_xlim(), panel.get_ylim()
    turn = 2.0 * math.pi
    ends = np.array([f0, f1])
    for d in _round_numbers(v0 / (turn * f1), v1 / (turn * f0), scale=1e-3):
        panel.plot(ends, turn * ends * d, color="#7f9fbf", lw=_weight(d / 1e-3), zorder=1)
        # where it comes in, on the left or from below
        f = max(f0, v0 / (turn * d)) * 1.06
        if turn * f * d < v1 / 1.5 and f < math.sqrt(f0 * f1):
            _label(panel, f, turn * f * d, f"{d / 1e-3:.4g} mm", 45.0, "left", "#41648c")
    for a in _round_numbers(turn * f0 * v0, turn * f1 * v1, scale=STANDARD_GRAVITY):
        panel.plot(ends, a / (turn * ends), color="#c9a58a", lw=_weight(in_unit(a, "g")), zorder=1)
        # where it leaves, on the right or below
        f = min(f1, a / (turn * v0)) / 1.06
        if a / (turn * f) < v1 / 1.5 and f > math.sqrt(f0 * f1):
            _label(panel, f, a / (turn * f), f"{in_unit(a, 'g'):.4g} g", -45.0, "right", "#8a5a33")


def _label(panel: Axes, x: float, y: float, text: str, angle: float, end: str, colour: str) -> None:
    panel.text(x, y, text, rotation=angle, rotation_mode="anchor", ha=end, va="bottom", fontsize=7, color=colour, zorder=5)


def _round_numbers(low: float, high: float, *, scale: float) -> Sequence[float]:
    """Return 1, 2 and 5 times the powers of ten of `scale` between two values."""
    first, last = math.floor(math.log10(low / scale)), math.ceil(math.log10(high / scale))
    numbers = [scale * m * 10.0**e for e in range(first, last + 1) for m in (1.0, 2.0, 5.0)]
    return [number for number in numbers if low < number < high]


def _weight(number: float) -> float:
    """Return the width of a diagonal: powers of ten stand out."""
    return 0.9 if abs(math.log10(number) - round(math.log10(number))) < 1e-6 else 0.45
