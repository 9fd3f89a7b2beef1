"""Calibration: values with covariance and draws, unknowns that the tests do not identify, and the model's own error."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.motions.spectra.srs import shock_response_spectrum
from wirerope_mj.studies.calibration.fit import GOOD, USUAL, Fit, Forward, Posterior, Prior, Problem, fit, sample
from wirerope_mj.studies.calibration.forward import SystemForward, Test
from wirerope_mj.studies.calibration.noise import DOMAINS, Domain, Series
from wirerope_mj.studies.calibration.open_law import open_laws
from wirerope_mj.studies.vary.distributions import Distribution
from wirerope_mj.studies.vary.vary_option import read_vary

LEVEL = 0.9  # Probability of the intervals that are stated
LITTLE = 0.7  # Standard deviation after the tests over that before from which on an unknown counts as not identified
TOGETHER = 0.95  # Correlation from which on two unknowns are known together only
# Standard deviation after the tests over that before from which on such a pair is named: less is known well enough apart
OPEN = 0.2
DISCREPANT = 0.1  # Discrepancy over the response from which on the model does not follow a channel
LOGARITHMS = "logarithm of frequency"  # `Series.across` of spectra in logarithms: their differences are relative errors
FAR = 2.5  # Standard deviations of the prior from which on a median stands at its end: one of a hundred is so far out
TINY = 1e-8  # Square of a slope over the response below which an unknown does not move it
# Octaves to each side of a history's frequency, and Q, of the oscillators that measure the error of peaks: as of equipment on
# wire rope, whose damping is a sixth of critical
OCTAVES, ISOLATED = 2, 3.0


@dataclass(frozen=True, kw_only=True, repr=False)
class Calibrated(Summarised):
    """Result of the calibration of any forward model to measured series."""

    problem: Problem  #: model, prior and series
    fit: Fit  #: the most likely point, and the noise of every series
    posterior: Posterior  #: draws

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {
            name: f"{value:.5g} ({low:.5g} to {high:.5g}) {unit}".rstrip()
            for name, unit, value, (low, high) in zip(self.names, self.units, self.values, self.intervals(), strict=True)
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

    @cached_property
    def normals(self) -> Array:
        """Draws of the unknowns in standard normals of the prior, (n, d), widened by the model's own error.

        That error does not average out over a test as noise does. So the likelihood is raised to a power, at most 1 (Miller
        and Dunson 2019), with which the tests determine the unknowns, on average over their directions, as one observation with
        the model's error would; how well in proportion to each other, such as stiffness to mass, stays. Each of a channel's
        unknowns could besides be the cause of the whole error, which is embedded in it (Sargsyan, Najm and Ghanem 2015): what
        a law does not follow and what a gain or a delay takes up instead cannot be told from each other, and a model whose
        error is a fraction x of a response of frequency f looks x / (2 pi f) late.
        """
        size, error = len(self.names), 0.0
        identity, sensitivity = np.eye(size), np.zeros((size, size))
        slopes = np.split(self.fit.jacobian, self.problem.ends[:-1])
        for series, noise, slope in zip(self.problem.series, self.fit.noises, slopes, strict=True):
            error += float(np.mean((noise.deviation(series) / series.rms) ** 2))
            sensitivity += slope.T @ slope / (len(slope) * series.rms**2)
        chain = [name.startswith("channel/") for name in self.names]
        embedded = np.diag(np.where(chain, error / np.maximum(np.diag(sensitivity), TINY), 0.0))
        information = np.linalg.inv(self.fit.covariance) - identity
        directions, alike = (np.trace(np.linalg.solve(information + TINY * identity, m)) for m in (information, sensitivity))
        tempering = max(error * directions / max(alike, TINY), 1.0)
        draws = self.posterior.normals
        middle, sizes, axes = draws.mean(axis=0), *np.linalg.eigh(np.atleast_2d(np.cov(draws.T)))
        covariance = axes * np.minimum(sizes, 1.0 - 1e-6) @ axes.T  # tests do not widen a prior
        information = np.linalg.inv(covariance) - identity
        reduction = np.linalg.inv(tempering * identity + information @ embedded)
        after = np.linalg.inv(identity + reduction @ information)
        widened = np.linalg.cholesky(after) @ np.linalg.inv(np.linalg.cholesky(covariance))
        return after @ reduction @ np.linalg.solve(covariance, middle) + (draws - middle) @ widened.T

    @cached_property
    def samples(self) -> Array:
        """Draws of the unknowns, (n, d)."""
        return self.problem.prior.values(self.normals)

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

    @cached_property
    def learned(self) -> Array:
        """Ratio of standard deviations after and before the tests, (d,): 1 where the tests tell nothing."""
        evenly = np.repeat((np.arange(1000)[:, None] + 0.5) / 1000, len(self.names), axis=1)
        return np.asarray(np.std(self.samples, axis=0) / np.std(self.problem.prior.quantiles(evenly), axis=0))

    @cached_property
    def at_an_end(self) -> dict[str, str]:
        """The end of the prior, "upper" or "lower", by names of the unknowns whose median lies there."""
        middle = dict(zip(self.names, np.median(self.normals, axis=0).tolist(), strict=True))
        return {name: "upper" if u > 0.0 else "lower" for name, u in middle.items() if abs(u) > FAR}

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
        """Messages on each unknown that the tests hardly narrow, and each pair of which they determine a combination only."""
        texts = [
            f"the tests say little of {name}: its standard deviation is {100.0 * ratio:.0f} % of that stated before"
            for name, ratio in zip(self.names, self.learned, strict=True)
            if ratio > LITTLE
        ]
        for i, later in enumerate(self.names):
            for k, earlier in enumerate(self.names[:i]):
                rho = self.correlation[i, k]
                if abs(rho) > TOGETHER and max(self.learned[i], self.learned[k]) > OPEN:
                    kind = "their ratio" if rho > 0.0 else "their product"
                    texts.append(f"{earlier} and {later} are known together only (correlation {rho:+.2f}): {kind} is")
        return tuple(texts)

    @property
    def discrepancies(self) -> Array:
        """Standard deviation of the model's own error over the local size of the response, of each series, (n_series,)."""
        return np.array([noise.discrepancy for noise in self.fit.noises])

    @cached_property
    def peak_error(self) -> tuple[float, int]:
        """Relative rms error of the model's peaks, without the noise, and the number of errors that it is computed from.

        A history has an extreme or two, one of them perhaps saturated. So its errors are ratios of shock response spectra at
        octaves about its own frequency; those of a loop are the errors of its two extremes, that of a spectrum in logarithms is
        the difference of the largest values.
        """
        squares: list[float] = []
        for series, model, noise in zip(self.problem.series, self.problem.split(self.fit.model), self.fit.noises, strict=True):
            noisy = noise.white / (1.0 if series.across == LOGARITHMS else series.largest)
            squares += ((_peaks(series, model) - _peaks(series, series.values)) ** 2 - noisy**2).tolist()
        return math.sqrt(max(float(np.mean(squares)), 0.0)), len(squares)

    @property
    def message(self) -> str:
        """One sentence on how the calibration ended."""
        ended = "converged" if self.fit.converged else "NOT CONVERGED"
        emulator = self.posterior.emulator_error
        error = 100.0 * self.discrepancies.max()
        text = f"{ended}; {self.problem.runs} runs of the model; model error {error:.2g} % of the response"
        return text if emulator < GOOD else f"{text}; the sampler's quadratic misses log likelihoods by {emulator:.2g}"


