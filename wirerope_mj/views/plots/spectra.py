"""Shock response spectra on the four-way paper of shock engineers, and power spectral densities."""

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import COLOURS, round_ticks

"""Of the payloads, in their order; the base is grey."""

BASE, TEST = "0.45", "#b30000"

_DECADES = 2.5
"""Below the largest that are drawn: what is less than a three hundredth of the peak decides nothing."""

_ROOM = 1.25
"""Of the largest, where an axis ends."""


def four_way_figure(spectra: Mapping[str, ShockResponseSpectrum], *, title: str = "") -> Figure:
    """Return pseudo-velocity over frequency with the diagonals of equal displacement [mm] and equal acceleration [g].

    On this paper a shock is a trapezoid: its displacement on the left, its velocity change at the top, its acceleration on
    the right. Displacements are read exactly; accelerations are 2 pi f times the pseudo-velocity, which the absolute
    acceleration exceeds a little where there is damping.

    Args:
        spectra: of one acceleration each, by name; the one called "base" is grey.
        title: above the picture.
    """
    figure = PlainFigure(figsize=(7.6, 7.2), layout="constrained", dpi=120)
    panel = figure.add_subplot()
    _title(figure, title)
    for name, spectrum, style in _styled(spectra):
        panel.plot(spectrum.frequencies, _one(spectrum.pseudo_velocity, name), label=name, zorder=4, **style)
    _dress(panel, "pseudo-velocity [m/s]")
    panel.set_aspect("equal")  # a decade is as long on both axes: the diagonals are at 45 degrees
    _diagonals(panel)
    panel.legend(fontsize=8, loc="upper right")
    return figure


def shock_spectra_figure(
    spectra: Mapping[str, ShockResponseSpectrum],
    *,
    title: str = "",
    test: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
) -> Figure:
    """Return the largest absolute accelerations (maximax) over frequency.

    Args:
        spectra: of one acceleration each, by name; the one called "base" is grey.
        title: above the picture.
        test: frequencies [Hz] and accelerations [m/s^2] of a test spectrum to be drawn beside them.
    """
    figure = PlainFigure(figsize=(9.0, 5.4), layout="constrained", dpi=120)
    panel = figure.add_subplot()
    _title(figure, title)
    for name, spectrum, style in _styled(spectra):
        panel.plot(spectrum.frequencies, in_unit(_one(spectrum.maximax, name), "g"), label=name, zorder=3, **style)
    if test is not None:
        f, a = (np.asarray(part, dtype=np.float64) for part in test)
        panel.plot(f, in_unit(a, "g"), color=TEST, ls="--", lw=1.3, label="test spectrum", zorder=3)
    q = {spectrum.q for spectrum in spectra.values()}
    quality = f", Q = {q.pop():g}" if len(q) == 1 else ""
    _dress(panel, f"absolute acceleration, maximax{quality} [g]")
    panel.legend(fontsize=8, loc="best")
    return figure


def density_figure(densities: Mapping[str, PowerSpectralDensity], *, title: str = "") -> Figure:
    """Return power spectral densities over frequency, with their rms; the band is one standard error wide on both sides.

    Args:
        densities: of one acceleration each, by name; the one called "base" is grey.
        title: above the picture.
    """
    figure = PlainFigure(figsize=(9.0, 5.4), layout="constrained", dpi=120)
    panel = figure.add_subplot()
    _title(figure, title)
    for name, density, style in _styled(densities):
        f, values = density.frequency[1:], _one(density.density, name)[1:] / STANDARD_GRAVITY**2
        label = f"{name}: {in_unit(float(density.rms), 'g'):.3g} g rms"
        panel.plot(f, values, label=label, zorder=3, **style)
        error = density.standard_error
        panel.fill_between(
            f, values * max(1.0 - error, 1e-3), values * (1.0 + error), color=style["color"], alpha=0.15, lw=0.0
        )
    _dress(panel, "power spectral density [g²/Hz]", decades=2.0 * _DECADES)
    panel.legend(fontsize=8, loc="best")
    return figure


