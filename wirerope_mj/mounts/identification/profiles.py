"""How far a value may be moved, the others following, before the residual rises: errors where no straight line tells them.

A standard error from the Jacobian takes the residual as linear. Where valleys bend, or where a second one lies as deep, values
far beyond three such errors fit as well. Here each value is moved by three of its errors and the others are fitted again
(profile likelihood; Bates and Watts 1988, chapter 6): the sum of squares has to rise by nine variances. The ends of all other
searches that fit within these nine variances count alike.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.residuals import Residual
from wirerope_mj.mounts.identification.search import Found, Search, run_search
from wirerope_mj.mounts.identification.uncertainty import OPEN, Certainty, Parameter, certainty_of, spread_of

ERRORS = 3.0
"""Standard errors by which a value is moved: the sum of squares then rises by their square, in variances."""

EXACT = 1e-6
"""Spread below which residuals are rounding rather than noise: nothing can be told from their rise."""

STRAIGHT = 1.0
"""Variances within which a rise, and what a step of the others would take from it, are those of a linear residual."""

BETTER = 0.25
"""Variances by which a fit has to be better to count as another one: half a standard error of one parameter."""

ROUNDS = 4
"""How often a value is moved farther as long as the residual has not risen."""

STEPS = 15
"""Steps of the others' search at one value: it begins where the straight line ends."""


@dataclass(frozen=True, kw_only=True)
class Spot:
    """Numbers that were fitted with one held, and by how many variances the sum of squares is above the best."""

    numbers: Array
    rise: float


@dataclass(frozen=True, kw_only=True)
class Survey:
    """What is known around and beside a fit.

    Attributes:
        certainty: of the best, errors as wide as what fits as well, other sets of values named.
        better: values of a better fit, if moving a value has shown one.
        evaluations: residuals computed.
    """

    certainty: Certainty
    better: dict[str, float] | None
    evaluations: int


def survey(
    search: Search, residual: Residual, found: Found, rivals: Sequence[Found], noise: float | None = None
) -> Survey:
    """Return what the data fix, from the best fit, from values moved, and from the ends of other searches.

    Args:
        search: the coordinates.
        residual: what is small at the best.
        found: the best.
        rivals: where other searches ended.
        noise: standard deviation of the residuals; None: as they are left.
    """
    certainty, spread = certainty_of(search, found, noise), spread_of(search, found, noise)
    if not EXACT < spread < np.inf:
        return Survey(certainty=certainty, better=None, evaluations=0)
    spots, reaches, made = _walked(search, residual, found, certainty, spread)
    deepest = min(spots, key=lambda spot: spot.rise, default=None)
    if deepest is not None and deepest.rise < -BETTER:
        return Survey(certainty=certainty, better=search.values(deepest.numbers), evaluations=made)
    best = search.values(found.numbers)
    for spot in spots:
        for name, value in search.values(spot.numbers).items():
            reaches[name] = max(reaches.get(name, 0.0), abs(value - best[name]))
    others = []
    for rival in rivals:
        rise = max((rival.cost - found.cost) / spread**2, 0.0)
        if rise >= ERRORS**2:
            continue
        there = certainty_of(search, rival, noise).parameters
        others.append((rise, there))
        for name, p in there.items():
            reach = abs(p.value - best[name]) + np.sqrt(ERRORS**2 - rise) * p.standard_error
            reaches[name] = max(reaches.get(name, 0.0), reach)
    return Survey(certainty=_widened(certainty, reaches, others), better=None, evaluations=made)


def _walked(
    search: Search, residual: Residual, found: Found, certainty: Certainty, spread: float
) -> tuple[list[Spot], dict[str, float], int]:
    """Return the fits that moving each well fixed value has shown, how far each could be moved, residuals computed."""
    reaches: dict[str, float] = {}
    spots: list[Spot] = []
    made = 0
    for place, c in enumerate(search.free):
        if not _fixed_well(certainty.parameters[c.name]):
            continue
        for side in (-ERRORS, ERRORS):
            walk = _Walk(search, residual, found, certainty, spread, place)
            reach = walk.reach(side * certainty.parameters[c.name].standard_error)
            reaches[c.name] = max(reaches.get(c.name, 0.0), reach)
            spots += walk.spots
            made += walk.made
    return spots, reaches, made


def _fixed_well(p: Parameter) -> bool:
    return not p.fixed and not p.at_bound and 0.0 < p.standard_error < OPEN * abs(p.value)


