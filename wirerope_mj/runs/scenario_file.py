"""The scenario as it stands in a run's folder, checked where it is read, and how it is judged."""

import math
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from wirerope_mj.engine.response.checked import check_motion
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.declared import is_subject, limit_subjects
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, RecordError, why_unread
from wirerope_mj.foundation.payload_limits import PayloadLimit, limits_by_patterns
from wirerope_mj.foundation.toml_file import toml_content
from wirerope_mj.runs.folder import FORMAT, SCENARIO


def judged_by(system: System, *, combined_travel: bool, limits: Sequence[PayloadLimit]) -> System:
    """Return the system with a scenario's limits in place of its model's; ModelError for one on nothing that is there."""
    return replace(_with_limits(system, limits), combined_travel=system.combined_travel and combined_travel)


def judge_table(*, combined_travel: bool, limits: Sequence[PayloadLimit]) -> Entries:
    """Return the table `judge` of a run's scenario.toml; empty if the model alone decides."""
    content: Entries = {} if combined_travel else {"combined_travel": False}
    if limits:
        content["limits"] = {f"{limit.kind}/{limit.name}": list(limit.values) for limit in limits}
    return content


def read_judge_table(content: Entries) -> Entries:
    """Return the arguments of `judged_by` that `judge_table` stored; ValueError names the key that is not what it must be."""
    unknown = [key for key in content if key not in ("combined_travel", "limits")]
    if unknown:
        raise ValueError(f"`judge.{unknown[0]}` is unknown; known: combined_travel, limits.")
    combined, stored = content.get("combined_travel", True), content.get("limits", {})
    if not isinstance(combined, bool):
        raise ValueError(f"`judge.combined_travel` must be true or false, got {combined!r}.")
    if not isinstance(stored, dict):
        raise ValueError(f"`judge.limits` must be a table, got {stored!r}.")
    limits = []
    for key, values in stored.items():
        kind, _, name = key.partition("/")
        if not isinstance(values, list) or not all(type(one) in (int, float) for one in values):
            raise ValueError(f"`judge.limits.{key}` must be a list of numbers, got {values!r}.")
        try:
            limits.append(PayloadLimit(kind=kind, name=name, values=tuple(values)))
        except ValueError as error:
            raise ValueError(f"`judge.limits.{key}`: {error}") from None
    return {"combined_travel": combined, "limits": tuple(limits)}


def subjects_of(system: System) -> dict[str, list[str]]:
    """Name the bodies and points that a limit of each kind may be on."""
    return limit_subjects(system.model, system.model.body(system.base).id if system.base else 0)


def _with_limits(system: System, limits: Sequence[PayloadLimit]) -> System:
    """Return the system with limits in place of those that its model states for the same subjects."""
    # A name may hold * and ?; a limit on a subject by its own name counts before one by such a pattern. ModelError if a limit
    # names no body of the payload and no point, or one thing is limited twice.
    if not limits:
        return system
    known = subjects_of(system)
    limits = limits_by_patterns(limits, known)
    for number, limit in enumerate(limits):
        if not is_subject(limit.name, limit.kind, known):
            raise ModelError(
                f"limit {limit.kind}/{limit.name}: there is no body of the payload and no point {limit.name!r} that has "
                f"this. There are {', '.join(known[limit.kind]) or 'none'}."
            )
        if any((other.kind, other.name) == (limit.kind, limit.name) for other in limits[:number]):
            raise ModelError(f"limit {limit.kind}/{limit.name}: it is given twice.")
    named = {(limit.kind, limit.name) for limit in limits}
    kept = [limit for limit in system.limits if (limit.kind, limit.name) not in named]
    return replace(system, limits=(*kept, *limits))


# Tables of which every key counts, and their keys.
_TABLES = {
    "model": ("file", "changes"),
    "simulate": ("duration", "initial", "timestep", "sample_rate", "callback", "accuracy", "corners", "engine"),
}
_NEEDED = {
    "model": ("file",), "simulate": ("duration", "initial", "timestep", "sample_rate", "callback"),
    "motion": ("kind", "description"), "options": (), "versions": (),
}  # fmt: skip
_REMEDY = "Put it right, or take the file from another copy of the folder."
_CHOICES = {"initial": ("settled", "relaxed", "unloaded"), "callback": ("native", "python"), "engine": ("mujoco", "kernel")}


def scenario_content(folder: Path) -> Entries:
    """Return the scenario of a run as it stands in its folder, with everything there and of the right type.

    RecordError if the folder is not a run, or its scenario is damaged; names the key.
    """
    path = folder / SCENARIO
    if not path.is_file():
        raise RecordError(f"{folder}: this is not a run; there is no {SCENARIO} here.")
    try:
        content = toml_content(path)
    except OSError as error:
        raise RecordError(f"{path}: {why_unread(error)}") from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise RecordError(f"{path}, line {line}: this is not the scenario of a run, nor text in UTF-8. {_REMEDY}") from None
    except tomllib.TOMLDecodeError as error:
        raise RecordError(f"{path}: this is not the scenario of a run, nor TOML: {error}. {_REMEDY}") from None
    if "format" in content and content["format"] != FORMAT:
        raise RecordError(f"{path}: `format` is {content['format']!r}, not {FORMAT}; use the version that wrote it.")
    try:
        _check(content)
    except ValueError as error:
        raise RecordError(f"{path}: this is not the scenario of a run as it was written: {error} {_REMEDY}") from None
    return content


def _check(content: Entries) -> None:
    """Raise ValueError that names the key unless the scenario is what `run_scenario` writes."""
    for name in ("format", "name", "question"):
        if name not in content:
            raise ValueError(f"`{name}` is missing.")
        if name != "format" and not isinstance(content[name], str):
            raise ValueError(f"`{name}` must be a string, got {content[name]!r}.")
    for table, needed in _NEEDED.items():
        if not isinstance(content.get(table), dict):
            raise ValueError(f"the table `{table}` is missing.")
        for key in needed:
            if key not in content[table]:
                raise ValueError(f"`{table}.{key}` is missing.")
        for key in content[table]:
            if table in _TABLES and key not in _TABLES[table]:
                raise ValueError(f"`{table}.{key}` is unknown; known: {', '.join(_TABLES[table])}.")
    for table, names in (("model", _TABLES["model"]), ("motion", _NEEDED["motion"]), ("versions", content["versions"])):
        for key in names:
            if not isinstance(content[table].get(key, ""), str):
                raise ValueError(f"`{table}.{key}` must be a string, got {content[table][key]!r}.")
    _check_simulate(content["simulate"])
    judge = content.get("judge", {})  # only where it says something
    if not isinstance(judge, dict):
        raise ValueError(f"`judge` must be a table, got {judge!r}.")
    read_judge_table(judge)
    check_motion("motion", content["motion"])


def _check_simulate(simulate: Entries) -> None:
    for name in ("duration", "sample_rate", "timestep", "accuracy"):
        if name in simulate and not (_is_finite(simulate[name]) and simulate[name] > 0.0):
            raise ValueError(f"`simulate.{name}` must be a number > 0, got {simulate[name]!r}.")
    for name, choices in _CHOICES.items():
        if name in simulate and simulate[name] not in choices:
            raise ValueError(f"`simulate.{name}` must be one of {', '.join(choices)}, got {simulate[name]!r}.")
    corners = simulate.get("corners", [])
    if not isinstance(corners, list) or not all(_is_finite(corner) for corner in corners):
        raise ValueError("`simulate.corners` must be a list of finite instants [s].")


def _is_finite(value: Any) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and abs(value) <= 1e300 and math.isfinite(value)  # larger integers are no float
