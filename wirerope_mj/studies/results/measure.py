"""Measures of a study's table: their columns, how each is displayed, and their quantiles, exceedance and worst variants."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import reduce
from operator import itemgetter
from types import MappingProxyType

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import scipy

from wirerope_mj.foundation.arrays import Array, Booleans, Entries
from wirerope_mj.foundation.tables import Column
from wirerope_mj.foundation.units import shown_in
from wirerope_mj.studies.ended import ended_early
from wirerope_mj.studies.engines.compute import DONE

COMBINED = "combined_travel"
# Largest of the columns that it matches: of bodies and points, as a run says it; `acceleration` is that of bodies alone.
ALL = "acceleration/*"
# Measures that are looked at first, in this order.
HEADLINES = ("travel", COMBINED, "acceleration", ALL, "fragility", "clearance")
# Those of them that are drawn, and whose variance is explained: of both travels the one that is nearer to its limit or farther
# beyond, since it decides.
DRAWN = ("travel", COMBINED, "acceleration", "fragility", "clearance")
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
    "load": ("bound of the load of a foot, its stops included", *shown_in("N"), None),
}
_ALIKE = 12  # Measures that are named because they begin alike: those of all mounts of a floor would fill the screen


@dataclass(frozen=True, kw_only=True)
class Measure:
    """A measure of a study's variants as tables and charts show it: its column, label, unit and digits."""

    name: str  # column of the table
    text: str  # its meaning, without the unit
    unit: str  # in which it is displayed
    factor: float  # from SI to this unit
    limit: float | None  # that it must not exceed, SI; None if there is none

    @property
    def label(self) -> str:
        return f"{self.text} [{self.unit}]"

    @property
    def heading(self) -> str:
        """Heading of its column: "combined travel", "deflection, m1, axial"."""
        quantity, *rest = self.name.split("/")
        return ", ".join([quantity.replace("_", " "), *("all" if part == "*" else part for part in rest)])

    @property
    def column(self) -> Column:
        return Column(self.heading, form=".4g") if self.unit == "-" else Column(self.heading, self.unit)


def measure_of(name: str, limits: Mapping[str, float] = MappingProxyType({})) -> Measure:
    """Return the measure of a column, with its own limit, or one of `limits`, SI by name."""
    quantity, _, rest = name.partition("/")
    text, unit, factor, limit_of_quantity = _QUANTITIES[quantity]
    text += {ALL: " of bodies and points", "acceleration": " of a body"}.get(name, "")
    rest = "" if name == ALL else rest
    limit = limits.get(name) if limit_of_quantity is None else limit_of_quantity
    return Measure(name=name, text=f"{text}, {rest}" if rest else text, unit=unit, factor=factor, limit=limit)


def unit_of(name: str) -> str:
    """Return the SI unit of a column of a study's table; "" of ratios, counts and inputs."""
    units = {"acceleration": "m/s^2", "deflection": "m", "displacement": "m", "force": "N", "load": "N"}
    return units.get(name.partition("/")[0], "")


def input_names(table: pa.Table) -> list[str]:
    names = table.column_names
    return names[1 : names.index("acceleration")]


def measures_of(table: pa.Table) -> list[str]:
    first = table.column_names.index("acceleration")
    return [name for name in table.column_names[first:] if name not in _OTHER]


def checked_measure(table: pa.Table, name: str) -> str:
    """Return the name of a measure that has values in the table; else raise ValueError, which lists the measures."""
    names = measures_of(table)
    if name not in (*names, ALL):
        raise ValueError(unknown_measure(name, names))
    if not np.isfinite(values_of(table, name)).any():
        raise ValueError(f"{name!r} has no value in any variant: nothing is rated or stated by which it would be judged.")
    return name


def headlines(table: pa.Table) -> list[str]:
    """Return the measures that are looked at first, of those that have values in the table."""
    return known_measures(table, HEADLINES)


def drawn_measures(table: pa.Table) -> list[str]:
    """Return the measures that are drawn: of both travels only the one with the larger utilisation."""
    names = [name for name in headlines(table) if name in DRAWN]
    if "travel" not in names or COMBINED not in names:
        return names
    combined, single = (np.nanmax(values_of(table, name)) for name in (COMBINED, "travel"))
    names.remove("travel" if combined > single else COMBINED)
    return names


def most_critical(table: pa.Table, limits: Mapping[str, float] = MappingProxyType({})) -> tuple[str, float] | None:
    """Find the measure with the largest utilisation in any variant, and that utilisation; None without limits.

    Limits are those of the quantities, and `limits` by name, SI.
    """
    measures = [measure_of(name, limits) for name in [*headlines(table), *known_measures(table, [*limits])]]
    limits = {measure.name: measure.limit for measure in measures if measure.limit}
    used = [(name, float(np.nanmax(values_of(table, name)) / limit)) for name, limit in limits.items()]
    return max(used, key=itemgetter(1), default=None)


def known_measures(table: pa.Table, names: Sequence[str]) -> list[str]:
    """Select the measures that have values in a table; `ALL` only if the largest acceleration of a variant is a point's."""
    points_matter = ALL in names and any(name.startswith(ALL[:-1]) for name in table.column_names)
    points_matter = points_matter and bool((values_of(table, ALL) > values_of(table, ALL[:-2])).any())
    present = [name for name in names if name in table.column_names or (name == ALL and points_matter)]
    return [name for name in present if np.isfinite(values_of(table, name)).any()]


