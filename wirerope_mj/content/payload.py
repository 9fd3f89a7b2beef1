"""What reaches the payload: its accelerations against their limits, over time and over frequency, and random vibration."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.comparison import BASE as THE_BASE
from wirerope_mj.assessment.criteria import Verdict, body_peaks
from wirerope_mj.assessment.criteria.verdict import RMS, SIGMA, Criterion
from wirerope_mj.content.base import base_acceleration
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.histories import DIRECTIONS, Line, history_panel, subject_called
from wirerope_mj.content.judged_run import JudgedRun, RunResult
from wirerope_mj.content.numbers import listed, number
from wirerope_mj.content.panels import BASE, Chart, Curve, Panel, crest, short, stacked
from wirerope_mj.content.run_spectra import acceleration_along, moving_axes
from wirerope_mj.content.selection import MOST, kind_of, main_direction, worst_names
from wirerope_mj.content.spectrum_charts import densities_chart, shock_chart, spectra_blocks
from wirerope_mj.content.verdicts import acceleration_limits, used_mark
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Sweep


def acceleration_blocks(run: RunResult) -> Iterator[Block | None]:
    """Yield peak accelerations, and rms and 3-sigma values of random vibration."""
    yield _accelerations(run)
    if isinstance(run.random, Absent):
        yield Statement(id="random", text=f"No rms and 3-sigma values: {run.random.reason}", tone="quiet")
    else:
        yield _random(run.random)


def payload_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield histories and spectra of what is shaken most."""
    worst = worst_names(run.response)
    if not worst:
        return
    limited = "those with limits come first, the most critical before the others; then "
    chosen = f"{limited if run.response.scene.limits else ''}those with the largest accelerations"
    yield replace(
        accelerations_chart(run, worst),
        id="accelerations",
        caption=f"Absolute accelerations of {listed(worst)} and of the base; {chosen}.",
        alt=f"Histories of the accelerations of {listed(worst)} and the base along x, y and z.",
    )
    if isinstance(run.motion, Sweep):
        yield sweep_chart(run, run.motion)
    yield from spectra_blocks(run)


def _accelerations(run: RunResult) -> Table:
    """Tabulate the peaks of base, bodies and points; against their limits where the model states any."""
    sweep = run.sweep
    limited = acceleration_limits(run.verdicts)
    rows: list[Row] = []
    for row in body_peaks(run.response):
        name = row.name if row.kind == "body" else f"{row.name} ({row.kind})"
        cells: list[Cell] = [name, Mark(row.value, "strong"), *row.axes, row.time]
        cells += [] if sweep is None else [float(sweep.frequency([row.time])[0])]
        if limited:
            worst = limited.get(row.name)
            cells += [worst.limit, worst.criterion.axis, used_mark(worst.utilisation)] if worst else [None, "", None]
        rows.append(cells)
    columns = [Column(align="left"), *(Column(name, "g", "z.2f") for name in ("peak", "x", "y", "z"))]
    columns += [Column("at", "s", "z.4f"), *([] if sweep is None else [Column("at", "Hz", "z.2f")])]
    columns += [Column("limit", "g"), Column("of", align="left"), Column("used", "%", "z.0f")] if limited else []
    return Table(
        id="peak-accelerations",
        title="Peak accelerations" if limited else "Peak accelerations, not judged: the model states no limits",
        columns=columns,
        rows=rows,
    )


def _random(verdicts: Sequence[Verdict]) -> Table | None:
    """Tabulate rms and 3-sigma accelerations of every body and point; None where there are none."""
    values = {(row.subject, row.criterion): row.value for row in verdicts}
    if not values:
        return None
    kinds = (("rms", RMS), ("3-sigma", SIGMA))
    criteria = [(f"{text} {axis}", Criterion(kind, axis=axis)) for text, kind in kinds for axis in "xyz"]
    return Table(
        id="random",
        title="Random vibration: rms and 3-sigma accelerations",
        columns=[Column(align="left"), *(Column(text, "g", ".3f") for text, _ in criteria)],
        rows=[
            [name, *(values.get((name, criterion)) for _, criterion in criteria)]
            for name in dict.fromkeys(row.subject for row in verdicts)
        ],
        note="Of the stationary part, from where the response has settled in it.",
    )


def accelerations_chart(run: JudgedRun, names: Sequence[str]) -> Chart:
    """Draw the accelerations of the base and of some bodies or points over time, a panel for each axis with any."""
    base = base_acceleration(run.response, run.motion)
    lines = []
    for rank, name in enumerate(names[:MOST]):
        part = subject_called(run.response, name)
        lines.append(Line(response=run.response, subject=part, name=name, kind=kind_of(run.selection, name, rank)))
    lines.append(Line(response=run.response, subject=THE_BASE, name="base", kind=BASE, history=base))
    return stacked([history_panel("acceleration", along, lines, run.selection.window) for along in DIRECTIONS])


def sweep_chart(run: JudgedRun, sweep: Sweep) -> Chart:
    """Draw accelerations over the frequency of a sweep along the base's motion, as far from zero as they reach."""
    response, curves = run.response, []
    frequency = sweep.frequency(response.time)
    for rank, name in enumerate((*worst_names(response), BASE)):
        size = np.zeros(response.time.size)
        for axis in moving_axes(response):
            size += acceleration_along(response, name, axis) ** 2
        x, y = crest(frequency, in_unit(np.sqrt(size), "g"))
        curves.append(Curve(x=x, y=y, name=short(name), kind=BASE if name == BASE else rank))
    panel = Panel(curves=curves, ylabel="acceleration [g]", xlabel="frequency of the base [Hz]", log="x", unit="g", xunit="Hz")
    return Chart(
        id="over-frequency", rows=[[panel]], height=210.0,
        caption="Accelerations along the base's motion over the frequency of the sweep.",
        alt="Accelerations over the frequency of the sweep.",
    )  # fmt: skip


def panel_over_frequency(run: JudgedRun) -> Panel | None:
    """Return what is drawn over frequency; None where there is nothing."""
    if isinstance(run.motion, Sweep):
        chart = sweep_chart(run, run.motion)
        ends = sorted((run.motion.start, run.motion.stop))
        return _with_peaks(replace(chart.rows[0][0], xlim=(ends[0], ends[1])))
    axis = main_direction(run.response)
    if run.spectra.densities:
        panel = _along(densities_chart(run), list(run.spectra.densities), axis)
        along = run.spectra.densities.get(axis, next(iter(run.spectra.densities.values())))
        rms = {short(name): in_unit(float(density.rms), "g") for name, density in along.items()}
        curves = [replace(curve, name=f"{curve.name}, {number(rms[curve.name])} g rms") for curve in panel.curves]
        return replace(panel, curves=curves)
    if isinstance(run.spectra.shock, Absent):
        return None
    return _with_peaks(_along(shock_chart(run), list(run.spectra.shock), axis))


def _with_peaks(panel: Panel) -> Panel:
    """Mark the largest value of each curve."""
    tops = [(curve, int(curve.y.argmax())) for curve in panel.curves]
    return replace(panel, curves=[replace(one, peak=(float(one.x[top]), float(one.y[top]))) for one, top in tops])


def _along(chart: Chart, axes: list[str], axis: str) -> Panel:
    """Return the panel of a chart along an axis, or its first; the label is that of the first alone."""
    row = chart.rows[0]
    panel = row[axes.index(axis) if axis in axes else 0]
    return replace(panel, ylabel=f"{row[0].ylabel} {panel.title}")