def _widened(
    certainty: Certainty, reaches: Mapping[str, float], others: Sequence[tuple[float, Mapping[str, Parameter]]]
) -> Certainty:
    """Return standard errors as wide as what fits as well, and that in words."""
    parameters, words = dict(certainty.parameters), list(certainty.open_combinations)
    for name, p in certainty.parameters.items():
        wide = replace(p, standard_error=max(p.standard_error, reaches.get(name, 0.0) / ERRORS))
        parameters[name] = p if p.fixed else wide
        if _fixed_well(p) and not _fixed_well(wide):
            size = (
                f"to better than {100 * wide.standard_error / abs(p.value):.3g} %"
                if wide.standard_error < np.inf
                else "at all"
            )
            words.append(f"{name} is not fixed {size}: moved that far, the other parameters make up for it")
    named: list[Mapping[str, Parameter]] = []
    for rise, there in sorted(others, key=lambda pair: pair[0]):
        if any(not _apart(there, known) for known in (certainty.parameters, *named)):
            continue
        named.append(there)
        apart = [there[name] for name in _apart(certainty.parameters, there)]
        values = ", ".join(f"{p.name} {p.value:.4g} {p.unit}".removesuffix(" -") for p in apart)
        words.append(f"another set of values fits {'as well' if rise < 1.0 else 'almost as well'}: {values}")
    return replace(certainty, parameters=parameters, open_combinations=tuple(words))


def _apart(one: Mapping[str, Parameter], other: Mapping[str, Parameter]) -> list[str]:
    """Return the names of values that lie beyond three errors of one set and are fixed well there."""
    return [n for n, p in one.items() if _fixed_well(p) and abs(other[n].value - p.value) > ERRORS * p.standard_error]


class _Walk:
    """One coordinate moved to one side."""

    def __init__(
        self, search: Search, residual: Residual, found: Found, certainty: Certainty, spread: float, place: int
    ) -> None:
        self.search, self.residual, self.found, self.spread, self.place = search, residual, found, spread, place
        self.spots: list[Spot] = []
        self.made = 0
        slopes = np.array([c.slope(n) for c, n in zip(search.free, found.numbers, strict=True)])
        column = certainty.covariance[:, place] / slopes  # how the others follow on the straight line
        self.line = column / column[place]

    def reach(self, distance: float) -> float:
        """Return how far the value gets until the sum of squares has risen by nine variances; 0 if not beyond `distance`."""
        c, begin = self.search.free[self.place], self.found.numbers[self.place]
        value, numbers, limit = c.value(begin), self.found.numbers, ERRORS**2
        farthest, before = 0.0, (0.0, 0.0)
        for number in range(ROUNDS):
            target = value + distance
            if not c.lower < target < c.upper:
                return farthest
            moved = numbers + (c.inside(target) - numbers[self.place]) * self.line
            if number == 0 and self._straight(moved):
                return 0.0
            spot = self._fitted(moved, target)
            if spot.rise >= 0.9 * limit:
                return farthest
            self.spots.append(spot)
            if spot.rise < -BETTER:
                return abs(distance)
            # Errors that the last two places are worth go on straight, twice as far at most.
            here = (abs(distance), float(np.sqrt(max(spot.rise, 0.0))))
            steepness = max(here[1] - before[1], 1e-9) / (here[0] - before[0])
            farthest, before = min(here[0] + (ERRORS - here[1]) / steepness, 2.0 * here[0]), here
            if farthest > 2.0 * ERRORS * OPEN * abs(value):
                return farthest
            numbers, distance = spot.numbers, math.copysign(farthest, distance)
        return farthest

    def _straight(self, moved: Array) -> bool:
        """Return whether the residual at the end of the straight line is that of a linear one."""
        low, high = self.search.bounds
        if not ((moved > low) & (moved < high)).all():
            return False
        self.made += 1
        try:
            residual = self.residual(self.search.law(moved))
        except (ValueError, OverflowError):
            return False
        if not np.isfinite(residual).all():
            return False
        rise = (residual @ residual - self.found.cost) / self.spread**2
        others = np.delete(self.found.jacobian, self.place, axis=1)
        step = np.linalg.lstsq(others, residual, rcond=None)[0]
        gain = float(np.sum((others @ step) ** 2)) / self.spread**2
        return bool(abs(rise - ERRORS**2) < STRAIGHT and gain < STRAIGHT)

    def _fitted(self, moved: Array, target: float) -> Spot:
        """Return the best fit with the value held."""
        c, search = self.search.free[self.place], self.search
        part = Search(family=search.family, coordinates=search.coordinates, fixed={**search.fixed, c.name: target})
        low, high = search.bounds
        if not part.free:
            self.made += 1
            residual = self.residual(search.law(moved))
            return Spot(numbers=moved, rise=float(residual @ residual - self.found.cost) / self.spread**2)
        ended = run_search(part, self.residual, search.values(np.clip(moved, low, high)), most=STEPS)
        self.made += ended.evaluations
        numbers = search.numbers(part.values(ended.numbers))
        return Spot(numbers=numbers, rise=(ended.cost - self.found.cost) / self.spread**2)
