"""One response, one `run.rrd`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from wirerope_mj.engine.response import Response
from wirerope_mj.views.recording.blueprint import blueprint_of
from wirerope_mj.views.recording.documents import log_documents
from wirerope_mj.views.recording.events import log_events
from wirerope_mj.views.recording.histories import log_histories
from wirerope_mj.views.recording.loops import log_loops, loops_of
from wirerope_mj.views.recording.poses import frames_of
from wirerope_mj.views.recording.scene import log_scene
from wirerope_mj.views.recording.selection import select
from wirerope_mj.views.recording.state import log_state
from wirerope_mj.views.recording.target import atomic_recording, target_of


def record_rerun(
    response: Response,
    path: str | Path,
    *,
    title: str = "",
    scenario_text: str = "",
    verdicts: Sequence[str] | None = None,
    tab: str = "Overview",
) -> Path:
    """Write a response as a recording that opens in the rerun viewer as it should be read, and return its path.

    Args:
        response: the response.
        path: file to write, or a folder, which gets a `run.rrd`; written whole or not at all.
        title: heading; the model's name if it is empty.
        scenario_text: Markdown or TOML that says what was simulated.
        verdicts: lines of Markdown that are shown above the peaks.
        tab: which tab is in front: "Overview", "Accelerations", "Deflections", "Forces", "Axial loops", ..., "Peaks".

    Raises:
        ValueError: there is no such tab.
        RecordError: the environment variable RERUN switches recordings off.
    """
    target = target_of(path)
    with atomic_recording(target) as rec:
        _write(response, rec, title=title, scenario_text=scenario_text, verdicts=verdicts, tab=tab)
    return target


def _write(
    response: Response, rec: Any, *, title: str, scenario_text: str, verdicts: Sequence[str] | None, tab: str
) -> None:

    selection, frames = select(response), frames_of(response)
    loops = loops_of(response, selection)
    # Before the data: a viewer that streams the file shows the right layout from its first moment.
    rec.send_blueprint(blueprint_of(response, selection, frames, loops, tab=tab), make_active=True, make_default=True)
    rec.send_recording_name(title or response.scene.name)
    log_documents(rec, response, selection, title=title, scenario_text=scenario_text, verdicts=verdicts)
    log_events(rec, response, selection)
    log_scene(rec, response, selection, frames)
    log_histories(rec, response, selection)
    log_loops(rec, response, selection, loops)
    log_state(rec, response)
