"""Modes of a linear system, and the mode of a stiffness that depends on the mode itself."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import scipy

from wirerope_mj.foundation.arrays import Array

ComplexArray = npt.NDArray[np.complex128]

CLOSE = 1e-6
"""Relative distance of eigenvalues whose shapes may turn into one another."""

TOLERANCE = 1e-9
"""Relative change of the eigenvalue at which an iterated mode is found."""

ROUNDS, DISTINCT, DIRECT = 100, 40, 15
"""Iterations of a mode, those in which its shape may change, and those that are not damped."""

FREE = 1e-9
"""Share of the largest eigenvalue below which one is rounding: nothing holds that motion."""


def solve(stiffness: Array, mass: Array) -> tuple[Array, Array]:
    """Return the eigenvalues [(rad/s)^2], (n,), from the lowest on, and the shapes, phi^T M phi = 1, as columns (n, n)."""
    values, shapes = scipy.linalg.eigh(stiffness, mass)
    values[np.abs(values) < FREE * np.abs(values).max(initial=0.0)] = 0.0
    return values, shapes


def frequency_of(values: Array) -> Array:
    """Return the frequencies [Hz] of eigenvalues; NaN for those below zero, whose motion runs away."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sqrt(values) / (2.0 * np.pi))


def follow(values: Array, shapes: Array, mass: Array, known: Array, mode: int) -> tuple[float, Array]:
    """Return eigenvalue and shape of the mode that stands for column `mode` of the shapes `known`, (n, n_known).

    Each of those is given one of the modes, so that their likeness (phi^T M phi)^2 is largest in all: two modes whose
    frequencies come close do not become the same one. Modes of one frequency are turned to be as like it as they can be.
    """
    likeness = shapes.T @ mass @ known
    indices, owners = scipy.optimize.linear_sum_assignment(-(likeness**2))
    best = int(indices[owners == mode][0])
    close = np.abs(values - values[best]) <= CLOSE * np.abs(values).max()
    shape = shapes[:, close] @ likeness[close, mode]
    return float(values[best]), np.asarray(shape / np.sqrt(shape @ mass @ shape))


def iterate(
    stiffness: Callable[[Array, float], ComplexArray], mass: Array, known: Array, mode: int, start: tuple[float, Array]
) -> tuple[float, Array, ComplexArray]:
    """Return eigenvalue, shape and complex stiffness of the mode whose stiffness is that of its own shape and frequency.

    Two modes of nearly one frequency mix in an instant, and may swap without end; then each keeps its known shape,
    whose Rayleigh quotient is right to the second order of what the shape lacks.

    Args:
        stiffness: complex stiffness of a shape (n,) and an eigenvalue.
        mass: mass matrix.
        known: shapes of all modes for small amplitudes, phi^T M phi = 1, (n, n).
        mode: which of them is followed.
        start: eigenvalue and shape to start from.
    """
    value, shape = start
    matrix = stiffness(shape, value)
    for count in range(ROUNDS):
        before = value
        if count < DISTINCT:
            value, shape = follow(*solve(matrix.real, mass), mass, known, mode)
        else:
            shape = known[:, mode]
            value = float(shape @ matrix.real @ shape)
        renewed = stiffness(shape, value)
        if abs(value - before) <= TOLERANCE * max(abs(value), abs(before)):
            return value, shape, renewed
        matrix = renewed if count < DIRECT else 0.5 * (matrix + renewed)  # what alternates is damped
    return value, shape, matrix
