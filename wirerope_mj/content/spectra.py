"""Spectra of shocks and of random vibration, of base and payload, as charts and as a table of rms values."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

from wirerope_mj.assessment.criteria import Criterion
from wirerope_mj.assessment.criteria.verdict import RMS
from wirerope_mj.content.blocks import Block
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import listed, several
from wirerope_mj.content.panels import BASE, Chart, Curve, Panel, short
from wirerope_mj.content.selection import Selection, kind_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Table
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.motions.spectra import ShockResponseSpectrum

_DECADES, POWER_DECADES = 2.5, 4.0  # below the largest that are drawn: less is nothing to design for
_ABOVE = 1.15  # of the largest, where the axis ends
_NEAR_DECADE = 0.05  # of a frequency, within which an axis goes on to a power of ten
_STILL = 1e-6  # [m/s^2]: an rms that is rounding


def spectra_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield shock response spectra, or power spectral densities and their rms values, of payload and base."""
    shock = run.spectra.shock
    if not isinstance(shock, Absent) and len(next(iter(shock.values()))) > 1:  # not of the base alone
        yield shock_chart(run)
    if run.spectra.densities:
        yield densities_chart(run)
        yield _rms(run)


def _srs_label(q: float) -> str:
    return f"SRS, Q = {q:g}: peak acceleration [g]"


def base_spectrum_chart(spectra: Mapping[str, ShockResponseSpectrum]) -> Chart:
    """Return the base's spectra by axis: absolute acceleration and pseudo-velocity over frequency, a line for each axis."""
    q = next(iter(spectra.values())).q
    parts = ((_srs_label(q), "g"), (f"pseudo-velocity, Q = {q:g} [m/s]", "m/s"))
    row = []
    for number, (label, unit) in enumerate(parts):
        curves = [
            Curve(
                x=one.frequencies, y=one.pseudo_velocity if number else in_unit(one.maximax, "g"), name=axis,
                kind="xyz".index(axis),
            )
            for axis, one in spectra.items()
        ]  # fmt: skip
        row.append(spectrum_panel(curves, label, unit))
    return Chart(
        id="base-spectrum", rows=[row], height=190.0,
        caption=f"Shock response spectrum of the base, Q = {q:g}: peak absolute acceleration (maximax) and pseudo-velocity of "
        "oscillators that stand on the base without isolators.",
        alt="Shock response spectrum of the base.",
    )  # fmt: skip


def shock_chart(run: JudgedRun) -> Chart:
    """Draw the shock response spectra of base and payload, a panel for each axis."""
    assert not isinstance(run.spectra.shock, Absent)
    first = next(iter(run.spectra.shock.values()))
    names = [name for name in first if name != BASE]
    lines = {
        axis: {name: (one.frequencies, in_unit(one.maximax, "g")) for name, one in along.items()}
        for axis, along in run.spectra.shock.items()
    }
    held = f"up to {run.spectra.held:.3g} Hz" if run.spectra.held else "nowhere"
    q = next(iter(first.values())).q
    return replace(
        _panels(lines, _srs_label(q), run.selection, unit="g"),
        id="payload-spectra",
        caption=f"Shock response spectra of {listed(names)} and of the base, maximax, Q = {q:g}: what equipment meets "
        "that stands there. Where the payload's line lies above the base's, isolation makes it worse. "
        f"{run.sample_rate:g} samples a second hold the payload's lines within 1 % {held}; above they are an indication.",
        alt=f"Shock response spectra of {listed(names)} and the base.",
    )


def densities_chart(run: JudgedRun) -> Chart:
    """Draw the power spectral densities of base and payload, a panel for each axis."""
    densities = run.spectra.densities
    lines = {
        # Without the line at 0 Hz, which cannot stand on a logarithmic axis, and where means are removed.
        axis: {name: (one.frequency[1:], one.density[1:] / STANDARD_GRAVITY**2) for name, one in along.items()}
        for axis, along in densities.items()
    }
    first = next(iter(densities.values()))
    one, names = next(iter(first.values())), listed([name for name in first if name != BASE])
    return replace(
        _panels(lines, "PSD [g²/Hz]", run.selection, decades=POWER_DECADES, unit="g²/Hz"),
        id="densities",
        caption=f"Power spectral densities of {names} and of the base while the response is stationary: "
        f"{one.duration:.4g} s, resolution {one.resolution:.3g} Hz, {several(one.segments, 'segment')}, so that each "
        f"density is known to {100.0 * one.standard_error:.0f} %.",
        alt=f"Power spectral densities of {names} and the base.",
    )


def _rms(run: JudgedRun) -> Table:
    return Table(
        id="rms",
        title="Root mean squares, once the response has settled",
        columns=(
            Column("where", align="left"), Column("axis", align="left"), Column("rms", "g"), Column("3 sigma", "g"),
            Column("error of the rms", "%", "z.1f"),
        ),
        rows=[row for name in next(iter(run.spectra.densities.values())) for row in _rms_rows(run, name)],
        note="Along every axis that is moved. Error: one standard deviation of the estimate, from bandwidth and length; "
        "it is known along the base's motion.",
    )  # fmt: skip


def _rms_rows(run: JudgedRun, name: str) -> Iterator[tuple[Cell, ...]]:
    """Yield the root mean square along every axis: of a body that which is judged, of the base that of its density."""
    verdicts = () if isinstance(run.random, Absent) else run.random
    judged = {row.criterion: row.value for row in verdicts if row.subject == name and row.criterion.kind == RMS}
    for axis in "xyz":
        density = run.spectra.densities.get(axis, {}).get(name)
        rms = judged.get(Criterion(RMS, axis=axis), float(density.rms) if density else 0.0)
        if rms > _STILL:
            yield name, axis, rms, 3.0 * rms, float(density.rms_error) if density else None


def _panels(
    lines: Mapping[str, Mapping[str, tuple[Array, Array]]], label: str, selection: Selection, *, unit: str,
    decades: float = _DECADES,
) -> Chart:  # fmt: skip
    """Return frequencies and values by axis and name, a panel for each axis."""
    row: list[Panel] = []
    for axis, along in lines.items():
        curves = [
            Curve(x=f, y=y, name=short(name), kind=BASE if name == "base" else kind_of(selection, name, number))
            for number, (name, (f, y)) in enumerate(along.items())
        ]
        curves.sort(key=lambda curve: curve.kind == BASE)  # which lies behind
        row.append(spectrum_panel(curves, "" if row else label, unit, title=f"along {axis}", decades=decades))
    return Chart(rows=[row], height=190.0)


def spectrum_panel(curves: list[Curve], label: str, unit: str, *, title: str = "", decades: float = _DECADES) -> Panel:
    """Return a panel with logarithmic axes, as far down as matters."""
    high = _ABOVE * max(float(curve.y.max()) for curve in curves) or 1.0  # nothing moved: an empty paper
    low = max(min(float(curve.y.min()) for curve in curves) / _ABOVE, high * 10.0**-decades)
    ends = _end(min(float(curve.x[0]) for curve in curves)), _end(min(float(curve.x[-1]) for curve in curves))
    return Panel(
        curves=curves, ylabel=label, xlabel="frequency [Hz]", title=title, xlim=ends, ylim=(low, high), log="xy",
        unit=unit, xunit="Hz",
    )  # fmt: skip


def _end(frequency: float) -> float:
    """Return where an axis ends: at a power of ten that is near, so that it is named."""
    power = 10.0 ** round(math.log10(frequency))
    return power if abs(frequency / power - 1.0) < _NEAR_DECADE else frequency
