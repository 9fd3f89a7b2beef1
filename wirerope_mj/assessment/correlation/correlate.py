"""Agreement of a run with a test: all measures of all channels, in a table and a sentence."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy

from wirerope_mj.assessment.correlation.over_frequency import (
    Band,
    SpectrumRatio,
    Transmissibility,
    coherence,
    density_ratio,
    shock_ratio,
    spectral_assurance,
    transmissibility,
)
from wirerope_mj.assessment.correlation.pairs import Delay, Pair, clock_of, coarser, delay_of, model_history, pair_of
from wirerope_mj.assessment.correlation.ratings import INNER, MagnitudePhase, Rating, iso_rating, russell, sprague_geers
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table
from wirerope_mj.foundation.units import significant
from wirerope_mj.motions import Measured, MeasuredChannel
from wirerope_mj.mounts.isolator import AXES

# Sampling rate of ISO/TS 18571 [Hz], and most samples that are rated: the cost of warping grows with their square
_ISO_RATE, _ISO_SAMPLES = 1e4, 4000

_LEAST_MARGIN = 8  # samples added before and after an event

_CLOCK_CORRELATION = 0.5  # correlation from which a channel's delay is taken for that of the clock
_SAME_INPUT = 0.15  # Russell's comprehensive error of the base above which it is another motion: excellent below
_NOTABLE = 0.1  # deviation of a ratio of two spectra, or of the base's rms values, below which it is not reported


@dataclass(frozen=True, kw_only=True, eq=False)
class ChannelCorrelation:
    """Agreement of a run with one measured channel."""

    pair: Pair = field(repr=False)  # both histories
    delay: Delay  # delay of this channel alone, before the test's delay is subtracted
    # both histories of the base along the same axis, None where it was not measured
    base: Pair | None = field(default=None, repr=False)

    @property
    def channel(self) -> MeasuredChannel:
        return self.pair.channel

    @property
    def label(self) -> str:
        """Name of the channel in tables and sentences, such as "point rack_top, z"."""
        return channel_label(self.channel)

    @cached_property
    def peak_ratio(self) -> float:
        return float(np.abs(self.pair.model).max() / np.abs(self.pair.measured).max())

    @cached_property
    def rms_ratio(self) -> float:
        return float(np.linalg.norm(self.pair.model) / np.linalg.norm(self.pair.measured))

    @cached_property
    def sprague_geers(self) -> MagnitudePhase:
        return sprague_geers(self.pair.measured, self.pair.model)

    @cached_property
    def russell(self) -> MagnitudePhase:
        return russell(self.pair.measured, self.pair.model)

    @cached_property
    def event(self) -> slice:
        """Samples from the first to the last at which a history exceeds 5 % of the measured peak, widened by a tenth."""
        measured, model = self.pair.measured, self.pair.model
        above = np.flatnonzero(np.maximum(np.abs(measured), np.abs(model)) > INNER * np.abs(measured).max())
        margin = (above[-1] - above[0]) // 10 + _LEAST_MARGIN
        return slice(max(int(above[0] - margin), 0), min(int(above[-1] + margin) + 1, measured.size))

    @cached_property
    def rating(self) -> Rating:
        """Rating after ISO/TS 18571 of the event alone, at 10 000 Hz or the rate that gives it 4000 samples.

        Before and after the event there is noise, which would be rated, too.
        """
        histories = self.pair.measured[self.event], self.pair.model[self.event]
        sampled, size = self.pair.rate, histories[0].size
        rate = min(_ISO_RATE, (_ISO_SAMPLES - 1) * sampled / (size - 1))
        if rate <= sampled:
            return iso_rating(*(coarser(values, sampled, rate) for values in histories))
        time, finer = np.arange(size) / sampled, np.arange(int((size - 1) / sampled * rate) + 1) / rate
        return iso_rating(*(scipy.interpolate.CubicSpline(time, values)(finer) for values in histories))

    @cached_property
    def shock(self) -> SpectrumRatio | None:
        """Ratio of the shock response spectra; None for a channel that is no acceleration or no transient."""
        return shock_ratio(self.pair)

    @cached_property
    def density(self) -> SpectrumRatio | None:
        """Ratio of the roots of the power spectral densities; None where the interval is too short."""
        return density_ratio(self.pair)

    @property
    def spectrum(self) -> SpectrumRatio | None:
        """Ratio of the shock response spectra, or else of the densities."""
        return self.shock or self.density

    @cached_property
    def coherence(self) -> float | None:
        """Mean coherence, weighted by the measured density; None where the interval is too short."""
        return coherence(self.pair)

    @cached_property
    def transmissibility(self) -> Transmissibility | None:
        """Transmissibility from the measured base to this channel; None where the base was not measured."""
        return None if self.base is None else transmissibility(self.base, self.pair)

    @cached_property
    def frac(self) -> float:
        """Frequency response assurance criterion of the transmissibilities, or of the spectra without a measured base."""
        return spectral_assurance(self.pair) if self.transmissibility is None else self.transmissibility.frac

    @property
    def worst_band(self) -> Band | None:
        """Band in which the spectra differ most; None if no band differs by a tenth."""
        return self.spectrum.bands[0] if self.spectrum and self.spectrum.bands else None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Correlation(Summarised):
    """Agreement of a run with a test."""

    name: str  #: of the test
    channels: tuple[ChannelCorrelation, ...]  #: the compared channels, in the order of the map
    delay: float  #: delay of the test's clock, subtracted before the comparison [s]
    aligned_by: str  #: label of the channel whose delay that is; "" where the clock was not moved
    clock: float = 1.0  #: seconds of the run in a second of the test's clock, found where the base was measured
    warnings: tuple[str, ...] = ()  #: of the record and of the comparison

    @property
    def responses(self) -> tuple[ChannelCorrelation, ...]:
        """Channels of bodies, points and mounts; the base's channels if there are no others."""
        return tuple(row for row in self.channels if row.channel.subject != "base") or self.channels

    @cached_property
    def other_base(self) -> str:
        """Sentence on a base of the run that moves otherwise than the measured base; "" if they move alike.

        A direction in which both peaks are below a tenth of the largest along any direction is left out.
        """
        peaks = [
            (float(np.abs([row.pair.measured, row.pair.model]).max()), row)
            for row in self.channels
            if row.channel.subject == "base"
        ]
        largest = {row.channel.quantity: peak for peak, row in sorted(peaks, key=lambda pair: pair[0])}
        apart = [
            f"along {row.channel.axis} (rms {row.rms_ratio:.2f} times, Russell {row.russell.comprehensive:.2f})"
            for peak, row in peaks
            if peak >= _NOTABLE * largest[row.channel.quantity]
            and (abs(row.rms_ratio - 1.0) > _NOTABLE or row.russell.comprehensive > _SAME_INPUT)
        ]
        return f"The base of the run does not move as the measured one does {' and '.join(apart)}." if apart else ""

    @cached_property
    def statement(self) -> str:
        """Sentences on a differing base and the largest deviation: "Model 25 % low between 6 and 9 Hz (point rack_top, z)."."""
        return f"{self.other_base} {self._deviation()}".lstrip()

    def _deviation(self) -> str:
        """Describe the largest deviation of the model from the measurement in a sentence."""

        def span(first: float, last: float, words: tuple[str, str]) -> str:
            low, high = (significant(frequency, 2) for frequency in (first, last))
            return f"{words[0]} {low} {words[1]} {high} Hz"

        banded = [(row.worst_band, row) for row in self.responses]
        worst = max(((band, row) for band, row in banded if band), key=lambda pair: pair[0].weight, default=None)
        if worst is not None:
            band, row = worst
            side, size = ("high" if band.deviation > 0.0 else "low"), abs(100.0 * band.deviation)
            where = f"at {significant(band.first, 2)} Hz"
            if band.last > band.first:
                where = span(band.first, band.last, ("between", "and"))
            return f"Model {size:.0f} % {side} {where} ({row.label})."
        failed = {row.label: "rated poor" for row in self.responses if row.rating.grade == "poor"}
        failed |= {row.label: "better upside down" for row in self.responses if row.delay.upside_down}
        named = " and ".join(f"{label} ({why})" for label, why in failed.items())
        if len(failed) == len(self.responses):
            return f"Model in no channel as measured: {named}."
        spectra = [row.spectrum for row in self.responses if row.spectrum and row.label not in failed]
        if not spectra:
            return "The test is too short to say over which frequencies the model is low or high."
        first, last = max(row.frequency[0] for row in spectra), min(row.frequency[-1] for row in spectra)
        which = "the channel" if len(spectra) == 1 else f"all {len(spectra)} channels"
        which = f"{len(spectra)} of {len(spectra) + len(failed)} channels, not in {named}" if failed else which
        return f"Model within {100.0 * _NOTABLE:.0f} % of the measurement {span(first, last, ('from', 'to'))} in {which}."

    @cached_property
    def table(self) -> Table:
        """Table of the measures of agreement of every channel."""
        columns = (
            Column("channel", align="left"), Column("peak", "", "z.3f"), Column("rms", "", "z.3f"), Column("M", "%", "+z.1f"),
            Column("P", "%", "z.1f"), Column("C", "%", "z.1f"), Column("Russell", "", "z.3f"), Column("ISO", "", "z.2f"),
            Column("grade", align="left"), Column("in 3 dB", "%", "z.0f"), Column("coherence", "", "z.2f"),
            Column("FRAC", "", "z.2f"),
        )  # fmt: skip
        rows: list[Sequence[Cell]] = []
        for row in self.channels:
            spread, within = row.sprague_geers, row.spectrum.within_3db if row.spectrum else None
            rows.append((
                row.label, row.peak_ratio, row.rms_ratio, spread.magnitude, spread.phase, Mark(spread.comprehensive, "strong"),
                row.russell.comprehensive, Mark(row.rating.overall, "strong"), row.rating.grade, within, row.coherence,
                row.frac,
            ))  # fmt: skip
        return Table(
            id=f"correlation-{self.name}", title=f"{self.name}: model over measurement", columns=columns, rows=rows,
            note="peak, rms: model over measurement. M, P, C: magnitude, phase and both, Sprague and Geers. Russell: his "
            "comprehensive error, excellent below 0.15, acceptable below 0.28. ISO: overall rating of ISO/TS 18571, 1 is "
            "agreement. in 3 dB: part of the octaves in which the spectra differ by less. FRAC: of transmissibilities where "
            "the base was measured, else of the spectra.",
        )  # fmt: skip

    @cached_property
    def ratings(self) -> Table:
        """Table of the parts of every channel's rating, and of its own delay."""
        columns = (
            Column("channel", align="left"), Column("corridor", "", "z.2f"), Column("phase", "", "z.2f"),
            Column("magnitude", "", "z.2f"), Column("slope", "", "z.2f"), Column("overall", "", "z.2f"),
            Column("own delay", "ms", "z.2f"), Column("spectra", align="left"), Column("column", align="left"),
        )  # fmt: skip
        rows: list[Sequence[Cell]] = []
        for row in self.channels:
            r, kind = row.rating, row.spectrum.kind if row.spectrum else "-"
            parts = (r.corridor, r.phase, r.magnitude, r.slope, Mark(r.overall, "strong"))
            rows.append((row.label, *parts, row.delay.value, kind, row.channel.column))
        return Table(
            id=f"ratings-{self.name}", title=f"{self.name}: ratings after ISO/TS 18571", columns=columns, rows=rows,
            note="Overall: 0.4 corridor, 0.2 each of the others. Own delay: by which this channel alone fits best.",
        )  # fmt: skip

    def _summary(self) -> tuple[str, dict[str, str]]:
        return f"Correlation with {self.name}: {self.statement}", {
            row.label: f"peak {row.peak_ratio:.3f}, ISO/TS 18571 {row.rating.overall:.2f} ({row.rating.grade})"
            for row in self.channels
        }


