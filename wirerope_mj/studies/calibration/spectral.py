"""Channels compared by their shock response or amplitude spectra instead of in time: what phases and delays do not spoil."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions.spectra.srs import shock_response_spectrum
from wirerope_mj.studies.calibration.noise import Series

# What of a channel is compared: its history, the logarithm of its shock response spectrum (Q = 10) or of its amplitudes
Domain = Literal["time", "srs", "spectrum"]

DOMAINS: tuple[Domain, ...] = ("time", "srs", "spectrum")

PER_OCTAVE = 6  # frequencies of a spectrum in an octave
_LEAST = 1e-3  # amplitude over the largest below which a logarithm of an amplitude spectrum says nothing


@dataclass(frozen=True, kw_only=True)
class Spectral:
    """A spectrum of a channel's smoothed samples."""

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
        """Return the series of smoothed samples at the same instants."""
        return _spectrum(self.domain, self.at, values, self.frequencies)


def _spectrum(domain: Domain, at: Array, values: Array, frequencies: Array) -> Array:
    """Return the logarithm of a spectrum at frequencies [Hz], (n_f,)."""
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
