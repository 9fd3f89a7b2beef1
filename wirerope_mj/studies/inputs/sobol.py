"""The sampling of Sobol's indices: two sets of variants, and for each factor a third that has this factor from the second."""

from collections.abc import Sequence

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.inputs.column import Quantity

SAMPLING = "sobol-indices"  # Its name
FEWEST = 8  # Base rows below which no variance is worth the name


def factors(quantities: Sequence[Quantity]) -> dict[str, list[int]]:
    """Return the factors, whose indices are found, with the indices of their columns among all columns.

    A factor is one quantity with all its columns, or what bears the same `group`.
    """
    columns: dict[str, list[int]] = {}
    first = 0
    for quantity in quantities:
        own = range(first, first + len(quantity.columns))
        columns.setdefault(quantity.distribution.group or quantity.name, []).extend(own)
        first += len(quantity.columns)
    return columns


def base_rows(variants: int, n_factors: int) -> int:
    """Return the number n of base rows of n (factors + 2) variants.

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
        f"{FEWEST * of_row}, such as {' or '.join(str(of_row * one) for one in near)} ({' or '.join(map(str, near))} rows); "
        f"got {variants}."
    )


def points(groups: Sequence[Sequence[int]], variants: int, seed: int) -> Array:
    """Return numbers from 0 to 1, (variants, n_columns), of Saltelli's matrices (Saltelli et al. 2010).

    Row by row: A, B, then for each factor A with the columns of this factor, `groups`, from B. So a larger study begins
    with a smaller one, and what a failed variant spoils is one row. ValueError if there are too many columns for Sobol's
    sequence, or the number of variants does not suit.
    """
    rows = base_rows(variants, len(groups))
    columns = sum(map(len, groups))
    if 2 * columns > scipy.stats.qmc.Sobol.MAXDIM:
        raise ValueError(
            f"Sobol's sequence has {scipy.stats.qmc.Sobol.MAXDIM} dimensions, and {columns} numbers vary, each twice."
        )
    sequence = scipy.stats.qmc.Sobol(2 * columns, scramble=True, rng=np.random.default_rng(seed)).random(rows)
    # Sobol's first dimensions fill the space best, even in pairs: they go to factors of few columns, for each of which much
    # hangs on one number.
    order = [column for group in sorted(groups, key=len) for column in group]
    a, b = np.empty((2, rows, columns))
    a[:, order], b[:, order] = sequence[:, 0::2], sequence[:, 1::2]
    rows_of = np.repeat(a[:, None], len(groups) + 2, axis=1)
    rows_of[:, 1] = b
    for number, group in enumerate(groups, start=2):
        rows_of[:, number, group] = b[:, group]
    return rows_of.reshape(variants, columns)
