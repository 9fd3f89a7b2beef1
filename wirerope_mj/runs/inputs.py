"""Inputs of a run as names and values, and the verdicts on what came of them: what runs are compared by."""

from pathlib import Path
from typing import Any

from wirerope_mj.assessment.criteria import Verdict, judge
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.engine.response import Response
from wirerope_mj.runs.checksums import digest_of
from wirerope_mj.runs.folder import SCENARIO
from wirerope_mj.runs.scenario_file import scenario_content
from wirerope_mj.runs.sources import check_one_run, system_and_motion

_TABLES = ("options", "simulate", "versions")
_CHARACTERS = 8  # of a file's digest: enough to see that two files differ


def run_inputs(folder: str | Path) -> dict[str, str]:
    """Return scenario, options, motion, simulation, versions and the digests of the model's files; {} without a scenario.

    Raises:
        RecordError: the scenario or a file of the model cannot be read; names it.
    """
    path = Path(folder) / SCENARIO
    if not path.is_file():  # a response that was saved alone
        return {}
    content = scenario_content(path.parent)
    inputs = {"scenario": content["name"], "motion": content["motion"]["description"]}
    for table in _TABLES:
        inputs |= {f"{_prefix(table)}{key}": _text(value) for key, value in content[table].items()}
    for file in sorted(path.parent.glob("model/**/*")):
        if file.is_file():
            digest = digest_of(file)[:_CHARACTERS]
            inputs[f"{file.relative_to(path.parent)}"] = f"digest {digest}"
    return inputs


def run_verdicts(folder: str | Path, response: Response) -> tuple[Verdict, ...]:
    """Judge the response in a folder as `wirerope run` does; one that was saved alone by what its scene states.

    Raises:
        RecordError: scenario, motion or model cannot be read, or are not those of the response; names which.
    """
    folder = Path(folder)
    if not (folder / SCENARIO).is_file():
        return tuple(judge(response))
    content = scenario_content(folder)
    system, motion = system_and_motion(folder, content)
    check_one_run(folder, content, system, response)
    return judged_run(system, motion, response, content).verdicts


def _prefix(table: str) -> str:
    return "version of " if table == "versions" else ""


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
