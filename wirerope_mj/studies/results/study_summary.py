"""The summary of a study: statistics, effects and worst variants, the same on the screen, on a page and in pictures."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wirerope_mj.foundation.arrays import Array, Booleans, Entries
from wirerope_mj.studies.ended import ended_early
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.effects import (
    Effect,
    SobolIndices,
    directions_text,
    effects,
    fraction_of_directions,
    sobol_indices,
)
from wirerope_mj.studies.results.measure import (
    HEADLINES,
    Exceedance,
    Measure,
    checked_measure,
    drawn_measures,
    exceedance,
    exceedance_of,
    headlines,
    input_names,
    is_done,
    measure_of,
    most_critical,
    quantiles,
    rows_of,
    values_of,
    worst,
)
from wirerope_mj.studies.results.varied import StatedLimit, limits_of, read_stated
from wirerope_mj.studies.vary.sampling import OF_INDICES, factors

QUANTILES = (0.5, 0.9, 0.95, 0.99)

_LOAD = "static_load"  # is judged of every study, though shown only where it is exceeded
_PAIR = 2  # columns of a factor that are listed one by one: two angles of a direction


@dataclass(frozen=True, kw_only=True)
class Statistics:
    """Statistics of one measure, SI."""

    measure: Measure  # with its unit and limit
    nominal: float  # of the system with nothing varied; NaN if that fails
    quantiles: tuple[float, ...]  # at `QUANTILES`; NaN where too few variants lie beyond
    # smallest, median, largest: of all variants
    smallest: float
    median: float
    largest: float
    variant: int  # number of the one with the largest value
    beyond: Exceedance | None  # exceedance of the limit; None without a limit
    ratio: float | None  # of it to all variants if they were sampled, or to all directions if these vary; else None


@dataclass(frozen=True, kw_only=True)
class StudySummary:
    """Summary of a study."""

    result: StudyResult
    by: str  # the measure that is looked at most
    effects: tuple[Effect, ...]  # of the inputs on it, the strongest first
    stated: tuple[StatedLimit, ...] = ()  # limits that somebody stated on this study

    @cached_property
    def indices(self) -> tuple[SobolIndices, ...]:
        """Sobol's indices of the displayed measures; empty unless the study was sampled for indices."""
        if self.result.study.sampling != OF_INDICES:
            return ()
        names = dict.fromkeys([self.by, *drawn_measures(self.result.columns), *self.limits])
        every = (sobol_indices(self.result, name) for name in names)
        return tuple(indices for indices in every if indices.factors)

    @cached_property
    def labels(self) -> dict[str, str]:
        """Names of the inputs with the units of their numbers, by name: "body floor mass [kg]", "motion level [factor]"."""
        return {column.name: column.label for quantity in self.result.study.quantities for column in quantity.columns}

    @cached_property
    def measures(self) -> tuple[Measure, ...]:
        """Measures to be displayed: `by` first, then the headlines of the table, then those with a limit in `limits`."""
        names = dict.fromkeys([self.by, *headlines(self.result.columns), *self.limits])
        return tuple(measure_of(name, self.limits) for name in names)

    @cached_property
    def limits(self) -> dict[str, float]:
        """Limits that were stated on a single measure each, and the smallest on `by`, SI by the measure's name."""
        alone = {limit.measures[0]: limit.limit for limit in reversed(self.stated) if len(limit.measures) == 1}
        return {name: limit for name, limit in limits_of(self.stated).items() if name == self.by} | alone

    @cached_property
    def beyond(self) -> dict[str, Booleans]:
        """Variants beyond each limit, (n,), by its subject: limits of parts, of the model, and stated ones."""
        table = self.result.independent
        limits = {
            statistic.measure.name: statistic.measure for statistic in self.statistics if statistic.measure.limit is not None
        }
        limits.setdefault(_LOAD, measure_of(_LOAD))
        limited = [
            (measure.text, values_of(table, name), measure.limit)
            for name, measure in limits.items()
            if measure.limit is not None
        ]
        limited += [(limit.text, limit.largest(table), limit.limit) for limit in self.stated]
        return {text: values > limit for text, values, limit in limited if np.isfinite(values).any()}

    @property
    def ratio_beyond(self) -> float | None:
        """Fraction of sampled variants, or of all directions where they vary, beyond any limit; else None."""
        done = is_done(self.result.independent)
        return self._ratio(np.where(done, np.any(list(self.beyond.values()), axis=0), np.nan), 0.5)

    @cached_property
    def statistics(self) -> tuple[Statistics, ...]:
        """Statistics of every displayed measure over the independent variants."""
        table, statistics = self.result.independent, []
        for measure in self.measures:
            values, limit = values_of(table, measure.name), measure.limit
            statistics.append(
                Statistics(
                    measure=measure, nominal=self.result.nominal.get(measure.name, np.nan),
                    quantiles=tuple(quantiles(values, QUANTILES)), smallest=float(np.nanmin(values)),
                    median=float(np.nanmedian(values)), largest=float(np.nanmax(values)),
                    variant=worst(table, measure.name, 1)[0],
                    beyond=None if limit is None else exceedance_of(table, measure.name, limit),
                    ratio=None if limit is None else self._ratio(values, limit),
                )
            )  # fmt: skip
        return tuple(statistics)

    @property
    def of_directions(self) -> str:
        """Text that follows a ratio: " of all directions" where it is one of directions; "" where it is one of variants."""
        return "" if self.result.is_sampled else f" of {directions_text(self.result.columns)}"

    @cached_property
    def ranked_inputs(self) -> tuple[str, ...]:
        """Inputs in the order in which a variant's are displayed, the most influential first.

        Of a study for Sobol's indices they are those of the factors with the largest total indices, as long as a factor is one
        number or two. Of others those that certainly matter come first, then what all mounts share, then what each mount has
        of its own: of those that may be chance nobody knows which one is the strongest.
        """
        names = input_names(self.result.columns)
        if self.result.study.sampling == OF_INDICES:
            strong = [names[column] for columns in self._factors.values() if len(columns) <= _PAIR for column in columns]
            return tuple(strong) or tuple(names)
        certain = [effect.name for effect in self.effects if effect.certain]
        uncertain = sorted((effect.name for effect in self.effects if not effect.certain), key=_of_one_mount)
        return tuple(dict.fromkeys([*certain, *uncertain, *sorted(names, key=_of_one_mount)]))

    @cached_property
    def left_out(self) -> tuple[str, ...]:
        """Vector-valued factors whose Sobol indices are not displayed, with their size: "stiffness (16 numbers)"."""
        if self.result.study.sampling != OF_INDICES:
            return ()
        return tuple(f"{name} ({len(columns)} numbers)" for name, columns in self._factors.items() if len(columns) > _PAIR)

    def worst(self, count: int) -> list[Entries]:
        """Return the rows of the variants with the largest values of `by`; for Sobol's indices, of independent ones."""
        table = self.result.independent
        numbers = worst(table, self.by, count)
        rows = rows_of(table, numbers)
        absent = {measure.name for measure in self.measures} - {*table.column_names}
        every = {name: values_of(rows, name).tolist() for name in absent}
        return [row | {name: values[place] for name, values in every.items()} for place, row in enumerate(rows.to_pylist())]

    @cached_property
    def _factors(self) -> dict[str, list[int]]:
        """Indices of the columns of each factor, the one with the largest total index first."""
        columns = factors(self.result.study.quantities)
        order = [factor.name for factor in sobol_indices(self.result, self.by).factors]
        return {name: columns[name] for name in dict.fromkeys([*order, *columns])}

    def _ratio(self, values: Array, limit: float) -> float | None:
        """Return the fraction of sampled variants, or of all directions where they vary, beyond a limit."""
        if self.result.is_sampled:
            return exceedance(values, limit).ratio
        table = self.result.independent
        return fraction_of_directions(table, input_names(table), values, limit)


