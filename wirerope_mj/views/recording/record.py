"""Recordings of one response, or of two or more over each other: one writer, one layout."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import rerun as rr
from rerun.chunk import RrdReader

from wirerope_mj.assessment.comparison import Align
from wirerope_mj.assessment.correlation import Correlation
from wirerope_mj.assessment.criteria import EXCEEDED, Verdict, judge
from wirerope_mj.content.blocks import Panel
from wirerope_mj.content.comparison import Inputs
from wirerope_mj.content.correlation import with_ghosts
from wirerope_mj.content.events import events_of, main_instants
from wirerope_mj.content.first_sheet import panel_over_frequency
from wirerope_mj.content.histories import TOTAL
from wirerope_mj.content.judged_run import JudgedRun, RunResult
from wirerope_mj.content.verdicts import headline
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.half_written import hidden_folder
from wirerope_mj.foundation.plain_text import markdown, markdown_lines
from wirerope_mj.foundation.tables import Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.banner import log_tile
from wirerope_mj.views.recording.blueprint import blueprint_of, loop_widths
from wirerope_mj.views.recording.drawn_runs import (
    Drawn,
    DrawnRun,
    one_run,
    overlay_texts,
    run_texts,
    several_runs,
    test_texts,
)
from wirerope_mj.views.recording.ghosts import ghost_factor, log_ghosts
from wirerope_mj.views.recording.loops import drawn_loops, log_loops, loop_plots
from wirerope_mj.views.recording.now import log_cursor, log_plan
from wirerope_mj.views.recording.panels import log_lanes, log_over_frequency, log_panel
from wirerope_mj.views.recording.paths import (
    APPLICATION,
    PROPERTIES,
    TIMELINE,
    UTILISATION,
    WORST_INSTANT,
    AtEvents,
    Below,
    Stream,
    at,
    entity,
    known_letters,
    root_of,
)
from wirerope_mj.views.recording.scene import log_scene
from wirerope_mj.views.recording.viewer import atomic_recording, join_recordings, target_of

OVERLAY_FILE = "overlay.rrd"


def record_rerun(
    response: Response, path: str | Path, *, title: str = "", scenario_text: str = "",
    verdicts: Sequence[Verdict] | None = None, tab: str = "Overview", state: bool = False,
) -> Path:  # fmt: skip
    """Write a response as a recording that opens in the rerun viewer as it should be read, and return its path.

    Args:
        response: the response.
        path: file to write, or a folder, which gets a `run.rrd`; written atomically.
        title: heading; the model's name if it is empty.
        scenario_text: Markdown or TOML that says what was simulated.
        verdicts: on the response; without them those that `wirerope_mj.assessment.criteria.judge` returns.
        tab: which tab is in front: "Overview", "Accelerations", "Deflections", "Forces", "Axial loops", ..., "Peaks".
        state: whether every sample is kept under /state, too, bit for bit as `read_state` returns it: three quarters of a
            file, which no view shows.

    Raises:
        ValueError: there is no such tab.
        RecordError: the environment variable RERUN switches recordings off.
    """
    run = RunResult(response=response, verdicts=tuple(judge(response) if verdicts is None else verdicts))
    return record_run(run, path, title=title, scenario_text=scenario_text, tab=tab, state=state)


def record_run(
    run: RunResult, path: str | Path, *, title: str = "", scenario_text: str = "", tab: str = "Overview",
    state: bool = False, over_frequency: Panel | None = None, tests: Sequence[Correlation] = (), application: str = APPLICATION,
) -> Path:  # fmt: skip
    """Write a judged run as a recording, and return its path; other arguments as for `record_rerun`.

    `over_frequency` is the panel over frequency; measured channels of `tests` are ghosts among the curves of the run.
    Recordings of one `application` share a layout.
    """
    drawn = one_run(run, over_frequency)
    drawn = replace(drawn, panels=with_ghosts(drawn.panels, tests))
    texts = run_texts(run, title=title, scenario_text=scenario_text)
    answer = headline(run.verdicts)
    drawn = replace(drawn, answer=(str(answer.values["answer"]), answer.tone))
    drawn = replace(drawn, texts=(*texts, *test_texts(tests)), listed=application != APPLICATION)
    target = target_of(path)
    with atomic_recording(target, application=application) as rec:
        shown = AtEvents(rec, main_instants(run.response, run.selection))
        _write(rec, shown, drawn, tab=tab, state=state)
        used, base = drawn.runs[0].selection.used, run.response.peaks.bodies.get(run.response.scene.base)
        worst = used[0].governing if used else None
        known = {
            "model": run.response.scene.name, "motion": str(run.response.motion.get("kind", "")),
            "level_g": in_unit(base.acceleration.value, "g") if base else None, "verdict": answer.text,
            "exceeded": int(np.sum([verdict.verdict == EXCEEDED for verdict in run.verdicts])),
            "worst": worst.subject if worst else None, "criterion": worst.criterion if worst else None,
            WORST_INSTANT: opening_instant([drawn.runs[0]]),
            UTILISATION: in_unit(used[0].largest, "%") if used else None,
        }  # fmt: skip
        known = {name: known_letters(value) if isinstance(value, str) else value for name, value in known.items()}
        rec.send_recording_name(title or run.response.scene.name)
        rec.send_property(PROPERTIES, rr.AnyValues(**{name: value for name, value in known.items() if value is not None}))
        log_lanes(shown, run.response, run.selection)
        log_cursor(shown, run)
        log_plan(shown, run.response, run.selection)
        if drawn.over_frequency is not None:
            log_over_frequency(shown, run, drawn.over_frequency, listed=drawn.listed)
    return target


def record_cases(runs: Mapping[str, JudgedRun], path: Path, *, notes: Mapping[str, str]) -> None:
    """Write the runs of the load cases of one model, by their names, as one file: a recording with its layout for each.

    The viewer has one layout for all recordings of an application: here each case is one. `notes` say what the cases are.
    """
    with hidden_folder(path) as folder:
        if folder is None:
            raise RecordError(f"{path}: another process is writing this recording. Wait for it, or choose another folder.")
        parts = []
        for number, (name, run) in enumerate(runs.items(), start=1):
            parts.append(folder / f"{number}.rrd")
            text = "\n\n".join(filter(None, (markdown_lines(notes[name]), f"**Base motion:** {markdown(run.acting)}")))
            application = f"{number} {re.sub('[^A-Za-z0-9_ -]', '-', name)[:60]}".rstrip(" _-")  # letters that rerun takes
            over = panel_over_frequency(run)
            record_run(run, parts[-1], title=name, scenario_text=text, over_frequency=over, application=application)
        join_recordings(parts, path)


def record_overlay(
    responses: Mapping[str, Response], path: str | Path, *, align: Align = "start", inputs: Inputs | None = None,
    tables: Sequence[Table] = (), tab: str = "Overview", scene: str = "", state: bool = False,
) -> Path:  # fmt: skip
    """Write two or more responses as one recording in which they lie over each other, and return its path.

    What they share by name is drawn in the same axes, and the base of each whatever it is called; differences are those to the
    first. What only one of them has is listed.

    Args:
        responses: the responses by the names that they get; the first is what others are compared with.
        path: file to write, or a folder, which gets an `overlay.rrd`; written atomically.
        align: "start": all begin together, as they were simulated; "shock": their first events fall together.
        inputs: what was given to each, as names and values; those that are not the same for all are shown.
        tables: of the study that the runs belong to, which get a tab of their own, "Study".
        tab: which tab is in front: "Overview", "Accelerations", "Deflections", "Forces", "Axial loops", ..., "Peaks".
        scene: which scene is in front: "Worst mount", "Side by side" or "Ghosts"; the first that there is by default.
        state: whether the samples of all runs are kept, as `record_rerun` does.

    Raises:
        ValueError: there are too few or too many responses, or an argument is none of its choices.
        RecordError: they share nothing, or one has no shock to align; or the environment variable RERUN switches
            recordings off.
    """
    drawn = several_runs(responses, align)
    return record_runs(drawn, path, inputs=inputs or {}, tables=tables, tab=tab, scene=scene, state=state)


def record_runs(
    drawn: Drawn, path: str | Path, *, inputs: Inputs, tables: Sequence[Table] = (),
    judged: Mapping[str, JudgedRun] | None = None, tab: str = "Overview", scene: str = "", state: bool = False,
) -> Path:  # fmt: skip
    """Write the recording that `several_runs` composed, and return its path; the rest is as for `record_overlay`."""
    drawn = replace(drawn, texts=overlay_texts(drawn.comparison, inputs, tables, judged), answer=("COMPARISON", ""))
    target = target_of(path, file=OVERLAY_FILE)
    with atomic_recording(target) as rec:
        rec.send_recording_name(" and ".join(run.name for run in drawn.runs))
        _write(rec, rec, drawn, tab=tab, scene=scene, state=state)
        if (instant := opening_instant(drawn.runs)) is not None:
            rec.send_property(PROPERTIES, rr.AnyValues(**{WORST_INSTANT: instant}))
    return target


def _write(rec: rr.RecordingStream, shown: Stream, drawn: Drawn, *, tab: str, scene: str = "", state: bool) -> None:
    """Log the layout first, then texts, events, scenes, panels, loops and ghosts of one run or several."""
    loops = drawn_loops(drawn.runs, drawn.shared)
    plots = loop_plots(loops, drawn.shared, loop_widths(drawn))
    factor = ghost_factor(drawn)
    rec.send_blueprint(blueprint_of(drawn, plots, factor, tab=tab, scene=scene), make_active=True, make_default=True)
    log_tile(rec, *drawn.answer)
    for text in drawn.texts:
        rec.log(entity(*text.path), rr.TextDocument(text.text, media_type=rr.MediaType.MARKDOWN), static=True)
    for run in drawn.runs:
        if events := events_of(run.response, run.selection):
            prefix, color = (f"{run.name}: ", {"color": [run.color] * len(events)}) if run.name else ("", {})
            texts = [f"{event.time:.4f} s  {prefix}{event.text}" for event in events]
            columns = rr.TextLog.columns(text=texts, level=[event.level for event in events], **color)
            shown.send_columns(entity("events", *run.names), at([event.time for event in events]), columns)
        log_scene(Below(shown, run.root), run.response, run.selection, run.frames, arrow=run.color)
    times = [run.response.time for run in drawn.runs]
    ends = min(time[0] for time in times), max(time[-1] for time in times)
    for key, panel in drawn.panels.items():
        if not drawn.alone or key[1:] != (TOTAL,) or key in drawn.overview:  # panels that no view shows would only take space
            log_panel(rec, entity("histories", *key), panel, ends, every=not drawn.alone)
    log_loops(shown, loops, plots)
    if factor > 1.0 or not drawn.alone:
        log_ghosts(shown, drawn, factor)
    if state:
        for run in drawn.runs:
            log_state(Below(rec, run.root), run.response)


def opening_instant(runs: Sequence[DrawnRun]) -> float | None:
    """Find the instant of the most critical check of all runs [s]; without limits that of the largest acceleration."""
    used = [
        (entry.largest, entry.governing.time + run.moved)
        for run in runs for entry in run.selection.used if entry.governing.time is not None
    ]  # fmt: skip
    parts = [(run, run.response.peaks.bodies | run.response.peaks.points) for run in runs]
    peaks = [
        (known[name].acceleration.value, known[name].acceleration.time)
        for run, known in parts for name in (*run.selection.bodies, *run.selection.points)
    ]  # fmt: skip
    return max(used or peaks, default=(0.0, None))[1]


ROOT = "state"


def log_state(rec: Stream, response: Response) -> None:
    """Log every column of the response's samples.

    Columns of one kind ("base", "bodies", "points", "mounts", and "time" itself) stand side by side in one entity: each
    entity costs about 20 bytes a row beyond its numbers, which for one per mount would be as much as the view.
    """
    names = list(response.samples.names)
    first = 0
    while first < len(names):
        kind = names[first].split("/")[0]
        last = first + 1
        while last < len(names) and names[last].split("/")[0] == kind:
            last += 1
        rec.log(entity(ROOT, kind), rr.AnyValues(columns=names[first:last], first=first), static=True)
        row = 0
        for values in response.samples.blocks(first, last):  # a long run need not stand in memory, let alone twice
            index = at(response.time[row : row + len(values)])
            rec.send_columns(entity(ROOT, kind), index, rr.Scalars.columns(scalars=np.ascontiguousarray(values)))
            row += len(values)
        first = last


def read_state(path: str | Path, *, run: str = "") -> dict[str, Array]:
    """Read the columns under /state of a recording, (n_t,) each, by name and in the order of `response.parquet`.

    Of a recording of several runs, `run` is the name of one. RecordError if the file holds no samples.
    """
    root = root_of(run) + entity(ROOT)
    names: dict[str, tuple[int, list[str]]] = {}
    blocks: dict[str, list[tuple[int, Array]]] = {}
    for chunk in RrdReader(str(path)).stream():
        kind = str(chunk.entity_path).removeprefix(f"{root}/")
        if kind == str(chunk.entity_path):
            continue
        batch = chunk.to_record_batch()
        if "Scalars:scalars" in batch.schema.names:
            column = batch["Scalars:scalars"]
            start = int(batch[TIMELINE].cast("int64")[0].as_py())
            blocks.setdefault(kind, []).append((start, column.flatten().to_numpy().reshape(len(column), -1)))
        elif "columns" in batch.schema.names:
            names[kind] = (batch["first"].flatten()[0].as_py(), batch["columns"].flatten().to_pylist())
    if not blocks or set(blocks) != set(names):
        raise RecordError(f"{path}: there are no samples under {root} here; record the response again.")
    arrays = {
        kind: np.concatenate([values for _, values in sorted(parts, key=lambda part: part[0])])
        for kind, parts in blocks.items()
    }
    kinds = sorted(names, key=lambda kind: names[kind][0])
    return {name: arrays[kind][:, n] for kind in kinds for n, name in enumerate(names[kind][1])}
