"""Edits of a board's job: load cases, limits, deck, temperature and the data of the document."""

import re
from collections.abc import Callable

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.runs.board.job_text import parsed, with_case, with_motions, with_value


def _number(text: str, action: Entries) -> int:
    """Return the number of the case that is asked for."""
    try:
        number = int(action.get("case", ""))
    except ValueError:
        number = -1
    if not 0 <= number < len(parsed(text).get("case", [])):
        raise ModelError("there is no such load case.")
    return number


def _case(text: str, action: Entries) -> tuple[str, str]:
    number, value = _number(text, action), str(action.get("value", "")).strip()
    if (key := str(action.get("key"))) == "motions":
        return with_motions(text, number, value), value
    return with_value(text, ["case", number, key], value), f"{key} {value}"


def _add_case(text: str, action: Entries) -> tuple[str, str]:
    names = [case.get("name") for case in parsed(text).get("case", [])]
    name = next(name for n in range(1, 10_000) if (name := f"case {n}") not in names)
    return with_case(text, name, "half-sine 15 g 11 ms z"), f"{name} added"


def _remove_case(text: str, action: Entries) -> tuple[str, str]:
    return with_value(text, ["case", _number(text, action)], None), "load case taken away"


def _limit(text: str, action: Entries) -> tuple[str, str]:
    key, value = str(action.get("key", "")).strip(), str(action.get("value", "")).strip()
    if not key:
        raise ModelError('name what is limited, such as "acceleration/equipment".')
    if not value and key not in parsed(text).get("limits", {}):
        raise ModelError(
            f'"{short(key)}" is no limit; one is written like acceleration/equipment = 4 g, or acceleration/* = 4 g.'
        )
    return with_value(text, ["limits", key], value), f"limit {key} {value or 'taken away'}"


def _add_limit(text: str, action: Entries) -> tuple[str, str]:
    """Add a limit that is said in one line, as `--limit` takes it; the sign may be missing."""
    key, _, value = re.sub(r"^(\S+/\S+)\s+(?=[-+.\d])", r"\1 = ", str(action.get("value", "")).strip()).partition("=")
    return _limit(text, {"key": key, "value": value})


_KEYS = ("name", "question", "deck", "temperature")


def _job(text: str, action: Entries) -> tuple[str, str]:
    key, value = str(action.get("key")), str(action.get("value", "")).strip()
    table, _, name = key.rpartition(".")
    if key not in _KEYS and table != "document":
        raise ModelError(f"there is no {key[:40]!r} here.")
    return with_value(text, [table, name] if table else [key], value), f"{name} {value or 'left empty'}"


JOB_EDITS: dict[str, Callable[[str, Entries], tuple[str, str]]] = {
    "case": _case, "add-case": _add_case, "remove-case": _remove_case, "limit": _limit, "add-limit": _add_limit, "job": _job,
}  # fmt: skip
