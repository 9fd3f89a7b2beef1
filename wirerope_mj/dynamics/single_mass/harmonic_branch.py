"""Harmonic balance followed over frequency by pseudo-arclength, through folds."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.single_mass.balance import HarmonicOrbit, checked_harmonics, harmonic_balance, orbit_of
from wirerope_mj.dynamics.single_mass.fourier import Balance, Solution, newton
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.summary import Summarised, quantity, span
from wirerope_mj.mounts.laws import Law

_FIRST, _SMALLEST = 0.02, 1e-6
"""Arclength of the first step and of the shortest; 1 is the whole deflection, or a factor e in frequency."""

_CORRECTIONS, _QUICK = 12, 0.05
"""Corrections of a step; the Jacobian is made anew when one of them leaves more than a twentieth of the residual."""

_MOST = 4000
"""Points after which a branch that does not arrive is going round in circles."""


@dataclass(frozen=True, kw_only=True)
class HarmonicFold:
    """A point where a branch turns back in frequency: frequency [Hz], amplitude [m/s^2], row of the branch."""

    frequency: float
    amplitude: float
    index: int


@dataclass(frozen=True, kw_only=True, repr=False)
class HarmonicBranch(Summarised):
    """Periodic motions followed over frequency by harmonic balance.

    Attributes:
        law: of the isolator axis.
        mass: [kg].
        acceleration: amplitude of the base [m/s^2].
        gravity: [m/s^2].
        frequency: [Hz], (n,), along the branch; it turns back at folds.
        amplitude: largest |absolute acceleration| of the mass [m/s^2], (n,).
        smallest_deflection: [m], (n,).
        largest_deflection: [m], (n,).
        coefficients: of the deflection [m], (n, harmonics + 1), complex.
        samples: of one period.
        folds: where the branch turns back in frequency; the fold itself is one of the n points.
        message: why it ended.
    """

    law: Law
    mass: float
    acceleration: float
    gravity: float
    frequency: Array = field(repr=False)
    amplitude: Array = field(repr=False)
    smallest_deflection: Array = field(repr=False)
    largest_deflection: Array = field(repr=False)
    coefficients: npt.NDArray[np.complex128] = field(repr=False)
    samples: int
    folds: tuple[HarmonicFold, ...]
    message: str

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
        """Return the motions at a frequency [Hz], one for each time that the branch passes it, in its order."""
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
    law: Law,
    *,
    mass: float,
    start: float,
    stop: float,
    acceleration: float,
    gravity: float = 0.0,
    harmonics: int = 31,
    samples: int = 1024,
    largest_step: float = 0.1,
    tolerance: float = 1e-10,
) -> HarmonicBranch:
    """Return the periodic motions of one mass on one isolator axis from one frequency to another, through folds.

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
    orbits = [
        orbit_of(balance, Solution(point[:-1], 0.0, 0), float(np.exp(point[-1])), acceleration) for point in points
    ]
    return HarmonicBranch(
        law=law, mass=mass, acceleration=acceleration, gravity=gravity, samples=samples,
        frequency=np.array([orbit.frequency for orbit in orbits]),
        amplitude=np.array([orbit.amplitude for orbit in orbits]),
        smallest_deflection=np.array([orbit.smallest_deflection for orbit in orbits]),
        largest_deflection=np.array([orbit.largest_deflection for orbit in orbits]),
        coefficients=np.array([orbit.coefficients for orbit in orbits]),
        folds=tuple(HarmonicFold(frequency=orbits[i].frequency, amplitude=orbits[i].amplitude, index=i) for i in folds),
        message=path.message,
    )  # fmt: skip


