"""The header of a table among the rows that other programs write: names and units by position, in one row or in several."""

import csv
import datetime
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.units import find_unit, is_unit, split_unit, underscored_unit

Rows = Sequence[tuple[int, list[str]]]  # number of each row, counted from 1, and its cells
DELIMITERS = {"\t": "tabs", ";": "semicolons", ",": "commas", "|": "bars", " ": "spaces"}
# what stands in a cell whose value is missing, in small letters
MISSING = frozenset((
    "nan", "+nan", "-nan", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind", "na", "n/a", "null", "none", "nil", "missing",
    "-", "--", "---", "#n/a", "#na", "#div/0!", "#value!", "#num!", "#ref!", "#name?", "#null!",
))  # fmt: skip
# an error of a spreadsheet where a row begins, which is no comment
SHEET_ERROR = re.compile(
    rf"(?:{'|'.join(re.escape(text) for text in MISSING if text.startswith('#'))})(?=[\s\",;|]|$)", re.IGNORECASE
)
# what a column of time is called, behind the names of structs or groups that hold it
TIME_COLUMN = re.compile(
    r"(?:.*\.)?(?:(?:elapsed|relative|absolute|record|sample|test)[ _])?"
    r"(?:time|t|x_?value|zeit|temps|tiempo|tempo|(?:date|datum)[ _/-]?(?:time|zeit)|time[ _]?(?:stamp|axis))"
    r"(?:_(?:s|sec|ms|us|min|h))?",
    re.IGNORECASE,
)
_CLOCK = re.compile(
    r"(?:(?P<first>\d{1,4})(?P<sign>[-./])(?P<second>\d{1,2}|[A-Za-z]{3})(?P=sign)(?P<third>\d{2,4})[T ,]+)?"
    r"(?:(?P<days>\d+) days?, )?(?P<hour>\d{1,2}):(?P<minute>\d{2})"
    r"(?::(?P<whole>\d{2})(?:[.,](?P<parts>\d{1,9})|:(?P<ms>\d{3}))?)?"
    r"\s*(?P<half>[AaPp]\.?[Mm]\.?)?(?:Z|\s*UTC|[+-]\d{2}:?\d{2})?"
)
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_LONGEST_UNIT = 16  # characters: a cell that is longer says something else than a unit


@dataclass(frozen=True, eq=False)
class Header:
    """The rows of a table that name its columns."""

    path: Path  # of the file
    line: int  # number of the row with the names, counted from 1; 0 where the file has no rows
    names: tuple[str, ...]  # of the columns, units taken off; one without a name is called "column 3", in a workbook "column C"
    units: tuple[str | None, ...]  # of the columns; None where the header has none
    delimiter: str = ""  # between the cells of a text
    decimal: str = "."  # or a comma, where other signs separate the cells, or quotation marks stand around them
    sheet: str = ""  # of a workbook
    encoding: str = "utf-8"  # of a text
    last: int = 0  # number of the last row of the header, where units or other names stand below the first
    unnamed: frozenset[int] = frozenset()  # columns without a name
    left_out: tuple[str, ...] = ()  # columns of a file of arrays that are of another length, or hold no numbers
    # how sure it is, where it was found among rows: 3 with two units at least, 2 above a row of units, 1 with as many names as
    # there are numbers below, 0 as the first row
    surety: int = 0
    # rows below the header of a workbook; numbers of all columns of another file, (n, n_columns); None of a text
    content: Rows | Array | None = field(default=None, repr=False)

    @property
    def location(self) -> str:
        return self.at(self.line)

    def at(self, row: int) -> str:
        """Name a row of the file as messages do: file, sheet and line."""
        if self.sheet:
            return f"{self.path}, sheet {short(plain(self.sheet))}, row {row}"
        return f"{self.path}, line {row}" if row else str(self.path)

    def listed(self, first: int = 0, *, units: bool = False) -> str:
        """List the columns' names from number `first` on, as messages do."""
        written = [f"{name} [{unit}]" if units and unit else name for name, unit in zip(self.names, self.units, strict=True)]
        return short(plain(", ".join(written[first:])))

    def factor(self, column: int, known: Mapping[str, float]) -> float:
        """Return the value of the column's unit in SI; RecordError if it has none, or one that is not known."""
        return known[self.known_unit(column, known)]

    def known_unit(self, column: int, known: Mapping[str, float], *, option: str = "") -> str:
        """Return the unit of a column as `known` spells it, also that behind the last underscore of its name.

        Messages name the `option` that says the unit in place of the file.

        RecordError: it has none, or one that is not known.
        """
        name, unit = short(plain(self.names[column])), self.units[column]
        if unit is None:
            if known_name := underscored_unit(self.names[column], known)[1]:
                return known_name
            first = next(iter(known))
            underscored = f"{name}_{re.sub('[^A-Za-z0-9]', '', first.replace('/', 'p'))}"
            example = (
                f'"{name} [{first}]"' if self.line else f'"{underscored}" or, where it may hold brackets, "{name} [{first}]"'
            )
            raise RecordError(
                f'{self.location}: column "{name}" has no unit. {f"Say it with {option}, or write" if option else "Write"} it '
                f"behind the name, for instance {example}; known units: {', '.join(known)}."
            )
        if known_name := find_unit(unit, known):
            return known_name
        raise RecordError(
            f'{self.location}: column "{name}" has the unknown unit "{short(plain(unit))}". Known units: {", ".join(known)}.'
        )

    def cells(self, text: str) -> list[str]:
        """Return the cells of a line, without empty ones beyond the last column."""
        cells = split_cells(text, self.delimiter)
        while len(cells) > len(self.names) and not cells[-1]:
            cells.pop()
        return cells


