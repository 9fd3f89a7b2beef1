"""Statistics of a measure over the variants of a study: quantiles, exceedance of a limit, the worst variants."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import scipy

from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.studies.ended import ended_early
from wirerope_mj.studies.engines.compute import DONE
from wirerope_mj.studies.results.measure import STRUCK, values_of

CONFIDENCE = 0.95
_BEYOND = 5  # Variants that lie beyond a percentile that is given


@dataclass(frozen=True, kw_only=True)
class Exceedance:
    """Exceedance of a limit."""

    # count, n: variants that exceed it, of how many that could be simulated and have a value
    count: int
    n: int
    # low, high: bounds of the probability at `CONFIDENCE` (Clopper and Pearson 1934), as of random draws; even sampling
    # is rather better than that. They know nothing of variants that failed. The upper one takes those of `early` as
    # beyond.
    low: float
    high: float
    failed: int = 0  # variants that could not be simulated, and are counted nowhere
    # variants among the n whose runs end before their peaks are over, and that keep the limit until then: not judged
    early: int = 0

    @property
    def ratio(self) -> float:
        """Ratio to the variants that were counted, 0 to 1; NaN if there are none."""
        return self.count / self.n if self.n else math.nan

    @property
    def at_most(self) -> float:
        """Ratio to all variants, if every one that is not counted were beyond the limit."""
        total = self.n + self.failed
        return (self.count + self.early + self.failed) / total if total else math.nan

    @property
    def judged(self) -> int:
        """How many variants are judged."""
        return self.n - self.early


def finite(values: Array) -> Array:
    """Return the values without NaN."""
    return values[np.isfinite(values)]


def quantiles(values: Array, probabilities: Sequence[float]) -> list[float]:
    """Return quantiles; NaN for those beyond which, away from the median, fewer than five variants lie: nobody knows them."""
    known = finite(values)
    beyond = [known.size * min(q, 1.0 - q) for q in probabilities]
    # 50 (1 - 0.9) is a little less than 5 in floating point.
    return [
        float(np.quantile(known, q)) if n >= _BEYOND - 1e-9 else math.nan for q, n in zip(probabilities, beyond, strict=True)
    ]


def exceedance(values: Array, limit: float, *, failed: int = 0, early: int = 0) -> Exceedance:
    """Return the exceedance of a limit by values; `failed` more variants have none, and `early` of them are not judged."""
    known = finite(values)
    k, n, tail = int((known > limit).sum()), known.size, (1.0 - CONFIDENCE) / 2.0
    low = float(scipy.stats.beta.ppf(tail, k, n - k + 1)) if k else 0.0
    most = k + early
    high = float(scipy.stats.beta.ppf(1.0 - tail, most + 1, n - most)) if most < n else 1.0
    return Exceedance(count=k, n=n, low=low, high=high, failed=failed, early=early)


def exceedance_of(table: pa.Table, measure: str, limit: float) -> Exceedance:
    """Return the exceedance of a limit by a measure, with the number of variants that failed."""
    return exceedance_in(table, measure, values_of(table, measure), limit)


def exceedance_in(table: pa.Table, measure: str, values: Array, limit: float) -> Exceedance:
    """Return the exceedance of a limit by values of a measure of a table, with how many failed or ended too early."""
    return exceedance(
        values, limit, failed=int(np.count_nonzero(np.asarray(table["status"]) != DONE)),
        early=int(np.count_nonzero(ended_early(table, measure) & (values <= limit))),
    )  # fmt: skip


def worst(table: pa.Table, measure: str, count: int) -> list[int]:
    """Return the numbers of the variants with the largest values of a measure, the largest first."""
    values = values_of(table, measure)
    order = np.argsort(-values, kind="stable")  # NaN come last
    numbers = np.asarray(table["variant"])
    return [int(numbers[row]) for row in order[:count] if np.isfinite(values[row])]


def row_of(table: pa.Table, number: int) -> Entries:
    """Return the row of a variant."""
    row = int(np.flatnonzero(np.asarray(table["variant"]) == number)[0])
    return table.slice(row, 1).to_pylist()[0]


def struck_variants(table: pa.Table) -> int | None:
    """Return in how many variants stops were struck; None of older tables, which do not say it."""
    return int(np.count_nonzero(values_of(table, STRUCK) > 0.0)) if STRUCK in table.column_names else None
