"""Text that others wrote, made safe to display: a name in a model or a file is data, on a terminal and in Markdown too."""

import re
from unicodedata import category

# Characters to which Markdown gives a meaning; an underscore inside a word has none.
_SPECIAL = re.compile(r"[\\`*\[\]<>|&#~$!]|(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])")
# Signs with which a formula of a spreadsheet begins.
_FORMULA = ("=", "+", "-", "@", "\t", "\r")
# Beginning of a line that is an item of a list, or makes a heading of the line above.
_LIST = re.compile(r"^(\s*\d*)([-+=.)])(?=[\s=-]|$)")


def plain(text: str) -> str:
    r"""Return text on one line, its invisible characters spelled out: `\x1b` for an escape, `\n` for a line break."""
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() or c == "\t" or category(c) == "Zs" else c.encode("unicode_escape").decode("ascii") for c in text
    )


def short(text: str, most: int = 200) -> str:
    """Cut text longer than `most` characters for a message; it then ends with three points."""
    return text if len(text) <= most else f"{text[:most]}..."


def quoted(value: object, most: int = 200) -> str:
    """Quote a value of any kind and size in a message: its own text may fail, or never end."""
    try:
        return short(repr(value), most)
    except Exception:
        return f"a value of type {type(value).__name__}"


def no_formula(text: str) -> str:
    """Put an apostrophe before a text that a spreadsheet would compute when it opens a CSV file; -1.5 stays a number."""
    try:
        float(text)
    except ValueError:
        return f"'{text}" if text.startswith(_FORMULA) else text
    return text


def as_named(cell: str) -> str:
    """Remove the apostrophe that `no_formula` put before the text of a cell."""
    return cell[1:] if cell.startswith("'") and cell[1:].startswith(_FORMULA) else cell


def plain_lines(text: str) -> str:
    """Return text with its invisible characters spelled out, but its line breaks kept."""
    return "\n".join(plain(line) for line in text.split("\n"))


def markdown(text: str) -> str:
    """Return Markdown that shows `text` as it is, on one line: no link, picture, table, formula or HTML comes out of it."""
    escaped = _SPECIAL.sub(lambda match: f"\\{match[0]}", plain(text).strip())
    return _LIST.sub(r"\1\\\2", escaped)


def markdown_lines(text: str) -> str:
    """Return Markdown that shows `text` as it is, its lines and paragraphs kept."""
    return "\n".join(markdown(line) for line in text.split("\n"))
