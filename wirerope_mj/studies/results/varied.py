"""The summary of a study as a file: what varied, statistics, and limits that are stated after the fact on measures of it."""

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
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.folder import SUMMARY
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.effects import sobol_indices
from wirerope_mj.studies.results.measure import (
    ALL,
    CONFIDENCE,
    Exceedance,
    exceedance_in,
    exceedance_of,
    finite,
    known_measures,
    measure_of,
    measures_of,
    quantiles,
    struck_variants,
    unknown_measure,
    values_of,
    worst,
)
from wirerope_mj.studies.vary.distributions import Choice, Distribution, Isotropic, Normal, Specimens, Uniform
from wirerope_mj.studies.vary.quantity import nominal_text
from wirerope_mj.studies.vary.sampling import LISTED, OF_INDICES

_CHOICES = 8  # numbers of a choice that are listed one by one


@dataclass(frozen=True, kw_only=True)
class Varied:
    """One quantity that varies."""

    name: str  # as `vary` says it
    kind: str  # of its numbers: "value", "shift", "factor", "index" or "choice"
    unit: str  # of its numbers; "" without one, "SI" as the law states
    # what the model says, as text: for a shift the position that is shifted, for a factor what it multiplies
    model: str
    nominal: tuple[float, ...]  # the smallest and the largest number that the model says; empty if it says none
    nominal_unit: str  # of these; "SI" as the law states
    distribution: Distribution

    @property
    def distribution_text(self) -> str:
        return distribution_text(self.distribution)

    def to_dict(self) -> Entries:
        """Return the entry for `summary.json`."""
        content: Entries = {"name": self.name, "kind": self.kind}
        if self.unit:
            content["unit"] = self.unit
        if self.nominal:
            low, high = self.nominal
            content["nominal"] = low if low == high else [low, high]
            content |= {"nominal_unit": self.nominal_unit} if self.nominal_unit else {}
        return {**content, "distribution": self.distribution_text}


def varied_of(study: StudyDefinition) -> list[Varied]:
    """Return the varied quantities of a study, in the order of `vary`."""
    varied = []
    for quantity in study.quantities:
        column = quantity.columns[0]
        many = isinstance(quantity.distribution, Specimens)  # of which many parameters vary, each about its own value
        every = [] if many else [number for column in quantity.columns for number in column.nominal(study.base, study.motions)]
        numbers = np.concatenate([np.ravel(numbers_of_column) for numbers_of_column in every]) if every else np.empty(0)
        ends = () if numbers.size == 0 or numbers.dtype == np.bool_ else (float(numbers.min()), float(numbers.max()))
        kind, text = column.nature, nominal_text(every, column.model_unit)
        model = "the isolator's" if many else f"shifted from {text}" if kind == "shift" else text
        varied.append(
            Varied(
                name=quantity.name, kind=kind, unit=column.unit, model=model, nominal=ends, nominal_unit=column.model_unit,
                distribution=quantity.distribution,
            )
        )  # fmt: skip
    return varied


def distribution_text(distribution: Distribution) -> str:
    """Describe a distribution: "normal, mean 1, standard deviation 0.1"."""
    if isinstance(distribution, Normal):
        ends = [f"{bound} {end:g}" for bound, end in (("from", distribution.low), ("to", distribution.high)) if end is not None]
        bounds = f", {' '.join(ends)}" if ends else ""
        return f"normal, mean {distribution.mean:g}, standard deviation {distribution.deviation:g}{bounds}"
    if isinstance(distribution, Uniform):
        points = f", {distribution.points} values" if distribution.points is not None else ""
        return f"uniform, from {distribution.low:g} to {distribution.high:g}{points}"
    if isinstance(distribution, Isotropic):
        between = f"from {distribution.low:g} to {distribution.high:g}"
        return f"directions equally likely over the sphere, {between} above the horizon"
    if isinstance(distribution, Choice):
        distinct = list(dict.fromkeys(distribution.choices))
        if len(distinct) <= _CHOICES or not all(isinstance(value, int | float) for value in distinct):
            return f"one of {', '.join(map(value_text, distinct))}"
        return f"one of {len(distinct)} values from {value_text(min(distinct))} to {value_text(max(distinct))}"
    return "scatter that the isolator's file states"


def value_text(value: object) -> str:
    """Format the value of an input; "none" where no mount fails."""
    return f"{value:.4g}" if isinstance(value, float) else str(value) or "none"


# Measures in the summary.
SUMMARISED = ("acceleration", ALL, "travel", "combined_travel", "static_load", "fragility", "clearance")
_QUANTILES = {"q05": 0.05, "median": 0.5, "q95": 0.95}


