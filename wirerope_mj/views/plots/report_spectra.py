"""Spectra of shocks and of random vibration as charts of a report."""

from collections.abc import Mapping

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum
from wirerope_mj.views.curves import BASE, Curve, Panel
from wirerope_mj.views.plots.report_image import short
from wirerope_mj.views.plots.report_response import kind_of
from wirerope_mj.views.plots.svg_chart import Chart
from wirerope_mj.views.selection import Selection

_DECADES, _POWER_DECADES = 2.5, 4.0  # below the largest that are drawn: less is nothing to design for
_ABOVE = 1.15  # of the largest, where the axis ends


def base_spectrum_chart(spectra: Mapping[str, ShockResponseSpectrum]) -> Chart:
    """Return the base's spectra: absolute acceleration and pseudo-velocity over frequency, a line for each axis.

    Args:
        spectra: by axis, "x", "y", "z".
    """
    parts = (("acceleration, maximax [g]", "g"), ("pseudo-velocity [m/s]", "m/s"))
    row = []
    for number, (label, unit) in enumerate(parts):
        curves = [
            Curve(
                x=one.frequencies,
                y=one.pseudo_velocity if number else in_unit(one.maximax, "g"),
                name=axis,
                kind="xyz".index(axis),
            )
            for axis, one in spectra.items()
        ]
        row.append(_panel(curves, label, unit))
    return Chart(rows=[row], height=190.0)


def payload_spectra_chart(spectra: Mapping[str, Mapping[str, ShockResponseSpectrum]], selection: Selection) -> Chart:
    """Return shock response spectra of base and payload, a panel for each axis.

    Args:
        spectra: by axis and name; that called "base" is the base's.
        selection: of the run, with its colours.
    """
    lines = {
        axis: {name: (one.frequencies, in_unit(one.maximax, "g")) for name, one in along.items()}
        for axis, along in spectra.items()
    }
    return _panels(lines, "acceleration, maximax [g]", selection, unit="g")


def densities_chart(densities: Mapping[str, Mapping[str, PowerSpectralDensity]], selection: Selection) -> Chart:
    """Return power spectral densities of base and payload, a panel for each axis.

    Args:
        densities: by axis and name; that called "base" is the base's.
        selection: of the run, with its colours.
    """
    lines = {
        # Without the line at 0 Hz, which cannot stand on a logarithmic axis, and where means are removed.
        axis: {name: (one.frequency[1:], one.density[1:] / STANDARD_GRAVITY**2) for name, one in along.items()}
        for axis, along in densities.items()
    }
    return _panels(lines, "density [g²/Hz]", selection, decades=_POWER_DECADES, unit="g²/Hz")


def _panels(
    lines: Mapping[str, Mapping[str, tuple[Array, Array]]],
    label: str,
    selection: Selection,
    *,
    unit: str,
    decades: float = _DECADES,
) -> Chart:
    """Return frequencies and values by axis and name, a panel for each axis."""
    row: list[Panel] = []
    for axis, along in lines.items():
        curves = [
            Curve(x=f, y=y, name=short(name), kind=BASE if name == "base" else kind_of(selection, name, number))
            for number, (name, (f, y)) in enumerate(along.items())
        ]
        curves.sort(key=lambda curve: curve.kind == BASE)  # which lies behind
        row.append(_panel(curves, "" if row else label, unit, title=f"along {axis}", decades=decades))
    return Chart(rows=[row], height=190.0)


def _panel(curves: list[Curve], label: str, unit: str, *, title: str = "", decades: float = _DECADES) -> Panel:
    """Return a panel with logarithmic axes, as far down as matters."""
    high = _ABOVE * max(float(curve.y.max()) for curve in curves)
    low = max(min(float(curve.y.min()) for curve in curves) / _ABOVE, high * 10.0**-decades)
    ends = min(float(curve.x[0]) for curve in curves), min(float(curve.x[-1]) for curve in curves)
    return Panel(
        curves=curves, ylabel=label, xlabel="frequency [Hz]", title=title, xlim=ends, ylim=(low, high), log="xy",
        unit=unit, xunit="Hz",
    )  # fmt: skip
