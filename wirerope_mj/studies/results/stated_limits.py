"""Limits that are stated after the fact, on one measure of a study or on all that a pattern matches, kept in `summary.json`."""

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.atomic_files import write_json
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.quantities import values_with_unit
from wirerope_mj.foundation.toml_file import read_json
from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, LENGTH_UNITS
from wirerope_mj.studies.folder import SUMMARY
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import CONFIDENCE, Exceedance, exceedance_in, measures_of, unknown_measure, values_of

_UNITS = {
    "acceleration": ACCELERATION_UNITS, "deflection": LENGTH_UNITS, "displacement": LENGTH_UNITS, "force": FORCE_UNITS,
    "travel": {"%": 0.01}, "combined_travel": {"%": 0.01}, "static_load": {"%": 0.01}, "fragility": {"%": 0.01},
    "clearance": {"%": 0.01},
}  # fmt: skip
KEY = "stated_limits"  # Of the list in `summary.json`; it is not there unless somebody has stated a limit
_KIND = "the summary of a study"
_REMEDY = "Remove the file, and go on with --resume (`resume=True`): it is written anew."
_EXAMPLE = '"deflection/*/roll = 35 mm"'


@dataclass(frozen=True, kw_only=True)
class StatedLimit:
    """A limit on the largest of some measures."""

    text: str  # as it was written
    measures: tuple[str, ...]  # columns of the table, at least one
    limit: float  # SI

    def exceedance(self, table: pa.Table) -> Exceedance:
        return exceedance_in(table, self.measures[0], self.largest(table), self.limit)

    def largest(self, table: pa.Table) -> Array:
        """Return the largest of the measures of each variant, SI, (n,); NaN where none has a value."""
        return np.asarray(np.fmax.reduce([values_of(table, name) for name in self.measures]))


def limit_of_text(text: str, known: Sequence[str]) -> StatedLimit:
    """Return the limit of a text such as `deflection/*/roll = 35 mm`.

    ValueError if the text is no limit, or there is no such measure among those that are known.
    """
    pattern, _, said = (part.strip() for part in text.rpartition("="))
    if not pattern or not said:
        raise ValueError(f"a limit of a study is written like {_EXAMPLE}; got {short(text)!r}.")
    quantity = pattern.partition("/")[0]
    names = tuple(name for name in known if fnmatchcase(name, pattern))
    if not names:
        raise ValueError(f"limit {short(text)!r}: {unknown_measure(pattern, known)}")
    try:
        limit, *more = values_with_unit(said, quantity, _UNITS.get(quantity, {}))
        if more:
            raise ValueError(f"one number must stand there, got {len(more) + 1}.")
    except ValueError as error:
        raise ValueError(f"limit {short(text)!r}: {error} It is written like {_EXAMPLE}.") from None
    return StatedLimit(text=text, measures=names, limit=limit)


def limits_of(stated: Sequence[StatedLimit]) -> dict[str, float]:
    """Return the smallest limit that was stated on each measure, SI by its name."""
    every = sorted(((one.limit, name) for one in stated for name in one.measures), reverse=True)
    return {name: limit for limit, name in every}


def write_stated(result: StudyResult, limits: Sequence[StatedLimit]) -> None:
    """Write how often limits are exceeded into the summary of a study, in place of those that were stated before.

    RecordError if the summary is damaged.
    """
    entries = []
    for one in limits:
        beyond = one.exceedance(result.independent)
        content: Entries = {
            "text": one.text, "measures": list(one.measures), "limit": one.limit,
            "beyond": beyond.count, "of": beyond.n, "failed": beyond.failed,
        }  # fmt: skip
        content |= {"ended_early": beyond.early} if beyond.early else {}
        if result.is_sampled and beyond.n:  # else it is no probability
            content |= {"probability": beyond.ratio, "low": beyond.low, "high": beyond.high, "confidence": CONFIDENCE}
        entries.append(content)
    write_json(result.folder / SUMMARY, read_json(result.folder / SUMMARY, _KIND, _REMEDY) | {KEY: entries})


def read_stated(result: StudyResult) -> tuple[StatedLimit, ...]:
    """Return the limits that stand in the summary of a study; nothing if there is no summary yet.

    RecordError if the summary is damaged.
    """
    path = result.folder / SUMMARY
    if not path.is_file():
        return ()
    stated = read_json(path, _KIND, _REMEDY).get(KEY, [])
    try:
        return tuple(limit_of_text(one["text"], measures_of(result.table)) for one in stated)
    except (KeyError, TypeError, ValueError) as error:
        raise RecordError(f"{path}: `{KEY}` is not what was written: {error} {_REMEDY}") from None
