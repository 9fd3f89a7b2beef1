"""The inputs of all variants: sampled probabilities, made into values by the quantities' distributions.

And how well the scatter of a few specimens is known.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import pyarrow as pa
import scipy

from wirerope_mj.foundation.arguments import integer, one_of
from wirerope_mj.foundation.arrays import AnyArray, Array
from wirerope_mj.foundation.budget import require_memory
from wirerope_mj.mounts.isolator import Isolator, Spread
from wirerope_mj.studies.vary.distributions import LARGEST, SMALLEST, Choice, Specimens, Uniform
from wirerope_mj.studies.vary.quantity import Quantity

LISTED = ("grid", "list")  # Samplings of values that are listed, and not sampled
# Eigenvalue of the correlations, of the largest one, below which a direction does not scatter: rounding leaves 1e-15, and the
# noise of fits, which is scatter, 1e-4 and more.
RANK = 1e-9
_OF_A_NUMBER = 24  # Bytes that one number of the inputs takes: its probability, its value, and its place in the table
OF_INDICES = "sobol-indices"  # the sampling of Saltelli's matrices, from which Sobol indices are found
SAMPLINGS = ("sobol", "latin-hypercube", "random", *LISTED, OF_INDICES)
BLOCK = 2**16  # variants that are drawn at once: of a million, the inputs are never in memory together
FEWEST = 8  # base rows of these matrices below which no variance is worth the name


def drawing(
    quantities: Sequence[Quantity], *, variants: int | None, sampling: str, seed: int
) -> tuple[int, Callable[[int, int], pa.Table]]:
    """Return the number of variants, and a function that draws inputs of some, given the first and how many.

    The same arguments give the same table, whatever is drawn at once. With "sobol", "sobol-indices" and "random" the first
    variants of a larger study are those of a smaller one. ValueError if the number of variants is not positive or does not
    suit the sampling, the sampling is unknown, or a grid has no listed values.
    """
    one_of("sampling", sampling, SAMPLINGS)
    if sampling in LISTED:
        lists = _lists(quantities, variants, sampling)
        size = len(lists[0]) if sampling == "list" else math.prod(map(len, lists))
        return size, partial(_listed, quantities, lists, sampling)
    columns = sum(len(quantity.columns) for quantity in quantities)
    size = integer("variants", variants, least=1)
    _require_memory(size, columns)
    points: Callable[[int, int], Array]
    if sampling == OF_INDICES:
        groups = factors(quantities)
        base_rows(size, len(groups))
        if 2 * columns > (most := scipy.stats.qmc.Sobol.MAXDIM):
            raise ValueError(f"Sobol's sequence has {most} dimensions, and {columns} numbers vary, each twice.")
        points = partial(saltelli_points, list(groups.values()), size, seed)
    elif sampling == "random":
        points = partial(_random_points, columns, seed)
    elif sampling == "latin-hypercube":  # whose strata are shuffled over all variants
        hypercube = cache(lambda: scipy.stats.qmc.LatinHypercube(columns, rng=np.random.default_rng(seed)).random(size))
        points = lambda first, count: hypercube()[first : first + count]  # noqa: E731
    else:
        if columns > (most := scipy.stats.qmc.Sobol.MAXDIM):
            raise ValueError(
                f"Sobol's sequence has {most} dimensions, and {columns} numbers vary; use `sampling` "
                '"latin-hypercube" or "random".'
            )
        points = partial(_sobol_points, columns, seed)
    for quantity in quantities:  # what the distributions refuse is refused now
        values_at(quantity, np.full((1, len(quantity.columns)), 0.5))
    return size, partial(_sampled, quantities, points)


def _random_points(columns: int, seed: int, first: int, count: int) -> Array:
    """Draw a piece of NumPy's random numbers, (count, columns)."""
    generator = np.random.PCG64(seed)
    generator.advance(first * columns)  # a number takes a step
    return np.random.Generator(generator).random((count, columns))


def _sobol_points(columns: int, seed: int, first: int, count: int) -> Array:
    """Draw a piece of Sobol's sequence, (count, columns); the piece is drawn to a power of two, in which it is balanced."""
    sequence = scipy.stats.qmc.Sobol(columns, scramble=True, rng=np.random.default_rng(seed))
    if first:
        sequence.fast_forward(first)
    return np.asarray(sequence.random(1 << max(count - 1, 0).bit_length())[:count])


