"""What a frequency response says, whoever shows it: resonances, folds, what is stable, and the curves of all levels."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from importlib.metadata import version

import numpy as np

from wirerope_mj.assessment.criteria.travel import untested
from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.content.numbers import several
from wirerope_mj.content.orbits import orbit_blocks
from wirerope_mj.content.panels import BASE, Chart, Curve, Panel
from wirerope_mj.content.selection import COLOURS
from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.summary import (
    BranchCurve,
    LevelSummary,
    OrderBand,
    ResonancePeak,
    order_statements,
)
from wirerope_mj.dynamics.periodic import Branch
from wirerope_mj.dynamics.sweep import FrequencySweep
from wirerope_mj.foundation.directions import direction_text
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.validity import BELOW

_MARKED = 0.05  # Ratio to the fundamental from which another harmonic gives a peak its name
_BESIDE, _ABOVE = 1.01, 1.12  # room about the curves, as factors
_NUMBERS = (Column("frequency", "Hz", ".5g"), Column("amplitude", "m/s²", ".4g"), Column("transmissibility", form=".4g"))


def response_content(result: FrequencyResponse, findings: Sequence[LevelSummary], bands: Sequence[OrderBand] = ()) -> Content:
    """Compose what a frequency response says, level by level, with the orders of a machine against its resonances."""
    options, (start, stop) = result.options, result.options.range
    assert options.response_direction is not None
    return Content(
        title=f"{result.name}: frequency response",
        facts=(
            ("Base", f"along {direction_text(options.direction)}"),
            ("Response", f"acceleration of {options.payload} along {direction_text(options.response_direction)}"),
            ("Range", f"{start:g} to {stop:g} Hz ({options.range_from})"), ("By", f"wirerope-mj {version('wirerope-mj')}"),
        ),
        question=("Where does the payload resonate, how strongly, and which motions are stable?",),
        verdict=_headline(findings, str(options.payload)),
        sections=(
            Section(
                "answer", "",
                lambda: (amplitude_chart(result, findings, bands), *_orders(findings, bands), *_outside_tests(result)),
                "headline",
            ),
            Section(
                "peaks", "Peaks and changes of stability", lambda: (peak_table(findings), event_table(findings)), "summary",
            ),
            Section(
                "levels", "How each level was computed", lambda: [_level_statement(one, options.rate) for one in findings],
                "summary",
            ),
            Section(
                "transmissibility", "Transmissibility", lambda: (amplitude_chart(result, findings, bands, relative=True),),
            ),
            Section("motions", "Motions along the resonance", partial(orbit_blocks, result.branches)),
        ),
    )  # fmt: skip


def _headline(findings: Sequence[LevelSummary], payload: str) -> Statement:
    """Return the conclusion: resonance and transmissibility, over the levels, or what keeps one from being known."""
    early = [one.level.branch for one in findings if one.level.branch is not None and not one.level.branch.complete]
    if early:
        level, text = abs(float(early[0].acceleration[0])), early[0].message
        if all(branch.beyond_travel for branch in early):
            at = float(early[0].frequency[-1])
            return Statement(
                id="headline", text=f"RATED TRAVEL at {level:.4g} m/s² from {at:.4g} Hz on: {early[0].beyond_travel}; motions "
                "beyond are not followed.", tone="exceeded", values={"acceleration": level, "frequency": at},
            )  # fmt: skip
        return Statement(id="headline", text=f"ENDED EARLY at {level:.4g} m/s²: {text}.", tone="exceeded")
    first, last = _top(findings[0]), _top(findings[-1])
    words = "Resonance" if not (first.at_edge or last.at_edge) else "No resonance peak in the range; largest response"
    levels = [one.level.acceleration for one in findings]
    frequency, ratio = f"{last.frequency:.4g} Hz", f"{last.transmissibility:.3g}"
    under = f"{levels[-1]:.4g} m/s²"
    if len(findings) > 1:
        frequency, ratio = f"{first.frequency:.4g} to {frequency}", f"{first.transmissibility:.3g} to {ratio}"
        under = f"{levels[0]:.4g} to {under}"
    text = f"{words} of {payload} at {frequency} under {under}: transmissibility {ratio}"
    folds = sum(len(one.level.branch.jumps) for one in findings if one.level.branch is not None)
    text += f"; {several(folds, 'fold')} where a sweep jumps" if folds else ""
    return Statement(
        id="headline", text=f"{text}.", tone="unjudged" if folds or first.at_edge or last.at_edge else "",
        values={"frequency": last.frequency, "amplitude": last.amplitude, "transmissibility": last.transmissibility},
    )  # fmt: skip


def _top(summary: LevelSummary) -> ResonancePeak:
    """Return the highest peak of a level's branch; of sweeps alone that of the higher one."""
    if summary.peaks:
        return summary.peaks[0]
    way, seen = max(summary.comparisons.items(), key=lambda item: item[1].peak)
    ends = summary.level.sweeps[way].frequency[[0, -1]]
    return ResonancePeak(
        frequency=seen.peak_frequency, amplitude=seen.peak, transmissibility=summary.level.transmissibility(seen.peak),
        point=-1, at_edge=seen.peak_frequency in ends, order=math.nan, harmonic="", share=math.nan,
    )  # fmt: skip


