"""The first sheet of a run: what went in and out, the criteria as bars, the worst instant, and three charts."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.comparison import BASE as THE_BASE
from wirerope_mj.assessment.criteria import body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.verdict import ACCELERATION, RMS, by_use, most_used
from wirerope_mj.content.base import base_acceleration
from wirerope_mj.content.blocks import BASE, PAYLOADS, Block, Chart, Panel, Statement, short
from wirerope_mj.content.histories import TOTAL, Line, history_panel, subject_called
from wirerope_mj.content.judged_run import STILL, JudgedRun
from wirerope_mj.content.numbers import number, with_unit
from wirerope_mj.content.required_spectra import required_curve, required_statement
from wirerope_mj.content.scene_outline import worst_instant
from wirerope_mj.content.selection import kind_of, main_direction, worst_names
from wirerope_mj.content.spectrum_charts import densities_chart, rms_along, shock_chart, sweep_chart
from wirerope_mj.content.verdicts import criteria_blocks, untested
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.units import instant_text
from wirerope_mj.motions import Sweep
from wirerope_mj.mounts.isolator.travel import SIDES


def brief_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield base motion and payload acceleration in a sentence, criteria as bars, worst instant, what is not judged, charts."""
    yield passage(run)
    if run.achieved:
        yield replace(required_statement(run), id="required", items=())
    criteria, *others = criteria_blocks(run.verdicts)
    yield from (criteria, worst_instant(run), *others, untested(run), first_charts(run))


def passage(run: JudgedRun) -> Statement | None:
    """State the base's motion and the most critical acceleration of the payload; of random vibration the largest rms.

    Of shocks and random vibration it is also given in percent of the base's, since both belong to one event.
    """
    names = worst_names(run.response)
    if not names:
        return None
    where, measure, into = names[0], "", 0.0
    out = max(row.value for row in body_peaks(run.response) if row.name == where)
    known = [row.amplification for row in run.verdicts if row.subject == where and row.amplification is not None]
    if run.random and not isinstance(run.random, Absent):
        most = max((row for row in run.random if row.criterion.kind == RMS), key=lambda row: row.value)
        axis = most.criterion.axis
        where, out, into, measure = most.subject, most.value, float(run.base_rms["xyz".index(axis)]), f" rms along {axis}"
    elif known:
        into = known[0].base
    of_base = f", {100.0 * out / into:.0f} % of the base's {with_unit(into, 'g')}" if into > STILL else ""
    text = f"{run.acting} → {with_unit(out, 'g')}{measure} at {where}{of_base}"
    return Statement("passage", text, values={"base_m_s2": into or None, "payload_m_s2": out, "where": where})


def first_histories(run: JudgedRun, window: tuple[float, float]) -> list[Panel]:
    """Draw the most critical acceleration and the most critical deflection over an interval [s], as far as there are any."""
    response, selection, panels = run.response, run.selection, list[Panel]()
    timed = by_use(row for row in run.verdicts if row.time is not None)
    mount = next((name for name in timed if name in selection.mounts), selection.governing)
    if names := worst_names(response)[:1]:
        # as it is judged, so that the curve's peak is that of the verdict: its size, or its component
        rows = (row for row in run.verdicts if row.subject == names[0] and row.criterion.kind == ACCELERATION)
        judged, size = most_used(rows), main_direction(response) if run.random else TOTAL
        along, kind = (judged and judged.criterion.axis) or size, kind_of(selection, names[0])
        lines = [
            Line(response=response, subject=subject_called(response, names[0]), name=names[0], kind=kind),
            Line(response=response, subject=THE_BASE, name="base", kind=BASE, history=base_acceleration(response, run.motion)),
        ]
        panels.append(history_panel("acceleration", along, lines, window))
    if mount:
        used = next(row for row in mount_peaks(response) if row.name == mount)
        axis = next((axis for axis, senses in SIDES.items() if used.governing in senses), selection.axes[0])
        line = Line(response=response, subject=mount, name=mount, kind=kind_of(selection, mount))
        panels.append(history_panel("deflection", axis, [line], window))
    return [replace(panel if run.random else _with_peak(panel), xlabel="time [s]") for panel in panels]


