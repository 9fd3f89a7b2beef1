"""The sampling of Sobol's indices: two sets of variants, and for each factor a third that has this factor from the second."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import qmc

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.inputs.quantities import Quantity

SAMPLING = "sobol-indices"
"""The word for it."""

FEWEST = 8
"""Base rows below which no variance is worth the name."""


def factors(quantities: Sequence[Quantity]) -> dict[str, list[int]]:
    """Return the factors, whose indices are found, with the places of their columns among all columns.

    A factor is one quantity with all its columns, or what bears the same `group`.
    """
    found: dict[str, list[int]] = {}
    place = 0
    for quantity in quantities:
        places = range(place, place + len(quantity.columns))
        found.setdefault(quantity.distribution.group or quantity.name, []).extend(places)
        place += len(quantity.columns)
    return found


def base_rows(variants: int, n_factors: int) -> int:
    """Return the number n of base rows of n (factors + 2) variants.

    Raises:
        ValueError: n is not a power of two; says which numbers of variants are near.
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


def shares(groups: Sequence[Sequence[int]], variants: int, seed: int) -> Array:
    """Return numbers from 0 to 1, (variants, n_columns), of Saltelli's matrices (Saltelli et al. 2010).

    Row by row: A, B, then for each factor A with the columns of this factor from B. So a larger study begins with a smaller
    one, and what a failed variant spoils is one stretch.

    Args:
        groups: places of each factor's columns.
        variants: n (factors + 2) of them.
        seed: of Sobol's sequence.

    Raises:
        ValueError: there are too many columns for Sobol's sequence, or the number of variants does not suit.
    """
    rows = base_rows(variants, len(groups))
    columns = sum(map(len, groups))
    if 2 * columns > qmc.Sobol.MAXDIM:
        raise ValueError(f"Sobol's sequence has {qmc.Sobol.MAXDIM} dimensions, and {columns} numbers vary, each twice.")
    points = qmc.Sobol(2 * columns, scramble=True, rng=np.random.default_rng(seed)).random(rows)
    # Sobol's first dimensions fill the space best, even in pairs: they go to factors of few columns, for each of which much
    # hangs on one number.
    order = [place for group in sorted(groups, key=len) for place in group]
    a, b = np.empty((2, rows, columns))
    a[:, order], b[:, order] = points[:, 0::2], points[:, 1::2]
    found = np.repeat(a[:, None], len(groups) + 2, axis=1)
    found[:, 1] = b
    for number, group in enumerate(groups, start=2):
        found[:, number, group] = b[:, group]
    return found.reshape(variants, columns)
