"""The answer of a study in figures, the same wherever it is shown: on the screen, on a page, in pictures."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from wirerope_mj.study.answers.directions import share_of_directions
from wirerope_mj.study.answers.findings import (
    HEADLINES,
    Chance,
    Measure,
    chance,
    checked_measure,
    headlines,
    input_names,
    measure_of,
    percent,
    quantiles,
    random_study,
    row_of,
    values_of,
    worst,
)
from wirerope_mj.study.answers.indices import SobolIndices, drawn, sobol_indices
from wirerope_mj.study.answers.sensitivity import Influence, influences
from wirerope_mj.study.inputs.sobol import SAMPLING
from wirerope_mj.study.result import StudyResult

QUANTILES = (0.5, 0.9, 0.95, 0.99)


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
        if self.beyond is None:
            return ""
        share = "" if self.share is None else f" ({percent(self.share)})"
        return f"{self.beyond.count} of {self.beyond.n}{share}"


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
    def measures(self) -> tuple[Measure, ...]:
        """The measures that are told: `by` first, then those that are looked at first anyway."""
        names = dict.fromkeys([self.by, *headlines(self.result.table)])
        return tuple(measure_of(name) for name in names)

    @cached_property
    def figures(self) -> tuple[Figures, ...]:
        """What is told of each measure."""
        return tuple(self._figures(measure) for measure in self.measures)

    def inputs(self, most: int) -> list[str]:
        """Return the inputs that are told of a variant: the strongest first."""
        strongest = [one.name for one in self.influences]
        return list(dict.fromkeys([*strongest, *input_names(self.result.table)]))[:most]

    def worst(self, count: int, *, inputs: int) -> list[WorstVariant]:
        """Return the variants with the largest values of `by`, and the strongest of their inputs."""
        table, names = self.result.table, self.inputs(inputs)
        found = []
        for number in worst(table, self.by, count):
            row = row_of(table, number)
            values = tuple(measure.factor * row[measure.name] for measure in self.measures)
            found.append(WorstVariant(variant=number, values=values, inputs=tuple(row[name] for name in names)))
        return found

    def _figures(self, measure: Measure) -> Figures:
        table, limit = self.result.table, measure.limit
        values, independent = values_of(table, measure.name), values_of(drawn(self.result), measure.name)
        beyond = None if limit is None else chance(independent, limit)
        share = None
        if beyond is not None and limit is not None and self.drawn:
            share = beyond.count / beyond.n
        elif limit is not None:
            share = share_of_directions(table, input_names(table), values, limit)
        return Figures(
            measure=measure,
            quantiles=tuple(measure.factor * value for value in quantiles(independent, QUANTILES)),
            smallest=measure.factor * float(np.nanmin(values)),
            median=measure.factor * float(np.nanmedian(values)),
            largest=measure.factor * float(np.nanmax(values)),
            variant=worst(table, measure.name, 1)[0],
            limit=None if limit is None else measure.factor * limit,
            beyond=beyond,
            share=share,
        )


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
