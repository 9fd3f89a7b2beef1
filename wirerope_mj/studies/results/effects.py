"""Which inputs of a study matter: their effects on its measures, Sobol's indices of their factors, directions by area."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import scipy

from wirerope_mj.foundation.arrays import AnyArray, Array, Integers
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import ALL, CONFIDENCE, is_done, measures_of, unknown_measure, values_of
from wirerope_mj.studies.vary.sampling import FEWEST, OF_INDICES, factors

AZIMUTH, ELEVATION = "motion/azimuth", "motion/elevation"
_GAP = 1.5  # Ratio to all other gaps between azimuths above which nobody looked into a gap


def sphere_areas(azimuth: Array, elevation: Array) -> Array:
    """Return the fraction of the spanned part of the sphere for which each direction [deg] stands, (n,), 1 in all.

    Directions of one elevation share a belt that reaches halfway to their neighbours above and below, sin(upper) - sin(lower)
    of the sphere's area 2 pi (Archimedes), and along it what lies halfway to their neighbours: points of equal angle crowd at
    the poles, where a circle of latitude is short. The first and the last elevation have no belt beyond themselves, and of a
    fan that does not go around, the first and the last azimuth none: nobody looked there. A direction that stands there
    twice, as a pole under every azimuth, counts once.
    """
    rings, ring = np.unique(elevation, return_inverse=True)
    edges = np.radians(np.concatenate((rings[:1], (rings[:-1] + rings[1:]) / 2.0, rings[-1:])))
    belts = np.diff(np.sin(edges)) if rings.size > 1 else np.ones(1)
    around = np.where(np.abs(elevation) == 90.0, 0.0, np.mod(azimuth, 360.0))
    areas, widths = np.zeros(azimuth.size), np.zeros(rings.size)
    for k in range(rings.size):
        on = np.flatnonzero(ring == k)
        angles, same, times = np.unique(around[on], return_inverse=True, return_counts=True)
        fractions, widths[k] = _arcs(angles)
        areas[on] = (fractions / times)[same.ravel()]
    # One direction stands for as much of its circle as the others of theirs: so a pole.
    widths = np.where(widths == 0.0, widths.max() or 1.0, widths)
    areas *= (belts * widths)[ring]
    return np.asarray(areas / areas.sum(), dtype=np.float64)


def _arcs(angles: Array) -> tuple[Array, float]:
    """Return the fraction of the spanned arc for which each angle [deg] stands, and the width of that arc [deg]."""
    # They go around unless there is a gap wider than all others by half: then they are a fan.
    if angles.size < 2:
        return np.ones(angles.size), 0.0
    gaps = np.diff(np.append(angles, angles[0] + 360.0))  # behind each angle
    widest = int(np.argmax(gaps))
    other_gaps = np.delete(gaps, widest)
    fan = bool(gaps[widest] > _GAP * other_gaps.max())
    if fan:
        gaps[widest] = 0.0
    width = float(gaps.sum())
    return (gaps + np.roll(gaps, 1)) / 2.0 / width, width


def whole_sphere(table: pa.Table) -> bool:
    """Tell whether the directions of a study go all around and from pole to pole."""
    azimuth, elevation = (np.asarray(table[name], dtype=np.float64) for name in (AZIMUTH, ELEVATION))
    if (elevation.min(), elevation.max()) != (-90.0, 90.0):
        return False
    between = [np.unique(np.mod(azimuth[elevation == level], 360.0)) for level in np.unique(elevation) if abs(level) < 90.0]
    return bool(between) and all(_arcs(ring)[1] > 360.0 - 1e-6 for ring in between)


def directions_text(table: pa.Table) -> str:
    """Name the directions to which a fraction refers: all, or those that a study spans."""
    return "all directions" if whole_sphere(table) else "the directions looked at"


def fraction_of_directions(table: pa.Table, inputs: list[str], values: Array, limit: float) -> float | None:
    """Return the fraction of the directions in which `values` exceed a limit, by area on the sphere; None if other inputs vary.

    Directions that failed or are not judged do not count.
    """
    if set(inputs) != {AZIMUTH, ELEVATION}:
        return None
    azimuth, elevation = (np.asarray(table[name], dtype=np.float64) for name in (AZIMUTH, ELEVATION))
    areas = np.where(is_done(table) & np.isfinite(values), sphere_areas(azimuth, elevation), 0.0)
    whole = float(areas.sum())
    return float(areas[values > limit].sum()) / whole if whole > 0.0 else None


SIGNIFICANCE = 0.01  # Probability that any of the inputs is called certain by accident, if none has an effect
# Fraction of the variance below which no effect is called certain: the test takes the scatter in all classes for equal, which
# is not quite so where inputs act together, and so little matters to nobody.
SMALLEST = 0.005
_LEAST = 12  # variants below which nothing is said: three bins of four


@dataclass(frozen=True, kw_only=True)
class Effect:
    """Effect of one input on a measure."""

    name: str
    # first-order Sobol index, the fraction of the measure's variance that the input alone explains; 0 to 1, and by
    # accident a little less than 0 where there is no effect
    index: float
    rank: float  # Spearman's correlation of input and measure, -1 to 1; NaN where the input has no order
    certain: bool  # whether accident alone would hardly give any of the inputs such an index


def effects(table: pa.Table, inputs: Sequence[str], measure: str) -> tuple[Effect, ...]:
    """Return the effect of each input on a measure, the strongest first; empty for too few variants.

    The index is estimated from the variants as they are (given data): the input is cut into classes with as many variants
    each, and eta^2 = variance between classes / variance. What classes without any effect would give by accident is taken
    away: 1 - (1 - eta^2)(n - 1)/(n - m) of n variants in m classes (epsilon^2, Kelley 1935). It needs no special sampling,
    and sees effects that rise and fall again. What the classes of the strongest input explain is taken from the measure
    before the next one is looked at: few variants of many inputs are never quite independent (pairs of Sobol's dimensions
    least of all), and a strong input would lend its effect to others. Of inputs that do depend on each other, such as the
    parameters of a specimen, the stronger one is given what they do together.
    """
    values = values_of(table, measure)
    kept = np.isfinite(values)
    values = values[kept]
    if values.size < _LEAST or np.ptp(values) <= 1e-12 * np.abs(values).max():
        return ()
    # Of all inputs their classes are held, a byte or two for each variant, and one column at a time.
    classes = {name: _classes(np.asarray(table[name])[kept]) for name in inputs}
    remaining = {name: numbers for name, numbers in classes.items() if 2 <= int(numbers.max()) + 1 <= values.size / 2}
    whole, rest = float(np.sum((values - values.mean()) ** 2)), values - values.mean()
    results, certain = [], True
    sizes: dict[str, tuple[float, float]] = {}
    while remaining:
        if certain:  # the measure has changed
            sizes = {name: _effect(numbers, rest) for name, numbers in remaining.items()}
        name = max(remaining, key=lambda candidate: sizes[candidate][0])
        explained, probability = sizes[name]
        certain = probability < SIGNIFICANCE / len(classes) and explained >= SMALLEST * whole
        rank = math.nan  # Spearman's correlation, Pearson's of the ranks; of what has no order there is none
        column = np.asarray(table[name])[kept]
        if column.dtype.kind in "fiub":
            a, b = scipy.stats.rankdata(column.astype(np.float64)), scipy.stats.rankdata(values)
            a, b = a - a.mean(), b - b.mean()
            size = math.sqrt(float(a @ a) * float(b @ b))
            rank = float(a @ b) / size if size > 0.0 else math.nan
        results.append(Effect(name=name, index=explained / whole, rank=rank, certain=certain))
        numbers = remaining.pop(name)
        if certain:
            rest = rest - _class_means(numbers, rest)[numbers]
    return tuple(results)


def _effect(classes: Integers, values: Array) -> tuple[float, float]:
    """Return the sum of squares that classes explain beyond chance, and its p-value."""
    n, m = values.size, int(classes.max()) + 1
    whole = float(np.sum((values - values.mean()) ** 2))
    inside = float(np.sum((values - _class_means(classes, values)[classes]) ** 2))
    if inside <= 1e-24 * whole or whole == 0.0:
        return whole, float(whole == 0.0)
    ratio = (whole - inside) / (m - 1) / (inside / (n - m))
    return whole - inside * (n - 1) / (n - m), float(scipy.stats.f.sf(ratio, m - 1, n - m))


def _class_means(classes: Integers, values: Array) -> Array:
    return np.bincount(classes, weights=values) / np.bincount(classes)


def _classes(column: AnyArray) -> Integers:
    """Return the class of each variant: its value, or one of some intervals that hold equally many variants."""
    _, classes = np.unique(column, return_inverse=True)
    # The cube root: enough classes for a curve, and enough variants in each for its mean.
    wanted, distinct = max(round(column.size ** (1.0 / 3.0)), 3), int(classes.max()) + 1
    if column.dtype.kind in "fiu" and distinct > 4 * wanted:  # neither strings nor booleans
        ranks = scipy.stats.rankdata(classes, method="min") - 1
        _, classes = np.unique((ranks * wanted) // column.size, return_inverse=True)
    return np.asarray(classes, dtype=np.min_scalar_type(int(classes.max())))


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
        """True if the rows are too few for the indices: intervals of total indices are wide, or indices far outside 0 to 1."""
        return any(factor.reach > _WIDE for factor in self.factors) or any(
            not -_BEYOND <= index <= 1.0 + _BEYOND for factor in self.factors for index in (factor.first, factor.total)
        )


def sobol_indices(result: StudyResult, measure: str) -> SobolIndices:
    """Return the indices of a measure of a study with `sampling="sobol-indices"`.

    Raises:
        ValueError: the study was sampled otherwise, or there is no such measure.
    """
    if result.study.sampling != OF_INDICES:
        raise ValueError(f'Sobol\'s indices need a study with sampling="{OF_INDICES}"; this one has {result.study.sampling!r}.')
    names = measures_of(result.columns)
    if measure not in (*names, ALL):
        raise ValueError(unknown_measure(measure, names))
    return indices_of(result.columns, list(factors(result.study.quantities)), measure)


def indices_of(table: pa.Table, names: Sequence[str], measure: str) -> SobolIndices:
    """Return the indices of a measure from a table of variants in the order of `saltelli_points`; rows may be missing.

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
    generator, at_once = np.random.default_rng(_SEED), max(_BLOCK // kept.size, 1)
    parts: list[tuple[Array, Array]] = []
    for begin in range(0, RESAMPLES, at_once):
        rows = generator.integers(len(kept), size=(min(at_once, RESAMPLES - begin), len(kept)))
        parts.append(_estimates(kept[rows]))
    samples = np.stack([np.concatenate(both) for both in zip(*parts, strict=True)])
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(samples, [tail, 1.0 - tail], axis=1)  # of first-order and total indices, (2, n_factors) each
    indices = [
        SobolIndex(
            name=name, first=float(first[0, k]), total=float(total[0, k]),
            first_interval=(float(low[0, k]), float(high[0, k])),
            total_interval=(float(low[1, k]), float(high[1, k])),
        )
        for k, name in enumerate(names)
    ]  # fmt: skip
    indices.sort(key=lambda index: -index.total)
    return SobolIndices(measure=measure, factors=tuple(indices), rows=len(kept), dropped=dropped)


def _estimates(values: Array) -> tuple[Array, Array]:
    """Estimate first-order and total indices, (s, n_factors), from f of A, B and each A_B in s samples of n rows."""
    centred = values - values[:, :, :2].mean(axis=(1, 2), keepdims=True)
    a, b, mixed = centred[:, :, :1], centred[:, :, 1:2], centred[:, :, 2:]
    variance = np.mean(centred[:, :, :2] ** 2, axis=(1, 2))[:, None]
    variance = np.where(variance > 0.0, variance, np.inf)  # of resampled rows that happen to be all alike
    return np.mean(b * (mixed - a), axis=1) / variance, 0.5 * np.mean((a - mixed) ** 2, axis=1) / variance
