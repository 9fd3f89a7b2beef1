"""Content of a frequency response: resonances, folds, stability, and the curves of all levels."""

import math
from collections.abc import Iterator, Sequence
from functools import partial
from importlib.metadata import version

import numpy as np

from wirerope_mj.assessment.criteria.travel import untested
from wirerope_mj.content.blocks import BASE, Block, Chart, Content, Curve, Panel, Section, Statement, with_room
from wirerope_mj.content.numbers import several
from wirerope_mj.content.selection import COLOURS
from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.summary import (
    LevelSummary,
    OrderBand,
    ResonancePeak,
    along_resonance,
    busiest_loops,
    order_statements,
)
from wirerope_mj.dynamics.periodic import Branch, PeriodicOrbit
from wirerope_mj.foundation.directions import direction_text
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left
from wirerope_mj.foundation.units import force_unit, in_unit
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.parts import BELOW

_NAMED_SHARE = 0.05  # Ratio to the fundamental from which another harmonic gives a peak its name
_MARGIN_X, _MARGIN_Y = 1.01, 1.12  # ratios of the ends of the axes to those of the curves
_NUMBERS = (Column("frequency", "Hz", ".5g"), Column("amplitude", "m/s²", ".4g"), Column("transmissibility", form=".4g"))


def response_content(result: FrequencyResponse, findings: Sequence[LevelSummary], bands: Sequence[OrderBand] = ()) -> Content:
    """Compose the content of a frequency response at all excitation levels, with the `bands` of a machine's orders."""
    options, (start, stop) = result.options, result.options.range
    assert options.response_direction is not None
    asked = {
        "Base": f"along {direction_text(options.direction)}",
        "Response": f"acceleration of {options.payload} along {direction_text(options.response_direction)}",
        "Range": f"{start:g} to {stop:g} Hz ({options.range_from})",
    }
    return Content(
        title=f"{result.name}: frequency response",
        facts=(*asked.items(), ("By", f"wirerope-mj {version('wirerope-mj')}")),
        question=("Where does the payload resonate, how strongly, and which motions are stable?",),
        verdict=_headline(findings, str(options.payload)),
        sections=(
            Section("brief", "", lambda: [Statement("asked", f"Base {', '.join(asked.values())}.")], "headline"),
            Section(
                "answer", "",
                lambda: (amplitude_chart(result, findings, bands), *_findings(result, findings, bands)),
                "headline",
            ),
            Section("peaks", "Peaks, changes of stability", lambda: (peak_table(findings), event_table(findings)), "summary"),
            Section(
                "levels", "How each level was computed", lambda: [_level_statement(level, options.rate) for level in findings],
                "summary",
            ),
            Section(
                "transmissibility", "Transmissibility", lambda: (amplitude_chart(result, findings, bands, relative=True),),
            ),
            Section("motions", "Motions along the resonance", partial(orbit_blocks, result.branches)),
        ),
    )  # fmt: skip


def _headline(findings: Sequence[LevelSummary], payload: str) -> Statement:
    """State the resonance with its transmissibility, or why a branch of periodic motions ended early."""
    branches = [summary.level.branch for summary in findings if summary.level.branch is not None]
    incomplete = [branch for branch in branches if not branch.complete]
    if incomplete:
        level, text = abs(float(incomplete[0].acceleration[0])), incomplete[0].message
        if all(branch.beyond_travel for branch in incomplete):
            at = float(incomplete[0].frequency[-1])
            return Statement(
                "headline", f"RATED TRAVEL at {level:.4g} m/s² from {at:.4g} Hz on: {incomplete[0].beyond_travel}; motions "
                "beyond are not followed.", tone="exceeded", values={"acceleration": level, "frequency": at},
            )  # fmt: skip
        return Statement("headline", f"ENDED EARLY at {level:.4g} m/s²: {text}.", tone="exceeded")
    first, last = _highest_peak(findings[0]), _highest_peak(findings[-1])
    words = "Resonance" if not (first.at_edge or last.at_edge) else "No resonance peak in the range; largest response"
    levels = [summary.level.acceleration for summary in findings]
    frequency, ratio = f"{last.frequency:.4g} Hz", f"{last.transmissibility:.3g}"
    under = f"{levels[-1]:.4g} m/s²"
    if len(findings) > 1:
        frequency, ratio = f"{first.frequency:.4g} to {frequency}", f"{first.transmissibility:.3g} to {ratio}"
        under = f"{levels[0]:.4g} to {under}"
    text = f"{words} of {payload} at {frequency} under {under}: transmissibility {ratio}"
    folds = sum(len(branch.jumps) for branch in branches)
    text += f"; {several(folds, 'fold')} where a sweep jumps" if folds else ""
    text += f"; {findings[-1].isolation_text}" if math.isfinite(findings[-1].isolation) else ""
    return Statement(
        "headline", f"{text}.", tone="unjudged" if folds or first.at_edge or last.at_edge else "",
        values={"frequency": last.frequency, "amplitude": last.amplitude, "transmissibility": last.transmissibility},
    )  # fmt: skip


