"""The limits that were stated on a study, in its `summary.json`, so that its report judges them, too."""

import json
from collections.abc import Sequence
from typing import Any

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.studies.folder import SUMMARY
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import measures_of
from wirerope_mj.studies.results.stated_limits import StatedLimit, limit_of_text
from wirerope_mj.studies.results.statistics import CONFIDENCE

KEY = "stated_limits"
"""Of the list in `summary.json`; it is not there unless somebody has stated a limit."""

_REMEDY = "Remove the file, and go on with --resume (`resume=True`): it is written anew."


def write_stated(result: StudyResult, limits: Sequence[StatedLimit]) -> None:
    """Write how often limits are exceeded into the summary of a study, in place of those that were stated before.

    Raises:
        RecordError: the summary is damaged.
    """
    content = _content(result) | {KEY: [_exceeded(result, one) for one in limits]}
    with atomic_file(result.folder / SUMMARY) as temporary_path:
        temporary_path.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def read_stated(result: StudyResult) -> tuple[StatedLimit, ...]:
    """Return the limits that stand in the summary of a study; nothing if there is no summary yet.

    Raises:
        RecordError: the summary is damaged.
    """
    path = result.folder / SUMMARY
    if not path.is_file():
        return ()
    stated = _content(result).get(KEY, [])
    try:
        return tuple(limit_of_text(one["text"], measures_of(result.table)) for one in stated)
    except (KeyError, TypeError, ValueError) as error:
        raise RecordError(f"{path}: `{KEY}` is not what was written: {error} {_REMEDY}") from None


def _content(result: StudyResult) -> dict[str, Any]:
    path = result.folder / SUMMARY
    try:
        content = json.loads(regular(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        why = why_unread(error) if isinstance(error, OSError) else "it is not JSON."
        raise RecordError(f"{path}: {why} {_REMEDY}") from None
    if not isinstance(content, dict):
        raise RecordError(f"{path}: this is not the summary of a study. {_REMEDY}")
    return content


def _exceeded(result: StudyResult, stated: StatedLimit) -> dict[str, Any]:
    """Return a limit in SI with its exceedance; a probability only of variants that were sampled."""
    beyond = stated.exceedance(result.independent)
    content = {
        "text": stated.text, "measures": list(stated.measures), "limit": stated.limit,
        "beyond": beyond.count, "of": beyond.n, "failed": beyond.failed,
    }  # fmt: skip
    content |= {"ended_early": beyond.early} if beyond.early else {}
    if result.is_sampled and beyond.n:
        content |= {"probability": beyond.ratio, "low": beyond.low, "high": beyond.high, "confidence": CONFIDENCE}
    return content
