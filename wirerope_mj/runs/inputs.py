"""Inputs of a run as names and values: the differences of two runs before anything is computed."""

from pathlib import Path
from typing import Any

from wirerope_mj.runs.checksums import digest_of
from wirerope_mj.runs.folder import SCENARIO
from wirerope_mj.runs.scenario_file import scenario_content

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


def _prefix(table: str) -> str:
    return "version of " if table == "versions" else ""


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
