"""What a study says: how its measures are distributed, how likely a limit is exceeded, and the worst variants."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from scipy.stats import beta

from wirerope_mj.study.answers.directions import AZIMUTH, ELEVATION, share_of_directions
from wirerope_mj.study.answers.indices import SobolIndices, drawn, sobol_indices
from wirerope_mj.study.answers.places import beyond_words, inputs_words
from wirerope_mj.study.engines.compute import DONE
from wirerope_mj.study.inputs.sampling import LISTED
from wirerope_mj.study.inputs.sobol import SAMPLING
from wirerope_mj.study.inputs.specimens import specimen_sentences
from wirerope_mj.study.result import StudyResult
from wirerope_mj.units import shown_in

Array = npt.NDArray[np.float64]

HEADLINES = ("travel", "acceleration", "fragility")
"""Measures that are looked at first, in this order."""

CONFIDENCE = 0.95

SLIGHT = 0.01
"""Total index below which a factor is only named."""

_KEPT = ("variant", "status", "message", "generation")
_ANGLES = (AZIMUTH, ELEVATION)
_ROOMS = {
    "travel": ("share of the rated travel", "%", 100.0, 1.0),
    "acceleration": ("largest acceleration", *shown_in("m/s^2"), None),
    "fragility": ("share of the stated acceleration limit", "%", 100.0, 1.0),
    "mounts": ("number of mounts that act", "-", 1.0, None),
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
        count, n: variants that exceed it, of how many.
        low, high: bounds of the probability at `CONFIDENCE` (Clopper and Pearson 1934), as of random draws; even sampling is
            rather better than that.
    """

    count: int
    n: int
    low: float
    high: float


def measure_of(name: str) -> Measure:
    """Return how a column of measures is shown."""
    room, _, rest = name.partition("/")
    words, unit, factor, limit = _ROOMS[room]
    return Measure(name=name, words=f"{words}, {rest}" if rest else words, unit=unit, factor=factor, limit=limit)


def input_names(table: pa.Table) -> list[str]:
    """Return the names of the columns that were sampled."""
    names = table.column_names
    return names[1 : names.index("acceleration")]


def input_label(name: str) -> str:
    """Return the name of an input with the unit of its values, where the name alone says it."""
    unit = "m" if "/centre/" in name or "/position/" in name else "°" if name in _ANGLES else ""
    return f"{name} [{unit}]" if unit else name


def measures_of(table: pa.Table) -> list[str]:
    """Return the names of the measures of a table."""
    first = table.column_names.index("acceleration")
    return [name for name in table.column_names[first:] if name not in _KEPT]


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
    """Return quantiles; NaN for those beyond which fewer than five variants lie: nobody knows them."""
    known = finite(values)
    return [float(np.quantile(known, q)) if known.size * (1.0 - q) >= 5.0 else math.nan for q in shares]


def chance(values: Array, limit: float) -> Chance:
    """Return how often values are beyond a limit."""
    known = finite(values)
    k, n, tail = int((known > limit).sum()), known.size, (1.0 - CONFIDENCE) / 2.0
    low = float(beta.ppf(tail, k, n - k + 1)) if k else 0.0
    high = float(beta.ppf(1.0 - tail, k + 1, n - k)) if k < n else 1.0
    return Chance(count=k, n=n, low=low, high=high)


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


def random_study(result: StudyResult) -> bool:
    """Return whether the variants were drawn, so that shares of them are probabilities."""
    return result.study.sampling not in LISTED


def percent(share: float) -> str:
    """Return a probability in per cent, to two digits."""
    value = 100.0 * share
    return (
        f"{value:.0f} %" if value >= 9.95 or value == 0.0 else f"{value:.1f} %" if value >= 0.095 else f"{value:.2g} %"
    )


def sentences(result: StudyResult) -> list[str]:
    """Return what the study answers, a sentence for every measure with a limit."""
    table, found = result.table, []
    independent = drawn(result)
    for name in headlines(table):
        measure = measure_of(name)
        if measure.limit is None:
            continue
        beyond, top = chance(values_of(independent, name), measure.limit), worst(table, name, 1)[0]
        largest = f"the largest is {measure.factor * np.nanmax(values_of(table, name)):.3g} % in variant {top}"
        if not random_study(result):
            inputs, values = input_names(table), values_of(table, name)
            part = share_of_directions(table, inputs, values, measure.limit)
            where = beyond_words(table, inputs, values, measure.limit)
            where += "" if part is None else f", {percent(part)} of all directions"
            largest += inputs_words(row_of(table, top), inputs)
            found.append(f"{_what(measure)}: beyond 100 % in {beyond.count} of {beyond.n} variants{where}; {largest}.")
            continue
        bounds = f"{percent(beyond.low)} to {percent(beyond.high)} at {percent(CONFIDENCE)} confidence"
        of = f"{beyond.n} {'' if independent is table else 'independent '}variants"
        share = percent(beyond.count / beyond.n)
        found.append(f"{_what(measure)}: beyond 100 % in {beyond.count} of {of}, {share} ({bounds}); {largest}.")
    if not found:
        found.append("Nothing is judged: the isolators state no rated travel and the model no limit.")
    found += specimen_sentences(result.study.quantities)
    if result.study.sampling == SAMPLING:
        every = (sobol_indices(result, name) for name in headlines(table))
        found += [_of_indices(one) for one in every if one.factors]
    return found


def _of_indices(found: SobolIndices) -> str:
    """Return what the factors explain of a measure as a sentence."""
    first, *others = found.factors
    low, high = (100.0 * max(end, 0.0) for end in first.total_interval)
    parts = [
        f"{first.name} explains {_share(first.first)} of its variance alone, {_share(first.total)} with what it does together "
        f"with others ({low:.0f} to {high:.0f} % at {percent(CONFIDENCE)} confidence)"
    ]
    parts += [f"{one.name} {_share(one.first)} and {_share(one.total)}" for one in others if one.total >= SLIGHT]
    slight = [one.name for one in others if one.total < SLIGHT]
    if slight:
        parts.append(f"less than {percent(SLIGHT)}: {', '.join(slight)}")
    dropped = f" {found.dropped} of {found.rows + found.dropped} base rows were dropped: variants of them failed."
    return f"{_what(measure_of(found.measure))}: {'; '.join(parts)}.{dropped if found.dropped else ''}"


def _share(index: float) -> str:
    return f"{100.0 * max(index, 0.0):.0f} %"


def _what(measure: Measure) -> str:
    return measure.words[0].upper() + measure.words[1:]