def _highest_peak(summary: LevelSummary) -> ResonancePeak:
    """Find the highest resonance peak at an excitation level, or the largest response of its sweeps."""
    if summary.peaks:
        return summary.peaks[0]
    way, comparison = max(summary.comparisons.items(), key=lambda item: item[1].peak)
    ends = summary.level.sweeps[way].frequency[[0, -1]]
    return ResonancePeak(
        frequency=comparison.peak_frequency, amplitude=comparison.peak,
        transmissibility=summary.level.transmissibility(comparison.peak), point=-1,
        at_edge=comparison.peak_frequency in ends, order=math.nan, harmonic="", share=math.nan,
    )  # fmt: skip


def _findings(result: FrequencyResponse, findings: Sequence[LevelSummary], bands: Sequence[OrderBand]) -> Iterator[Statement]:
    """Yield the machine orders at resonances, and the levels whose motion is outside the tests of the laws."""
    if bands:
        yield Statement("orders", items=tuple(order_statements(bands, findings)))
    isolators = {name: mount.isolator for name, mount in result.system.mounts.items()}
    tested = any(isolator.validity.stated for isolator in isolators.values())
    for level in result.levels if tested else ():
        if level.branch is not None:
            motion = level.branch.orbit(level.branch.peak).response
            paths = {name: motion.mounts[name].deflection for name in isolators}
            ends = {name: (path.min(axis=0), path.max(axis=0)) for name, path in paths.items()}
        else:
            sweep = next(iter(level.sweeps.values()))
            row = int(np.argmax(sweep.amplitude))
            ends = {name: (mount.minimum[row], mount.maximum[row]) for name, mount in sweep.mounts.items()}
        if where := untested(isolators, ends):
            below = any(
                0.5 * (ends[name][1][k] - ends[name][0][k]) < tested_range.amplitude[0]
                for name, isolator in isolators.items()
                for k, axis in enumerate(AXES)
                if (tested_range := isolator.validity.stated.get(axis))
                and axis in isolator.validity.outside(*ends[name], small=True)
            )
            end = f" Cycles below the least tested are {BELOW}." if below else ""
            yield Statement(
                "outside-tests", tone="unjudged",
                text=f"At {level.acceleration:.4g} m/s² the highest motion is outside the cycles that isolators were "
                f"identified from: {where}. Resonance and transmissibility are extrapolated there.{end}",
            )  # fmt: skip


def peak_table(findings: Sequence[LevelSummary]) -> Table:
    """Tabulate the resonance peaks at every excitation level, the highest first, and those of its sweeps."""
    rows: list[Row] = []
    for summary in findings:
        level, branch = summary.level, summary.level.branch
        for number, peak in enumerate(summary.peaks):
            if number:
                name: Cell = f"peak of {peak.harmonic}" if peak.share >= _NAMED_SHARE else "further peak"
            elif branch is not None and not branch.complete:
                end = "highest within rated travel" if branch.beyond_travel else "highest before it ended"
                name = Mark(end, "exceeded")
            else:
                name = Mark("highest, at the edge", "unjudged") if peak.at_edge else "resonance peak"
            note = f"{peak.harmonic}, {100.0 * peak.share:.3g} %"
            rows.append((level.acceleration, name, peak.frequency, peak.amplitude, peak.transmissibility, note))
        for way, comparison in summary.comparisons.items():
            ratio = level.transmissibility(comparison.peak)
            rows.append((level.acceleration, f"peak of the sweep {way}", comparison.peak_frequency, comparison.peak, ratio, ""))
    columns = (Column("level", "m/s²", ".4g"), *left("peak"), *_NUMBERS, Column("harmonic", align="text"))
    note = "Harmonic: the largest one besides the fundamental, of which it is so many percent."
    return Table("peaks", "Peaks", columns, rows, note=note)


