"""Spectra of shocks and of random vibration as pictures for a report."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import (
    BASE,
    COLOURS,
    WIDTH,
    Array,
    legend_above,
    level,
    report_style,
    round_ticks,
    short,
)

_DECADES, _POWER_DECADES = 2.5, 4.0  # below the largest that are drawn: less is nothing to design for
_ABOVE = 1.15  # of the largest, where the axis ends


def base_spectrum_figure(spectra: Mapping[str, ShockResponseSpectrum]) -> Figure:
    """Return the base's spectra: absolute acceleration and pseudo-velocity over frequency, a line for each axis.

    Args:
        spectra: by axis, "x", "y", "z".
    """
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 2.7), layout="constrained")
        left, right = figure.subplots(1, 2)
        for number, (axis, spectrum) in enumerate(spectra.items()):
            style = {"color": COLOURS["xyz".index(axis)], "label": axis, "lw": 1.0 + 0.9 * (len(spectra) - 1 - number)}
            left.plot(spectrum.frequencies, in_unit(spectrum.maximax, "g"), **style)
            right.plot(spectrum.frequencies, spectrum.pseudo_velocity, **style)
        _dress(left, "acceleration, maximax [g]")
        _dress(right, "pseudo-velocity [m/s]")
        legend_above(figure, left)
    return figure


def payload_spectra_figure(spectra: Mapping[str, Mapping[str, ShockResponseSpectrum]]) -> Figure:
    """Return shock response spectra of base and payload, a panel for each axis.

    Args:
        spectra: by axis and name; the one called "base" is grey.
    """
    lines = {
        axis: {name: (spectrum.frequencies, in_unit(spectrum.maximax, "g")) for name, spectrum in along.items()}
        for axis, along in spectra.items()
    }
    return _panels(lines, "acceleration, maximax [g]")


def densities_figure(densities: Mapping[str, Mapping[str, PowerSpectralDensity]]) -> Figure:
    """Return power spectral densities of base and payload, a panel for each axis.

    Args:
        densities: by axis and name; the one called "base" is grey.
    """
    lines = {
        # Without the line at 0 Hz, which cannot stand on a logarithmic axis, and where means are removed.
        axis: {name: (one.frequency[1:], one.density[1:] / STANDARD_GRAVITY**2) for name, one in along.items()}
        for axis, along in densities.items()
    }
    return _panels(lines, "density [g²/Hz]", decades=_POWER_DECADES)


def _panels(lines: Mapping[str, Mapping[str, tuple[Array, Array]]], label: str, *, decades: float = _DECADES) -> Figure:
    """Return frequencies and values by axis and name, a panel for each axis."""
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 2.7 if len(lines) > 1 else 3.3), layout="constrained")
        panels = np.atleast_1d(figure.subplots(1, len(lines)))
        for panel, (axis, along) in zip(panels, lines.items(), strict=True):
            colours = iter(COLOURS)
            for number, (name, (frequency, values)) in enumerate(along.items()):
                colour = BASE if name == "base" else next(colours)
                panel.plot(frequency, values, color=colour, label=short(name), zorder=level(number, colour))
            panel.set_title(f"along {axis}")
            _dress(panel, label if panel is panels[0] else "", ticks=12 // len(lines) + 3, decades=decades)
        legend_above(figure, *panels)
    return figure


def _dress(panel: Any, label: str, *, ticks: int = 12, decades: float = _DECADES) -> None:
    """Give a panel logarithmic axes with round numbers."""
    panel.set_xscale("log")
    panel.set_yscale("log")
    x, y = (
        [np.asarray(data) for data in part] for part in zip(*(line.get_data() for line in panel.lines), strict=True)
    )
    high = _ABOVE * max(float(values.max()) for values in y)
    low = max(min(float(values.min()) for values in y) / _ABOVE, high * 10.0**-decades)
    first, last = min(float(values[0]) for values in x), min(float(values[-1]) for values in x)
    panel.set_xlim(first, last)
    panel.set_ylim(low, high)
    round_ticks(panel.xaxis, first, last, most=ticks)
    round_ticks(panel.yaxis, low, high)
    panel.set_xlabel("frequency [Hz]")
    panel.set_ylabel(label)
    panel.grid(color="0.9")
    panel.set_axisbelow(True)