def summary(result: StudyResult) -> Entries:
    """Return the statistics of a study's measures, SI.

    Of each measure the nominal system's value. Of sampled variants, percentiles beyond which at least five variants lie, and
    the probability beyond the limit with its bounds; in a study for Sobol's indices these, too; of listed variants the
    smallest, the median and the largest value.
    """
    nominal, method, table = result.nominal, result.inputs["sampling"]["method"], result.independent
    measures: Entries = {}
    for name in known_measures(table, SUMMARISED):
        measures[name] = {"nominal": nominal[name]} if name in nominal else {}
        sampled = method not in LISTED
        values, limit = finite(values_of(table, name)), measure_of(name).limit
        content: Entries = {"smallest": float(values.min()), "median": float(np.median(values))}
        if sampled:
            each = zip(_QUANTILES, quantiles(values, list(_QUANTILES.values())), strict=True)
            content = {name: value for name, value in each if np.isfinite(value)}
        content |= {"largest": float(values.max()), "variant": worst(table, name, 1)[0]}
        if limit is not None:
            beyond = exceedance_of(table, name, limit)
            content |= {"limit": limit, "beyond": beyond.count, "of": beyond.n}
            content |= {"ended_early": beyond.early} if beyond.early else {}
            if sampled:
                content |= {"probability": beyond.ratio, "low": beyond.low, "high": beyond.high, "confidence": CONFIDENCE}
        measures[name] |= content
        if method == OF_INDICES:
            sobol = sobol_indices(result, name)
            indices = {
                factor.name: {
                    "first": factor.first, "first_interval": list(factor.first_interval),
                    "total": factor.total, "total_interval": list(factor.total_interval),
                }
                for factor in sobol.factors
            }  # fmt: skip
            counts = {"base_rows": sobol.rows, "dropped_rows": sobol.dropped}
            measures[name] |= counts | {"indices": indices} if indices else {}
    struck = struck_variants(result.columns)
    return {**head(result), **({} if struck is None else {"struck": struck}), "measures": measures}


def head(result: StudyResult) -> Entries:
    """Return the entries with which summaries of studies and searches begin."""
    return {
        "format": result.inputs["format"], "name": result.inputs["name"], "id": result.inputs["id"],
        "variants": result.columns.num_rows, "failed": len(result.failed),
        "timestep_s": result.inputs["simulate"]["timestep"],
        "varied": [quantity.to_dict() for quantity in varied_of(result.study)],
    }  # fmt: skip


_UNITS = {
    "acceleration": ACCELERATION_UNITS, "deflection": LENGTH_UNITS, "displacement": LENGTH_UNITS, "force": FORCE_UNITS,
    "load": FORCE_UNITS, "travel": {"%": 0.01}, "combined_travel": {"%": 0.01}, "static_load": {"%": 0.01},
    "fragility": {"%": 0.01}, "clearance": {"%": 0.01},
}  # fmt: skip
KEY = "stated_limits"  # Of the list in `summary.json`; it is not there unless somebody has stated a limit
_KIND = "the summary of a study"
_REMEDY = "Remove the file, and go on with --resume (`resume=True`): it is written anew."
_EXAMPLE = '"deflection/*/roll = 35 mm"'


@dataclass(frozen=True, kw_only=True)
class StatedLimit:
    """A limit that a user states on a computed study: on the largest of some measures."""

    text: str  # as it was written
    measures: tuple[str, ...]  # columns of the table, at least one
    limit: float  # SI

    def exceedance(self, table: pa.Table) -> Exceedance:
        return exceedance_in(table, self.measures[0], self.largest(table), self.limit)

    def largest(self, table: pa.Table) -> Array:
        """Return the largest of the measures of each variant, SI, (n,); NaN where none has a value."""
        return np.asarray(np.fmax.reduce([values_of(table, name) for name in self.measures]))


def limit_of_text(text: str, known: Sequence[str]) -> StatedLimit:
    """Parse a limit such as `deflection/*/roll = 35 mm`.

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
    every = sorted(((limit.limit, name) for limit in stated for name in limit.measures), reverse=True)
    return {name: limit for limit, name in every}


def write_stated(result: StudyResult, limits: Sequence[StatedLimit]) -> None:
    """Write how often limits are exceeded into the summary of a study; limits stated before are replaced.

    RecordError if the summary is damaged.
    """
    entries = []
    for limit in limits:
        beyond = limit.exceedance(result.independent)
        content: Entries = {
            "text": limit.text, "measures": list(limit.measures), "limit": limit.limit,
            "beyond": beyond.count, "of": beyond.n, "failed": beyond.failed,
        }  # fmt: skip
        content |= {"ended_early": beyond.early} if beyond.early else {}
        if result.is_sampled and beyond.n:  # else it is no probability
            content |= {"probability": beyond.ratio, "low": beyond.low, "high": beyond.high, "confidence": CONFIDENCE}
        entries.append(content)
    write_json(result.folder / SUMMARY, read_json(result.folder / SUMMARY, _KIND, _REMEDY) | {KEY: entries})


def read_stated(result: StudyResult) -> tuple[StatedLimit, ...]:
    """Read the limits in the summary of a study; empty if there is no summary yet.

    RecordError if the summary is damaged.
    """
    path = result.folder / SUMMARY
    if not path.is_file():
        return ()
    stated = read_json(path, _KIND, _REMEDY).get(KEY, [])
    try:
        return tuple(limit_of_text(limit["text"], measures_of(result.columns)) for limit in stated)
    except (KeyError, TypeError, ValueError) as error:
        raise RecordError(f"{path}: `{KEY}` is not what was written: {error} {_REMEDY}") from None
