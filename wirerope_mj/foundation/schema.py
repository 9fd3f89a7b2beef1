"""JSON Schemas of the classes that tables of files are made into, and blank forms of such files."""

import inspect
import json
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from types import NoneType
from typing import Annotated, Any

import msgspec
import tomli_w

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.structure import DATE, keys_of, marks_of, needed_keys, options_of, tables_in, unit_of


def schema(kind: Any, schemas: Mapping[type, Entries] | None = None) -> Entries:
    """Return the JSON Schema of a class's tables; `schemas` hold those of classes with readers of their own."""
    explained = _comments(kind)
    properties: Entries = {}
    for key, field in keys_of(kind).items():
        about = explained.get(field.field)
        properties[key] = ({"description": about} if about else {}) | _value_schema(field.hint, schemas or {})
    content: Entries = {"type": "object", "description": (kind.__doc__ or "").split("\n")[0], "properties": properties}
    needed = needed_keys(kind).values()
    alone = [keys[0] for keys in needed if len(keys) == 1]
    several = [{"oneOf": [{"required": [key]} for key in keys]} for keys in needed if len(keys) > 1]
    content |= {"required": alone} if alone else {}
    return content | ({"allOf": several} if several else {}) | {"additionalProperties": False}


def _value_schema(hint: Any, schemas: Mapping[type, Entries]) -> Entries:
    """Return the JSON Schema of the values that a field of a type may have, tables included."""
    options: list[Entries] = []
    how, inner = tables_in(hint)
    if inner is Path:
        options.append({"type": "string"})
    elif how is not float:
        tables = schemas[inner] if inner in schemas else schema(inner, schemas)
        lists = {"type": "array", "items": tables}
        options.append(tables if how is None else lists if how is tuple else {"type": "object", "additionalProperties": tables})
    for option, marks in options_of(hint):
        if option is not NoneType and tables_in(option)[0] is float:
            metas = tuple(mark for mark in marks if isinstance(mark, msgspec.Meta))
            options.append(msgspec.json.schema(Annotated[(option, *metas)] if metas else option))
            options += [{"type": "string", "format": "date"}] if DATE in marks else []
    return options[0] if len(options) == 1 else {"anyOf": options}


def _comments(kind: type) -> dict[str, str]:
    """Read the comments on the fields of a class from its source: behind each field, or above it."""
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


def example(value: Any) -> msgspec.Meta:
    """Mark the example of a field for blank forms, in the unit of its first key."""
    return msgspec.Meta(examples=[value])


def blank_form(kind: Any, *, filled: Collection[str] = (), title: str = "") -> str:
    """Write a template of a class's file: all keys with meaning and example, optional ones commented out.

    Examples stand in the marks of the fields, `bounds(examples=[..])`; of a field without one it is the default.

    Args:
        kind: the class of the file.
        filled: keys that are no comments though a file may leave them out: "case", and "case.half-sine" in its table.
        title: first lines, without their #.
    """
    head = [*title.splitlines(), "Take the # before a key away to use it, and that before its [table]. Numbers are examples."]
    return "\n".join([*(f"# {line}" for line in head), *_form(kind, "", filled, shown=True)]) + "\n"


def _form(kind: Any, path: str, filled: Collection[str], *, shown: bool) -> Iterator[str]:
    """Yield the lines of a table: keys without #, keys with #, then tables; `shown` if the table itself has no #."""
    explained, defaults = _comments(kind), {item.name: item.default for item in fields(kind)}
    written, first, later, tables = set[str](), list[str](), list[str](), list[str]()
    for key, field in keys_of(kind).items():
        if not field.among and field.field in written:  # in another unit
            continue
        written.add(field.field)
        place, (how, inner), marks = f"{path}{key}", tables_in(field.hint), marks_of(field.hint)
        metas = [mark for mark in marks if isinstance(mark, msgspec.Meta)]
        about = field.meant.summary if field.meant else explained.get(field.field, "")
        stated = [field.meant.example] if field.meant else [text for meta in metas for text in meta.examples or ()]
        active = shown and (field.field in needed_keys(kind) or place in filled)
        mark, nested = "" if active else "#", how is not float and inner is not Path
        if nested or (stated and isinstance(stated[0], dict)):
            tables += ["", *([f"# {about}"] if about else []), f"{mark}[[{place}]]" if how is tuple else f"{mark}[{place}]"]
            lines = _form(inner, f"{place}.", filled, shown=active) if nested else tomli_w.dumps(stated[0]).splitlines()
            tables += lines if nested else [f"{mark}{line}" for line in lines]
            continue
        default = defaults[field.field]
        if not stated and (default is None or default is MISSING or default in ((), "")):
            raise TypeError(f"`{place}` of {kind.__name__} needs an example.")
        example = stated[0] if stated else list(default) if isinstance(default, tuple) else default
        unit = "".join(f"[{unit_of(meta)}] " for meta in metas if unit_of(meta))
        line = f"{key} = {json.dumps(example)}" if isinstance(example, list) else tomli_w.dumps({key: example}).strip()
        (first if active else later).append(f"{mark}{line}" + (f"  # {unit}{about}" if unit + about else ""))
    yield from (*first, *later, *tables)
