"""Recordings of one response, or of two or more over each other, by one writer.

The timeline is `sim_time` [s]. The entities of a run alone stand in `wirerope_mj.views.recording`; those of several are:

```text
/runs/NAME/world/...                          scene of a run, as in a recording of its own; mounts in the run's colour
/runs/NAME/state/...                          its exact samples, if they are kept; `read_state(path, run=NAME)` reads them
/ghosts/NAME/world/...                        its bodies in the base's frame, transparent in the run's colour
/histories/acceleration/DIR/KIND/PART         base, bodies and points of several runs [g];  .../RANK/NAME/peak
/histories/deflection|force/AXIS/MOUNT        mounts of several runs [mm, kN];  .../RANK/NAME/peak  .../rated
/histories/difference/KIND/PART/NAME          how far a run is from the first [g, mm]
/loops/AXIS/MOUNT                             frame of the plot;  .../data/NAME  the loop [mm, kN];  .../trail  .../cursor
/events/NAME                                  log of events
/differences  /peaks/...  /study              texts
```

RANK is 0 for the largest swing, which the viewer draws first and so behind the others.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from wirerope_mj.assessment.comparison import Align, Inputs
from wirerope_mj.assessment.criteria import Verdict
from wirerope_mj.content.events import main_instants
from wirerope_mj.content.panels import Panel
from wirerope_mj.content.selection import select
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.tables import Table
from wirerope_mj.views.recording.blueprint import blueprint_of
from wirerope_mj.views.recording.comparison_blueprint import loop_widths, overlay_blueprint
from wirerope_mj.views.recording.comparison_text import overlay_texts
from wirerope_mj.views.recording.cursor import log_cursor
from wirerope_mj.views.recording.documents import texts_of
from wirerope_mj.views.recording.drawn_runs import DrawnRun, Overlay, overlay_of, run_alone
from wirerope_mj.views.recording.events import log_events
from wirerope_mj.views.recording.ghosts import log_ghosts
from wirerope_mj.views.recording.graphs import Graphs, log_graphs
from wirerope_mj.views.recording.histories import graphs_of_overlay, graphs_of_run
from wirerope_mj.views.recording.lanes import log_lanes
from wirerope_mj.views.recording.large import large_factor, log_large
from wirerope_mj.views.recording.loops import drawn_loops, frame_width, log_loops, loop_plots
from wirerope_mj.views.recording.over_frequency import log_over_frequency
from wirerope_mj.views.recording.paths import AtEvents, Below
from wirerope_mj.views.recording.plan import log_plan
from wirerope_mj.views.recording.properties import send_properties
from wirerope_mj.views.recording.scene import log_scene
from wirerope_mj.views.recording.state import log_state
from wirerope_mj.views.recording.target import atomic_recording, target_of

OVERLAY_FILE = "overlay.rrd"


def record_rerun(
    response: Response,
    path: str | Path,
    *,
    title: str = "",
    scenario_text: str = "",
    verdicts: Sequence[Verdict] | None = None,
    tab: str = "Overview",
    state: bool = False,
) -> Path:
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
    return write_alone(
        run_alone(response, select(response, verdicts)),
        path,
        title=title,
        scenario_text=scenario_text,
        tab=tab,
        state=state,
    )


def write_alone(
    run: DrawnRun,
    path: str | Path,
    *,
    title: str,
    scenario_text: str,
    tab: str = "Overview",
    state: bool = False,
    panel: Panel | None = None,
) -> Path:
    """Write a run alone, and return the path; the rest is as for `record_rerun`.

    `panel` is what is drawn over frequency.
    """
    response = run.response
    graphs, loops = graphs_of_run(run), drawn_loops([run], run.selection)
    widths = {axis: frame_width(len(run.selection.shown(axis))) for axis in run.selection.axes}
    plots = loop_plots(loops, run.selection, widths)
    layout = blueprint_of(run, graphs, plots, panel, tab=tab)
    texts = texts_of(run, title=title, scenario_text=scenario_text)
    target = target_of(path)
    with atomic_recording(target) as rec:
        rec.send_blueprint(layout, make_active=True, make_default=True)
        send_properties(rec, run, title)
        shown = AtEvents(rec, main_instants(response, run.selection))
        _write(shown, texts, [run], graphs)
        log_lanes(shown, response, run.selection)
        log_cursor(shown, response, run.selection)
        log_plan(shown, response, run.selection)
        if (factor := large_factor(run)) > 1.0:
            log_large(shown, run, factor)
        if panel is not None:
            log_over_frequency(shown, response, run.selection, panel)
        log_loops(shown, loops, plots)
        if state:
            log_state(rec, response)
    return target


def record_overlay(
    responses: Mapping[str, Response],
    path: str | Path,
    *,
    align: Align = "start",
    inputs: Inputs | None = None,
    tables: Sequence[Table] = (),
    tab: str = "Overview",
    scene: str = "Side by side",
    state: bool = False,
) -> Path:
    """Write two or more responses as one recording in which they lie over each other, and return its path.

    What they share by name is drawn in the same axes, and the base of each whatever it is called; differences are those to the
    first. What only one of them has is listed.

    Args:
        responses: the responses by the names that they get; the first is what others are compared with.
        path: file to write, or a folder, which gets an `overlay.rrd`; written atomically.
        align: "start": all begin together, as they were simulated; "shock": their first events fall together.
        inputs: what was given to each, as names and values; those that are not the same for all are shown.
        tables: of the study that the runs belong to, which get a tab of their own, "Study".
        tab: which tab is in front: "Overview", "Accelerations", "Mounts", "Axial loops", ..., "Peaks".
        scene: which scene is in front: "Side by side", "Ghosts" or "Worst mount".
        state: whether the samples of all runs are kept, as `record_rerun` does.

    Raises:
        ValueError: there are too few or too many responses, or an argument is none of its choices.
        RecordError: they share nothing, or one has no shock to align; or the environment variable RERUN switches
            recordings off.
    """
    overlay = overlay_of(responses, align)
    return write_overlay(overlay, path, inputs=inputs or {}, tables=tables, tab=tab, scene=scene, state=state)


def write_overlay(
    overlay: Overlay,
    path: str | Path,
    *,
    inputs: Inputs,
    tables: Sequence[Table] = (),
    tab: str = "Overview",
    scene: str = "Side by side",
    state: bool = False,
) -> Path:
    """Write what `overlay_of` made of the runs, and return the path; the rest is as for `record_overlay`."""
    graphs, loops = graphs_of_overlay(overlay), drawn_loops(overlay.runs, overlay.shared)
    plots = loop_plots(loops, overlay.shared, loop_widths(overlay))
    layout = overlay_blueprint(overlay, graphs, plots, study=bool(tables), tab=tab, scene=scene)
    target = target_of(path, file=OVERLAY_FILE)
    with atomic_recording(target) as rec:
        rec.send_blueprint(layout, make_active=True, make_default=True)
        rec.send_recording_name(" and ".join(run.name for run in overlay.runs))
        _write(rec, overlay_texts(overlay, inputs, tables), overlay.runs, graphs)
        log_loops(rec, loops, plots)
        log_ghosts(rec, overlay)
        if state:
            for run in overlay.runs:
                log_state(Below(rec, run.root), run.response)
    return target


def _write(rec: Any, texts: Mapping[str, str], runs: Sequence[DrawnRun], graphs: Graphs) -> None:
    import rerun as rr

    for path, text in texts.items():
        rec.log(path, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
    for run in runs:
        log_events(rec, run)
        log_scene(Below(rec, run.root), run.response, run.selection, run.frames, arrow=run.color)
    times = [run.response.time for run in runs]
    log_graphs(rec, graphs, (min(time[0] for time in times), max(time[-1] for time in times)))