def _orders(findings: Sequence[LevelSummary], bands: Sequence[OrderBand]) -> Iterator[Statement]:
    if bands:
        yield Statement(id="orders", items=tuple(order_statements(bands, findings)))


def _outside_tests(result: FrequencyResponse) -> Iterator[Statement]:
    """Yield for each level a statement on the mounts whose highest motion is outside what their laws were identified from."""
    isolators = {name: mount.isolator for name, mount in result.system.mounts.items()}
    if not any(isolator.validity.stated for isolator in isolators.values()):
        return
    for level in result.levels:
        if level.branch is not None:
            motion = level.branch.orbit(level.branch.peak).response
            paths = {name: motion.mounts[name].deflection for name in isolators}
            ends = {name: (path.min(axis=0), path.max(axis=0)) for name, path in paths.items()}
        else:
            sweep = next(iter(level.sweeps.values()))
            row = int(np.argmax(sweep.amplitude))
            ends = {name: (one.minimum[row], one.maximum[row]) for name, one in sweep.mounts.items()}
        if where := untested(isolators, ends):
            below = any(
                0.5 * (ends[name][1][k] - ends[name][0][k]) < one.amplitude[0]
                for name, isolator in isolators.items()
                for k, axis in enumerate(AXES)
                if (one := isolator.validity.stated.get(axis)) and axis in isolator.validity.outside(*ends[name], small=True)
            )
            end = f" Cycles below the least tested are {BELOW}." if below else ""
            yield Statement(
                id="outside-tests", tone="unjudged",
                text=f"At {level.acceleration:.4g} m/s² the highest motion is outside the cycles that isolators were "
                f"identified from: {where}. Resonance and transmissibility are extrapolated there.{end}",
            )  # fmt: skip


def peak_table(findings: Sequence[LevelSummary]) -> Table:
    """Tabulate the peaks of every level's branch, the highest first, and of its sweeps."""
    rows: list[Row] = []
    for summary in findings:
        level = summary.level
        for number, peak in enumerate(summary.peaks):
            name = _peak_name(peak, first=number == 0, branch=level.branch)
            note = f"{peak.harmonic}, {100.0 * peak.share:.3g} %"
            rows.append((level.acceleration, name, peak.frequency, peak.amplitude, peak.transmissibility, note))
        for way, seen in summary.comparisons.items():
            ratio = level.transmissibility(seen.peak)
            rows.append((level.acceleration, f"peak of the sweep {way}", seen.peak_frequency, seen.peak, ratio, ""))
    columns = (Column("level", "m/s²", ".4g"), Column("peak", align="left"), *_NUMBERS, Column("harmonic", align="text"))
    note = "Harmonic: the largest one besides the fundamental, of which it is so many percent."
    return Table(id="peaks", title="Peaks", columns=columns, rows=rows, note=note)


