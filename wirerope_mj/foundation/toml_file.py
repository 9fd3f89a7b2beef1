"""TOML files that users write, read with messages that name file, line and column."""

import tomllib
from bisect import bisect_left
from collections.abc import Sequence
from pathlib import Path

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, WireRopeError, why_unread
from wirerope_mj.foundation.regular_files import regular


def read_toml(path: str | Path, kind: str, error: type[WireRopeError] = ModelError, remedy: str = "") -> Entries:
    """Read a TOML file, which messages call a `kind`, as "isolator file"; `remedy` of one that a program wrote.

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


def line_of(path: Path, keys: Sequence[str | int], named: Sequence[str] = ()) -> int | None:
    """Find the line at which a table of a TOML file begins, or the entry in it that is `named`; None where there is none.

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

    def holds(number: int) -> bool:
        """Return whether what begins in the first lines holds the entry."""
        for end in range(number, len(lines)):
            try:
                return entry_at(tomllib.loads("\n".join(lines[:end])), inward) is not None
            except tomllib.TOMLDecodeError:  # a list or a text that goes on below
                continue
        return True

    return bisect_left(range(1, len(lines)), True, key=holds) + 1 if inward else None


def entry_at(content: object, keys: Sequence[str | int]) -> object:
    """Return the entry of nested tables and lists under some keys; None where there is none."""
    for key in keys:
        try:
            content = content[key]  # type: ignore[index]
        except (LookupError, TypeError):
            return None
    return content
