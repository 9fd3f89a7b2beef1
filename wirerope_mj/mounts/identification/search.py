"""Residuals of a law on loops, and nonlinear least squares in its coordinates, at once or in the thesis' three stages."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.families import Coordinate, Family
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.laws import Law

Residual = Callable[[Law], Array]
Data = Literal["loops", "skeleton"]
# Fraction of the rectangle about a loop below which its area is too small to divide by; wire rope has 0.1 to 0.5.
THIN = 0.01


def _of_each(loops: Sequence[MeasuredLoop], part: Callable[[MeasuredLoop, Array], Array | float]) -> Residual:
    """Return the residual that joins `part` of every loop; `part` takes a loop and the law's force minus the measured one."""
    return lambda law: np.concatenate([np.ravel(part(loop, loop.model_force(law) - loop.force)) for loop in loops])


def _centred(values: Array) -> Array:
    return values - values.mean()


def loop_residual(loops: Sequence[MeasuredLoop], data: Data = "loops") -> Residual:
    """Compare the force of a law with that of all loops, each without its mean, over its weight.

    The mean is what a drifting zero of the load cell adds; the law's own is lost with it. Data are "loops", all samples, or
    "skeleton", the forces at the turning points alone.
    """

    def tips(loop: MeasuredLoop, misfit: Array) -> float:
        relative = misfit / loop.weight
        return relative[np.argmax(loop.deflection)] - relative[np.argmin(loop.deflection)]

    return _of_each(loops, tips if data == "skeleton" else lambda loop, misfit: _centred(misfit / loop.weight))


def harmonic_residual(loops: Sequence[MeasuredLoop]) -> Residual:
    """Compare the first seven Fourier coefficients of the law's and the measured force over the cycle's phase.

    Samples count as uniform over the phase, as those of a sine sampled in time are.
    """

    def coefficients(loop: MeasuredLoop, misfit: Array) -> Array:
        spectrum = np.fft.rfft(misfit[:-1])[1:8] * np.sqrt(2.0 / (misfit.size - 1)) / loop.weight
        return np.concatenate([spectrum.real, spectrum.imag])

    return _of_each(loops, coefficients)


def mid_line_residual(loops: Sequence[MeasuredLoop]) -> Residual:
    """Compare the loops' mid-lines (F_up + F_down) / 2, which show the elastic part: the first of three stages."""
    return _of_each(loops, lambda loop, misfit: _centred(loop.mid_line(misfit, 41) / loop.weight))


def area_residual(loops: Sequence[MeasuredLoop]) -> Residual:
    """Compare the loops' areas, relative to the measured ones: the second of three stages.

    A loop thinner than `THIN` of the rectangle about it counts relative to that fraction of the rectangle: noise of the force
    makes such an area small, zero or negative.
    """

    def area(loop: MeasuredLoop, misfit: Array) -> float:
        thin = THIN * float(np.ptp(loop.deflection) * np.ptp(loop.force))
        return loop.area(misfit) / max(loop.area(loop.force), thin)

    return _of_each(loops, area)


def joined(loops: Residual, extra: Sequence[Residual]) -> Residual:
    if not extra:
        return loops
    return lambda law: np.concatenate([loops(law), *(np.ravel(residual(law)) for residual in extra)])


def rms(residual: Array) -> float:
    return float(np.sqrt(np.mean(residual**2)))


# Step of the differences that make the Jacobian, in logarithms or scaled units: 1e5 times the traces' own error.
STEP = 1e-6
TOLERANCE = 1e-10  # Relative change of the numbers below which a search has converged
# Variances of the residual that a step has to take from the sum of squares: 0.03 standard errors of one parameter.
GAIN = 1e-3
# So many steps together have to take this many variances from the sum of squares: half a standard error of one parameter.
# What moves on and takes less creeps along a valley that the noise does not tell apart from its end.
STEPS_RUNNING, STALLED = 10, 0.25
EVALUATIONS = 100  # Largest number of evaluations of a search; one that needs more is on a wrong way
STALL_MESSAGE = f"{STEPS_RUNNING} steps together changed the residual by less than half a standard error does"
COST_CONVERGED = "the last step changed the residual by less than the noise can tell"
REFUSED = 1e3  # Residual of a law that cannot be evaluated on the loops, in units of their force: far from any fit


