"""summary.json of a run: what is written into it, and read back."""

from pathlib import Path

from wirerope_mj.assessment.criteria import summary
from wirerope_mj.assessment.criteria.sampled import samples_hold
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.run import run_content
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import Absent, RecordError
from wirerope_mj.foundation.summary import json_values
from wirerope_mj.foundation.toml_file import read_json
from wirerope_mj.runs.folder import FORMAT, SUMMARY

_REMEDY = "Take the file from another copy of the folder, or repeat the run."


def summary_content(judged: JudgedRun, *, seconds: float) -> Entries:
    """Return the content of summary.json; `seconds` is how long the simulation took."""
    response, content = judged.response, run_content(judged)
    numerics = response.numerics
    names = ("criterion", "subject", "value", "unit", "note")  # standard errors of random vibration are in its notes
    random = (
        [] if isinstance(judged.random, Absent) else [{name: getattr(row, name) for name in names} for row in judged.random]
    )
    return {
        "format": FORMAT, "name": str(judged.inputs["name"]), "motion": judged.motion.description,
        "record_warnings": list(judged.record_warnings),
        **({"model_warnings": list(judged.model_warnings)} if judged.model_warnings else {}),
        **summary(response, judged.verdicts),
        **({"random": random} if random else {}),
        **({"untested": judged.untested} if judged.untested else {}),
        "content": content.to_dict(*content.sections_of("headline", "summary")),
        "numerics": {
            "timestep_s": numerics.timestep, "steps": numerics.steps, "samples": int(response.time.size),
            "samples_hold": samples_hold(response), "callback": numerics.callback, "engine": numerics.engine,
            "why_not_kernel": numerics.why, "accuracy": json_values(numerics.accuracy),
            "estimated_error": json_values(numerics.error_estimate), "limited_by": numerics.limited_by,
            "seconds": seconds, "versions": numerics.versions,
        },
    }  # fmt: skip


def read_summary(folder: str | Path) -> Entries:
    """Return the content of a run's summary.json; RecordError if there is none, or it cannot be read."""
    path = Path(folder) / SUMMARY
    if not path.exists():
        raise RecordError(f"{folder}: there is no {SUMMARY} here. {_REMEDY}")
    return read_json(path, "the summary of a run", _REMEDY)
