"""Two or more responses over each other in one recording: what is different between them, where and when.

The timeline is `sim_time` [s] for all of them. Entities:

```text
/runs/NAME/world/...                          scene of a run, as in a recording of its own; mounts in the run's colour
/runs/NAME/state/...                          its exact samples; `read_state(path, run=NAME)` reads them
/ghosts/NAME/world/...                        its bodies in the base's frame, transparent in the run's colour
/histories/acceleration/DIR/KIND/PART         base, bodies and points of several runs [g];  .../RANK/NAME/peak
/histories/deflection|force/AXIS/MOUNT        mounts of several runs [mm, kN];  .../RANK/NAME/peak  .../rated
/histories/difference/KIND/PART/NAME          how far a run is from the first [g, mm]
/loops/AXIS/MOUNT                             frame of the plot;  .../data/NAME  the loop [mm, kN];  .../trail  .../cursor
/events/NAME                                  what happens
/differences  /peaks/...                      texts
```

RANK is 0 for the largest swing, which the viewer draws first and so behind the others.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from wirerope_mj.assessment.comparison import Align, Inputs
from wirerope_mj.engine.response import Response
from wirerope_mj.views.recording.events import events_of
from wirerope_mj.views.recording.overlay_blueprint import EVENTS, loop_widths, overlay_blueprint
from wirerope_mj.views.recording.overlay_ghosts import log_ghosts
from wirerope_mj.views.recording.overlay_histories import log_overlaid_histories
from wirerope_mj.views.recording.overlay_loops import log_overlaid_loops, overlaid_loops
from wirerope_mj.views.recording.overlay_runs import Overlay, overlay_of
from wirerope_mj.views.recording.overlay_text import log_overlay_texts
from wirerope_mj.views.recording.paths import Below, at, entity, root_of
from wirerope_mj.views.recording.scene import log_scene
from wirerope_mj.views.recording.state import log_state
from wirerope_mj.views.recording.target import atomic_recording, target_of

FILE = "overlay.rrd"


def record_overlay(
    responses: Mapping[str, Response],
    path: str | Path,
    *,
    align: Align = "start",
    inputs: Inputs | None = None,
    tab: str = "Overview",
    scene: str = "Side by side",
) -> Path:
    """Write two or more responses as one recording in which they lie over each other, and return its path.

    What they share by name is drawn in the same axes, and the base of each whatever it is called; differences are those to the
    first. What only one of them has is listed.

    Args:
        responses: the responses by the names that they get; the first is what others are compared with.
        path: file to write, or a folder, which gets an `overlay.rrd`; written whole or not at all.
        align: "start": all begin together, as they were simulated; "shock": their first events fall together.
        inputs: what was given to each, as names and values; those that are not the same for all are shown.
        tab: which tab is in front: "Overview", "Accelerations", "Mounts", "Axial loops", ..., "Peaks".
        scene: which scene is in front: "Side by side", "Ghosts" or "Worst mount".

    Raises:
        ValueError: there are too few or too many responses, or an argument is none of its choices.
        RecordError: they share nothing, or one has no shock to align; or the environment variable RERUN switches
            recordings off.
    """
    return write_overlay(overlay_of(responses, align), path, inputs=inputs or {}, tab=tab, scene=scene)


def write_overlay(
    overlay: Overlay, path: str | Path, *, inputs: Inputs, tab: str = "Overview", scene: str = "Side by side"
) -> Path:
    """Write what `overlay_of` made of the runs, and return the path; the rest is as for `record_overlay`."""
    target = target_of(path, file=FILE)
    with atomic_recording(target) as rec:
        _write(overlay, rec, inputs=inputs, tab=tab, scene=scene)
    return target


def _write(overlay: Overlay, rec: Any, *, inputs: Inputs, tab: str, scene: str) -> None:
    overlaid = overlaid_loops(overlay, loop_widths(overlay))
    blueprint = overlay_blueprint(overlay, overlaid, tab=tab, scene=scene)
    rec.send_blueprint(blueprint, make_active=True, make_default=True)  # before the data: right from the first moment
    rec.send_recording_name(" and ".join(run.name for run in overlay.runs))
    log_overlay_texts(rec, overlay, inputs)
    _log_events(rec, overlay)
    for run in overlay.runs:
        below = Below(rec, root_of(run.name))
        log_scene(below, run.response, run.selection, run.frames, arrow=run.color)
    log_ghosts(rec, overlay)
    log_overlaid_histories(rec, overlay)
    log_overlaid_loops(rec, overlaid)
    for run in overlay.runs:
        log_state(Below(rec, root_of(run.name)), run.response)


def _log_events(rec: Any, overlay: Overlay) -> None:
    import rerun as rr

    for run in overlay.runs:
        found = events_of(run.response, run.selection)
        if found:
            columns = rr.TextLog.columns(
                text=[f"{run.name}: {event.text}" for event in found],
                level=[event.level for event in found],
                color=[run.color] * len(found),
            )
            rec.send_columns(entity(EVENTS, run.name), at([event.time for event in found]), columns)
