"""The content of a search's `summary.json`."""

from typing import Any

from wirerope_mj.studies.results.summary_file import head
from wirerope_mj.studies.search.result import GENERATION, SearchResult


def search_summary(result: SearchResult) -> dict[str, Any]:
    """Return the front of a search, SI, and its knee; percentiles of designs that an evolution has chosen mean nothing."""
    names = ["variant", GENERATION, *result.shown]
    return {
        **head(result),
        "minimised": list(result.minimise),
        "limits": result.limits,
        "within_limits": int(result.feasible.sum()),
        "front": result.front.select(names).to_pylist(),
        "knee": result.knee,
    }
