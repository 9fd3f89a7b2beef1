"""Files that are read: regular ones, inside their own folder; text in any encoding, and kinds of files that are no tables.

A pipe gives its content once, and a device never ends. What is no text is known by how it begins.
"""

import codecs
import errno
import re
from os.path import isfile  # as `Path.is_file`, but a name that is too long is none
from pathlib import Path

from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import quoted


def regular(path: str | Path) -> Path:
    """Return a path, links followed; OSError if it is neither a regular file nor a folder nor missing.

    Every reader calls this before it opens a file, and treats the error as any other that a file cannot be read.

    Raises:
        OSError: a pipe, a socket or a device is there; ENODEV, which `why_unread` explains.
    """
    path = Path(path)
    if path.exists() and not path.is_file() and not path.is_dir():
        raise OSError(errno.ENODEV, "not a regular file", str(path))
    return path


def is_inside(path: Path, folder: Path) -> bool:
    """Tell whether a path leads to something in a folder, links resolved; a name that no file can have does not."""
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError):
        return False


def file_inside(folder: Path, name: object, kind: str) -> Path:
    """Return the path of the file `name` of a run or a study.

    Raises:
        RecordError: it does not lie in the folder, or is not there.
    """
    if isinstance(name, str) and is_inside(folder / name, folder) and isfile(folder / name):
        return folder / name
    raise RecordError(
        f"{folder}: the {kind} {quoted(name)} is not in this folder, and nothing outside it is read. Take the file from "
        "another copy of the folder."
    )


_LOOKED_AT = 1 << 16  # bytes by which an encoding is known: more than any header has
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip
_EXPORT = "Export the channels as CSV, or as a MATLAB file (-v7)."
_SHEET = "Save the sheet as XLSX or CSV."
_FOREIGN: tuple[tuple[bytes, str, str], ...] = (
    (b"\xd0\xcf\x11\xe0", "a workbook of old Excel (.xls), or another Office file", _SHEET),
    (b"MDF  ", "an MDF (MF4) file of ASAM", _EXPORT),
    (b"|CF,", "a file of imc FAMOS", _EXPORT),
    (b"RIFF", "a RIFF file that is no WAV", _EXPORT),
    (b"\x93NUMPY", "an array of NumPy", "Write it with numpy.savetxt and a header, or as a MATLAB file."),
    *((b"CDF" + version, "a NetCDF file", _EXPORT) for version in (b"\x01", b"\x02", b"\x05")),
    (b"SQLite format 3", "a database of SQLite", _EXPORT),
    (b"%PDF", "a PDF document", "Export the table itself as CSV."),
    (b"\x89PNG", "a PNG picture", "Export the table itself as CSV."),
    (b"\xff\xd8\xff", "a JPEG picture", "Export the table itself as CSV."),
    (b"\x1f\x8b", "compressed by gzip", "Unpack it first."),
    (b"7z\xbc\xaf", "an archive of 7-Zip", "Unpack it first."),
    (b"Rar!", "a RAR archive", "Unpack it first."),
    (b"<?xml", "an XML file", "Export the table itself as CSV or XLSX."),
    (b"<!DOCTYPE", "an HTML page", "Export the table itself as CSV or XLSX."),
    (b"<table", "an HTML page, as some programs call .xls", _SHEET),
    (b"<html", "an HTML page, as some programs call .xls", _SHEET),
    (b'[{"', "a JSON file", "Export the table itself as CSV."),
    (b'{"', "a JSON file", "Export the table itself as CSV."),
    (b"ARROW1", "a Feather or Arrow file", "Write it as Parquet or CSV."),
    *(
        (b"\x80" + version, "a pickle of Python", "Write the table as Parquet or CSV.")
        for version in (b"\x03", b"\x04", b"\x05")
    ),
    (b"\x1aE\xdf\xa3", "an IDE file of enDAQ, or another in EBML", _EXPORT),
    (b"{\\rtf", "a document in RTF", "Save it as plain text."),
    (b"DIAEXTENDED", "the header of a DIAdem data set", _EXPORT),
)


def encoding_of(path: Path) -> str:
    """Find the encoding of a text by its byte order mark, its NUL bytes, or as valid UTF-8; else that of Windows.

    Raises:
        OSError: the file cannot be read.
    """
    with regular(path).open("rb") as file:
        head = file.read(_LOOKED_AT)
    for mark, encoding in _MARKS:
        if head.startswith(mark):
            return encoding
    for first, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        # text of western languages in UTF-16 has a NUL in every second byte, and none in the others
        if len(head) > 3 and head[first::2].count(0) > 0.9 * len(head[first::2]) and not head[1 - first :: 2].count(0):
            return encoding
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def read_text(path: Path) -> str:
    """Read a text in whatever encoding; raises as `encoding_of` does."""
    return path.read_text(encoding=encoding_of(path), errors="replace")


def foreign_kind(path: Path) -> str:
    """Describe a file that no reader of tables reads, and the remedy, in two sentences; "" for others.

    Raises:
        OSError: the file cannot be read.
    """
    with regular(path).open("rb") as file:
        head = file.read(400)
    bare = head.removeprefix(codecs.BOM_UTF8).lstrip()
    for begins, kind, remedy in _FOREIGN:
        marked = bare[: len(begins)].lower() == begins.lower() if begins.startswith(b"<") else bare.startswith(begins)
        if marked:
            return f"this is {kind}, which is not read. {remedy}"
    if bare.startswith(b"PK\x03\x04") and b"opendocument" in head:
        return f"this is a sheet of OpenDocument, which is not read. {_SHEET}"
    if re.match(rb"-1\s*[\r\n]+\s*\d+\s*[\r\n]", bare):
        return "this is a universal file (UFF), which is read as a record or a test alone. Export the columns as CSV."
    return ""
