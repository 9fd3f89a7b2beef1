"""Starts of a search: a coarse grid of the numbers that bend a loop, each with the best of those that stretch it.

The force of every law here is a sum of parts that some of its coordinates multiply (bound, stiffnesses). With the others
given, those follow from linear least squares in one step (variable projection, Golub and Pereyra 1973), so that a grid of a few
hundred shapes has points near the best fit whatever the sizes are.
"""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.coordinates import Coordinate, Family
from wirerope_mj.mounts.identification.measured import MeasuredLoop

SAMPLES = 60  # Samples of each loop that the grid looks at: its shape, not its noise


def grid_starts(
    family: Family,
    coordinates: Sequence[Coordinate],
    loops: Sequence[MeasuredLoop],
    fixed: Mapping[str, float],
    *,
    count: int,
) -> list[dict[str, float]]:
    """Return the values of the best points of the grid, and of the best for each pattern of signs that the grid has.

    Laws with coordinates of either sign can have a valley for each pattern, of depths that the noise does not tell apart: a
    spring that hardens to one side, and one that softens to the other beside a stiffer straight one. `count` is the number of
    the best points whatever their signs.
    """
    thin = [loop.thinned(SAMPLES) for loop in loops]
    amplitudes = np.array([np.ptp(loop.deflection) / 2.0 for loop in loops])
    axes = {
        c.name: [fixed[c.name]] if c.name in fixed else _grid_values(c, amplitudes) for c in coordinates if not c.linear
    }
    fits = []
    for point in itertools.product(*axes.values()):
        shape = dict(zip(axes, point, strict=True))
        values, cost = _stretched(family, coordinates, thin, shape, fixed)
        if np.isfinite(cost):
            fits.append((cost, values))
    fits.sort(key=lambda pair: pair[0])
    signed = [name for name, along in axes.items() if min(along) < 0.0 < max(along)]
    chosen = [values for _, values in fits[:count]]
    seen = {tuple(np.sign(values[name]) for name in signed) for values in chosen}
    for _, values in fits:
        pattern = tuple(np.sign(values[name]) for name in signed)
        if 0.0 not in pattern and pattern not in seen:
            seen.add(pattern)
            chosen.append(values)
    return chosen


def _grid_values(c: Coordinate, amplitudes: Array) -> list[float]:
    """Return the values of the grid along one coordinate."""
    smallest, largest = float(amplitudes.min()), float(amplitudes.max())
    by_name: dict[str, Sequence[float]] = {
        "sigma": (0.3, 0.6, 1.0, 1.5),
        "n": (1.0, 2.0),  # the two with closed forms: the grid takes a tenth of the time
        "exponent": (1.0, 2.0),
        "rounding": (0.0, 0.3 * largest),
        "loss": (0.1, 0.5),
        "reversal": (0.03 * largest, 0.2 * largest),
        "c_ln_b": (-1.0 / largest, 0.0, 1.0 / largest),
        "b2": (-8.0 / largest, -3.0 / largest, 3.0 / largest, 8.0 / largest),
        "g2": (2.0 / largest, 6.0 / largest, 20.0 / largest),
        "g3": (-0.4 * largest, 0.0, 0.4 * largest),
    }
    if c.name in ("gap_below", "gap_above"):  # loops may close by little
        return [float(v) for v in c.upper * np.array([0.0, 0.2, 0.4, 0.6, 0.75, 0.88, 0.96])]
    if c.name == "x1":
        return [float(v) for v in smallest * np.array([0.15, 0.5])]
    if "/" in c.name:  # Jenkin elements slip one after the other up to the largest amplitude
        return [2.0, 3.5]
    if c.name == "alpha":
        return [float(1.0 / v) for v in np.geomspace(0.1 * smallest, largest, 8)]
    if c.name in ("x_y", "u_c"):
        return [float(v) for v in np.geomspace(0.1 * smallest, largest, 8)]
    return [min(max(float(v), c.lower), c.upper) for v in by_name[c.name]]


def _stretched(
    family: Family,
    coordinates: Sequence[Coordinate],
    loops: Sequence[MeasuredLoop],
    shape: Mapping[str, float],
    fixed: Mapping[str, float],
) -> tuple[dict[str, float], float]:
    """Return all values with the best linear ones, and the mean square that is left."""
    linear = [c for c in coordinates if c.linear and c.name not in fixed]
    base = {c.name: fixed.get(c.name, max(c.lower, 0.0)) for c in coordinates if c.linear} | dict(shape)
    zero = _forces(family, base, loops)
    columns = []
    for c in linear:
        size = c.scale if not c.logarithmic else 0.01 * np.sqrt(c.lower * c.upper) + 10.0 * c.lower
        moved = base | {c.name: base[c.name] + size}
        columns.append((_forces(family, moved, loops) - zero) / size)
    measured = np.concatenate([(loop.force - loop.force.mean()) / loop.weight for loop in loops])
    matrix = np.stack(columns, axis=1)
    if not (np.isfinite(matrix).all() and np.isfinite(zero).all()):
        return {}, np.inf
    norms = np.linalg.norm(matrix, axis=0)
    norms[norms == 0.0] = 1.0
    low = np.array([(c.lower - base[c.name]) for c in linear]) * norms
    high = np.array([(c.upper - base[c.name]) for c in linear]) * norms
    best = scipy.optimize.lsq_linear(matrix / norms, measured - zero, (low - 1e-12 * np.abs(low), high))
    values = {c.name: float(base[c.name] + step) for c, step in zip(linear, best.x / norms, strict=True)}
    return base | values, 2.0 * float(best.cost) / measured.size


def _forces(family: Family, values: Mapping[str, float], loops: Sequence[MeasuredLoop]) -> Array:
    """Return the law's forces on all loops without their means, over the loops' weights."""
    law = family.make(dict(values))
    parts = [loop.model_force(law) for loop in loops]
    return np.concatenate([(part - part.mean()) / loop.weight for part, loop in zip(parts, loops, strict=True)])
