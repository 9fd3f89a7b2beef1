"""What a run was given, as names and values: what tells two runs apart before anything is computed."""

import hashlib
import tomllib
from pathlib import Path
from typing import Any

from wirerope_mj.errors import RecordError
from wirerope_mj.runfolder.folder import SCENARIO

_TABLES = ("options", "simulate", "versions")
_CHARACTERS = 8  # of a file's digest: enough to see that two files differ


def run_inputs(folder: str | Path) -> dict[str, str]:
    """Return scenario, options, motion, simulation, versions and the digests of the model's files; {} without a scenario.

    Raises:
        RecordError: the scenario cannot be read.
    """
    path = Path(folder) / SCENARIO
    if not path.is_file():  # a response that was saved alone
        return {}
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
        inputs = {"scenario": str(content["name"]), "motion": str(content["motion"]["description"])}
        for table in _TABLES:
            inputs |= {f"{_prefix(table)}{key}": _text(value) for key, value in content[table].items()}
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, KeyError, TypeError, AttributeError) as error:
        raise RecordError(f"{path}: this is not the scenario of a run ({type(error).__name__}: {error}).") from None
    for file in sorted(path.parent.glob("model/**/*")):
        if file.is_file():
            digest = hashlib.sha256(file.read_bytes()).hexdigest()[:_CHARACTERS]
            inputs[f"{file.relative_to(path.parent)}"] = f"digest {digest}"
    return inputs


def _prefix(table: str) -> str:
    return "version of " if table == "versions" else ""


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
