"""A calibration: values with their covariance and draws, what the tests do not tell, and how far the model follows them."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.studies.calibration.fit import Fit, Problem
from wirerope_mj.studies.calibration.forward import SystemForward
from wirerope_mj.studies.calibration.posterior import GOOD, Posterior

LEVEL = 0.9
"""Probability of the intervals that are stated."""

LITTLE = 0.7
"""Standard deviation after the tests over that before from which on they say little of an unknown."""

TOGETHER = 0.95
"""Correlation from which on two unknowns are known together only."""

EMBEDDED = 0.3
"""Largest model error that is put into the values of mounts: beyond it they mean little."""

OPEN = 0.2
"""Standard deviation after the tests over that before from which on such a pair is named: less is known well enough apart."""

DISCREPANT = 0.1
"""Discrepancy over the response from which on the model does not follow a channel."""


MINOR = 0.5
"""Extreme over the largest of its series from which on it counts as a peak: a smaller one says little of the largest."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Calibrated(Summarised):
    """Any forward model brought to measured series.

    Attributes:
        problem: model, prior and series.
        fit: the most likely point, and the noise of every series.
        posterior: draws.
    """

    problem: Problem
    fit: Fit
    posterior: Posterior

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {
            name: f"{value:.5g} ({low:.5g} to {high:.5g}) {unit}".rstrip()
            for name, unit, value, (low, high) in zip(
                self.names, self.units, self.values, self.intervals(), strict=True
            )
        }
        return f"{type(self).__name__}: {self.message}", lines

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return self.problem.prior.names

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the unknowns; "" for factors."""
        return self.problem.prior.units

    @property
    def samples(self) -> Array:
        """Draws of the posterior, (n, d)."""
        return self.posterior.values

    @cached_property
    def values(self) -> Array:
        """Medians of the draws, (d,)."""
        return np.asarray(np.median(self.samples, axis=0))

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the draws, (d, d)."""
        return np.atleast_2d(np.cov(self.samples.T))

    @cached_property
    def correlation(self) -> Array:
        """Correlation of the draws, (d, d)."""
        deviations = np.sqrt(np.diag(self.covariance))
        return self.covariance / np.outer(deviations, deviations)

    def intervals(self, level: float = LEVEL) -> Array:
        """Return the ends of the central intervals that hold each unknown with a probability, (d, 2)."""
        return np.quantile(self.samples, [0.5 - 0.5 * level, 0.5 + 0.5 * level], axis=0).T

    @property
    def learned(self) -> Array:
        """Standard deviation after the tests over that before, in the prior's own scale, (d,): 1 where nothing was learned."""
        return np.asarray(np.std(self.posterior.normals, axis=0))

    @property
    def insignificant(self) -> tuple[str, ...]:
        """Names of values other than factors that lie within two standard deviations of zero."""
        deviations = np.sqrt(np.diag(self.covariance))
        return tuple(
            name
            for name, unit, value, deviation in zip(self.names, self.units, self.values, deviations, strict=True)
            if unit == "SI" and not name.startswith("channel/") and abs(value) < 2.0 * deviation
        )

    @property
    def not_identified(self) -> tuple[str, ...]:
        """A message for each unknown of which the tests say little, and for those that are known together only."""
        texts = [
            f"the tests say little of {name}: its standard deviation is {100.0 * left:.0f} % of that stated before"
            for name, left in zip(self.names, self.learned, strict=True)
            if left > LITTLE
        ]
        for i, one in enumerate(self.names):
            for k, other in enumerate(self.names[:i]):
                rho = self.correlation[i, k]
                if abs(rho) > TOGETHER and max(self.learned[i], self.learned[k]) > OPEN:
                    kind = "their ratio" if rho > 0.0 else "their product"
                    texts.append(f"{other} and {one} are known together only (correlation {rho:+.2f}): {kind} is")
        return tuple(texts)

    @property
    def discrepancies(self) -> Array:
        """Standard deviation of the model's own error over the local size of the response, of each series, (n_series,)."""
        return np.array([noise.discrepancy for noise in self.fit.noises])

    @cached_property
    def peak_error(self) -> tuple[float, int]:
        """Root mean square error of the model's extremes over the largest of their series, noise taken off, and their number.

        Extremes below `MINOR` of the largest are left out. Of logarithms it is the difference at the largest value.
        """
        squares: list[float] = []
        models = self.problem.split(self.fit.model)
        for one, own, noise in zip(self.problem.series, models, self.fit.noises, strict=True):
            ends = [(float(own.max()), float(one.values.max())), (float(own.min()), float(one.values.min()))]
            largest = max(abs(measured) for _, measured in ends) if one.unit else 1.0
            kept = [end for end in ends if abs(end[1]) > MINOR * largest] if one.unit else ends[:1]
            squares += [((calculated - measured) ** 2 - noise.white**2) / largest**2 for calculated, measured in kept]
        return math.sqrt(max(float(np.mean(squares)), 0.0)), len(squares)

    @property
    def message(self) -> str:
        """How the calibration ended."""
        ended = "converged" if self.fit.converged else "NOT CONVERGED"
        emulator = self.posterior.emulator_error
        error = 100.0 * self.discrepancies.max()
        text = f"{ended}; {self.problem.runs} runs of the model; model error {error:.2g} % of the response"
        return text if emulator < GOOD else f"{text}; the sampler's quadratic misses log likelihoods by {emulator:.2g}"


@dataclass(frozen=True, kw_only=True, repr=False)
class Calibration(Calibrated):
    """A system brought to its tests.

    Attributes:
        forward: the system, its tests, and what varies.
    """

    forward: SystemForward

    @cached_property
    def samples(self) -> Array:
        """Draws of the posterior, (n, d), those of mounts with the model's own error in them.

        That error does not average out over a test as noise does: a law that misses the response by some percent is not known
        better than that (embedded model error, Sargsyan, Najm and Ghanem 2015).
        """
        draws = self.posterior.values.copy()
        laws = [
            name.startswith("mount/") and unit in ("", "SI") for name, unit in zip(self.names, self.units, strict=True)
        ]
        error = min(float(np.sqrt(np.mean(self.discrepancies**2))), EMBEDDED)
        normals = np.random.default_rng(1).standard_normal((len(draws), sum(laws)))
        draws[:, laws] *= np.exp(error * normals)
        return draws

    @cached_property
    def system(self) -> System:
        """The system with the medians of what varies."""
        return self.forward.system_at(self.values)