def _sampled(quantities: Sequence[Quantity], points: Callable[[int, int], Array], first: int, count: int) -> pa.Table:
    """Draw the inputs of some variants: probabilities, one for each column, and values at them."""
    ends = np.cumsum([len(quantity.columns) for quantity in quantities])[:-1]
    blocks = zip(quantities, np.split(points(first, count), ends, axis=1), strict=True)
    return _table(quantities, [column for quantity, part in blocks for column in values_at(quantity, part)], first)


def _table(quantities: Sequence[Quantity], values: Sequence[Sequence[Any] | AnyArray], first: int) -> pa.Table:
    """Join the values of all columns, (n,) each, to a table of inputs with variants numbered from `first` on."""
    columns = [column for quantity in quantities for column in quantity.columns]
    numbers = pa.array(np.arange(first, first + len(values[0])), type=pa.int64())
    arrays = [pa.array(value, type=column.type) for value, column in zip(values, columns, strict=True)]
    return pa.table([numbers, *arrays], names=["variant", *(column.name for column in columns)])


def _require_memory(variants: int, columns: int) -> None:
    """Raise BudgetError if the table of inputs is larger than memory."""
    require_memory(
        f"the inputs of {float(min(variants, 10**300)):.4g} variants",
        float(min(variants, 10**300)) * (columns + 1) * _OF_A_NUMBER,
        "Compute fewer `variants`: a probability of exceedance p is known to sqrt(p / variants).",
    )


def values_at(quantity: Quantity, points: Array) -> list[AnyArray]:
    """Map probabilities between 0 and 1, (n, n_columns), to the values of a quantity's columns, (n,) each."""
    distribution = quantity.distribution
    if not isinstance(distribution, Specimens):
        return [distribution.values(column) for column in points.T]
    values: list[AnyArray] = []
    for isolator in quantity.isolators:
        size = len(isolator.spread.parameters) if isolator.spread else 0
        normals = scipy.special.ndtri(np.clip(points[:, len(values) : len(values) + size], SMALLEST, LARGEST))
        values += list(sample_parameters(isolator, normals).T)
    return values


def sample_parameters(isolator: Isolator, normals: Array) -> Array:
    """Draw specimens' parameters from an isolator's spread, (n, n_parameters), by as many standard normals."""
    # Directions in which the specimens did not scatter have none, and parameters that were always equal, as those of both limit
    # curves of a law whose file states one, have the same columns.
    spread = isolator.spread
    assert spread is not None  # `quantities` has seen to it
    laws = [(isolator.axes[axis], key) for axis, key in (name.split(".", 1) for name in spread.parameters)]
    mean = np.array([law.parameter(key) for law, key in laws if law is not None], dtype=np.float64)
    covariance = np.array(spread.covariance)
    sizes = np.sqrt(np.where(np.diag(covariance) > 0.0, np.diag(covariance), 1.0))
    # As correlations, because stiffness and sharpness differ by ten orders of magnitude.
    correlation = covariance / np.outer(sizes, sizes)
    values, vectors = np.linalg.eigh(correlation)
    if values.min() < -1e-9 * max(values.max(), 1.0):
        raise ValueError(f"the covariance in the [spread] of isolator {isolator.name!r} is not positive semidefinite.")
    kept = np.where(values > RANK * values.max(initial=0.0), values, 0.0)
    root = (vectors * np.sqrt(kept)) @ vectors.T * sizes
    for k, row in enumerate(correlation):
        twin = int(np.argmax(row > 1.0 - RANK))  # the first parameter that is as this one, itself at the latest
        if row[twin] > 1.0 - RANK and mean[twin] == mean[k] and math.isclose(sizes[twin], sizes[k], rel_tol=RANK):
            root[:, k] = root[:, twin]
    # Sums in one order, so that a value has the same bits however many variants there are, and those of its twin.
    return np.asarray(mean + sum(normals[:, [k]] * root[k] for k in range(mean.size)))


