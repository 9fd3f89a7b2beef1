"""Values as an engineer reads them: millimetres, kilonewtons and g, with as many digits as they are worth."""

import math
import re

from wirerope_mj.foundation.units import force_unit, in_unit, shown_in, significant

ABSENT = "–"  # Stands where there is no value
MINUS = "\N{MINUS SIGN}"


def shown_unit(unit: str) -> str:
    """Return the unit in which values of an SI unit are shown."""
    return shown_in(unit)[0].replace("^2", "²")


def shown(value: float | None, unit: str = "", *, digits: int = 3) -> str:
    """Return a value of an SI unit as a number in the unit that is shown; without one, or if it is not known, a dash."""
    if value is None or not math.isfinite(value):
        return ABSENT
    return number(in_unit(value, shown_in(unit)[0]), digits=digits)


def with_unit(value: float | None, unit: str, *, digits: int = 3) -> str:
    """Return number and unit; the unit may also be one that is displayed: "ms", "%"."""
    if unit == "N" and value is not None and force_unit(value) == "N":
        return f"{number(value, digits=digits)} N"
    return f"{shown(value, unit, digits=digits)} {shown_unit(unit)}".strip()


def number(value: float, *, digits: int = 3) -> str:
    """Return a number to some significant digits without an exponent, with a true minus sign."""
    return significant(value, digits).replace("-", MINUS) if math.isfinite(value) else ABSENT


def fixed(value: float, decimals: int) -> str:
    """Return a number with some decimals, a true minus sign, and no minus before a zero."""
    return f"{value:z.{decimals}f}".replace("-", MINUS) if math.isfinite(value) else ABSENT


def several(count: int, thing: str) -> str:
    """Return a count with its noun: "1 mount", "3 mounts"."""
    return f"{count} {thing if count == 1 else thing + 's'}"


def title_of(name: str) -> str:
    """Return a name as text: "shock-box_3ax" is "Shock box 3ax"; hyphens between digits stay, as in a date."""
    text = re.sub(r"(?<!\d)-|-(?!\d)", " ", name.replace("_", " ")).strip()
    return text[:1].upper() + text[1:]


def paragraphs(text: str) -> list[str]:
    """Return the paragraphs of a text, each on one line."""
    return [" ".join(part.split()) for part in text.strip().split("\n\n") if part.strip()]


def listed(names: list[str], *, most: int = 6) -> str:
    """Return names in a row; of many the first, and how many more there are."""
    if len(names) <= most:
        return ", ".join(names)
    return f"{', '.join(names[: most - 1])} and {len(names) - most + 1} more"
