"""Standard errors, correlations, and the combinations of parameters that no residual identifies.

The errors of a search take all residuals as independent and alike. A load cell's noise is as large in newtons on a small loop
as on a large one, and filters, hum and the misfit of a law correlate neighbours. A parameter is disturbed by the noise at those
frequencies that its own effect on the force has, the first harmonics of the cycle.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.foundation.arrays import Array, ComplexArray
from wirerope_mj.mounts.identification.search import Minimum, Unknowns

# Standard error, in logarithms or in the size that a coordinate can have, from which on the data do not identify it.
OPEN = 0.25
NAMED = 0.3  # Component of a non-identifiable combination (a unit vector) from which on a coordinate is named in it
ROUNDING = 1e-12  # Component of a combination (a unit vector) that counts as zero
AT_BOUND = 1e-6  # Fraction of a coordinate's range within which it stands at its bound


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """Fitted value of one parameter of the search, with its standard error."""

    name: str
    unit: str
    value: float  # fitted, or given
    # of the value; a third of the distance at which the residual has risen as it does three errors away, where that is more
    # than the Jacobian says; 0 if it was fixed, infinite if the data do not identify it at all
    standard_error: float
    fixed: bool  # whether it was given
    at_bound: bool  # whether it stands at the end of its range


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """Uncertainty of a fit: errors, covariance, and combinations of parameters that the data do not identify."""

    parameters: dict[str, Parameter]  # all coordinates, by name
    covariance: Array  # of the free coordinates' values, (n, n)
    free: tuple[str, ...]  # names of the free coordinates, in the order of the matrices
    # of the Jacobian over the noise, largest first, (n,): one over each is a combination's standard error
    singular_values: Array
    non_identifiable: tuple[str, ...]  # a message for each combination of parameters that the data do not identify

    @property
    def correlation(self) -> Array:
        """Correlation of the free parameters, (n, n)."""
        deviations = np.sqrt(np.diag(self.covariance))
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.nan_to_num(self.covariance / np.outer(deviations, deviations), nan=0.0)


def uncertainty_of(unknowns: Unknowns, minimum: Minimum, noise: float | None = None) -> Uncertainty:
    """Compute standard errors, correlations and non-identifiable combinations at a minimum.

    The Jacobian J in the coordinates' numbers gives the covariance s^2 (J^T J)^-1; its singular value decomposition
    says along which combinations it is large. `noise` is the standard deviation of the residuals; None: as they are left.
    """
    free = unknowns.free
    spread = noise_of(unknowns, minimum, noise)
    _, singular, combinations = np.linalg.svd(minimum.jacobian, full_matrices=False)
    combinations[np.abs(combinations) < ROUNDING] = 0.0  # else what is not identified at all spoils what is
    rounding = np.finfo(float).eps * singular.max(initial=0.0)  # which moves nothing
    singular = np.where(singular > rounding, singular, 0.0)
    singular = np.concatenate([singular, np.zeros(len(free) - singular.size)])
    combinations = np.vstack([combinations, np.zeros((len(free) - combinations.shape[0], len(free)))])
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.where(spread == 0.0, 0.0, spread / singular)
        numbers = combinations.T @ np.diag(np.where(np.isfinite(errors), errors, 1e150) ** 2) @ combinations
    slopes = np.array([c.slope(number) for c, number in zip(free, minimum.numbers, strict=True)])
    with np.errstate(over="ignore"):  # of what the data do not identify at all, which then is infinite
        covariance = numbers * np.outer(slopes, slopes)
    names = tuple(c.name for c in free)
    not_identified = [(row, float(error)) for row, error in zip(combinations, errors, strict=True) if error > OPEN]
    values, (low, high) = unknowns.values(minimum.numbers), unknowns.bounds
    bounded = np.minimum(minimum.numbers - low, high - minimum.numbers) <= AT_BOUND * (high - low)
    deviations = np.sqrt(np.diag(covariance))
    deviations = np.where(deviations < 1e100, deviations, np.inf)
    fitted = {name: (float(deviations[i]), bool(bounded[i])) for i, name in enumerate(names)}
    parameters = {}
    for c in unknowns.coordinates:
        error, at_bound = fitted.get(c.name, (0.0, False))
        parameters[c.name] = Parameter(
            name=c.name, unit=c.unit, value=values[c.name], standard_error=error, fixed=c.name not in fitted, at_bound=at_bound
        )
    return Uncertainty(
        parameters=parameters, covariance=covariance, free=names,
        singular_values=singular / spread if spread > 0.0 else np.full(len(free), np.inf),
        non_identifiable=tuple(_message(names, row, error) for row, error in not_identified),
    )  # fmt: skip


def noise_of(unknowns: Unknowns, minimum: Minimum, noise: float | None) -> float:
    """Return `noise`, or else the standard deviation of the residuals at the minimum."""
    freedom = minimum.residual.size - len(unknowns.free)
    if noise is not None:
        return noise
    return float(np.sqrt(minimum.cost / freedom)) if freedom > 0 else np.inf


def _message(names: Sequence[str], combination: Array, error: float) -> str:
    """Describe a combination of fitted parameters, weights (n,), that the data do not identify, by its standard error."""
    named = [(names[i], combination[i]) for i in np.argsort(-np.abs(combination)) if abs(combination[i]) >= NAMED]
    if not named:
        return "the data hold fewer values than there are free parameters"
    size = "at all" if error > 1e6 else f"to better than {100 * np.expm1(min(error, 20.0)):.3g} %"
    if len(named) == 1:
        return f"{named[0][0]} is not identifiable {size}"
    moves = ", ".join(f"{name} {'up' if component * named[0][1] > 0.0 else 'down'}" for name, component in named)
    together = " and ".join(name for name, _ in named)
    return f"{together} are not identifiable apart {size}: moving {moves} together changes too little"


# Harmonics of the cycle at which bands of the noise's spectrum begin, so wide that loops of a few amplitudes show each.
BANDS = (1, 4, 9, 19, 41)


def with_noise_of_each(uncertainty: Uncertainty, unknowns: Unknowns, minimum: Minimum, sizes: Sequence[int]) -> Uncertainty:
    """Widen the uncertainty for noise of a different size in every loop, estimated from the residual, and correlated samples.

    With J_i the rows of the Jacobian of a loop, V_i the covariance of its noise and H = (J^T J)^-1 the covariance is H (sum
    of J_i^T V_i J_i) H (Huber 1967; White 1980; Newey and West 1987). V_i is the loop's mean square times a spectrum of noise
    that all loops have in common, known by `BANDS`. The fit absorbs a fraction of the noise at each harmonic, its leverage
    there, which the spectrum is corrected for. Standard errors that were enlarged before are enlarged by the same ratio.

    `sizes` are the numbers of residuals of each loop; the remaining residuals form one more group, taken as uncorrelated.
    """
    freedom = minimum.residual.size - len(unknowns.free)
    slopes = np.array([c.slope(number) for c, number in zip(unknowns.free, minimum.numbers, strict=True)])
    jacobian = minimum.jacobian / slopes
    norms = np.linalg.norm(jacobian, axis=0)
    active = norms > 0.0  # a coordinate that moves no residual at the minimum keeps its error
    variances = np.diag(uncertainty.covariance)
    if freedom <= 0 or not active.any() or not np.isfinite(variances[active]).all() or np.any(variances[active] <= 0.0):
        return uncertainty
    scaled = jacobian[:, active] / norms[active]
    influence = np.linalg.pinv(scaled).T / norms[active]  # J H, (n_residuals, n_active)
    covariance = uncertainty.covariance.copy()
    covariance[np.ix_(active, active)] = _sandwich(minimum.residual, influence, np.linalg.qr(scaled)[0], sizes, freedom)
    before, after = np.sqrt(variances), np.sqrt(np.diag(covariance))
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = dict(zip(uncertainty.free, np.where(active, after / before, 1.0), strict=True))
    parameters = {
        name: replace(p, standard_error=p.standard_error * grown.get(name, 1.0)) for name, p in uncertainty.parameters.items()
    }
    return replace(uncertainty, parameters=parameters, covariance=covariance)


def _sandwich(residual: Array, influence: Array, basis: Array, sizes: Sequence[int], freedom: int) -> Array:
    """Compute the covariance of the values, for noise of each loop's mean square with one spectrum for all loops.

    The residual is (n,); `influence`, (n, n_free), the change of the values by each residual; the columns of `basis`,
    (n, n_free), are orthonormal and span what the parameters move.
    """
    ends = np.cumsum(sizes)
    loops = [slice(end - size, end) for size, end in zip(sizes, ends, strict=True)]
    squares = [float(np.mean(residual[loop] ** 2)) for loop in loops]
    # One degree of freedom of white noise in each band: few loops may leave none to one.
    power, band_freedom = (np.full(len(BANDS), residual.size / freedom), np.ones(len(BANDS)))
    for loop, square in zip(loops, squares, strict=True):
        if square == 0.0:
            continue
        lines, fitted = _harmonics(residual[loop, np.newaxis]), _harmonics(basis[loop])
        band = np.searchsorted(BANDS, np.arange(1, lines.shape[0] + 1), side="right") - 1
        power += np.bincount(band, np.sum(np.abs(lines) ** 2, axis=1) / square, len(BANDS))
        band_freedom += np.bincount(band, np.maximum(2.0 - np.sum(np.abs(fitted) ** 2, axis=1), 0.0), len(BANDS))
    known = np.maximum(band_freedom, 4.0)
    spectrum = power / band_freedom * known / (known - 2.0)  # Student's distribution is wider than the normal one by this
    # At the harmonics it is straight in logarithms through the middles of its bands. Below the middle of the first it goes on
    # as it bends there: correlated noise is largest at the lowest harmonic.
    middles = np.log([*np.sqrt(np.multiply(BANDS[:-1], np.subtract(BANDS[1:], 1))), 1.4 * BANDS[-1]])
    harmonics, values = np.log(np.arange(1, max(sizes) // 2 + 1)), np.log(spectrum)
    slope = (values[1] - values[0]) / (middles[1] - middles[0])
    below = values[0] + slope * (harmonics - middles[0])
    spectrum_at_harmonics = np.exp(np.where(harmonics < middles[0], below, np.interp(harmonics, middles, values)))
    covariance = np.zeros((influence.shape[1], influence.shape[1]))
    for loop, square in zip(loops, squares, strict=True):
        moved = _harmonics(influence[loop])
        covariance += square * np.real(moved.conj().T @ (moved * spectrum_at_harmonics[: moved.shape[0], np.newaxis]))
    extra = influence[ends[-1] :]
    if extra.size:
        covariance += np.mean(residual[ends[-1] :] ** 2) * residual.size / freedom * (extra.T @ extra)
    return covariance


def _harmonics(values: Array) -> ComplexArray:
    """Return a loop's columns as harmonics from the first on, (n_harmonics, n), with the same sum of squares."""
    return np.asarray(np.fft.rfft(values, axis=0)[1 : (values.shape[0] + 1) // 2] * np.sqrt(2.0 / values.shape[0]))
