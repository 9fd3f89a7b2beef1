"""What a scenario says of judging, over what its model says: limits of the payload, and whether axes count together."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.declared import is_subject, limit_subjects
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import PayloadLimit


def judged_by(system: System, *, combined_travel: bool, limits: Sequence[PayloadLimit]) -> System:
    """Return the system with a scenario's limits in place of its model's; ModelError for one on nothing that is there."""
    return replace(_with_limits(system, limits), combined_travel=system.combined_travel and combined_travel)


def judge_table(*, combined_travel: bool, limits: Sequence[PayloadLimit]) -> dict[str, Any]:
    """Return the table `judge` of a run's scenario.toml; empty if the model alone decides."""
    content: dict[str, Any] = {} if combined_travel else {"combined_travel": False}
    if limits:
        content["limits"] = {f"{limit.kind}/{limit.name}": list(limit.values) for limit in limits}
    return content


def read_judge_table(content: Mapping[str, Any]) -> dict[str, Any]:
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
        if not isinstance(values, list) or any(
            isinstance(one, bool) or not isinstance(one, int | float) for one in values
        ):
            raise ValueError(f"`judge.limits.{key}` must be a list of numbers, got {values!r}.")
        try:
            limits.append(PayloadLimit(kind=kind, name=name, values=tuple(values)))
        except ValueError as error:
            raise ValueError(f"`judge.limits.{key}`: {error}") from None
    return {"combined_travel": combined, "limits": tuple(limits)}


def _with_limits(system: System, limits: Sequence[PayloadLimit]) -> System:
    """Return the system with limits in place of those that its model states for the same subjects.

    Raises:
        ModelError: a limit names no body of the payload and no point, or one thing is limited twice.
    """
    if not limits:
        return system
    known = limit_subjects(system.model, system.model.body(system.base).id if system.base else 0)
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
