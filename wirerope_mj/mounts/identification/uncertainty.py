"""Standard errors, correlations, and the combinations of parameters that no residual identifies."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.search import Minimum, Unknowns

# Standard error, in logarithms or in the size that a coordinate can have, from which on the data do not identify it.
OPEN = 0.25
NAMED = 0.3  # Component of a non-identifiable combination (a unit vector) from which on a coordinate is named in it
ROUNDING = 1e-12  # Component of a combination (a unit vector) that is none
AT_BOUND = 1e-6  # Fraction of a coordinate's range within which it stands at its bound


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One coordinate after a fit.

    Attributes:
        value: fitted, or given.
        standard_error: of the value; a third of the distance at which the residual has risen as it does three errors away,
            where that is more than the Jacobian says; 0 if it was fixed, infinite if the data do not identify it at all.
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
class Uncertainty:
    """Uncertainty of a fit.

    Attributes:
        parameters: all coordinates, by name.
        covariance: of the free coordinates' values, (n, n).
        correlation: the same without sizes, (n, n).
        free: names of the free coordinates, in the order of the matrices.
        singular_values: of the Jacobian over the noise, largest first, (n,): one over each is a combination's standard error.
        non_identifiable: a message for each combination of parameters that the data do not identify.
    """

    parameters: dict[str, Parameter]
    covariance: Array
    correlation: Array
    free: tuple[str, ...]
    singular_values: Array
    non_identifiable: tuple[str, ...]


def uncertainty_of(unknowns: Unknowns, minimum: Minimum, noise: float | None = None) -> Uncertainty:
    """Return standard errors, correlations and non-identifiable combinations at a minimum.

    The Jacobian J in the coordinates' numbers gives the covariance s^2 (J^T J)^-1; its singular value decomposition
    says along which combinations it is large. `noise` is the standard deviation of the residuals; None: as they are left.
    """
    free = unknowns.free
    spread = noise_of(unknowns, minimum, noise)
    _, singular, combinations = np.linalg.svd(minimum.jacobian, full_matrices=False)
    combinations[np.abs(combinations) < ROUNDING] = 0.0  # else what is not identified at all spoils what is
    singular = np.where(
        singular > np.finfo(float).eps * singular.max(initial=0.0), singular, 0.0
    )  # rounding moves nothing
    singular = np.concatenate([singular, np.zeros(len(free) - singular.size)])
    combinations = np.vstack([combinations, np.zeros((len(free) - combinations.shape[0], len(free)))])
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.where(spread == 0.0, 0.0, spread / singular)
        numbers = combinations.T @ np.diag(np.where(np.isfinite(errors), errors, 1e150) ** 2) @ combinations
    slopes = np.array([c.slope(number) for c, number in zip(free, minimum.numbers, strict=True)])
    with np.errstate(over="ignore"):  # of what the data do not identify at all, which then is infinite
        covariance = numbers * np.outer(slopes, slopes)
    deviations = np.sqrt(np.diag(covariance))
    with np.errstate(divide="ignore", invalid="ignore"):
        correlation = np.nan_to_num(covariance / np.outer(deviations, deviations), nan=0.0)
    names = tuple(c.name for c in free)
    return Uncertainty(
        parameters=_parameters(unknowns, minimum, deviations),
        covariance=covariance,
        correlation=correlation,
        free=names,
        singular_values=singular / spread if spread > 0.0 else np.full(len(free), np.inf),
        non_identifiable=tuple(
            _message(names, combination, float(error))
            for combination, error in zip(combinations, errors, strict=True)
            if error > OPEN
        ),
    )


def noise_of(unknowns: Unknowns, minimum: Minimum, noise: float | None) -> float:
    """Return the standard deviation of the residuals: the one given, else as they are left."""
    freedom = minimum.residual.size - len(unknowns.free)
    if noise is not None:
        return noise
    return float(np.sqrt(minimum.cost / freedom)) if freedom > 0 else np.inf


def _parameters(unknowns: Unknowns, minimum: Minimum, deviations: Array) -> dict[str, Parameter]:
    values, (low, high) = unknowns.values(minimum.numbers), unknowns.bounds
    room = np.minimum(minimum.numbers - low, high - minimum.numbers)
    errors = np.where(deviations < 1e100, deviations, np.inf)
    fitted = {
        c.name: (float(error), bool(bounded))
        for c, error, bounded in zip(unknowns.free, errors, room <= AT_BOUND * (high - low), strict=True)
    }
    parameters = {}
    for c in unknowns.coordinates:
        error, at_bound = fitted.get(c.name, (0.0, False))
        parameters[c.name] = Parameter(
            name=c.name, unit=c.unit, value=values[c.name], standard_error=error, fixed=c.name not in fitted,
            at_bound=at_bound,
        )  # fmt: skip
    return parameters


def _message(names: Sequence[str], combination: Array, error: float) -> str:
    named = [(names[i], combination[i]) for i in np.argsort(-np.abs(combination)) if abs(combination[i]) >= NAMED]
    if not named:
        return "the data hold fewer values than there are free parameters"
    size = "at all" if error > 1e6 else f"to better than {100 * np.expm1(min(error, 20.0)):.3g} %"
    if len(named) == 1:
        return f"{named[0][0]} is not identifiable {size}"
    moves = ", ".join(f"{name} {'up' if component * named[0][1] > 0.0 else 'down'}" for name, component in named)
    together = " and ".join(name for name, _ in named)
    return f"{together} are not identifiable apart {size}: moving {moves} together changes too little"