def event_table(findings: Sequence[LevelSummary]) -> Table | None:
    """Tabulate folds, changes of stability, side branches and jumps; None without events."""
    rows: list[Row] = []
    for summary in findings:
        level = summary.level
        jumps = {jump.parameter: jump for jump in level.branch.jumps} if level.branch is not None else {}
        for event in level.branch.bifurcations if level.branch is not None else ():
            landed = jumps.get(event.frequency) if event.kind == "fold" else None
            if event.kind == "fold" and landed is None:
                continue  # both of its motions are within 1 %
            notes = [f"{event.before} -> {event.after} unstable multipliers"]
            if landed is not None:
                landing = "nowhere on this branch" if math.isnan(landed.landing) else f"{landed.landing:.4g} m/s²"
                notes.append(f"sweep {'up' if landed.rising else 'down'} jumps to {landing}")
            numbers = event.frequency, event.amplitude, event.transmissibility
            rows.append((level.acceleration, event.kind, *numbers, "; ".join(notes)))
        for side in level.branch.side_branches if level.branch is not None else ():
            low, high = sorted((side.start, side.stop))
            text = f"up to {high:.5g} Hz: two motions, {100.0 * side.difference:.1g} % apart"
            rows.append((level.acceleration, "side branch", low, None, None, text))
        for way, comparison in summary.comparisons.items():
            for jump in comparison.jumps:
                ratio, note = level.transmissibility(jump.amplitude), f"{100.0 * jump.past_fold:+.2f} % from the fold"
                name = f"jump of the sweep {way}"
                rows.append((level.acceleration, name, jump.frequency, jump.amplitude, ratio, note))
    columns = (Column("level", "m/s²", ".4g"), *left("event"), *_NUMBERS, Column(align="text"))
    title = "Folds, changes of stability and jumps"
    return Table("events", title, columns, rows) if rows else None


def _level_statement(summary: LevelSummary, rate: float) -> Statement:
    level, lines = summary.level, []
    if (branch := level.branch) is not None:
        start = "continuation" if branch.complete or branch.beyond_travel else "continuation ENDED EARLY"
        lines.append(
            f"{start}: {branch.frequency.size} points, {branch.model_steps} model steps, {level.branch_seconds:.1f} s; "
            f"{branch.message}"
        )
        neutral = f"; {branch.neutral.max()} neutral directions left out" if branch.neutral.any() else ""
        unstable = branch.frequency[~branch.stable]
        span = f"{unstable.min():.5g} and {unstable.max():.5g} Hz" if unstable.size else ""
        beside = "; on side branches a stable motion is within 1 %" if branch.side_branches else ""
        text = f"{unstable.size} points between {span} are unstable{beside}" if span else "all motions are stable"
        lines.append(f"{text}{neutral}")
    for way, sweep in level.sweeps.items():
        comparison = summary.comparisons[way]
        text = f"sweep {way} at {rate:g} octaves/min: {sweep.frequency.size} cycles, {sweep.model_steps} model steps"
        if not math.isnan(comparison.largest):
            text += f"; away from jumps within {100.0 * comparison.largest:.2g} % of the branch (at {comparison.at:.4g} Hz), "
            text += f"half of it within {100.0 * comparison.median:.2g} %"
        lines += [text, *(f"sweep {way}: {warning}" for warning in sweep.warnings)]
    if level.sweeps:
        lines.append(f"sweeps: {level.sweep_seconds:.1f} s together")
    text, tone = f"Level {level.acceleration:.4g} m/s²: {summary.isolation_text}", "" if level.complete else "exceeded"
    return Statement(f"level-{level.acceleration:.4g}", text, items=tuple(lines), tone=tone)


