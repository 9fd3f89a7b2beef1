"""Texts on the results of a study: exceedances, failures, early ends, and variance explained by the inputs."""

import math
import re
from collections.abc import Mapping, Sequence

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.mounts.isolator.travel import RATINGS
from wirerope_mj.studies.ended import ended_early, still_growing, why_early
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.effects import SobolIndices, directions_text, fraction_of_directions, sobol_indices
from wirerope_mj.studies.results.measure import (
    COMBINED,
    CONFIDENCE,
    Exceedance,
    Measure,
    drawn_measures,
    exceedance_of,
    headlines,
    input_names,
    measure_of,
    row_of,
    struck_variants,
    values_of,
    worst,
)
from wirerope_mj.studies.results.varied import StatedLimit, value_text
from wirerope_mj.studies.vary.sampling import OF_INDICES, specimen_messages

_NUMBER = re.compile(r"\d[\d.]*(e[+-]?\d+)?")
_NUMBERED = 6  # variants of one message that are listed by their numbers
_CHOICES = 8  # choices that are listed
_INPUTS = 2  # most inputs that are listed with the largest value
SLIGHT = 0.01  # total index below which a factor is listed without it


def statements(result: StudyResult) -> list[str]:
    """Describe the exceedances of each limited measure, with cautions on early ends, stops, travel and sampling."""
    # A mount that keeps its static load is not mentioned.
    overloaded = np.nanmax(values_of(result.columns, "static_load"), initial=0.0) > 1.0
    measures = map(measure_of, [*headlines(result.columns), *(["static_load"] if overloaded else [])])
    texts = [_limit_text(result, measure, measure.limit) for measure in measures if measure.limit is not None]
    if not texts:
        texts.append("The isolators state no rated travel and the model no limit: judged is only what --limit states.")
    texts = [*early_statements(result.columns), *texts, *struck_statements(result.columns)]
    if "travel" in headlines(result.columns) and COMBINED not in result.columns.column_names:  # of an older version
        texts += travel_statements(result.study.base)
    texts += specimen_messages(result.study.quantities)
    if result.study.sampling == OF_INDICES:
        every = (sobol_indices(result, name) for name in drawn_measures(result.columns))
        texts += [of_indices(indices) for indices in every if indices.factors]
    return texts


def percent(probability: float) -> str:
    """Write a probability in percent, with more digits the smaller it is."""
    value = 100.0 * probability
    return f"{value:.0f} %" if value >= 9.95 or value == 0.0 else f"{value:.1f} %" if value >= 0.095 else f"{value:.2g} %"


def failures(failed: Mapping[int, str]) -> dict[str, list[int]]:
    """Group failed variants by message, messages that differ only in numbers as one."""
    variants: dict[str, list[int]] = {}
    first: dict[str, str] = {}
    for number, message in failed.items():
        variants.setdefault(first.setdefault(_NUMBER.sub("", message), message), []).append(number)
    return variants


def numbered(numbers: Sequence[int], noun: str = "variant") -> str:
    """List variants for a message: "variant 3", or "17 variants (3, 8, 9, ...)"."""
    if len(numbers) == 1:
        return f"{noun} {numbers[0]}"
    shown = ", ".join(map(str, numbers[:_NUMBERED])) + (", ..." if len(numbers) > _NUMBERED else "")
    return f"{len(numbers)} {noun}s ({shown})"


def struck_statements(table: pa.Table) -> list[str]:
    struck = struck_variants(table)
    if not struck:
        return []
    return [
        f"Stops are struck in {struck} of {table.num_rows} variants: their accelerations depend on stiffness and "
        "damping of the stops."
    ]


def travel_statements(system: System) -> list[str]:
    """State that a study judges travel along single axes only, if a mount is rated along several."""
    for mount in system.mounts.values():
        if len({RATINGS[rating][0] for rating in mount.isolator.limits.travel.stated}) > 1:
            return [
                f"Travel is judged along each axis by itself; a run judges all at once, too (combined travel, {COMBINED}), "
                "which can be exceeded where this is not."
            ]
    return []


def limit_statement(stated: StatedLimit, table: pa.Table, *, sampled: bool) -> str:
    """State how often a limit is exceeded, with bounds where variants are a sample."""
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


def exceedance_text(exceedance: Exceedance, ratio: float | None) -> str:
    """Write an exceedance for a cell, such as "88 of 325 (27 %), 17 failed"."""
    of = "" if ratio is None or math.isnan(ratio) else f" ({percent(ratio)})"
    failed = f", {exceedance.failed} failed" if exceedance.failed else ""
    failed += f", {exceedance.early} not judged" if exceedance.early else ""
    return f"{exceedance.count} of {exceedance.n}{of}{failed}"


