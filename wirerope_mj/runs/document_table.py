"""The table `[document]` of a job, read and written; and the check of what tables of a job hold."""

from dataclasses import asdict, fields
from datetime import date
from difflib import get_close_matches
from pathlib import Path

from wirerope_mj.content.document import TEXTS, Document, Revision
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.plain_text import quoted, short
from wirerope_mj.foundation.regular_files import regular

_LINES = tuple(one.name for one in fields(Document) if one.name not in ("logo", "history", "texts"))
_PICTURES = {b"\x89PNG\r\n\x1a\n": ".png", b"\xff\xd8\xff": ".jpg"}
_SAID = {
    str: "a text", float: "a number", bool: "true or false", list: "a text or a list of texts", dict: "a table",
    date: "a date or a text",
}  # fmt: skip


def checked(table: Entries, known: Entries, where: str) -> None:
    """Raise ModelError unless a table has known keys with values of their kinds; a list is one of texts, or of tables."""
    for key, value in table.items():
        if key not in known:
            near = get_close_matches(key, known, n=1)
            meant = f" Did you mean `{near[0]}`?" if near else ""
            raise ModelError(f"{where}: `{short(key)}` is unknown; known: {', '.join(known)}.{meant}")
        kind = known[key]
        right = {
            float: isinstance(value, int | float) and not isinstance(value, bool),
            list: isinstance(value, str) or (isinstance(value, list) and all(isinstance(one, str | dict) for one in value)),
            date: isinstance(value, str | date),
        }.get(kind, isinstance(value, kind))
        if not right:
            raise ModelError(f"{where}: `{key}` must be {_SAID[kind]}, got {quoted(value)}.")


def read_document(table: Entries, path: Path) -> Document:
    """Read the data of a document; a logo lies relative to the file at `path`.

    ModelError if a key is unknown or of another kind, or the logo is no PNG or JPEG; names it.
    """
    where = f"{path}, [document]"
    kinds = dict.fromkeys(_LINES, str) | {"date": date}
    checked(table, kinds | {"logo": str, "history": list, "text": dict}, where)
    checked(table.get("text", {}), dict.fromkeys(TEXTS, str), f"{where}, text")
    revisions = []
    for number, row in enumerate(table.get("history", []), start=1):
        if not isinstance(row, dict):
            raise ModelError(f"{where}: `history` must be tables [[document.history]], got {quoted(row)}.")
        known = {one.name: date if one.name == "date" else str for one in fields(Revision)}
        checked(row, known, f"{where}, history {number}")
        if "revision" not in row:
            raise ModelError(f"{where}, history {number}: `revision` is missing.")
        revisions.append(Revision(**{name: str(value) for name, value in row.items()}))
    logo = path.parent / table["logo"] if "logo" in table else None
    if logo is not None:
        logo_ending(logo, where)
    lines = {name: str(table[name]) for name in _LINES if name in table}
    return Document(**lines, logo=logo, history=tuple(revisions), texts=dict(table.get("text", {})))


def logo_ending(logo: Path, where: str) -> str:
    """Return ".png" or ".jpg" by what a picture's file begins with; ModelError if it is neither."""
    try:
        with regular(logo).open("rb") as file:
            begins = file.read(8)
    except OSError:
        raise ModelError(f"{where}: there is no file {str(logo)!r} for `logo`.") from None
    ending = next((ending for mark, ending in _PICTURES.items() if begins.startswith(mark)), "")
    if not ending:
        raise ModelError(f"{where}: `logo` must be a PNG or JPEG file, and {logo} is neither.")
    return ending


def document_table(document: Document, logo: str) -> Entries:
    """Return the table of a document as `read_document` reads it; `logo` is the name of the logo's copy."""
    table: Entries = {name: getattr(document, name) for name in _LINES if getattr(document, name)}
    table |= {"logo": logo} if logo else {}
    table |= {"history": [asdict(one) for one in document.history]} if document.history else {}
    return table | ({"text": dict(document.texts)} if document.texts else {})
