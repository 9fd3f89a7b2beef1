"""summary.json of a run: what is written into it, and read back."""

import json
from pathlib import Path

from wirerope_mj.assessment.criteria import summary
from wirerope_mj.assessment.criteria.sampled import samples_hold
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.run import run_content
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import Absent, RecordError, why_unread
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.summary import json_values
from wirerope_mj.runs.folder import FORMAT, SUMMARY

_REMEDY = "Take the file from another copy of the folder, or repeat the run."


def summary_content(judged: JudgedRun, *, seconds: float) -> Entries:
    """Return the content of summary.json; `seconds` is how long the simulation took."""
    response, content = judged.response, run_content(judged)
    numerics = response.numerics
    return {
        "format": FORMAT, "name": str(judged.inputs["name"]), "motion": judged.motion.description,
        "record_warnings": list(judged.record_warnings),
        **({"model_warnings": list(judged.model_warnings)} if judged.model_warnings else {}),
        **summary(response, judged.verdicts),
        **_random_content(judged),
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


def _random_content(judged: JudgedRun) -> Entries:
    """Return rms and 3-sigma accelerations of random vibration [m/s^2], standard errors in their notes; nothing without any."""
    if isinstance(judged.random, Absent) or not judged.random:
        return {}
    names = ("criterion", "subject", "value", "unit", "note")
    return {"random": [{name: getattr(row, name) for name in names} for row in judged.random]}


def read_summary(folder: str | Path) -> Entries:
    """Return the content of a run's summary.json; RecordError if there is none, or it cannot be read."""
    path = Path(folder) / SUMMARY
    try:
        content = json.loads(regular(path).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise RecordError(f"{folder}: there is no {SUMMARY} here. {_REMEDY}") from None
    except OSError as error:
        raise RecordError(f"{path}: {why_unread(error)}") from None
    except json.JSONDecodeError as error:
        raise RecordError(
            f"{path}, line {error.lineno}, column {error.colno}: this is not the summary of a run, nor JSON. {_REMEDY}"
        ) from None
    except (ValueError, RecursionError):
        raise RecordError(f"{path}: this is not the summary of a run, nor JSON in UTF-8. {_REMEDY}") from None
    if not isinstance(content, dict):
        raise RecordError(f"{path}: this is not the summary of a run, which has names and values in braces. {_REMEDY}")
    return content
