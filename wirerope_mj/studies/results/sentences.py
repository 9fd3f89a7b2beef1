"""What a study answers, in sentences."""

import math

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.mounts.isolator.travel import RATINGS
from wirerope_mj.studies.inputs.sobol import SAMPLING
from wirerope_mj.studies.inputs.specimens import specimen_sentences
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.directions import directions_words, share_of_directions
from wirerope_mj.studies.results.findings import (
    CONFIDENCE,
    Chance,
    Measure,
    chance_of,
    headlines,
    input_names,
    measure_of,
    percent,
    random_study,
    row_of,
    struck_variants,
    values_of,
    worst,
)
from wirerope_mj.studies.results.indices import SobolIndices, drawn, sobol_indices
from wirerope_mj.studies.results.places import beyond_words, inputs_words

SLIGHT = 0.01
"""Total index below which a factor is only named."""


def sentences(result: StudyResult) -> list[str]:
    """Return what the study answers, a sentence for every measure with a limit, and what must be known to read them."""
    found = [
        _of_limit(result, measure, measure.limit)
        for measure in map(measure_of, [*headlines(result.table), *_overloaded(result.table)])
        if measure.limit is not None
    ]
    if not found:
        found.append("Nothing is judged: the isolators state no rated travel and the model no limit.")
    found += struck_sentences(result.table)
    if "travel" in headlines(result.table):
        found += travel_sentences(result.study.base)
    found += specimen_sentences(result.study.quantities)
    if result.study.sampling == SAMPLING:
        every = (sobol_indices(result, name) for name in headlines(result.table))
        found += [of_indices(one) for one in every if one.factors]
    return found


def struck_sentences(table: pa.Table) -> list[str]:
    """Return in how many variants stops were struck; nothing of none, and of tables of older versions, which do not say it."""
    struck = struck_variants(table)
    if not struck:
        return []
    return [
        f"Stops are struck in {struck} of {table.num_rows} variants: their accelerations depend on stiffness and "
        "damping of the stops."
    ]


def _overloaded(table: pa.Table) -> list[str]:
    """Return the measure of static load if a mount is loaded beyond its rating; what keeps it needs no word."""
    return ["static_load"] if np.nanmax(values_of(table, "static_load"), initial=0.0) > 1.0 else []


def travel_sentences(system: System) -> list[str]:
    """Return what a run's report judges of travel and a study does not; nothing unless a mount is rated along several axes."""
    for mount in system.mounts.values():
        if len({RATINGS[rating][0] for rating in mount.isolator.limits.travel.stated}) > 1:
            return [
                "Travel is judged along each axis by itself; the report of a run judges all axes together, too (travel "
                "combined), which can be exceeded where this is not."
            ]
    return []


def beyond_text(beyond: Chance, share: float | None) -> str:
    """Return how often a limit is exceeded, for a cell: "88 of 325 (27 %), 17 failed"; without the share if it is None."""
    of = "" if share is None or math.isnan(share) else f" ({percent(share)})"
    return f"{beyond.count} of {beyond.n}{of}{f', {beyond.failed} failed' if beyond.failed else ''}"


def _of_limit(result: StudyResult, measure: Measure, limit: float) -> str:
    """Return how often a measure is beyond its limit, and where it is largest."""
    table, independent, inputs = result.table, drawn(result), input_names(result.table)
    beyond, top = chance_of(independent, measure.name, limit), worst(independent, measure.name, 1)[0]
    values = values_of(independent, measure.name)
    largest = f"the largest is {measure.factor * np.nanmax(values):.3g} % in variant {top}"
    begin = f"{_what(measure)}: beyond 100 % in {beyond.count} of {beyond.n}"
    if not random_study(result):
        part = share_of_directions(table, inputs, values, limit)
        where = beyond_words(table, inputs, values, limit)
        where += "" if part is None else f", {percent(part)} of {directions_words(table)}"
        largest += inputs_words(row_of(table, top), inputs)
        return f"{begin} variants{where}{_failed(beyond, counted=False)}; {largest}."
    bounds = f"{percent(beyond.low)} to {percent(beyond.high)} at {percent(CONFIDENCE)} confidence"
    of = f"{'' if independent is table else 'independent '}variants"
    return f"{begin} {of}, {percent(beyond.share)} ({bounds}){_failed(beyond, counted=True)}; {largest}."


def _failed(beyond: Chance, *, counted: bool) -> str:
    """Return how many variants are not counted, and the share of all if they were; "" if none failed."""
    if not beyond.failed:
        return ""
    more = f": {percent(beyond.at_most)} if all of them were beyond" if counted else ""
    return f"; {beyond.failed} more failed and {'is' if beyond.failed == 1 else 'are'} not counted{more}"


def of_indices(found: SobolIndices) -> str:
    """Return what the factors explain of a measure as a sentence."""
    measure = measure_of(found.measure)
    begin = _begun(measure.words if measure.limit is None else measure.name)
    dropped = f" {found.dropped} of {found.rows + found.dropped} base rows were dropped: variants of them failed."
    end = dropped if found.dropped else ""
    if found.too_few:
        reach = max(one.reach for one in found.factors)
        return (
            f"{begin}: {found.rows} base rows are too few to say what explains its variance (total indices are known to "
            f"within {100.0 * reach:.0f} % of it).{end}"
        )
    first, *others = found.factors
    low, high = (100.0 * max(side, 0.0) for side in first.total_interval)
    parts = [
        f"{first.name} explains {_share(first.first)} of its variance alone, {_share(first.total)} with what it does together "
        f"with others ({low:.0f} to {high:.0f} % at {percent(CONFIDENCE)} confidence)"
    ]
    parts += [f"{one.name} {_share(one.first)} and {_share(one.total)}" for one in others if one.total >= SLIGHT]
    slight = [one.name for one in others if one.total < SLIGHT]
    if slight:
        parts.append(f"less than {percent(SLIGHT)}: {', '.join(slight)}")
    return f"{begin}: {'; '.join(parts)}.{end}"


def _share(index: float) -> str:
    return f"{100.0 * min(max(index, 0.0), 1.0):.0f} %"


def _what(measure: Measure) -> str:
    """Return a measure as a sentence begins with it: its name, too, where tables say no more."""
    if measure.limit is None:
        return _begun(measure.words)
    return f"{_begun(measure.name)} ({measure.words})"


def _begun(words: str) -> str:
    return f"{words[0].upper()}{words[1:].replace('_', ' ')}"
