"""Starts of a search: a coarse grid of the nonlinear coordinates, each point with the best of the linear ones.

The force of every law here is a sum of parts that some of its coordinates multiply (bound, stiffnesses). With the others
given, those follow from linear least squares in one step (variable projection, Golub and Pereyra 1973), so that a grid of a few
hundred shapes has points near the best fit whatever the sizes are.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations, pairwise, product

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.families import RESOLVED, Family
from wirerope_mj.mounts.identification.measured import MeasuredLoop, ScaleLoop
from wirerope_mj.mounts.identification.scales import APART
from wirerope_mj.mounts.identification.search import Unknowns

SAMPLES = 60  # Samples of each loop that the grid is compared with: its shape, not its noise


def grid_starts(unknowns: Unknowns, loops: Sequence[MeasuredLoop], *, count: int) -> list[dict[str, float]]:
    """Choose the best points of the grid of parameter values, and the best point for each pattern of their signs, as starts.

    Laws with coordinates of either sign can have a valley for each pattern, of depths that the noise does not tell apart: a
    spring that hardens to one side, and one that softens to the other beside a stiffer straight one. `count` is the number of
    the best points whatever their signs.
    """
    thin = [loop.thinned(SAMPLES) for loop in loops]
    nonlinear, fixed = [c for c in unknowns.coordinates if not c.linear], unknowns.fixed
    within = {c.name: [min(max(float(value), c.lower), c.upper) for value in c.grid] for c in nonlinear}
    axes = {name: [fixed[name]] if name in fixed else values for name, values in within.items()}
    fits = []
    for point in product(*axes.values()):
        shape = dict(zip(axes, point, strict=True))
        values, cost = _complete(unknowns, thin, shape)
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


def _complete(unknowns: Unknowns, loops: Sequence[MeasuredLoop], shape: Mapping[str, float]) -> tuple[dict[str, float], float]:
    """Complete nonlinear values, the shape, by the best linear values; return all values and the mean square residual."""
    linear = [c for c in unknowns.free if c.linear]
    multiplied, fixed = [c for c in unknowns.coordinates if c.linear], unknowns.fixed
    base = {c.name: fixed.get(c.name, max(c.lower, 0.0)) for c in multiplied} | dict(shape)
    zero = _forces(unknowns.family, base, loops)
    columns = []
    for c in linear:
        size = c.scale if not c.logarithmic else 0.01 * np.sqrt(c.lower * c.upper) + 10.0 * c.lower
        moved = base | {c.name: base[c.name] + size}
        columns.append((_forces(unknowns.family, moved, loops) - zero) / size)
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
    """Evaluate a law's forces on all loops, without their means, over the loops' weights, (n,)."""
    law = family.make(dict(values))
    parts = [loop.model_force(law) for loop in loops]
    return np.concatenate([(part - part.mean()) / loop.weight for part, loop in zip(parts, loops, strict=True)])


_YIELD = 12  # number of yield deflections of the grid, from twice what the least amplitude shows to the largest amplitude
_EXPONENTS = (1.0, 2.0)  # the two with closed forms
_SIGMAS = (0.5, 1.0)
_ASYMMETRIES = (-1.0, -0.3, 0.0, 0.3, 1.0)  # times one over the largest amplitude
_Point = tuple[float, dict[str, float]]  # of the grid: mean squares left, its values by coordinate


def scale_starts(unknowns: Unknowns, loops: Sequence[MeasuredLoop], names: Sequence[str]) -> list[dict[str, float]]:
    """Choose the best grid point for each n and sigma as a start, best first: searches from them may end at different minima.

    The scales are named, the largest first.
    """
    thin = [ScaleLoop.of(loop.thinned(SAMPLES)) for loop in loops]
    fixed = unknowns.fixed
    exponents = sorted({fixed[f"n_{name}"] for name in names if f"n_{name}" in fixed}) or _EXPONENTS
    sigmas = [fixed["sigma"]] if "sigma" in fixed else _SIGMAS
    grids = [_points_of(unknowns, thin, names, n, sigma) for n, sigma in product(exponents, sigmas)]
    best = [min(points, key=lambda point: point[0]) for points in grids]
    return [values | dict(fixed) for _, values in sorted(best, key=lambda point: point[0])]


def _points_of(unknowns: Unknowns, loops: Sequence[ScaleLoop], names: Sequence[str], n: float, sigma: float) -> list[_Point]:
    """Return the grid's points and misfits for one n and sigma: all yield deflections far enough apart, every asymmetry."""
    amplitudes = [loop.amplitude for loop in loops]
    yields = np.geomspace(2.0 * RESOLVED * min(amplitudes), max(amplitudes), _YIELD)
    shapes = [[loop.shape(float(x_y), sigma, n) for loop in loops] for x_y in yields]
    springs = [c for c in unknowns.coordinates if c.name in _POWERS]
    picks = combinations(range(_YIELD), len(names))
    choices = [pick for pick in picks if all(yields[b] >= APART * yields[a] for a, b in pairwise(pick))]
    measured = np.concatenate([(loop.force - loop.force.mean()) / loop.weight for loop in loops])
    points = []
    asymmetries = [0.0]
    if any(c.name == "c_ln_b" for c in unknowns.coordinates):
        tried = [asymmetry / max(amplitudes) for asymmetry in _ASYMMETRIES]
        asymmetries = [unknowns.fixed["c_ln_b"]] if "c_ln_b" in unknowns.fixed else tried
    for asymmetry in asymmetries:
        scale_columns = [_column(loops, shape, asymmetry) for shape in shapes]
        spring_columns = []  # of unit springs, in every averaged cycle
        for power in (_POWERS[c.name] for c in springs):
            units = [np.sign(loop.deflection) * np.abs(loop.deflection) ** power for loop in loops]
            forces = [np.tile(unit, (max(loop.averaged, 1), 1)) for loop, unit in zip(loops, units, strict=True)]
            spring_columns.append(_column(loops, forces, asymmetry))
        least = np.array([0.0] * len(names) + [c.lower for c in springs])
        for pick in choices:
            matrix = np.stack([*(scale_columns[index] for index in pick[::-1]), *spring_columns], axis=1)
            norms = np.linalg.norm(matrix, axis=0)
            best = np.linalg.lstsq(matrix / norms, measured, rcond=None)[0]
            if (best < least * norms).any():
                best = scipy.optimize.lsq_linear(matrix / norms, measured, (least * norms, np.inf)).x
            linear, cost = best / norms, float(np.sum((matrix / norms @ best - measured) ** 2))
            x_y = yields[list(pick[::-1])]
            values = {f"z_max_{name}": float(linear[index]) for index, name in enumerate(names)}
            values |= {f"x_y_{names[0]}": float(x_y[0]), "sigma": sigma, "c_ln_b": asymmetry}
            values |= {f"x_y_{a}/{b}": float(x_y[i] / x_y[i + 1]) for i, (a, b) in enumerate(pairwise(names))}
            values |= {f"n_{name}": n for name in names}
            values |= {c.name: float(value) for c, value in zip(springs, linear[len(names) :], strict=True)}
            points.append((cost, values))
    return points


_POWERS: Mapping[str, int] = {"k": 1, "k1": 1, "k2": 2, "k3": 3}


def _column(loops: Sequence[ScaleLoop], forces: Sequence[Array], asymmetry: float) -> Array:
    """Stack unit forces on all loops with the asymmetry, without their means, over the loops' weights."""
    parts = []
    for loop, force in zip(loops, forces, strict=True):
        part = loop.as_measured(np.exp(asymmetry * loop.deflection) * force)
        parts.append((part - part.mean()) / loop.weight)
    return np.concatenate(parts)
