"""Properties of a recording: what a table of several recordings in the viewer can be sorted by."""

from typing import Any

from wirerope_mj.assessment.criteria import EXCEEDED, headline
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.drawn_runs import DrawnRun
from wirerope_mj.views.recording.letters import known_letters


def send_properties(rec: Any, run: DrawnRun, title: str) -> None:
    """Send the recording's name, and motion, level, verdict and the worst utilisation of the run as properties."""
    import rerun as rr

    response, used = run.response, run.selection.used
    rec.send_recording_name(title or response.scene.name)
    base = response.peaks.bodies.get(response.scene.base)
    worst = used[0].governing if used else None
    verdicts = run.selection.verdicts
    known = {
        "model": response.scene.name,
        "motion": str(response.motion.get("kind", "")),
        "level_g": in_unit(base.acceleration.value, "g") if base else None,
        "verdict": headline(verdicts),
        "exceeded": sum(verdict.verdict == EXCEEDED for verdict in verdicts),
        "worst": worst.subject if worst else None,
        "criterion": worst.criterion if worst else None,
        "utilisation_percent": in_unit(used[0].largest, "%") if used else None,
    }
    said = {name: known_letters(value) if isinstance(value, str) else value for name, value in known.items()}
    rec.send_property("run", rr.AnyValues(**{name: value for name, value in said.items() if value is not None}))
