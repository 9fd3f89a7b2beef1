"""Posterior of a fit: the affine-invariant sampler of emcee on a quadratic emulator, checked against runs of the model."""

from dataclasses import dataclass

import emcee
import numpy as np

from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.studies.calibration.fit import Fit, Prior, Problem

# Standard deviations of the points that the emulator is made from: a little beyond what the posterior holds
REACH = 1.3
CHECKED = 16  # draws at which the emulator is held against the model
# Root mean square error of the emulator's log likelihood within which it is taken: a band moves by less than a tenth
GOOD = 0.3
ROUNDS = 4  # times that runs at draws may join the emulator
_FAR, _SMALL = 4.0, 1e-4  # standard normals at which a prior is held to be positive, and the step of its slopes

WALKERS, STEPS, BURNED, THIN = 48, 1200, 300, 20


@dataclass(frozen=True, kw_only=True)
class Posterior:
    """Draws of the unknowns after the tests."""

    normals: Array  # draws of u, (n, d)
    values: Array  # the same as values, (n, d)
    # root mean square of the emulator's error in log likelihood at draws that it was not made from
    emulator_error: float
    acceptance: float  # of the sampler
    checked: Integers  # rows of the draws that were computed by the model
    series: Array  # the model's series there, (n_checked, n_samples)


class Coordinates:
    """Coordinates in which a model bends least: logarithms of values that are positive, over the fit's covariance.

    A response depends on stiffness over mass; in logarithms that is straight, however long the ridge.
    """

    def __init__(self, prior: Prior, found: Fit) -> None:
        self._prior, self._middle = prior, found.normals
        self.root = np.asarray(np.linalg.cholesky(found.covariance), dtype=np.float64)
        self._positive = (prior.values(np.outer([-_FAR, _FAR], np.ones(prior.size))) > 0.0).all(axis=0)
        self._at = self._plain(found.normals[np.newaxis])[0]
        steps = _SMALL * np.eye(prior.size)
        slopes = (self._plain(found.normals + steps) - self._plain(found.normals - steps)).T / (2.0 * _SMALL)
        # Values may scatter along fewer directions than there are: parameters of one [spread] that go together.
        self._inverse = np.linalg.pinv(slopes @ self.root)

    def normals(self, s: Array) -> Array:
        """Return u at standard deviations s of the fit, (n, d)."""
        return self._middle + s @ self.root.T

    def bent(self, normals: Array) -> Array:
        """Return the coordinates of u, (n, d): s where the priors are straight."""
        return np.asarray((self._plain(normals) - self._at) @ self._inverse.T)

    def _plain(self, normals: Array) -> Array:
        values = self._prior.values(normals)
        return np.where(self._positive, np.log(np.where(self._positive, values, 1.0)), values)


def sample(problem: Problem, found: Fit, *, draws: int = 1000, seed: int = 1) -> Posterior:
    """Return draws of the posterior.

    The whitened residual is a quadratic of `Coordinates`, made from runs about the fit, and its sum of squares a form of the
    coefficients' Gram matrix: a thousand steps of the sampler cost less than a run. The model is run again at draws; where the
    emulator misses there, these runs join it.
    """
    generator = np.random.default_rng(seed)
    coordinates, roots = Coordinates(problem.prior, found), problem.roots(found.noises)
    size = found.normals.size
    count = _terms(np.zeros((1, size))).shape[1]
    points = REACH * generator.standard_normal((max(2 * count, 24), size))
    normals = coordinates.normals(np.concatenate([np.zeros((1, size)), points]))
    residuals = problem.whitened((problem.model(normals) - problem.measured).T, roots).T
    error = np.inf
    for number in range(ROUNDS):
        good = np.isfinite(residuals).all(axis=1)
        terms = _terms(coordinates.bent(normals[good]))
        coefficients = np.linalg.lstsq(terms, residuals[good], rcond=None)[0]
        gram = coefficients @ coefficients.T
        chain, acceptance = _walked(coordinates, gram, draws, seed + number)
        rows = generator.choice(len(chain), CHECKED, replace=False)
        series = problem.model(chain[rows])
        true = problem.whitened((series - problem.measured).T, roots).T
        emulated = _logarithm(coordinates, gram, chain[rows])
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
    """Return 1, s and all products of two of them, (n, 1 + d + d (d + 1) / 2)."""
    rows, columns = np.triu_indices(s.shape[1])
    return np.concatenate([np.ones((len(s), 1)), s, s[:, rows] * s[:, columns]], axis=1)


def _logarithm(coordinates: Coordinates, gram: Array, normals: Array) -> Array:
    """Return the emulator's log likelihood at u, (n,)."""
    terms = _terms(coordinates.bent(normals))
    return np.asarray(-0.5 * np.einsum("ni,ij,nj->n", terms, gram, terms))


def _walked(coordinates: Coordinates, gram: Array, draws: int, seed: int) -> tuple[Array, float]:
    """Return draws of u by the sampler, (draws, d), and its acceptance."""
    size = coordinates.root.shape[0]

    def logarithm(s: Array) -> Array:
        u = coordinates.normals(s)
        return _logarithm(coordinates, gram, u) - 0.5 * np.sum(u**2, axis=1)

    walkers = max(WALKERS, 4 * size)
    sampler = emcee.EnsembleSampler(walkers, size, logarithm, vectorize=True)
    begin = np.random.RandomState(seed)  # the sampler's own kind
    sampler.random_state = begin.get_state()
    sampler.run_mcmc(0.5 * begin.standard_normal((walkers, size)), STEPS)
    chain = sampler.get_chain(discard=BURNED, thin=THIN, flat=True)
    rows = np.random.default_rng(seed).choice(len(chain), min(draws, len(chain)), replace=False)
    return coordinates.normals(chain[rows]), float(np.mean(sampler.acceptance_fraction))
