"""Charts and tables of spectra: of a run, on four-way paper, beside a test spectrum, and power spectral densities."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from wirerope_mj.assessment.criteria import Criterion, body_peaks
from wirerope_mj.assessment.criteria.random import SIGMAS
from wirerope_mj.assessment.criteria.verdict import RMS
from wirerope_mj.content.blocks import BASE, LEFT, LIMIT, OTHERS, RIGHT, WIDTH, Block, Chart, Curve, Note, Panel, crest, short
from wirerope_mj.content.judged_run import STILL, JudgedRun
from wirerope_mj.content.numbers import fixed, listed, several, with_unit
from wirerope_mj.content.run_spectra import BASE as THE_BASE
from wirerope_mj.content.run_spectra import acceleration_along, held_text, moving_axes
from wirerope_mj.content.selection import COLOURS, Selection, kind_of, worst_names
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Table, left
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.motions import Sweep
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum

_DECADES, POWER_DECADES = 2.5, 4.0  # decades below the largest value that are drawn
_MARGIN = 1.15  # ratio of the end of an axis to the largest value
_NEAR_DECADE = 0.05  # relative distance within which an axis is extended to a power of ten
_EQUAL = 1e-6  # relative difference up to which two spectra are one line


def spectra_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield shock response spectra and power spectral densities of base and payload, with a table of rms values."""
    shock = run.spectra.shock
    if not isinstance(shock, Absent) and len(next(iter(shock.values()))) > 1:  # not of the base alone
        yield shock_chart(run)
    if run.spectra.densities:
        yield densities_chart(run)
        rows: list[tuple[Cell, ...]] = []
        for name in next(iter(run.spectra.densities.values())):
            for axis in "xyz":
                density = run.spectra.densities.get(axis, {}).get(name)
                if (rms := rms_along(run, name, axis)) > STILL:
                    rows.append((name, axis, rms, SIGMAS * rms, float(density.rms_error) if density else None))
        error = Column("error of the rms", "%", "z.1f")
        yield Table(
            "rms", "Root mean squares, once the response has settled",
            (*left("where", "axis"), Column("rms", "g"), Column("3 sigma", "g"), error), rows,
            note="Along every axis that is moved. Error: one standard deviation of the estimate, from bandwidth and length; "
            "it is known along the base's motion.",
        )  # fmt: skip


def _srs_label(q: float) -> str:
    return f"SRS, Q = {q:g}: peak acceleration [g]"


def base_spectrum_chart(spectra: Mapping[str, ShockResponseSpectrum]) -> Chart:
    """Draw absolute acceleration and pseudo-velocity of the base over frequency, by axis."""
    q = next(iter(spectra.values())).q
    parts = ((_srs_label(q), "g"), (f"pseudo-velocity, Q = {q:g} [m/s]", "m/s"))
    equal: dict[str, list[str]] = {}  # axes along which the base moves alike, by the first of them
    for axis, spectrum in spectra.items():
        same = (other for other in equal if np.allclose(spectrum.maximax, spectra[other].maximax, rtol=_EQUAL, atol=0.0))
        equal.setdefault(next(same, axis), []).append(axis)
    row = []
    for number, (label, unit) in enumerate(parts):
        curves = [
            Curve(
                spectrum.frequencies, spectrum.pseudo_velocity if number else in_unit(spectrum.maximax, "g"), name=listed(axes),
                kind=BASE, dash=("", "dashed", "dotted")[rank],
            )
            for rank, (axis, axes) in enumerate(equal.items())
            for spectrum in [spectra[axis]]
        ]  # fmt: skip
        row.append(spectrum_panel(curves, label, unit))
    return Chart(
        id="base-spectrum", rows=[row], height=190.0,
        caption=f"Shock response spectrum of the base, Q = {q:g}: peak absolute acceleration (maximax) and pseudo-velocity of "
        "oscillators that stand on the base without isolators.",
        alt="Shock response spectrum of the base.",
    )  # fmt: skip


