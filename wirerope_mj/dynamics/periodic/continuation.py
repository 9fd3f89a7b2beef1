"""Pseudo-arclength continuation of periodic motions in the frequency or the level of the base's sine.

A point of a branch is y = (x, ln p), p the parameter that is followed, in units in which a step of 1 changes p by the largest
step allowed, or the motion by a quarter of its ranges. Its residuals are P(x, p) - x. The least solution is taken in neutral
directions, so that they neither stop the corrector nor are stepped along.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.dynamics.arclength import corrected, crossing, unit_tangent
from wirerope_mj.dynamics.periodic.branch import Kind, Parameter
from wirerope_mj.dynamics.periodic.motion import Drive, ranges, scales
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import DIFFERENCE, MARGIN, FloquetStability, Shot, monodromy, shot, stability
from wirerope_mj.foundation.arrays import Array

CHANGE = 0.25  # change of the motion relative to its ranges that counts as one unit of arclength
UNCLEAR = 0.1  # component of a unit tangent below which its sign may change between two points
CLOSE = 1e-6  # relative distance in the parameter to which events are located
# Fraction of the branch's tolerance to which folds are corrected: where a branch is steep, a residual of 1e-6 moves the
# parameter by 1e-5.
TIGHTER = 1e-2


@dataclass(frozen=True, kw_only=True)
class Point:
    """A corrected point of a branch."""

    shot: Shot
    parameter: float  # value of the parameter that is followed
    matrix: Array  # derivative of the residuals by (scaled x, arclength's unit of ln p), (n_x, n_x + 1)
    tangent: Array  # unit tangent in the units of arclength, (n_x + 1,)
    stability: FloquetStability  # Floquet multipliers
    corrections: int  # corrector iterations that it took
    width: float  # velocity over which the laws were smoothed [m/s]

    @property
    def unstable(self) -> int:
        return int((np.abs(self.stability.multipliers) > 1.0 + MARGIN).sum())


@dataclass(frozen=True, kw_only=True)
class Event:
    """A fold or a change of stability between two points, and the Floquet multiplier that crosses the unit circle there."""

    kind: Kind
    multiplier: complex
    point: Point


class Continuation:
    """The numerics of following a branch: points, tangents, predictor and corrector."""

    def __init__(
        self, search: OrbitSearch, *, parameter: Parameter, held: float, periods: int, unit: float, tolerance: float
    ) -> None:
        """Prepare to follow `parameter` p, frequency or acceleration, the other `held`; arclength 1 is `unit` of ln p."""
        self.search, self.flow, self.parameter = search, search.flow, parameter
        self.held, self.periods, self.unit, self.tolerance = held, periods, unit, tolerance

    def drive(self, value: float, steps: int | None = None) -> Drive:
        """Make the base's sine at a value of the parameter; `steps`, if given, replaces the chosen number of steps."""
        frequency, acceleration = (value, self.held) if self.parameter == "frequency" else (self.held, value)
        drive = self.search.drive(frequency, acceleration, self.periods)
        return drive if steps is None else replace(drive, steps=steps)

    def point(self, motion: Shot, value: float, *, before: Array | None, corrections: int = 0, sign: float = 1.0) -> Point:
        """Make the branch's point at a periodic motion; its tangent has the sense of `before`, else `sign` along p."""
        matrix, n = self._matrix(motion, value), motion.x.size
        return Point(
            shot=motion, parameter=value, matrix=matrix, corrections=corrections, width=self.flow.width,
            tangent=unit_tangent(matrix / self._to_arc(n), np.append(np.zeros(n), sign) if before is None else before),
            stability=stability(self.flow, motion, matrix[:, :n] + np.eye(n)),
        )  # fmt: skip

    def closed(self, x: Array, value: float) -> Shot | None:
        """Find the periodic motion near the unknowns x at a value of the parameter by Newton's method; None if that fails."""
        motion = self.search.closed(shot(self.flow, x, self.drive(value)), self.tolerance)
        return motion if motion.closes(self.tolerance) else None

    def _matrix(self, motion: Shot, value: float) -> Array:
        """Differentiate the residuals by the scaled unknowns and by ln p / unit, (n_x, n_x + 1)."""
        variational = self.search.variational
        phi = variational.matrix(motion) if variational is not None else None
        if phi is None:
            phi = monodromy(self.flow, motion)
        moved = self.drive(value * math.exp(DIFFERENCE * self.unit), motion.track.drive.steps)
        end = self.flow.ends(motion.x[np.newaxis], moved)[0]
        return np.column_stack([phi - np.eye(phi.shape[0]), (end - motion.track.end) / motion.scale / DIFFERENCE])

    def _to_arc(self, n: int) -> Array:
        """Return the arclength of a unit of each of n scaled unknowns, and of ln p / unit, (n_x + 1,)."""
        return np.append(np.full(n, 1.0 / (CHANGE * math.sqrt(n))), 1.0)

    def turned(self, point: Point, slope: float, change: Array) -> Point:
        """Reverse a point's tangent where it points against the branch: against `slope` in ln p, or if small `change` of x."""
        along = float(point.tangent[-1]) * slope
        if abs(slope) < UNCLEAR:
            along = float(point.tangent[:-1] @ (change / point.shot.scale))
        return replace(point, tangent=point.tangent if along >= 0.0 else -point.tangent)

    def step(self, last: Point, length: float, tolerance: float | None = None) -> Point | None:
        """Take a step of an arclength; None if the corrector does not converge."""
        arc = self._to_arc(last.shot.x.size)
        return self._correct(last, length * last.tangent / arc, last.tangent * arc, length, tolerance)

    def at_value(self, last: Point, value: float) -> Point | None:
        """Find the point at a value of the parameter near the last point."""
        n = last.shot.x.size
        wanted = math.log(value / last.parameter) / self.unit
        tangent = last.tangent / self._to_arc(n)
        length = wanted / tangent[n] if abs(tangent[n]) > 1e-12 else 0.0
        return self._correct(last, np.append((length * tangent)[:n], wanted), np.append(np.zeros(n), 1.0), wanted)

    def _correct(self, last: Point, move: Array, row: Array, wanted: float, tolerance: float | None = None) -> Point | None:
        """Correct a scaled `move` from the last point, under the constraint row . move = wanted."""
        steps = self.drive(last.parameter * math.exp(self.unit * move[-1])).steps

        def value(move: Array) -> float:
            return float(last.parameter * math.exp(self.unit * move[-1]))

        def at(move: Array) -> Shot:
            x = last.shot.x + last.shot.scale * move[:-1]
            return shot(self.flow, x, self.drive(value(move), steps), last.shot.scale)

        def matrix_at(motion: Shot, move: Array) -> Array:
            return self._matrix(motion, value(move))

        correction = corrected(at, matrix_at, last.matrix, move, row, wanted, tolerance or self.tolerance)
        if correction is None:
            return None
        motion, move, corrections = correction
        motion = replace(motion, scale=scales(self.flow.coordinates, ranges(self.flow.system, motion.track)))
        before = last.tangent * np.append(last.shot.scale / motion.scale, 1.0)
        return self.point(motion, value(move), before=before, corrections=corrections)

    def event(self, a: Point, b: Point, length: float) -> Event | None:
        """Find the fold or change of stability between two points, `length` of arclength apart; None without one.

        A fold is where the tangent turns, not where the parameter of the points is largest: the tangent is that of the
        continuous motion, and at the tip of a narrow resonance the reversals that pass a step change the parameter by twice the
        steps' own error.
        """
        if turns(a, b):

            def tight(arclength: float) -> Point | None:
                return self.step(a, arclength, TIGHTER * self.tolerance) or self.step(a, arclength)

            point = crossing(tight, (a, b), length, lambda p: float(p.tangent[-1]), CLOSE / self.unit)
            values = point.stability.multipliers
            nearest = complex(values[np.argmin(np.abs(values - 1.0))]) if values.size else 1.0 + 0.0j
            return Event(kind="fold", multiplier=nearest, point=point)
        low, high = sorted((a.unstable, b.unstable))
        if low == high:
            return None

        def modulus(point: Point) -> float:
            values = point.stability.multipliers
            return float(np.abs(values[low])) - 1.0 if low < values.size else -1.0

        point = crossing(lambda s: self.step(a, s), (a, b), length, modulus, CLOSE / self.unit)
        more = a if a.unstable > b.unstable else b
        critical = complex(more.stability.multipliers[low])
        if abs(critical.imag) > 1e-6 * abs(critical):
            kind: Kind = "Neimark-Sacker"
        else:
            kind = "period doubling" if critical.real < 0.0 else "symmetry breaking"
        return Event(kind=kind, multiplier=critical, point=point)


def turns(a: Point, b: Point) -> bool:
    return float(a.tangent[-1] * b.tangent[-1]) < 0.0
