"""Measures of a study's table: their columns, and how each is displayed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from types import MappingProxyType

import numpy as np
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.tables import Column
from wirerope_mj.foundation.units import shown_in
from wirerope_mj.studies.engines.compute import DONE

COMBINED = "combined_travel"
# Largest of the columns that it matches: of bodies and points, as a run says it; `acceleration` is that of bodies alone.
ALL = "acceleration/*"
# Measures that are looked at first, in this order.
HEADLINES = ("travel", COMBINED, "acceleration", ALL, "fragility", "clearance")
# Those of them that are drawn, and whose variance is explained.
DRAWN = ("travel", "acceleration", "fragility", "clearance")
STRUCK = "struck"  # Column of the number of stops that were struck
_OTHER = ("variant", "status", "message", "generation")
_QUANTITIES = {
    "travel": ("largest utilisation of a rated travel along one axis", "%", 100.0, 1.0),
    COMBINED: ("utilisation of all rated travels at once, in-house rule", "%", 100.0, 1.0),
    "acceleration": ("largest acceleration", *shown_in("m/s^2"), None),
    "static_load": ("utilisation of the rated static load", "%", 100.0, 1.0),
    "fragility": ("utilisation of the stated acceleration limit", "%", 100.0, 1.0),
    "clearance": ("utilisation of the stated clearance of points", "%", 100.0, 1.0),
    "mounts": ("number of mounts that act", "-", 1.0, None),
    "struck": ("number of stops struck", "-", 1.0, None),
    "deflection": ("largest deflection", *shown_in("m"), None),
    "displacement": ("largest displacement relative to the base", *shown_in("m"), None),
    "force": ("largest force", *shown_in("N"), None),
}
_ALIKE = 12  # Measures that are named because they begin alike: those of all mounts of a floor would fill the screen


@dataclass(frozen=True, kw_only=True)
class Measure:
    """A measure as it is displayed."""

    name: str  # column of the table
    text: str  # its meaning, without the unit
    unit: str  # in which it is displayed
    factor: float  # from SI to this unit
    limit: float | None  # that it must not exceed, SI; None if there is none

    @property
    def label(self) -> str:
        """Text and unit, as an axis says it."""
        return f"{self.text} [{self.unit}]"

    @property
    def column(self) -> Column:
        """Column of its values in a table."""
        return Column(self.name, form=".4g") if self.unit == "-" else Column(self.name, self.unit)


def measure_of(name: str, limits: Mapping[str, float] = MappingProxyType({})) -> Measure:
    """Return the measure of a column; one that has no limit of its own takes it from `limits`, SI by name."""
    quantity, _, rest = name.partition("/")
    text, unit, factor, own = _QUANTITIES[quantity]
    text += {ALL: " of bodies and points", "acceleration": " of a body"}.get(name, "")
    rest = "" if name == ALL else rest
    limit = limits.get(name) if own is None else own
    return Measure(name=name, text=f"{text}, {rest}" if rest else text, unit=unit, factor=factor, limit=limit)


def unit_of(name: str) -> str:
    """Return the SI unit of a column of a study's table; "" of ratios, counts and inputs."""
    units = {"acceleration": "m/s^2", "deflection": "m", "displacement": "m", "force": "N"}
    return units.get(name.partition("/")[0], "")


def input_names(table: pa.Table) -> list[str]:
    """Return the names of the columns that were sampled."""
    names = table.column_names
    return names[1 : names.index("acceleration")]


def measures_of(table: pa.Table) -> list[str]:
    """Return the names of the measures of a table."""
    first = table.column_names.index("acceleration")
    return [name for name in table.column_names[first:] if name not in _OTHER]


def checked_measure(table: pa.Table, name: str) -> str:
    """Return `name`; ValueError names the measures if it is none, or was not judged."""
    names = measures_of(table)
    if name not in (*names, ALL):
        raise ValueError(unknown_measure(name, names))
    if not np.isfinite(values_of(table, name)).any():
        raise ValueError(f"{name!r} has no value in any variant: nothing is rated or stated by which it would be judged.")
    return name


def headlines(table: pa.Table) -> list[str]:
    """Return the measures of `HEADLINES` that have values."""
    return known_measures(table, HEADLINES)


def known_measures(table: pa.Table, names: Sequence[str]) -> list[str]:
    """Return those of some measures that have values: older tables know less; `ALL` only where a point is beyond all bodies."""
    there = [name for name in names if name in table.column_names or (name == ALL and _points_matter(table))]
    return [name for name in there if np.isfinite(values_of(table, name)).any()]


def _points_matter(table: pa.Table) -> bool:
    beside = any(name.startswith(ALL[:-1]) for name in table.column_names)
    return beside and bool((values_of(table, ALL) > values_of(table, ALL[:-2])).any())


def values_of(table: pa.Table, name: str) -> Array:
    """Return a column of measures, NaN where the variant failed or nothing is judged, (n,)."""
    names = [one for one in table.column_names if one.startswith(name[:-1])] if name == ALL else [name]
    values = np.fmax.reduce([np.asarray(table[one], dtype=np.float64) for one in names])
    return np.where(np.asarray(table["status"]) == DONE, values, np.nan)


def unknown_measure(name: str, known: Sequence[str]) -> str:
    """Return what is wrong with a name or pattern that is of no measure, and what there is, as a sentence without a capital."""
    first = name.partition("/")[0].rstrip("*?")
    alike = [one for one in known if first and one.startswith(first)]
    alike.sort(key=lambda one: -SequenceMatcher(None, one, name).ratio())
    rest = ", ..." if len(alike) > _ALIKE else ""
    begin = f"; alike are {', '.join(alike[:_ALIKE])}{rest}" if alike else ""
    return f"there is no measure {name!r}{begin}; there are {kinds_of(known)}."


def kinds_of(known: Sequence[str]) -> str:
    """Return measures as a list with NAME in place of mounts, bodies and points."""
    return ", ".join(dict.fromkeys(map(_kind, known)))


def _kind(name: str) -> str:
    """Return a measure with NAME in place of a mount, a body or a point: "deflection/NAME/roll"."""
    first, *rest = name.split("/")
    if not rest:
        return name
    return "/".join([first, "NAME", *(rest[-1:] if first == "deflection" else [])])
