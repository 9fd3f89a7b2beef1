"""Vibration of ships with regard to people: ISO 6954 of 1984 (peaks) and of 2000 (weighted rms).

Both give two values: below the lower one adverse comments are not probable, above the upper one they are.
"""

import math
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import signal
from scipy.integrate import cumulative_trapezoid

from wirerope_mj.criteria.verdict import Verdict
from wirerope_mj.spectra import power_spectral_density

Array = npt.NDArray[np.float64]

PEAKS_1984 = {"lower": (4e-3, 0.126), "upper": (9e-3, 0.285)}
"""Peak velocity from 5 to 100 Hz [m/s], and peak acceleration from 1 to 5 Hz [m/s^2]."""

RMS_2000 = {"A": (2e-3, 4e-3), "B": (3e-3, 6e-3), "C": (4e-3, 8e-3)}
"""Weighted rms velocity, lower and upper [m/s]: A passenger cabins, B crew accommodation, C working spaces."""

_WORDS = {"lower": "adverse comments are not probable below", "upper": "adverse comments are probable above"}
_KNEE = 5.0
_RANGE_1984 = (1.0, 100.0)


def weighting(frequency: npt.ArrayLike) -> Array:
    """Return the size of the combined weighting of ISO 2631-2 (Wm) for acceleration at frequencies [Hz].

    H(s) = s^2 / (s^2 + sqrt(2) w1 s + w1^2)  w2^2 / (s^2 + sqrt(2) w2 s + w2^2)  1 / (1 + s / w3) with w1 = 2 pi 10^-0.1,
    w2 = 2 pi 100 and w3 = 1 / 0.028 rad/s (ISO 8041): band limits of 0.79 and 100 Hz, and the passage from acceleration to
    velocity at 5.68 Hz. At 15.915 Hz it is 0.3362. For velocity the weighting is this one times w / w3, so that a weighted
    acceleration is 35.7 times the weighted velocity.
    """
    f = np.asarray(frequency, dtype=np.float64)
    low, high = 10.0**-0.1, 100.0
    band = f**2 / np.sqrt(f**4 + low**4) / np.sqrt(1.0 + (f / high) ** 4)
    return band / np.sqrt(1.0 + (2.0 * math.pi * f * _TRANSITION) ** 2)


_TRANSITION = 0.028
"""1 / w3 of the weighting [s]."""


def iso_6954_1984(frequency: npt.ArrayLike, velocity: npt.ArrayLike, *, subject: str) -> tuple[Verdict, ...]:
    """Return the verdicts of ISO 6954:1984 on the lines of a spectrum: the worst line against the lower and upper limit.

    Args:
        frequency: of the lines [Hz]; those outside 1 to 100 Hz do not count.
        velocity: their peak velocities [m/s], largest values that repeat; see `velocity_lines`.
        subject: what is judged.

    Raises:
        ValueError: lines are not as they must be, or none lies between 1 and 100 Hz.
    """
    f, v = _lines(frequency, velocity)
    inside = (f >= _RANGE_1984[0]) & (f <= _RANGE_1984[1])
    if not inside.any():
        raise ValueError(f"`frequency` must hold a line from 1 to 100 Hz, got {f.min():.6g} to {f.max():.6g}.")
    f, v = f[inside], v[inside]
    found = []
    for name, (plateau, acceleration) in PEAKS_1984.items():
        allowed = np.where(f < _KNEE, acceleration / (2.0 * math.pi * f), plateau)
        worst = int((v / allowed).argmax())
        found.append(
            Verdict(
                criterion=f"ISO 6954:1984 {name}",
                subject=subject,
                value=float(v[worst]),
                limit=float(allowed[worst]),
                unit="m/s",
                note=f"peak velocity at {f[worst]:.4g} Hz; {_WORDS[name]}",
            )
        )
    return tuple(found)