def channel_label(channel: MeasuredChannel) -> str:
    """Name a channel in tables and sentences: "point rack_top, z", "mount m1, axial force"."""
    kind, _, name = channel.subject.partition("/")
    subject = name if kind == "body" else f"{kind} {name}".strip()
    axis = AXES["xyz".index(channel.axis)] if kind == "mount" else channel.axis
    quantity = "" if channel.quantity == "acceleration" else f" {channel.quantity}"
    return f"{subject}, {axis}{quantity}"


def correlate(response: Response, measured: Measured, *, align: bool = True) -> Correlation:
    """Compare a run with a test: every measured channel with the model's, on one clock.

    Args:
        response: of the run, whose base moved as in the test.
        measured: the test.
        align: whether the test's clock is moved by the delay that is found: of the base's acceleration where that was
            measured, since model and test share it, else of the channel that fits best. Of the base the clock's rate is found,
            too: a model whose frequency is off looks like a clock that is.

    Raises:
        RecordError: the run does not have what was measured, or both last together for less than 16 samples, or no channel
            tells when it was taken.
    """
    for channel in measured.channels:
        model_history(response, measured, channel)  # says first that the run has every channel
    alive = [channel for channel in measured.channels if np.ptp(channel.values)]
    if not alive:
        raise RecordError(f"{measured.path}: every channel is dead: there is nothing to compare.")
    delays = {channel.key: delay_of(response, measured, channel) for channel in alive}
    if measured.start:
        ambiguous = [channel for channel in alive if delays[channel.key].alike is not None]
        delays |= {channel.key: delay_of(response, measured, channel, around=0.0) for channel in ambiguous}
    clear = [channel for channel in alive if delays[channel.key].alike is None]
    base_channels = [
        channel for channel in clear if channel.subject == "base" and abs(delays[channel.key].correlation) >= _CLOCK_CORRELATION
    ]
    best = max(base_channels or clear, key=lambda channel: abs(delays[channel.key].correlation), default=alive[0])
    moved = align and best in clear and abs(delays[best.key].correlation) >= _CLOCK_CORRELATION
    delay, clock = delays[best.key].value if moved else 0.0, 1.0
    if moved or not align:
        delays = {channel.key: delay_of(response, measured, channel, around=delay) for channel in alive}
    left_out = {channel.key: delays[channel.key] for channel in alive if delays[channel.key].alike is not None}
    if len(left_out) == len(alive):
        raise RecordError(f"{measured.path}: {_ambiguity_text(best, delays[best.key])}")
    alive = [channel for channel in alive if channel.key not in left_out]
    if moved and best.subject == "base" and not delays[best.key].upside_down:
        delay, clock = clock_of(response, measured, best, delay=delay)
    pairs = {channel.key: pair_of(response, measured, channel, delay=delay, clock=clock) for channel in alive}
    bases = {p.channel.axis: p for p in pairs.values() if p.channel.key.startswith("base acceleration")}
    bases_of = {c.key: None if c.subject.startswith(("base", "mount/")) else bases.get(c.axis) for c in alive}
    channels = tuple(ChannelCorrelation(pair=pair, delay=delays[key], base=bases_of[key]) for key, pair in pairs.items())
    warnings = _warnings(measured, channels, delay, left_out, unaligned=best if align and not moved else None)
    return Correlation(
        name=measured.name, channels=channels, delay=delay, aligned_by=channel_label(best) if moved else "",
        clock=clock, warnings=(*measured.warnings, *warnings),
    )  # fmt: skip


