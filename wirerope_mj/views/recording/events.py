"""Events of a run in a recording: as a log, and as a timeline of the few that tell its course."""

from typing import Any

from wirerope_mj.content.events import events_of
from wirerope_mj.views.recording.drawn_runs import DrawnRun
from wirerope_mj.views.recording.paths import at, entity


def log_events(rec: Any, run: DrawnRun) -> None:
    """Log the events of a run."""
    import rerun as rr

    events = events_of(run.response, run.selection)
    if events:
        prefix, color = (f"{run.name}: ", {"color": [run.color] * len(events)}) if run.name else ("", {})
        columns = rr.TextLog.columns(
            text=[f"{event.time:.4f} s  {prefix}{event.text}" for event in events],
            level=[event.level for event in events],
            **color,
        )
        rec.send_columns(entity("events", *run.names), at([event.time for event in events]), columns)