def _lists(quantities: Sequence[Quantity], variants: int | None, sampling: str) -> list[list[Any]]:
    """Return the values that each column takes in a list or a grid; ValueError if they do not suit."""
    lists: list[list[Any]] = []
    for quantity in quantities:
        distribution = quantity.distribution
        values = distribution.listed if isinstance(distribution, Choice | Uniform) else []
        if not values:
            raise ValueError(
                f"`vary`: {quantity.name!r} has no values for a {sampling}; give a Choice(...), or a Uniform(..., points=...)."
            )
        lists += [values] * len(quantity.columns)
    sizes = [len(values) for values in lists]
    if sampling == "list" and len(set(sizes)) > 1:
        raise ValueError(f"the quantities of a list must all have as many values, got {', '.join(map(str, sizes))}.")
    size = sizes[0] if sampling == "list" else math.prod(sizes)
    if variants is not None and variants != size:
        raise ValueError(f"`variants` must be left out of a {sampling}, or be its size {size}, got {variants}.")
    _require_memory(size, len(sizes))
    return lists


def _listed(quantities: Sequence[Quantity], lists: Sequence[list[Any]], sampling: str, first: int, count: int) -> pa.Table:
    """Return inputs of a list, or of a grid: all combinations; the last one varies fastest."""
    if sampling == "list":
        return _table(quantities, [values[first : first + count] for values in lists], first)
    indices = np.unravel_index(np.arange(first, first + count), [len(values) for values in lists])
    return _table(quantities, [[values[k] for k in row] for values, row in zip(lists, indices, strict=True)], first)


def factors(quantities: Sequence[Quantity]) -> dict[str, list[int]]:
    """Return the factors for which Sobol's indices are computed, with the numbers of their columns among all columns.

    A factor is one quantity with all its columns, or what bears the same `group`.
    """
    columns: dict[str, list[int]] = {}
    first = 0
    for quantity in quantities:
        numbers = range(first, first + len(quantity.columns))
        columns.setdefault(quantity.distribution.group or quantity.name, []).extend(numbers)
        first += len(quantity.columns)
    return columns


def base_rows(variants: int, n_factors: int) -> int:
    """Return the number n of base rows in n (factors + 2) variants.

    ValueError if n is not a power of two; says which numbers of variants are near.
    """
    of_row = n_factors + 2
    rows = variants / of_row
    power = max(int(np.floor(np.log2(max(rows, 1.0)))), FEWEST.bit_length() - 1)
    if rows == 2**power:
        return 2**power
    near = [2**power, 2 ** (power + 1)] if rows > FEWEST else [FEWEST]
    raise ValueError(
        f"`variants` must be {of_row} times a power of two for the indices of {n_factors} factors, at least "
        f"{FEWEST * of_row}, such as {' or '.join(str(of_row * base) for base in near)} ({' or '.join(map(str, near))} rows); "
        f"got {variants}."
    )


