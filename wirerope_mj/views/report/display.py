"""Figures as an engineer reads them: millimetres, kilonewtons and g, with as many digits as they are worth."""

import math
import re

from wirerope_mj.foundation.units import shown_in

ABSENT = "–"
"""What stands where there is no figure."""

MINUS = "\N{MINUS SIGN}"


def shown_unit(unit: str) -> str:
    """Return the unit in which values of an SI unit are shown."""
    return shown_in(unit)[0].replace("^2", "²")


def shown(value: float | None, unit: str = "", *, digits: int = 3) -> str:
    """Return a value of an SI unit as a number in the unit that is shown; without one, or if it is not known, a dash."""
    if value is None or not math.isfinite(value):
        return ABSENT
    return number(value * shown_in(unit)[1], digits=digits)


def with_unit(value: float | None, unit: str, *, digits: int = 3) -> str:
    """Return number and unit."""
    return f"{shown(value, unit, digits=digits)} {shown_unit(unit)}".strip()


def number(value: float, *, digits: int = 3) -> str:
    """Return a number to some significant digits without an exponent, whole digits never cut: 0.00123, 1.23, 123, 12345."""
    if not math.isfinite(value):
        return ABSENT
    if value == 0.0 or abs(value) < 1e-9:  # nothing that is shown in mm, kN or g is that small and not rounding
        return "0"
    rounded = abs(float(f"{value:.{digits - 1}e}"))  # 9.9999 is 10.0, not 10.00
    places = max(digits - 1 - math.floor(math.log10(rounded)), 0)
    return fixed(value, min(places, 6))


def fixed(value: float, places: int) -> str:
    """Return a number with some decimal places, a true minus sign, and no minus before a zero."""
    if not math.isfinite(value):
        return ABSENT
    text = f"{value:.{places}f}"
    return text.lstrip("-") if float(text) == 0.0 else text.replace("-", MINUS)


def percent(share: float | None, *, places: int = 0) -> str:
    """Return a share in per cent."""
    return ABSENT if share is None or not math.isfinite(share) else f"{fixed(100.0 * share, places)} %"


def several(count: int, thing: str, things: str = "") -> str:
    """Return a count with its noun: "1 mount", "3 mounts"."""
    return f"{count} {thing if count == 1 else things or thing + 's'}"


def title_of(name: str) -> str:
    """Return a name as words: "shock-box_3ax" is "Shock box 3ax"; hyphens between digits stay, as in a date."""
    words = re.sub(r"(?<!\d)-|-(?!\d)", " ", name.replace("_", " ")).strip()
    return words[:1].upper() + words[1:]


def listed(names: list[str], *, most: int = 6) -> str:
    """Return names in a row; of many the first, and how many more there are."""
    if len(names) <= most:
        return ", ".join(names)
    return f"{', '.join(names[: most - 1])} and {len(names) - most + 1} more"
