"""A result as a workbook (XLSX): statements in the first sheet, every table in its own, and samples in the last."""

import errno
import gc
import re
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wirerope_mj.content.blocks import Content, Statement
from wirerope_mj.foundation.atomic_files import atomic_file, check_writable, place_named
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.exports import Exported
from wirerope_mj.foundation.plain_text import no_formula, plain_lines
from wirerope_mj.foundation.tables import Mark, Table
from wirerope_mj.foundation.units import in_unit

if TYPE_CHECKING:
    import openpyxl

_ROWS, _COLUMNS = 1_048_576, 16_384  # of a sheet, by the format
_LONGEST = 31  # letters of a sheet's name
_COLUMN_WIDTH = 16.0  # width of a column in letters, enough for headings


def write_workbook(content: Content, samples: Exported | None, path: Path, *, force: bool = False) -> Path:
    """Write statements and tables of a content, values in the units that are shown, and samples in SI; return the path.

    RecordError if openpyxl is missing, the file is there and must not be replaced, or the samples are too many for a sheet.
    """
    try:
        from openpyxl import Workbook
    except ModuleNotFoundError:
        raise RecordError(f"{path}: XLSX needs openpyxl: pip install 'wirerope-mj[xlsx]', or write CSV.") from None
    check_writable(path, force=force)
    with place_named(path), _full_disk_raised():
        _write_sheets(Workbook(write_only=True), content, samples, path)
    return path


@contextmanager
def _full_disk_raised() -> Iterator[None]:
    """Raise OSError for a full disk, without the tracebacks that writers of unfinished sheets print at their end."""
    hook, number = sys.unraisablehook, 0
    try:
        yield
    except Exception as error:
        if str(error) not in ("IO_ENOSPC", "IO_EDQUOT", "IO_EFBIG", "IO_EIO"):
            raise
        number, sys.unraisablehook = getattr(errno, str(error)[3:]), lambda _: None
        traceback.clear_frames(error.__traceback__)
    if number:
        gc.collect()
        sys.unraisablehook = hook
        raise OSError(number, "")


def _write_sheets(book: "openpyxl.Workbook", content: Content, samples: Exported | None, path: Path) -> None:
    """Write a sheet of statements, a sheet of each table, and a sheet of samples."""
    page = _sheet(book, "summary", 2)
    for line in ([content.title], [content.verdict.text], [], *content.facts):
        _append(page, line)
    for section in content.sections:
        statements = [block for block in section.blocks if isinstance(block, Statement)]
        texts = [text for statement in statements for text in (statement.text, *statement.items) if text]
        for line in ([], [section.title], *([text] for text in texts)) if statements else ():
            _append(page, line)
    for table in content.blocks():
        if isinstance(table, Table):
            page = _sheet(book, table.id or table.title, len(table.columns))
            _append(page, [table.title])
            _append(page, [" ".join(column.title().split()) for column in table.columns])
            for cells in table.rows:
                values: list[str | float | None] = []
                for column, cell in zip(table.columns, cells, strict=True):
                    value = cell.content if isinstance(cell, Mark) else cell
                    if isinstance(value, float | int):
                        value = float(in_unit(value, column.unit)) if np.isfinite(value) else None
                    values.append(value)
                _append(page, values)
            _append(page, [table.note])
    if samples is not None:
        page = _sheet(book, "samples", len(samples.names))
        _append(page, samples.headings)
        rows = (row for block in samples.blocks() for row in zip(*(np.asarray(part).tolist() for part in block), strict=True))
        for number, row in enumerate(rows, start=2):
            if number > _ROWS or len(row) > _COLUMNS:
                raise RecordError(f"{path}: these samples are too many for a sheet: choose columns, or write CSV or HDF5.")
            _append(page, [None if isinstance(value, float) and not np.isfinite(value) else value for value in row])
    written = BytesIO()
    book.save(written)
    with atomic_file(path) as temporary:
        temporary.write_bytes(written.getvalue())


def _append(page: "openpyxl.worksheet.worksheet.Worksheet", values: Sequence[str | float | None]) -> None:
    from openpyxl.cell import WriteOnlyCell

    cells: list[Any] = list(values)
    for number, value in enumerate(values):
        if isinstance(value, str):
            cells[number] = cell = WriteOnlyCell(page, plain_lines(value))  # no XML holds control characters
            cell.data_type, cell.quotePrefix = "s", no_formula(value) != value  # the prefix keeps it text when it is edited
    page.append(cells)


def _sheet(book: "openpyxl.Workbook", name: str, columns: int) -> "openpyxl.worksheet.worksheet.Worksheet":
    """Create a sheet under a name that is allowed and unique."""
    from openpyxl.utils import get_column_letter

    plain = re.sub(r"[\\/*?:\[\]]", " ", name)[:_LONGEST].strip() or "table"
    number, unique, taken = 1, plain, [title.lower() for title in book.sheetnames]
    while unique.lower() in taken:
        number += 1
        unique = f"{plain[: _LONGEST - 1 - len(str(number))]} {number}"
    page = book.create_sheet(unique)
    for number in range(1, min(columns, _COLUMNS) + 1):
        page.column_dimensions[get_column_letter(number)].width = _COLUMN_WIDTH
    return page
