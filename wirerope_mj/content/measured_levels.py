"""Break points over the spectrum of a measured record: their slopes, how they were made, and how far they lie above it."""

from collections.abc import Sequence

from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.motions.break_points import SpectrumEnvelope


def measured_levels_content(record: str, envelopes: Sequence[SpectrumEnvelope], files: Sequence[str]) -> Content:
    """Compose the content of break points that envelop the spectrum of a record; `files` hold them, if written."""
    first = envelopes[0]
    if first.q is None:
        name = "Power spectral density"
        how = (
            f"Power spectral density by Welch's method, Hann windows that overlap by half, lines {first.resolution:.3g} Hz "
            f"apart, each within {100.0 * (2.0 / first.degrees_of_freedom) ** 0.5:.2g} % (standard error)"
        )
    else:
        name = "Shock response spectrum"
        how = (
            f"Shock response spectrum, largest absolute acceleration, Q = {first.q:g}, {first.resolution:g} lines to an octave"
        )
    how += (
        ". Within its band the curve lies on or above every line. Slopes are whole decibels to an octave, frequencies those of "
        "the series R20; the curve is the lowest such one in decibels over octaves."
    )
    option = "psd" if first.q is None else "required-spectrum"
    length = "60 s" if first.q is None else "30 s"
    damping = "" if first.q is None else f" damping {50.0 / first.q:g} %"
    played = "; ".join(f"{file} {length} {e.axis}{damping}" for file, e in zip(files, envelopes, strict=False))
    use = [Statement("play", f'Played by: wirerope shock MODEL --{option} "{played}"')] if files else []
    return Content(
        title=f"{name} of {record}, enveloped",
        verdict=_above(first),
        sections=(Section("levels", "", lambda: [*map(_points, envelopes), Statement("method", how), *use], "summary"),),
    )


def _above(envelope: SpectrumEnvelope) -> Statement:
    """State how far the enveloping curve lies above the lines of the measured spectrum."""
    text = f"Along {envelope.axis}"
    values: dict[str, float | str | None] = {"exceedances": envelope.exceedances, "mean_excess_db": envelope.mean_excess}
    if envelope.q is None:
        curve, measured = envelope.rms
        text += f" {with_unit(curve, 'm/s^2')} rms, {curve / measured:.3g} times the measured {with_unit(measured, 'm/s^2')},"
        values |= {"rms_m_s2": curve, "measured_rms_m_s2": measured}
    low, high = envelope.points[0][0], envelope.points[-1][0]
    text += (
        f" {envelope.mean_excess:.2g} dB above the measured lines in the mean; {envelope.exceedances} of "
        f"{envelope.levels.size} lines from {low:g} to {high:g} Hz exceed it."
    )
    return Statement(f"above-{envelope.axis}", text, values=values)


def _points(envelope: SpectrumEnvelope) -> Table:
    """Tabulate break points and the slopes between them."""
    density = envelope.q is None
    slopes = [f"{slope:+.0f}".replace("+0", "0").replace("-0", "0") for slope in envelope.slopes] + [""]
    return Table(
        f"break-points-{envelope.axis}", f"Along {envelope.axis}",
        columns=(
            Column("frequency", "Hz", ".6g"),
            Column("density", "g²/Hz", ".3g") if density else Column("acceleration", "g", ".3g"),
            Column("slope to the next [dB/oct]"),
        ),
        rows=[(f, level, slope) for (f, level), slope in zip(envelope.points, slopes, strict=True)],
        note=_above(envelope).text,
    )  # fmt: skip
