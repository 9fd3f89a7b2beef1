"""Fit of any forward model to measured series, and the posterior about it.

The fit: a coarse design, least squares, and the residual's noise. The posterior: the affine-invariant sampler of emcee on a
quadratic emulator, checked against runs of the model.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import emcee
import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.studies.calibration.noise import Noise, Series, estimate_noise, first_noise
from wirerope_mj.studies.vary.distributions import LARGEST, SMALLEST, Normal, Uniform


@dataclass(frozen=True, kw_only=True)
class Prior:
    """Joint distribution of the unknowns of a calibration before the tests."""

    names: tuple[str, ...]  # of the unknowns
    units: tuple[str, ...]  # of their values; "" for factors
    quantiles: Callable[[Array], Array]  # maps probabilities (n, d) to values (n, d)

    @classmethod
    def of(cls, distributions: Mapping[str, Normal | Uniform]) -> Self:
        """Make the prior of independent unknowns without units."""
        members = tuple(distributions.values())
        return cls(
            names=tuple(distributions),
            units=("",) * len(members),
            quantiles=lambda p: np.stack([member.values(p[:, k]) for k, member in enumerate(members)], axis=1),
        )

    @property
    def size(self) -> int:
        return len(self.names)

    def values(self, normals: Array) -> Array:
        """Map independent standard normals u (n, d) to values of the unknowns (n, d)."""
        return self.quantiles(np.clip(scipy.special.ndtr(normals), SMALLEST, LARGEST))


# Maps values of unknowns (n, d) to the model's series one behind the other, (n, n_samples); NaN in rows that fail
Forward = Callable[[Array], Array]
DESIGN, STARTS = 64, 2  # Points of the coarse design, and how many of the best begin a search
STEP = 0.02  # Step of the differences that make the Jacobian, in standard deviations of the prior
ROUNDS, SHORT = 4, 2  # Times that the noise is estimated and the search goes on, from anywhere and from a known beginning
ROUGH, FINE = 1e-3, 1e-6  # Tolerances of searches with the noise guessed, and estimated
SIDE = 8  # runs side by side that take as long as a single run, about: lanes on two processors
USUAL = 55  # Times that a calibration takes of such runs, about: the design, Jacobians and runs, the emulator and its check
REFUSED = 1e3  # Whitened residual where the model cannot be computed


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Most likely point of the unknowns, with the covariance, noise and derivatives there."""

    normals: Array  # standard normals u of the prior at the point, (d,)
    covariance: Array  # of u about it, prior included, (d, d)
    noises: tuple[Noise, ...]  # of each series
    model: Array  # the model's series there, (n_samples,)
    jacobian: Array  # their derivative by u, (n_samples, d)
    residual: Array  # whitened, (n_samples,)
    converged: bool  # whether the last search ended by itself
    runs: int  # of the model so far


class Problem:
    """A forward model, a prior and measured series, with a count of the model's runs.

    Attributes:
        runs: of the model so far.
        progress: called after each batch of runs with the time that all took so far, in multiples of a single run's.
    """

    def __init__(self, forward: Forward, series: Sequence[Series], prior: Prior) -> None:
        self.series, self.prior, self.runs = tuple(series), prior, 0
        self.progress: Callable[[int], None] = lambda times: None
        self._times = 0
        self._forward = forward
        self.ends = np.cumsum([item.values.size for item in series])
        self.measured = np.concatenate([item.values for item in series])

    def split(self, values: Array) -> list[Array]:
        """Split values of all series, one behind the other along the last axis, into those of each series."""
        return np.split(values, self.ends[:-1], axis=-1)

    def model(self, normals: Array) -> Array:
        """Return the model's series, (n, n_samples), at standard normals u of the prior, (n, d)."""
        values = self._forward(self.prior.values(normals))
        self.runs += len(normals)
        self._times += math.ceil(len(normals) / SIDE)
        self.progress(self._times)
        return values

    def jacobian(self, normals: Array) -> Array:
        """Return the derivative of the model's series by u at `normals` (d,), (n_samples, d), by central differences."""
        steps = STEP * np.eye(normals.size)
        values = self.model(np.concatenate([normals + steps, normals - steps]))
        ahead, behind = np.split(values, 2)
        slopes = ((ahead - behind) / (2.0 * STEP)).T
        if not np.isfinite(slopes).all():
            raise ConvergenceError(
                "the model cannot be computed beside the best point found; narrow the priors to values that it takes."
            )
        return np.asarray(slopes)

    def roots(self, noises: Sequence[Noise]) -> list[Array]:
        """Return the lower Cholesky factor of the noise's covariance of each series."""
        return [noise.root(item) for noise, item in zip(noises, self.series, strict=True)]

    def whitened(self, values: Array, roots: Sequence[Array]) -> Array:
        """Whiten values, the samples along their first axis, by the lower Cholesky factors of the noise: L^-1 times values."""
        parts = np.split(values, self.ends[:-1], axis=0)
        return np.concatenate(
            [
                scipy.linalg.solve_triangular(root, part, lower=True, check_finite=False)
                for root, part in zip(roots, parts, strict=True)
            ]
        )


