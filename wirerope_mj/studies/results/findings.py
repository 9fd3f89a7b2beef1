"""What a study says: how its measures are distributed, how likely a limit is exceeded, and the worst variants."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from scipy.stats import beta

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import shown_in
from wirerope_mj.studies.engines.compute import DONE
from wirerope_mj.studies.inputs.sampling import LISTED

if TYPE_CHECKING:
    from wirerope_mj.studies.result import StudyResult


HEADLINES = ("travel", "acceleration", "fragility")
"""Measures that are looked at first, in this order."""

CONFIDENCE = 0.95

STRUCK = "struck"
"""Column of the number of stops that were struck."""

_BEYOND = 5
"""Variants that lie beyond a percentile that is given."""

_KEPT = ("variant", "status", "message", "generation")
_FIGURE = re.compile(r"\d[\d.]*(e[+-]?\d+)?")
_NUMBERED = 6  # variants of one message that are told by their numbers
_ROOMS = {
    "travel": ("largest share of a rated travel along one axis", "%", 100.0, 1.0),
    "acceleration": ("largest acceleration", *shown_in("m/s^2"), None),
    "static_load": ("share of the rated static load", "%", 100.0, 1.0),
    "fragility": ("share of the stated acceleration limit", "%", 100.0, 1.0),
    "mounts": ("number of mounts that act", "-", 1.0, None),
    "struck": ("number of stops struck", "-", 1.0, None),
    "deflection": ("largest deflection", *shown_in("m"), None),
    "displacement": ("largest displacement relative to the base", *shown_in("m"), None),
    "force": ("largest force", *shown_in("N"), None),
}


@dataclass(frozen=True, kw_only=True)
class Measure:
    """How a measure is shown.

    Attributes:
        name: column of the table.
        words: what it is, without the unit.
        unit: in which it is shown.
        factor: from SI to this unit.
        limit: that it must not exceed, SI; None if there is none.
    """

    name: str
    words: str
    unit: str
    factor: float
    limit: float | None

    @property
    def label(self) -> str:
        """Words and unit, as an axis says it."""
        return f"{self.words} [{self.unit}]"


@dataclass(frozen=True, kw_only=True)
class Chance:
    """How often a limit was exceeded.

    Attributes:
        count, n: variants that exceed it, of how many that could be simulated and are judged.
        low, high: bounds of the probability at `CONFIDENCE` (Clopper and Pearson 1934), as of random draws; even sampling is
            rather better than that. They know nothing of variants that failed.
        failed: variants that could not be simulated, and are counted nowhere.
    """

    count: int
    n: int
    low: float
    high: float
    failed: int = 0

    @property
    def share(self) -> float:
        """Share of the variants that were counted, 0 to 1; NaN if there are none."""
        return self.count / self.n if self.n else math.nan

    @property
    def at_most(self) -> float:
        """Share of all variants, if every one that failed counted as beyond the limit."""
        return (self.count + self.failed) / (self.n + self.failed) if self.n + self.failed else math.nan


def measure_of(name: str) -> Measure:
    """Return how a column of measures is shown."""
    room, _, rest = name.partition("/")
    words, unit, factor, limit = _ROOMS[room]
    return Measure(name=name, words=f"{words}, {rest}" if rest else words, unit=unit, factor=factor, limit=limit)


def input_names(table: pa.Table) -> list[str]:
    """Return the names of the columns that were sampled."""
    names = table.column_names
    return names[1 : names.index("acceleration")]


def measures_of(table: pa.Table) -> list[str]:
    """Return the names of the measures of a table."""
    first = table.column_names.index("acceleration")
    return [name for name in table.column_names[first:] if name not in _KEPT]


def struck_variants(table: pa.Table) -> int | None:
    """Return in how many variants stops were struck; None of older tables, which do not say it."""
    return int(np.count_nonzero(values_of(table, STRUCK) > 0.0)) if STRUCK in table.column_names else None


def checked_measure(table: pa.Table, name: str) -> str:
    """Return `name`; ValueError names the measures if it is none, or was not judged."""
    names = measures_of(table)
    if name not in names:
        shown = ", ".join(names[:8])
        raise ValueError(f"there is no measure {name!r}; there are {shown}{', ...' if len(names) > 8 else ''}.")
    if not np.isfinite(values_of(table, name)).any():
        raise ValueError(
            f"{name!r} has no value in any variant: nothing is rated or stated by which it would be judged."
        )
    return name


def headlines(table: pa.Table) -> list[str]:
    """Return the measures of `HEADLINES` that have values."""
    return [name for name in HEADLINES if np.isfinite(values_of(table, name)).any()]


def values_of(table: pa.Table, name: str) -> Array:
    """Return a column of measures, NaN where the variant failed or nothing is judged, (n,)."""
    return np.where(np.asarray(table["status"]) == DONE, np.asarray(table[name], dtype=np.float64), np.nan)


def finite(values: Array) -> Array:
    """Return the values without NaN."""
    return values[np.isfinite(values)]


def quantiles(values: Array, shares: Sequence[float]) -> list[float]:
    """Return quantiles; NaN for those beyond which, away from the median, fewer than five variants lie: nobody knows them."""
    known = finite(values)
    beyond = [known.size * min(q, 1.0 - q) for q in shares]
    # 50 (1 - 0.9) is a little less than 5 in floating point.
    return [
        float(np.quantile(known, q)) if n >= _BEYOND - 1e-9 else math.nan for q, n in zip(shares, beyond, strict=True)
    ]


def chance(values: Array, limit: float, *, failed: int = 0) -> Chance:
    """Return how often values are beyond a limit; `failed` more variants have none."""
    known = finite(values)
    k, n, tail = int((known > limit).sum()), known.size, (1.0 - CONFIDENCE) / 2.0
    low = float(beta.ppf(tail, k, n - k + 1)) if k else 0.0
    high = float(beta.ppf(1.0 - tail, k + 1, n - k)) if k < n else 1.0
    return Chance(count=k, n=n, low=low, high=high, failed=failed)


def chance_of(table: pa.Table, measure: str, limit: float) -> Chance:
    """Return how often a measure is beyond a limit, with the number of variants that failed."""
    return chance(values_of(table, measure), limit, failed=int(np.count_nonzero(np.asarray(table["status"]) != DONE)))


def worst(table: pa.Table, measure: str, count: int) -> list[int]:
    """Return the numbers of the variants with the largest values of a measure, the largest first."""
    values = values_of(table, measure)
    order = np.argsort(-values, kind="stable")  # NaN come last
    numbers = np.asarray(table["variant"])
    return [int(numbers[place]) for place in order[:count] if np.isfinite(values[place])]


def row_of(table: pa.Table, number: int) -> dict[str, Any]:
    """Return the row of a variant."""
    place = int(np.flatnonzero(np.asarray(table["variant"]) == number)[0])
    return table.slice(place, 1).to_pylist()[0]


def random_study(result: "StudyResult") -> bool:
    """Return whether the variants were drawn, so that shares of them are probabilities."""
    return result.study.sampling not in LISTED


def percent(share: float) -> str:
    """Return a probability in per cent, to two digits."""
    value = 100.0 * share
    return (
        f"{value:.0f} %" if value >= 9.95 or value == 0.0 else f"{value:.1f} %" if value >= 0.095 else f"{value:.2g} %"
    )


def failures(result: "StudyResult") -> dict[str, list[int]]:
    """Return the messages of the variants that failed with their numbers; of those that differ in figures alone the first."""
    found: dict[str, list[int]] = {}
    first: dict[str, str] = {}
    for number, message in result.failed.items():
        found.setdefault(first.setdefault(_FIGURE.sub("", message), message), []).append(number)
    return found


def numbered(numbers: Sequence[int], thing: str = "variant") -> str:
    """Return which variants there are, for a message: "variant 3", or "17 variants (3, 8, 9, ...)"."""
    if len(numbers) == 1:
        return f"{thing} {numbers[0]}"
    shown = ", ".join(map(str, numbers[:_NUMBERED])) + (", ..." if len(numbers) > _NUMBERED else "")
    return f"{len(numbers)} {thing}s ({shown})"
