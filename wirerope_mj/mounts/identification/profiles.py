"""Profile likelihood: standard errors where the residual is not linear in the parameters.

A standard error from the Jacobian takes the residual as linear. Where valleys bend, or where a second one lies as deep, values
far beyond three such errors fit as well. Here each value is moved by three of its errors and the others are fitted again
(Bates and Watts 1988, chapter 6): the sum of squares has to rise by nine variances. The ends of all other
searches that fit within these nine variances count alike.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.search import Minimum, Residual, Unknowns, run_search
from wirerope_mj.mounts.identification.uncertainty import OPEN, Parameter, Uncertainty, noise_of, uncertainty_of

ERRORS = 3.0  # Standard errors by which a value is moved: the sum of squares then rises by their square, in variances
EXACT = 1e-6  # Spread below which residuals are rounding rather than noise: nothing can be told from their rise
# Variances within which a rise, and what a step of the others would take from it, are those of a linear residual.
STRAIGHT = 1.0
# Variances by which a fit has to be better to count as another one: half a standard error of one parameter.
BETTER = 0.25
ROUNDS = 4  # Times that a value is moved farther as long as the residual has not risen
STEPS = 15  # Steps of the others' search at one value: it begins where the straight line ends


@dataclass(frozen=True, kw_only=True)
class ProfilePoint:
    """Parameters fitted with one held fixed, and the rise of the sum of squares above the minimum, in variances."""

    numbers: Array
    rise: float


@dataclass(frozen=True, kw_only=True)
class Survey:
    """Uncertainty of a fit by its profiles: single parameters moved, with all others fitted again."""

    uncertainty: Uncertainty  # of the best minimum: errors span all points that fit as well, messages name other sets of values
    better: dict[str, float] | None  # values of a better fit, if moving a value has shown one
    evaluations: int  # residuals computed


def survey(
    unknowns: Unknowns, residual: Residual, best: Minimum, rivals: Sequence[Minimum], noise: float | None = None
) -> Survey:
    """Compute the uncertainty of the best minimum from its profiles and from the minima of other searches.

    Standard errors span all points that fit as well; a message names each value that is open so. `noise` is the standard
    deviation of the residuals; None: as they are left.
    """
    uncertainty, spread = uncertainty_of(unknowns, best, noise), noise_of(unknowns, best, noise)
    if not EXACT < spread < np.inf:
        return Survey(uncertainty=uncertainty, better=None, evaluations=0)
    reaches: dict[str, float] = {}
    points: list[ProfilePoint] = []
    evaluations = 0
    for index, c in enumerate(unknowns.free):
        for side in (-ERRORS, ERRORS) if _identified(uncertainty.parameters[c.name]) else ():
            profile = _Profile(unknowns, residual, best, uncertainty, spread, index)
            reach = profile.reach(side * uncertainty.parameters[c.name].standard_error)
            reaches[c.name] = max(reaches.get(c.name, 0.0), reach)
            points += profile.points
            evaluations += profile.evaluations
    deepest = min(points, key=lambda point: point.rise, default=None)
    if deepest is not None and deepest.rise < -BETTER:
        return Survey(uncertainty=uncertainty, better=unknowns.values(deepest.numbers), evaluations=evaluations)
    values = unknowns.values(best.numbers)
    for point in points:
        for name, value in unknowns.values(point.numbers).items():
            reaches[name] = max(reaches.get(name, 0.0), abs(value - values[name]))
    sets: list[tuple[float, Mapping[str, Parameter]]] = []
    for rival in rivals:
        rise = max((rival.cost - best.cost) / spread**2, 0.0)
        if rise >= ERRORS**2:
            continue
        sets.append((rise, uncertainty_of(unknowns, rival, noise).parameters))
        for name, p in sets[-1][1].items():
            reach = abs(p.value - values[name]) + np.sqrt(ERRORS**2 - rise) * p.standard_error
            reaches[name] = max(reaches.get(name, 0.0), reach)
    parameters, messages = dict(uncertainty.parameters), list(uncertainty.non_identifiable)
    for name, p in uncertainty.parameters.items():
        wide = replace(p, standard_error=max(p.standard_error, reaches.get(name, 0.0) / ERRORS))
        parameters[name] = p if p.fixed else wide
        if _identified(p) and not _identified(wide):
            error = 100 * wide.standard_error / abs(p.value)
            size = f"to better than {error:.3g} %" if wide.standard_error < np.inf else "at all"
            messages.append(f"{name} is not identifiable {size}: moved that far, the other parameters make up for it")
    named = [uncertainty.parameters]
    for rise, rival_set in sorted(sets, key=lambda pair: pair[0]):
        if any(not _different(rival_set, known) for known in named):
            continue
        named.append(dict(rival_set))
        different = [rival_set[name] for name in _different(uncertainty.parameters, rival_set)]
        texts = ", ".join(f"{p.name} {p.value:.4g} {p.unit}".removesuffix(" -") for p in different)
        messages.append(f"another set of values fits {'as well' if rise < 1.0 else 'almost as well'}: {texts}")
    widened = replace(uncertainty, parameters=parameters, non_identifiable=tuple(messages))
    return Survey(uncertainty=widened, better=None, evaluations=evaluations)


def _identified(p: Parameter) -> bool:
    return not p.fixed and not p.at_bound and 0.0 < p.standard_error < OPEN * abs(p.value)


def _different(first: Mapping[str, Parameter], second: Mapping[str, Parameter]) -> list[str]:
    """Name the values of the second set that lie beyond three errors of the first and are identified there."""
    return [n for n, p in first.items() if _identified(p) and abs(second[n].value - p.value) > ERRORS * p.standard_error]


class _Profile:
    """Profile of one parameter to one side: the parameter is moved step by step, and all others are fitted again."""

    def __init__(
        self, unknowns: Unknowns, residual: Residual, best: Minimum, uncertainty: Uncertainty, spread: float, index: int
    ) -> None:
        self.unknowns, self.residual, self.best, self.spread, self.index = unknowns, residual, best, spread, index
        self.points: list[ProfilePoint] = []
        self.evaluations = 0
        slopes = np.array([c.slope(n) for c, n in zip(unknowns.free, best.numbers, strict=True)])
        column = uncertainty.covariance[:, index] / slopes  # how the others follow on the straight line
        self.line = column / column[index]

    def reach(self, distance: float) -> float:
        """Find the distance at which the sum of squares has risen by nine variances; 0 if not beyond `distance`."""
        c, begin = self.unknowns.free[self.index], self.best.numbers[self.index]
        value, numbers, limit = c.value(begin), self.best.numbers, ERRORS**2
        farthest, before = 0.0, (0.0, 0.0)
        for number in range(ROUNDS):
            target = value + distance
            if not c.lower < target < c.upper:
                return farthest
            moved = numbers + (c.inside(target) - numbers[self.index]) * self.line
            if number == 0 and self._straight(moved):
                return 0.0
            held = replace(self.unknowns, fixed={**self.unknowns.fixed, c.name: target})
            if held.free:
                start = self.unknowns.values(np.clip(moved, *self.unknowns.bounds))
                ended = run_search(held, self.residual, start, max_evaluations=STEPS)
                cost, evaluations = ended.cost, ended.evaluations
                moved = self.unknowns.numbers(held.values(ended.numbers))
            else:
                residual = self.residual(self.unknowns.law(moved))
                cost, evaluations = float(residual @ residual), 1
            self.evaluations += evaluations
            point = ProfilePoint(numbers=moved, rise=(cost - self.best.cost) / self.spread**2)
            if point.rise >= 0.9 * limit:
                return farthest
            self.points.append(point)
            if point.rise < -BETTER:
                return abs(distance)
            # Errors that the last two points are worth go on straight, twice as far at most.
            size, errors = abs(distance), float(np.sqrt(max(point.rise, 0.0)))
            steepness = max(errors - before[1], 1e-9) / (size - before[0])
            farthest, before = min(size + (ERRORS - errors) / steepness, 2.0 * size), (size, errors)
            if farthest > 2.0 * ERRORS * OPEN * abs(value):
                return farthest
            numbers, distance = point.numbers, math.copysign(farthest, distance)
        return farthest

    def _straight(self, moved: Array) -> bool:
        """True if the residual at `moved`, the end of a straight line, is that of a linear problem within a variance."""
        low, high = self.unknowns.bounds
        if not ((moved > low) & (moved < high)).all():
            return False
        self.evaluations += 1
        try:
            residual = self.residual(self.unknowns.law(moved))
        except (ValueError, OverflowError):
            return False
        if not np.isfinite(residual).all():
            return False
        rise = (residual @ residual - self.best.cost) / self.spread**2
        others = np.delete(self.best.jacobian, self.index, axis=1)
        step = np.linalg.lstsq(others, residual, rcond=None)[0]
        gain = float(np.sum((others @ step) ** 2)) / self.spread**2
        return bool(abs(rise - ERRORS**2) < STRAIGHT and gain < STRAIGHT)
