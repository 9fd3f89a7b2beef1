"""Power spectral densities of random vibration, with their statistical uncertainty."""

import math
from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import not_negative, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.summary import Summarised, quantity
from wirerope_mj.motions.spectra.ramp import check_samples

# half-overlapping segments by default: 28 degrees of freedom, a density within about 27 % (one standard error)
SEGMENTS = 15
# statistical bandwidth of a line seen through a Hann window, in resolutions: 1 / (2 int rho^2) with rho the window's
# autocorrelation over lags of 0 to 1 segment
WINDOW_BANDWIDTH = 2.079
# exponent with which the bandwidths of a resonance and of the window add up: within 7 % from a resolution on
BLUR = 1.25
# samples a segment must have: fewer leave a window with hardly a frequency between its main lobe and half the rate
LEAST_SAMPLES = 8


@dataclass(frozen=True, kw_only=True, repr=False)
class PowerSpectralDensity(Summarised):
    """Mean square per frequency of a stationary acceleration, one-sided, (n_f,), or (n_f, k) for k of them side by side."""

    frequency: Array  #: [Hz], (n_f,), evenly spaced from 0
    density: Array  #: [(m/s^2)^2/Hz]
    resolution: float  #: distance of the frequencies, one over the length of a segment [Hz]
    duration: float  #: length of the record after what was discarded [s]
    segments: int  #: number of half-overlapping segments that were averaged
    #: of the chi-squared distribution that every density has about its true value: 2 for each segment, less what their
    #: overlap shares
    degrees_of_freedom: float

    def _summary(self) -> tuple[str, dict[str, str]]:
        rms = ", ".join(quantity(float(value), "m/s^2") for value in np.atleast_1d(self.rms))
        return "PowerSpectralDensity", {
            "frequencies": f"0 to {self.frequency[-1]:.4g} Hz, {self.resolution:.4g} Hz apart",
            "rms": rms,
            "segments": f"{self.segments} of {self.duration:.4g} s",
            "standard error": f"{100.0 * self.standard_error:.3g} % of each density",
        }

    @property
    def standard_error(self) -> float:
        """Relative standard error of a density, sqrt(2 / degrees of freedom)."""
        return math.sqrt(2.0 / self.degrees_of_freedom)

    @property
    def rms(self) -> Array:
        """Root of the mean square about the mean [m/s^2], (), or (k,)."""
        return self.rms_between(0.0, math.inf)

    def rms_between(self, low: float, high: float) -> Array:
        """Return the root mean square of the frequencies from `low` to `high` [Hz] as [m/s^2], (), or (k,).

        A line stands for the width of one resolution about it; of a line that is cut only the part inside counts.
        """
        if not 0.0 <= low < high:
            raise ValueError(f"`low` and `high` must be 0 <= low < high, got {low!r} and {high!r}.")
        half = 0.5 * self.resolution
        widths = np.minimum(self.frequency + half, high) - np.maximum(self.frequency - half, low)
        return np.sqrt(np.tensordot(np.clip(widths, 0.0, self.resolution), self.density, axes=(0, 0)))

    @property
    def bandwidth(self) -> Array:
        """Statistical bandwidth [Hz], (), or (k,): (integral of the density)^2 over the integral of its square.

        A band of this width with a constant density would have a mean square as uncertain as this one. The scatter of the
        densities, which enlarges the mean of their squares by 1 + 2 / degrees of freedom, is taken out, and so is what the
        window widens: with w that of a line, b^BLUR = seen^BLUR - w^BLUR. Never less than 1 / duration, at which the mean
        square has two degrees of freedom: what is narrower cannot be told from a sine.
        """
        square = self.resolution * np.sum(self.density**2, axis=0) / (1.0 + 2.0 / self.degrees_of_freedom)
        with np.errstate(invalid="ignore"):
            seen = (self.resolution * np.sum(self.density, axis=0)) ** 2 / square
        blur = np.clip(seen**BLUR - (WINDOW_BANDWIDTH * self.resolution) ** BLUR, 0.0, None)
        return np.maximum(blur ** (1.0 / BLUR), 1.0 / self.duration)

    @property
    def settling(self) -> Array:
        """Time in which a response of this bandwidth forgets its start [s], (), or (k,): 3 / bandwidth.

        An oscillator's bandwidth is 2 pi damping frequency, with which its free vibration decays; after this time its mean
        square lacks exp(-6) = 0.25 %. Of several resonances the one that dominates counts.
        """
        return 3.0 / self.bandwidth

    @property
    def rms_error(self) -> Array:
        """Relative standard error of the root mean square, 1 / (2 sqrt(bandwidth duration)), (), or (k,)."""
        return 0.5 / np.sqrt(self.bandwidth * self.duration)


