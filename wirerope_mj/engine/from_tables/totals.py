"""Rows of totals in a table of masses, which add up other rows and are no parts."""

import re
import warnings
from collections.abc import Sequence

from wirerope_mj.engine.from_tables.sheet import Row
from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.foundation.plain_text import short

# words of which the name of a row of totals consists
_TOTAL = {
    "total", "totals", "totale", "totaux", "totales", "totaal", "totalt", "sum", "sums", "summe", "summen", "gesamt",
    "insgesamt", "gesamtmasse", "gesamtgewicht", "zwischensumme", "zwischensummen", "subtotal", "subtotale", "somme", "soma",
    "suma", "somma", "razem", "yhteensa", "samlet", "\u03c3", "\u2211", "\u5408\u8ba1", "\u603b\u8ba1", "\u5408\u8a08",
    "\ud569\uacc4",
}  # fmt: skip
_BESIDE = {"grand", "sub", "mass", "masses", "weight", "masse", "massen", "gewicht", "all", "parts", "of", "the", "over", "kg"}
_ROUNDED = 2e-3  # by how much a total may miss the sum of what it adds up, for the digits that are printed


def without_totals(rows: Sequence[Row]) -> list[Row]:
    """Leave out rows of totals, with a warning for each.

    A total equals the sum of all masses, of rows directly above it, or of all rows below it, else RecordError; one without a
    mass is left out unchecked.
    """
    named = [{*re.findall(r"\w+|\u2211", row.text("name").casefold())} for row in rows]
    is_total = [bool(words & _TOTAL) and words <= _TOTAL | _BESIDE for words in named]
    masses = [row.number("mass") for row, total in zip(rows, is_total, strict=True) if not total]
    kept: list[Row] = []
    for row, total in zip(rows, is_total, strict=True):
        if not total:
            kept.append(row)
            continue
        stated = row.number("mass", 0.0)
        ranges = [masses, *(masses[first : len(kept)] for first in range(len(kept))), masses[len(kept) :]]
        if stated and not any(abs(stated - sum(part)) <= _ROUNDED * stated for part in ranges):
            raise row.error(
                f'"{short(row.text("name"))}" is {stated:.6g} kg, and the other rows add up to {sum(masses):.6g} kg. Correct '
                "the table, leave the row out, or give it another name if it is a mass of its own."
            )
        warnings.warn(
            f'{row.location}: "{short(row.text("name"))}", {stated:.6g} kg, adds up other rows and is left out.', RecordWarning,
            stacklevel=2,
        )  # fmt: skip
    if not kept:
        raise rows[0].error("the table of masses holds a total and nothing else.")
    return kept
