"""Fit of any forward model to measured series: a coarse design, least squares, and the noise that is left."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.studies.calibration.noise import Noise, Series, estimate_noise, first_noise
from wirerope_mj.studies.vary.distributions import LARGEST, SMALLEST, Normal, Uniform


@dataclass(frozen=True, kw_only=True)
class Prior:
    """Distributions of unknowns."""

    names: tuple[str, ...]  # of the unknowns
    units: tuple[str, ...]  # of their values; "" for factors
    quantiles: Callable[[Array], Array]  # maps probabilities (n, d) to values (n, d)

    @classmethod
    def of(cls, distributions: Mapping[str, Normal | Uniform]) -> Self:
        """Make the prior of independent unknowns without units."""
        own = tuple(distributions.values())
        return cls(
            names=tuple(distributions),
            units=("",) * len(own),
            quantiles=lambda p: np.stack([one.values(p[:, k]) for k, one in enumerate(own)], axis=1),
        )

    @property
    def size(self) -> int:
        """Number of unknowns d."""
        return len(self.names)

    def values(self, normals: Array) -> Array:
        """Return the values (n, d) at independent standard normals (n, d)."""
        return self.quantiles(np.clip(scipy.special.ndtr(normals), SMALLEST, LARGEST))


# Maps values of unknowns (n, d) to the model's series one behind the other, (n, n_samples); NaN in rows without any
Forward = Callable[[Array], Array]
DESIGN, STARTS = 64, 2  # Points of the coarse design, and how many of the best begin a search
STEP = 0.02  # Step of the differences that make the Jacobian, in standard deviations of the prior
ROUNDS, SHORT = 4, 2  # Times that the noise is estimated and the search goes on, from anywhere and from a known beginning
ROUGH, FINE = 1e-3, 1e-6  # Tolerances of searches with the noise guessed, and estimated
REFUSED = 1e3  # Whitened residual where the model cannot be computed


@dataclass(frozen=True, kw_only=True)
class Fit:
    """The most likely point and what surrounds it."""

    normals: Array  # u there, (d,)
    covariance: Array  # of u about it, prior included, (d, d)
    noises: tuple[Noise, ...]  # of each series
    model: Array  # the model's series there, (n_samples,)
    jacobian: Array  # their derivative by u, (n_samples, d)
    residual: Array  # whitened, (n_samples,)
    converged: bool  # whether the last search ended by itself
    runs: int  # of the model so far


class Problem:
    """A forward model, a prior and measured series, with a memory of runs.

    Attributes:
        runs: of the model so far.
    """

    def __init__(self, forward: Forward, series: Sequence[Series], prior: Prior) -> None:
        self.series, self.prior, self.runs = tuple(series), prior, 0
        self._forward = forward
        self.ends = np.cumsum([one.values.size for one in series])
        self.measured = np.concatenate([one.values for one in series])

    def split(self, values: Array) -> list[Array]:
        """Cut the last axis into the series."""
        return np.split(values, self.ends[:-1], axis=-1)

    def model(self, normals: Array) -> Array:
        """Return the model's series, (n, n_samples), at u (n, d)."""
        self.runs += len(normals)
        return self._forward(self.prior.values(normals))

    def jacobian(self, normals: Array) -> Array:
        """Return the derivative of the model's series by u, (n_samples, d), by central differences in one batch."""
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
        """Return the Cholesky factors of the series' covariances."""
        return [noise.root(one) for noise, one in zip(noises, self.series, strict=True)]

    def whitened(self, values: Array, roots: Sequence[Array]) -> Array:
        """Return L^-1 times values whose first axis is the samples."""
        parts = np.split(values, self.ends[:-1], axis=0)
        return np.concatenate(
            [
                scipy.linalg.solve_triangular(root, part, lower=True, check_finite=False)
                for root, part in zip(roots, parts, strict=True)
            ]
        )


def fit(problem: Problem, *, seed: int = 1, begin: tuple[Array, Sequence[Noise]] | None = None) -> Fit:
    """Return the most likely unknowns, the noise of every series estimated along with them.

    Searches begin at the best points of a coarse design that a seed draws; short ones at a point to `begin` at, u (d,), with
    the noise of every series.

    Raises:
        ConvergenceError: the model cannot be computed anywhere in the prior, or not beside the best point.
    """
    noises: Sequence[Noise] = [first_noise(one) for one in problem.series] if begin is None else begin[1]
    starts = _starts(problem, noises, seed) if begin is None else begin[0][np.newaxis]
    found = min((_searched(problem, noises, start, ROUGH) for start in starts), key=lambda ended: float(ended.cost))
    rounds, tolerance = (ROUNDS, FINE) if begin is None else (SHORT, ROUGH)
    for _ in range(rounds):
        jacobian = problem.jacobian(found.x)
        model = problem.model(found.x[np.newaxis])[0]
        linear = problem.measured - model + jacobian @ found.x
        noises = estimate_noise(problem.series, noises, np.split(jacobian, problem.ends[:-1]), problem.split(linear))
        before = found.x
        found = _searched(problem, noises, before, tolerance)
        if np.abs(found.x - before).max() < 1e-3:
            break
    model, roots = problem.model(found.x[np.newaxis])[0], problem.roots(noises)
    jacobian = problem.jacobian(found.x)
    white = problem.whitened(jacobian, roots)
    return Fit(
        normals=found.x, covariance=np.asarray(np.linalg.inv(white.T @ white + np.eye(found.x.size)), dtype=np.float64),
        jacobian=jacobian, noises=tuple(noises), model=model, residual=problem.whitened(model - problem.measured, roots),
        converged=found.status > 0, runs=problem.runs,
    )  # fmt: skip


def _starts(problem: Problem, noises: Sequence[Noise], seed: int) -> Array:
    """Return the best points of a coarse design, (n, d)."""
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
    return np.asarray(normals[good][np.argsort(costs)[:STARTS]])


def _searched(problem: Problem, noises: Sequence[Noise], start: Array, tolerance: float) -> scipy.optimize.OptimizeResult:
    """Return the end of a search by least squares over the whitened residual and the prior."""
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