def holds(group: str, name: str) -> bool:
    """Tell whether a struct or group ("" is the whole file) holds a column, such as test.acc, itself or in a nested one."""
    return not group or name.startswith(f"{group}.")


def split_cells(text: str, delimiter: str) -> list[str]:
    """Split a line at a delimiter, " " being any run of spaces; quotation marks hold a cell together and are taken off."""
    if delimiter == " ":
        parts: list[str] = []
        for part in re.findall(r'"[^"]*"|\S+', text):
            if parts and re.fullmatch(r"\[.*\]|\(.*\)", part):
                parts[-1] += f" {part}"  # a unit belongs to the name before it
            else:
                parts.append(part)
        return [part.strip('"') for part in parts]
    if '"' in text:
        try:
            return [cell.strip() for cell in next(csv.reader([text], delimiter=delimiter, skipinitialspace=True), [])]
        except csv.Error:
            pass
    return [cell.strip().strip('"').strip() for cell in text.split(delimiter)]


def is_missing(cell: str) -> bool:
    """Tell whether a cell says that its value is missing."""
    return not cell or cell.lower() in MISSING


def is_number(cell: str) -> bool:
    """Tell whether a cell holds a number, with a decimal point or comma."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return "_" not in cell


def find_header(path: Path, rows: Rows) -> Header | None:
    """Find the header among the first rows of a table; None where numbers begin at once, or there is no row.

    It is the first row with two units, else that above a row of units, else the last one above the numbers that has as many
    cells, else the first.
    """
    data = next((i for i, (_, cells) in enumerate(rows) if _is_data(cells)), len(rows))
    if data == 0:
        return None
    above = rows[:data]
    of_units = next((i for i in range(1, data) if _are_units(rows[i][1]) and _match(rows[i - 1][1], rows[i][1])), None)
    with_units = next((i for i, (_, cells) in enumerate(above) if sum(split_unit(c)[1] is not None for c in cells) >= 2), None)
    if with_units is not None and with_units == of_units:
        with_units = None
    fits = data < len(rows) and _match(above[-1][1], rows[data][1])
    if with_units is not None:
        surety, names = 3, with_units
    elif of_units is not None:
        surety, names = 2, of_units - 1
    elif fits:
        surety, names = 1, data - 1
    else:
        surety, names = 0, 0
    line, cells = rows[names]
    headings = [split_unit(cell) for cell in cells]
    last = names
    # names that span columns, as merged cells do, and their parts in the row below or above
    if names + 1 < data and not _are_units(rows[names + 1][1]) and _spans(cells, rows[names + 1][1]):
        last = names + 1
        headings = _joined(cells, rows[last][1])
    elif surety < 3 and names and _spans(rows[names - 1][1], cells):
        headings = _joined(rows[names - 1][1], cells)
    if last + 1 < data and _are_units(rows[last + 1][1]):
        last += 1
        headings += [("", None)] * (len(rows[last][1]) - len(headings))
        below = [split_unit(cell)[1] or cell or None for cell in rows[last][1]] + [None] * len(headings)
        headings = [(name, unit or more) for (name, unit), more in zip(headings, below, strict=False)]
    kept = max((i for i, heading in enumerate(headings, 1) if heading[0] or heading[1]), default=0)
    if data < len(rows):
        kept = max(kept, min(len(headings), len(rows[data][1])))  # a column without a name may hold something
    headed, units = zip(*(headings[:kept] or headings[:1]), strict=True)
    return Header(path, line, tuple(headed), tuple(units), last=rows[last][0], surety=surety)


def _is_data(cells: Sequence[str]) -> bool:
    """Tell whether most of a row is numbers or times, beginning with the first cell that is not empty."""
    filled = [cell for cell in cells if cell]
    numbers = [is_number(cell) or is_clock_time(cell) or is_missing(cell) for cell in filled]
    return bool(filled) and numbers[0] and not is_missing(filled[0]) and 2 * sum(numbers) > len(numbers)


def _are_units(cells: Sequence[str]) -> bool:
    """Tell whether a row holds nothing but units, most of them known."""
    filled = [split_unit(cell) for cell in cells if cell]
    units = [unit if unit is not None and not name else name for name, unit in filled]
    short_ones = all(0 < len(unit) <= _LONGEST_UNIT and not is_number(unit) for unit in units)
    return bool(units) and short_ones and 2 * sum(map(is_unit, units)) >= len(units) and is_unit(units[0])


def _match(names: Sequence[str], cells: Sequence[str]) -> bool:
    """Tell whether names fit the cells below: a name above each cell but empty ones at the end, and no name a number."""
    least = [max((i for i, cell in enumerate(row, 1) if cell), default=0) for row in (names, cells)]
    fit = least[0] <= len(cells) and least[1] <= len(names) and least[0] > (len(cells) > 1)
    return fit and not any(is_number(name) for name in names if name)


def _spans(above: Sequence[str], below: Sequence[str]) -> bool:
    """Tell whether names above span columns that have further names below, as merged cells do."""
    if len(above) > len(below) or any(is_number(cell) for cell in (*above, *below)) or sum(map(bool, above)) < 2:
        return False
    above = [*above, *[""] * (len(below) - len(above))]  # a workbook keeps no empty cells at the end
    spanned = [i for i, name in enumerate(above) if i and (not name or name == above[i - 1])]
    # a column of one name has none in the other row; of two names each, the upper ones come several times
    alone = not above[0] or not all(below)
    return bool(spanned) and all(below[i] for i in spanned) and (alone or all(above))


def _joined(above: Sequence[str], below: Sequence[str]) -> list[tuple[str, str | None]]:
    """Join names that span columns with those below them; a unit may stand in either."""
    headings: list[tuple[str, str | None]] = []
    span: tuple[str, str | None] = ("", None)
    for i, cell in enumerate(below):
        if i < len(above) and above[i]:
            span = split_unit(above[i])
        name, unit = split_unit(cell)
        headings.append((f"{span[0]} {name}".strip(), unit or span[1]))
    return headings


def is_clock_time(cell: str) -> bool:
    """Tell whether a cell holds a time of day, with a date or without, such as 2026-01-31 12:00:00.001 or 12:00:00,5."""
    return _CLOCK.fullmatch(cell) is not None


def clock_time(cell: str, *, day_first: bool = False) -> tuple[int, float]:
    """Return an instant as a clock shows it: the day, counted from year 1 or 0 without a date, and the second of that day.

    They are two numbers, since a double holds no microseconds of so many seconds. A date with slashes has its month first,
    with `day_first` its day.

    Raises:
        ValueError: the cell holds no such instant.
    """
    match = _CLOCK.fullmatch(cell)
    if match is None:
        raise ValueError(cell)
    hour, day = int(match["hour"]), int(match["days"] or 0)
    if match["half"]:
        hour = hour % 12 + 12 * (match["half"][0] in "pP")
    if match["sign"]:
        first, third = int(match["first"]), int(match["third"])
        middle = _MONTHS.index(match["second"].lower()) + 1 if match["second"].lower() in _MONTHS else int(match["second"])
        if len(match["first"]) > 2:
            year, month, of_month = first, middle, third
        elif match["sign"] == "/" and not day_first and not match["second"].isalpha():
            year, month, of_month = third, first, middle
        else:
            year, month, of_month = third, middle, first
        day += datetime.date(year + 2000 * (year < 100), month, of_month).toordinal()
    second = 3600 * hour + 60 * int(match["minute"]) + int(match["whole"] or 0)
    return day, second + float(f"0.{match['parts'] or match['ms'] or 0}")