def amplitude_chart(
    result: FrequencyResponse, findings: Sequence[LevelSummary], bands: Sequence[OrderBand] = (), *, relative: bool = False
) -> Chart:
    """Draw the payload's largest acceleration, or its ratio to that of the base, over frequency at all levels."""
    options = result.options
    assert options.response_direction is not None
    what = f"{options.payload} along {direction_text(options.response_direction)}"
    curves = _curves(findings, relative=relative)
    x, y = (np.concatenate([getattr(curve, part) for curve in curves]) for part in "xy")
    panel = Panel(
        curves, f"transmissibility of {what} [-]" if relative else f"largest acceleration of {what} [m/s²]",
        xlabel="frequency of the base [Hz]", xlim=(float(x.min()) / _MARGIN_X, float(x.max()) * _MARGIN_X),
        ylim=(float(y.min()) / _MARGIN_Y, float(y.max()) * _MARGIN_Y), log="xy", unit="" if relative else "m/s²", xunit="Hz",
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
    """Draw folds and changes of stability, the backbone (peaks of all levels), branches, and behind them sweeps."""
    events: dict[str, list[tuple[float, float]]] = {}
    tops, branches, sweeps = [], [], []
    for number, summary in enumerate(findings):
        level, kind = summary.level, number % COLOURS
        name, scale = f"{level.acceleration:.4g} m/s²", 1.0 / level.acceleration if relative else 1.0
        if level.branch is not None and (curve := summary.curve) is not None:
            # segments that are alike in stability, each with the first point of the next
            ends = [0, *(np.flatnonzero(np.diff(curve.stable)) + 1).tolist(), max(curve.stable.size - 1, 1)]
            for first, last in zip(ends[:-1], ends[1:], strict=True):
                part, stable = slice(first, last + 1), bool(curve.stable[first])
                branches.append(Curve(
                    curve.frequency[part], scale * curve.amplitude[part], name=name if stable else f"{name}, unstable",
                    kind=kind, dash="" if stable else "dashed", marks=curve.stable.size == 1, weight=1.2,
                ))  # fmt: skip
            for event in level.branch.bifurcations:
                events.setdefault(event.kind, []).append((event.frequency, scale * event.amplitude))
        for way, sweep in level.sweeps.items():
            sweeps.append(Curve(
                sweep.frequency, scale * sweep.amplitude, name=f"{name}, sweep {way}", kind=kind, weight=0.7,
                dash="dotted" if way == "down" else "",
            ))  # fmt: skip
        if summary.peaks and not summary.peaks[0].at_edge:
            tops.append((summary.peaks[0].frequency, scale * summary.peaks[0].amplitude))
    marks = [Curve(*np.array(at).T, name=name, kind=BASE, marks=True, weight=1.8) for name, at in events.items()]
    backbone = Curve(*np.array(tops).T, name="backbone", kind=BASE, dash="dotted", weight=0.9) if len(tops) > 1 else None
    return [*marks, *([backbone] if backbone else []), *branches, *sweeps]


_PANELS = 4  # most panels of a chart, from the lowest level to the highest
_MULTIPLIERS = 5  # Floquet multipliers in the table
Motion = tuple[Branch, int, PeriodicOrbit]  # A branch, the number of one of its points, and the motion there


def orbit_blocks(branches: Sequence[Branch]) -> Iterator[Block]:
    """Yield loops and phase portraits of the mount that does most work at some levels' resonances, and a table of them."""
    if not branches or not branches[0].system.mounts:
        return
    rows = np.unique(np.linspace(0, len(branches) - 1, min(len(branches), _PANELS)).round().astype(int))
    chosen = [branches[row] for row in rows]
    loops = busiest_loops(chosen[-1].orbit(chosen[-1].peak).response)
    if not loops:
        return
    motions = [[(branch, point, branch.orbit(point)) for point in along_resonance(branch)] for branch in chosen]
    yield _orbit_chart(motions, *loops[0])
    yield _orbit_chart(motions, *loops[0], portraits=True)
    yield orbit_table([motion for level in motions for motion in level], *loops[0])


def _orbit_chart(motions: Sequence[Sequence[Motion]], mount: str, axis: int, *, portraits: bool = False) -> Chart:
    branch, *_ = motions[0][0]
    device = branch.system.mounts[mount].isolator.name
    panels = [_orbit_panel(level, mount, axis, portraits=portraits) for level in motions]
    across = 2 if len(panels) == _PANELS else len(panels)
    what = "Phase portraits" if portraits else "Loops"
    more = " A dot marks where a period of the base begins." if portraits else ""
    return Chart(
        id="orbit-portraits" if portraits else "orbit-loops", height=260.0,
        rows=[panels[first : first + across] for first in range(0, len(panels), across)],
        caption=f"{what} of {mount} ({device}), {AXES[axis]}, along the resonance of each level: the highest motion bold, "
        f"unstable ones dashed.{more}",
        alt=f"{what} of {mount} along the resonance.",
    )  # fmt: skip


def _orbit_panel(level: Sequence[Motion], mount: str, axis: int, *, portraits: bool) -> Panel:
    unit, curves, dots = "m/s" if portraits else _force_unit(level, mount, axis), [], []
    for number, (branch, point, orbit) in enumerate(level):
        loop, highest = orbit.response.mounts[mount], point == branch.peak
        name = f"{orbit.frequency:.4g} Hz" + (" highest" if highest else "") + ("" if orbit.stable else ", unstable")
        upward = orbit.deflection_rate(mount) if portraits else loop.force
        curve = Curve(
            in_unit(loop.deflection[:, axis], "mm"), in_unit(upward[:, axis], unit), name=name,
            kind=BASE if highest else number, dash="" if orbit.stable else "dashed", weight=1.8 if highest else 1.0,
        )  # fmt: skip
        curves.append(curve)
        begins = orbit.steps // orbit.periods * np.arange(orbit.periods if portraits else 0)
        dots += [(float(curve.x[row]), float(curve.y[row])) for row in begins]
    curves.sort(key=lambda curve: (curve.kind == BASE, not curve.dash))  # dashed ones in front of what they run along
    return Panel(
        curves, f"its rate [{unit}]" if portraits else f"force [{unit}]", dots=dots,
        xlabel="deflection [mm], tension positive" if AXES[axis] == "axial" else "deflection [mm]",
        title=f"{abs(float(level[0][0].acceleration[0])):.4g} m/s²",
        xlim=with_room(np.concatenate([curve.x for curve in curves])), unit=unit, xunit="mm",
    )  # fmt: skip


def _force_unit(motions: Sequence[Motion], mount: str, axis: int) -> str:
    largest = max(float(np.abs(orbit.response.mounts[mount].force[:, axis]).max()) for *_, orbit in motions)
    return force_unit(largest)


def orbit_table(motions: Sequence[Motion], mount: str, axis: int) -> Table:
    """Tabulate periodic motions: amplitude, stability, range of a mount's loop, work per repetition."""
    rows: list[Row] = []
    for branch, point, orbit in motions:
        state: Cell = "stable" if orbit.stable else Mark("UNSTABLE", "unjudged")
        amplitude, ratio = float(branch.amplitude[point]), float(branch.transmissibility[point])
        level = abs(float(branch.acceleration[point]))
        rows.append((level, orbit.frequency, state, amplitude, ratio, *_ranges(orbit, mount, axis)))
    unit = _force_unit(motions, mount, axis)
    columns = (
        Column("level", "m/s²", ".4g"), Column("frequency", "Hz", ".5g"), *left("motion"),
        Column("amplitude", "m/s²", ".4g"), Column("transmissibility", form=".4g"),
        Column("deflection from", "mm", "z.4g"), Column("to", "mm", "z.4g"),
        Column("force from", unit, "z.4g"), Column("to", unit, "z.4g"), Column("work", "J", ".3g"),
    )  # fmt: skip
    title = f"Motions, with the loop of mount {mount}, {AXES[axis]}; work: of one repetition"
    return Table("orbits", title, columns, rows)


def _ranges(orbit: PeriodicOrbit, mount: str, axis: int) -> tuple[float, float, float, float, float]:
    """Find the range of a mount's deflection [m] and force [N], and the work of a repetition [J]."""
    loop = orbit.response.mounts[mount]
    x, force = loop.deflection[:, axis], loop.force[:, axis]
    work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(x)))
    return float(x.min()), float(x.max()), float(force.min()), float(force.max()), work


