"""Values as text in an engineer's units, such as mm, kN and g, with significant digits only."""

import math
import re

from wirerope_mj.foundation.units import force_unit, in_unit, shown_in, significant

ABSENT = "–"  # in place of a missing value
MINUS = "\N{MINUS SIGN}"


def shown_unit(unit: str) -> str:
    return shown_in(unit)[0].replace("^2", "²")


def shown(value: float | None, unit: str = "", *, digits: int = 3) -> str:
    """Write an SI value in the unit that outputs show, without the unit; a dash for None and NaN."""
    if value is None or not math.isfinite(value):
        return ABSENT
    return number(in_unit(value, shown_in(unit)[0]), digits=digits)


def with_unit(value: float | None, unit: str, *, digits: int = 3) -> str:
    """Write a value with its unit, an SI unit or a displayed one such as "ms" or "%"."""
    if unit == "N" and value is not None and force_unit(value) == "N":
        return f"{number(value, digits=digits)} N"
    return f"{shown(value, unit, digits=digits)} {shown_unit(unit)}".strip()


def number(value: float, *, digits: int = 3) -> str:
    return significant(value, digits).replace("-", MINUS) if math.isfinite(value) else ABSENT


def fixed(value: float, decimals: int) -> str:
    return f"{value:z.{decimals}f}".replace("-", MINUS) if math.isfinite(value) else ABSENT


def several(count: int, thing: str) -> str:
    """Write a count with its noun, such as "1 mount" or "3 mounts"."""
    return f"{count} {thing if count == 1 else thing + 's'}"


def title_of(name: str) -> str:
    """Write a name as a title, "shock-box_3ax" as "Shock box 3ax"; hyphens between digits stay."""
    text = re.sub(r"(?<!\d)-|-(?!\d)", " ", name.replace("_", " ")).strip()
    return text[:1].upper() + text[1:]


def paragraphs(text: str) -> list[str]:
    """Split a text at its empty lines into paragraphs without line breaks."""
    return [" ".join(part.split()) for part in text.strip().split("\n\n") if part.strip()]


def listed(names: list[str], *, most: int = 6) -> str:
    """Join names by commas; of more than `most`, count the rest."""
    if len(names) <= most:
        return ", ".join(names)
    return f"{', '.join(names[: most - 1])} and {len(names) - most + 1} more"