def power_spectral_density(
    time: ArrayLike, acceleration: ArrayLike, *, discard: float = 0.0, resolution: float | None = None
) -> PowerSpectralDensity:
    """Return the one-sided power spectral density by Welch's method: Hann windows that overlap by half, means removed.

    Args:
        time: uniform instants [s], (n,).
        acceleration: [m/s^2], (n,), or (n, k) for k of them, each by itself.
        discard: length at the beginning that is left out [s]: until the response has settled.
        resolution: distance of the frequencies [Hz]: finer tells narrow peaks apart, coarser is more certain. Without it,
            that of 15 segments.

    Raises:
        ValueError: the samples are not uniform or not finite, or what is left is too short for the resolution.
    """
    values, step = check_samples(time, acceleration)
    discard = not_negative("discard", discard, unit="s")
    length = step * values.shape[0]
    kept = values[min(math.ceil(discard / step - 1e-9), values.shape[0]) :]
    left = step * kept.shape[0]
    size = _segment(kept.shape[0], step, resolution)
    if size < LEAST_SAMPLES or size > kept.shape[0]:
        wanted = "" if resolution is None else f" at {resolution:.6g} Hz"
        least = LEAST_SAMPLES * step if resolution is None else max(1.0 / resolution, LEAST_SAMPLES * step)
        if size < LEAST_SAMPLES and resolution is not None and size <= kept.shape[0]:
            raise ValueError(
                f"`resolution` must leave at least {LEAST_SAMPLES} samples to a segment: at most "
                f"{1.0 / (LEAST_SAMPLES * step):.6g} Hz, got {resolution:.6g}."
            )
        raise ValueError(
            f"`time` is too short for a density{wanted}: of {length:.6g} s the first {discard:.6g} s do not count; at least "
            f"{discard + least:.6g} s are needed, several times that beyond the first to be certain of anything."
        )
    window = scipy.signal.windows.hann(size, sym=False)
    hop = size - size // 2
    segments = (kept.shape[0] - size) // hop + 1
    frequency, density = scipy.signal.welch(
        kept, fs=1.0 / step, window=window, noverlap=size // 2, detrend="constant", scaling="density", axis=0
    )
    return PowerSpectralDensity(
        frequency=frequency, density=density, resolution=1.0 / (size * step), duration=left, segments=segments,
        degrees_of_freedom=_degrees(window, hop, segments),
    )  # fmt: skip


def _segment(samples: int, step: float, resolution: float | None) -> int:
    """Return the samples of a segment."""
    if resolution is None:
        return int(2 * samples // (SEGMENTS + 1))
    return round(1.0 / (positive("resolution", resolution, unit="Hz") * step))


def _degrees(window: Array, hop: int, segments: int) -> float:
    """Return the degrees of freedom of the mean of overlapping segments (Welch 1967, Percival and Walden 1993 section 6.17).

    Two segments h apart are correlated by r = (sum w[t] w[t + h])^2 / (sum w^2)^2, and the mean of K of them has
    2 K / (1 + 2 sum (1 - j / K) r_j) degrees of freedom; for half-overlapping Hann windows only r_1 = 1/36 counts.
    """
    shared = float(window[hop:] @ window[: window.size - hop]) / float(window @ window)
    return 2.0 * segments / (1.0 + 2.0 * (1.0 - 1.0 / segments) * shared**2)
