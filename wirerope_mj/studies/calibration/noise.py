"""Measured series, in time or as spectra, with their noise and the model's own error, estimated from a fit's residual.

A residual is noise, white before its samples were smoothed, and, where the model does not follow, a smooth error of its own: a
Gaussian process that grows with the response there, oscillates with it, and is correlated over some length (Kennedy
and O'Hagan 2001; Brynjarsdottir and O'Hagan 2014). So a wrong model gets wide bands, and a right one narrow ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions.spectra.srs import shock_response_spectrum

# Noise and discrepancy from which the first fit starts, over the rms and the local size of a series
WHITE, DISCREPANT = 0.05, 0.1
LEAST_SIZE = 1e-4  # least noise over a series' rms: less is rounding and the error of the simulation
LARGEST_SIZE = 2.0  # largest discrepancy over the local size: a model that far off explains nothing
POWERS = (0.0, 1.5)  # of the local size, with which a discrepancy may grow


@dataclass(frozen=True, kw_only=True)
class Series:
    """Measured series that a model is compared with."""

    name: str  # in tables and messages
    at: Array  # instants [s], or logarithms of frequencies, rising, (n,)
    values: Array  # (n,)
    size: Array  # local size of the response, relative to which the discrepancy is, (n,)
    frequency: float = 0.0  # about which the discrepancy oscillates [1 / unit of `at`]; 0 for none
    unit: str = ""  # of the values; "" for logarithms and what has none
    across: Literal["time", "logarithm of frequency", "loop", "other"] = "other"  # what `at` is
    # standard deviation of the smoothing of its samples [unit of `at`], which correlates their noise; 0 for none
    smoothed: float = 0.0
    averaged: float = 1.0  # standard deviation of its noise over that of a measured sample, where the smoothing averages them

    @cached_property
    def rms(self) -> float:
        """Root mean square of the local size of the response [unit of the series]."""
        return float(np.sqrt(np.mean(self.size**2)))

    @cached_property
    def lags(self) -> tuple[Array, Array]:
        """Distances between samples, and the cosine with which the model's own error oscillates over them, (n, n) each."""
        lag = np.abs(self.at[:, np.newaxis] - self.at)
        return lag, np.cos(2.0 * np.pi * self.frequency * lag)

    @cached_property
    def noise(self) -> Array:
        """Correlation of the noise of smoothed samples, (n, n): a Gaussian, sqrt(2) times as wide as the smoothing."""
        if not self.smoothed:
            return np.eye(self.at.size)
        return np.exp(-0.25 * (self.lags[0] / self.smoothed) ** 2)

    @cached_property
    def largest(self) -> float:
        """Largest local size of the response [unit of the series]."""
        return float(self.size.max())

    @cached_property
    def lengths(self) -> tuple[float, float]:
        """Shortest and longest correlation length of the search [unit of `at`]."""
        step, whole = float(np.median(np.diff(self.at))), float(np.ptp(self.at))
        shortest = max(2.0 * step, 0.25 / self.frequency if self.frequency else 0.0)
        return shortest, max(whole, 2.0 * shortest)


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Noise of a series, and the model's own error there, its discrepancy."""

    white: float  # standard deviation of the samples' noise [unit of the series]
    # standard deviation of the model's own error where the response is largest, over its size there [-]
    discrepancy: float
    length: float  # correlation length of that error [unit of `at`]
    power: float = 1.0  # of the local size with which it grows: 1 in proportion, 0 the same everywhere

    def deviation(self, series: Series) -> Array:
        """Return the standard deviation of the model's own error, (n,)."""
        return self.discrepancy * series.largest * (series.size / series.largest) ** self.power

    def root(self, series: Series) -> Array:
        """Return the lower Cholesky factor of the covariance of noise and model's own error together, (n, n)."""
        lag, swing = series.lags
        deviation = self.deviation(series)
        covariance = np.exp(-lag / self.length) * swing * deviation * deviation[:, np.newaxis]
        covariance += self.white**2 * series.noise
        return np.asarray(scipy.linalg.cholesky(covariance, lower=True, overwrite_a=True, check_finite=False))


def first_noise(series: Series) -> Noise:
    """Return the noise of a series with which the first fit starts."""
    low, high = series.lengths
    return Noise(white=WHITE * series.rms, discrepancy=DISCREPANT, length=float(np.sqrt(low * high)))


@dataclass(frozen=True, kw_only=True)
class Information:
    """Information on the unknowns u in series with Jacobian J by u, covariance K and residual r."""

    precision: Array  # J^T K^-1 J, (d, d)
    projection: Array  # of the residual: J^T K^-1 r, (d,)


def information(series: Series, noise: Noise, jacobian: Array, linear: Array) -> tuple[Information, float, float]:
    """Return the information of a series, half the log determinant of its covariance K, and r^T K^-1 r of its residual r.

    The jacobian is that of the model's series by u, (n, d), `linear` measured minus model at u = 0 on the tangent, (n,).
    """
    root = noise.root(series)
    white = scipy.linalg.solve_triangular(
        root, np.column_stack([jacobian, linear]), lower=True, check_finite=False, overwrite_b=True
    )
    j, r = white[:, :-1], white[:, -1]
    return Information(precision=j.T @ j, projection=j.T @ r), float(np.log(np.diag(root)).sum()), float(r @ r)


