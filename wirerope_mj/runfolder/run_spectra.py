"""Spectra of a run, of its base and of the bodies and points that are shaken most: of a shock, or of random vibration."""

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from wirerope_mj.excitation import BaseMotion, RandomVibration
from wirerope_mj.plots.report_motion import moving_axes
from wirerope_mj.plots.report_response import acceleration_along
from wirerope_mj.report import BASE, Absent
from wirerope_mj.response import Response
from wirerope_mj.spectra import (
    PowerSpectralDensity,
    ShockResponseSpectrum,
    power_spectral_density,
    shock_response_spectrum,
)
from wirerope_mj.spectra.arguments import octave_grid
from wirerope_mj.spectra.srs import SAMPLES_PER_PERIOD

Array = npt.NDArray[np.float64]

Q = 10.0
"""Amplification of the oscillators: the convention where nothing else is agreed."""

_LOWEST, _HIGHEST = 1.0, 1000.0  # [Hz]
_FINE = 10_000.0  # [Hz], at which a base whose motion is known in closed form is sampled
_MOST_FINE = 200_000  # samples of it: twenty seconds
_LONG = 200_000  # samples from which spectra have fewer lines: each takes a hundredth of a second for a million samples
_LINES, _FEW_LINES = 12, 6  # to an octave
_STEADY = ("sweep", "sine", "vibration-lines")
_LEAST_STEADY = 1.0  # [s] of stationary vibration below which a density is too uncertain to be shown


def run_spectra(
    motion: BaseMotion, response: Response, names: Sequence[str], sample_rate: float
) -> Mapping[str, Mapping[str, ShockResponseSpectrum]] | Absent:
    """Return the spectra along every axis in which the base moves, by axis and name, the base first; or why there are none.

    Args:
        motion: of the base.
        response: to it.
        names: bodies and points.
        sample_rate: of the response [Hz].
    """
    terms = motion.parts
    axes = moving_axes(response)
    if not axes:
        return Absent(reason="The base rests: there is no shock response spectrum.")
    if any(isinstance(term, RandomVibration) for term in terms):
        return Absent(reason="The base vibrates at random: power spectral densities stand for shock response spectra.")
    if any(term.kind in _STEADY for term in terms):
        return Absent(
            reason="The base is driven steadily: a shock response spectrum would say little, and none is shown."
        )
    highest = min(sample_rate / SAMPLES_PER_PERIOD, _HIGHEST)
    if highest < 2.0 * _LOWEST:
        return Absent(reason=f"At {sample_rate:g} samples a second there is no shock response spectrum worth showing.")
    if motion.velocity_jumps:
        return Absent(
            reason="The base's velocity jumps: its acceleration is not finite, and its pseudo-velocity is the jump itself at "
            "every frequency. No shock response spectrum is shown."
        )
    frequencies = octave_grid(_LOWEST, highest, per_octave=_LINES if response.time.size <= _LONG else _FEW_LINES)
    found: dict[str, dict[str, ShockResponseSpectrum]] = {}
    for axis in axes:
        found["xyz"[axis]] = {BASE: _of_base(motion, response, axis, frequencies)}
        for name in names:
            found["xyz"[axis]][name] = _spectrum(response, name, axis, frequencies)
    return found


def run_densities(
    motion: BaseMotion, response: Response, names: Sequence[str]
) -> Mapping[str, Mapping[str, PowerSpectralDensity]]:
    """Return the power spectral densities of a random vibration while it is stationary, by axis and name; else nothing.

    Args:
        motion: of the base.
        response: to it.
        names: bodies and points.
    """
    terms = [term for term in motion.parts if isinstance(term, RandomVibration)]
    first = max((term.steady[0] for term in terms), default=0.0)
    last = min((term.steady[1] for term in terms), default=0.0)
    rows = slice(*np.searchsorted(response.time, [first, last]))
    time = response.time[rows]
    if len(terms) < len(motion.parts) or time.size < 2 or time[-1] - time[0] < _LEAST_STEADY:
        return {}
    return {
        "xyz"[axis]: {
            name: power_spectral_density(time, acceleration_along(response, name, axis)[rows])
            for name in (BASE, *names)
        }
        for axis in moving_axes(response)
    }


def _spectrum(response: Response, name: str, axis: int, frequencies: Array) -> ShockResponseSpectrum:
    return shock_response_spectrum(response.time, acceleration_along(response, name, axis), frequencies, q=Q)


def _of_base(motion: BaseMotion, response: Response, axis: int, frequencies: Array) -> ShockResponseSpectrum:
    """Return the spectrum of the base: from its closed form where that is known, so that no peak falls between samples."""
    fine = int(float(response.time[-1]) * _FINE) + 1
    if motion.files or fine > _MOST_FINE or fine <= response.time.size:
        return _spectrum(response, BASE, axis, frequencies)
    time = np.arange(fine) / _FINE
    grid = octave_grid(_LOWEST, _HIGHEST, per_octave=_LINES)
    return shock_response_spectrum(time, motion.acceleration(time)[:, axis], grid, q=Q)