def save_four_way(spectra: Mapping[str, ShockResponseSpectrum], path: str | Path, *, title: str = "") -> None:
    """Write `four_way_figure` as a picture; the ending of `path` says of which kind."""
    # Equal decades leave empty paper above and below.
    four_way_figure(spectra, title=title).savefig(path, bbox_inches="tight")


def save_shock_spectra(
    spectra: Mapping[str, ShockResponseSpectrum],
    path: str | Path,
    *,
    title: str = "",
    test: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
) -> None:
    """Write `shock_spectra_figure` as a picture; the ending of `path` says of which kind."""
    shock_spectra_figure(spectra, title=title, test=test).savefig(path)


def save_densities(densities: Mapping[str, PowerSpectralDensity], path: str | Path, *, title: str = "") -> None:
    """Write `density_figure` as a picture; the ending of `path` says of which kind."""
    density_figure(densities, title=title).savefig(path)


def _styled(lines: Mapping[str, Any]) -> Iterator[tuple[str, Any, dict[str, Any]]]:
    """Yield name, spectrum and style; the base is grey, and no colour is lost to it."""
    others = [name for name in lines if name != "base"]
    for name, spectrum in lines.items():
        index = others.index(name) if name != "base" else 0
        colour = BASE if name == "base" else COLOURS[index % len(COLOURS)]
        yield name, spectrum, {"color": colour, "lw": 1.6, "ls": "-" if index < len(COLOURS) else "--"}


def _one(values: Array, name: str) -> Array:
    """Return the values of a spectrum of one acceleration."""
    if values.ndim != 1:
        raise ValueError(f"the spectrum {name!r} must be of one acceleration, got the shape {values.shape}.")
    return values


def _title(figure: Figure, title: str) -> None:
    if title:
        figure.suptitle(title, fontsize=12, fontweight="bold")


def _dress(panel: Any, label: str, *, decades: float = _DECADES) -> None:
    """Give a panel logarithmic axes with round numbers, from the lines in it."""
    drawn = [np.asarray(line.get_data(), dtype=np.float64) for line in panel.lines]
    high = _ROOM * max(float(y.max()) for _, y in drawn)
    if not high > 0.0:
        high = 1.0  # nothing moved: an empty paper
    positive = [float(y[y > 0.0].min()) for _, y in drawn if (y > 0.0).any()]
    low = max(min(positive, default=0.0) / _ROOM, high * 10.0**-decades)
    low = min(low, high / 10.0)
    first, last = min(float(x[0]) for x, _ in drawn), max(float(x[-1]) for x, _ in drawn)
    if first == last:
        first, last = first / 2.0, 2.0 * last
    panel.set_xlim(first, last)
    panel.set_ylim(low, high)
    panel.set_xscale("log")  # after the limits: lines that are zero have none on such an axis
    panel.set_yscale("log")
    round_ticks(panel.xaxis, first, last)
    round_ticks(panel.yaxis, low, high)
    panel.set_xlabel("frequency [Hz]")
    panel.set_ylabel(label)
    panel.grid(color="0.9")
    panel.set_axisbelow(True)


def _diagonals(panel: Any) -> None:
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


def _label(panel: Any, x: float, y: float, text: str, angle: float, end: str, colour: str) -> None:
    panel.text(
        x, y, text, rotation=angle, rotation_mode="anchor", ha=end, va="bottom", fontsize=7, color=colour, zorder=5
    )


def _round_numbers(low: float, high: float, *, scale: float) -> Sequence[float]:
    """Return 1, 2 and 5 times the powers of ten of `scale` between two values."""
    first, last = math.floor(math.log10(low / scale)), math.ceil(math.log10(high / scale))
    numbers = [scale * m * 10.0**e for e in range(first, last + 1) for m in (1.0, 2.0, 5.0)]
    return [number for number in numbers if low < number < high]


def _weight(number: float) -> float:
    """Return the width of a diagonal: powers of ten stand out."""
    return 0.9 if abs(math.log10(number) - round(math.log10(number))) < 1e-6 else 0.45