def estimate_noise(
    series: Sequence[Series], noises: Sequence[Noise], jacobians: Sequence[Array], linear: Sequence[Array]
) -> list[Noise]:
    """Estimate the noise of every series by the likelihood with the unknowns integrated out.

    With the model linear about the fit, u standard normal before and K the covariance of a residual, the marginal likelihood is
    that of K + J J^T of all series together (Patterson and Thompson 1971: what a fit absorbs does not count as small noise).
    Arguments as those of `information`, of each series.
    """
    known = [information(*arguments)[0] for arguments in zip(series, noises, jacobians, linear, strict=True)]
    estimates = list(noises)
    for k, single in enumerate(series):
        other_series = [info for i, info in enumerate(known) if i != k]
        size = jacobians[k].shape[1]
        precision = np.eye(size) + sum((info.precision for info in other_series), np.zeros((size, size)))
        projection = sum((info.projection for info in other_series), np.zeros(size))
        estimates[k] = _most_likely(
            single, estimates[k], jacobians[k], linear[k], Information(precision=precision, projection=projection)
        )
        known[k] = information(single, estimates[k], jacobians[k], linear[k])[0]
    return estimates


def _most_likely(series: Series, start: Noise, jacobian: Array, linear: Array, from_others: Information) -> Noise:
    """Find the most likely noise of one series, given the information on the unknowns in all other series."""
    low, high = series.lengths
    ends = np.log([(LEAST_SIZE * series.rms, 10.0 * series.rms), (LEAST_SIZE, LARGEST_SIZE), (low, high)])
    bounds = np.vstack([ends, POWERS])

    def noise_of(x: Array) -> Noise:
        white, discrepancy, length = np.exp(x[:3]).tolist()
        return Noise(white=white, discrepancy=discrepancy, length=length, power=float(x[3]))

    def negative_log_likelihood(x: Array) -> float:
        known, determinant, square = information(series, noise_of(x), jacobian, linear)
        precision, projection = from_others.precision + known.precision, from_others.projection + known.projection
        root = scipy.linalg.cho_factor(precision, lower=True)
        explained = float(projection @ scipy.linalg.cho_solve(root, projection))
        return determinant + float(np.log(np.diag(root[0])).sum()) + 0.5 * (square - explained)

    begin = np.array([*np.log([start.white, start.discrepancy, start.length]), start.power])
    best = scipy.optimize.minimize(
        negative_log_likelihood, np.clip(begin, bounds[:, 0], bounds[:, 1]), method="L-BFGS-B", bounds=bounds,
        options={"maxiter": 25, "ftol": 1e-6},
    )  # fmt: skip
    return noise_of(best.x)


# Form in which a channel is compared: its history, the logarithm of its shock response spectrum (Q = 10) or of its amplitudes
Domain = Literal["time", "srs", "spectrum"]

DOMAINS: tuple[Domain, ...] = ("time", "srs", "spectrum")

PER_OCTAVE = 6  # frequencies of a spectrum in an octave
_LEAST = 1e-3  # amplitude over the largest below which a logarithm of an amplitude spectrum says nothing


@dataclass(frozen=True, kw_only=True)
class Spectral:
    """Spectrum of a channel's smoothed samples, as a series in logarithms."""

    domain: Domain  # "srs" or "spectrum"
    # instants of the samples [s], (n,); where some are left out they are bridged straight, measured and calculated
    # alike
    at: Array
    frequencies: Array  # [Hz], (n_f,)
    series: Series  # logarithm of the measured spectrum over that of frequency

    @classmethod
    def of(cls, history: Series, domain: Domain) -> "Spectral":
        """Make the spectrum of a measured channel.

        Raises:
            RecordError: it is no acceleration, of which a shock response spectrum is, or too short for a spectrum.
        """
        if domain == "srs" and history.unit != "m/s^2":
            raise RecordError(f"{history.name}: shock response spectra are of accelerations; compare it in time.")
        step, whole = float(np.diff(history.at).min()), float(np.ptp(history.at))
        low, high = 2.0 / whole, 0.1 / step
        count = int(PER_OCTAVE * np.log2(high / low)) + 1 if high > low else 0
        if count < 2 * PER_OCTAVE:
            raise RecordError(f"{history.name}: it is too short for a spectrum of two octaves; compare it in time.")
        frequencies = np.geomspace(low, high, count)
        values = _spectrum(domain, history.at, history.values, frequencies)
        series = Series(
            name=history.name, at=np.log(frequencies), values=values, size=np.ones(count), across="logarithm of frequency",
        )  # fmt: skip
        return cls(domain=domain, at=history.at, frequencies=frequencies, series=series)

    def of_samples(self, values: Array) -> Array:
        return _spectrum(self.domain, self.at, values, self.frequencies)


def _spectrum(domain: Domain, at: Array, values: Array, frequencies: Array) -> Array:
    """Return the logarithm of samples' SRS, or of their smoothed Fourier amplitudes, at frequencies [Hz], (n_f,)."""
    step = float(np.diff(at).min())
    time = at[0] + step * np.arange(round(float(np.ptp(at)) / step) + 1)
    even = np.interp(time, at, values)
    if domain == "srs":
        return np.asarray(np.log(shock_response_spectrum(time - time[0], even, frequencies).maximax))
    power = np.abs(np.fft.rfft(even - even.mean())) ** 2
    lines = np.fft.rfftfreq(even.size, step)
    octaves = np.log2(np.maximum(lines, 1e-9) / frequencies[:, np.newaxis])
    weights = np.exp(-0.5 * (octaves * PER_OCTAVE) ** 2) + 1e-300
    smooth = weights @ power / weights.sum(axis=1)
    return np.asarray(0.5 * np.log(smooth + _LEAST**2 * smooth.max()))