def any_exceeded(summaries: Sequence[StudySummary]) -> Exceedance:
    """Count the variants beyond any limit of some studies, of those that could be simulated in all."""
    tables = [summary.result.independent for summary in summaries]
    beyond = np.any([mask for summary in summaries for mask in summary.beyond.values()], axis=0)
    done = np.all([is_done(table) for table in tables], axis=0)
    early = np.any([ended_early(table) for table in tables], axis=0) & ~beyond & done
    return exceedance(
        np.where(done, beyond, np.nan), 0.5, failed=int(np.count_nonzero(~done)), early=int(np.count_nonzero(early))
    )


def _of_one_mount(name: str) -> bool:
    """Tell whether an input belongs to a single mount, and not to all that a pattern matches."""
    return name.startswith("mount/") and not set(name) & set("*?,")


def summary_of(result: StudyResult, by: str | None = None) -> StudySummary:
    """Summarise a study by a measure: by default the most critical one, or acceleration without limits.

    ValueError if there is no such measure, or it has no value in any variant; RecordError if the limits that were stated
    cannot be read.
    """
    table, stated = result.columns, read_stated(result)
    critical = most_critical(result.independent, limits_of(stated))
    by = checked_measure(table, by or (critical or (headlines(table) or HEADLINES))[0])
    # Listed inputs go hand in hand: what one of them explains alone means nothing.
    listed = result.study.sampling == "list"
    return StudySummary(
        result=result, by=by, effects=() if listed else effects(result.independent, input_names(table), by),
        stated=stated,
    )  # fmt: skip
