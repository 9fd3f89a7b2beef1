"""Finite elements for the direction of a rope along its length: cubic, with four points of Gauss each."""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.rope_loop.shape import LoopShape

# Of the polynomials. Energy and force then err by h^6, as tests/test_rope_loop.py measures by halving the elements.
DEGREE = 3


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Shape functions of one half loop; lengths in units of the half loop's length.

    Attributes:
        value: shape functions at the points of Gauss, (q, n).
        slope: their derivatives, (q, n).
        weight: weights of the points, (q,).
        curvature: natural curvature at the points, (q,).
        natural: natural direction at the nodes [rad], (n,).
    """

    value: Array
    slope: Array
    weight: Array
    curvature: Array
    natural: Array


def mesh(shape: LoopShape, elements: int) -> Mesh:
    """Return the elements of a half loop; no element reaches over a jump of the natural curvature.

    Args:
        shape: of the half loop.
        elements: their number, shared among the segments in proportion to their lengths, at least one for each.
    """
    lengths = np.array([length for length, _ in shape.segments]) / shape.length
    bends = np.array([curvature for _, curvature in shape.segments]) * shape.length
    counts = np.maximum(1, np.round(elements * lengths).astype(int))
    sizes, curvatures = np.repeat(lengths / counts, counts), np.repeat(bends, counts)
    points, weights = np.polynomial.legendre.leggauss(DEGREE + 1)
    inside = np.linspace(-1.0, 1.0, DEGREE + 1)
    basis = np.linalg.inv(np.vander(inside, increasing=True))  # columns: coefficients of the shape functions
    at_points = np.vander(points, DEGREE + 1, increasing=True) @ basis
    powers = np.arange(1, DEGREE + 1)
    slopes = (powers * np.vander(points, DEGREE, increasing=True)) @ basis[1:]

    total, per = len(sizes), DEGREE + 1
    value, slope = np.zeros((total * per, DEGREE * total + 1)), np.zeros((total * per, DEGREE * total + 1))
    for index, size in enumerate(sizes):
        rows, columns = slice(index * per, (index + 1) * per), slice(DEGREE * index, DEGREE * (index + 1) + 1)
        value[rows, columns], slope[rows, columns] = at_points, slopes * (2.0 / size)
    steps = np.repeat(sizes * curvatures, DEGREE) / DEGREE
    return Mesh(
        value=value,
        slope=slope,
        weight=np.outer(0.5 * sizes, weights).ravel(),
        curvature=np.repeat(curvatures, per),
        natural=shape.start + np.concatenate([[0.0], np.cumsum(steps)]),
    )


def default_elements(shape: LoopShape) -> int:
    """Return the number of elements for a force to about 1e-6 of itself away from the taut rope: one for every 12 degrees."""
    turned = sum(abs(length * curvature) for length, curvature in shape.segments)
    return max(15, math.ceil(turned / math.radians(12.0)))