def _peak_name(peak: ResonancePeak, *, first: bool, branch: Branch | None) -> Cell:
    if not first:
        return f"peak of {peak.harmonic}" if peak.share >= _MARKED else "further peak"
    if branch is not None and not branch.complete:
        return Mark("highest within rated travel" if branch.beyond_travel else "highest before it ended", "exceeded")
    return Mark("highest, at the edge", "unjudged") if peak.at_edge else "resonance peak"


def event_table(findings: Sequence[LevelSummary]) -> Table | None:
    """Tabulate folds, changes of stability, side branches and jumps of sweeps; None without any."""
    rows: list[Row] = []
    for summary in findings:
        level = summary.level
        if level.branch is not None:
            rows += [(level.acceleration, *row) for row in _branch_events(level.branch)]
        for way, seen in summary.comparisons.items():
            for jump in seen.jumps:
                ratio, note = level.transmissibility(jump.amplitude), f"{100.0 * jump.past_fold:+.2f} % from the fold"
                name = f"jump of the sweep {way}"
                rows.append((level.acceleration, name, jump.frequency, jump.amplitude, ratio, note))
    columns = (Column("level", "m/s²", ".4g"), Column("event", align="left"), *_NUMBERS, Column(align="text"))
    title = "Folds, changes of stability and jumps"
    return Table(id="events", title=title, columns=columns, rows=rows) if rows else None


def _branch_events(branch: Branch) -> Iterator[Row]:
    """Yield folds and changes of stability in the order of a branch, then its side branches."""
    jumps = {jump.parameter: jump for jump in branch.jumps}
    for event in branch.bifurcations:
        jump = jumps.get(event.frequency) if event.kind == "fold" else None
        if event.kind == "fold" and jump is None:
            continue  # both of its motions are within 1 %
        notes = [f"{event.before} -> {event.after} unstable multipliers"]
        if jump is not None:
            landing = "nowhere on this branch" if math.isnan(jump.landing) else f"{jump.landing:.4g} m/s²"
            notes.append(f"sweep {'up' if jump.rising else 'down'} jumps to {landing}")
        yield event.kind, event.frequency, event.amplitude, event.transmissibility, "; ".join(notes)
    for side in branch.side_branches:
        low, high = sorted((side.start, side.stop))
        yield "side branch", low, None, None, f"up to {high:.5g} Hz: two motions, {100.0 * side.difference:.1g} % apart"


def _level_statement(summary: LevelSummary, rate: float) -> Statement:
    """Return what a level's computations say of themselves."""
    level, lines = summary.level, []
    if level.branch is not None:
        branch = level.branch
        start = "continuation" if branch.complete or branch.beyond_travel else "continuation ENDED EARLY"
        lines.append(
            f"{start}: {branch.frequency.size} points, {branch.model_steps} model steps, {level.branch_seconds:.1f} s; "
            f"{branch.message}"
        )
        lines.append(_stability(branch))
    for way, sweep in level.sweeps.items():
        lines += _sweep_sentences(summary, way, sweep, rate)
    if level.sweeps:
        lines.append(f"sweeps: {level.sweep_seconds:.1f} s together")
    tone = "" if level.complete else "exceeded"
    text = f"Level {level.acceleration:.4g} m/s²"
    return Statement(id=f"level-{level.acceleration:.4g}", text=text, items=tuple(lines), tone=tone)


def _stability(branch: Branch) -> str:
    unstable = int((~branch.stable).sum())
    neutral = f"; {branch.neutral.max()} neutral directions left out" if branch.neutral.any() else ""
    if not unstable:
        return f"all motions are stable{neutral}"
    range_ = branch.frequency[~branch.stable]
    beside = "; on side branches a stable motion is within 1 %" if branch.side_branches else ""
    return f"{unstable} points between {range_.min():.5g} and {range_.max():.5g} Hz are unstable{beside}{neutral}"


def _sweep_sentences(summary: LevelSummary, way: str, sweep: FrequencySweep, rate: float) -> list[str]:
    seen = summary.comparisons[way]
    text = f"sweep {way} at {rate:g} octaves/min: {sweep.frequency.size} cycles, {sweep.model_steps} model steps"
    if not math.isnan(seen.largest):
        text += (
            f"; away from jumps within {100.0 * seen.largest:.2g} % of the branch (at {seen.at:.4g} Hz), half of it within "
            f"{100.0 * seen.median:.2g} %"
        )
    return [text, *(f"sweep {way}: {warning}" for warning in sweep.warnings)]


