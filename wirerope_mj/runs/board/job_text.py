"""The text of a job, edited key by key; comments, order and everything that is not touched stay as they were written."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

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
_AND = "; "  # between the motions of a case that are added


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
    """Write the motions of a case in one line, each its kind and its phrase, as `with_motions` reads them."""
    said = {kind: case[kind] for kind in SPOKEN_MOTIONS if kind in case}
    phrases = ((kind, text) for kind, texts in said.items() for text in ([texts] if isinstance(texts, str) else texts))
    return _AND.join(f"{kind} {text}" for kind, texts in phrases for text in listed_phrases(texts))


def with_motions(text: str, number: int, line: str) -> str:
    """Write the motions of case `number` as a line says them: "half-sine 15 g 11 ms z; half-sine 8 g 11 ms x".

    ModelError if a motion does not begin with its kind.
    """
    said: dict[str, list[str]] = {}
    for part in listed_phrases(line):
        kind, _, phrase = part.strip().partition(" ")
        if kind not in SPOKEN_MOTIONS:
            raise ModelError(f'"{short(kind)}" is no motion; a case begins with one of {", ".join(SPOKEN_MOTIONS)}.')
        said.setdefault(kind, []).append(phrase.strip())
    job = parsed(text)
    case = job["case"][number]
    for kind in SPOKEN_MOTIONS:
        if kind in case and kind not in said:
            del case[kind]
    for kind, phrases in said.items():
        case[kind] = phrases[0] if len(phrases) == 1 else phrases
    return tomlkit.dumps(job)


def with_value(text: str, keys: Sequence[str | int], value: str | float | bool | None) -> str:
    """Write the value at some keys, tables and numbers of cases among them; with None or "" the key is taken away."""
    job = parsed(text)
    table: Any = job
    for key in keys[:-1]:
        if isinstance(key, str) and key not in table:
            table[key] = tomlkit.table()
        table = table[key]
    last = keys[-1]
    if value in (None, ""):
        if isinstance(last, int) or last in table:
            del table[last]
    else:
        table[last] = value
    return tomlkit.dumps(job)


def with_case(text: str, name: str, line: str) -> str:
    """Add a case below the others, with a line left empty around it."""
    job = parsed(f"{text.rstrip()}\n\n")
    case = tomlkit.table()
    case["name"] = name
    case.add(tomlkit.nl())
    job.setdefault("case", tomlkit.aot()).append(case)
    return with_motions(f"{tomlkit.dumps(job).rstrip()}\n", len(job["case"]) - 1, line)