def _peaks(series: Series, values: Array) -> Array:
    """Return the peaks of a series as numbers whose differences are relative errors, (n,)."""
    if series.across == LOGARITHMS:
        return values.max(keepdims=True)
    if series.across != "time":
        return np.array([values.max(), values.min()]) / np.abs(series.values).max()
    step = float(np.diff(series.at).min())
    time = np.arange(series.at[0], series.at[-1] + 0.5 * step, step)  # saturated samples are bridged straight, in all values
    frequencies = series.frequency * 2.0 ** np.arange(-OCTAVES, OCTAVES + 1)
    frequencies = frequencies[frequencies <= max(0.1 / step, frequencies[0])]
    even = np.interp(time, series.at, values)
    return np.log(shock_response_spectrum(time - time[0], even, frequencies, q=ISOLATED).maximax)


@dataclass(frozen=True, kw_only=True, repr=False)
class Calibration(Calibrated):
    """Result of the calibration of a system to its tests."""

    forward: SystemForward  #: the system, its tests, and what varies

    @cached_property
    def system(self) -> System:
        """System with the medians of the unknowns."""
        return self.forward.system_at(self.values)

    @cached_property
    def tested_travel(self) -> dict[tuple[str, str], float]:
        """Largest deflections of mounts in the tests, at the most likely values, by mount and axis [m]."""
        return self.forward.tested_travel(self.problem.prior.values(self.fit.normals[np.newaxis])[0])

    @cached_property
    def opened(self) -> "Calibration":
        """Calibration to the same tests with hardening and asymmetry as further unknowns (`open_laws`); self if none apply."""
        forward = self.forward
        laws = open_laws(forward.system, forward.vary, self.tested_travel)
        if not laws.added:
            return self
        wider = SystemForward(laws.system, forward.tests, laws.vary, forward.domain)
        problem, first = Problem(wider, wider.series, wider.prior), len(forward.columns)
        start = np.insert(self.fit.normals, first, np.zeros(len(laws.added)))
        refit = fit(problem, begin=(start, self.fit.noises))
        draws = sample(problem, refit, draws=len(self.posterior.normals))
        return Calibration(problem=problem, fit=refit, posterior=draws, forward=wider)

    def lag(self, number: int) -> float:
        """Return the delay of a measured history behind the model [s]; 0 unless it halves the rms residual.

        The model at the most likely values is moved by up to half of the measured history's length to either side.
        """
        series = self.problem.series[number]
        if series.across != "time":
            return 0.0
        steps = 0.5 * (series.at - series.at[0])
        lags = np.concatenate([-steps[:0:-1], steps])
        values = self.problem.prior.values(self.fit.normals[np.newaxis])[0]
        squares = np.sum((self.forward.delayed(values, number, lags) - series.values) ** 2, axis=1)
        best = int(np.argmin(squares))
        return float(lags[best]) if squares[best] < 0.25 * squares[steps.size - 1] else 0.0


