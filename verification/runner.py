"""Running cases: what came out of each, and whether it lies within its bound."""

import importlib.util
import math
import time
import warnings
from dataclasses import dataclass
from pathlib import Path

from verification.case import Case, Comparison, NotRunError

WITHIN, OUTSIDE, NOT_RUN, FAILED = "within", "outside", "not run", "failed"


@dataclass(frozen=True, kw_only=True)
class Result:
    """What came out of a case.

    Attributes:
        case: the case.
        status: "within" or "outside" its bound, "not run", or "failed" with an exception.
        comparison: None unless it was run to its end.
        note: why there is none.
        seconds: that it took.
    """

    case: Case
    status: str
    comparison: Comparison | None = None
    note: str = ""
    seconds: float = 0.0


def missing(case: Case) -> list[str]:
    """Return the packages that a case needs and that are not installed."""
    return [name for name in case.needs if importlib.util.find_spec(name) is None]


def run_case(case: Case, data: Path | None = None) -> Result:
    """Return the result of a case; an exception of the library is a result too, a missing package is never a pass.

    Args:
        case: to run.
        data: folder of measured tests, for those of the kind "measured"; None: they are not run.
    """
    absent = missing(case)
    if absent:
        return Result(case=case, status=NOT_RUN, note=f"needs {', '.join(absent)}")
    if case.kind == "measured" and data is None:
        return Result(case=case, status=NOT_RUN, note="no data")
    start = time.perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            comparison = case.run(data) if case.kind == "measured" else case.run()
    except NotRunError as reason:
        return Result(case=case, status=NOT_RUN, note=str(reason))
    except Exception as error:  # whatever it is, the other cases are still worth running
        return Result(case=case, status=FAILED, note=f"{type(error).__name__}: {error}")
    within = math.isfinite(comparison.error) and comparison.error <= case.bound
    return Result(
        case=case,
        status=WITHIN if within else OUTSIDE,
        comparison=comparison,
        note="" if within else case.known,
        seconds=time.perf_counter() - start,
    )