class _Path:
    """Steps along the solutions of a balance; a point is the unknowns and the logarithm of omega."""

    def __init__(self, balance: Balance, acceleration: float, tolerance: float) -> None:
        self.balance, self.acceleration, self.tolerance = balance, acceleration, tolerance
        self.message = ""

    def residual(self, point: Array) -> Array:
        """Return the balance's residual at a point."""
        return self.balance.residual(point[:-1], float(np.exp(point[-1])), self.acceleration)

    def jacobian(self, point: Array) -> Array:
        """Return the derivatives of the residual by the unknowns and by the logarithm of omega, (n, n + 1)."""
        u, omega, here = point[:-1], float(np.exp(point[-1])), self.residual(point)
        moved = point.copy()
        moved[-1] += 1e-7  # the residual is smooth in the frequency: rounding and curvature are even near there
        column = (self.residual(moved) - here) / (moved[-1] - point[-1])
        return np.column_stack([self.balance.jacobian(u, omega, self.acceleration, here), column])

    def tangent(self, jacobian: Array, scale: Array, towards: Array) -> Array:
        """Return the direction of the branch in scaled coordinates, (n + 1,), oriented like `towards`."""
        null = np.linalg.svd(jacobian * scale)[2][-1]
        return null if null @ towards >= 0.0 else -null

    def correct(self, point: Array, jacobian: Array, scale: Array, normal: Array) -> tuple[Array, int]:
        """Return the solution in the plane through `point` across `normal`, and the corrections it took; too many: none."""
        corrected, last = point.copy(), np.inf
        for correction in range(_CORRECTIONS):
            residual = self.residual(corrected)
            size = float(np.abs(residual).max())
            if size <= self.tolerance:
                return corrected, correction
            if not size < 2.0 * last:
                break
            if size > _QUICK * last:
                jacobian = self.jacobian(corrected)
                if not np.isfinite(jacobian).all():
                    break
            bordered = np.vstack([jacobian * scale, normal])
            corrected = corrected + scale * np.linalg.solve(bordered, np.append(-residual, 0.0))
            last = size
        return corrected, _CORRECTIONS

    def follow(self, point: Array, end: float, largest_step: float) -> Iterator[tuple[Array, bool]]:
        """Yield the points after the first and whether they are folds, up to the frequency `end` (logarithm of omega)."""
        begin, sign, length = point[-1], np.sign(end - point[-1]), min(_FIRST, largest_step)
        scale, jacobian = _scale(point), self.jacobian(point)
        tangent = self.tangent(jacobian, scale, np.append(np.zeros(point.size - 1), sign))
        for _ in range(_MOST):
            corrected, corrections = self.correct(point + length * scale * tangent, jacobian, scale, tangent)
            if corrections >= _CORRECTIONS:
                length *= 0.5
                if length < _SMALLEST:
                    raise ConvergenceError(
                        f"the branch cannot be followed beyond {np.exp(point[-1]) / (2.0 * np.pi):.6g} Hz: steps of "
                        f"{_SMALLEST:g} of the deflection fail. Try more harmonics, or another `start`."
                    )
                continue
            after = self.jacobian(corrected)
            next_tangent = self.tangent(after, scale, tangent)
            if sign * (corrected[-1] - end) >= 0.0 or sign * (begin - corrected[-1]) > 0.0:
                last = end if sign * (corrected[-1] - end) >= 0.0 else begin
                yield self.at(point, corrected, last), False
                self.message = "reached the last frequency" if last == end else "came back to the first frequency"
                return
            if next_tangent[-1] * tangent[-1] < 0.0:
                yield self.fold(point, tangent, corrected, next_tangent, scale), True
            yield corrected, False
            length *= 1.4 if corrections <= 3 else 1.0 if corrections <= 6 else 0.7
            length = min(length, largest_step)
            point, scale = corrected, _scale(corrected)
            jacobian, tangent = after, self.tangent(after, scale, next_tangent)
        self.message = f"ended after {_MOST} points"

    def at(self, before: Array, after: Array, log_omega: float) -> Array:
        """Return the point between two with a given frequency."""
        fraction = (log_omega - before[-1]) / (after[-1] - before[-1])
        guess, omega = before + fraction * (after - before), float(np.exp(log_omega))
        solution = newton(self.balance, guess[:-1], omega, self.acceleration, self.tolerance)
        return np.append(solution.u, log_omega)

    def fold(self, before: Array, t0: Array, after: Array, t1: Array, scale: Array) -> Array:
        """Return the point between two where the tangent is vertical, by the secant on its share in frequency."""
        low, high, slope_low, slope_high = 0.0, 1.0, t0[-1], t1[-1]
        chord, corrected = after - before, before
        normal = chord / scale / np.linalg.norm(chord / scale)
        for _ in range(6):
            fraction = low - slope_low * (high - low) / (slope_high - slope_low)
            jacobian = self.jacobian(before + fraction * chord)
            corrected, corrections = self.correct(before + fraction * chord, jacobian, scale, normal)
            if corrections >= _CORRECTIONS:
                return after if abs(slope_high) < abs(slope_low) else before
            slope = self.tangent(self.jacobian(corrected), scale, t0 + t1)[-1]
            if (
                abs(slope) < 1e-6
            ):  # the frequency is then within 1e-6 of a step of the fold's, by its second order far closer
                break
            if slope * slope_low > 0.0:
                low, slope_low = fraction, slope
            else:
                high, slope_high = fraction, slope
        return corrected


def _scale(point: Array) -> Array:
    """Return the units of steps from a point: the size of its deflection, and 1 for the logarithm of omega."""
    size = float(np.linalg.norm(point[:-1]))
    return np.append(np.full(point.size - 1, size), 1.0)