def iso_6954_2000(
    frequency: npt.ArrayLike, velocity: npt.ArrayLike, *, subject: str, space: Literal["A", "B", "C"]
) -> tuple[Verdict, ...]:
    """Return the verdicts of ISO 6954:2000 on the lines of a spectrum: the overall weighted rms velocity.

    Args:
        frequency: of the lines [Hz].
        velocity: their peak velocities [m/s].
        subject: what is judged.
        space: "A" passenger cabins, "B" crew accommodation, "C" working spaces.

    Raises:
        ValueError: lines or space are not as they must be.
    """
    f, v = _lines(frequency, velocity)
    factors = weighting(f) * 2.0 * math.pi * f * _TRANSITION
    return _overall(math.sqrt(0.5 * float(np.sum((factors * v) ** 2))), subject, space)


def iso_6954_2000_of_history(
    time: npt.ArrayLike,
    acceleration: npt.ArrayLike,
    *,
    subject: str,
    space: Literal["A", "B", "C"],
    discard: float = 0.0,
    resolution: float = 0.25,
) -> tuple[Verdict, ...]:
    """Return the verdicts of ISO 6954:2000 on a history: the overall weighted rms velocity.

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
    weighted = weighting(density.frequency) ** 2 * density.density
    return _overall(_TRANSITION * math.sqrt(float(np.sum(weighted)) * density.resolution), subject, space)


def velocity_lines(
    time: npt.ArrayLike, acceleration: npt.ArrayLike, *, discard: float = 0.0, resolution: float = 0.25
) -> tuple[Array, Array]:
    """Return frequencies [Hz] and peak velocities [m/s] of the lines of an acceleration, for `iso_6954_1984`.

    By Welch's method with a flat-top window on the integrated history: a sine shows its amplitude within 0.1 % wherever it
    lies between the lines, in about five of them, so that lines must not be added up. What lies below five resolutions
    cannot be told from the drift of the integral and is left out.

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
    velocity = cumulative_trapezoid(signal.detrend(values[-kept:], type="constant"), dx=1.0 / rate, initial=0.0)
    frequency, square = signal.welch(
        velocity, fs=rate, window="flattop", nperseg=size, scaling="spectrum", detrend="linear"
    )
    told = (frequency > 4.5 * checked.resolution) & (frequency < 0.45 * rate)
    # The trapezoidal rule integrates a sine to (w T / 2) / tan(w T / 2) of its integral.
    half = math.pi * frequency[told] / rate
    return frequency[told], np.sqrt(2.0 * square[told]) * np.tan(half) / half


def _lines(frequency: npt.ArrayLike, velocity: npt.ArrayLike) -> tuple[Array, Array]:
    f, v = np.atleast_1d(np.asarray(frequency, dtype=np.float64)), np.atleast_1d(np.asarray(velocity, dtype=np.float64))
    if f.ndim != 1 or f.shape != v.shape or not f.size:
        raise ValueError(
            f"`frequency` and `velocity` must be rows of the same length, got the shapes {f.shape} and {v.shape}."
        )
    if not (np.isfinite(f).all() and np.isfinite(v).all() and f.min() > 0.0 and v.min() >= 0.0):
        raise ValueError("`frequency` must be finite and > 0 Hz and `velocity` finite and >= 0 m/s.")
    return f, v


def _overall(velocity: float, subject: str, space: str) -> tuple[Verdict, ...]:
    """Return the verdicts on a weighted rms velocity [m/s]."""
    if space not in RMS_2000:
        raise ValueError(f"`space` must be one of {', '.join(RMS_2000)}, got {space!r}.")
    return tuple(
        Verdict(
            criterion=f"ISO 6954:2000 {space} {name}",
            subject=subject,
            value=velocity,
            limit=limit,
            unit="m/s",
            note=f"weighted rms velocity; {_WORDS[name]}",
        )
        for name, limit in zip(("lower", "upper"), RMS_2000[space], strict=True)
    )
