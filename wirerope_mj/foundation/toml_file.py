"""TOML files that users write, read with messages that name file, line and column."""

import tomllib
from pathlib import Path

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, why_unread
from wirerope_mj.foundation.regular_files import regular


def read_toml(path: str | Path, kind: str) -> Entries:
    """Read a TOML file, which messages call a `kind`, as "isolator file".

    Raises:
        ModelError: the file cannot be read, is no text or is not TOML; names file, line and column, and what to do.
    """
    try:
        return toml_content(path)
    except OSError as error:
        raise ModelError(f"{path}: cannot read this {kind}: {why_unread(error)}") from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise ModelError(
            f"{path}, line {line}: cannot read this {kind}: it is not a text file in UTF-8. Save it as plain text."
        ) from None
    except tomllib.TOMLDecodeError as error:
        raise ModelError(
            f"{path}: not valid TOML: {error}. A line is `key = value`, with texts in quotes and a point, no comma, in numbers."
        ) from None


def toml_content(path: str | Path) -> Entries:
    """Return the content of a TOML file.

    Raises:
        OSError, UnicodeDecodeError, tomllib.TOMLDecodeError: as reading and parsing do; lists in lists without end are no TOML.
    """
    try:
        return tomllib.loads(regular(path).read_text(encoding="utf-8"))
    except RecursionError:
        raise tomllib.TOMLDecodeError("lists or tables stand in one another too deeply") from None
