"""One response, one `run.rrd`."""

import os
import uuid
from collections.abc import Sequence
from pathlib import Path

from wirerope_mj.errors import RecordError
from wirerope_mj.recording.blueprint import blueprint_of
from wirerope_mj.recording.documents import log_documents
from wirerope_mj.recording.events import log_events
from wirerope_mj.recording.histories import log_histories
from wirerope_mj.recording.loops import log_loops, loops_of
from wirerope_mj.recording.paths import APPLICATION, FILE
from wirerope_mj.recording.poses import frames_of
from wirerope_mj.recording.scene import log_scene
from wirerope_mj.recording.selection import select
from wirerope_mj.recording.state import log_state
from wirerope_mj.response import Response


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
    import rerun as rr
    from rerun.error_utils import strict_mode

    target = Path(path)
    target = target / FILE if target.is_dir() or target.suffix != ".rrd" else target
    target.parent.mkdir(parents=True, exist_ok=True)
    beside = target.with_name(target.name + ".part")
    was_strict = strict_mode()
    rr.set_strict_mode(True)  # otherwise a wrong call loses data with no more than a warning
    try:
        _write(response, beside, title=title, scenario_text=scenario_text, verdicts=verdicts, tab=tab)
        if not beside.is_file():
            raise RecordError("nothing was recorded: the environment variable RERUN switches it off. Unset it.")
        os.replace(beside, target)
    finally:
        rr.set_strict_mode(was_strict)
        beside.unlink(missing_ok=True)
    return target


def _write(
    response: Response, path: Path, *, title: str, scenario_text: str, verdicts: Sequence[str] | None, tab: str
) -> None:
    import rerun as rr

    selection, frames = select(response), frames_of(response)
    loops = loops_of(response, selection)
    with rr.RecordingStream(APPLICATION, recording_id=uuid.uuid4()) as rec:
        rec.set_log_time_enabled(False)
        rec.save(path)
        # Before the data: a viewer that streams the file shows the right layout from its first moment.
        rec.send_blueprint(
            blueprint_of(response, selection, frames, loops, tab=tab), make_active=True, make_default=True
        )
        rec.send_recording_name(title or response.scene.name)
        log_documents(rec, response, selection, title=title, scenario_text=scenario_text, verdicts=verdicts)
        log_events(rec, response, selection)
        log_scene(rec, response, selection, frames)
        log_histories(rec, response, selection)
        log_loops(rec, response, selection, loops)
        log_state(rec, response)