def shock_chart(run: JudgedRun) -> Chart:
    """Draw shock response spectra of base and payload, a panel for each axis."""
    assert not isinstance(run.spectra.shock, Absent)
    first = next(iter(run.spectra.shock.values()))
    names = [name for name in first if name != BASE]
    lines = {
        axis: {name: (srs.frequencies, in_unit(srs.maximax, "g")) for name, srs in along.items()}
        for axis, along in run.spectra.shock.items()
    }
    q = next(iter(first.values())).q
    return replace(
        _axis_panels(lines, _srs_label(q), run.selection, unit="g"),
        id="payload-spectra",
        caption=f"Shock response spectra of {listed(names)} and of the base, maximax, Q = {q:g}: what equipment meets "
        "that stands there. Where the payload's line lies above the base's, isolation makes it worse. "
        f"{run.sample_rate:g} samples a second hold the payload's lines {held_text(run.spectra.held)}; above they are an "
        "indication.",
        alt=f"Shock response spectra of {listed(names)} and the base.",
    )


def densities_chart(run: JudgedRun) -> Chart:
    """Draw power spectral densities of base and payload, a panel for each axis."""
    densities = run.spectra.densities
    lines = {
        # Without the line at 0 Hz, which has no place on a logarithmic axis.
        axis: {name: (psd.frequency[1:], psd.density[1:] / STANDARD_GRAVITY**2) for name, psd in along.items()}
        for axis, along in densities.items()
    }
    first = next(iter(densities.values()))
    psd, names = next(iter(first.values())), listed([name for name in first if name != BASE])
    return replace(
        _axis_panels(lines, "PSD [g²/Hz]", run.selection, decades=POWER_DECADES, unit="g²/Hz"),
        id="densities",
        caption=f"Power spectral densities of {names} and of the base while the response is stationary: "
        f"{psd.duration:.4g} s, resolution {psd.resolution:.3g} Hz, {several(psd.segments, 'segment')}, so that each "
        f"density is known to {100.0 * psd.standard_error:.0f} %.",
        alt=f"Power spectral densities of {names} and the base.",
    )


def rms_along(run: JudgedRun, name: str, axis: str) -> float:
    """Find the rms acceleration of base, body or point along an axis [m/s^2]: the judged value, or that of its PSD."""
    if name == THE_BASE:
        return float(run.base_rms["xyz".index(axis)])
    verdicts, criterion = () if isinstance(run.random, Absent) else run.random, Criterion(RMS, axis=axis)
    density = run.spectra.densities.get(axis, {}).get(name)
    judged = (row.value for row in verdicts if row.subject == name and row.criterion == criterion)
    return next(judged, float(density.rms) if density else 0.0)


def _axis_panels(
    lines: Mapping[str, Mapping[str, tuple[Array, Array]]], label: str, selection: Selection, *, unit: str,
    decades: float = _DECADES,
) -> Chart:  # fmt: skip
    """Draw spectra in a panel for each axis, the base behind the others."""
    row: list[Panel] = []
    for axis, along in lines.items():
        curves = [
            Curve(f, y, name=short(name), kind=BASE if name == BASE else kind_of(selection, name))
            for name, (f, y) in along.items()
        ]
        curves.sort(key=lambda curve: curve.kind == BASE)  # which lies behind
        row.append(spectrum_panel(curves, "" if row else label, unit, title=f"along {axis}", decades=decades))
    return Chart(rows=[row], height=190.0)


def spectrum_panel(curves: list[Curve], label: str, unit: str, *, title: str = "", decades: float = _DECADES) -> Panel:
    """Draw spectra on logarithmic axes, values down to some decades below the largest."""
    high = _MARGIN * max(float(curve.y.max()) for curve in curves) or 1.0  # nothing moved: an empty paper
    low = max(min(float(curve.y.min()) for curve in curves) / _MARGIN, high * 10.0**-decades)
    ends = _axis_end(min(float(curve.x[0]) for curve in curves)), _axis_end(min(float(curve.x[-1]) for curve in curves))
    return Panel(
        curves, label, xlabel="frequency [Hz]", title=title, xlim=ends, ylim=(low, high), log="xy",
        unit=unit, xunit="Hz",
    )  # fmt: skip


def _axis_end(frequency: float) -> float:
    """Round the end of an axis to a power of ten within 5 %, so that it gets a label."""
    power = 10.0 ** round(math.log10(frequency))
    return power if abs(frequency / power - 1.0) < _NEAR_DECADE else frequency


