"""A result as a workbook (XLSX): what it says in one sheet, every table in its own, and samples in the last."""

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
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table
from wirerope_mj.foundation.units import in_unit

if TYPE_CHECKING:
    import openpyxl

_ROWS, _COLUMNS = 1_048_576, 16_384  # of a sheet, by the format
_LONGEST = 31  # letters of a sheet's name
_WIDE = 16.0  # width of a column in letters: headings such as "static load [%]" are read without dragging it


def write_workbook(content: Content, samples: Exported | None, path: Path, *, force: bool = False) -> Path:
    """Write statements and tables of a content, values in the units that are shown, and samples in SI; return the path.

    RecordError if openpyxl is missing, the file is there and must not be replaced, or the samples are too many for a sheet.
    """
    try:
        from openpyxl import Workbook
    except ModuleNotFoundError:
        raise RecordError(f"{path}: XLSX needs openpyxl: pip install 'wirerope-mj[xlsx]', or write CSV.") from None
    check_writable(path, force=force)
    with place_named(path), _full_disk_told():
        _write(Workbook(write_only=True), content, samples, path)
    return path


@contextmanager
def _full_disk_told() -> Iterator[None]:
    """Raise what lxml, by which openpyxl writes its temporary files, says of a full disk as the operating system does."""
    # The writers of unfinished sheets would print tracebacks when they are cleared away.
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


def _write(book: "openpyxl.Workbook", content: Content, samples: Exported | None, path: Path) -> None:
    page = _sheet(book, "summary", 2)
    for said in _said(content):
        _append(page, said)
    for table in content.blocks():
        if isinstance(table, Table):
            page = _sheet(book, table.id or table.title, len(table.columns))
            _append(page, [table.title])
            _append(page, [" ".join(column.title().split()) for column in table.columns])
            for cells in table.rows:
                _append(page, [_value(*pair) for pair in zip(table.columns, cells, strict=True)])
            _append(page, [table.note])
    if samples is not None:
        page = _sheet(book, "samples", len(samples.names))
        _append(page, samples.headings)
        for number, row in enumerate(_rows(samples), start=2):
            if number > _ROWS or len(row) > _COLUMNS:
                raise RecordError(f"{path}: these samples are too many for a sheet: choose columns, or write CSV or HDF5.")
            _append(page, row)
    written = BytesIO()
    book.save(written)
    with atomic_file(path) as temporary:
        temporary.write_bytes(written.getvalue())


def _append(page: "openpyxl.worksheet.worksheet.Worksheet", values: Sequence[str | float | None]) -> None:
    """Append a row, every text typed as text: openpyxl makes formulas of what begins with =, and errors of #N/A."""
    from openpyxl.cell import WriteOnlyCell

    cells: list[Any] = list(values)
    for number, value in enumerate(values):
        if isinstance(value, str):
            cells[number] = cell = WriteOnlyCell(page, plain_lines(value))  # no XML holds control characters
            cell.data_type, cell.quotePrefix = "s", no_formula(value) != value  # the prefix keeps it text when it is edited
    page.append(cells)


def _sheet(book: "openpyxl.Workbook", name: str, columns: int) -> "openpyxl.worksheet.worksheet.Worksheet":
    """Begin a sheet whose columns are wide enough for their headings."""
    from openpyxl.utils import get_column_letter

    page = book.create_sheet(_sheet_name(name, book.sheetnames))
    for number in range(1, min(columns, _COLUMNS) + 1):
        page.column_dimensions[get_column_letter(number)].width = _WIDE
    return page


def _said(content: Content) -> Iterator[list[str]]:
    """Yield title, verdict, facts and what the sections say."""
    yield from ([content.title], [content.verdict.text], [], *(list(fact) for fact in content.facts))
    for section in content.sections:
        said = [block for block in section.blocks if isinstance(block, Statement)]
        yield from ([], [section.title]) if said else ()
        yield from ([text] for one in said for text in (one.text, *one.items) if text)


def _value(column: Column, cell: Cell) -> str | float | None:
    """Return a cell as a number in the unit of its column where it is one."""
    content = cell.content if isinstance(cell, Mark) else cell
    if isinstance(content, str) or content is None or not np.isfinite(content):
        return content if isinstance(content, str) else None
    return float(in_unit(content, column.unit))


def _rows(samples: Exported) -> Iterator[list[str | float | None]]:
    for block in samples.blocks():
        for row in zip(*(np.asarray(column).tolist() for column in block), strict=True):
            yield [None if isinstance(value, float) and not np.isfinite(value) else value for value in row]


def _sheet_name(name: str, taken: list[str]) -> str:
    """Return a name that a sheet may have and none has."""
    plain = re.sub(r"[\\/*?:\[\]]", " ", name)[:_LONGEST].strip() or "table"
    number, unique = 1, plain
    while unique.lower() in (one.lower() for one in taken):
        number += 1
        unique = f"{plain[: _LONGEST - 1 - len(str(number))]} {number}"
    return unique