@dataclass(frozen=True, kw_only=True)
class Unknowns:
    """The parameters of a law by which it is searched for, its coordinates, some of them fixed."""

    family: Family  # how the law is made
    coordinates: Sequence[Coordinate]  # all coordinates
    fixed: Mapping[str, float]  # values of those that do not move

    @property
    def free(self) -> list[Coordinate]:
        return [c for c in self.coordinates if c.name not in self.fixed]

    def numbers(self, values: Mapping[str, float]) -> Array:
        """Return the numbers that the search varies from the values of all coordinates, slightly inside their bounds."""
        low, high = self.bounds
        inside = np.array([c.inside(values[c.name]) for c in self.free])
        return np.clip(inside, low + 1e-9 * (high - low), high - 1e-9 * (high - low))

    def values(self, numbers: Array) -> dict[str, float]:
        free = {c.name: float(c.value(number)) for c, number in zip(self.free, numbers, strict=True)}
        return {c.name: free.get(c.name, self.fixed.get(c.name, 0.0)) for c in self.coordinates}

    def law(self, numbers: Array) -> Law:
        return self.family.make(self.values(numbers))

    @property
    def bounds(self) -> tuple[Array, Array]:
        return (np.array([c.inside(c.lower) for c in self.free]), np.array([c.inside(c.upper) for c in self.free]))


@dataclass(frozen=True, kw_only=True)
class Minimum:
    """Result of a search: numbers, their residual and Jacobian, steps, evaluations (Jacobians included), why it stopped."""

    numbers: Array
    residual: Array
    jacobian: Array
    iterations: int
    evaluations: int
    converged: bool
    message: str

    @property
    def cost(self) -> float:
        return float(self.residual @ self.residual)


class _StalledError(Exception):
    """Raised when `STEPS_RUNNING` steps have changed the residual by less than the noise resolves."""


class _Residuals:
    """The residual and its Jacobian along a search: counts evaluations, and stops a search that stalls."""

    def __init__(self, unknowns: Unknowns, residual: Residual, begin: Array) -> None:
        self._unknowns, self._residual = unknowns, residual
        self._size = residual(unknowns.law(begin)).size
        self.evaluations = 0
        self.steps: list[Minimum] = []  # the minimum so far at each step
        self.freedom = max(self._size - begin.size, 1)  # samples left over for the noise
        self._latest = (begin, self._value(begin))

    def residual(self, numbers: Array) -> Array:
        """Evaluate the residual and remember it for the Jacobian there."""
        self._latest = (numbers.copy(), self._value(numbers))
        return self._latest[1]

    def jacobian(self, numbers: Array) -> Array:
        """Differentiate the residual by differences; _StalledError if the search stalls."""
        before = self._latest[1] if np.array_equal(self._latest[0], numbers) else self._value(numbers)
        # SciPy's own step is relative to the number: for one near zero it is so small that the differences are rounding.
        high, columns = self._unknowns.bounds[1], []
        for index, number in enumerate(numbers):
            moved = numbers.copy()
            moved[index] += STEP if number + STEP <= high[index] else -STEP
            columns.append((self._value(moved) - before) / (moved[index] - number))
        matrix = np.stack(columns, axis=1)
        self.steps.append(
            Minimum(
                numbers=numbers.copy(), residual=before, jacobian=matrix, iterations=len(self.steps) + 1,
                evaluations=self.evaluations, converged=True, message=STALL_MESSAGE,
            )
        )  # fmt: skip
        cost = self.steps[-1].cost
        earlier = self.steps[-1 - STEPS_RUNNING].cost if len(self.steps) > STEPS_RUNNING else np.inf
        if earlier - cost < STALLED / self.freedom * cost:
            raise _StalledError
        return matrix

    def _value(self, numbers: Array) -> Array:
        """Evaluate the residual; `REFUSED` where the law has no finite force."""
        self.evaluations += 1
        try:
            value = self._residual(self._unknowns.law(numbers))
        except (ValueError, OverflowError):
            return np.full(self._size, REFUSED)
        return np.where(np.isfinite(value), value, REFUSED)


