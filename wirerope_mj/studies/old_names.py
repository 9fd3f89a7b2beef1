"""Names of inputs in study folders of format 1, in which shifts were not called so."""

import re
from typing import Any

import pyarrow as pa

FIRST = 1
"""The format in which "body/NAME/centre/x" and "mount/NAME/position/x" were shifts."""

_SHIFT = re.compile(r"^(body/.+/centre|mount/.+/position)(?=/[xyz]$)")


def todays_name(name: str) -> str:
    """Return what an input of a folder of format 1 is called now: "body/floor/centre/x" is "body/floor/centre_shift/x"."""
    return _SHIFT.sub(r"\1_shift", name)


def todays_inputs(content: dict[str, Any]) -> dict[str, Any]:
    """Return the content of a `study.toml` with today's names; its format stays, which says how its table is written."""
    if content["format"] != FIRST:
        return content
    return {**content, "vary": [{**one, "name": todays_name(one["name"])} for one in content["vary"]]}


def todays_table(table: pa.Table, content: dict[str, Any]) -> pa.Table:
    """Return the table of the folder of `content` with today's names."""
    if content["format"] != FIRST:
        return table
    return table.rename_columns([todays_name(name) for name in table.column_names])
