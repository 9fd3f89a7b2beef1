"""Harmonic balance followed over frequency by pseudo-arclength, through folds."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from wirerope_mj.dynamics.arclength import corrected, crossing, unit_tangent
from wirerope_mj.dynamics.single_mass.balance import (
    Balance,
    HarmonicOrbit,
    Solution,
    checked_harmonics,
    harmonic_balance,
    newton,
    orbit_of,
)
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, ComplexArray
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.summary import Summarised, quantity, span
from wirerope_mj.mounts.laws import Law

# Arclength of the first step and of the shortest; 1 is the whole deflection, or a factor e in frequency.
_FIRST, _SMALLEST = 0.02, 1e-6
_AIM = 7  # corrections that the step length is steered to: Broyden's formula needs five to eight to reach 1e-10
_CLOSE = 1e-9  # relative distance in the frequency to which folds are located
_MOST = 4000  # points after which a branch that does not reach its end is given up


@dataclass(frozen=True, kw_only=True)
class HarmonicFold:
    """A point where a branch turns back in frequency: frequency [Hz], amplitude [m/s^2], row of the branch."""

    frequency: float
    amplitude: float
    index: int


@dataclass(frozen=True, kw_only=True, repr=False)
class HarmonicBranch(Summarised):
    """Periodic motions followed over frequency by harmonic balance."""

    law: Law  #: of the isolator axis
    mass: float  #: [kg]
    acceleration: float  #: amplitude of the base [m/s^2]
    gravity: float  #: [m/s^2]
    frequency: Array = field(repr=False)  #: [Hz], (n,), along the branch; it turns back at folds
    amplitude: Array = field(repr=False)  #: largest |absolute acceleration| of the mass [m/s^2], (n,)
    smallest_deflection: Array = field(repr=False)  #: [m], (n,)
    largest_deflection: Array = field(repr=False)  #: [m], (n,)
    coefficients: ComplexArray = field(repr=False)  #: of the deflection [m], (n, harmonics + 1), complex
    samples: int  #: of one period
    folds: tuple[HarmonicFold, ...]  #: where the branch turns back in frequency; the fold itself is one of the n points
    message: str  #: why it ended

    def _summary(self) -> tuple[str, dict[str, str]]:
        peak = int(np.argmax(self.amplitude))
        return f"HarmonicBranch of {self.mass:.4g} kg on {type(self.law).__name__}", {
            "frequency": f"{span((self.frequency[0], self.frequency[-1]), 'Hz')}, {self.frequency.size} motions",
            "base": quantity(self.acceleration, "m/s^2"),
            "largest amplitude": f"{quantity(self.amplitude[peak], 'm/s^2')} at {self.frequency[peak]:.4g} Hz",
            "folds": ", ".join(f"{fold.frequency:.4g} Hz" for fold in self.folds) or "none",
            "message": self.message,
        }

    @property
    def transmissibility(self) -> Array:
        """Largest |absolute acceleration| of the mass over the base's amplitude [-], (n,)."""
        return self.amplitude / self.acceleration

    def orbits_at(self, frequency: float) -> tuple[HarmonicOrbit, ...]:
        """Find the motions at a frequency [Hz], one for each passage of the branch, in its order."""
        f = self.frequency
        rows = np.flatnonzero((f[:-1] - frequency) * (f[1:] - frequency) <= 0.0)
        rows = rows[[i == 0 or f[i] != frequency for i in rows]]  # a point that is hit is the end of the step before
        orbits = []
        for i in rows:
            fraction = (frequency - f[i]) / (f[i + 1] - f[i]) if f[i + 1] != f[i] else 0.0
            guess = (1.0 - fraction) * self.coefficients[i] + fraction * self.coefficients[i + 1]
            orbits.append(
                harmonic_balance(
                    self.law, mass=self.mass, frequency=frequency, acceleration=self.acceleration, gravity=self.gravity,
                    harmonics=guess.size - 1, samples=self.samples, guess=guess,
                )
            )  # fmt: skip
        return tuple(orbits)


def follow_harmonic_balance(
    law: Law, *, mass: float, start: float, stop: float, acceleration: float, gravity: float = 0.0, harmonics: int = 31,
    samples: int = 1024, largest_step: float = 0.1, tolerance: float = 1e-10,
) -> HarmonicBranch:  # fmt: skip
    """Follow the periodic motions of one mass on one isolator axis from one frequency to another, through folds.

    The branch is followed by its arclength: of the deflection's coefficients, measured by their own size, and of the
    logarithm of the frequency. It starts with the motion that `harmonic_balance` finds there.

    Args:
        law: of the axis.
        mass: [kg].
        start: frequency of the first motion [Hz].
        stop: frequency of the last [Hz], above or below.
        acceleration: amplitude of the base [m/s^2].
        gravity: [m/s^2].
        harmonics: retained.
        samples: of one period.
        largest_step: longest arclength of a step; 0.1 is a tenth of the deflection or of the frequency.
        tolerance: of the residual.

    Raises:
        ValueError: an argument is out of its range.
        ConvergenceError: no motion at `start`, or the branch cannot be followed on from a frequency that is named.
    """
    if positive("start", start, unit="Hz") == positive("stop", stop, unit="Hz"):
        raise ValueError(f"`stop` must differ from `start`, got {start} Hz for both; use `harmonic_balance` instead.")
    if not _SMALLEST < largest_step <= 1.0:
        raise ValueError(f"`largest_step` must be in ({_SMALLEST:g}, 1], got {largest_step}.")
    first = harmonic_balance(
        law, mass=mass, frequency=start, acceleration=acceleration, gravity=gravity,
        harmonics=checked_harmonics(harmonics, samples), samples=samples, tolerance=tolerance,
    )  # fmt: skip
    balance = Balance(law, mass, gravity, harmonics, samples)
    path = _Path(balance, acceleration, tolerance)
    begin = np.append(balance.from_coefficients(first.coefficients), np.log(2.0 * np.pi * start))
    points, folds = [begin], []
    for point, is_fold in path.follow(begin, np.log(2.0 * np.pi * stop), largest_step):
        points.append(point)
        if is_fold:
            folds.append(len(points) - 1)
    orbits = [orbit_of(balance, Solution(point[:-1], 0.0, 0), float(np.exp(point[-1])), acceleration) for point in points]
    columns = ("frequency", "amplitude", "smallest_deflection", "largest_deflection", "coefficients")
    return HarmonicBranch(
        law=law, mass=mass, acceleration=acceleration, gravity=gravity, samples=samples,
        **{name: np.array([getattr(orbit, name) for orbit in orbits]) for name in columns},
        folds=tuple(HarmonicFold(frequency=orbits[i].frequency, amplitude=orbits[i].amplitude, index=i) for i in folds),
        message=path.message,
    )  # fmt: skip