def amplitude_chart(
    result: FrequencyResponse, findings: Sequence[LevelSummary], bands: Sequence[OrderBand] = (), *, relative: bool = False
) -> Chart:
    """Draw the payload's largest acceleration over frequency for all levels, or its ratio to that of the base."""
    options = result.options
    assert options.response_direction is not None
    what = f"{options.payload} along {direction_text(options.response_direction)}"
    curves = _curves(findings, relative=relative)
    x, y = (np.concatenate([getattr(curve, part) for curve in curves]) for part in "xy")
    panel = Panel(
        curves=curves, ylabel=f"transmissibility of {what} [-]" if relative else f"largest acceleration of {what} [m/s²]",
        xlabel="frequency of the base [Hz]", xlim=(float(x.min()) / _BESIDE, float(x.max()) * _BESIDE),
        ylim=(float(y.min()) / _ABOVE, float(y.max()) * _ABOVE), log="xy", unit="" if relative else "m/s²", xunit="Hz",
        bands=[(band.label, band.low, band.high) for band in bands],
    )  # fmt: skip
    name = "Transmissibility" if relative else "Largest acceleration"
    return Chart(
        id="transmissibility" if relative else "amplitude", rows=[[panel]], height=360.0,
        caption=f"{name} of {what} over frequency, for every acceleration of the base. Unstable motions are dashed, which no "
        "sweep reaches; dots mark folds and changes of stability.",
        alt=f"{name} of {what} over frequency.",
    )  # fmt: skip


def _curves(findings: Sequence[LevelSummary], *, relative: bool) -> list[Curve]:
    """Return marks of folds and changes of stability, the backbone, the branches and behind them the sweeps."""
    events: dict[str, list[tuple[float, float]]] = {}
    tops, branches, sweeps = [], [], []
    for number, summary in enumerate(findings):
        level, kind = summary.level, number % COLOURS
        name, scale = f"{level.acceleration:.4g} m/s²", 1.0 / level.acceleration if relative else 1.0
        if level.branch is not None and summary.curve is not None:
            branches += [_scaled(curve, scale) for curve in _segments(summary.curve, name, kind)]
            for event in level.branch.bifurcations:
                events.setdefault(event.kind, []).append((event.frequency, scale * event.amplitude))
        for way, sweep in level.sweeps.items():
            curve = Curve(x=sweep.frequency, y=sweep.amplitude, name=f"{name}, sweep {way}", kind=kind, weight=0.7)
            sweeps.append(_scaled(replace(curve, dash="dotted" if way == "down" else ""), scale))
        if summary.peaks and not summary.peaks[0].at_edge:
            tops.append((summary.peaks[0].frequency, scale * summary.peaks[0].amplitude))
    marks = [replace(_through(at, kind), marks=True, weight=1.8) for kind, at in events.items()]
    backbone = [replace(_through(tops, "backbone"), dash="dotted", weight=0.9)] if len(tops) > 1 else []
    return [*marks, *backbone, *branches, *sweeps]


def _segments(curve: BranchCurve, name: str, kind: int) -> Iterator[Curve]:
    """Yield the segments of a branch that are alike in stability, each with the first point of the next."""
    changes = np.flatnonzero(np.diff(curve.stable)) + 1
    ends = [0, *changes.tolist(), max(curve.stable.size - 1, 1)]
    for a, b in zip(ends[:-1], ends[1:], strict=True):
        part, stable = slice(a, b + 1), bool(curve.stable[a])
        yield Curve(
            x=curve.frequency[part], y=curve.amplitude[part], name=name if stable else f"{name}, unstable", kind=kind,
            dash="" if stable else "dashed", marks=curve.stable.size == 1, weight=1.2,
        )  # fmt: skip


def _scaled(curve: Curve, scale: float) -> Curve:
    return replace(curve, y=scale * curve.y)


def _through(points: Sequence[tuple[float, float]], name: str) -> Curve:
    x, y = np.array(points).T
    return Curve(x=x, y=y, name=name, kind=BASE)
