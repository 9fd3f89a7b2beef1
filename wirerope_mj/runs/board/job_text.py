"""The text of a job, edited key by key; comments, order and everything that is not touched stay as they were written."""

import json
import re
from collections.abc import Mapping
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.motions.registry import SPOKEN_MOTIONS
from wirerope_mj.runs.said_motion import listed_phrases

_BLANK = """# A job of load cases, as `wirerope cases` takes it.
model = {model}
name = {name}

[limits]

[[case]]
name = "vertical shock"
half-sine = "15 g 11 ms z"
"""
JOB_EDITS = ("case", "add-case", "remove-case", "limit", "add-limit", "job")
_KEYS = ("name", "question", "deck", "temperature")  # of a job that are set as they are


def blank_job(model: str, name: str) -> str:
    """Write a job of one load case, to be edited."""
    return _BLANK.format(model=json.dumps(model, ensure_ascii=False), name=json.dumps(name, ensure_ascii=False))


def parsed(text: str) -> tomlkit.TOMLDocument:
    """Parse a job; ModelError if it is no TOML."""
    try:
        return tomlkit.parse(text)
    except TOMLKitError as error:
        raise ModelError(f"the job is no TOML: {error}") from None


def motions_of(case: Mapping[str, Any]) -> str:
    """Write the motions of a case in one line, each its kind and its phrase."""
    said = {kind: case[kind] for kind in SPOKEN_MOTIONS if kind in case}
    phrases = ((kind, text) for kind, texts in said.items() for text in ([texts] if isinstance(texts, str) else texts))
    return "; ".join(f"{kind} {text}" for kind, texts in phrases for text in listed_phrases(texts))


def edited_job(text: str, asked: str, action: Entries) -> tuple[str, str]:
    """Edit the text of a job by one of `JOB_EDITS`; return it and a phrase that says what was done; ModelError if it fails."""
    job = parsed(f"{text.rstrip()}\n\n" if asked == "add-case" else text)
    key, value = str(action.get("key", "")).strip(), str(action.get("value", "")).strip()
    if asked == "add-case":
        cases = job.setdefault("case", tomlkit.aot())
        names = [case.get("name") for case in cases]
        name = next(name for n in range(1, 10_000) if (name := f"case {n}") not in names)
        case = tomlkit.table()
        case |= {"name": name, "half-sine": "15 g 11 ms z"}
        case.add(tomlkit.nl())
        cases.append(case)
        return f"{tomlkit.dumps(job).rstrip()}\n", f"{name} added"
    if asked in ("case", "remove-case"):
        number = str(action.get("case", ""))
        if number not in map(str, range(len(job.get("case", [])))):
            raise ModelError("there is no such load case.")
        case, said = job["case"][int(number)], value if key == "motions" else f"{key} {value}"
        if asked == "remove-case":
            del job["case"][int(number)]
            said = "load case taken away"
        elif key == "motions":
            _write_motions(case, value)
        else:
            _write(case, key, value)
    elif asked == "job":
        table, _, name = key.rpartition(".")
        if key not in _KEYS and table != "document":
            raise ModelError(f"there is no {key[:40]!r} here.")
        _write(job.setdefault(table, tomlkit.table()) if table else job, name, value)
        said = f"{name} {value or 'left empty'}"
    else:
        if asked == "add-limit":  # in one line, as `--limit` takes it; the sign may be missing
            key, _, value = re.sub(r"^(\S+/\S+)\s+(?=[-+.\d])", r"\1 = ", value).partition("=")
        key, value, limits = key.strip(), value.strip(), job.setdefault("limits", tomlkit.table())
        if not key:
            raise ModelError('name what is limited, such as "acceleration/equipment".')
        if not value and key not in limits:
            raise ModelError(
                f'"{short(key)}" is no limit; one is written like acceleration/equipment = 4 g, or acceleration/* = 4 g.'
            )
        _write(limits, key, value)
        said = f"limit {key} {value or 'taken away'}"
    return tomlkit.dumps(job), said


def _write(table: Any, key: str, value: str) -> None:
    """Write the value of a key, or take it away where there is none."""
    if value:
        table[key] = value
    elif key in table:
        del table[key]


def _write_motions(case: Any, line: str) -> None:
    """Write the motions of a case as a line says them: "half-sine 15 g 11 ms z; half-sine 8 g 11 ms x"."""
    said: dict[str, list[str]] = {}
    for part in listed_phrases(line):
        kind, _, phrase = part.strip().partition(" ")
        if kind not in SPOKEN_MOTIONS:
            known = f'"{short(kind)}" is no motion; a case begins with one of {", ".join(SPOKEN_MOTIONS)}.'
            raise ModelError(f'{known} It is written like "half-sine 15 g 11 ms z".')
        said.setdefault(kind, []).append(phrase.strip())
    for kind in SPOKEN_MOTIONS:
        if kind in said:
            case[kind] = said[kind][0] if len(said[kind]) == 1 else said[kind]
        elif kind in case:
            del case[kind]
