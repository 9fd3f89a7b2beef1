"""The answer of a study in figures, the same wherever it is shown: on the screen, on a page, in pictures."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from wirerope_mj.studies.inputs.nominal import column_label
from wirerope_mj.studies.inputs.sobol import SAMPLING, factors
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.directions import directions_words, share_of_directions
from wirerope_mj.studies.results.findings import (
    HEADLINES,
    Chance,
    Measure,
    chance_of,
    checked_measure,
    headlines,
    input_names,
    measure_of,
    quantiles,
    random_study,
    row_of,
    values_of,
    worst,
)
from wirerope_mj.studies.results.indices import SobolIndices, drawn, sobol_indices
from wirerope_mj.studies.results.sensitivity import Influence, influences
from wirerope_mj.studies.results.sentences import beyond_text

QUANTILES = (0.5, 0.9, 0.95, 0.99)

_PAIR = 2  # columns of a factor that are told one by one: two angles of a direction


@dataclass(frozen=True, kw_only=True)
class Figures:
    """What is told of one measure; numbers are in the unit in which it is shown.

    Attributes:
        measure: which, and how it is shown.
        quantiles: at `QUANTILES`; NaN where too few variants lie beyond.
        smallest, median, largest: of all variants.
        variant: number of the one with the largest value.
        limit: that it must not exceed; None if there is none.
        beyond: how often it does; None without a limit.
        share: that this is of all variants if they were drawn, or of all directions if these vary; None if it is of nothing.
    """

    measure: Measure
    quantiles: tuple[float, ...]
    smallest: float
    median: float
    largest: float
    variant: int
    limit: float | None
    beyond: Chance | None
    share: float | None

    @property
    def beyond_words(self) -> str:
        """How often the limit is exceeded: "88 of 325 (34 %)"; "" without a limit."""
        return "" if self.beyond is None else beyond_text(self.beyond, self.share)


@dataclass(frozen=True, kw_only=True)
class WorstVariant:
    """One of the worst variants.

    Attributes:
        variant: its number.
        values: of the measures that are told, in the unit in which they are shown.
        inputs: values of the inputs that are told.
    """

    variant: int
    values: tuple[float, ...]
    inputs: tuple[Any, ...]


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a study answers.

    Attributes:
        result: of the study.
        by: the measure that is looked at most.
        influences: what the inputs do to it, the strongest first.
    """

    result: StudyResult
    by: str
    influences: tuple[Influence, ...]

    @property
    def drawn(self) -> bool:
        """Whether the variants were drawn, so that shares of them are probabilities."""
        return random_study(self.result)

    @cached_property
    def indices(self) -> tuple[SobolIndices, ...]:
        """Sobol's indices of the measures that are told; of a study that was not sampled for them, none."""
        if self.result.study.sampling != SAMPLING:
            return ()
        return tuple(found for one in self.measures if (found := sobol_indices(self.result, one.name)).factors)

    @cached_property
    def labels(self) -> dict[str, str]:
        """Names of the inputs with the units of their numbers, by name: "body/floor/mass [kg]", "motion/level [factor]"."""
        columns = [column for quantity in self.result.study.quantities for column in quantity.columns]
        return {column.name: column_label(column) for column in columns}

    @cached_property
    def measures(self) -> tuple[Measure, ...]:
        """The measures that are told: `by` first, then those that are looked at first anyway."""
        names = dict.fromkeys([self.by, *headlines(self.result.table)])
        return tuple(measure_of(name) for name in names)

    @cached_property
    def figures(self) -> tuple[Figures, ...]:
        """What is told of each measure."""
        return tuple(self._figures(measure) for measure in self.measures)

    @property
    def share_words(self) -> str:
        """Of what a share is, behind its figure: " of all directions"; "" of variants."""
        return "" if self.drawn else f" of {directions_words(self.result.table)}"

    @cached_property
    def shown_inputs(self) -> tuple[str, ...]:
        """The inputs in the order in which they are told of a variant, those that matter most first.

        Of a study for Sobol's indices they are those of the factors with the largest total indices, as long as a factor is one
        number or two. Of others those that certainly matter come first, then what all mounts share, then what each mount has
        of its own: of those that may be chance nobody knows which one is the strongest.
        """
        names = input_names(self.result.table)
        if self.result.study.sampling == SAMPLING:
            strong = [names[place] for places in self._factors.values() if len(places) <= _PAIR for place in places]
            return tuple(strong) or tuple(names)
        certain = [one.name for one in self.influences if one.certain]
        others = sorted((one.name for one in self.influences if not one.certain), key=_of_one_mount)
        return tuple(dict.fromkeys([*certain, *others, *sorted(names, key=_of_one_mount)]))

    @cached_property
    def left_out(self) -> tuple[str, ...]:
        """Factors of Sobol's indices that are many numbers, of which no single one is told: "stiffness (16 numbers)"."""
        if self.result.study.sampling != SAMPLING:
            return ()
        many = {name: len(places) for name, places in self._factors.items() if len(places) > _PAIR}
        return tuple(f"{name} ({count} numbers)" for name, count in many.items())

    def inputs(self, most: int) -> list[str]:
        """Return the inputs that are told of a variant: the strongest first."""
        return list(self.shown_inputs[:most])

    def worst(self, count: int, *, inputs: int) -> list[WorstVariant]:
        """Return the variants with the largest values of `by`, and the strongest of their inputs.

        Of a study for Sobol's indices they are those that were drawn for themselves: the others repeat them but for one factor.
        """
        table, names = drawn(self.result), self.inputs(inputs)
        found = []
        for number in worst(table, self.by, count):
            row = row_of(table, number)
            values = tuple(measure.factor * row[measure.name] for measure in self.measures)
            found.append(WorstVariant(variant=number, values=values, inputs=tuple(row[name] for name in names)))
        return found

    @cached_property
    def _factors(self) -> dict[str, list[int]]:
        """Places of the columns of each factor of Sobol's indices, the one with the largest total index first."""
        places = factors(self.result.study.quantities)
        order = [one.name for one in sobol_indices(self.result, self.by).factors]
        return {name: places[name] for name in dict.fromkeys([*order, *places])}

    def _figures(self, measure: Measure) -> Figures:
        table, limit = drawn(self.result), measure.limit
        values = values_of(table, measure.name)
        beyond = None if limit is None else chance_of(table, measure.name, limit)
        share = None
        if beyond is not None and limit is not None and self.drawn:
            share = beyond.share
        elif limit is not None:
            share = share_of_directions(table, input_names(table), values, limit)
        return Figures(
            measure=measure,
            quantiles=tuple(measure.factor * value for value in quantiles(values, QUANTILES)),
            smallest=measure.factor * float(np.nanmin(values)),
            median=measure.factor * float(np.nanmedian(values)),
            largest=measure.factor * float(np.nanmax(values)),
            variant=worst(table, measure.name, 1)[0],
            limit=None if limit is None else measure.factor * limit,
            beyond=beyond,
            share=share,
        )


def _of_one_mount(name: str) -> bool:
    """Return whether an input is that of a single mount, as each has one of its own."""
    return name.startswith("mount/") and not set(name) & set("*?,")


def answer_of(result: StudyResult, by: str | None = None) -> Answer:
    """Return what a study answers.

    Args:
        result: of the study.
        by: measure that is looked at most; None: travel if anything is rated, else acceleration.

    Raises:
        ValueError: there is no such measure, or it has no value in any variant.
    """
    table = result.table
    by = checked_measure(table, by or (headlines(table) or HEADLINES)[0])
    # Listed inputs go hand in hand: what one of them explains alone means nothing.
    found = () if result.study.sampling == "list" else influences(drawn(result), input_names(table), by)
    return Answer(result=result, by=by, influences=found)