def run_search(
    unknowns: Unknowns, residual: Residual, start: Mapping[str, float], *, max_evaluations: int = EVALUATIONS
) -> Minimum:
    """Run a trust-region Levenberg-Marquardt search with bounds (SciPy's `least_squares`, "trf").

    It has converged when a step reduces the sum of squares by less than `GAIN` of the residual's variance, or changes the
    numbers by less than `TOLERANCE`; a search that stalls (`STALLED`) returns its last step, as converged. A relative change of
    the cost would ask for more where there are many samples, and never converge in a valley that the data leave open.
    """
    begin = unknowns.numbers(start)
    residuals = _Residuals(unknowns, residual, begin)
    try:
        result = scipy.optimize.least_squares(
            residuals.residual, begin, jac=residuals.jacobian, bounds=unknowns.bounds, x_scale="jac",
            max_nfev=max_evaluations, ftol=GAIN / residuals.freedom, xtol=TOLERANCE, gtol=TOLERANCE,
        )  # fmt: skip
    except _StalledError:
        return residuals.steps[-1]
    ends = {0: f"it still moved after {max_evaluations} evaluations", 2: COST_CONVERGED, 4: COST_CONVERGED}
    return Minimum(
        numbers=result.x, residual=result.fun, jacobian=result.jac, iterations=result.njev,
        evaluations=residuals.evaluations, converged=result.status > 0,
        message=ends.get(result.status, str(result.message)),
    )  # fmt: skip


Method = Literal["three-stage", "time", "frequency"]


@dataclass(frozen=True, kw_only=True)
class Stage:
    """One stage of a fit: its name, steps, evaluations, the root mean square residual of the loops, the fitted values."""

    name: str
    iterations: int
    evaluations: int
    error: float
    values: dict[str, float]


def run_stages(
    unknowns: Unknowns, loops: Sequence[MeasuredLoop], full: Residual, values: Mapping[str, float], method: Method
) -> tuple[Minimum, tuple[Stage, ...]]:
    """Search from `values` in the stages of a method; the last one minimises the residual `full`.

    By the method "three-stage": stiffness from mid-lines, hysteresis from areas, everything from forces; "time": the last of
    these at once; "frequency": everything from the Fourier coefficients of the forces.
    """
    stages: list[Stage] = []

    def stage(name: str, part: Unknowns, residual: Residual, begin: Mapping[str, float]) -> tuple[Minimum, dict[str, float]]:
        minimum = run_search(part, residual, begin)
        fitted = part.values(minimum.numbers)
        error = rms(full(part.law(minimum.numbers)))
        stages.append(
            Stage(name=name, iterations=minimum.iterations, evaluations=minimum.evaluations, error=error, values=fitted)
        )
        return minimum, fitted

    if method == "frequency":
        minimum, fitted = stage("frequency", unknowns, harmonic_residual(loops), values)
        # The error, and what the data identify, are still those of the forces.
        by_force = run_search(unknowns, full, fitted, max_evaluations=1)
        return replace(by_force, converged=minimum.converged, message=minimum.message), tuple(stages)
    if method == "three-stage":
        begin = {**{c.name: values[c.name] for c in unknowns.coordinates}, **unknowns.fixed}
        parts = (("stiffness", True, mid_line_residual(loops)), ("areas", False, area_residual(loops)))
        for name, stiffness, residual in parts:
            held = {c.name: begin[c.name] for c in unknowns.coordinates if c.stiffness is not stiffness}
            part = replace(unknowns, fixed={**held, **unknowns.fixed})
            if part.free:
                _, begin = stage(name, part, residual, begin)
        values = begin
    minimum, _ = stage("everything", unknowns, full, values)
    return minimum, tuple(stages)