_HEIGHT = 330.0  # of a panel
_PANEL_WIDTH = WIDTH - LEFT - RIGHT  # a decade is as long on both axes of four-way paper
_LABEL_OFFSET = 1.07  # ratio of frequencies by which labels are set off the edge
_TWO_PI = 2.0 * math.pi


def four_way_chart(spectra: Mapping[str, ShockResponseSpectrum]) -> Chart:
    """Draw pseudo-velocity over frequency with the diagonals of equal displacement [mm] and equal acceleration [g].

    On this paper a shock is a trapezoid: its displacement on the left, its velocity change at the top, its acceleration on
    the right. Displacements are read exactly; accelerations are 2 pi f times the pseudo-velocity, which the absolute
    acceleration exceeds a little where there is damping. The spectrum named "base" is grey.
    """
    curves = _curves(spectra, lambda spectrum: (spectrum.frequencies, spectrum.pseudo_velocity))
    panel = _over_all_frequencies(spectrum_panel(curves, f"pseudo-velocity{_q_text(spectra)} [m/s]", "m/s"))
    assert panel.xlim is not None
    assert panel.ylim is not None
    diagonals = list(_diagonals(panel.xlim, panel.ylim))
    decades = [math.log10(high / low) for low, high in (panel.xlim, panel.ylim)]
    lines, notes = [line for line, _ in diagonals], [note for _, some in diagonals for note in some]
    panel = replace(panel, curves=[*curves, *lines], notes=notes)
    return Chart(
        id="four-way", rows=[[panel]], height=_PANEL_WIDTH * decades[1] / decades[0], alt="Four-way shock response spectrum."
    )


def shock_spectra_chart(
    spectra: Mapping[str, ShockResponseSpectrum], *, test: tuple[ArrayLike, ArrayLike] | None = None
) -> Chart:
    """Draw the largest absolute accelerations (maximax) over frequency, "base" in grey.

    `test` are frequencies [Hz] and accelerations [m/s^2] of a test spectrum to be drawn beside them.
    """
    curves = _curves(spectra, lambda spectrum: (spectrum.frequencies, in_unit(spectrum.maximax, "g")))
    if test is not None:
        f, a = (np.asarray(part, dtype=np.float64) for part in test)
        curves.append(Curve(f, in_unit(a, "g"), name="test spectrum", kind=LIMIT, dash="dashed"))
    panel = _over_all_frequencies(spectrum_panel(curves, f"SRS{_q_text(spectra)}: peak acceleration [g]", "g"))
    return Chart(id="shock-spectra", rows=[[panel]], height=_HEIGHT, alt="Shock response spectra.")


def power_densities_chart(densities: Mapping[str, PowerSpectralDensity]) -> Chart:
    curves = _curves(densities, lambda spectrum: (spectrum.frequency[1:], spectrum.density[..., 1:] / STANDARD_GRAVITY**2))
    curves = [
        replace(curve, name=f"{name}: {in_unit(float(psd.rms), 'g'):.3g} g rms, ±{in_unit(psd.standard_error, '%'):.0f} %")
        for curve, (name, psd) in zip(curves, densities.items(), strict=True)
    ]
    panel = _over_all_frequencies(spectrum_panel(curves, "PSD [g²/Hz]", "g²/Hz", decades=POWER_DECADES))
    return Chart(id="power-densities", rows=[[panel]], height=_HEIGHT, alt="Power spectral densities.")


def _curves(spectra: Mapping[str, Any], values_of: Callable[[Any], tuple[Array, Array]]) -> list[Curve]:
    """Draw spectra in the numbered colours, "base" in grey; ValueError if a spectrum is of several axes."""
    curves: list[Curve] = []
    number = 0
    for name, spectrum in spectra.items():
        x, y = values_of(spectrum)
        if y.ndim != 1:
            raise ValueError(f"the spectrum {name!r} must be of one acceleration, got the shape {y.shape}.")
        if name == BASE:  # it takes no numbered colour
            curves.append(Curve(x, y, name=name, kind=BASE))
            continue
        dash = "dashed" if number >= COLOURS else ""
        curves.append(Curve(x, y, name=name, kind=number % COLOURS, dash=dash))
        number += 1
    return curves