def fit(problem: Problem, *, seed: int = 1, begin: tuple[Array, Sequence[Noise]] | None = None) -> Fit:
    """Fit the unknowns, and estimate the noise of every series along with them.

    Searches begin at the best points of a coarse design drawn with `seed`; or, shorter, at `begin`: standard normals u (d,) of
    the prior and the noise of every series.

    Raises:
        ConvergenceError: the model cannot be computed anywhere in the prior, or not beside the best point.
    """
    noises: Sequence[Noise]
    if begin is None:
        noises = [first_noise(item) for item in problem.series]
        points = scipy.stats.qmc.Sobol(problem.prior.size, scramble=True, rng=np.random.default_rng(seed)).random(DESIGN)
        normals = np.vstack([np.zeros(problem.prior.size), scipy.special.ndtri(np.clip(points, 1e-3, 1.0 - 1e-3))])
        values = problem.model(normals)
        good = np.isfinite(values).all(axis=1)
        if not good.any():
            raise ConvergenceError(
                f"the model could be computed at none of {len(normals)} points of the prior; narrow it to values that it takes."
            )
        white = problem.whitened((values[good] - problem.measured).T, problem.roots(noises))
        costs = np.sum(white**2, axis=0) + np.sum(normals[good] ** 2, axis=1)
        starts = normals[good][np.argsort(costs)[:STARTS]]
    else:
        starts, noises = begin[0][np.newaxis], begin[1]
    best = min((_search(problem, noises, start, ROUGH) for start in starts), key=lambda ended: float(ended.cost))
    rounds, tolerance = (ROUNDS, FINE) if begin is None else (SHORT, ROUGH)
    for _ in range(rounds):
        jacobian = problem.jacobian(best.x)
        model = problem.model(best.x[np.newaxis])[0]
        linear = problem.measured - model + jacobian @ best.x
        noises = estimate_noise(problem.series, noises, np.split(jacobian, problem.ends[:-1]), problem.split(linear))
        before = best.x
        best = _search(problem, noises, before, tolerance)
        if np.abs(best.x - before).max() < 1e-3:
            break
    model, roots = problem.model(best.x[np.newaxis])[0], problem.roots(noises)
    jacobian = problem.jacobian(best.x)
    white = problem.whitened(jacobian, roots)
    return Fit(
        normals=best.x, covariance=np.asarray(np.linalg.inv(white.T @ white + np.eye(best.x.size)), dtype=np.float64),
        jacobian=jacobian, noises=tuple(noises), model=model, residual=problem.whitened(model - problem.measured, roots),
        converged=best.status > 0, runs=problem.runs,
    )  # fmt: skip


def _search(problem: Problem, noises: Sequence[Noise], start: Array, tolerance: float) -> scipy.optimize.OptimizeResult:
    """Search for the least squares of whitened residual and prior, from `start` on; return SciPy's result."""
    roots = problem.roots(noises)

    def residual(u: Array) -> Array:
        values = problem.model(u[np.newaxis])[0]
        if not np.isfinite(values).all():
            return np.full(values.size + u.size, REFUSED)
        return np.concatenate([problem.whitened(values - problem.measured, roots), u])

    def jacobian(u: Array) -> Array:
        return np.vstack([problem.whitened(problem.jacobian(u), roots), np.eye(u.size)])

    return scipy.optimize.least_squares(
        residual, start, jac=jacobian, method="trf", x_scale="jac", ftol=tolerance, xtol=10.0 * tolerance, gtol=tolerance,
        max_nfev=30,
    )  # fmt: skip


# Standard deviations of the points that the emulator is made from: a little beyond what the posterior holds
REACH = 1.3
CHECKED = 16  # draws at which the emulator is held against the model
# Root mean square error of the emulator's log likelihood within which it is taken: a band moves by less than a tenth
GOOD = 0.3
JOINED = 4  # times that runs at draws may join the emulator
_PRIOR_ENDS, _SMALL = 4.0, 1e-4  # standard normals at which a prior is held to be positive, and the step of its slopes

WALKERS, STEPS, BURNED, THIN = 48, 1200, 300, 20  # of the sampler: walkers, steps, steps discarded, steps to a draw


@dataclass(frozen=True, kw_only=True)
class Posterior:
    """Draws of the unknowns after the tests."""

    normals: Array  # draws in standard normals u of the prior, (n, d)
    values: Array  # the same as values, (n, d)
    # root mean square of the emulator's error in log likelihood at draws that it was not made from
    emulator_error: float
    acceptance: float  # of the sampler
    checked: Integers  # rows of the draws that were computed by the model
    series: Array  # the model's series there, (n_checked, n_samples)


