"""Masses of a model: rows of a table, whose totals are no masses, or the parts in a CAD program's text."""

import re
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.engine.flexible.panel import DAMPING
from wirerope_mj.engine.from_tables.layout import Mass, MassProperties, Sprung, why_impossible
from wirerope_mj.engine.from_tables.mass_text import POSITIVE, read_mass_text
from wirerope_mj.engine.from_tables.sheet import TEXT, Row, read_sheet
from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.foundation.plain_text import short

MOMENTS, PRODUCTS, SIZES = ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz"), ("size_x", "size_y", "size_z")
# words of which the name of a row of totals consists
_TOTAL = {
    "total", "totals", "totale", "totaux", "totales", "totaal", "totalt", "sum", "sums", "summe", "summen", "gesamt",
    "insgesamt", "gesamtmasse", "gesamtgewicht", "zwischensumme", "zwischensummen", "subtotal", "subtotale", "somme", "soma",
    "suma", "somma", "razem", "yhteensa", "samlet", "\u03c3", "\u2211", "\u5408\u8ba1", "\u603b\u8ba1", "\u5408\u8a08",
    "\ud569\uacc4",
}  # fmt: skip
_BESIDE = {"grand", "sub", "mass", "masses", "weight", "masse", "massen", "gewicht", "all", "parts", "of", "the", "over", "kg"}
_ROUNDED = 2e-3  # by how much a total may miss the sum of what it adds up, for the digits that are printed
_SAME = 1e-6  # within which a mass that is called otherwise is the sum of all others


def read_masses(path: Path, *, products: str = "") -> tuple[Mass, ...]:
    """Read the masses of a table, or of a CAD program's text, .txt; `products` as `read_layout` has it.

    Raises:
        RecordError: says file, row and column that are wrong.
    """
    if path.suffix.lower() == ".txt":
        masses = tuple(Mass(name, one, location=str(path)) for name, one in read_mass_text(path, products=products))
    else:
        needed = {"name": TEXT, "mass": "mass", **{axis: "length" for axis in "xyz"}}
        further = {
            **dict.fromkeys((*MOMENTS, *PRODUCTS), "inertia"), **dict.fromkeys(SIZES, "length"),
            "frequency": "frequency", "damping": "ratio", "along": TEXT,
        }  # fmt: skip
        rows = read_sheet(path, kind="table of masses", needed=needed, further=further)
        masses = tuple(_mass(row, -1.0 if products == POSITIVE else 1.0) for row in _without_totals(rows))
    last = masses[-1]  # where a total stands; another part may well weigh as much as the rest
    others = sum(mass.properties.mass for mass in masses[:-1])
    if len(masses) > 2 and abs(last.properties.mass - others) < _SAME * others:
        warnings.warn(
            f'{last.location}: "{short(last.name)}" weighs what all others weigh together, {others:.6g} kg: if it is their '
            "total, leave it out.", RecordWarning, stacklevel=2,
        )  # fmt: skip
    return masses


def _without_totals(rows: Sequence[Row]) -> list[Row]:
    """Return the rows that are masses, with a warning of each that adds up others; RecordError if a total adds up to none."""
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


def _mass(row: Row, sign: float) -> Mass:
    name, mass = row.text("name"), row.number("mass")
    if mass <= 0.0:
        raise row.error(f'column "mass" of "{short(name)}" must be > 0, got {row.cells["mass"]}.')
    given = [column for column in (*MOMENTS, *PRODUCTS) if row.has(column)]
    missing = [column for column in MOMENTS if column not in given]
    if given and missing:
        raise row.error(
            f'column "{missing[0]}" of "{short(name)}" is empty though "{given[0]}" is given; fill in '
            "ixx, iyy and izz, or size_x, size_y and size_z of a box, or leave all empty: then it is a point mass."
        )
    tensor = np.zeros((3, 3))
    if any(row.has(column) for column in SIZES):  # a box that is filled evenly
        if given:
            raise row.error(f'columns "{given[0]}" and "size_x" of "{short(name)}" both say the inertia; leave one empty.')
        sizes = np.array([row.number(column) for column in SIZES])
        for column, size in zip(SIZES, sizes, strict=True):
            if size < 0.0:
                raise row.error(f'column "{column}" of "{short(name)}" must be >= 0, got {row.cells[column]}.')
        tensor = np.diag(mass / 12.0 * (sizes @ sizes - sizes**2))
    elif given:
        tensor[np.diag_indices(3)] = [row.number(column) for column in MOMENTS]
        for column, (i, j) in zip(PRODUCTS, ((0, 1), (0, 2), (1, 2)), strict=True):
            tensor[i, j] = tensor[j, i] = sign * row.number(column, 0.0)
    if why := why_impossible(tensor):
        raise row.error(
            f'no body has the inertia in columns "ixx" to "iyz" of "{short(name)}": {why}. It is taken '
            "about the part's own centre of mass."
        )
    properties = MassProperties(mass, np.array(row.vector("x", "y", "z")), tensor)
    return Mass(name, properties, _sprung(row, name), row.location)


def _sprung(row: Row, name: str) -> Sprung | None:
    """Return how a subassembly stands in the payload; None of a mass that is part of it."""
    if not row.has("frequency"):
        if given := [column for column in ("damping", "along") if row.has(column)]:
            raise row.error(f'"{short(name)}" has a {given[0]} and no "frequency"; fill in both or none.')
        return None
    frequency, damping = row.number("frequency"), row.number("damping", DAMPING)
    axis = row.text("along") if row.has("along") else "z"
    if frequency <= 0.0 or not 0.0 <= damping < 1.0 or axis not in ("x", "y", "z"):
        raise row.error(
            f'a subassembly has a "frequency" > 0, a "damping" from 0 to below 100 % and moves "along" x, y or '
            f"z; got {frequency:g} Hz, {100.0 * damping:g} % and {short(axis)}."
        )
    if "/" in name or any(character.isspace() for character in name) or name == "deck":
        raise row.error(f'"{short(name)}" is a body of its own and needs a name without spaces and "/".')
    return Sprung(frequency, damping, axis)
