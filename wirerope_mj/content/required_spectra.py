"""Blocks on required and achieved spectra of the base: chart with ratio, lowest point, strong motion, independence of axes."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from wirerope_mj.content.blocks import BASE, LIMIT, Block, Chart, Curve, Panel, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import fixed, listed, number, with_unit
from wirerope_mj.content.spectrum_charts import spectrum_panel
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table, left
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions.achieved_spectra import AchievedSpectrum, AxisPair

ENVELOPED = 0.99  # lowest ratio that envelops: peaks between the samples of the computation are up to 0.8 % higher
_BESIDE = 3  # charts beside each other
# largest coherence, and largest correlation at any delay, of axes that are independent by IEEE 344: either suffices (as ANCO
# Engineers, "IEEE-344 Check", states the standard's criteria)
COHERENT, CORRELATED = 0.5, 0.3


def required_spectrum_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield what the base's motion achieves of the spectra that it was made for; nothing without such a spectrum."""
    if not run.achieved:
        return
    yield required_statement(run)
    yield spectra_table({"": run.achieved})
    if run.axis_pairs:
        yield pairs_table({"": run.axis_pairs})
    yield spectra_chart(run.achieved)


def spectra_chart(achieved: Sequence[AchievedSpectrum]) -> Chart:
    """Draw achieved and required spectra over each other, and their ratio, side by side for each direction."""
    rows = []
    for first in range(0, len(achieved), _BESIDE):
        beside = achieved[first : first + _BESIDE]
        rows += [[panel(one) for one in beside], [_ratio_panel(one) for one in beside]]
    dampings = listed([f"{100.0 * value:g} %" for value in dict.fromkeys(one.damping for one in achieved)])
    return Chart(
        id="required-achieved", rows=rows, height=150.0,
        caption=f"Required response spectrum and the one that the base's motion achieves, {dampings} damping, and their ratio: "
        "nowhere below 1 where the motion envelops what is required.",
        alt="Required and achieved response spectra of the base over each other, and their ratio.",
    )  # fmt: skip


def required_statement(run: JudgedRun) -> Statement:
    """State whether the base's motion envelops the required spectra, whether its axes are independent, and what is lacking."""
    achieved, pairs, simulated = run.achieved, run.axis_pairs, float(run.response.time[-1])
    worst = min(achieved, key=lambda one: one.lowest[0])
    ratio, frequency = worst.lowest
    where = f"along {worst.direction} at {number(frequency)} Hz"
    peaks = [(one.peak / float(one.required[-1]), one.direction) for one in achieved]
    lowest_peak = min(peaks)[0]
    ends = f" from {worst.frequencies[0]:.4g} to {worst.frequencies[-1]:.4g} Hz" if lowest_peak < ENVELOPED else ""
    text = f"The base's motion envelops the required spectrum{ends}: lowest ratio {fixed(ratio, 3)}, {where}"
    if ratio < ENVELOPED:
        text = f"The base's motion falls below the required spectrum, to {fixed(ratio, 3)} of it {where}: " + (
            f"only {simulated:.4g} s of its {run.motion.end:.4g} s are simulated"
            if simulated < run.motion.end
            else "`required-spectrum` in place of `spectrum`, or a factor, makes it envelop"
        )
    values: dict[str, float | str | None] = {"lowest_ratio": ratio, "at_Hz": frequency, "along": worst.direction}
    values["lowest_peak_ratio"] = lowest_peak
    items = []
    if lowest_peak < ENVELOPED:
        ratios = listed([f"{fixed(one, 2)} along {along}" for one, along in peaks if one < ENVELOPED])
        text += f"; its zero-period acceleration, the last level, is not reached: the base's peak is only {ratios} of it"
        items.append(
            "Above the last frequency the achieved spectrum falls to the base's peak: let the file go on to the highest "
            "frequency that matters and end level over an octave, which the peak then reaches as a rule, or scale the motion "
            f"by {fixed(1.0 / lowest_peak, 2)} where a standard asks for the zero-period acceleration itself."
        )
    if pairs:
        coherence, correlation = max(pair.coherence for pair in pairs), max(pair.largest_correlation for pair in pairs)
        independent = all(pair.coherence <= COHERENT or pair.largest_correlation <= CORRELATED for pair in pairs)
        text += f"; its axes are {'' if independent else 'not '}independent (largest coherence {fixed(coherence, 2)}, "
        text += f"correlation {fixed(correlation, 2)} at any delay)"
        values |= {"largest_coherence": coherence, "largest_correlation": correlation}
    if run.motion.velocity_jumps:
        items.append("Sudden changes of the base's velocity are not part of the achieved spectrum.")
    tone = "within" if min(ratio, lowest_peak) >= ENVELOPED else "unjudged"
    return Statement("required-spectrum", f"{text}.", items=tuple(items), tone=tone, values=values)