@dataclass(frozen=True)
class _TrialPoint:
    """A point off the branch, (n + 1,), and the residuals of the balance there, (n,)."""

    y: Array
    residuals: Array


@dataclass(frozen=True)
class _Point:
    """A solution on the branch, in units of the size of its deflection, and 1 for the logarithm of omega."""

    y: Array  # unknowns and the logarithm of omega, (n + 1,)
    scale: Array  # units, (n + 1,)
    matrix: Array  # derivative of the residual in these units, (n, n + 1)
    tangent: Array  # unit tangent, (n + 1,)
    corrections: int = 0  # corrector iterations that it took


class _Path:
    """Continuation along the solutions of a balance; a point y is the unknowns and the logarithm of omega, (n + 1,)."""

    def __init__(self, balance: Balance, acceleration: float, tolerance: float) -> None:
        self.balance, self.acceleration, self.tolerance = balance, acceleration, tolerance
        self.message = ""

    def residual(self, y: Array) -> Array:
        return self.balance.residual(y[:-1], float(np.exp(y[-1])), self.acceleration)

    def jacobian(self, y: Array, residual: Array) -> Array:
        """Differentiate the residual at y by the unknowns and by the logarithm of omega, (n, n + 1)."""
        moved = y.copy()
        moved[-1] += 1e-7  # the residual is smooth in the frequency: errors of rounding and curvature are about equal here
        column = (self.residual(moved) - residual) / (moved[-1] - y[-1])
        by_unknowns = self.balance.jacobian(y[:-1], float(np.exp(y[-1])), self.acceleration, residual)
        return np.column_stack([by_unknowns, column])

    def point(self, y: Array, like: Array, corrections: int = 0) -> _Point:
        """Make the point of a solution y, its tangent with the sense of the direction `like` in y."""
        scale = np.append(np.full(y.size - 1, float(np.linalg.norm(y[:-1]))), 1.0)
        matrix = self.jacobian(y, self.residual(y)) * scale
        return _Point(y, scale, matrix, unit_tangent(matrix, like / scale), corrections)

    def step(self, last: _Point, length: float) -> _Point | None:
        """Take a step of an arclength; None if the corrector does not converge."""

        def at(move: Array) -> _TrialPoint:
            y = last.y + last.scale * move
            return _TrialPoint(y, self.residual(y))

        def matrix_at(tried: _TrialPoint, _: Array) -> Array:
            return self.jacobian(tried.y, tried.residuals) * last.scale

        correction = corrected(at, matrix_at, last.matrix, length * last.tangent, last.tangent, length, self.tolerance)
        if correction is None:
            return None
        tried, _, corrections = correction
        return self.point(tried.y, last.scale * last.tangent, corrections)

    def follow(self, begin: Array, end: float, largest_step: float) -> Iterator[tuple[Array, bool]]:
        """Yield the points after the first and whether they are folds, up to the frequency `end` (logarithm of omega)."""
        start, sign, length = begin[-1], np.sign(end - begin[-1]), min(_FIRST, largest_step)
        last = self.point(begin, np.append(np.zeros(begin.size - 1), sign))
        for _ in range(_MOST):
            point = self.step(last, length)
            if point is None:
                length *= 0.5
                if length < _SMALLEST:
                    raise ConvergenceError(
                        f"the branch cannot be followed beyond {np.exp(last.y[-1]) / (2.0 * np.pi):.6g} Hz: steps of "
                        f"{_SMALLEST:g} of the deflection fail. Try more harmonics, or another `start`."
                    )
                continue
            arrived = sign * (point.y[-1] - end) >= 0.0
            if arrived or sign * (start - point.y[-1]) > 0.0:
                yield self.between(last.y, point.y, end if arrived else start), False
                self.message = "reached the last frequency" if arrived else "came back to the first frequency"
                return
            if point.tangent[-1] * last.tangent[-1] < 0.0:
                step = partial(self.step, last)
                yield crossing(step, (last, point), length, lambda p: float(p.tangent[-1]), _CLOSE).y, True
            yield point.y, False
            length = min(length * float(np.clip(_AIM / max(point.corrections, 1), 0.7, 1.4)), largest_step)
            last = point
        self.message = f"ended after {_MOST} points"

    def between(self, before: Array, after: Array, log_omega: float) -> Array:
        """Find the point y of a given frequency between two points."""
        guess = before + (log_omega - before[-1]) / (after[-1] - before[-1]) * (after - before)
        solution = newton(self.balance, guess[:-1], float(np.exp(log_omega)), self.acceleration, self.tolerance)
        return np.append(solution.u, log_omega)
