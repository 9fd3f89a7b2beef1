"""The content of a study's `summary.json`."""

from typing import Any

import numpy as np
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.inputs.sampling import LISTED
from wirerope_mj.studies.inputs.sobol import SAMPLING
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.indices import sobol_indices
from wirerope_mj.studies.results.measure import ALL, STRUCK, known_measures, measure_of, values_of
from wirerope_mj.studies.results.statistics import (
    CONFIDENCE,
    exceedance_of,
    finite,
    quantiles,
    struck_variants,
    worst,
)
from wirerope_mj.studies.results.varied import varied_of

# Measures in the summary.
SUMMARISED = ("acceleration", ALL, "travel", "combined_travel", "static_load", "fragility", "clearance")
_QUANTILES = {"q05": 0.05, "median": 0.5, "q95": 0.95}


def summary(result: StudyResult) -> dict[str, Any]:
    """Return the statistics of a study's measures, SI.

    What the nominal system does. Of variants that were sampled percentiles, as far as five variants lie beyond them, and the
    probability beyond the limit with its bounds; of those for Sobol's indices these, too; of listed ones the smallest, the
    middle and the largest value.
    """
    nominal = result.nominal
    result = result.narrowed(("variant", "status", "message", STRUCK, *SUMMARISED))
    method = result.inputs["sampling"]["method"]
    table = result.independent if method == SAMPLING else result.table
    measures = {}
    for name in known(table):
        measures[name] = {"nominal": nominal[name]} if name in nominal else {}
        measures[name] |= _of_measure(table, name, sampled=method not in LISTED)
        if method == SAMPLING:
            measures[name] |= _indices(result, name)
    struck = struck_variants(result.table)
    return {**head(result), **({} if struck is None else {"struck": struck}), "measures": measures}


def head(result: StudyResult) -> dict[str, Any]:
    """Return what the summaries of studies and of searches begin with."""
    return {
        "format": result.inputs["format"],
        "name": result.inputs["name"],
        "id": result.inputs["id"],
        "variants": result.table.num_rows,
        "failed": len(result.failed),
        "timestep_s": result.inputs["simulate"]["timestep"],
        "varied": [one.to_dict() for one in varied_of(result.study)],
    }


def known(table: pa.Table) -> list[str]:
    """Return the measures of `SUMMARISED` that have values."""
    return known_measures(table, SUMMARISED)


def _of_measure(table: pa.Table, name: str, *, sampled: bool) -> dict[str, Any]:
    values, limit = finite(values_of(table, name)), measure_of(name).limit
    content = _quantiles(values) if sampled else {"smallest": float(values.min()), "median": float(np.median(values))}
    content |= {"largest": float(values.max()), "variant": worst(table, name, 1)[0]}
    if limit is not None:
        beyond = exceedance_of(table, name, limit)
        content |= {"limit": limit, "beyond": beyond.count, "of": beyond.n}
        content |= {"ended_early": beyond.early} if beyond.early else {}
        if sampled:
            content |= {"probability": beyond.ratio, "low": beyond.low, "high": beyond.high, "confidence": CONFIDENCE}
    return content


def _quantiles(values: Array) -> dict[str, Any]:
    each = zip(_QUANTILES, quantiles(values, list(_QUANTILES.values())), strict=True)
    return {name: value for name, value in each if np.isfinite(value)}


def _indices(result: StudyResult, name: str) -> dict[str, Any]:
    sobol = sobol_indices(result, name)
    indices = {
        one.name: {
            "first": one.first, "first_interval": list(one.first_interval),
            "total": one.total, "total_interval": list(one.total_interval),
        }
        for one in sobol.factors
    }  # fmt: skip
    return {"base_rows": sobol.rows, "dropped_rows": sobol.dropped, "indices": indices} if indices else {}
