"""Human exposure to vibration: weighted acceleration and doses of ISO 2631-1, habitability of ships of ISO 6954.

Both editions of ISO 6954, that of 1984 (peaks) and that of 2000 (weighted rms), give two values: below the lower one adverse
comments are not probable, above the upper one they are.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from wirerope_mj.assessment.criteria.verdict import Criterion, Verdict
from wirerope_mj.foundation.arguments import not_negative, one_of
from wirerope_mj.foundation.arrays import Array, ArrayLike, ComplexArray
from wirerope_mj.motions.spectra import power_spectral_density
from wirerope_mj.motions.spectra.ramp import check_samples

_RUNNING_WINDOW = 1.0  # time over which the running rms is taken [s] (ISO 2631-1, 6.3.1)
# Periods of a weighting's lower band limit by which a history is zero-padded: a filter of Q = 0.71 has rung out to 1e-5 then.
_PADDING = 3.0


@dataclass(frozen=True, kw_only=True)
class Weighting:
    """A frequency weighting of acceleration, as ISO 8041 defines it by analogue filters.

    H(p) = p^2 / (p^2 + r w1 p + w1^2)  w2^2 / (p^2 + r w2 p + w2^2)      r = sqrt(2), band limits
           (1 + p / w3) / (1 + p / (Q4 w4) + (p / w4)^2)                  from acceleration to velocity
           (w5 / w6)^2 (1 + p / (Q5 w5) + (p / w5)^2) / (1 + p / (Q6 w6) + (p / w6)^2)     upward step
    """

    # low, high: band limits f1, f2 [Hz]
    low: float
    high: float
    # f3, f4, q4: of the passage from acceleration to velocity [Hz]; f3 may be infinite
    f3: float
    f4: float
    q4: float
    step: tuple[float, ...] = ()  # f5 [Hz], Q5, f6 [Hz], Q6 of the upward step; empty without one

    def gain(self, frequency: ArrayLike) -> ComplexArray:
        """Evaluate H at frequencies [Hz], (...)."""
        p = 1j * np.asarray(frequency, dtype=np.complex128)
        root = math.sqrt(2.0)
        gain = p**2 / (p**2 + root * self.low * p + self.low**2) * self.high**2
        gain = gain / (p**2 + root * self.high * p + self.high**2)
        gain = gain * (1.0 + p / self.f3) / (1.0 + p / (self.q4 * self.f4) + (p / self.f4) ** 2)
        if self.step:
            f5, q5, f6, q6 = self.step
            up, down = ((1.0 + p / (q * f) + (p / f) ** 2) for f, q in ((f5, q5), (f6, q6)))
            gain = gain * (f5 / f6) ** 2 * up / down
        return gain


# Parameters of ISO 8041-1: Wk vertical, Wd horizontal, Wf motion sickness, Wm buildings and ships (ISO 2631-2, ISO 6954).
_KNEE = 1.0 / (2.0 * math.pi * 0.028)
WEIGHTINGS = {
    "Wk": Weighting(low=0.4, high=100.0, f3=12.5, f4=12.5, q4=0.63, step=(2.37, 0.91, 3.35, 0.91)),
    "Wd": Weighting(low=0.4, high=100.0, f3=2.0, f4=2.0, q4=0.63),
    "Wf": Weighting(low=0.08, high=0.63, f3=math.inf, f4=0.25, q4=0.86, step=(0.0625, 0.80, 0.10, 0.80)),
    "Wm": Weighting(low=10.0**-0.1, high=100.0, f3=_KNEE, f4=_KNEE, q4=0.5),
}


@dataclass(frozen=True, kw_only=True)
class Exposure:
    """Weighted vibration of a person at a point, along x, y and z of the world, z upwards."""

    rms: Array  # weighted rms acceleration [m/s^2], (3,): Wd horizontally, Wk vertically
    # running: NaN for a history shorter than 1 s
    running: Array  # largest running rms over 1 s, the maximum transient vibration value [m/s^2], (3,)
    peak: Array  # largest weighted acceleration [m/s^2], (3,)
    dose: Array  # fourth power vibration dose value [m/s^1.75], (3,)
    sickness: float  # motion sickness dose value MSDV of z, by Wf [m/s^1.5]
    duration: float  # length of the history without what is discarded [s]

    @property
    def total(self) -> float:
        """Vibration total value for comfort, the root of the sum of squares of rms [m/s^2]."""
        return float(np.linalg.norm(self.rms))

    @property
    def crest(self) -> Array:
        """Crest factor, peak over rms, (3,); NaN without motion. Above 9 the rms is not enough: use running rms and dose."""
        return np.divide(self.peak, self.rms, out=np.full(3, math.nan), where=self.rms > 1e-9 * self.total)


def exposure(time: ArrayLike, acceleration: ArrayLike, *, discard: float = 0.0) -> Exposure:
    """Evaluate a person's exposure to an acceleration by ISO 2631-1: rms, running rms, peak and dose values.

    Args:
        time: uniform instants [s], (n,).
        acceleration: along x, y and z [m/s^2], (n, 3), from rest.
        discard: length at the beginning that does not count [s]; the filters see it.

    Raises:
        ValueError: the samples are not as they must be, or nothing is left of them.
    """
    instants, values = np.asarray(time, dtype=np.float64), np.asarray(acceleration, dtype=np.float64)
    rate = 1.0 / check_samples(instants, values)[1]
    kept = instants.size - round(min(not_negative("discard", discard) * rate, instants.size))
    if kept < 2:
        raise ValueError(f"`discard` must leave something of the {instants[-1] - instants[0]:.6g} s, got {discard:.6g} s.")
    horizontal, vertical = (weighted(values[:, axes], rate, name) for axes, name in ((slice(2), "Wd"), (slice(2, 3), "Wk")))
    filtered = np.concatenate([horizontal, vertical], axis=1)[-kept:]
    sickness_filtered = weighted(values[:, 2:], rate, "Wf")[-kept:]
    energy = np.cumsum(np.vstack([np.zeros(3), filtered**2]), axis=0)
    window = round(_RUNNING_WINDOW * rate)
    long = window <= kept
    running = np.sqrt(np.max(energy[window:] - energy[:-window], axis=0) / window) if long else np.full(3, math.nan)
    return Exposure(
        rms=np.sqrt(energy[-1] / kept), running=running, peak=np.abs(filtered).max(axis=0),
        dose=(np.sum(filtered**4, axis=0) / rate) ** 0.25, sickness=math.sqrt(float(np.sum(sickness_filtered**2)) / rate),
        duration=kept / rate,
    )  # fmt: skip


def weighted(acceleration: Array, rate: float, weighting: str) -> Array:
    """Filter accelerations that start from rest [m/s^2], (n, k), sampled at `rate` [Hz], by one of `WEIGHTINGS`."""
    filters = WEIGHTINGS[weighting]
    size = acceleration.shape[0] + round(_PADDING / filters.low * rate)
    lines = np.fft.rfft(acceleration, n=size, axis=0)
    lines *= filters.gain(np.fft.rfftfreq(size, 1.0 / rate))[:, None]
    return np.fft.irfft(lines, n=size, axis=0)[: acceleration.shape[0]]


# Peak velocity from 5 to 100 Hz [m/s], and peak acceleration from 1 to 5 Hz [m/s^2].
PEAKS_1984 = {"lower": (4e-3, 0.126), "upper": (9e-3, 0.285)}
# Weighted rms velocity, lower and upper [m/s]: A passenger cabins, B crew accommodation, C working spaces.
RMS_2000 = {"A": (2e-3, 4e-3), "B": (3e-3, 6e-3), "C": (4e-3, 8e-3)}
_MEANING = {"lower": "adverse comments are not probable below", "upper": "adverse comments are probable above"}
_CORNER = 5.0  # frequency from which velocity counts, and not acceleration [Hz]
_RANGE_1984 = (1.0, 100.0)
_RANGE_2000 = (10.0**-0.05, 10.0**1.95)  # Outer edges of the third-octave bands of 1 and 80 Hz [Hz]: 0.891 and 89.1
# Lowest line, in resolutions: below it the integral's drift contaminates a line, the filter of `velocity_lines` ending at six.
_LOWEST_LINE = 5.75
_RESOLUTION_2000 = 0.25  # of the density that is weighted [Hz]: a quarter of the lowest frequency that counts
_TRANSITION = 0.028  # weighted acceleration times this is weighted velocity [s]
_HOPS = 32  # Windows that start within the length of one: an amplitude through the filter is followed within 2 %


def iso_6954_1984(frequency: ArrayLike, velocity: ArrayLike, *, subject: str) -> tuple[Verdict, ...]:
    """Judge the lines of a spectrum by ISO 6954:1984: the worst line against the lower and upper limit.

    Args:
        frequency: of the lines [Hz]; those outside 1 to 100 Hz do not count.
        velocity: their peak velocities [m/s]. The standard means the largest that repeat in the record, not an average
            over it; see `velocity_lines`.
        subject: what is judged.

    Raises:
        ValueError: lines are not as they must be, or none lies between 1 and 100 Hz.
    """
    f, v = (np.atleast_1d(np.asarray(values, dtype=np.float64)) for values in (frequency, velocity))
    if f.ndim != 1 or f.shape != v.shape or not f.size:
        raise ValueError(f"`frequency` and `velocity` must be rows of the same length, got the shapes {f.shape} and {v.shape}.")
    if not (np.isfinite(f).all() and np.isfinite(v).all() and f.min() > 0.0 and v.min() >= 0.0):
        raise ValueError("`frequency` must be finite and > 0 Hz and `velocity` finite and >= 0.")
    low, high = _RANGE_1984
    inside = (f >= low) & (f <= high)
    if not inside.any():
        raise ValueError(f"`frequency` must hold a line from {low:.3g} to {high:.3g} Hz, got {f.min():.6g} to {f.max():.6g}.")
    f, v = f[inside], v[inside]
    verdicts = []
    for name, (plateau, acceleration) in PEAKS_1984.items():
        allowed = np.where(f < _CORNER, acceleration / (2.0 * math.pi * f), plateau)
        worst = int((v / allowed).argmax())
        verdicts.append(Verdict(
            criterion=Criterion(f"ISO 6954:1984 {name}"), subject=subject, value=float(v[worst]), limit=float(allowed[worst]),
            unit="m/s", note=f"peak velocity at {f[worst]:.4g} Hz, taken as the largest that repeats; {_MEANING[name]}",
        ))  # fmt: skip
    return tuple(verdicts)


def iso_6954_2000(
    time: ArrayLike, acceleration: ArrayLike, *, subject: str, space: Literal["A", "B", "C"], discard: float = 0.0
) -> tuple[Verdict, ...]:
    """Judge a history by ISO 6954:2000: the overall weighted rms velocity from 1 to 80 Hz.

    What counts are the third-octave bands of 1 to 80 Hz, from 0.891 to 89.1 Hz, with sharp edges.

    Args:
        time: uniform instants [s], (n,).
        acceleration: [m/s^2], (n,).
        subject: what is judged.
        space: "A" passenger cabins, "B" crew accommodation, "C" working spaces.
        discard: length at the beginning that is left out [s]: until the response has settled.

    Raises:
        ValueError: the samples are not as they must be, or too short, or there is no such space.
    """
    one_of("space", space, RMS_2000)
    density = power_spectral_density(time, acceleration, discard=discard, resolution=_RESOLUTION_2000)
    half = 0.5 * density.resolution  # a line stands for this much on either side of it
    low, high = _RANGE_2000
    widths = np.minimum(density.frequency + half, high) - np.maximum(density.frequency - half, low)
    weighted = np.abs(WEIGHTINGS["Wm"].gain(density.frequency)) ** 2 * density.density * np.clip(widths, 0.0, None)
    return tuple(
        Verdict(
            criterion=Criterion(f"ISO 6954:2000 {space} {name}"), subject=subject, limit=limit, unit="m/s",
            value=_TRANSITION * math.sqrt(float(np.sum(weighted))),
            note=f"weighted rms velocity from 1 to 80 Hz; {_MEANING[name]}",
        )
        for name, limit in zip(("lower", "upper"), RMS_2000[space], strict=True)
    )  # fmt: skip


def velocity_lines(
    time: ArrayLike, acceleration: ArrayLike, *, discard: float = 0.0, resolution: float = 0.25
) -> tuple[Array, Array]:
    """Find frequencies [Hz] and the largest peak velocities [m/s] of the lines of an acceleration, for `iso_6954_1984`.

    ISO 6954:1984 asks for the largest value that repeats. Here the integrated history passes a filter about each line, its
    amplitude is followed through the record, and the largest counts, whether it repeats or not: that is on the safe side.
    The filter (Kaiser window, one over the resolution long) is flat within two resolutions of the line and ends at six. A
    steady sine has its amplitude within 0.1 %, and one whose amplitude changes has the largest as long as it changes no
    faster than two resolutions: at 0.25 Hz, twice a second. Faster beats are lines of their own, and a coarser resolution
    takes them together; lines less than four resolutions apart count as one that beats.

    Only the highest frequency within two resolutions of the Hann spectrum has this amplitude; those beside it have the Hann
    window's, so that a line keeps its frequency. A line shows in several frequencies, and they must not be added up.

    Random vibration has no lines: its result grows with the root of the resolution, and slowly with the length of the
    record. Lines below six resolutions cannot be told from the drift of the integral and are left out.

    Args:
        time: uniform instants [s], (n,).
        acceleration: [m/s^2], (n,).
        discard: length at the beginning that is left out [s]: until the response has settled.
        resolution: distance of the lines [Hz].

    Raises:
        ValueError: the samples are not as they must be, or too short.
    """
    checked = power_spectral_density(time, acceleration, discard=discard, resolution=resolution)
    instants, values = np.asarray(time, dtype=np.float64), np.asarray(acceleration, dtype=np.float64)
    rate = (instants.size - 1) / float(instants[-1] - instants[0])
    size, kept = round(rate / checked.resolution), round(checked.duration * rate)
    velocity = scipy.integrate.cumulative_trapezoid(
        scipy.signal.detrend(values[-kept:], type="constant"), dx=1.0 / rate, initial=0.0
    )
    frequency = np.arange(size // 2 + 1) * rate / size
    shown = (frequency > _LOWEST_LINE * checked.resolution) & (frequency < 0.45 * rate)
    if not shown.any():
        raise ValueError(
            f"`resolution` must leave a line between six resolutions and 0.45 of the sampling rate: less than "
            f"{0.45 * rate / _LOWEST_LINE:.6g} Hz, got {resolution:.6g}."
        )
    # Cut off, at half, four resolutions from the line; 6 lets 0.07 % through beyond the sixth.
    window = scipy.signal.firwin(size, 4.0 / size, window=("kaiser", 6.0), fs=1.0)
    hann = scipy.signal.windows.hann(size, sym=False)
    windows, peaks = np.stack([window, hann / hann.sum()]), np.zeros((2, frequency.size))
    for first in range(0, velocity.size - size + 1, max(size // _HOPS, 1)):
        segment = scipy.signal.detrend(velocity[first : first + size])
        np.maximum(peaks, 2.0 * np.abs(np.fft.rfft(windows * segment)), out=peaks)
    largest: Array = np.where(peaks[1] == scipy.ndimage.maximum_filter1d(peaks[1], 5), peaks[0], peaks[1])[shown]
    # The trapezoidal rule integrates a sine to (w T / 2) / tan(w T / 2) of its integral.
    half = math.pi * frequency[shown] / rate
    return frequency[shown], largest * np.tan(half) / half
