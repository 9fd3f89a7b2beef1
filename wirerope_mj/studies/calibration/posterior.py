"""Posterior of a fit: the affine-invariant sampler of emcee on a quadratic emulator, checked against runs of the model."""

from dataclasses import dataclass

import emcee
import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.calibration.fit import Fit, Problem

REACH = 1.3
"""Standard deviations of the points that the emulator is made from: a little beyond what the posterior holds."""

CHECKED = 16
"""Draws at which the emulator is held against the model."""

GOOD = 0.3
"""Root mean square error of the emulator's log likelihood within which it is taken: a band moves by less than a tenth."""

WALKERS, STEPS, BURNED, THIN = 48, 1200, 300, 20


@dataclass(frozen=True, kw_only=True)
class Posterior:
    """Draws of the unknowns after the tests.

    Attributes:
        normals: draws of u, (n, d).
        values: the same as values, (n, d).
        emulator_error: root mean square of the emulator's error in log likelihood at draws that it was not made from.
        acceptance: of the sampler.
        checked: rows of the draws that were computed by the model.
        series: the model's series there, (n_checked, n_samples).
    """

    normals: Array
    values: Array
    emulator_error: float
    acceptance: float
    checked: npt.NDArray[np.int64]
    series: Array


def sample(problem: Problem, found: Fit, *, draws: int = 1000, seed: int = 1) -> Posterior:
    """Return draws of the posterior.

    The whitened residual is a quadratic of s = (u - u*) / root of the covariance, made from runs about the fit, and its sum of
    squares a form of the coefficients' Gram matrix: a thousand steps of the sampler cost less than a run. The model is run
    again at draws; where the emulator misses there, these runs join it.
    """
    generator = np.random.default_rng(seed)
    root = np.asarray(np.linalg.cholesky(found.covariance), dtype=np.float64)
    roots = problem.roots(found.noises)
    size = found.normals.size
    count = _terms(np.zeros((1, size))).shape[1]
    points = REACH * generator.standard_normal((max(2 * count, 24), size))
    points = np.concatenate([np.zeros((1, size)), points])
    residuals = _residuals(problem, found.normals + points @ root.T, roots)
    error, rounds = np.inf, 3
    for number in range(rounds):
        good = np.isfinite(residuals).all(axis=1)
        coefficients = np.linalg.lstsq(_terms(points[good]), residuals[good], rcond=None)[0]
        gram = coefficients @ coefficients.T
        chain, acceptance = _walked(found, root, gram, draws, seed + number)
        rows = generator.choice(len(chain), CHECKED, replace=False)
        u = found.normals + chain[rows] @ root.T
        series = problem.model(u)
        true = problem.whitened((series - problem.measured).T, roots).T
        emulated = -0.5 * np.einsum("ni,ij,nj->n", _terms(chain[rows]), gram, _terms(chain[rows]))
        difference = emulated + 0.5 * np.sum(true**2, axis=1)
        error = float(np.sqrt(np.mean((difference - np.mean(difference)) ** 2)))
        if error < GOOD:
            break
        points, residuals = np.concatenate([points, chain[rows]]), np.concatenate([residuals, true])
    normals = found.normals + chain @ root.T
    return Posterior(
        normals=normals, values=problem.prior.values(normals), emulator_error=error, acceptance=acceptance,
        checked=rows, series=series,
    )  # fmt: skip


def _residuals(problem: Problem, normals: Array, roots: list[Array]) -> Array:
    return problem.whitened((problem.model(normals) - problem.measured).T, roots).T


def _terms(s: Array) -> Array:
    """Return 1, s and all products of two of them, (n, 1 + d + d (d + 1) / 2)."""
    rows, columns = np.triu_indices(s.shape[1])
    return np.concatenate([np.ones((len(s), 1)), s, s[:, rows] * s[:, columns]], axis=1)


def _walked(found: Fit, root: Array, gram: Array, draws: int, seed: int) -> tuple[Array, float]:
    """Return draws of s by the sampler, (draws, d), and its acceptance."""
    size = found.normals.size

    def logarithm(s: Array) -> Array:
        terms, u = _terms(s), found.normals + s @ root.T
        return -0.5 * (np.einsum("ni,ij,nj->n", terms, gram, terms) + np.sum(u**2, axis=1))

    walkers = max(WALKERS, 4 * size)
    sampler = emcee.EnsembleSampler(walkers, size, logarithm, vectorize=True)
    begin = np.random.RandomState(seed)  # the sampler's own kind
    sampler.random_state = begin.get_state()
    sampler.run_mcmc(0.5 * begin.standard_normal((walkers, size)), STEPS)
    chain = sampler.get_chain(discard=BURNED, thin=THIN, flat=True)
    rows = np.random.default_rng(seed).choice(len(chain), min(draws, len(chain)), replace=False)
    return chain[rows], float(np.mean(sampler.acceptance_fraction))
