"""Pseudo-arclength continuation of periodic motions in the frequency or the level of the base's sine.

A point of a branch is y = (x, ln p), p the parameter that is followed. In units in which a step of 1 changes p by the largest
step allowed, or the motion by a quarter of its ranges, the corrector solves

    P(x, p) - x = 0,        t . (y - y_predicted) = 0

with the matrix of the last point, brought up to date by Broyden's formula; the least solution is taken in the directions in
which the motion is neutral, so that they neither stop it nor are wandered along.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.dynamics.periodic.branch import Parameter
from wirerope_mj.dynamics.periodic.coordinates import scales
from wirerope_mj.dynamics.periodic.find import OrbitSearch
from wirerope_mj.dynamics.periodic.multipliers import FloquetStability, stability
from wirerope_mj.dynamics.periodic.observe import ranges
from wirerope_mj.dynamics.periodic.shooting import DIFFERENCE, Shot, least_solution, monodromy, shot
from wirerope_mj.dynamics.periodic.track import Drive
from wirerope_mj.foundation.arrays import Array

CHANGE = 0.25
"""Change of the motion relative to its ranges that counts as one unit of arclength."""

CORRECTIONS = 10
"""Corrector iterations of one point."""

UNCLEAR = 0.1
"""Component of a unit tangent whose sign may change between two points."""

SLOW = 0.5
"""Ratio of two residuals above which the matrix is integrated anew."""


@dataclass(frozen=True, kw_only=True)
class Point:
    """A corrected point of a branch.

    Attributes:
        parameter: value of what is followed.
        matrix: derivative of the scaled gap by (scaled x, arclength's unit of ln p), (n_x, n_x + 1).
        tangent: unit tangent in the units of arclength, (n_x + 1,).
        stability: Floquet multipliers.
        corrections: corrector iterations that it took.
        width: velocity over which the laws were smoothed [m/s].
    """

    shot: Shot
    parameter: float
    matrix: Array
    tangent: Array
    stability: FloquetStability
    corrections: int
    width: float


class Continuation:
    """The numerics of following a branch: points, tangents, predictor and corrector."""

    def __init__(
        self, search: OrbitSearch, *, parameter: Parameter, other: float, periods: int, unit: float, tolerance: float
    ) -> None:
        """Prepare to follow `parameter` with the `other` one fixed; `unit` of ln p counts as one unit of arclength."""
        self.search, self.flow, self.parameter = search, search.flow, parameter
        self.other, self.periods, self.unit, self.tolerance = other, periods, unit, tolerance

    def drive(self, value: float, steps: int | None = None) -> Drive:
        """Return the base's sine at a value of the parameter."""
        frequency, acceleration = (value, self.other) if self.parameter == "frequency" else (self.other, value)
        drive = self.search.drive(frequency, acceleration, self.periods)
        return drive if steps is None else replace(drive, steps=steps)

    def point(
        self, motion: Shot, value: float, *, before: Array | None, corrections: int = 0, sign: float = 1.0
    ) -> Point:
        """Return the point of a motion that repeats itself, its tangent turned like the one `before` or to `sign`."""
        matrix = self._matrix(motion, value)
        n = motion.x.size
        judged = stability(self.flow, motion, matrix[:, :n] + np.eye(n))
        return Point(
            shot=motion,
            parameter=value,
            matrix=matrix,
            tangent=self._tangent(matrix, before, sign),
            stability=judged,
            corrections=corrections,
            width=self.flow.width,
        )

    def _matrix(self, motion: Shot, value: float) -> Array:
        """Return the derivative of the scaled gap by the scaled unknowns and by ln p / unit, (n_x, n_x + 1)."""
        variational = self.search.variational
        phi = variational.matrix(motion) if variational is not None else None
        if phi is None:
            phi = monodromy(self.flow, motion)
        moved = self.drive(value * math.exp(DIFFERENCE * self.unit), motion.track.drive.steps)
        end = self.flow.ends(motion.x[np.newaxis], moved)[0]
        return np.column_stack([phi - np.eye(phi.shape[0]), (end - motion.track.end) / motion.scale / DIFFERENCE])

    def _to_arc(self, n: int) -> Array:
        """Return what a unit of the scaled unknowns (n_x of them) and of ln p / unit counts in arclength, (n_x + 1,)."""
        return np.append(np.full(n, 1.0 / (CHANGE * math.sqrt(n))), 1.0)

    def _tangent(self, matrix: Array, before: Array | None, sign: float) -> Array:
        n = matrix.shape[0]
        arc = self._to_arc(n)
        row = np.append(np.zeros(n), sign) if before is None else before
        system = np.vstack([matrix / arc, row])
        tangent = least_solution(system, np.append(np.zeros(n), 1.0))
        return np.asarray(tangent / np.linalg.norm(tangent))

    def turned(self, point: Point, slope: float, change: Array) -> Point:
        """Return the point with its tangent in the direction that led there: of the slope in ln p, or of the change of x."""
        along = float(point.tangent[-1]) * slope
        if abs(slope) < UNCLEAR:
            along = float(point.tangent[:-1] @ (change / point.shot.scale))
        return replace(point, tangent=point.tangent if along >= 0.0 else -point.tangent)

    def step(self, last: Point, length: float, tolerance: float | None = None) -> Point | None:
        """Return the point an arclength further, None if the corrector does not get there."""
        arc = self._to_arc(last.shot.x.size)
        return self._correct(last, length * last.tangent / arc, last.tangent * arc, length, tolerance)

    def at_value(self, last: Point, value: float) -> Point | None:
        """Return the point at a value of the parameter near the last point."""
        n = last.shot.x.size
        wanted = math.log(value / last.parameter) / self.unit
        tangent = last.tangent / self._to_arc(n)
        length = wanted / tangent[n] if abs(tangent[n]) > 1e-12 else 0.0
        return self._correct(last, np.append((length * tangent)[:n], wanted), np.append(np.zeros(n), 1.0), wanted)

    def _correct(
        self, last: Point, move: Array, row: Array, wanted: float, tolerance: float | None = None
    ) -> Point | None:
        """Return the corrected point after a scaled `move` from the last one, under the constraint row . move = wanted."""
        scale, n, unit = last.shot.scale, last.shot.x.size, self.unit
        value = last.parameter * math.exp(unit * move[n])
        steps = self.drive(value).steps
        system = np.vstack([last.matrix, row])
        now = self._moved(last, move, steps)
        gaps = [now.residual]
        fresh = False
        for correction in range(CORRECTIONS):
            if now.residual <= (tolerance or self.tolerance):
                value = last.parameter * math.exp(unit * move[n])
                own = replace(now, scale=scales(self.flow.coordinates, ranges(self.flow.system, now.track)))
                before = last.tangent * np.append(scale / own.scale, 1.0)
                return self.point(own, value, before=before, corrections=correction)
            if not np.isfinite(now.residual):
                return None
            left = np.append(-now.gap, wanted - row @ move)
            change = least_solution(system, left)
            move = move + change
            after = self._moved(last, move, steps)
            if not np.isfinite(after.residual):
                return None
            system[:n] += np.outer(after.gap - now.gap - system[:n] @ change, change) / (change @ change)
            now = after
            gaps.append(now.residual)
            if gaps[-1] > SLOW * gaps[-2] and not fresh:
                value = last.parameter * math.exp(unit * move[n])
                system[:n], fresh = self._matrix(now, value), True
        return None

    def _moved(self, last: Point, move: Array, steps: int) -> Shot:
        value = last.parameter * math.exp(self.unit * move[-1])
        x = last.shot.x + last.shot.scale * move[:-1]
        return shot(self.flow, x, self.drive(value, steps), last.shot.scale)
