"""The content of a run, and what reaches the payload: accelerations against their limits, over time and over frequency."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from wirerope_mj.assessment.comparison import BASE as THE_BASE
from wirerope_mj.assessment.criteria import Verdict, body_peaks
from wirerope_mj.assessment.criteria.random import SIGMAS
from wirerope_mj.assessment.criteria.sampled import samples_hold
from wirerope_mj.assessment.criteria.verdict import RMS, SIGMA, Criterion
from wirerope_mj.content.base import base_acceleration, base_blocks, warnings_of
from wirerope_mj.content.blocks import Block, Content, Depth, Section, Statement
from wirerope_mj.content.contacts import contact_blocks, contact_history_blocks
from wirerope_mj.content.credibility import credibility_blocks
from wirerope_mj.content.decks import deck_blocks, decks_blocks
from wirerope_mj.content.histories import DIRECTIONS, Line, history_panel, subject_called
from wirerope_mj.content.judged_run import STILL, JudgedRun, RunResult
from wirerope_mj.content.model import model_blocks
from wirerope_mj.content.modes import run_modes_blocks
from wirerope_mj.content.mounts import mount_blocks, mount_history_blocks
from wirerope_mj.content.numbers import fixed, listed, number, paragraphs, several, with_unit
from wirerope_mj.content.panels import BASE, Chart, Curve, Panel, crest, short, stacked
from wirerope_mj.content.run_spectra import acceleration_along, moving_axes
from wirerope_mj.content.selection import MOST, kind_of, main_direction, worst_names
from wirerope_mj.content.spectrum_charts import densities_chart, rms_along, shock_chart, spectra_blocks
from wirerope_mj.content.statics import run_statics_blocks
from wirerope_mj.content.verdicts import acceleration_limits, answer_blocks, full_table, grounds_blocks, headline, used_mark
from wirerope_mj.content.worst import worst_instant
from wirerope_mj.engine.response import Numerics
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Sweep

START = {
    "settled": "at rest in the equilibrium of the first loading",
    "relaxed": "at rest in the relaxed equilibrium, as after long vibration",
    "unloaded": "in the modelled geometry, with unloaded mounts",
}


def run_content(run: JudgedRun) -> Content:
    """Compose what a run says: the verdict first, what it rests on after it."""
    versions = run.inputs.get("versions", {})
    return Content(
        title=run.title,
        facts=(
            ("Model", run.model_file),
            ("Excitation" if run.motion.loaded_sites else "Base motion", run.acting),
            ("Simulated", run.written),
            ("By", f"wirerope-mj {versions.get('wirerope-mj', 'unknown')}"),
        ),
        question=tuple(paragraphs(str(run.inputs.get("question", "")))) or ("The scenario asks no question.",),
        verdict=headline(run.verdicts),
        sections=(
            _section(run, "warnings", "", _warnings, "headline"),
            _section(run, "answer", "", answer_blocks, "headline"),
            _section(run, "grounds", "", lambda judged: (worst_instant(judged), *grounds_blocks(judged))),
            _section(run, "accelerations", "Peak accelerations", acceleration_blocks, "summary"),
            _section(run, "mounts", "Peaks of the mounts", mount_blocks, "summary"),
            _section(run, "contacts", "Stops and contacts", contact_blocks, "summary"),
            _section(run, "model", "Model and mounts", model_blocks),
            _section(run, "statics", "At rest under gravity", run_statics_blocks),
            _section(run, "modes", "Modes", run_modes_blocks),
            _section(run, "base", "Base motion", base_blocks),
            _section(run, "payload", "What reaches the payload", _payload_blocks),
            _section(run, "mounts-in-motion", "Mounts in motion", mount_history_blocks),
            _section(run, "contact-histories", "Stops and contacts over time", contact_history_blocks),
            _section(run, "decks", "On a deck that bends", decks_blocks),
            _section(run, "deck", "Loads on the deck", deck_blocks),
            _section(run, "credibility", "How far this can be relied on", credibility_blocks),
            _section(run, "numerics", "Numerics, options and versions", _numerics),
            _section(run, "verdicts", "All verdicts", lambda run: [full_table(run.verdicts)]),
        ),
    )


def _section(
    run: JudgedRun, name: str, title: str, blocks: Callable[[JudgedRun], Iterable[Block | None]], depth: Depth = "full"
) -> Section:
    return Section(name, title, partial(blocks, run), depth)


def _warnings(run: JudgedRun) -> Iterator[Block | None]:
    for place, warning in enumerate(run.model_warnings, start=1):
        yield Statement(id=f"model-warning-{place}", text=f"warning: {warning}", tone="unjudged")
    yield warnings_of(run)


def numerics_statement(numerics: Numerics) -> Statement:
    """Return how the numbers were computed, in one sentence."""
    limit = f", limited by {numerics.limited_by}" if numerics.limited_by else ""
    steps = f"{several(numerics.steps, 'step')} of at most {with_unit(numerics.timestep, 'ms', digits=4)}{limit}"
    return Statement(
        id="numerics", text=f"{steps}, computed by {numerics.computed_by}, {numerics.error_text}", tone="quiet",
        values={"timestep_s": numerics.timestep, "steps": float(numerics.steps), "error": numerics.error_estimate},
    )  # fmt: skip


def _numerics(run: JudgedRun) -> Iterator[Block]:
    """Yield how the numbers were computed, and by what."""
    numerics, arguments = run.response.numerics, run.inputs.get("simulate", {})
    initial, versions = str(arguments.get("initial", "settled")), run.inputs.get("versions", {})
    rows = [
        ("simulated", f"{arguments.get('duration', run.response.time[-1]):g} s from {START.get(initial, initial)}"),
        ("steps", f"{several(numerics.steps, 'step')} of at most {with_unit(numerics.timestep, 'ms', digits=4)}"),
        ("step limited by", numerics.limited_by or "not recorded"),
        ("estimated error", _error(numerics)),
        ("samples", f"{run.response.time.size}; {samples_hold(run.response)}; peaks are those of every step"),
        ("computed by", f"{numerics.computed_by}{f': {numerics.why}' if numerics.why else ''}"),
    ]
    rows += [(f"option {name}", str(value)) for name, value in run.inputs.get("options", {}).items()]
    if versions:
        rows.append(("versions", ", ".join(f"{name} {version}" for name, version in versions.items())))
    columns = (Column("what", align="left"), Column("value", align="text"))
    yield Table(id="settings", title="How it was computed", columns=columns, rows=rows)


def _error(numerics: Numerics) -> str:
    if not math.isfinite(numerics.error_estimate):
        return "not estimated: the step was given" if math.isnan(numerics.accuracy) else numerics.error_text
    if numerics.limited_by == SENSITIVE:
        return numerics.error_text
    error = f"{with_unit(numerics.error_estimate, '%', digits=2)} of the peaks, by halving the step"
    if math.isnan(numerics.accuracy):
        return f"{error} that was given"
    asked = f"{with_unit(numerics.accuracy, '%', digits=2)} asked for"
    return f"{error}; {'above the ' if numerics.error_estimate > numerics.accuracy else ''}{asked}"


def acceleration_blocks(run: RunResult) -> Iterator[Block | None]:
    """Yield peak accelerations, and rms and 3-sigma values of random vibration."""
    yield _accelerations(run)
    if isinstance(run.random, Absent):
        yield Statement(id="random", text=f"No rms and 3-sigma values: {run.random.reason}", tone="quiet")
    else:
        yield _random(run, run.random)


def _payload_blocks(run: JudgedRun) -> Iterator[Block | None]:
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
        yield _sweep_chart(run, run.motion)
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


def _random(run: RunResult, verdicts: Sequence[Verdict]) -> Table | None:
    """Tabulate rms and 3-sigma accelerations of the base and of every body and point; None where there are none."""
    values = {(row.subject, row.criterion): row.value for row in verdicts}
    if not values:
        return None
    most = max((row for row in verdicts if row.criterion.kind == RMS), key=lambda row: row.value)
    kinds = (("rms", RMS), ("3-sigma", SIGMA))
    criteria = [(f"{text} {axis}", Criterion(kind, axis=axis)) for text, kind in kinds for axis in "xyz"]
    of_base = [float(rms) if rms > STILL else None for rms in run.base_rms]
    sigmas = [rms and SIGMAS * rms for rms in of_base]
    return Table(
        id="random",
        title="Random vibration: rms and 3-sigma accelerations",
        columns=[Column(align="left"), *(Column(text, "g", ".3f") for text, _ in criteria)],
        rows=[
            [f"{run.response.scene.base} (base)", *of_base, *sigmas],
            *(
                [name, *(values.get((name, criterion)) for _, criterion in criteria)]
                for name in dict.fromkeys(row.subject for row in verdicts)
            ),
        ],
        note="Of the stationary part, from where the response has settled in it. The largest rms of the payload, "
        f"{most.subject} {most.criterion.axis}: {most.note}.",
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


def _sweep_chart(run: JudgedRun, sweep: Sweep) -> Chart:
    """Draw accelerations over the frequency of a sweep along the base's motion, as far from zero as they reach."""
    response, curves, tops = run.response, [], list[str]()
    frequency, peaks = sweep.frequency(response.time), {row.name: row for row in body_peaks(response)}
    for rank, name in enumerate((*worst_names(response), BASE)):
        size = np.zeros(response.time.size)
        for axis in moving_axes(response):
            size += acceleration_along(response, name, axis) ** 2
        x, y = crest(frequency, in_unit(np.sqrt(size), "g"))
        top = peaks[response.scene.base if name == BASE else name]  # of every step, as in the table
        peak = float(sweep.frequency([top.time])[0]), in_unit(top.value, "g")
        if name != BASE:
            tops.append(f"{short(name)} {with_unit(top.value, 'g')} at {fixed(peak[0], 2)} Hz")
        curves.append(Curve(x=x, y=y, name=short(name), kind=BASE if name == BASE else rank, peak=peak))
    panel = Panel(curves=curves, ylabel="acceleration [g]", xlabel="frequency of the base [Hz]", log="x", unit="g", xunit="Hz")
    return Chart(
        id="over-frequency", rows=[[panel]], height=210.0,
        caption=f"Accelerations along the base's motion over the frequency of the sweep; largest: {listed(tops)}.",
        alt="Accelerations over the frequency of the sweep.",
    )  # fmt: skip


def panel_over_frequency(run: JudgedRun) -> Panel | None:
    """Return what is drawn over frequency; None where there is nothing."""
    if isinstance(run.motion, Sweep):
        chart = _sweep_chart(run, run.motion)
        ends = sorted((run.motion.start, run.motion.stop))
        return replace(chart.rows[0][0], xlim=(ends[0], ends[1]))
    axis = main_direction(run.response)
    if run.spectra.densities:
        axes = list(run.spectra.densities)
        panel, axis = _along(densities_chart(run), axes, axis), axis if axis in axes else axes[0]
        rms = {short(name): in_unit(rms_along(run, name, axis), "g") for name in run.spectra.densities[axis]}
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
