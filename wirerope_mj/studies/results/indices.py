"""Sobol's indices of a study that was sampled for them: what each factor explains of a measure, alone and with the others."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.inputs.sampling import FEWEST, OF_INDICES, factors
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import ALL, CONFIDENCE, measures_of, unknown_measure, values_of

# Half the width of a total index's interval, and how far an index lies outside 0 to 1, from which on the rows are too few.
_WIDE, _BEYOND = 0.25, 0.1
# Of the base rows with replacement: the ends of the intervals are then known to a tenth of their length.
RESAMPLES = 1000
_BLOCK = 2**22  # numbers of resampled rows that are held at once, 32 MB
_SEED = 1  # of the resampling, so that the same table says the same again


@dataclass(frozen=True, kw_only=True)
class SobolIndex:
    """Sensitivity indices of one factor for a measure."""

    name: str
    # fraction of the variance that it explains alone; by accident a little less than 0 where there is no effect
    first: float
    total: float  # fraction that it explains alone and together with others, so what would be gone if it were known
    # first_interval, total_interval: lower and upper bound at `CONFIDENCE`
    first_interval: tuple[float, float]
    total_interval: tuple[float, float]

    @property
    def reach(self) -> float:
        """Half the width of the total index's interval."""
        return (self.total_interval[1] - self.total_interval[0]) / 2.0


@dataclass(frozen=True, kw_only=True)
class SobolIndices:
    """Sobol's indices of a measure."""

    measure: str  # name of its column
    # the indices, the largest total one first; empty if too few rows are left or the measure does not vary
    factors: tuple[SobolIndex, ...]
    rows: int  # base rows that were used
    dropped: int  # base rows that were not, because one of their variants failed or has no value

    @property
    def too_few(self) -> bool:
        """True if the rows are too few to say anything: intervals of total indices are wide, or indices are none."""
        return any(one.reach > _WIDE for one in self.factors) or any(
            not -_BEYOND <= index <= 1.0 + _BEYOND for one in self.factors for index in (one.first, one.total)
        )


def sobol_indices(result: StudyResult, measure: str) -> SobolIndices:
    """Return the indices of a measure of a study with `sampling="sobol-indices"`.

    Raises:
        ValueError: the study was sampled otherwise, or there is no such measure.
    """
    if result.study.sampling != OF_INDICES:
        raise ValueError(f'Sobol\'s indices need a study with sampling="{OF_INDICES}"; this one has {result.study.sampling!r}.')
    names = measures_of(result.table)
    if measure not in (*names, ALL):
        raise ValueError(unknown_measure(measure, names))
    return indices_of(result.table, list(factors(result.study.quantities)), measure)


def indices_of(table: pa.Table, names: Sequence[str], measure: str) -> SobolIndices:
    """Return the indices of a measure from a table of variants in the order of `sobol.points`; rows may be missing.

    With f of A, B and A_B (A with one factor from B) and V the variance over A and B, centred about its mean: first order
    E(f_B (f_AB - f_A)) / V, total E((f_A - f_AB)^2) / 2V (Saltelli et al. 2010, table 2 b and f), as SciPy's
    `sobol_indices` computes them. That takes none but whole powers of two, which failed variants do not leave. Intervals are
    the percentiles of a bootstrap over base rows, as of random draws; even sampling is rather better than that.
    """
    of_row = len(names) + 2
    numbers = np.asarray(table["variant"])
    every = np.full((int(numbers.max(initial=0)) // of_row + 1, of_row), np.nan)
    every.flat[numbers] = values_of(table, measure)
    kept = every[np.isfinite(every).all(axis=1)]
    dropped = len(every) - len(kept)
    scale = float(np.abs(kept).max(initial=0.0))
    if len(kept) < FEWEST or np.ptp(kept[:, :2]) <= 1e-12 * scale:
        return SobolIndices(measure=measure, factors=(), rows=len(kept), dropped=dropped)
    kept = kept / scale
    first, total = _estimates(kept[None])
    low, high = _intervals(kept)
    indices = [
        SobolIndex(
            name=name, first=float(first[0, k]), total=float(total[0, k]),
            first_interval=(float(low[0, k]), float(high[0, k])),
            total_interval=(float(low[1, k]), float(high[1, k])),
        )
        for k, name in enumerate(names)
    ]  # fmt: skip
    indices.sort(key=lambda one: -one.total)
    return SobolIndices(measure=measure, factors=tuple(indices), rows=len(kept), dropped=dropped)


def _estimates(values: Array) -> tuple[Array, Array]:
    """Return first-order and total indices, (s, n_factors), of samples of rows (s, n, n_factors + 2)."""
    centred = values - values[:, :, :2].mean(axis=(1, 2), keepdims=True)
    a, b, mixed = centred[:, :, :1], centred[:, :, 1:2], centred[:, :, 2:]
    variance = np.mean(centred[:, :, :2] ** 2, axis=(1, 2))[:, None]
    variance = np.where(variance > 0.0, variance, np.inf)  # of resampled rows that happen to be all alike
    return np.mean(b * (mixed - a), axis=1) / variance, 0.5 * np.mean((a - mixed) ** 2, axis=1) / variance


def _intervals(values: Array) -> tuple[Array, Array]:
    """Return lower and upper bounds of first-order and total indices, each (2, n_factors)."""
    generator = np.random.default_rng(_SEED)
    at_once = max(_BLOCK // values.size, 1)
    parts: list[tuple[Array, Array]] = []
    for first in range(0, RESAMPLES, at_once):
        rows = generator.integers(len(values), size=(min(at_once, RESAMPLES - first), len(values)))
        parts.append(_estimates(values[rows]))
    samples = np.stack([np.concatenate(both) for both in zip(*parts, strict=True)])
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(samples, [tail, 1.0 - tail], axis=1)
    return low, high