def _limit_text(result: StudyResult, measure: Measure, limit: float) -> str:
    """Describe how often a measure exceeds its limit, and its largest value."""
    table, independent, inputs = result.columns, result.independent, input_names(result.columns)
    beyond, top = exceedance_of(independent, measure.name, limit), worst(independent, measure.name, 1)[0]
    values = values_of(independent, measure.name)
    largest = f"the largest is {measure.factor * np.nanmax(values):.3g} % in variant {top}"
    start = f"{capital(measure.heading)} ({measure.text}): beyond 100 % in {beyond.count} of {beyond.n}"
    if not beyond.judged:
        return f"{capital(measure.heading)} ({measure.text}): not judged, since every run ends before its peaks are over."
    if not result.is_sampled:
        fraction = fraction_of_directions(table, inputs, values, limit)
        which = exceeding_inputs(table, inputs, values, limit)
        which += "" if fraction is None else f", {percent(fraction)} of {directions_text(table)}"
        return f"{start} variants{which}{not_counted(beyond)}; {largest}{inputs_text(row_of(table, top), inputs)}."
    bounds = f"{percent(beyond.low)} to {percent(beyond.high)} at {percent(CONFIDENCE)} confidence"
    of = f"{'' if independent is table else 'independent '}variants"
    at_most = f": {percent(beyond.at_most)} if all of them were beyond" if beyond.failed or beyond.early else ""
    return f"{start} {of}, {percent(beyond.ratio)} ({bounds}){not_counted(beyond)}{at_most}; {largest}."


def not_counted(beyond: Exceedance) -> str:
    """Write how many variants are not judged or not counted; "" without such variants."""
    early = f"; {beyond.early} ended too early to be judged" if beyond.early else ""
    are = "is" if beyond.failed == 1 else "are"
    return early + (f"; {beyond.failed} more could not be simulated and {are} not counted" if beyond.failed else "")


def early_statements(table: pa.Table) -> list[str]:
    """State how many variants end before their peaks are over, or while a measure still grows."""

    def which(count: int) -> str:
        return "Every variant" if count == table.num_rows else f"{count} of {table.num_rows} variants"

    early, growing, texts = int(np.count_nonzero(ended_early(table))), still_growing(table), list[str]()
    if early:
        texts.append(f"{which(early)}: not judged but for what is exceeded already, since {why_early(table)}.")
    if growing:
        texts.append(f"{which(growing)}: what still grows when the run ends is not judged unless it is exceeded; run longer.")
    return texts


def of_indices(indices: SobolIndices) -> str:
    """Describe the variance of a measure that each factor explains, by Sobol's indices."""
    measure = measure_of(indices.measure)
    begin = capital(measure.text if measure.limit is None else measure.heading)
    dropped = f" {indices.dropped} of {indices.rows + indices.dropped} base rows were dropped: variants of them failed."
    end = dropped if indices.dropped else ""
    if indices.too_few:
        reach = max(factor.reach for factor in indices.factors)
        return (
            f"{begin}: {indices.rows} base rows are too few to say what explains its variance (total indices are known to "
            f"within {100.0 * reach:.0f} % of it).{end}"
        )
    first, *others = indices.factors
    low, high = (100.0 * max(side, 0.0) for side in first.total_interval)
    parts = [
        f"{first.name} explains {_index(first.first)} of its variance alone, {_index(first.total)} with what it does together "
        f"with others ({low:.0f} to {high:.0f} % at {percent(CONFIDENCE)} confidence)"
    ]
    parts += [f"{factor.name} {_index(factor.first)} and {_index(factor.total)}" for factor in others if factor.total >= SLIGHT]
    slight = [factor.name for factor in others if factor.total < SLIGHT]
    if slight:
        parts.append(f"less than {percent(SLIGHT)}: {', '.join(slight)}")
    return f"{begin}: {'; '.join(parts)}.{end}"


def _index(index: float) -> str:
    """Write a Sobol index in percent; an estimate outside 0 to 100 % is so by chance, and is cut off."""
    return f"{100.0 * min(max(index, 0.0), 1.0):.0f} %"


def capital(text: str) -> str:
    return f"{text[0].upper()}{text[1:].replace('_', ' ')}"


def exceeding_inputs(table: pa.Table, inputs: Sequence[str], values: Array, limit: float) -> str:
    """Describe for which values of the only input `values`, (n,), exceed a limit; "" without such, or with several inputs.

    For a number, the value at which the limit is first crossed, interpolated between two variants; for choices, their names.
    """
    beyond = values > limit
    if len(inputs) != 1 or not beyond.any():
        return ""
    (name,) = inputs
    kind = table.schema.field(name).type
    if pa.types.is_floating(kind):
        known = np.isfinite(values)
        order = np.argsort(np.asarray(table[name], dtype=np.float64)[known], kind="stable")
        x, y = np.asarray(table[name], dtype=np.float64)[known][order], values[known][order]
        first = int(np.argmax(y > limit))
        if first == 0:
            return f", already at {name} {x[0]:.4g}"
        at = x[first - 1] + (limit - y[first - 1]) / (y[first] - y[first - 1]) * (x[first] - x[first - 1])
        return f", first at {name} {at:.3g} (interpolated between {x[first - 1]:.4g} and {x[first]:.4g})"
    texts = [value_text(value) for value, is_beyond in zip(table[name].to_pylist(), beyond, strict=True) if is_beyond]
    rest = len(texts) - _CHOICES
    return f" ({name}: {', '.join(texts[:_CHOICES])}{f' and {rest} more' if rest > 0 else ''})"


def inputs_text(row: Entries, inputs: Sequence[str]) -> str:
    """Write the inputs of a variant; "" if there are more than two."""
    if not 1 <= len(inputs) <= _INPUTS:
        return ""
    return f" ({', '.join(f'{name} {value_text(row[name])}' for name in inputs)})"
