"""Following a curve of solutions by its arclength: tangent, corrector, and where something vanishes along the curve.

A point has n unknowns and a parameter, in units in which its steps have length; `matrix`, (n, n + 1), is the derivative of its
gap, which vanishes on the curve. The unit tangent t has matrix t = 0. A move from the last point to the next solves

    gap(move) = 0,        row . move = wanted

with row = t for a step of the length `wanted` across the curve, and the parameter's own unit vector to meet a value of it.
"""

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np

from wirerope_mj.foundation.arrays import Array

# Singular values below this say nothing: they are the difference quotients' own error. Axes that hardly move have singular
# values near 1e-5 that must not be cut off: their states do converge.
NEUTRAL = 1e-6
# The same for tangents: what takes 100 000 periods to settle leads nowhere, and is left to the corrector.
SLOWEST = 1e-5
# Gap, over the tolerance, that may stay in directions that say nothing: along them a motion drifts for a million periods.
ALONG_NEUTRAL = 10.0
# Change of the parameter, in its unit of arclength, beyond which a correction leads nowhere; a step is 1 at the most.
FARTHEST = 10.0
CORRECTIONS = 10  # corrections of one point
SLOW = 0.5  # ratio of two gaps above which the matrix is computed anew
LOCATIONS = 12  # points that are computed to find where something vanishes


class Tried(Protocol):
    """What a move leads to, and its gap, (n,)."""

    @property
    def gap(self) -> Array: ...


class OnCurve(Protocol):
    """A point of a curve and its unit tangent, (n + 1,)."""

    @property
    def tangent(self) -> Array: ...


T = TypeVar("T", bound=Tried)
P = TypeVar("P", bound=OnCurve)


def least_solution(matrix: Array, right: Array, neutral: float = NEUTRAL) -> Array:
    """Solve matrix @ step = right, with the least step in the directions in which nothing changes."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        inverse = np.full_like(matrix, np.inf)
    if np.linalg.norm(inverse) < 1.0 / neutral:  # no singular value is below it: this costs a tenth of them
        return np.asarray(inverse @ right)
    u, values, v = np.linalg.svd(matrix, full_matrices=False)
    kept = values > neutral
    return np.asarray(v[kept].T @ ((u[:, kept].T @ right) / values[kept]))


def felt(matrix: Array, gap: Array, neutral: float = NEUTRAL) -> Array:
    """Take out of a gap, (n,), what lies along directions in which nothing changes."""
    u, values, _ = np.linalg.svd(matrix, full_matrices=False)
    kept = u[:, values > neutral]
    return np.asarray(kept @ (kept.T @ gap))


def unit_tangent(matrix: Array, like: Array) -> Array:
    """Compute the unit tangent, (n + 1,), turned like another direction."""
    n = matrix.shape[0]
    tangent = least_solution(np.vstack([matrix, like]), np.append(np.zeros(n), 1.0), SLOWEST)
    return np.asarray(tangent / np.linalg.norm(tangent))


def corrected(
    at: Callable[[Array], T], matrix_at: Callable[[T, Array], Array], matrix: Array, move: Array, row: Array,
    wanted: float, tolerance: float,
) -> tuple[T, Array, int] | None:  # fmt: skip
    """Correct a predicted move, (n + 1,), until its gap vanishes under row . move = wanted; None where it does not.

    The matrix, (n, n + 1), given at the last point, is brought up to date by Broyden's formula, and computed anew by
    `matrix_at` once where a correction leaves most of the gap. `at` says where a move leads; `tolerance` is the largest
    residual. Returns where it leads, the move and the number of corrections.

    Where a gap grows, a difference quotient's error was taken for a slow direction: these are left alone from there on.
    """
    n, fresh, neutral = matrix.shape[0], False, NEUTRAL
    system, now = np.vstack([matrix, row]), at(move)
    size = float(np.abs(now.gap).max())
    for correction in range(CORRECTIONS):
        if size <= tolerance or (
            size <= ALONG_NEUTRAL * tolerance and np.abs(felt(system[:n], now.gap, neutral)).max() <= tolerance
        ):
            return now, move, correction
        if not np.isfinite(size):
            return None
        change = least_solution(system, np.append(-now.gap, wanted - row @ move), neutral)
        move = move + change
        if not abs(move[-1]) < FARTHEST:
            return None
        (before, last), now = (now, size), at(move)
        size = float(np.abs(now.gap).max())
        if not np.isfinite(size):
            return None
        if size > last and neutral < SLOWEST:
            now, move, size, neutral = before, move - change, last, SLOWEST
            continue
        system[:n] += np.outer(now.gap - before.gap - system[:n] @ change, change) / (change @ change)
        if size > SLOW * last and not fresh:
            system[:n], fresh = matrix_at(now, move), True
    return None


def crossing(
    step: Callable[[float], P | None], ends: tuple[P, P], length: float, test: Callable[[P], float], close: float
) -> P:
    """Find where `test` vanishes between two points, at which its signs differ, by the Illinois method.

    `step` makes the point at an arclength from the first, if there is one; `length` is that between both. `test` of a fold is
    the tangent's component of the parameter; it is located to a distance `close` in the parameter, in its unit of arclength.
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
