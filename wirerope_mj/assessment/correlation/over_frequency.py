"""A computed history against a measured one over frequency: ratios of spectra, coherence, response functions."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from wirerope_mj.assessment.correlation.pairs import Pair
from wirerope_mj.foundation.arrays import Array, ComplexArray
from wirerope_mj.motions.spectra import power_spectral_density, shock_response_spectrum
from wirerope_mj.motions.spectra.ramp import octave_grid
from wirerope_mj.motions.spectra.srs import SAMPLES_PER_PERIOD

Q = 10.0  # amplification at resonance of the oscillators of shock response spectra
THREE_DB = 10.0 ** (3.0 / 20.0)  # ratio of amplitudes

_PERIODS = 2.0  # least periods of a frequency within the interval
_LINES = 12  # frequencies of a shock response spectrum to an octave
_HIGHEST = 0.4  # highest frequency over the sampling rate: the resampling filter passes it
_DECAYED = 0.3  # rms of the last quarter over that of the whole, below which a history is a transient
_POWER = 1e-3  # fraction of the largest density below which a density is noise
_DRIVEN = 1e-2  # fraction of the base's largest density below which the base does not drive: it is noise in tests
_PER_OCTAVE = 6  # bands to an octave over which densities are averaged
_SEGMENTS = 8  # least segments of a coherence: that of a single segment is always 1
_LEAST_RATIO = 1e-3  # least ratio that is reported, -60 dB: that of a model at rest has no logarithm
_NOTABLE = 0.1  # least deviation of a ratio that is reported


@dataclass(frozen=True, kw_only=True, eq=False)
class Band:
    """Frequencies between which the model is low or high."""

    # first, last: [Hz]
    first: float
    last: float
    deviation: float  # mean of model over measurement, less 1
    weight: float  # size of the deviation, see `SpectrumRatio.bands`


@dataclass(frozen=True, kw_only=True, eq=False)
class SpectrumRatio:
    """Two spectra of amplitudes, and their ratio."""

    kind: str  # "SRS" or "PSD"
    frequency: Array = field(repr=False)  # [Hz], (n_f,), at equal ratios
    # measured, model: largest accelerations, or roots of densities, (n_f,)
    measured: Array = field(repr=False)
    model: Array = field(repr=False)

    @property
    def ratio(self) -> Array:
        """Model over measurement, (n_f,), no less than -60 dB."""
        return np.maximum(self.model / self.measured, _LEAST_RATIO)

    @property
    def within_3db(self) -> float:
        """Part of the octaves in which the model lies within 3 dB of the measurement, 0 to 1."""
        return float(np.mean((self.ratio <= THREE_DB) & (self.ratio >= 1.0 / THREE_DB)))

    @cached_property
    def bands(self) -> tuple[Band, ...]:
        """Bands in which the model is more than a tenth low or high, by falling weight.

        The weight is the sum of |log ratio| times the measured amplitude over the largest, so that a deviation counts where
        amplitudes are large. A band of densities reaches to the edges of its outermost averages.
        """
        beyond = 2.0 ** (0.5 / _PER_OCTAVE) if self.kind == "PSD" else 1.0
        signs = np.sign(self.ratio - 1.0) * (np.abs(self.ratio - 1.0) > _NOTABLE)
        edges = np.flatnonzero(np.diff(signs)) + 1
        bands = []
        for rows in np.split(np.arange(signs.size), edges):
            if signs[rows[0]]:
                size = self.measured[rows] / self.measured.max()
                weight = float(np.sum(np.abs(np.log(self.ratio[rows])) * size)) / signs.size
                mean = float(np.sum(self.model[rows])) / float(np.sum(self.measured[rows]))
                first, last = float(self.frequency[rows[0]]) / beyond, float(self.frequency[rows[-1]]) * beyond
                bands.append(Band(first=first, last=last, deviation=mean - 1.0, weight=weight))
        return tuple(sorted(bands, key=lambda band: -band.weight))


def is_transient(values: Array) -> bool:
    """Check whether a history (n,) has decayed in its last quarter, or has too few cycles for averages."""
    centred = values - values.mean()
    cycles = int(np.abs(np.fft.rfft(centred)).argmax())
    decayed = float(centred[-(centred.size // 4) :].std()) < _DECAYED * float(centred.std())
    return decayed or cycles < _PERIODS * _SEGMENTS


def shock_ratio(pair: Pair) -> SpectrumRatio | None:
    """Compute the shock response spectra (maximax, Q = 10) of two transient accelerations; None for other histories."""
    if pair.channel.quantity != "acceleration" or not np.ptp(pair.measured) or not is_transient(pair.measured):
        return None
    lowest, highest = _frequency_range(pair)
    highest = min(highest, pair.rate / SAMPLES_PER_PERIOD)
    if highest < 2.0 * lowest:
        return None
    frequency = octave_grid(lowest, highest, per_octave=_LINES)
    both = shock_response_spectrum(pair.time, np.column_stack([pair.measured, pair.model]), frequency, q=Q).maximax
    return SpectrumRatio(kind="SRS", frequency=frequency, measured=both[:, 0], model=both[:, 1])


def density_ratio(pair: Pair) -> SpectrumRatio | None:
    """Compute the roots of the power spectral densities in bands of a sixth of an octave that are above the noise.

    A transient is taken as one segment without a window, else by Welch's method; None where fewer than three bands are left.
    """
    lowest, highest = _frequency_range(pair)
    if highest < 2.0 * lowest:
        return None
    both = np.column_stack([pair.measured, pair.model])
    if is_transient(pair.measured):
        densities = np.abs(np.fft.rfft(both - both.mean(axis=0), axis=0)) ** 2
        frequency = np.asarray(np.fft.rfftfreq(pair.time.size, 1.0 / pair.rate), dtype=np.float64)
    else:
        density = power_spectral_density(pair.time, both)
        frequency, densities = density.frequency, density.density
    edges = octave_grid(lowest, highest, per_octave=_PER_OCTAVE)
    numbers = np.digitize(frequency, edges)
    centres, means = [], []
    for number in range(1, edges.size):
        inside = numbers == number
        if inside.any():
            centres.append(float(np.sqrt(edges[number - 1] * edges[number])))
            means.append(densities[inside].mean(axis=0))
    values = np.array(means).reshape(-1, 2)
    kept = values[:, 0] > _POWER * values[:, 0].max(initial=0.0)
    if np.count_nonzero(kept) < 3:
        return None
    roots = np.sqrt(values[kept])
    return SpectrumRatio(kind="PSD", frequency=np.array(centres)[kept], measured=roots[:, 0], model=roots[:, 1])


def coherence(pair: Pair) -> float | None:
    """Average the coherence of model and measurement, weighted by the measured density; None for too short a history.

    The coherence |S_mc|^2 / (S_mm S_cc) of Welch's method with 15 segments (Bendat and Piersol, Random Data, 4th ed.,
    section 5.2): 1 where one is a linear filter of the other.
    """
    from scipy.signal import csd

    size = 2 * pair.time.size // 16
    if size < 8 * _SEGMENTS:
        return None
    m, c = (values - values.mean() for values in (pair.measured, pair.model))
    cross, auto_m, auto_c = (csd(a, b, fs=pair.rate, nperseg=size)[1][1:] for a, b in ((m, c), (m, m), (c, c)))
    product = auto_m.real * auto_c.real
    if not product.any():
        return None
    squared = np.abs(cross) ** 2 / np.where(product > 0.0, product, np.inf)
    return float(np.average(squared, weights=auto_m.real))


@dataclass(frozen=True, kw_only=True, eq=False)
class Transmissibility:
    """Ratio of a channel's acceleration to the base's along the same axis, measured and computed."""

    frequency: Array = field(repr=False)  # [Hz], (n_f,), where the measured base moves
    # measured, model: complex, (n_f,)
    measured: ComplexArray = field(repr=False)
    model: ComplexArray = field(repr=False)

    @property
    def frac(self) -> float:
        return assurance(self.measured, self.model)


def transmissibility(base: Pair, pair: Pair) -> Transmissibility | None:
    """Estimate the transfer function H1 = S_xy / S_xx from the base x to a channel y, measured and computed.

    A transient is one segment. None where the two do not share their instants, or fewer than eight lines are left.
    """
    from scipy.signal import csd

    if base.time.size != pair.time.size or pair.channel.quantity != "acceleration":
        return None
    size = pair.time.size if is_transient(pair.measured) else 2 * pair.time.size // 16
    window = "boxcar" if size == pair.time.size else "hann"
    functions, inputs = [], []
    for drive, response in ((base.measured, pair.measured), (base.model, pair.model)):
        frequency, cross = csd(drive, response, fs=pair.rate, nperseg=size, window=window, detrend=False)
        _, power = csd(drive, drive, fs=pair.rate, nperseg=size, window=window, detrend=False)
        inputs.append(power.real)
        functions.append(cross / np.where(power.real > 0.0, power.real, np.inf))
    lowest, highest = _frequency_range(pair)
    kept = (frequency >= lowest) & (frequency <= highest) & (inputs[0] > _DRIVEN * inputs[0].max())
    if np.count_nonzero(kept) < 8:
        return None
    return Transmissibility(frequency=frequency[kept], measured=functions[0][kept], model=functions[1][kept])


def spectral_assurance(pair: Pair) -> float:
    """Evaluate the assurance criterion of the Fourier spectra of both histories, for a test without a measured base."""
    measured, model = (np.fft.rfft(values - values.mean()) for values in (pair.measured, pair.model))
    kept = np.fft.rfftfreq(pair.time.size, 1.0 / pair.rate) <= _HIGHEST * pair.rate
    return assurance(measured[kept], model[kept])


def assurance(measured: ComplexArray, model: ComplexArray) -> float:
    """Compare functions of frequency by the assurance criterion FRAC: 1 if they differ by a factor only, 0 if orthogonal.

    |sum H_m conj(H_c)|^2 / (sum |H_m|^2 sum |H_c|^2), H_m measured, H_c computed: Heylen and Lammens, ISMA 21 (1996) 17.
    """
    size = float(np.sum(np.abs(measured) ** 2) * np.sum(np.abs(model) ** 2))
    return float(np.abs(np.vdot(measured, model)) ** 2 / size) if size else 0.0


def _frequency_range(pair: Pair) -> tuple[float, float]:
    """Find the lowest and highest frequency that an interval and its sampling rate resolve [Hz]."""
    return _PERIODS / float(pair.time[-1] - pair.time[0]), _HIGHEST * pair.rate
