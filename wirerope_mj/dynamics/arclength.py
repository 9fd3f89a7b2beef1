"""Following a curve of solutions by its arclength: tangent, corrector, and zeros of a test function along the curve.

A point has n unknowns and a parameter, in units of arclength; `matrix`, (n, n + 1), is the derivative of its residuals, which
vanish on the curve. The unit tangent t has matrix t = 0. A move from the last point to the next solves

    residuals(move) = 0,        row . move = wanted

with row = t for a step of the length `wanted` across the curve, and the parameter's unit vector to reach a given value of it.
"""

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np

from wirerope_mj.foundation.arrays import Array

# Singular values below this are the error of the difference quotients: their directions are neutral. Axes that hardly move
# have singular values near 1e-5 that must not be cut off: their states do converge.
NEUTRAL = 1e-6
# The same for tangents: directions that take 100 000 periods to settle are left to the corrector.
SLOWEST = 1e-5
# Residual, over the tolerance, that may stay in neutral directions: along them a motion drifts for a million periods.
ALONG_NEUTRAL = 10.0
# Change of the parameter, in its unit of arclength, beyond which a correction is given up; a step is 1 at the most.
FARTHEST = 10.0
CORRECTIONS = 10  # most corrections of one point
SLOW = 0.5  # ratio of two successive residuals above which the matrix is computed anew
LOCATIONS = 12  # most points that are computed to find a zero along the curve


class TrialPoint(Protocol):
    """A point off the curve to which a move leads, and its residuals, (n,)."""

    @property
    def residuals(self) -> Array: ...


class OnCurve(Protocol):
    """A point of a curve and its unit tangent, (n + 1,)."""

    @property
    def tangent(self) -> Array: ...


T = TypeVar("T", bound=TrialPoint)
P = TypeVar("P", bound=OnCurve)


def least_solution(matrix: Array, right: Array, neutral: float = NEUTRAL) -> Array:
    """Solve matrix @ step = right, without a step along neutral directions, whose singular values are below `neutral`."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        inverse = np.full_like(matrix, np.inf)
    if np.linalg.norm(inverse) < 1.0 / neutral:  # no singular value is below it: this costs a tenth of them
        return np.asarray(inverse @ right)
    u, values, v = np.linalg.svd(matrix, full_matrices=False)
    kept = values > neutral
    return np.asarray(v[kept].T @ ((u[:, kept].T @ right) / values[kept]))


def without_neutral(matrix: Array, residuals: Array, neutral: float = NEUTRAL) -> Array:
    """Project residuals, (n,), on the directions whose singular values in the matrix are above `neutral`."""
    u, values, _ = np.linalg.svd(matrix, full_matrices=False)
    kept = u[:, values > neutral]
    return np.asarray(kept @ (kept.T @ residuals))


def unit_tangent(matrix: Array, like: Array) -> Array:
    """Compute the unit tangent, (n + 1,), with the sense of the direction `like`, (n + 1,)."""
    n = matrix.shape[0]
    tangent = least_solution(np.vstack([matrix, like]), np.append(np.zeros(n), 1.0), SLOWEST)
    return np.asarray(tangent / np.linalg.norm(tangent))


def corrected(
    at: Callable[[Array], T], matrix_at: Callable[[T, Array], Array], matrix: Array, move: Array, row: Array,
    wanted: float, tolerance: float,
) -> tuple[T, Array, int] | None:  # fmt: skip
    """Correct a predicted move, (n + 1,), until its residuals vanish under row . move = wanted; None without convergence.

    The matrix, (n, n + 1), given at the last point, is brought up to date by Broyden's formula, and computed anew by
    `matrix_at` once where a correction leaves most of the residuals. `at` evaluates the point to which a move leads;
    `tolerance` is the largest residual. Returns the point, the move and the number of corrections.

    Where a residual grows, a difference quotient's error was taken for a slow direction: these are neutral from there on.
    """
    n, renewed, neutral = matrix.shape[0], False, NEUTRAL
    system, point = np.vstack([matrix, row]), at(move)
    largest = float(np.abs(point.residuals).max())
    for correction in range(CORRECTIONS):
        if largest <= tolerance or (
            largest <= ALONG_NEUTRAL * tolerance
            and np.abs(without_neutral(system[:n], point.residuals, neutral)).max() <= tolerance
        ):
            return point, move, correction
        if not np.isfinite(largest):
            return None
        change = least_solution(system, np.append(-point.residuals, wanted - row @ move), neutral)
        move = move + change
        if not abs(move[-1]) < FARTHEST:
            return None
        (before, last), point = (point, largest), at(move)
        largest = float(np.abs(point.residuals).max())
        if not np.isfinite(largest):
            return None
        if largest > last and neutral < SLOWEST:
            point, move, largest, neutral = before, move - change, last, SLOWEST
            continue
        system[:n] += np.outer(point.residuals - before.residuals - system[:n] @ change, change) / (change @ change)
        if largest > SLOW * last and not renewed:
            system[:n], renewed = matrix_at(point, move), True
    return None


def crossing(
    step: Callable[[float], P | None], ends: tuple[P, P], length: float, test: Callable[[P], float], close: float
) -> P:
    """Find the zero of a test function between two points, at which its signs differ, by the Illinois method.

    `step` makes the point at an arclength from the first, if there is one; `length` is the arclength between both. `test` of a
    fold is the tangent's component of the parameter; the zero is located to a distance `close` in the parameter, in its unit
    of arclength.
    """
    left, right, f_left, f_right = 0.0, length, test(ends[0]), test(ends[1])
    best, least = min(((end, abs(test(end))) for end in reversed(ends)), key=lambda pair: pair[1])
    for _ in range(LOCATIONS):
        middle = (left * f_right - right * f_left) / (f_right - f_left)
        point = step(middle)
        if point is None:
            break
        value = test(point)
        if abs(value) < least:
            best, least = point, abs(value)
        if abs(point.tangent[-1]) * abs(right - left) < close:  # the remaining interval, in the parameter
            break
        if value * f_right < 0.0:
            left, f_left = right, f_right
        else:
            f_left *= 0.5
        right, f_right = middle, value
    return best
