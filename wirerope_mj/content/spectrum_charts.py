"""Spectra of accelerations as charts: on the four-way paper of shock engineers, beside a test spectrum, as power densities."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from wirerope_mj.content.panels import BASE, OTHERS, Chart, Curve, Note, Panel
from wirerope_mj.content.selection import COLOURS
from wirerope_mj.content.spectra import POWER_DECADES, spectrum_panel
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum

_HEIGHT = 330.0  # of a panel
_ACROSS = 686.0  # width of a panel, about: a decade is as long on both axes of four-way paper
_INSIDE = 1.07  # of a frequency, by which names stand off the edge
_TURN = 2.0 * math.pi


def four_way_chart(spectra: Mapping[str, ShockResponseSpectrum]) -> Chart:
    """Return pseudo-velocity over frequency with the diagonals of equal displacement [mm] and equal acceleration [g].

    On this paper a shock is a trapezoid: its displacement on the left, its velocity change at the top, its acceleration on
    the right. Displacements are read exactly; accelerations are 2 pi f times the pseudo-velocity, which the absolute
    acceleration exceeds a little where there is damping. Of the spectra, each of one acceleration, "base" is grey.
    """
    curves = _curves(spectra, lambda one: (one.frequencies, one.pseudo_velocity))
    panel = _over_all(spectrum_panel(curves, f"pseudo-velocity{_q(spectra)} [m/s]", "m/s"))
    assert panel.xlim is not None
    assert panel.ylim is not None
    diagonals = list(_diagonals(panel.xlim, panel.ylim))
    decades = [math.log10(high / low) for low, high in (panel.xlim, panel.ylim)]
    lines, notes = [line for line, _ in diagonals], [note for _, some in diagonals for note in some]
    panel = replace(panel, curves=[*curves, *lines], notes=notes)
    return Chart(
        id="four-way", rows=[[panel]], height=_ACROSS * decades[1] / decades[0], alt="Four-way shock response spectrum."
    )


def shock_spectra_chart(
    spectra: Mapping[str, ShockResponseSpectrum], *, test: tuple[ArrayLike, ArrayLike] | None = None
) -> Chart:
    """Return the largest absolute accelerations (maximax) over frequency, "base" in grey.

    `test` are frequencies [Hz] and accelerations [m/s^2] of a test spectrum to be drawn beside them.
    """
    curves = _curves(spectra, lambda one: (one.frequencies, in_unit(one.maximax, "g")))
    if test is not None:
        f, a = (np.asarray(part, dtype=np.float64) for part in test)
        curves.append(Curve(x=f, y=in_unit(a, "g"), name="test spectrum", kind=len(curves) % COLOURS, dash="dashed"))
    panel = _over_all(spectrum_panel(curves, f"SRS{_q(spectra)}: peak acceleration [g]", "g"))
    return Chart(id="shock-spectra", rows=[[panel]], height=_HEIGHT, alt="Shock response spectra.")


def power_densities_chart(densities: Mapping[str, PowerSpectralDensity]) -> Chart:
    """Return power spectral densities over frequency, named with their rms and the standard error of each line."""
    curves = _curves(densities, lambda one: (one.frequency[1:], one.density[..., 1:] / STANDARD_GRAVITY**2))
    curves = [
        replace(curve, name=f"{name}: {in_unit(float(one.rms), 'g'):.3g} g rms, ±{in_unit(one.standard_error, '%'):.0f} %")
        for curve, (name, one) in zip(curves, densities.items(), strict=True)
    ]
    panel = _over_all(spectrum_panel(curves, "PSD [g²/Hz]", "g²/Hz", decades=POWER_DECADES))
    return Chart(id="power-densities", rows=[[panel]], height=_HEIGHT, alt="Power spectral densities.")


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


def _over_all(panel: Panel) -> Panel:
    """Return a panel over all frequencies of its curves."""
    first, last = min(float(one.x[0]) for one in panel.curves), max(float(one.x[-1]) for one in panel.curves)
    return replace(panel, xlim=(first, last) if first < last else (first / 2.0, 2.0 * last))


def _diagonals(across: tuple[float, float], upward: tuple[float, float]) -> Iterator[tuple[Curve, list[Note]]]:
    """Yield the lines of equal displacement, rising, and of equal acceleration, falling, with their names at an end."""
    (f0, f1), (v0, v1) = across, upward
    middle = math.sqrt(f0 * f1)
    for d in _round_numbers(v0 / (_TURN * f1), v1 / (_TURN * f0), scale=1e-3):
        first, last = max(f0, v0 / (_TURN * d)), min(f1, v1 / (_TURN * d))
        f = _INSIDE * first  # where it comes in
        notes = [(f, _TURN * f * d, f"{d / 1e-3:.4g} mm", False)] if f < middle and _TURN * f * d < v1 / 1.5 else []
        yield _diagonal(first, last, _TURN * first * d, _TURN * last * d), notes
    for a in _round_numbers(_TURN * f0 * v0, _TURN * f1 * v1, scale=STANDARD_GRAVITY):
        first, last = max(f0, a / (_TURN * v1)), min(f1, a / (_TURN * v0))
        f = last / _INSIDE  # where it leaves
        notes = [(f, a / (_TURN * f), f"{in_unit(a, 'g'):.4g} g", True)] if f > middle and a / (_TURN * f) < v1 / 1.5 else []
        yield _diagonal(first, last, a / (_TURN * first), a / (_TURN * last)), notes


def _diagonal(first: float, last: float, start: float, end: float) -> Curve:
    return Curve(x=np.array([first, last]), y=np.array([start, end]), name="", kind=OTHERS, weight=0.7)


def _round_numbers(low: float, high: float, *, scale: float) -> Sequence[float]:
    """Return 1, 2 and 5 times the powers of ten of `scale` between two values."""
    first, last = math.floor(math.log10(low / scale)), math.ceil(math.log10(high / scale))
    numbers = [scale * m * 10.0**e for e in range(first, last + 1) for m in (1.0, 2.0, 5.0)]
    return [number for number in numbers if low < number < high]
