"""Content of a run against tests: agreement, measures, ratings, and measured and calculated curves over each other."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from wirerope_mj.assessment.correlation import ChannelCorrelation, Correlation
from wirerope_mj.assessment.correlation.over_frequency import THREE_DB, SpectrumRatio
from wirerope_mj.content.blocks import MEASURED, MODEL, Block, Chart, Content, Curve, Panel, Section, Statement, short
from wirerope_mj.content.histories import Histories
from wirerope_mj.content.numbers import several, with_unit
from wirerope_mj.content.spectrum_charts import POWER_DECADES, spectrum_panel
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY, in_unit
from wirerope_mj.mounts.isolator import AXES

_UNITS = {"acceleration": "g", "velocity": "m/s", "displacement": "mm", "deflection": "mm", "force": "kN"}
_TONES = {"excellent": "within", "good": "within", "fair": "near", "poor": "exceeded"}
_HEIGHT, _MOST_DB = 105.0, 12.0  # height of a panel; largest ratio that is drawn [dB]


def correlation_content(run: str, tests: Sequence[Correlation]) -> Content:
    """Compose the content of a run against tests: the worst agreement, how their clocks were matched, and their sections."""
    names = " and ".join(test.name for test in tests)
    worst = min(tests, key=lambda test: min(channel.rating.overall for channel in test.responses))
    facts = []
    for test in tests:
        channel = test.channels[0]
        first, last = channel.pair.time[[0, -1]].round(4) + 0.0
        text = f"compared from {first:g} to {last:g} s at {channel.pair.rate:.5g} Hz"
        if test.aligned_by:
            moved = abs(test.delay) * channel.channel.rate >= 0.5
            clock = f"moved by {with_unit(-test.delay, 'ms')}" if moved else "agrees"
            clock += "" if test.clock == 1.0 else f", and its seconds made {test.clock:.7g} of the run's"
            text = f"{clock}, by {test.aligned_by}; {text}"
        else:
            text = f"as given; {text}"
        facts.append((f"Clock of {test.name}", text))
    question = f"How well does the model agree with what was measured in {names}?"
    return Content(
        title=f"{run} against {names}", verdict=agreement(worst), facts=tuple(facts), question=(question,),
        sections=tuple(section for section in correlation_sections(tests) if len(tests) > 1 or section.id != "tests"),
    )  # fmt: skip


def correlation_sections(tests: Sequence[Correlation]) -> Iterator[Section]:
    """Yield for each test agreement, warnings, measures, and charts of histories, spectra, transmissibility and loops."""
    kinds = {"histories": _histories, "spectra": _spectra, "transmissibility": _transmissibility, "loops": _loops}
    yield Section("tests", "Against measurements", lambda: map(agreement, tests), "headline")
    for test in tests:
        text = "Said of the measurement, on which every figure here rests:"
        warnings = Statement(f"warnings-{test.name}", text, items=test.warnings, tone="unjudged")
        if test.warnings:
            yield Section(f"warnings-{test.name}", "", partial(list, [warnings]), "headline")
        measures = [test.table, test.ratings]
        yield Section(f"measures-{test.name}", f"Agreement with {test.name}", partial(list, measures), "summary")
        for kind, build in kinds.items():
            yield Section(f"{kind}-{test.name}", f"{test.name}: {kind}", partial(build, test))


def agreement(test: Correlation) -> Statement:
    """State the largest deviation of the model from a test, and the rating of the worst channel."""
    worst = min(test.responses, key=lambda channel: channel.rating.overall)
    rated = f"lowest ISO/TS 18571 rating {worst.rating.overall:.2f}, {worst.rating.grade} ({worst.label})"
    band = max(
        (channel.worst_band for channel in test.responses if channel.worst_band),
        key=lambda channel: channel.weight,
        default=None,
    )
    values = {} if band is None else {"first_Hz": band.first, "last_Hz": band.last, "deviation": band.deviation}
    return Statement(
        f"agreement-{test.name}", f"{test.name}: {test.statement[:-1]}; {rated}.",
        tone="unjudged" if test.other_base else _TONES[worst.rating.grade],
        values={**values, "rating": worst.rating.overall, "delay_s": test.delay, "clock": test.clock},
    )  # fmt: skip


def with_ghosts(panels: Histories, tests: Sequence[Correlation]) -> Histories:
    """Add measured curves to the panels of a run, and for each channel a panel of model and measurement."""
    overlaid = dict(panels)
    for test in tests:
        for channel in test.channels:
            kind, _, subject = channel.channel.subject.partition("/")
            axis = "xyz".index(channel.channel.axis)
            key = (channel.channel.quantity, AXES[axis] if kind == "mount" else "xyz"[axis])
            panel = channel_panel(channel)
            if key in overlaid and kind != "base":
                ghost = replace(panel.curves[1], name=short(f"{subject} measured"), kind=MEASURED)
                overlaid[key] = replace(overlaid[key], curves=[*overlaid[key].curves, ghost])
            overlaid["measured", f"{channel.channel.quantity}s", test.name, channel.label] = replace(
                panel, title=f"{panel.title} {panel.ylabel}"
            )
    return overlaid


def channel_panel(channel: ChannelCorrelation, model: str = "model") -> Panel:
    unit, pair = _UNITS[channel.channel.quantity], channel.pair
    curves = [_curve(pair.time, in_unit(y, unit), name) for name, y in ((model, pair.model), ("measured", pair.measured))]
    return Panel(curves, f"[{unit}]", title=channel.label, unit=unit, xlim=(pair.time[0], pair.time[-1]))


def _curve(x: Array, y: Array, name: str) -> Curve:
    row = int(np.abs(y).argmax())
    return Curve(
        x, y, name=name, kind=MODEL if name == "model" else MEASURED, peak=(float(x[row]), float(y[row])),
        dash="dashed" if name == "model" else "",
    )  # fmt: skip


def _histories(test: Correlation) -> Iterator[Block]:
    """Yield a chart of measured and calculated histories of all channels."""
    spans = [channel.pair.time[channel.event][[0, -1]] for channel in test.responses]
    window = min(float(span[0]) for span in spans), max(float(span[1]) for span in spans)
    panels = [replace(channel_panel(channel), xlim=window) for channel in test.channels]
    rows = [
        [replace(panel, title=f"{panel.title} {panel.ylabel}", xlabel="time [s]" if panel is panels[-1] else "")]
        for panel in panels
    ]
    saturated = [channel.label for channel in test.channels if channel.channel.saturated.any()]
    cut = f" Saturated, so that the true peak is higher: {'; '.join(saturated)}." if saturated else ""
    yield Chart(
        id=f"histories-{test.name}", rows=rows, height=_HEIGHT,
        caption=f"As measured in {test.name}, and as the model says: {several(len(panels), 'channel')} on channel clock, while "
        f"responses are above 5 % of their peaks.{cut}",
        alt=f"Histories measured in {test.name} and of the model.",
    )  # fmt: skip


def _spectra(test: Correlation) -> Iterator[Block]:
    """Yield a chart of shock response spectra and roots of PSDs, of model and test, and of their ratios."""
    rows = [
        [_spectra_panel(channel, ratio), _ratio_panel(ratio)]
        for channel in test.responses
        for ratio in (channel.shock, channel.density)
        if ratio
    ]
    if rows:
        yield Chart(
            id=f"spectra-{test.name}", rows=rows, height=_HEIGHT,
            caption="Left: shock response spectra (maximax, Q = 10) of accelerations that die away or last few cycles, and "
            "roots of power spectral densities in sixths of an octave, where there is more than noise. Right: model over "
            "measurement; the dashed lines are 3 dB.",
            alt=f"Spectra measured in {test.name} and of the model, and their ratios.",
        )  # fmt: skip


def _spectra_panel(channel: ChannelCorrelation, ratio: SpectrumRatio) -> Panel:
    """Draw spectra of model and measurement: an SRS in its unit, the root of a PSD over its measured peak."""
    unit = _UNITS[channel.channel.quantity]
    factor = in_unit(1.0, unit) if unit != "g" else 1.0 / STANDARD_GRAVITY
    shown = unit if ratio.kind == "SRS" else "relative"
    curves = [
        _curve(ratio.frequency, (factor if ratio.kind == "SRS" else 1.0 / ratio.measured.max()) * y, name)
        for name, y in (("model", ratio.model), ("measured", ratio.measured))
    ]
    label = f"SRS [{unit}]" if ratio.kind == "SRS" else "root of PSD [-]"
    return spectrum_panel(curves, label, shown, title=f"{channel.label}: {ratio.kind}", decades=POWER_DECADES)


def _ratio_panel(ratio: SpectrumRatio) -> Panel:
    """Draw the ratio of model to measurement over the frequency [dB]."""
    decibels = 20.0 * np.log10(np.maximum(ratio.ratio, 1e-12))
    three_db = 20.0 * float(np.log10(THREE_DB))
    return Panel(
        [Curve(ratio.frequency, np.clip(decibels, -_MOST_DB, _MOST_DB), name="", kind=MODEL)],
        "model / meas. [dB]", xlabel="frequency [Hz]", title=f"ratio, {100.0 * ratio.within_3db:.0f} % within 3 dB",
        limits=[("+3 dB", three_db), ("-3 dB", -three_db)], xlim=(float(ratio.frequency[0]), float(ratio.frequency[-1])),
        ylim=(-_MOST_DB, _MOST_DB), log="x", unit="dB", xunit="Hz",
    )  # fmt: skip


def _transmissibility(test: Correlation) -> Iterator[Block]:
    """Yield a chart of acceleration over that of the measured base by frequency, of model and test."""
    rows = []
    for channel in test.channels:
        ratio = channel.transmissibility
        if ratio is not None:
            curves = [
                _curve(ratio.frequency, np.abs(y), name) for name, y in (("model", ratio.model), ("measured", ratio.measured))
            ]
            rows.append([spectrum_panel(curves, "[-]", "", title=f"{channel.label}: FRAC {ratio.frac:.2f}")])
    if rows:
        yield Chart(
            id=f"transmissibility-{test.name}", rows=rows, height=_HEIGHT,
            caption="Acceleration over that of the measured base along the same axis, where the base moves; motion across it "
            "is in there, too.",
            alt=f"Transmissibilities measured in {test.name} and of the model.",
        )  # fmt: skip


def _loops(test: Correlation) -> Iterator[Block]:
    """Yield a chart of force over deflection, measured and calculated, of mounts with both channels."""
    by_key = {channel.channel.key: channel for channel in test.channels}
    panels = []
    for key, channel in by_key.items():
        force = by_key.get(key.replace("deflection", "force"))
        if channel.channel.quantity == "deflection" and force is not None:
            curves = [
                Curve(in_unit(x, "mm"), in_unit(y, "kN"), name=name, kind=kind)
                for name, kind, x, y in (
                    ("model", MODEL, channel.pair.model, force.pair.model),
                    ("measured", MEASURED, channel.pair.measured, force.pair.measured),
                )
            ]
            title = channel.label.removesuffix(" deflection")
            panels.append(Panel(curves, "force [kN]", xlabel="deflection [mm]", title=title, unit="kN", xunit="mm"))
    if panels:
        yield Chart(
            id=f"loops-{test.name}", rows=[panels[row : row + 2] for row in range(0, len(panels), 2)], height=190.0,
            caption="Force over deflection, counted from the start.", alt=f"Loops measured in {test.name} and of the model.",
        )  # fmt: skip
