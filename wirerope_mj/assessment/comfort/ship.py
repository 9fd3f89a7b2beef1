"""Vibration of ships with regard to people: ISO 6954 of 1984 (peaks) and of 2000 (weighted rms).

Both give two values: below the lower one adverse comments are not probable, above the upper one they are.
"""

import math
from typing import Literal

import numpy as np
import scipy

from wirerope_mj.assessment.comfort.people import WEIGHTINGS
from wirerope_mj.assessment.criteria.verdict import Criterion, Verdict
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.motions.spectra import power_spectral_density

# Peak velocity from 5 to 100 Hz [m/s], and peak acceleration from 1 to 5 Hz [m/s^2].
PEAKS_1984 = {"lower": (4e-3, 0.126), "upper": (9e-3, 0.285)}
# Weighted rms velocity, lower and upper [m/s]: A passenger cabins, B crew accommodation, C working spaces.
RMS_2000 = {"A": (2e-3, 4e-3), "B": (3e-3, 6e-3), "C": (4e-3, 8e-3)}
_MEANING = {"lower": "adverse comments are not probable below", "upper": "adverse comments are probable above"}
_KNEE = 5.0
_RANGE_1984 = (1.0, 100.0)
_RANGE_2000 = (10.0**-0.05, 10.0**1.95)  # Outer edges of the third-octave bands of 1 and 80 Hz [Hz]: 0.891 and 89.1
# Resolutions below which the drift of the integral shows in a line: the filter of `velocity_lines` ends at six.
_LEAST_SHOWN = 5.75
_TRANSITION = 0.028  # weighted acceleration times this is weighted velocity [s]
_HOPS = 32  # Windows begun in the length of one: what passes the filter, four resolutions, is followed within 2 %


def iso_6954_1984(frequency: ArrayLike, velocity: ArrayLike, *, subject: str) -> tuple[Verdict, ...]:
    """Return the verdicts of ISO 6954:1984 on the lines of a spectrum: the worst line against the lower and upper limit.

    Args:
        frequency: of the lines [Hz]; those outside 1 to 100 Hz do not count.
        velocity: their peak velocities [m/s]. The standard means the largest that repeat in the record, not an average
            over it; see `velocity_lines`.
        subject: what is judged.

    Raises:
        ValueError: lines are not as they must be, or none lies between 1 and 100 Hz.
    """
    f, v = _lines_within(frequency, velocity, *_RANGE_1984)
    verdicts = []
    for name, (plateau, acceleration) in PEAKS_1984.items():
        allowed = np.where(f < _KNEE, acceleration / (2.0 * math.pi * f), plateau)
        worst = int((v / allowed).argmax())
        verdicts.append(Verdict(
            criterion=Criterion(f"ISO 6954:1984 {name}"), subject=subject, value=float(v[worst]), limit=float(allowed[worst]),
            unit="m/s", note=f"peak velocity at {f[worst]:.4g} Hz, taken as the largest that repeats; {_MEANING[name]}",
        ))  # fmt: skip
    return tuple(verdicts)


def iso_6954_2000(
    frequency: ArrayLike, velocity: ArrayLike, *, subject: str, space: Literal["A", "B", "C"]
) -> tuple[Verdict, ...]:
    """Return the verdicts of ISO 6954:2000 on the lines of a spectrum: the overall weighted rms velocity.

    Args:
        frequency: of the lines [Hz]; those outside the third-octave bands of 1 to 80 Hz, 0.891 to 89.1 Hz, do not count.
        velocity: their peak velocities [m/s].
        subject: what is judged.
        space: "A" passenger cabins, "B" crew accommodation, "C" working spaces.

    Raises:
        ValueError: lines or space are not as they must be, or no line lies in these bands.
    """
    f, v = _lines_within(frequency, velocity, *_RANGE_2000)
    factors = np.abs(WEIGHTINGS["Wm"].gain(f)) * 2.0 * math.pi * f * _TRANSITION
    return _overall(math.sqrt(0.5 * float(np.sum((factors * v) ** 2))), subject, space)


