"""TOML files that users write and JSON files of programs, read with messages that name file, line and column."""

import json
import tomllib
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, RecordError, WireRopeError, why_unread
from wirerope_mj.foundation.regular_files import regular


def read_toml(path: str | Path, kind: str, error: type[WireRopeError] = ModelError, remedy: str = "") -> Entries:
    """Read a TOML file, which messages call a `kind`, as "isolator file"; `remedy` for files that a program wrote.

    Raises:
        WireRopeError: `error`; the file cannot be read, is no text or is not TOML; names file, line and column, and what to do.
    """
    try:
        return toml_content(path)
    except OSError as fault:
        raise error(f"{path}: cannot read this {kind}: {why_unread(fault)}") from None
    except UnicodeDecodeError as fault:
        line = fault.object[: fault.start].count(b"\n") + 1
        text = f"{path}, line {line}: cannot read this {kind}: it is not a text file in UTF-8."
        raise error(f"{text} {remedy or 'Save it as plain text.'}") from None
    except tomllib.TOMLDecodeError as fault:
        form = "A line is `key = value`, with texts in quotes and a point, no comma, in numbers."
        raise error(f"{path}: not valid TOML: {fault}. {remedy or form}") from None


def toml_content(path: str | Path) -> Entries:
    """Return the content of a TOML file.

    Raises:
        OSError, UnicodeDecodeError, tomllib.TOMLDecodeError: as reading and parsing do; lists in lists without end are no TOML.
    """
    try:
        return tomllib.loads(regular(path).read_text(encoding="utf-8"))
    except RecursionError:
        raise tomllib.TOMLDecodeError("lists or tables stand in one another too deeply") from None


def read_json(path: Path, kind: str, remedy: str) -> Entries:
    """Read the table of a JSON file, which messages call a `kind`, as "the summary of a run"; RecordError if it is none."""
    try:
        content = json.loads(regular(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordError(f"{path}: {why_unread(error)} {remedy}") from None
    except json.JSONDecodeError as error:
        where = f"{path}, line {error.lineno}, column {error.colno}"
        raise RecordError(f"{where}: this is not {kind}, nor JSON. {remedy}") from None
    except (ValueError, RecursionError):
        raise RecordError(f"{path}: this is not {kind}, nor JSON in UTF-8. {remedy}") from None
    if not isinstance(content, dict):
        raise RecordError(f"{path}: this is not {kind}, which has names and values in braces. {remedy}")
    return content


def line_of(path: Path, keys: Sequence[str | int], named: Sequence[str] = ()) -> int | None:
    """Find the line at which a table of a TOML file begins, or its entry `named`; None where there is none.

    Of the names those count that follow each other inward from the table. The shortest beginning of the file that TOML takes
    and that holds the entry ends with it, so that the parser itself says where that is.
    """
    try:
        lines, content = regular(path).read_text(encoding="utf-8").split("\n"), toml_content(path)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return None
    inward = list(keys)
    for name in named:
        if entry_at(content, [*inward, name]) is not None:
            inward.append(name)

    def contains_entry(number: int) -> bool:
        """Tell whether the first `number` lines, completed to valid TOML, contain the entry."""
        for end in range(number, len(lines)):
            try:
                return entry_at(tomllib.loads("\n".join(lines[:end])), inward) is not None
            except tomllib.TOMLDecodeError:  # a list or a text that continues in the next line
                continue
        return True

    return bisect_left(range(1, len(lines)), True, key=contains_entry) + 1 if inward else None


def entry_at(content: object, keys: Sequence[str | int]) -> object:
    """Return the entry at a path of keys in nested tables and lists; None where there is none."""
    for key in keys:
        try:
            content = content[key]  # type: ignore[index]
        except (LookupError, TypeError):
            return None
    return content


def flat_entries(
    content: object, path: str = "", label: Callable[[object, int], str] = lambda item, number: str(number)
) -> Entries:
    """Return the values of nested tables and lists by path, "simulate.duration"; of empty ones the size, 0.

    `label` says what an entry of a list is called.
    """
    if isinstance(content, Mapping):
        items = [(str(key), item) for key, item in content.items()]
    elif isinstance(content, list | tuple):
        items = [(label(item, number), item) for number, item in enumerate(content)]
    else:
        return {path: content}
    if not items and path:
        return {path: 0}
    below = (flat_entries(item, f"{path}.{key}" if path else key, label) for key, item in items)
    return {name: value for entries in below for name, value in entries.items()}
