"""The pictures that suit a study: by what varies of it, and how it was sampled."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from matplotlib.figure import Figure

from wirerope_mj.studies.inputs.sampling import LISTED
from wirerope_mj.studies.inputs.sobol import SAMPLING
from wirerope_mj.studies.results.directions import AZIMUTH, ELEVATION
from wirerope_mj.studies.results.indices import SobolIndices
from wirerope_mj.studies.results.measure import headlines, input_names, measure_of, values_of
from wirerope_mj.studies.results.statistics import finite
from wirerope_mj.studies.results.study_summary import StudySummary
from wirerope_mj.views.plots.directions import directions_figure
from wirerope_mj.views.plots.study import (
    MOST_SCATTERS,
    choices_figure,
    curve_figure,
    distribution_figure,
    scatter_figure,
    sensitivity_figure,
)
from wirerope_mj.views.plots.study_indices import indices_figure

_MOST_CHOICES = 60  # bars in one picture


@dataclass(frozen=True, kw_only=True)
class StudyPicture:
    """A picture with its file name without ending, and what it shows."""

    name: str
    figure: Figure
    caption: str


def study_pictures(summary: StudySummary) -> list[StudyPicture]:
    """Return the pictures of a study."""
    result, by = summary.result, summary.by
    table = result.independent
    inputs = [name for name in input_names(table) if len(set(table[name].to_pylist())) > 1]
    names = list(dict.fromkeys([by, *headlines(table)]))[:2]
    pictures = []
    if {AZIMUTH, ELEVATION} == set(inputs):
        caption = (
            f"{_capital(measure_of(by).text)} over the direction in which the base is driven first; equal areas are equal "
            "parts of the sphere; the ring is the largest, the line the limit."
        )
        pictures.append(StudyPicture(name="directions", figure=directions_figure(table, by), caption=caption))
    elif len(inputs) == 1:
        pictures += _of_one_input(summary, table, inputs[0], names)
    several = [name for name in names if finite(values_of(table, name)).size > 1]
    if result.is_sampled and several:
        caption = (
            "Fraction of the variants that stay below a value, with percentiles; dashed: the limit. A percentile is named if "
            "at least five variants lie beyond it."
        )
        figure = distribution_figure(table, several, summary.limits)
        pictures.insert(0, StudyPicture(name="distribution", figure=figure, caption=caption))
    if result.study.sampling == SAMPLING:
        pictures += [*_of_indices(summary.indices[:2]), *_scatter(summary, table)]
    elif summary.effects and len(inputs) > 1 and "directions" not in {picture.name for picture in pictures}:
        pictures += [_sensitivity(summary), *_scatter(summary, table)]
    return pictures


def _of_one_input(summary: StudySummary, table: pa.Table, name: str, names: Sequence[str]) -> list[StudyPicture]:
    listed = " and ".join(measure_of(measure).text for measure in names)
    if not pa.types.is_floating(table.schema.field(name).type) and table.num_rows <= _MOST_CHOICES:
        caption = f"{_capital(listed)} for each choice of {name}, sorted; dashed: the limit."
        return [StudyPicture(name="choices", figure=choices_figure(table, name, names), caption=caption)]
    if pa.types.is_string(table.schema.field(name).type):
        return []
    caption = f"{_capital(listed)} over {name}; dashed: the limit."
    return [StudyPicture(name="curve", figure=curve_figure(table, name, names, summary.labels), caption=caption)]


def _of_indices(indices: Sequence[SobolIndices]) -> list[StudyPicture]:
    if not indices:
        return []
    few = any(one.too_few for one in indices)
    caption = (
        "What each factor explains of the variance alone, and with what it does together with others: Sobol's first-order "
        f"and total indices, with intervals of 95 % confidence.{f' {indices[0].rows} base rows are too few.' if few else ''}"
    )
    return [StudyPicture(name="indices", figure=indices_figure(indices), caption=caption)]


def _sensitivity(summary: StudySummary) -> StudyPicture:
    by = summary.by
    caption = (
        f"What each input alone explains of the variance of: {measure_of(by).text}. Blue: it rises with the input; orange: "
        "it falls; grey: the input has no order; pale: not surely above chance."
    )
    return StudyPicture(
        name="sensitivity", figure=sensitivity_figure(summary.effects, by, summary.labels), caption=caption
    )


def _scatter(summary: StudySummary, table: pa.Table) -> list[StudyPicture]:
    numbers = [name for name in summary.ranked_inputs if _is_number(table, name)][:MOST_SCATTERS]
    if not numbers:
        return []
    text = measure_of(summary.by).text
    listed = summary.result.study.sampling in LISTED
    mean = "the mean at each value of the input" if listed else "the mean of variants with like values of the input"
    caption = f"{_capital(text)} of every variant over the strongest inputs; the line is {mean}; dashed: the limit."
    return [
        StudyPicture(name="scatter", figure=scatter_figure(table, numbers, summary.by, summary.labels), caption=caption)
    ]


def _is_number(table: pa.Table, name: str) -> bool:
    return not pa.types.is_string(table.schema.field(name).type) and len(np.unique(np.asarray(table[name]))) > 2


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]
