"""Limits that somebody states after the fact, on one measure of a study or on all that a pattern matches."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, LENGTH_UNITS, in_si
from wirerope_mj.studies.results.measure import values_of
from wirerope_mj.studies.results.statements import not_counted, percent
from wirerope_mj.studies.results.statistics import CONFIDENCE, Exceedance, exceedance_in
from wirerope_mj.studies.unknown_measure import unknown_measure

_UNITS = {
    "acceleration": ACCELERATION_UNITS, "deflection": LENGTH_UNITS, "displacement": LENGTH_UNITS, "force": FORCE_UNITS,
    "travel": {"%": 0.01}, "static_load": {"%": 0.01}, "fragility": {"%": 0.01},
    "clearance": {"%": 0.01},
}  # fmt: skip
_EXAMPLE = '"deflection/*/roll = 35 mm"'
_TEXT = re.compile(r"\s*(\S+)\s*=\s*([-+.\deE]+)\s*([^\d\s.+-]\S*)\s*")


@dataclass(frozen=True, kw_only=True)
class StatedLimit:
    """A limit on the largest of some measures.

    Attributes:
        text: as it was written.
        measures: columns of the table, at least one.
        limit: SI.
    """

    text: str
    measures: tuple[str, ...]
    limit: float

    def exceedance(self, table: pa.Table) -> Exceedance:
        """Return how often any of the measures is beyond the limit."""
        return exceedance_in(table, self.measures[0], self.largest(table), self.limit)

    def largest(self, table: pa.Table) -> Array:
        """Return the largest of the measures of each variant, SI, (n,); NaN where none has a value."""
        return np.asarray(np.fmax.reduce([values_of(table, name) for name in self.measures]))


def matching_measures(pattern: str, known: Sequence[str]) -> tuple[str, ...]:
    """Return the measures that a pattern with * and ? matches; ValueError if there is none."""
    names = tuple(name for name in known if fnmatchcase(name, pattern))
    if not names:
        raise ValueError(unknown_measure(pattern, known))
    return names


def limit_of_text(text: str, known: Sequence[str]) -> StatedLimit:
    """Return the limit of a text such as `deflection/*/roll = 35 mm`.

    Raises:
        ValueError: the text is no limit, or there is no such measure among those that are known.
    """
    match = _TEXT.fullmatch(text)
    if match is None:
        raise ValueError(f"a limit of a study is written like {_EXAMPLE}; got {short(text)!r}.")
    pattern, number, unit = match.groups()
    quantity = pattern.partition("/")[0]
    try:
        names = matching_measures(pattern, known)
    except ValueError as error:
        raise ValueError(f"limit {short(text)!r}: {error}") from None
    units = _UNITS.get(quantity, {})
    if unit not in units:
        raise ValueError(
            f"limit {short(text)!r}: {unit!r} is no unit of {quantity}; known are {', '.join(units) or 'none'}."
        )
    try:
        value = in_si(float(number), units[unit])
        return StatedLimit(text=text, measures=names, limit=value)
    except ValueError as error:
        raise ValueError(f"limit {short(text)!r}: {error}") from None


def limit_statement(stated: StatedLimit, table: pa.Table, *, sampled: bool) -> str:
    """Return in one sentence how often a limit is exceeded; bounds of the probability where variants are a sample."""
    beyond = stated.exceedance(table)
    several = f", any of {len(stated.measures)}" if len(stated.measures) > 1 else ""
    failed = not_counted(beyond)
    if not beyond.judged:
        why = "every run ends before its peaks are over" if beyond.n else "nothing has a value"
        return f"Beyond {stated.text}: not judged, since {why}{failed}."
    start = f"Beyond {stated.text}{several}: {beyond.count} of {beyond.n} variants"
    if not sampled:
        return f"{start}{failed}."
    bounds = f"{percent(beyond.low)} to {percent(beyond.high)} at {percent(CONFIDENCE)} confidence"
    return f"{start}, {percent(beyond.ratio)} ({bounds}){failed}."