def first_charts(run: JudgedRun) -> Chart | None:
    """Draw side by side the most critical acceleration and deflection over time, and the payload's spectra."""
    panels, names = first_histories(run, run.selection.window), worst_names(run.response)[:1]
    if over := panel_over_frequency(run):
        first = {short(name) for name in names}  # of several bodies the one beside it alone, under the same name
        named = [replace(curve, name=curve.name.partition(", ")[0]) for curve in over.curves]
        curves = [curve for curve in named if curve.name in first or curve.kind not in PAYLOADS]
        panels.append(replace(over, curves=curves, title=over.ylabel.replace("peak acceleration ", ""), ylabel=""))
    return Chart(
        id="first-charts", rows=[panels], height=150.0,
        caption="Acceleration of the most critical part of the payload and of the base, deflection of the most critical mount, "
        "and spectra; limits and ratings dashed.",
        alt="Acceleration, deflection and spectra of the most critical parts.",
    ) if panels else None  # fmt: skip


def _with_peak(panel: Panel) -> Panel:
    """Mark the largest value of a panel's first curve with its instant, if that is in the interval shown."""
    first, last = panel.xlim or (-math.inf, math.inf)
    x, y = panel.curves[0].peak or (math.nan, math.nan)
    if not first <= x <= last:
        return panel
    values = np.concatenate([curve.y for curve in panel.curves] + [[level] for _, level in panel.limits if level * y > 0.0])
    low, high = float(values.min()), float(values.max())
    aside = math.copysign(0.06 * (high - low), y)  # away from the curve, as far as the panel reaches
    # beyond a limit that the text would cross
    near = [level for _, level in panel.limits if 0.0 < math.copysign(1.0, y) * (level - y) < 2.5 * abs(aside)]
    place, ylim = min(max(y + aside, low), high), panel.ylim
    if near:
        place = near[0] + 1.2 * aside
        ylim = min(low, place) - abs(aside), max(high, place) + abs(aside)
    text = f"{number(y)} {panel.unit} at {instant_text(x)}"
    return replace(panel, dots=[(x, y)], notes=[(x, place, text, x > 0.5 * (first + last))], ylim=ylim)


def panel_over_frequency(run: JudgedRun) -> Panel | None:
    """Draw what suits the motion over frequency: accelerations of a sweep, PSDs, or shock response spectra; None without."""
    if isinstance(run.motion, Sweep):
        chart = sweep_chart(run, run.motion)
        ends = sorted((run.motion.start, run.motion.stop))
        return replace(chart.rows[0][0], xlim=(ends[0], ends[1]))
    axis = main_direction(run.response)
    if axis == TOTAL and (parts := [row for row in body_peaks(run.response) if row.kind != "base"]):  # the largest peak's
        axis = "xyz"[int(np.argmax(parts[0].axes))]
    if run.spectra.densities:
        axes = list(run.spectra.densities)
        panel, axis = _panel_along(densities_chart(run), axes, axis), axis if axis in axes else axes[0]
        rms = {short(name): with_unit(rms_along(run, name, axis), "g") for name in run.spectra.densities[axis]}
        curves = [replace(curve, name=f"{curve.name}, {rms[curve.name]} rms") for curve in panel.curves]
        return replace(panel, curves=curves)
    if isinstance(run.spectra.shock, Absent):
        return None
    panel = _panel_along(shock_chart(run), list(run.spectra.shock), axis)
    tops = [(curve, int(curve.y.argmax())) for curve in panel.curves]
    curves = [replace(curve, peak=(float(curve.x[top]), float(curve.y[top]))) for curve, top in tops]
    curves += [required_curve(one) for one in run.achieved if one.direction == axis]
    return replace(panel, curves=curves)


def _panel_along(chart: Chart, axes: list[str], axis: str) -> Panel:
    """Choose the panel of an axis from a chart's only row, labelled by the row's label and its own title."""
    row = chart.rows[0]
    panel = row[axes.index(axis) if axis in axes else 0]
    return replace(panel, ylabel=f"{row[0].ylabel} {panel.title}")
