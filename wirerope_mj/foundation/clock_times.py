"""Instants as a clock shows them: dates and times of day."""

import datetime
import re

_CLOCK = re.compile(
    r"(?:(?P<first>\d{1,4})(?P<sign>[-./])(?P<second>\d{1,2}|[A-Za-z]{3})(?P=sign)(?P<third>\d{2,4})[T ,]+)?"
    r"(?:(?P<days>\d+) days?, )?(?P<hour>\d{1,2}):(?P<minute>\d{2})"
    r"(?::(?P<whole>\d{2})(?:[.,](?P<parts>\d{1,9})|:(?P<ms>\d{3}))?)?"
    r"\s*(?P<half>[AaPp]\.?[Mm]\.?)?(?:Z|\s*UTC|[+-]\d{2}:?\d{2})?"
)
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")


def is_clock_time(cell: str) -> bool:
    """Tell whether a cell holds a time of day, with a date or without, such as 2026-01-31 12:00:00.001 or 12:00:00,5."""
    return _CLOCK.fullmatch(cell) is not None


def clock_time(cell: str, *, day_first: bool = False) -> tuple[int, float]:
    """Return an instant as a clock shows it: the day, counted from year 1 or 0 without a date, and the second of that day.

    Apart, since a double holds no microseconds of so many seconds. A date with slashes has its month first, or its day.

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