def spectra_table(achieved: Mapping[str, Sequence[AchievedSpectrum]]) -> Table:
    """Tabulate lowest ratio, zero-period acceleration and strong motion of each spectrum, by load case ("" for one alone)."""
    rows = []
    for case, spectra in achieved.items():
        for one in spectra:
            ratio, frequency = one.lowest
            cells: list[Cell] = [case] if case else []
            cells += [one.direction, one.damping, Mark(ratio, "within" if ratio >= ENVELOPED else "near"), frequency]
            cells += [float(one.ratio.max()), float(one.required[-1]), one.peak, one.peak / float(one.required[-1])]
            rows.append([*cells, *(ends[1] - ends[0] for ends in (one.strong, one.significant))])
    columns = [
        *(left("load case") if "" not in achieved else []), *left("along"), Column("damping", "%", "z.3g"),
        Column("lowest\nachieved /\nrequired", form="z.3f"), Column("at", "Hz"), Column("highest", form="z.2f"),
        Column("ZPA\nrequired", "g", "z.3f"), Column("ZPA\nachieved", "g", "z.3f"), Column("ratio", form="z.2f"),
        Column("strong\nmotion", "s", "z.1f"), Column("5 to 95 %\nArias", "s", "z.1f"),
    ]  # fmt: skip
    return Table(
        "required-spectra", "Required and achieved response spectra of the base", columns, rows,
        note="ZPA: zero-period acceleration; required, that of the spectrum's last frequency; achieved, the base's peak. "
        "Strong motion: from the first to the last instant above a quarter of the peak; then, while the Arias intensity rises.",
    )  # fmt: skip


def pairs_table(pairs: Mapping[str, Sequence[AxisPair]]) -> Table:
    """Tabulate correlation and coherence of each pair of axes, by load case ("" for one alone)."""
    rows, widths = [], []
    for case, of_case in pairs.items():
        for pair in of_case:
            cells: list[Cell] = [case] if case else []
            rows.append([
                *cells, ", ".join(pair.directions), pair.correlation, pair.largest_correlation, pair.coherence, pair.frequency,
            ])  # fmt: skip
            widths.append(with_unit(pair.resolution, "Hz", digits=2))
    return Table(
        "axis-pairs", "Independence of the axes, while both are significant",
        [
            *(left("load case") if "" not in pairs else []), *left("axes"), Column("correlation", form="z.2f"),
            Column("largest at\nany delay", form="z.2f"), Column("largest\ncoherence", form="z.2f"), Column("at", "Hz"),
        ],
        rows,
        note=f"Coherence by Welch's method, resolution {listed(list(dict.fromkeys(widths)))}, half overlapping, within the "
        "required spectra; of two independent noises it is up to 0.3 so. Independent, by IEEE 344 as laboratories state "
        f"it: a coherence of at most {COHERENT:g}, or a correlation of at most {CORRELATED:g} at any delay.",
    )  # fmt: skip


def required_curve(one: AchievedSpectrum) -> Curve:
    return Curve(one.frequencies, in_unit(one.required, "g"), name="required", kind=LIMIT, dash="dashed")


def panel(one: AchievedSpectrum) -> Panel:
    curves = [Curve(one.frequencies, in_unit(one.achieved, "g"), name="achieved", kind=BASE), required_curve(one)]
    return spectrum_panel(curves, "acceleration [g]", "g", title=f"along {one.direction}, {100.0 * one.damping:g} %")


def _ratio_panel(one: AchievedSpectrum) -> Panel:
    ends, (ratio, frequency) = (float(one.frequencies[0]), float(one.frequencies[-1])), one.lowest
    low, high = min(0.9, 0.98 * ratio), max(1.1, 1.02 * float(one.ratio.max()))
    return Panel(
        [Curve(one.frequencies, one.ratio, name="achieved", kind=BASE)], "achieved / required", xlabel="frequency [Hz]",
        limits=[("", 1.0)], dots=[(frequency, ratio)], xlim=ends, ylim=(float(np.floor(10 * low) / 10), high), log="x",
        xunit="Hz",
    )  # fmt: skip
