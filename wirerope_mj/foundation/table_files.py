"""Tables as other programs write them, in any container: header with units, rows, numbers, and the location of faults.

Text with any usual separator, decimal sign and encoding, sheets of workbooks, MATLAB and Parquet files, and the text files of
some loggers are read by what they hold, not by the ending of their names.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TextIO

import numpy as np

from wirerope_mj.foundation.array_files import columns_of_array_file
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.logger_files import columns_as_stated, columns_of_logger
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.regular_files import encoding_of, foreign_kind, regular
from wirerope_mj.foundation.table_header import (
    DELIMITERS,
    SHEET_ERROR,
    Header,
    Rows,
    find_header,
    is_missing,
    is_number,
    split_cells,
)
from wirerope_mj.foundation.units import in_si, split_unit
from wirerope_mj.foundation.xlsx_rows import is_workbook, sheet_names, xlsx_rows

# Largest number that a file may hold, in its own units: beyond all that was ever measured, or any clock counts, in any known
# unit, and integrals of what is left are finite.
LARGEST = 1e15
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")  # characters that no text holds, but for tabs and what ends a line or a page
_DECIMAL = re.compile(r"[-+]?\d*([.,])\d+(?:[eE][-+]?\d+)?")
_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:([ ',.\u00a0\u202f])\d{3})+(?:[.,]\d+)?")
_ABOVE = 130  # lines in which a header and the first numbers stand below what a rig or a logger says of itself
_LOOKED_AT = 300  # rows by which the decimal sign is known
Stated = tuple[str | None, float | None]  # columns and interval [s] of a text without a header
COMMENTS = ("#", "%", "//")
_OPENS_CELL = re.compile(r'(?:^|[,;\t|])\s*"')  # a quotation mark elsewhere may be an inch


def read_header(
    path: Path, *, kind: str, example: str, sheet: str = "", columns: Collection[str] = (), stated: Stated | None = None
) -> Header:
    """Read the header of a table in any file format.

    It is the first row with two units, or that above a row of units, or the last one above as many numbers, else the first that
    is no comment (#, %); what a rig or a logger says of itself may stand above it. Where numbers begin at once it may be the
    last comment. Units stand as `split_unit` splits them. Of a workbook the `sheet` is read, in small letters, the first where
    none is called so, and of a file of arrays the columns that are as long as the `columns` that are asked for.

    A text of numbers alone has the columns and the interval that are `stated`, as `columns_as_stated` takes them.

    Messages say what the file should be, `kind`, as "cyclic test", and show an `example` of its header.

    Raises:
        RecordError: the file cannot be read, is empty or no table.
    """
    wanted = f"A {kind} is a table with a header such as {example}."
    try:
        if not regular(path).exists():
            raise RecordError(f"{path}: no such file. {wanted}")
        if stated is not None:
            return _checked(columns_as_stated(path, *stated))
        if header := columns_of_array_file(path, columns):
            return _checked(header)
        if foreign := foreign_kind(path):
            raise RecordError(f"{path}: {foreign}")
        if is_workbook(path):
            titles = sheet_names(path)
            chosen = [sheet] if sheet in titles else titles  # a cover may stand before the sheet that is meant
            for order in (chosen, chosen[:1]):
                for name in order:
                    title, filled = xlsx_rows(path, name)
                    header = find_header(path, filled[:_ABOVE])
                    if header is not None and header.surety > 0:
                        break
                else:
                    continue
                break
            if not filled:
                raise RecordError(f"{path}: the sheet {short(plain(title))} is empty. {wanted}")
            if header is None:
                raise _without_header(f"{path}, sheet {short(plain(title))}, row {filled[0][0]}", wanted)
            below = [row for row in filled if row[0] > header.last]
            header = replace(header, sheet=title, content=below)
            return _checked(replace(header, decimal=_decimal_sign(header, (cells for _, cells in below[:_LOOKED_AT]))))
        header = columns_of_logger(path)
        return _text_header(path, wanted) if header is None else _checked(header)
    except OSError as error:
        raise RecordError(f"{path}: the {kind} cannot be read: {why_unread(error)}") from None


def _text_header(path: Path, wanted: str) -> Header:
    """Find header, encoding, separator and decimal sign of a text; RecordError says that a table as `wanted` was expected."""
    encoding = encoding_of(path)
    with path.open(encoding=encoding, errors="replace") as file:
        lines, comments = _first_lines(path, file)
    if not lines:
        raise RecordError(
            f"{path}: the file is empty. Expected {wanted.partition('with ')[2].rstrip('.')} and rows of numbers."
        )
    tried: list[tuple[int, int, str, Header]] = []
    for order, delimiter in enumerate(DELIMITERS):
        if delimiter == " " and tried and max(tried)[0] > 0:
            break  # spaces stand within names and beside other separators
        rows = [(number, split_cells(text, delimiter)) for number, text in lines]
        if header := find_header(path, rows) or _header_in_comments(path, comments, rows):
            several = len(header.names) > 1 or (header.surety > 0 and delimiter == ",")
            tried.append((header.surety if several else -1, -order, delimiter, header))
    surety, _, delimiter, header = max(tried, default=(-1, 0, "", Header(path, 0, (), ())))
    if not tried or (surety < 1 and is_number(lines[0][1].split()[0])):  # numbers with spaces between them
        raise _without_header(f"{path}, line {lines[0][0]}", wanted)
    if surety < 1:  # nothing tells: the first separator that the line has
        text = next(text for number, text in lines if number == header.line)
        delimiter = next((sign for sign in (*DELIMITERS,)[:4] if sign in text), ",")
        headers = [candidate for _, _, sign, candidate in tried if sign == delimiter]
        if not headers:  # a file of numbers alone
            raise _without_header(f"{path}, line {lines[0][0]}", wanted)
        header = headers[0]
    header = replace(header, delimiter=delimiter, encoding=encoding)
    with open_rows(header) as file:
        rows_of_cells = (header.cells(text) for _, text in zip(range(_LOOKED_AT), file, strict=False))
        return _checked(replace(header, decimal=_decimal_sign(header, rows_of_cells)))


def _first_lines(path: Path, file: TextIO) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return the first lines and the comments of a file, numbered; a quoted cell may continue on the next line."""
    lines: list[tuple[int, str]] = []
    comments: list[tuple[int, str]] = []
    whole = ""
    for number, text in enumerate(file, start=1):
        whole += text if not whole else f" {text}"
        if whole.count('"') % 2 and _OPENS_CELL.search(whole) and whole.count('"') < 200 and number < _ABOVE:
            whole = whole.rstrip("\r\n")
            continue
        line, whole = whole.strip("\r\n"), ""
        if is_comment(line):
            comments.append((number, line.lstrip(' \t"#%/')))
        elif line.strip(' \t;,|"'):
            if _CONTROL.search(line):
                raise RecordError(
                    f"{path}, line {number}: control characters{' (NUL)' if chr(0) in line else ''} stand where a table has "
                    "text, as in a binary file, one that was cut off, or text in UTF-16 without its mark. Export it as CSV "
                    "from the program that wrote it, or save the text in UTF-8."
                )
            if set(line) - set('-=_+ \t;,|"'):  # else a line that is drawn
                lines.append((number, line))
        if len(lines) > _ABOVE:
            break
    return lines, comments


def _header_in_comments(path: Path, comments: Sequence[tuple[int, str]], rows: Rows) -> Header | None:
    """Find a header in the last comment with as many cells as the numbers below it, at any separator."""
    width = len(rows[0][1])
    for number, text in reversed([comment for comment in comments if comment[0] < rows[0][0]]):
        for delimiter in DELIMITERS:
            cells = split_cells(text, delimiter)
            if len(cells) == width and (width > 1 or split_unit(cells[0])[1]) and not any(map(is_number, cells)):
                names, units = zip(*map(split_unit, cells), strict=True)
                return Header(path, number, names, units, last=number, surety=1)
    return None


def _without_header(location: str, wanted: str) -> RecordError:
    """Return the error for a file that begins with numbers, with the remedy."""
    remedy = "Write that line above the numbers"
    if wanted.startswith("A record"):  # that is played
        remedy += ', or say it by columns="time [s], z [g]" (--columns), or without a time interval=0.005 [s] (--interval)'
    return RecordError(f"{location}: numbers begin here and no header stands above them. {wanted} {remedy}.")


def _checked(header: Header) -> Header:
    """Name the columns that have no name by their number, or by their letter in a workbook."""
    unnamed = frozenset(i for i, name in enumerate(header.names) if not name)
    names = list(header.names)
    for column in unnamed:
        names[column], letters, number = f"column {column + 1}", "", column + 1
        while header.sheet and number:
            number, rest = divmod(number - 1, 26)
            letters = chr(ord("A") + rest) + letters
            names[column] = f"column {letters}"
    return replace(header, names=tuple(names), unnamed=unnamed)


def find_column(header: Header, name: str, *, without: int | None = None) -> int:
    """Return the index of a column by its name, the column `without` left out; RecordError lists the columns if none matches.

    A name may be that of the column, that with its unit as the file has it, "column 3", the field of a struct by its own name,
    or of several columns of one name the second as `name#2`.
    """
    columns = {i: column for i, column in enumerate(header.names) if i != without}
    bare, unit = split_unit(name)
    first, _, number = name.rpartition("#")
    alike = [i for i, column in columns.items() if column == first]
    position = re.fullmatch(r"column (\d+)", name)
    ways = (
        [i for i, column in columns.items() if column == name],
        [i for i, column in columns.items() if unit is not None and (column, header.units[i]) == (bare, unit)],
        [i for i, column in columns.items() if not header.line and column.rpartition(".")[2] == name],
        alike[int(number) - 1 : int(number)] if number.isdigit() and int(number) else [],
        [int(position[1]) - 1] if position and int(position[1]) - 1 in columns else [],
    )
    places = next((matches for matches in ways if matches), [])
    if len(places) == 1:
        return places[0]
    fault, remedy = f'there is no column "{short(plain(name))}"', ""
    if places:
        fault, remedy = f'there are {len(places)} columns "{short(plain(name))}"', f' Say which: "{name}#1" or "{name}#2".'
    raise RecordError(f"{header.location}: {fault}; the columns are {short(plain(', '.join(columns.values())))}.{remedy}")


def _decimal_sign(header: Header, rows: Iterable[Sequence[str]]) -> str:
    """Find the decimal sign of the first decimal number below a header; RecordError where commas may separate thousands."""
    sign, commas, whole = "", [], 0
    for cells in rows:
        for cell in cells:
            match = _DECIMAL.fullmatch(cell)
            sign = sign or (match[1] if match else "")
            if match and match[1] == ",":
                commas.append(cell.lstrip("+-"))
            whole += bool(re.fullmatch(r"[-+]?[1-9]\d{1,2}", cell))
    if sign == "," and whole and all(re.fullmatch(r"[1-9]\d{0,2},\d{3}", cell) for cell in commas):
        raise RecordError(
            f'{header.location}: the numbers below, such as "{commas[0]}", have a comma that may separate thousands or '
            "decimals. Write them without separators of thousands, and with a decimal point."
        )
    return sign or "."


def is_comment(text: str) -> bool:
    text = text.lstrip(' \t"')
    return text.startswith(COMMENTS) and not SHEET_ERROR.match(text)


def open_rows(header: Header) -> TextIO:
    """Open a text at the first row below its header."""
    file = header.path.open(encoding=header.encoding, errors="replace")
    for _ in range(header.last):
        file.readline()
    return file


def rows_below(header: Header) -> Iterator[tuple[int, str, list[str]]]:
    """Yield line number, location for messages, and cells of every row; empty rows and comments are skipped."""
    for line, cells in numbered_rows(header):
        location = header.at(line)
        require_cells(header, location, cells)
        if any("[" in cell or "(" in cell for cell in cells) and sum(split_unit(cell)[1] is not None for cell in cells) > 1:
            raise RecordError(
                f'{location}: "{short(plain(header.delimiter.join(cells)))}" looks like a second header after that in '
                f"{'row' if header.sheet else 'line'} {header.line}. "
                "A file has one header and one unit for each quantity: convert the rows, or use two files."
            )
        yield line, location, [with_point(header, location, cell) for cell in cells]


def numbered_rows(header: Header) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of every row below a header as they stand; empty rows and comments are skipped."""
    width, content = len(header.names), header.content
    if isinstance(content, np.ndarray):
        yield from ((number, ["" if v != v else repr(v) for v in row]) for number, row in enumerate(content.tolist(), 1))
    elif content is not None:
        for number, cells in content:
            yield number, [*cells[:width], *[""] * (width - len(cells)), *(cell for cell in cells[width:] if cell)]
    else:
        with open_rows(header) as file:
            for number, text in enumerate(file, start=header.last + 1):
                if not is_comment(text) and any(cells := header.cells(text)):
                    yield number, cells


def rows_in_si(header: Header, units: Mapping[int, Mapping[str, float]]) -> list[tuple[float, ...]]:
    """Read some columns below a header in SI; `units`: the units that each may have."""
    factors = {column: header.factor(column, known) for column, known in units.items()}
    return [
        tuple(in_si(number_in(place, header.names[column], cells[column]), factor) for column, factor in factors.items())
        for _, place, cells in rows_below(header)
    ]


def with_point(header: Header, location: str, cell: str) -> str:
    """Return a cell with a decimal point in its number; RecordError if its decimal sign is not the file's."""
    match = _DECIMAL.fullmatch(cell) if header.decimal == "," else None
    if match is None:
        return cell
    if match[1] == ".":
        raise RecordError(
            f'{location}: "{short(cell)}" has a point and numbers above it have decimal commas. Write all with the same sign.'
        )
    return cell.replace(",", ".")


def require_cells(header: Header, location: str, cells: Sequence[str]) -> None:
    """Raise RecordError unless a row has as many cells as the header has columns."""
    count, columns = len(cells), len(header.names)
    if count == columns:
        return
    message = f"{location}: {count} cells where the header has {columns} columns."
    if count > columns and header.delimiter == ",":
        message += " Decimals are written with a point: here every comma separates two cells."
    elif count == 1 and (used := next((sign for sign in ";\t," if sign in cells[0]), None)):
        message += (
            f" The header's cells are separated by {DELIMITERS[header.delimiter]}, those of this row by {DELIMITERS[used]}."
        )
    raise RecordError(message)


def parse_number(cell: str) -> float:
    """Parse the number in a cell; ValueError also for 1_000 and digits of other scripts, which Python accepts."""
    if "_" in cell or not cell.isascii():
        raise ValueError(cell)
    return float(cell)


def number_in(location: str, name: str, cell: str) -> float:
    """Return the finite number in a cell of the column `name`; RecordError if it is none."""
    try:
        value = parse_number(cell)
    except ValueError:
        hint = ""
        if is_missing(cell):
            hint = " Its value is missing."
        elif cell.startswith("="):
            hint = " The value of this formula is not stored: open the workbook in a spreadsheet program and save it."
        elif _THOUSANDS.fullmatch(cell):
            hint = " Write thousands without a separator."
        elif re.fullmatch(r"[-+.,\deE]+\s*[a-zA-Zµ²/^]+2?", cell):
            hint = " Units stand in the header only, one for each column."
        elif "," in cell:
            hint = " Decimals are written with a point, or all with a comma where semicolons or tabs separate the cells."
        raise RecordError(f'{location}: "{short(cell)}" in column "{short(name)}" is not a number.{hint}') from None
    if not abs(value) <= LARGEST:
        raise RecordError(
            f'{location}: {cell} in column "{name}" is no measured value; cut or repair the file before it is used.'
        )
    return value
