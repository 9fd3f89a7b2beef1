"""Rows of a sheet of an XLSX file, as texts; openpyxl is imported where it is used."""

import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from wirerope_mj.foundation.budget import require_memory
from wirerope_mj.foundation.errors import BudgetError, RecordError, why_unread
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.table_header import SHEET_ERROR

# bytes of memory for one of a sheet's XML: a cell of five bytes becomes a text and its place in a list
_UNPACKED = 20.0


def xlsx_rows(path: Path, sheet: str = "") -> tuple[str, list[tuple[int, list[str]]]]:
    """Read a sheet: its name, and number and texts of its rows, without empty ones and those that begin with #.

    Args:
        path: of the XLSX file.
        sheet: name of the sheet, in small letters; the first where none has it.

    Raises:
        RecordError: openpyxl is not installed, or the file is none that it reads.
        BudgetError: unpacked, it is too large for the memory.
    """
    title, values = _values(path, sheet)
    if any(None in row for row in values) and _has_formulas(path):
        _, formulas = _values(path, sheet, formulas=True)  # in place of values that are not stored
        values = [[w if v is None else v for v, w in zip(*rows, strict=True)] for rows in zip(values, formulas, strict=True)]
    texts = (
        (number, ["" if v is None else repr(v) if isinstance(v, float) else str(v).strip() for v in row])
        for number, row in enumerate(values, start=1)
        if set(row) - {None}
    )
    return title, [
        (number, row) for number, row in texts if any(row) and (not row[0].startswith("#") or SHEET_ERROR.match(row[0]))
    ]


def _values(path: Path, sheet: str, *, formulas: bool = False) -> tuple[str, list[Sequence[Any]]]:
    """Read the name of a sheet and its cells, row by row: formulas by value, or as they are written."""
    with _workbook(path, formulas=formulas) as book:
        sheets = book.worksheets
        chosen = next((candidate for candidate in sheets if candidate.title.strip().lower() == sheet), sheets[0])
        chosen.reset_dimensions()  # those of the file would fill all rows up to its farthest cell
        return str(chosen.title), list(chosen.iter_rows(values_only=True))


def _has_formulas(path: Path) -> bool:
    with zipfile.ZipFile(path) as parts:
        return any(b"<f" in parts.read(name) for name in parts.namelist() if name.startswith("xl/worksheets/"))


def is_workbook(path: Path) -> bool:
    with regular(path).open("rb") as file:
        return file.read(4) == b"PK\x03\x04" or path.suffix.lower() in (".xlsx", ".xlsm")


def sheet_names(path: Path) -> list[str]:
    """Read the names of a workbook's sheets, in small letters; raises as `xlsx_rows` does."""
    with _workbook(path) as book:
        return [sheet.title.strip().lower() for sheet in book.worksheets]


@contextmanager
def _workbook(path: Path, *, formulas: bool = False) -> Iterator[Any]:
    """Open a workbook by openpyxl for the block; RecordError if it cannot be read, BudgetError if it is too large."""
    try:
        import openpyxl
    except ModuleNotFoundError:
        raise RecordError(
            f"{path}: XLSX files are read by openpyxl, which is not installed: pip install 'wirerope-mj[xlsx]', "
            "or save the sheet as CSV."
        ) from None
    try:
        with regular(path).open("rb") as file:
            with zipfile.ZipFile(file) as parts:
                size = sum(part.file_size for part in parts.infolist())
            require_memory(f"{path}, unpacked,", _UNPACKED * size, "Save the sheet as CSV.")
            yield openpyxl.load_workbook(file, read_only=True, data_only=not formulas)
    except BudgetError:
        raise
    except OSError as error:
        raise RecordError(f"{path}: the table cannot be read: {why_unread(error)}") from None
    except Exception:  # openpyxl raises what its parsers of zip and XML raise
        raise RecordError(f"{path}: this is no XLSX file that can be read. Save it again, or as CSV.") from None