def _warnings(
    measured: Measured, channels: Sequence[ChannelCorrelation], delay: float, left_out: Mapping[str, Delay],
    unaligned: MeasuredChannel | None,
) -> Iterator[str]:  # fmt: skip
    """Yield warnings: no common clock, ambiguous, dead or saturated channels, channels upside down or on other clocks."""
    name = measured.name
    if unaligned is not None:
        largest = max(abs(row.delay.correlation) for row in channels if row.channel == unaligned)
        yield (
            f'{name}: no delay makes column "{unaligned.column}" like the run (largest correlation {largest:.2f}): its clock '
            "was not moved. Say when its first sample was taken and how fast its clock runs (--start, --clock); or is it "
            "another test than this run's?"
        )
    for channel in measured.channels:
        if channel.key in left_out:
            yield f"{name}: {_ambiguity_text(channel, left_out[channel.key])}"
        elif not np.ptp(channel.values):
            yield f'{name}: column "{channel.column}" is dead and is not compared.'
    for row in channels:
        column, late = row.channel.column, row.delay.value - delay
        # Period of the measured history's mean frequency, that of its root mean square slope.
        values = row.pair.measured - row.pair.measured.mean()
        slope = float(np.linalg.norm(np.gradient(values)))
        period = 2.0 * np.pi * float(np.linalg.norm(values)) / (slope * row.pair.rate) if slope else np.inf
        if row.delay.upside_down:
            yield f'{name}: column "{column}" fits {row.label} better upside down: is its axis -{row.channel.axis}?'
        elif unaligned is None and row.delay.correlation >= _CLOCK_CORRELATION and abs(late) > period:
            yield (
                f'{name}: column "{column}" fits {1e3 * late:+.4g} ms after the others, more than a '
                "period: is it on another clock?"
            )
        if row.channel.saturated.any():
            yield f'{name}: column "{column}" was saturated: its true peak is higher, and the peak ratio lower.'


def _ambiguity_text(channel: MeasuredChannel, delay: Delay) -> str:
    """Explain why a channel is not compared that fits the model equally well at two delays."""
    return (
        f'column "{channel.column}" is not compared: it fits {channel_label(channel)}, or its negative, alike when it is '
        f"moved by {-1e3 * delay.value:+.4g} ms and by {-1e3 * (delay.alike or 0.0):+.4g} ms; a vibration that dies away tells "
        "neither when it began nor its sign. Say when its first sample was taken (--start)."
    )
