"""Checks of a study's `study.toml` as it stands in a folder: a digest that fits says nothing of what it holds."""

import inspect
from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Any, get_args

from wirerope_mj.engine.response.checked import check_motion
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.studies.inputs.distributions import Distribution

_KINDS: dict[str, Any] = {kind.__name__: kind for kind in get_args(Distribution)}
_TABLES: dict[str, tuple[dict[str, Any], dict[str, Any] | None]] = {
    "model": ({"file": str}, {"changes": str, "path": str}),
    "simulate": ({"duration": Any, "timestep": Any, "sample_rate": Any, "initial": Any}, {}),
    "sampling": ({"method": str, "variants": int, "seed": int}, {}),
    "versions": ({}, None),
    "files": ({}, None),
}
"""Keys of each table that must be there, and that may be, with the types of their values; None: any may."""


def check_inputs(content: Mapping[str, Any]) -> None:
    """Raise ValueError that names the key unless a study can be made from the inputs."""
    for name, (needed, further) in _TABLES.items():
        if name == "files" and name not in content:  # of the first format
            continue
        _check_table(name, content.get(name), needed, further)
    for name in ("vary", "motions"):
        if not isinstance(content.get(name), list):
            raise ValueError(f"`{name}` must be a list of tables, got {quoted(content.get(name))}.")
    for number, one in enumerate(content["vary"]):
        _check_distribution(f"vary.{number}", one)
    for number, motion in enumerate(content["motions"]):
        check_motion(f"motions.{number}", motion)


def _check_table(name: str, table: Any, needed: Mapping[str, Any], further: Mapping[str, Any] | None) -> None:
    if not isinstance(table, dict):
        raise ValueError(f"`{name}` must be a table, got {quoted(table)}.")
    for key in needed:
        if key not in table:
            raise ValueError(f"`{name}.{key}` is missing.")
    for key, value in table.items():
        kind = {**needed, **(further or {})}.get(key, Any if further is None else None)
        if kind is None:
            raise ValueError(f"`{name}.{key}` is unknown; known: {', '.join([*needed, *(further or {})])}.")
        if kind is not Any and (not isinstance(value, kind) or isinstance(value, bool)):
            raise ValueError(f"`{name}.{key}` must be {'text' if kind is str else 'an integer'}, got {quoted(value)}.")
        if name == "model" and "\0" in value:
            raise ValueError(f"`{name}.{key}` must be the path of a file, got {quoted(str(PurePosixPath(value)))}.")


def _check_distribution(name: str, table: Any) -> None:
    if not isinstance(table, dict) or not isinstance(table.get("name"), str):
        raise ValueError(f"`{name}` must be a table with the `name` of what varies, got {quoted(table)}.")
    one_of(f"{name}.kind", table.get("kind"), _KINDS)
    given = {key: value for key, value in table.items() if key not in ("name", "kind", "choices")}
    choices = table.get("choices", [])
    if not isinstance(choices, list):
        raise ValueError(f"`{name}.choices` must be a list, got {quoted(choices)}.")
    for flag in ("relative", "each"):
        if not isinstance(given.get(flag, False), bool):
            raise ValueError(f"`{name}.{flag}` must be true or false, got {quoted(given[flag])}.")
    try:
        inspect.signature(_KINDS[table["kind"]]).bind(*choices, **given)
    except TypeError as error:
        raise ValueError(f"`{name}`: {str(error).replace('an unexpected keyword', 'an unknown')}.") from None