def calibrate(
    system: System, tests: Sequence[Test], *, vary: Mapping[str, Distribution] | Sequence[str], residuals: Domain = "time",
    draws: int = 1000, seed: int = 1, progress: Callable[[float], None] = lambda fraction: None,
) -> Calibration:  # fmt: skip
    """Calibrate the unknowns of a system to its tests: values, covariance, draws, and the system with the medians.

    A coarse design of the prior, computed in lanes, gives the best points from which least squares begin. Noise and the model's
    own error are estimated for every channel with the unknowns integrated out; draws are emcee's on a quadratic emulator that
    is checked against runs.

    Args:
        system: as far as it is known.
        tests: measured channels with the base's motion, frequency responses, loops of an isolator in a rig.
        vary: priors of what is to be found, by the names that a study takes, and of channels as "channel/NAME/gain", "delay" or
            "offset"; or the same as lines of text.
        residuals: "time", or "srs" or "spectrum" for the logarithms of the channels' spectra; frequency responses and loops are
            compared as they are.
        draws: of the posterior.
        seed: of design and sampler.
        progress: takes the fraction of the runs that is done, of as many as calibrations usually take.

    Raises:
        ValueError: a prior is missing, or is none that can be calibrated.
        ModelError: a name stands for nothing in the system.
        RecordError: a channel is not of this system, is too short or dead.
        ConvergenceError: the model cannot be computed within the priors.
    """
    if not tests:
        raise ValueError("`tests` must name one measured test at least, got none.")
    one_of("residuals", residuals, DOMAINS)
    distributions = dict(vary) if isinstance(vary, Mapping) else read_vary(vary)
    forward = SystemForward(system, tests, distributions, residuals)
    result = calibrate_model(forward, forward.series, forward.prior, draws=draws, seed=seed, progress=progress)
    return Calibration(problem=result.problem, fit=result.fit, posterior=result.posterior, forward=forward)


def calibrate_model(
    forward: Forward, series: Sequence[Series], prior: Prior, *, draws: int = 1000, seed: int = 1,
    progress: Callable[[float], None] = lambda fraction: None,
) -> Calibrated:  # fmt: skip
    """Calibrate the unknowns of any forward model to measured series; arguments as those of `calibrate`."""
    problem = Problem(forward, series, prior)
    problem.progress = lambda times: progress(min(times / USUAL, 1.0))
    most_likely = fit(problem, seed=seed)
    return Calibrated(problem=problem, fit=most_likely, posterior=sample(problem, most_likely, draws=draws, seed=seed))