def motion_blocks(motion: Motion, until: int, loop: tuple[str, int] | None) -> Iterator[Block]:
    """Yield stability, Floquet multipliers and loop (mount, axis) of a motion, and bifurcations before the point `until`."""
    branch, point, orbit = motion
    level, state = abs(float(branch.acceleration[point])), "stable" if orbit.stable else "UNSTABLE"
    yield Statement("motion", f"{orbit.frequency:.5g} Hz, {level:.4g} m/s²: {state}", tone="strong")
    events = [event.description for event in branch.bifurcations if point <= event.index < max(until, point + 1)]
    yield Statement("events", items=tuple(events))
    yield Statement(
        "amplitude",
        f"Amplitude {branch.amplitude[point]:.4g} m/s², transmissibility {branch.transmissibility[point]:.4g}",
        tone="strong",
    )
    yield Table(
        "multipliers", "", (Column("Floquet multiplier"), Column("modulus", form=".4f")),
        [
            (f"{value.real:+.4f} {value.imag:+.4f} i", float(abs(value)))
            for value in orbit.floquet_multipliers[:_MULTIPLIERS]
        ],
    )  # fmt: skip
    if loop is not None:
        low, high, least, most, work = _ranges(orbit, *loop)
        yield Statement(
            "loop",
            f"Mount {loop[0]}, {AXES[loop[1]]}: {in_unit(low, 'mm'):.4g} to {in_unit(high, 'mm'):.4g} mm, "
            f"{in_unit(least, 'kN'):.4g} to {in_unit(most, 'kN'):.4g} kN, {work:.3g} J per repetition",
        )
    neutral = f", {orbit.neutral} neutral directions" if orbit.neutral else ""
    text = f"point {point + 1} of {branch.frequency.size}, residual {orbit.residual:.1e}{neutral}"
    yield Statement("point", text, tone="quiet")
