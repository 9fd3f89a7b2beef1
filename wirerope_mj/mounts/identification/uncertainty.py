"""What the data fix and what they leave open: standard errors, correlations, and combinations that no residual sees."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.search import Found, Search

OPEN = 0.25
"""Standard error, in logarithms or in the size that a coordinate can have, from which on the data leave it open."""

PART = 0.3
"""Share of an open combination from which on a coordinate is named in it."""

AT_BOUND = 1e-6
"""Share of a coordinate's range within which it stands at its bound."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One coordinate after a fit.

    Attributes:
        name: of the coordinate.
        unit: of its value.
        value: what was found, or given.
        standard_error: of the value; a third of the distance at which the residual has risen as it does three errors away,
            where that is more than the Jacobian says; 0 if it was fixed, infinite if the data do not fix it at all.
        fixed: whether it was given.
        at_bound: whether it stands at the end of its range.
    """

    name: str
    unit: str
    value: float
    standard_error: float
    fixed: bool
    at_bound: bool


@dataclass(frozen=True, kw_only=True)
class Certainty:
    """How far a fit can be trusted.

    Attributes:
        parameters: all coordinates, by name.
        covariance: of the free coordinates' values, (n, n).
        correlation: the same without sizes, (n, n).
        free: names of the free coordinates, in the order of the matrices.
        singular_values: of the Jacobian over the noise, largest first, (n,): one over each is a combination's standard error.
        open_combinations: what the data leave open, in words.
    """

    parameters: dict[str, Parameter]
    covariance: Array
    correlation: Array
    free: tuple[str, ...]
    singular_values: Array
    open_combinations: tuple[str, ...]


def certainty_of(search: Search, found: Found, noise: float | None = None) -> Certainty:
    """Return standard errors, correlations and open combinations at the end of a search.

    The Jacobian J in the coordinates' numbers gives the covariance s^2 (J^T J)^-1; its singular value decomposition
    says along which combinations it is large.

    Args:
        search: the coordinates.
        found: where the search ended.
        noise: standard deviation of the residuals; None: as they are left.
    """
    free = search.free
    spread = spread_of(search, found, noise)
    _, singular, combinations = np.linalg.svd(found.jacobian, full_matrices=False)
    singular = np.concatenate([singular, np.zeros(len(free) - singular.size)])
    combinations = np.vstack([combinations, np.zeros((len(free) - combinations.shape[0], len(free)))])
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.where(spread == 0.0, 0.0, spread / singular)
        numbers = combinations.T @ np.diag(np.where(np.isfinite(errors), errors, 1e150) ** 2) @ combinations
    slopes = np.array([c.slope(number) for c, number in zip(free, found.numbers, strict=True)])
    with np.errstate(over="ignore"):  # of what the data do not fix at all, which then is infinite
        covariance = numbers * np.outer(slopes, slopes)
    deviations = np.sqrt(np.diag(covariance))
    with np.errstate(divide="ignore", invalid="ignore"):
        correlation = np.nan_to_num(covariance / np.outer(deviations, deviations), nan=0.0)
    return Certainty(
        parameters=_parameters(search, found, deviations),
        covariance=covariance,
        correlation=correlation,
        free=tuple(c.name for c in free),
        singular_values=singular / spread if spread > 0.0 else np.full(len(free), np.inf),
        open_combinations=tuple(
            _words([c.name for c in free], row, float(error))
            for row, error in zip(combinations, errors, strict=True)
            if error > OPEN
        ),
    )


def spread_of(search: Search, found: Found, noise: float | None) -> float:
    """Return the standard deviation of the residuals: the one given, else as they are left."""
    freedom = found.residual.size - len(search.free)
    if noise is not None:
        return noise
    return float(np.sqrt(found.cost / freedom)) if freedom > 0 else np.inf


def _parameters(search: Search, found: Found, deviations: Array) -> dict[str, Parameter]:
    values, low, high = search.values(found.numbers), *search.bounds
    free = {c.name: place for place, c in enumerate(search.free)}
    result = {}
    for c in search.coordinates:
        place = free.get(c.name)
        error, at_bound = 0.0, False
        if place is not None:
            error = float(deviations[place]) if deviations[place] < 1e100 else np.inf
            near = AT_BOUND * (high[place] - low[place])
            at_bound = bool(min(found.numbers[place] - low[place], high[place] - found.numbers[place]) <= near)
        result[c.name] = Parameter(
            name=c.name, unit=c.unit, value=values[c.name], standard_error=error, fixed=place is None, at_bound=at_bound
        )
    return result


def _words(names: Sequence[str], combination: Array, error: float) -> str:
    """Return words for a combination of coordinates that the data leave open."""
    order = np.argsort(-np.abs(combination))
    named = [(names[i], combination[i]) for i in order if abs(combination[i]) >= PART]
    if not named:
        return "the data hold fewer figures than there are free parameters"
    size = "at all" if error > 1e6 else f"to better than {100 * np.expm1(min(error, 20.0)):.3g} %"
    if len(named) == 1:
        return f"{named[0][0]} is not fixed {size}"
    ways = ["up" if share * named[0][1] > 0.0 else "down" for _, share in named]
    moves = ", ".join(f"{name} {way}" for (name, _), way in zip(named, ways, strict=True))
    return f"{' and '.join(name for name, _ in named)} are not told apart {size}: moving {moves} together changes too little"