def values_of(table: pa.Table, name: str) -> Array:
    """Return a column of measures, NaN where the variant failed or nothing is judged, (n,)."""
    names = [column for column in table.column_names if column.startswith(name[:-1])] if name == ALL else [name]
    values = reduce(np.fmax, (np.asarray(table[column], dtype=np.float64) for column in names))
    return np.where(is_done(table), values, np.nan)


def is_done(table: pa.Table) -> Booleans:
    """Return the mask of the variants that could be simulated, (n,)."""
    return np.asarray(pc.equal(table["status"], DONE))


def unknown_measure(name: str, known: Sequence[str]) -> str:
    """Describe why a name or pattern matches no measure, and what exists, as a clause."""
    first = name.partition("/")[0].rstrip("*?")
    alike = [measure for measure in known if first and measure.startswith(first)]
    alike.sort(key=lambda candidate: -SequenceMatcher(None, candidate, name).ratio())
    rest = ", ..." if len(alike) > _ALIKE else ""
    begin = f"; alike are {', '.join(alike[:_ALIKE])}{rest}" if alike else ""
    return f"there is no measure {name!r}{begin}; there are {kinds_of(known)}."


def kinds_of(known: Sequence[str]) -> str:
    """List measures with NAME in place of mounts, bodies and points."""
    kinds = dict[str, None]()
    for name in known:
        first, *rest = name.split("/")
        kinds["/".join([first, *(["NAME"] if rest else []), *(rest[-1:] if first == "deflection" else [])])] = None
    return ", ".join(kinds)


CONFIDENCE = 0.95
_BEYOND = 5  # Variants that lie beyond a percentile that is given


@dataclass(frozen=True, kw_only=True)
class Exceedance:
    """Exceedance of a limit."""

    # count, n: variants that exceed it, of how many that could be simulated and have a value
    count: int
    n: int
    # low, high: bounds of the probability at `CONFIDENCE` (Clopper and Pearson 1934), as of random draws; even sampling
    # is rather better than that. They know nothing of variants that failed. The upper one takes those of `early` as
    # beyond.
    low: float
    high: float
    failed: int = 0  # variants that could not be simulated, and are counted nowhere
    # variants among the n whose runs end before their peaks are over, and that keep the limit until then: not judged
    early: int = 0

    @property
    def ratio(self) -> float:
        """Ratio to the counted variants, 0 to 1; NaN if there are none."""
        return self.count / self.n if self.n else math.nan

    @property
    def at_most(self) -> float:
        """Ratio to all variants if every one that is not counted exceeded the limit."""
        total = self.n + self.failed
        return (self.count + self.early + self.failed) / total if total else math.nan

    @property
    def judged(self) -> int:
        """Number of variants that are judged by the limit."""
        return self.n - self.early


def finite(values: Array) -> Array:
    """Return the values without NaN."""
    return values[np.isfinite(values)]


def quantiles(values: Array, probabilities: Sequence[float]) -> list[float]:
    """Return quantiles of values; NaN where fewer than five values lie beyond, too few to tell."""
    known = finite(values)
    beyond = [known.size * min(q, 1.0 - q) for q in probabilities]
    # 50 (1 - 0.9) is a little less than 5 in floating point.
    return [
        float(np.quantile(known, q)) if n >= _BEYOND - 1e-9 else math.nan for q, n in zip(probabilities, beyond, strict=True)
    ]


def exceedance(values: Array, limit: float, *, failed: int = 0, early: int = 0) -> Exceedance:
    """Count the values beyond a limit and bound the probability; `failed` variants and `early` ones are not judged."""
    known = finite(values)
    k, n, tail = int((known > limit).sum()), known.size, (1.0 - CONFIDENCE) / 2.0
    low = float(scipy.stats.beta.ppf(tail, k, n - k + 1)) if k else 0.0
    most = k + early
    high = float(scipy.stats.beta.ppf(1.0 - tail, most + 1, n - most)) if most < n else 1.0
    return Exceedance(count=k, n=n, low=low, high=high, failed=failed, early=early)


def exceedance_of(table: pa.Table, measure: str, limit: float) -> Exceedance:
    """Return the exceedance of a limit by a measure, with the number of variants that failed."""
    return exceedance_in(table, measure, values_of(table, measure), limit)


def exceedance_in(table: pa.Table, measure: str, values: Array, limit: float) -> Exceedance:
    """Return the exceedance of a limit by values of a measure of a table, with how many failed or ended too early."""
    return exceedance(
        values, limit, failed=int(np.count_nonzero(~is_done(table))),
        early=int(np.count_nonzero(ended_early(table, measure) & (values <= limit))),
    )  # fmt: skip


def worst(table: pa.Table, measure: str, count: int) -> list[int]:
    """Return the numbers of the variants with the largest values of a measure, the largest first."""
    values = values_of(table, measure)
    order = np.argsort(-values, kind="stable")  # NaN come last
    numbers = np.asarray(table["variant"])
    return [int(numbers[row]) for row in order[:count] if np.isfinite(values[row])]


def rows_of(table: pa.Table, numbers: Sequence[int]) -> pa.Table:
    """Return the rows of some variants, in this order."""
    return table.take(np.searchsorted(np.asarray(table["variant"]), np.asarray(numbers, dtype=np.int64)))


def row_of(table: pa.Table, number: int) -> Entries:
    return rows_of(table, [number]).to_pylist()[0]


def struck_variants(table: pa.Table) -> int | None:
    """Count the variants in which stops were struck; None for older tables, which do not tell."""
    return int(np.count_nonzero(values_of(table, STRUCK) > 0.0)) if STRUCK in table.column_names else None
