"""Content of a run, and its blocks on accelerations of the payload: against limits, over time and over frequency."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from wirerope_mj.assessment.comparison import BASE as THE_BASE
from wirerope_mj.assessment.criteria import body_peaks
from wirerope_mj.assessment.criteria.payload import body_corners, corner_displacements
from wirerope_mj.assessment.criteria.random import SIGMAS
from wirerope_mj.assessment.criteria.sampled import elements, sampled_peak, samples_hold
from wirerope_mj.assessment.criteria.verdict import RMS, SIGMA, Criterion, payload_bodies
from wirerope_mj.content.base import base_acceleration, base_blocks, warnings_of
from wirerope_mj.content.blocks import (
    BASE,
    Block,
    Chart,
    Content,
    Depth,
    Section,
    Statement,
    stacked,
)
from wirerope_mj.content.credibility import credibility_blocks, reliance
from wirerope_mj.content.decks import deck_blocks, decks_blocks
from wirerope_mj.content.first_sheet import brief_blocks
from wirerope_mj.content.histories import DIRECTIONS, Line, history_panel, subject_called
from wirerope_mj.content.judged_run import STILL, JudgedRun, RunResult
from wirerope_mj.content.model import model_blocks
from wirerope_mj.content.modes import run_modes_blocks
from wirerope_mj.content.mounts import contact_blocks, contact_history_blocks, mount_blocks, mount_history_blocks
from wirerope_mj.content.numbers import listed, number, paragraphs, several, with_unit
from wirerope_mj.content.random_vibration import random_blocks
from wirerope_mj.content.required_spectra import required_spectrum_blocks
from wirerope_mj.content.selection import MOST_CURVES, kind_of, worst_names
from wirerope_mj.content.spectrum_charts import spectra_blocks, sweep_chart
from wirerope_mj.content.statics import run_statics_blocks
from wirerope_mj.content.verdicts import (
    acceleration_limits,
    answer_blocks,
    full_table,
    grounds_blocks,
    headline,
    used_mark,
)
from wirerope_mj.engine.response import Numerics, Response
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Drop, Sweep, VibrationLines

_LARGE_ERROR = 0.01  # fraction of the peaks that is said of a step that was given
START = {
    "settled": "at rest in the equilibrium of the first loading",
    "relaxed": "at rest in the relaxed equilibrium, as after long vibration",
    "unloaded": "in the modelled geometry, with unloaded mounts",
}


def run_content(run: JudgedRun) -> Content:
    """Compose the content of a run: the verdict first, then its grounds."""

    def section(name: str, title: str, blocks: Callable[[JudgedRun], Iterable[Block | None]], depth: Depth = "full") -> Section:
        return Section(name, title, partial(blocks, run), depth)

    def warnings(run: JudgedRun) -> Iterator[Block | None]:
        for rank, warning in enumerate(run.model_warnings, start=1):
            yield Statement(f"model-warning-{rank}", f"warning: {warning}", tone="unjudged")
        yield warnings_of(run)

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
            section("warnings", "", warnings, "headline"),
            section(
                "brief", "", lambda judged: (*brief_blocks(judged), doubtful_numerics(judged.response.numerics)), "headline"
            ),
            section("reliance", "", lambda judged: [reliance(judged)]),
            section("answer", "", lambda judged: [*answer_blocks(judged)][:1], "headline"),
            section("grounds", "", grounds_blocks),
            section("accelerations", "Peak accelerations", acceleration_blocks, "summary"),
            section("mounts", "Peaks of the mounts", mount_blocks, "summary"),
            section("contacts", "Stops and contacts", contact_blocks, "summary"),
            section("random", "Transmissibility", random_blocks, "summary"),
            section("required-spectrum", "Required and achieved spectrum", required_spectrum_blocks, "summary"),
            section("model", "Model and mounts", model_blocks),
            section("statics", "At rest under gravity", run_statics_blocks),
            section("modes", "Modes", run_modes_blocks),
            section("base", "Base motion", base_blocks),
            section("payload", "What reaches the payload", _payload_blocks),
            section("mounts-in-motion", "Mounts in motion", mount_history_blocks),
            section("contact-histories", "Stops and contacts over time", contact_history_blocks),
            section("decks", "On a deck that bends", decks_blocks),
            section("deck", "Loads on the deck", deck_blocks),
            section("credibility", "How far this can be relied on", credibility_blocks),
            section("numerics", "Numerics, options and versions", _settings_blocks),
            section("verdicts", "All verdicts", lambda run: [full_table(run.verdicts)]),
        ),
    )


def doubtful_numerics(numerics: Numerics) -> Statement | None:
    """State how a run was computed if its estimated error exceeds that asked for, else 1 %, or finer steps do not agree."""
    error, asked = numerics.error_estimate, numerics.accuracy
    if numerics.limited_by == SENSITIVE or error > (_LARGE_ERROR if math.isnan(asked) else asked):  # NaN: not estimated
        return replace(numerics_statement(numerics), id="doubtful-numerics", tone="unjudged")
    return None


def numerics_statement(numerics: Numerics) -> Statement:
    limit = f", limited by {numerics.limited_by}" if numerics.limited_by else ""
    steps = f"{several(numerics.steps, 'step')} of at most {with_unit(numerics.timestep, 'ms', digits=4)}{limit}"
    return Statement(
        "numerics", f"{steps}, computed by {numerics.computed_by}, {numerics.error_text}", tone="quiet",
        values={"timestep_s": numerics.timestep, "steps": float(numerics.steps), "error": numerics.error_estimate},
    )  # fmt: skip


def _settings_blocks(run: JudgedRun) -> Iterator[Block]:
    """Tabulate steps, estimated error, samples, options and versions of a run."""
    numerics, arguments = run.response.numerics, run.inputs.get("simulate", {})
    initial, versions = str(arguments.get("initial", "settled")), run.inputs.get("versions", {})
    finite, step_given = math.isfinite(numerics.error_estimate), math.isnan(numerics.accuracy)
    error = f"{with_unit(numerics.error_estimate, '%', digits=2)} of the peaks, by halving the step"
    if not finite and step_given:
        error = "not estimated: the step was given"
    elif not finite or numerics.limited_by == SENSITIVE:
        error = numerics.error_text
    elif step_given:
        error += " that was given"
    else:
        above = "above the " if numerics.error_estimate > numerics.accuracy else ""
        error += f"; {above}{with_unit(numerics.accuracy, '%', digits=2)} asked for"
    rows = [
        ("simulated", f"{arguments.get('duration', run.response.time[-1]):g} s from {START.get(initial, initial)}"),
        ("steps", f"{several(numerics.steps, 'step')} of at most {with_unit(numerics.timestep, 'ms', digits=4)}"),
        ("step limited by", numerics.limited_by or "not recorded"),
        ("estimated error", error),
        ("samples", f"{run.response.time.size}; {samples_hold(run.response)}; peaks are those of every step"),
        ("computed by", f"{numerics.computed_by}{f': {numerics.why}' if numerics.why else ''}"),
    ]
    rows += [(f"option {name}", str(value)) for name, value in run.inputs.get("options", {}).items()]
    if versions:
        rows.append(("versions", ", ".join(f"{name} {version}" for name, version in versions.items())))
    columns = [*left("what"), Column("value", align="text")]
    yield Table("settings", "How it was computed", columns, rows)


def acceleration_blocks(run: RunResult) -> Iterator[Block | None]:
    """Yield peak accelerations against limits, and rms and 3-sigma values."""
    sweep, limited = run.sweep, acceleration_limits(run.verdicts)
    rows: list[Row] = []
    falls = any(part.get("kind") == Drop.kind for part in elements(run.response.motion))
    for row in body_peaks(run.response):
        kind = f"{row.kind}, in its fall" if row.kind == "base" and falls else row.kind
        name = row.name if row.kind == "body" else f"{row.name} ({kind})"
        cells: list[Cell] = [name, Mark(row.value, "strong"), *row.axes, row.time]
        cells += [] if sweep is None else [float(sweep.frequency([row.time])[0])]
        if limited:
            worst = limited.get(row.name)
            cells += [worst.limit, worst.criterion.axis, used_mark(worst.utilisation)] if worst else [None, "", None]
        rows.append(cells)
    columns = [*left(""), *(Column(name, "g", "z.2f") for name in ("peak", "x", "y", "z"))]
    columns += [Column("at", "s", "z.4f"), *([] if sweep is None else [Column("at", "Hz", "z.2f")])]
    columns += [Column("limit", "g"), *left("of"), Column("used", "%", "z.0f")] if limited else []
    title = "Peak accelerations" if limited else "Peak accelerations, not judged: the model states no limits"
    yield Table("peak-accelerations", title, columns, rows)
    yield payload_moves(run.response)
    yield dwells_found(run.response)
    if isinstance(run.random, Absent):
        yield Statement("random", f"No rms and 3-sigma values: {run.random.reason}", tone="quiet")
    elif run.random:
        values = {(row.subject, row.criterion): row.value for row in run.random}
        most = max((row for row in run.random if row.criterion.kind == RMS), key=lambda row: row.value)
        kinds = (("rms", RMS), ("3-sigma", SIGMA))
        criteria = [(f"{text} {axis}", Criterion(kind, axis=axis)) for text, kind in kinds for axis in "xyz"]
        base_values = [float(rms) if rms > STILL else None for rms in run.base_rms]
        names = dict.fromkeys(row.subject for row in run.random)
        yield Table(
            "random", "Random vibration: rms and 3-sigma accelerations",
            [*left(""), *(Column(text, "g", ".3f") for text, _ in criteria)],
            [
                [f"{run.response.scene.base} (base)", *base_values, *(rms and SIGMAS * rms for rms in base_values)],
                *([name, *(values.get((name, criterion)) for _, criterion in criteria)] for name in names),
            ],
            note="Of the stationary part, from where the response has settled in it. The largest rms of the payload, "
            f"{most.subject} {most.criterion.axis}: {most.note}.",
        )  # fmt: skip


def payload_moves(response: Response) -> Statement | None:
    """State how far the payload moves relative to the base: its points, or else the corners of its bodies."""
    reached = {
        name: (peak.relative_displacement.value, peak.relative_displacement.time, peak.relative_displacement.vector)
        for name, peak in response.peaks.points.items()
    }
    payload = payload_bodies(response)
    for body in () if reached else (body for body in response.scene.bodies if body.name in payload):
        corners = body_corners(body)
        for moved in corner_displacements(response, body, corners if corners.size else np.zeros((1, 3))):
            value, time = sampled_peak(response.time, np.linalg.norm(moved, axis=1))
            if value > reached.get(body.name, (-1.0,))[0]:
                reached[body.name] = value, time, moved[int(np.abs(response.time - time).argmin())]
    if not reached:
        return None
    name, (value, time, vector) = max(reached.items(), key=lambda entry: entry[1][0])
    x, y, z = (number(in_unit(float(part), "mm")) for part in vector)
    return Statement(
        "payload-moves",
        f"The payload moves up to {with_unit(value, 'mm')} relative to the base: {name} at {time:.4f} s, by {x}, {y}, {z} mm "
        "along x, y, z from the modelled geometry.",
        values={"displacement_m": value, "where": name, "at_s": time},
    )  # fmt: skip


def dwells_found(response: Response) -> Statement | None:
    """State the frequencies of an amplitude table at which it dwells; None of other motions."""
    seen, dwells = set[tuple[float, str]](), dict[float, float]()
    for part in elements(response.motion):
        if part.get("kind") == VibrationLines.kind and "duration" in part:
            (frequency, _), *others = next(part[name] for name in ("acceleration", "velocity", "displacement") if name in part)
            line = frequency, str(part["direction"])
            if line in seen and not others:
                dwells[frequency] = float(part["duration"])
            seen.add(line)
    if not dwells:
        return None
    at = ", ".join(f"{frequency:g}" for frequency in dwells)
    return Statement(
        "dwells", f"Dwells of {listed([f'{length:g} s' for length in dict.fromkeys(dwells.values())])} at {at} Hz."
    )


def _payload_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield accelerations of the most accelerated bodies and points: histories, over a sweep, and spectra."""
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


def accelerations_chart(run: JudgedRun, names: Sequence[str]) -> Chart:
    base = base_acceleration(run.response, run.motion)
    lines = []
    for name in names[:MOST_CURVES]:
        part = subject_called(run.response, name)
        lines.append(Line(response=run.response, subject=part, name=name, kind=kind_of(run.selection, name)))
    lines.append(Line(response=run.response, subject=THE_BASE, name="base", kind=BASE, history=base))
    return stacked([history_panel("acceleration", along, lines, run.selection.window) for along in DIRECTIONS])
