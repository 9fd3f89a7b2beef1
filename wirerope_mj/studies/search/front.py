"""Feasible designs of a table, and the Pareto front of them."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.ended import ended_early
from wirerope_mj.studies.engines.compute import DONE

Mask = npt.NDArray[np.bool_]


def objectives(table: pa.Table, names: Sequence[str]) -> Array:
    """Return what is minimised of every design, (n, n_names); infinite where a design failed or nothing is judged.

    Neither is a design whose run ends before its peaks are over: softer ones would win for having been stopped.
    """
    values = np.full((table.num_rows, len(names)), np.inf)
    done = np.asarray(table["status"]) == DONE
    for index, name in enumerate(names):
        column = np.asarray(table[name], dtype=np.float64)
        values[:, index] = np.where(done & ~ended_early(table, name) & ~np.isnan(column), column, np.inf)
    return values


def violations(table: pa.Table, limits: Mapping[str, float]) -> Array:
    """Return by how much every design exceeds each limit, relative to it, (n, n_limits): <= 0 where it is kept.

    Of a limit 0 it is the value itself. Infinite where a design failed or nothing is judged: nobody knows that it is kept.
    """
    allowed = np.array(list(limits.values()))
    return (objectives(table, list(limits)) - allowed) / np.where(allowed == 0.0, 1.0, np.abs(allowed))


def feasible(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> Mask:
    """Return the mask of the designs that were simulated, have a value of all that is minimised, and keep all limits, (n,)."""
    return np.asarray(
        np.isfinite(objectives(table, names)).all(axis=1) & (violations(table, limits) <= 0.0).all(axis=1)
    )


def front(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> list[int]:
    """Return the rows of the Pareto-optimal feasible designs, those with the least of the first name first.

    A design is one of them unless another feasible one is not worse in any respect and better in one; of several that are
    equal in all respects it is the first.
    """
    values = objectives(table, names)
    candidates = np.flatnonzero(feasible(table, names, limits))
    order = candidates[np.lexsort([candidates, *values[candidates].T[::-1]])]
    kept: list[int] = []
    for row in order:  # what beats a row stands before it
        if not any((values[other] <= values[row]).all() for other in kept):
            kept.append(int(row))
    return kept


def nearest(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> tuple[int, str, float] | None:
    """Return the row that exceeds its limits the least, the limit that it exceeds most, and by how much of it.

    None if no design has values by which it could be judged.
    """
    rows = nearest_first(table, names, limits)
    if not limits or not rows:
        return None
    over = violations(table, limits)[rows[0]]
    index = int(np.argmax(over))
    return rows[0], list(limits)[index], float(over[index])


def nearest_first(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> list[int]:
    """Return the rows that can be judged, that which exceeds its limits the least first."""
    over = violations(table, limits).max(axis=1, initial=-math.inf)
    worst = np.where(np.isfinite(objectives(table, names)).all(axis=1), over, np.inf)
    return [int(row) for row in np.argsort(worst, kind="stable") if worst[row] < np.inf]
