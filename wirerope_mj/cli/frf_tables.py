"""Tables of `wirerope frf`: for every level its peaks, folds and changes of stability, and what it cost."""

import math
from collections.abc import Sequence

from rich.markup import escape

from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary, ResonancePeak
from wirerope_mj.dynamics.periodic import Branch
from wirerope_mj.dynamics.sweep import FrequencySweep
from wirerope_mj.foundation.directions import direction_text
from wirerope_mj.foundation.tables import Column, Row, Table
from wirerope_mj.views.terminal import console, print_lines, print_table

_MARKED = 0.1
"""Ratio to the fundamental from which another harmonic gives a peak its name."""

_COLUMNS = (
    Column(align="left"),
    Column("frequency", "Hz", ".5g"),
    Column("amplitude", "m/s^2", ".4g"),
    Column("transmis-\nsibility", form=".4g"),
    Column(align="text"),
)


def print_response(result: FrequencyResponse, findings: Sequence[LevelSummary]) -> None:
    """Print what every level shows."""
    options, screen = result.options, console()
    start, stop = options.range
    assert options.response_direction is not None
    screen.print(
        f"\n[bold]{escape(result.name)}[/]  base along {direction_text(options.direction)}, acceleration of "
        f"{escape(str(options.payload))} along {direction_text(options.response_direction)}, {start:g} to {stop:g} Hz "
        f"({options.range_from})",
        soft_wrap=True,
    )
    for summary in findings:
        screen.print()
        print_table(Table(title=f"Level {summary.level.acceleration:.4g} m/s^2", columns=_COLUMNS, rows=_rows(summary)))
        print_lines(_sentences(summary, options.rate))


def _rows(summary: LevelSummary) -> list[Row]:
    """Return the rows of a level's table: peaks, then what happens on the branch in its order, then the sweeps."""
    level = summary.level
    rows: list[Row] = [_peak_row(peak, first=n == 0, complete=level.complete) for n, peak in enumerate(summary.peaks)]
    if level.branch is not None:
        rows += _event_rows(level.branch)
    for direction, seen in summary.comparisons.items():
        rows.append(
            (f"peak of the sweep {direction}", seen.peak_frequency, seen.peak, level.transmissibility(seen.peak), "")
        )
        for jump in seen.jumps:
            ratio, note = level.transmissibility(jump.amplitude), f"{100.0 * jump.past_fold:+.2f} % from the fold"
            rows.append((f"jump of the sweep {direction}", jump.frequency, jump.amplitude, ratio, note))
    return rows


def _peak_row(peak: ResonancePeak, *, first: bool, complete: bool) -> Row:
    harmonic = f"{peak.harmonic}: {100.0 * peak.share:.3g} % of the fundamental"
    if first:
        name = "highest at the edge of the range" if peak.at_edge else "resonance peak"
        name = name if complete else "highest before it ended"
    else:
        name = f"peak of {peak.harmonic}" if peak.share >= _MARKED else "further peak"
    return name, peak.frequency, peak.amplitude, peak.transmissibility, harmonic


def _event_rows(branch: Branch) -> list[Row]:
    rows: list[Row] = []
    jumps = {jump.parameter: jump for jump in branch.jumps}
    for event in branch.bifurcations:
        jump = jumps.get(event.frequency) if event.kind == "fold" else None
        if event.kind == "fold" and jump is None:
            continue  # both of its motions are within 1 %
        notes = [f"{event.before} -> {event.after} multipliers outside the unit circle"]
        if jump is not None:
            landing = "nowhere on this branch" if math.isnan(jump.landing) else f"{jump.landing:.4g} m/s^2"
            notes.append(f"a sweep {'up' if jump.rising else 'down'} jumps to {landing}")
        rows.append((event.kind, event.frequency, event.amplitude, event.transmissibility, "; ".join(notes)))
    for side in branch.side_branches:
        low, high = sorted((side.start, side.stop))
        note = f"up to {high:.5g} Hz: two motions, {100.0 * side.difference:.1g} % apart"
        rows.append(("side branch", low, math.nan, math.nan, note))
    return rows


def _sentences(summary: LevelSummary, rate: float) -> list[str]:
    """Return what the level's computations say of themselves."""
    level, lines = summary.level, []
    if level.branch is not None:
        branch = level.branch
        start = "continuation" if branch.complete else "continuation ENDED EARLY"
        lines.append(
            f"{start}: {branch.frequency.size} points, {branch.model_steps} model steps, {level.branch_seconds:.1f} s; "
            f"{branch.message}"
        )
        lines.append(_stability(branch))
    for direction, sweep in level.sweeps.items():
        lines += _sweep_sentences(summary, direction, sweep, rate)
    if level.sweeps:
        lines.append(f"sweeps: {level.sweep_seconds:.1f} s together")
    return lines


def _stability(branch: Branch) -> str:
    unstable = int((~branch.stable).sum())
    neutral = f"; {branch.neutral.max()} neutral directions left out" if branch.neutral.any() else ""
    if not unstable:
        return f"all motions are stable{neutral}"
    range_ = branch.frequency[~branch.stable]
    beside = "; on side branches a stable motion is within 1 %" if branch.side_branches else ""
    return f"{unstable} points between {range_.min():.5g} and {range_.max():.5g} Hz are unstable{beside}{neutral}"


def _sweep_sentences(summary: LevelSummary, direction: str, sweep: FrequencySweep, rate: float) -> list[str]:
    seen = summary.comparisons[direction]
    text = f"sweep {direction} at {rate:g} octaves/min: {sweep.frequency.size} cycles, {sweep.model_steps} model steps"
    if not math.isnan(seen.largest):
        text += (
            f"; away from jumps within {100.0 * seen.largest:.2g} % of the branch (at {seen.at:.4g} Hz), half of it within "
            f"{100.0 * seen.median:.2g} %"
        )
    return [text, *(f"sweep {direction}: {warning}" for warning in sweep.warnings)]