def iso_6954_2000_of_history(
    time: ArrayLike, acceleration: ArrayLike, *, subject: str, space: Literal["A", "B", "C"],
    discard: float = 0.0, resolution: float = 0.25,
) -> tuple[Verdict, ...]:  # fmt: skip
    """Return the verdicts of ISO 6954:2000 on a history: the overall weighted rms velocity from 1 to 80 Hz.

    What counts are the third-octave bands of 1 to 80 Hz, from 0.891 to 89.1 Hz, with sharp edges.

    Args:
        time: uniform instants [s], (n,).
        acceleration: [m/s^2], (n,).
        subject: what is judged.
        space: "A" passenger cabins, "B" crew accommodation, "C" working spaces.
        discard: length at the beginning that is left out [s]: until the response has settled.
        resolution: of the density that is weighted [Hz]; a quarter of the lowest frequency that counts.

    Raises:
        ValueError: the samples are not as they must be, or too short, or there is no such space.
    """
    density = power_spectral_density(time, acceleration, discard=discard, resolution=resolution)
    half = 0.5 * density.resolution  # a line stands for this much on either side of it
    low, high = _RANGE_2000
    widths = np.minimum(density.frequency + half, high) - np.maximum(density.frequency - half, low)
    weighted = np.abs(WEIGHTINGS["Wm"].gain(density.frequency)) ** 2 * density.density * np.clip(widths, 0.0, None)
    return _overall(_TRANSITION * math.sqrt(float(np.sum(weighted))), subject, space)


def velocity_lines(
    time: ArrayLike, acceleration: ArrayLike, *, discard: float = 0.0, resolution: float = 0.25
) -> tuple[Array, Array]:
    """Return frequencies [Hz] and the largest peak velocities [m/s] of the lines of an acceleration, for `iso_6954_1984`.

    ISO 6954:1984 asks for the largest value that repeats. Here the integrated history passes a filter about each line, its
    amplitude is followed through the record, and the largest counts, whether it repeats or not: that is on the safe side.
    The filter (Kaiser window, one over the resolution long) is flat within two resolutions of the line and ends at six. A
    steady sine has its amplitude within 0.1 %, and one whose amplitude changes has the largest as long as it changes no
    faster than two resolutions: at 0.25 Hz, twice a second. Faster beats are lines of their own, and a coarser resolution
    takes them together; lines less than four resolutions apart count as one that beats.

    Only what is the highest within two resolutions through a Hann window has this amplitude; beside it stands what that
    window shows, so that a line keeps its frequency. A line shows in several frequencies, and they must not be added up.

    Random vibration has no lines: what comes out for it grows with the root of the resolution, and slowly with the length
    of the record. What lies below six resolutions cannot be told from the drift of the integral and is left out.

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
    shown = (frequency > _LEAST_SHOWN * checked.resolution) & (frequency < 0.45 * rate)
    if not shown.any():
        raise ValueError(
            f"`resolution` must leave a line between six resolutions and 0.45 of the sampling rate: less than "
            f"{0.45 * rate / _LEAST_SHOWN:.6g} Hz, got {resolution:.6g}."
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


def _overall(velocity: float, subject: str, space: str) -> tuple[Verdict, ...]:
    """Return the verdicts on a weighted rms velocity [m/s]."""
    one_of("space", space, RMS_2000)
    return tuple(
        Verdict(
            criterion=Criterion(f"ISO 6954:2000 {space} {name}"), subject=subject, value=velocity, limit=limit, unit="m/s",
            note=f"weighted rms velocity from 1 to 80 Hz; {_MEANING[name]}",
        )
        for name, limit in zip(("lower", "upper"), RMS_2000[space], strict=True)
    )  # fmt: skip


def _lines_within(frequency: ArrayLike, velocity: ArrayLike, low: float, high: float) -> tuple[Array, Array]:
    """Return the lines from `low` to `high` [Hz], frequencies and velocities [m/s], in any order; refuse what are none."""
    f, v = np.atleast_1d(np.asarray(frequency, dtype=np.float64)), np.atleast_1d(np.asarray(velocity, dtype=np.float64))
    if f.ndim != 1 or f.shape != v.shape or not f.size:
        raise ValueError(f"`frequency` and `velocity` must be rows of the same length, got the shapes {f.shape} and {v.shape}.")
    if not (np.isfinite(f).all() and np.isfinite(v).all() and f.min() > 0.0 and v.min() >= 0.0):
        raise ValueError("`frequency` must be finite and > 0 Hz and `velocity` finite and >= 0.")
    inside = (f >= low) & (f <= high)
    if not inside.any():
        raise ValueError(f"`frequency` must hold a line from {low:.3g} to {high:.3g} Hz, got {f.min():.6g} to {f.max():.6g}.")
    return f[inside], v[inside]
