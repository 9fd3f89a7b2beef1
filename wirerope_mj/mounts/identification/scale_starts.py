"""Starts of a search for several scales: yield deflections from a grid, what is linear by least squares."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise, product

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.coordinates import SEEN
from wirerope_mj.mounts.identification.measured import MeasuredLoop, ScaleLoop
from wirerope_mj.mounts.identification.scales import APART
from wirerope_mj.mounts.identification.search import Unknowns
from wirerope_mj.mounts.identification.start import SAMPLES

_YIELD = 12  # Yield deflections of the grid, from twice what the least amplitude shows to the largest amplitude
_EXPONENTS = (1.0, 2.0)  # the two with closed forms
_SIGMAS = (0.5, 1.0)
_ASYMMETRIES = (-1.0, -0.3, 0.0, 0.3, 1.0)  # times one over the largest amplitude


@dataclass(frozen=True, kw_only=True)
class _Point:
    """One point of the grid: mean squares left, its values by coordinate."""

    cost: float
    values: dict[str, float]


def scale_starts(unknowns: Unknowns, loops: Sequence[MeasuredLoop], names: Sequence[str]) -> list[dict[str, float]]:
    """Return the values of the best point of the grid for each n and sigma, best first: searches from two may end in others.

    Args:
        unknowns: coordinates of a law of several scales.
        loops: as they were measured.
        names: of the scales, the largest first.
    """
    thin = [ScaleLoop.of(loop.thinned(SAMPLES)) for loop in loops]
    fixed = unknowns.fixed
    exponents = sorted({fixed[f"n_{name}"] for name in names if f"n_{name}" in fixed}) or _EXPONENTS
    sigmas = [fixed["sigma"]] if "sigma" in fixed else _SIGMAS
    bends = [_with_bend(unknowns, thin, names, n, sigma) for n, sigma in product(exponents, sigmas)]
    best = [min(points, key=lambda point: point.cost) for points in bends]
    return [point.values | dict(fixed) for point in sorted(best, key=lambda point: point.cost)]


def _with_bend(
    unknowns: Unknowns, loops: Sequence[ScaleLoop], names: Sequence[str], n: float, sigma: float
) -> list[_Point]:
    """Return the points of one n and one sigma: every choice of yield deflections apart, every asymmetry."""
    amplitudes = [loop.amplitude for loop in loops]
    yields = np.geomspace(2.0 * SEEN * min(amplitudes), max(amplitudes), _YIELD)
    shapes = [[loop.shape(float(x_y), sigma, n) for loop in loops] for x_y in yields]
    springs = [c for c in unknowns.coordinates if c.name in _POWERS]
    choices = [pick for pick in combinations(range(_YIELD), len(names)) if _apart(yields[list(pick)])]
    measured = np.concatenate([(loop.force - loop.force.mean()) / loop.weight for loop in loops])
    points = []
    for asymmetry in _asymmetries(unknowns, max(amplitudes)):
        scale_columns = [_column(loops, shape, asymmetry) for shape in shapes]
        spring_columns = [
            _column(loops, [_spring(loop, _POWERS[c.name]) for loop in loops], asymmetry) for c in springs
        ]
        least = np.array([0.0] * len(names) + [c.lower for c in springs])
        for pick in choices:
            matrix = np.stack([*(scale_columns[index] for index in pick[::-1]), *spring_columns], axis=1)
            linear, cost = _best_linear(matrix, measured, least)
            x_y = yields[list(pick[::-1])]
            values = {f"z_max_{name}": float(linear[index]) for index, name in enumerate(names)}
            values |= {f"x_y_{names[0]}": float(x_y[0]), "sigma": sigma, "c_ln_b": asymmetry}
            values |= {f"x_y_{a}/{b}": float(x_y[i] / x_y[i + 1]) for i, (a, b) in enumerate(pairwise(names))}
            values |= {f"n_{name}": n for name in names}
            values |= {c.name: float(value) for c, value in zip(springs, linear[len(names) :], strict=True)}
            points.append(_Point(cost=cost, values=values))
    return points


_POWERS: Mapping[str, int] = {"k": 1, "k1": 1, "k2": 2, "k3": 3}


def _apart(yields: Array) -> bool:
    return bool((yields[1:] >= APART * yields[:-1]).all())


def _asymmetries(unknowns: Unknowns, largest: float) -> list[float]:
    """Return the values of c ln b on the grid; 0 of a law that has none."""
    if all(c.name != "c_ln_b" for c in unknowns.coordinates):
        return [0.0]
    return [unknowns.fixed["c_ln_b"]] if "c_ln_b" in unknowns.fixed else [one / largest for one in _ASYMMETRIES]


def _spring(loop: ScaleLoop, power: int) -> Array:
    """Return the force of a unit spring in every averaged cycle, (n_cycles, n_t)."""
    force = np.sign(loop.deflection) * np.abs(loop.deflection) ** power
    return np.tile(force, (max(loop.averaged, 1), 1))


def _column(loops: Sequence[ScaleLoop], forces: Sequence[Array], asymmetry: float) -> Array:
    """Return unit forces on all loops with the asymmetry, without their means, over the loops' weights."""
    parts = []
    for loop, force in zip(loops, forces, strict=True):
        part = loop.as_measured(np.exp(asymmetry * loop.deflection) * force)
        parts.append((part - part.mean()) / loop.weight)
    return np.concatenate(parts)


def _best_linear(matrix: Array, measured: Array, least: Array) -> tuple[Array, float]:
    """Return the best linear values not below `least`, and the sum of squares that is left."""
    norms = np.linalg.norm(matrix, axis=0)
    best = np.linalg.lstsq(matrix / norms, measured, rcond=None)[0]
    if (best < least * norms).any():
        best = scipy.optimize.lsq_linear(matrix / norms, measured, (least * norms, np.inf)).x
    return best / norms, float(np.sum((matrix / norms @ best - measured) ** 2))
