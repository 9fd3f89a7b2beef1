"""Which inputs of a study matter: how much of a measure's variance each explains alone, and which way it goes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from scipy.stats import f as f_distribution
from scipy.stats import rankdata

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.engines.compute import DONE

CHANCE = 0.01
"""How likely any of the inputs may be called certain by accident, if none has an effect."""

SMALLEST_SHARE = 0.005
"""Share of the variance below which no effect is called certain: the test takes the scatter in all classes for equal, which is
not quite so where inputs act together, and so little matters to nobody."""

_LEAST = 12  # variants below which nothing is said: three bins of four


@dataclass(frozen=True, kw_only=True)
class Influence:
    """What one input does to a measure.

    Attributes:
        name: of the input.
        share: of the measure's variance that the input alone explains, its first-order Sobol index; 0 to 1, and by chance a
            little less than 0 where there is no effect.
        rank: Spearman's correlation of input and measure, -1 to 1; NaN where the input has no order.
        certain: whether chance alone would hardly give such a share to any of the inputs.
    """

    name: str
    share: float
    rank: float
    certain: bool


def influences(table: pa.Table, inputs: Sequence[str], measure: str) -> tuple[Influence, ...]:
    """Return what each input does to a measure, the strongest first; nothing if too few variants can tell.

    The share is estimated from the variants as they are (given data): the input is cut into classes with as many variants
    each, and eta^2 = variance between classes / variance. What classes without any effect would give by chance is taken
    away: 1 - (1 - eta^2)(n - 1)/(n - m) of n variants in m classes (epsilon^2, Kelley 1935). It needs no special sampling,
    and sees effects that rise and fall again. The strongest input comes first, and what its classes explain is taken from
    the measure before the next one is looked at: few variants of many inputs are never quite independent (pairs of Sobol's
    dimensions least of all), and a strong input would lend its effect to others. Of inputs that do depend on each other, such
    as the parameters of a specimen, the stronger one is given what they do together.

    Args:
        table: of a study.
        inputs: names of its columns.
        measure: name of a column.
    """
    values, done = np.asarray(table[measure], dtype=np.float64), np.asarray(table["status"]) == DONE
    kept = done & np.isfinite(values)
    values = values[kept]
    if values.size < _LEAST or np.ptp(values) <= 1e-12 * np.abs(values).max():
        return ()
    columns = {name: np.asarray(table[name])[kept] for name in inputs}
    classes = {name: _classes(column) for name, column in columns.items()}
    left = {name: places for name, places in classes.items() if 2 <= places.max() + 1 <= values.size / 2}
    whole, rest = float(np.sum((values - values.mean()) ** 2)), values - values.mean()
    found, certain = [], True
    effects: dict[str, tuple[float, float]] = {}
    while left:
        if certain:  # the measure has changed
            effects = {name: _effect(places, rest) for name, places in left.items()}
        name = max(left, key=lambda one: effects[one][0])
        explained, chance = effects[name]
        certain = chance < CHANCE / len(classes) and explained >= SMALLEST_SHARE * whole
        found.append(Influence(name=name, share=explained / whole, rank=_rank(columns[name], values), certain=certain))
        places = left.pop(name)
        if certain:
            rest = rest - _class_means(places, rest)[places]
    return tuple(found)


def _effect(classes: npt.NDArray[np.int64], values: Array) -> tuple[float, float]:
    """Return the sum of squares that classes explain beyond chance, and how likely chance gives as much."""
    n, m = values.size, int(classes.max()) + 1
    whole = float(np.sum((values - values.mean()) ** 2))
    inside = float(np.sum((values - _class_means(classes, values)[classes]) ** 2))
    if inside <= 1e-24 * whole or whole == 0.0:
        return whole, float(whole == 0.0)
    ratio = (whole - inside) / (m - 1) / (inside / (n - m))
    return whole - inside * (n - 1) / (n - m), float(f_distribution.sf(ratio, m - 1, n - m))


def _class_means(classes: npt.NDArray[np.int64], values: Array) -> Array:
    return np.bincount(classes, weights=values) / np.bincount(classes)


def _classes(column: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """Return the class of each variant: its value, or of many different numbers one of some stretches of equal size."""
    _, places = np.unique(column, return_inverse=True)
    if column.dtype.kind not in "fiu":  # words and truth values
        return np.asarray(places, dtype=np.int64)
    # The cube root: enough classes for a curve, and enough variants in each for its mean.
    wanted = max(round(column.size ** (1.0 / 3.0)), 3)
    distinct = int(places.max()) + 1
    if distinct <= 4 * wanted:
        return np.asarray(places, dtype=np.int64)
    ranks = rankdata(places, method="min") - 1
    _, classes = np.unique((ranks * wanted) // column.size, return_inverse=True)
    return np.asarray(classes, dtype=np.int64)


def _rank(column: npt.NDArray[Any], values: Array) -> float:
    """Return Spearman's correlation: Pearson's of the ranks."""
    if column.dtype.kind not in "fiub":
        return math.nan
    a, b = rankdata(column.astype(np.float64)), rankdata(values)
    a, b = a - a.mean(), b - b.mean()
    size = math.sqrt(float(a @ a) * float(b @ b))
    return float(a @ b) / size if size > 0.0 else math.nan
