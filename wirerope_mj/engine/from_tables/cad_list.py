"""Columns of the lists that CAD programs export, called as a table of masses calls them."""

import re
from collections.abc import Sequence

MOMENTS, PRODUCTS = ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz")
_CENTRE = r"(?:cent(?:er|re) of (?:mass|gravity)|com|cog|cg|centroid|schwerpunkt|centre de masse|baricentro)"
# What each column is called elsewhere, in small letters.
_CALLED = {
    "name": r"name|(?:part|component|item|body|bauteil|komponente)(?: ?name)?|benennung|bezeichnung",
    "mass": r"mass|masse|massa|masa",
    "quantity": r"quantity|qty\.?|count|anzahl|menge",
    **{axis: rf"{axis}|{_CENTRE}[ _.:-]*{axis}|{axis}[ _.:-]*{_CENTRE}|{axis}[ _]?bar" for axis in "xyz"},
    **{name: rf"[li][ _]?{name[1:]}|(?:moments? of )?inertia[ _]?{name[1:]}" for name in MOMENTS},
    **{name: rf"[lip][ _]?{name[1:]}|(?:products? of )?inertia[ _]?{name[1:]}" for name in PRODUCTS},
}
_NUMBER = r"part ?(?:number|no\.?|nr\.?|id)|teilenummer|artikel(?:nummer)?"
# Columns that say nothing of masses.
_BESIDE = (
    r"material|werkstoff|density|dichte|volume|volumen|(?:surface )?area|oberfl\w+|description|revision|state|configuration|"
    r"appearance|vendor|supplier|comments?|bemerkung|finish|color|colour|level|ebene|pos\.?|no\.?|#"
)
BESIDE = "beside"  # column that is not read


def columns_of_masses(names: Sequence[str]) -> tuple[str, ...]:
    """Return the columns' names of a list as a table of masses has them; those that say nothing of masses are called `BESIDE`.

    SolidWorks' L are moments about the centre of mass; where they stand, its I, at the origin, are not read.
    """
    found = []
    central = any(re.fullmatch(r"l[ _]?[xyz]{2}", name.casefold()) for name in names)
    for name in names:
        written = " ".join(name.casefold().split())
        if central and re.fullmatch(r"i[ _]?[xyz]{2}", written):
            found.append(BESIDE)
            continue
        known = next((column for column, called in _CALLED.items() if re.fullmatch(called, written)), None)
        found.append(BESIDE if known is None and re.fullmatch(rf"{_BESIDE}|{_NUMBER}", written) else known or name)
    if "name" not in found and (numbers := [k for k, name in enumerate(names) if re.fullmatch(_NUMBER, name.casefold())]):
        found[numbers[0]] = "name"
    return tuple(found)