class Coordinates:
    """Coordinates in which a model is closest to linear: logarithms of positive values, scaled by the fit's covariance.

    A response depends on stiffness over mass: the ridge of equally good values is straight in logarithms, however long.
    """

    def __init__(self, prior: Prior, found: Fit) -> None:
        self._prior, self._middle = prior, found.normals
        self.root = np.asarray(np.linalg.cholesky(found.covariance), dtype=np.float64)
        self._positive = (prior.values(np.outer([-_PRIOR_ENDS, _PRIOR_ENDS], np.ones(prior.size))) > 0.0).all(axis=0)
        self._origin = self._logarithms(found.normals[np.newaxis])[0]
        steps = _SMALL * np.eye(prior.size)
        slopes = (self._logarithms(found.normals + steps) - self._logarithms(found.normals - steps)).T / (2.0 * _SMALL)
        # Values may scatter along fewer directions than there are: parameters of one [spread] that go together.
        self._inverse = np.linalg.pinv(slopes @ self.root)

    def normals(self, s: Array) -> Array:
        """Return standard normals u (n, d) of the prior that lie s (n, d) standard deviations of the fit from its point."""
        return self._middle + s @ self.root.T

    def from_normals(self, normals: Array) -> Array:
        """Return the coordinates of standard normals u, (n, d); they equal the s of `normals` where the priors are linear."""
        return np.asarray((self._logarithms(normals) - self._origin) @ self._inverse.T)

    def _logarithms(self, normals: Array) -> Array:
        """Return the values of the unknowns at standard normals u (n, d), as logarithms where an unknown is always positive."""
        values = self._prior.values(normals)
        return np.where(self._positive, np.log(np.where(self._positive, values, 1.0)), values)


def sample(problem: Problem, fitted: Fit, *, draws: int = 1000, seed: int = 1) -> Posterior:
    """Draw from the posterior by emcee, on a quadratic emulator of the residual.

    The whitened residual is a quadratic of `Coordinates`, made from runs about the fit, and its sum of squares a form of the
    coefficients' Gram matrix: a thousand steps of the sampler cost less than a run. The model is run again at draws; where the
    emulator misses there, these runs join it.
    """
    generator = np.random.default_rng(seed)
    coordinates, roots = Coordinates(problem.prior, fitted), problem.roots(fitted.noises)
    size = fitted.normals.size
    count = _terms(np.zeros((1, size))).shape[1]
    points = REACH * generator.standard_normal((max(2 * count, 24), size))
    normals = coordinates.normals(np.concatenate([np.zeros((1, size)), points]))
    residuals = problem.whitened((problem.model(normals) - problem.measured).T, roots).T
    error = np.inf
    for number in range(JOINED):
        good = np.isfinite(residuals).all(axis=1)
        terms = _terms(coordinates.from_normals(normals[good]))
        coefficients = np.linalg.lstsq(terms, residuals[good], rcond=None)[0]
        gram = coefficients @ coefficients.T
        chain, acceptance = _sampled(coordinates, gram, draws, seed + number)
        rows = generator.choice(len(chain), CHECKED, replace=False)
        series = problem.model(chain[rows])
        true = problem.whitened((series - problem.measured).T, roots).T
        emulated = _log_likelihood(coordinates, gram, chain[rows])
        difference = emulated + 0.5 * np.sum(true**2, axis=1)
        error = float(np.sqrt(np.mean((difference - np.mean(difference)) ** 2)))
        if error < GOOD:
            break
        normals, residuals = np.concatenate([normals, chain[rows]]), np.concatenate([residuals, true])
    return Posterior(
        normals=chain, values=problem.prior.values(chain), emulator_error=error, acceptance=acceptance, checked=rows,
        series=series,
    )  # fmt: skip


def _terms(s: Array) -> Array:
    """Return the terms of a quadratic in s (n, d): 1, s and all products of two of them, (n, 1 + d + d (d + 1) / 2)."""
    rows, columns = np.triu_indices(s.shape[1])
    return np.concatenate([np.ones((len(s), 1)), s, s[:, rows] * s[:, columns]], axis=1)


def _log_likelihood(coordinates: Coordinates, gram: Array, normals: Array) -> Array:
    """Return the emulator's log likelihood, (n,), at standard normals u of the prior, (n, d)."""
    terms = _terms(coordinates.from_normals(normals))
    return np.asarray(-0.5 * np.einsum("ni,ij,nj->n", terms, gram, terms))


def _sampled(coordinates: Coordinates, gram: Array, draws: int, seed: int) -> tuple[Array, float]:
    """Draw standard normals u of the prior, (draws, d), by emcee on the emulator; return them and the accepted fraction."""
    size = coordinates.root.shape[0]

    def log_posterior(s: Array) -> Array:
        u = coordinates.normals(s)
        return _log_likelihood(coordinates, gram, u) - 0.5 * np.sum(u**2, axis=1)

    walkers = max(WALKERS, 4 * size)
    sampler = emcee.EnsembleSampler(walkers, size, log_posterior, vectorize=True)
    begin = np.random.RandomState(seed)  # the sampler's own kind
    sampler.random_state = begin.get_state()
    sampler.run_mcmc(0.5 * begin.standard_normal((walkers, size)), STEPS)
    chain = sampler.get_chain(discard=BURNED, thin=THIN, flat=True)
    rows = np.random.default_rng(seed).choice(len(chain), min(draws, len(chain)), replace=False)
    return coordinates.normals(chain[rows]), float(np.mean(sampler.acceptance_fraction))
