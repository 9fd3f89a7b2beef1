"""JSON Schemas of the classes that tables of files are made into."""

import inspect
import re
from collections.abc import Mapping
from dataclasses import is_dataclass
from pathlib import Path
from types import NoneType
from typing import Annotated, Any

import msgspec

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.structure import DATE, keys_of, needed_keys, options_of, tables_in


def schema(kind: Any, schemas: Mapping[type, Entries] | None = None) -> Entries:
    """Return the JSON Schema of the tables of a class; `schemas` are those of classes that have readers."""
    explained = _comments(kind)
    properties: Entries = {}
    for key, found in keys_of(kind).items():
        about = explained.get(found.field)
        properties[key] = ({"description": about} if about else {}) | _value_schema(found.hint, schemas or {})
    content: Entries = {"type": "object", "description": (kind.__doc__ or "").split("\n")[0], "properties": properties}
    needed = needed_keys(kind).values()
    alone = [keys[0] for keys in needed if len(keys) == 1]
    several = [{"oneOf": [{"required": [key]} for key in keys]} for keys in needed if len(keys) > 1]
    content |= {"required": alone} if alone else {}
    return content | ({"allOf": several} if several else {}) | {"additionalProperties": False}


def _value_schema(hint: Any, schemas: Mapping[type, Entries]) -> Entries:
    found: list[Entries] = []
    how, inner = tables_in(hint)
    if inner is Path:
        found.append({"type": "string"})
    elif how is not float:
        tables = schemas[inner] if inner in schemas else schema(inner, schemas)
        lists = {"type": "array", "items": tables}
        found.append(tables if how is None else lists if how is tuple else {"type": "object", "additionalProperties": tables})
    for option, marks in options_of(hint):
        if option is not NoneType and tables_in(option)[0] is float:
            metas = tuple(mark for mark in marks if isinstance(mark, msgspec.Meta))
            found.append(msgspec.json.schema(Annotated[(option, *metas)] if metas else option))
            found += [{"type": "string", "format": "date"}] if DATE in marks else []
    return found[0] if len(found) == 1 else {"anyOf": found}


def _comments(kind: type) -> dict[str, str]:
    """Read what the source of a class says of its fields: the comment behind each, or those above it."""
    texts: dict[str, str] = {}
    for part in reversed(kind.__mro__):
        above: list[str] = []
        for line in inspect.getsource(part).splitlines() if is_dataclass(part) else ():
            text = line.partition("#")[2].lstrip(": ").strip()
            if line.strip().startswith("#"):
                above.append(text)
                continue
            if name := re.match(r"    (\w+): ", line):
                texts[name[1]] = text or " ".join(above)
            above = []
    return texts
