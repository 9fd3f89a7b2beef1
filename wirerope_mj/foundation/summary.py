"""Results in a few lines: as text in a terminal, as a small table in a notebook."""

import math
from html import escape

from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.foundation.units import shown_in

MOST_LINES = 12
"""Lines of a summary: what is longer is looked up by name rather than read."""


class Summarised:
    """Base of results that say in a few lines what they hold; a dataclass among them has `repr=False`."""

    def _summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and values with their units by what they are."""
        raise NotImplementedError

    def _lines(self) -> tuple[str, list[tuple[str, str]]]:
        heading, values = self._summary()
        rows = [(plain(name), plain(value)) for name, value in values.items()]
        if len(rows) >= MOST_LINES:
            rows = [*rows[: MOST_LINES - 2], ("...", f"and {len(rows) - MOST_LINES + 2} more")]
        return plain(heading), rows

    def __repr__(self) -> str:
        heading, rows = self._lines()
        width = max((len(name) for name, _ in rows), default=0)
        return "\n".join([heading, *(f"  {name:{width}}  {value}".rstrip() for name, value in rows)])

    def _repr_html_(self) -> str:
        heading, rows = self._lines()
        cells = "".join(
            f'<tr><td style="text-align:left">{escape(name)}</td><td style="text-align:left">{escape(value)}</td></tr>'
            for name, value in rows
        )
        return f"<table><caption>{escape(heading)}</caption>{cells}</table>"


def quantity(value: float, unit: str) -> str:
    """Return a value of an SI unit with the unit in which an engineer reads it: "31.2 mm"."""
    shown, factor = shown_in(unit)
    return f"{value * factor:.4g} {shown}".strip() if math.isfinite(value) else "not known"


def span(values: tuple[float, float], unit: str) -> str:
    """Return the two ends of a range of an SI unit: "5 to 80 Hz"."""
    shown, factor = shown_in(unit)
    return f"{values[0] * factor:.4g} to {values[1] * factor:.4g} {shown}".strip()