def saltelli_points(
    groups: Sequence[Sequence[int]], variants: int, seed: int, first: int = 0, count: int | None = None
) -> Array:
    """Draw probabilities between 0 and 1, (count, n_columns), as rows of Saltelli's matrices (Saltelli et al. 2010).

    Row by row: A, B, then for each factor A with the columns of this factor, `groups`, from B. So a larger study begins
    with a smaller one, and what a failed variant spoils is one row. ValueError if the number of variants does not suit.
    """
    base_rows(variants, len(groups))
    of_row, end = len(groups) + 2, variants if count is None else first + count
    begin = first // of_row
    columns, rows = sum(map(len, groups)), -(-end // of_row) - begin
    sequence = _sobol_points(2 * columns, seed, begin, rows)
    # Sobol's first dimensions fill the space best, even in pairs: they go to factors of few columns, for each of which much
    # hangs on one number.
    order = [column for group in sorted(groups, key=len) for column in group]
    a, b = np.empty((2, rows, columns))
    a[:, order], b[:, order] = sequence[:, 0::2], sequence[:, 1::2]
    rows_of = np.repeat(a[:, None], of_row, axis=1)
    rows_of[:, 1] = b
    for number, group in enumerate(groups, start=2):
        rows_of[:, number, group] = b[:, group]
    return rows_of.reshape(rows * of_row, columns)[first - begin * of_row : end - begin * of_row]


_UNTESTED = ("catalogue", "estimated")  # kinds of isolators whose scatter is no specimens'


def rank(spread: Spread) -> int:
    """Return the number of independent directions in which parameters scatter; of n specimens at most n - 1."""
    covariance = np.array(spread.covariance)
    sizes = np.sqrt(np.diag(covariance))
    kept = sizes > 0.0
    values = np.linalg.eigvalsh(covariance[np.ix_(kept, kept)] / np.outer(sizes[kept], sizes[kept]))
    return int((values > RANK * values.max(initial=0.0)).sum())


def known_specimens(spread: Spread) -> int | None:
    """Return the number of specimens behind a covariance; None if calibrated or of full rank, hence of any larger number."""
    directions = rank(spread)
    return directions + 1 if directions < len(spread.parameters) and not spread.calibrated else None


def deviation_bounds(specimens: int) -> tuple[float, float]:
    """Return the bounds of the true standard deviation over that of some specimens, at 95 % confidence.

    (n - 1) s^2 / sigma^2 of n normal specimens is chi-squared with n - 1 degrees of freedom.
    """
    specimens = integer("specimens", specimens, least=2)
    tail = (1.0 - 0.95) / 2.0
    low, high = scipy.stats.chi2.ppf([tail, 1.0 - tail], specimens - 1)
    return math.sqrt((specimens - 1) / high), math.sqrt((specimens - 1) / low)


def specimen_messages(quantities: Sequence[Quantity]) -> list[str]:
    """Return for every isolator with varied specimens how accurately their scatter is known."""
    isolators = {
        isolator.name: isolator
        for quantity in quantities
        if isinstance(quantity.distribution, Specimens)
        for isolator in quantity.isolators
    }
    texts = []
    for name, isolator in isolators.items():
        spread, kind = isolator.spread, isolator.provenance.kind
        if spread is None:
            continue
        if spread.calibrated:
            texts.append(
                f"Specimens of {name}: drawn from what its calibration leaves open; specimens of one make scatter besides."
            )
        elif kind in _UNTESTED:
            texts.append(
                f"Specimens of {name} ({kind}): none were tested; they are drawn from the scatter that its file assumes."
            )
        elif (specimens := known_specimens(spread) or 0) >= 2:
            low, high = deviation_bounds(specimens)
            texts.append(
                f"Specimens of {name}: {len(spread.parameters)} parameters scatter along {specimens - 1} directions, so they "
                f"come from {specimens} specimens: the true standard deviations are {low:.2g} to {high:.2g} times those (95 % "
                "confidence), and percentiles are no better known; `redrawn` shows what as many others might have given."
            )
    return texts


def redrawn(isolator: Isolator, *, seed: int, specimens: int | None = None) -> Isolator:
    """Draw the isolator that a test of other specimens of the same make might have given.

    They are sampled from the isolator's own spread; their mean and covariance replace parameters and spread. Studies with
    several seeds show how far a result hangs on the specimens that happened to be tested (a parametric bootstrap).

    Args:
        isolator: with a [spread].
        seed: of the sample.
        specimens: how many were tested, >= 2; None if fewer than there are parameters, which the covariance then shows.

    Raises:
        ValueError: the isolator has no spread, or an argument is out of range, or a parameter leaves its law's range.
    """
    if isolator.spread is None:
        raise ValueError(f"isolator {isolator.name!r} has no [spread].")
    if specimens is None:
        specimens = known_specimens(isolator.spread)
        if specimens is None:
            raise ValueError(f"`specimens` must be given: the [spread] of {isolator.name!r} does not say how many there were.")
    specimens = integer("specimens", specimens, least=2)
    normals = np.random.default_rng(seed).standard_normal((specimens, len(isolator.spread.parameters)))
    values = sample_parameters(isolator, normals)
    laws: dict[str, dict[str, float]] = {}
    for name, value in zip(isolator.spread.parameters, values.mean(axis=0), strict=True):
        axis, _, key = name.partition(".")
        laws.setdefault(axis, {})[key] = float(value)
    covariance = np.atleast_2d(np.cov(values, rowvar=False))
    return replace(
        isolator,
        spread=replace(isolator.spread, covariance=tuple(tuple(float(number) for number in row) for row in covariance)),
        **{axis: replace(law, **law.completed(laws[axis])) for axis, law in isolator.axes.items() if law and axis in laws},  # type: ignore[arg-type]
    )