def _q_text(spectra: Mapping[str, ShockResponseSpectrum]) -> str:
    """Write the quality factor that all spectra share, such as ", Q = 10"; "" if they differ."""
    q = {spectrum.q for spectrum in spectra.values()}
    return f", Q = {q.pop():g}" if len(q) == 1 else ""


def _over_all_frequencies(panel: Panel) -> Panel:
    first, last = min(float(curve.x[0]) for curve in panel.curves), max(float(curve.x[-1]) for curve in panel.curves)
    return replace(panel, xlim=(first, last) if first < last else (first / 2.0, 2.0 * last))


def _diagonals(across: tuple[float, float], upward: tuple[float, float]) -> Iterator[tuple[Curve, list[Note]]]:
    """Yield the diagonals of four-way paper with labels: equal displacement, rising, and equal acceleration, falling."""
    (f0, f1), (v0, v1) = across, upward
    middle = math.sqrt(f0 * f1)

    def line(first: float, last: float, start: float, end: float) -> Curve:
        return Curve(np.array([first, last]), np.array([start, end]), name="", kind=OTHERS, weight=0.7)

    for d in _round_numbers(v0 / (_TWO_PI * f1), v1 / (_TWO_PI * f0), scale=1e-3):
        first, last = max(f0, v0 / (_TWO_PI * d)), min(f1, v1 / (_TWO_PI * d))
        f = _LABEL_OFFSET * first  # beside its left end
        notes = [(f, _TWO_PI * f * d, f"{d / 1e-3:.4g} mm", False)] if f < middle and _TWO_PI * f * d < v1 / 1.5 else []
        yield line(first, last, _TWO_PI * first * d, _TWO_PI * last * d), notes
    for a in _round_numbers(_TWO_PI * f0 * v0, _TWO_PI * f1 * v1, scale=STANDARD_GRAVITY):
        first, last = max(f0, a / (_TWO_PI * v1)), min(f1, a / (_TWO_PI * v0))
        f = last / _LABEL_OFFSET  # beside its right end
        notes = (
            [(f, a / (_TWO_PI * f), f"{in_unit(a, 'g'):.4g} g", True)] if f > middle and a / (_TWO_PI * f) < v1 / 1.5 else []
        )
        yield line(first, last, a / (_TWO_PI * first), a / (_TWO_PI * last)), notes


def _round_numbers(low: float, high: float, *, scale: float) -> Sequence[float]:
    """List 1, 2 and 5 times the powers of ten of `scale` between two values."""
    first, last = math.floor(math.log10(low / scale)), math.ceil(math.log10(high / scale))
    numbers = [scale * m * 10.0**e for e in range(first, last + 1) for m in (1.0, 2.0, 5.0)]
    return [number for number in numbers if low < number < high]


def sweep_chart(run: JudgedRun, sweep: Sweep) -> Chart:
    """Draw accelerations along the base's motion over the frequency of the sweep, as maxima of short intervals."""
    response, curves, tops = run.response, [], list[str]()
    frequency, peaks = sweep.frequency(response.time), {row.name: row for row in body_peaks(response)}
    for name in (*worst_names(response), BASE):
        size = np.zeros(response.time.size)
        for axis in moving_axes(response):
            size += acceleration_along(response, name, axis) ** 2
        x, y = crest(frequency, in_unit(np.sqrt(size), "g"))
        top = peaks[response.scene.base if name == BASE else name]  # of every step, as in the table
        peak = float(sweep.frequency([top.time])[0]), in_unit(top.value, "g")
        if name != BASE:
            tops.append(f"{short(name)} {with_unit(top.value, 'g')} at {fixed(peak[0], 2)} Hz")
        curves.append(Curve(x, y, name=short(name), kind=BASE if name == BASE else kind_of(run.selection, name), peak=peak))
    panel = Panel(curves, "acceleration [g]", xlabel="frequency of the base [Hz]", log="x", unit="g", xunit="Hz")
    return Chart(
        id="over-frequency", rows=[[panel]], height=210.0,
        caption=f"Accelerations along the base's motion over the frequency of the sweep; largest: {listed(tops)}.",
        alt="Accelerations over the frequency of the sweep.",
    )  # fmt: skip
