"""Columns of the lists that CAD programs export, called as a table of masses calls them."""

import re
import warnings
from collections.abc import Sequence

from wirerope_mj.engine.from_tables.mass_text import POSITIVE, TENSOR
from wirerope_mj.engine.from_tables.sheet import BESIDE, Row
from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.foundation.plain_text import short

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


def columns_of_masses(names: Sequence[str]) -> tuple[str, ...]:
    """Translate the column names of a CAD program's list to those of a table of masses; columns to be skipped get `BESIDE`.

    SolidWorks' L are moments about the centre of mass; where they stand, its I, at the origin, are not read.
    """
    columns = []
    central = any(re.fullmatch(r"l[ _]?[xyz]{2}", name.casefold()) for name in names)
    for name in names:
        written = " ".join(name.casefold().split())
        if central and re.fullmatch(r"i[ _]?[xyz]{2}", written):
            columns.append(BESIDE)
            continue
        known = next((column for column, called in _CALLED.items() if re.fullmatch(called, written)), None)
        columns.append(BESIDE if known is None and re.fullmatch(rf"{_BESIDE}|{_NUMBER}", written) else known or name)
    if "name" not in columns and (numbers := [k for k, name in enumerate(names) if re.fullmatch(_NUMBER, name.casefold())]):
        columns[numbers[0]] = "name"
    return tuple(columns)


def sign_of_products(rows: Sequence[Row], products: str) -> float:
    """Return the sign convention of products of inertia: 1 for elements of the tensor, -1 for +sum x y dm.

    A CAD program's list, which has other column names than a table, does not say which; SolidWorks' L are +sum x y dm, about
    the centre of mass, unless an option of SolidWorks is changed. A warning says what is taken.
    """
    written = {name: text for name, text in rows[0].written.items() if name != BESIDE}
    sign = -1.0 if products == POSITIVE else 1.0
    if all(text.casefold() == name for name, text in written.items()):
        return sign
    moments, crossed = (
        [written[name] for name in names if any(row.has(name) and row.number(name) for row in rows)]
        for names in (MOMENTS, PRODUCTS)
    )
    solidworks = any(text.casefold().startswith("l") for text in (*moments, *crossed))
    unsaid = []
    # moments that are called I are in SolidWorks those at the origin, whatever the sign of the products
    if moments and not solidworks and (not products or moments[0].casefold().startswith("ix")):
        unsaid.append(
            f'about which point its moments of inertia are, "{short(moments[0])}"; they are taken about each part\'s own '
            "centre of mass, which columns called name, x, y, z, ixx say without this warning. Where they are about the "
            "origin, move them first"
        )
    if crossed and not products:
        taken, option = "elements of the tensor, -sum x y dm", POSITIVE
        if solidworks:
            sign, taken, option = -1.0, "+sum x y dm, as SolidWorks prints L", TENSOR
        unsaid.append(
            f'the sign of its products of inertia, "{short(crossed[0])}"; they are taken as {taken}. `--products {option}` '
            "takes them the other way"
        )
    if unsaid:
        warnings.warn(f"{rows[0].location}: the list does not say {'; nor '.join(unsaid)}.", RecordWarning, stacklevel=2)
    return sign
