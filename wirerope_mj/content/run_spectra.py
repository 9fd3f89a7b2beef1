"""Spectra of a run, of its base and of its most accelerated bodies and points: SRS of a shock, or PSD of random vibration."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.criteria.sampled import steady_interval
from wirerope_mj.content.selection import worst_names
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation.run import aliasing
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.motions import BaseMotion, RandomVibration
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum, power_spectral_density
from wirerope_mj.motions.spectra.ramp import octave_grid
from wirerope_mj.motions.spectra.srs import SAMPLES_PER_PERIOD, resolved_frequency, shock_response_spectrum

BASE = "base"  # Name of the base among the spectra
Q = 10.0  # quality factor of the oscillators, the usual convention
_LOWEST, _HIGHEST = 1.0, 1000.0  # [Hz]
_FINE_RATE = 10_000.0  # [Hz], at which a base whose motion is known in closed form is sampled
_MOST_FINE_SAMPLES = 200_000  # samples at this rate: twenty seconds
_LONG_RUN = 200_000  # samples from which spectra have fewer lines: each takes 10 ms for a million samples
_LINES, _FEW_LINES = 12, 6  # to an octave
_STEADY = ("sweep", "sine", "vibration-lines")
_LEAST_STEADY = 1.0  # [s] of stationary vibration below which a density is too uncertain to be shown


_STILL = 1e-12  # [m]: displacement up to which the base is at rest along an axis


@dataclass(frozen=True, kw_only=True)
class RunSpectra:
    """Spectra of a run by axis and name: shock response spectra, or the reason for their absence, and densities.

    Spectra of bodies and points are computed from samples, within 1 % up to the frequency `held` [Hz].
    """

    shock: Mapping[str, Mapping[str, ShockResponseSpectrum]] | Absent
    densities: Mapping[str, Mapping[str, PowerSpectralDensity]]
    held: float = math.nan


def spectra_of(motion: BaseMotion, response: Response, sample_rate: float) -> RunSpectra:
    """Compute the spectra of a run's base and of its most accelerated bodies and points."""
    names = worst_names(response)
    shock = run_spectra(motion, response, names, sample_rate)
    held_to = math.nan
    if aliasing([motion], sample_rate):  # a sine near the sample rate appears slow and smooth
        held_to = 0.0
    elif not isinstance(shock, Absent):
        held_to = min(
            resolved_frequency(response.time, acceleration_along(response, name, "xyz".index(axis)), spectrum)
            for axis, lines in shock.items()
            for name, spectrum in lines.items()
            if name != BASE or len(lines) == 1
        )
    return RunSpectra(shock=shock, densities=run_densities(motion, response, names), held=held_to)


def run_spectra(
    motion: BaseMotion, response: Response, names: Sequence[str], sample_rate: float
) -> Mapping[str, Mapping[str, ShockResponseSpectrum]] | Absent:
    """Compute shock response spectra along the axes in which the base moves, by axis and name, or why they are absent."""
    terms = motion.parts
    axes = moving_axes(response)
    if not axes:
        return Absent(reason="The base rests: there is no shock response spectrum.")
    if any(isinstance(term, RandomVibration) for term in terms):
        return Absent(reason="The base vibrates at random: PSDs are shown instead of SRS.")
    if any(term.kind in _STEADY and not term.targets for term in terms):
        return Absent(reason="The base is driven steadily: a shock response spectrum would say little, and none is shown.")
    highest = min(sample_rate / SAMPLES_PER_PERIOD, _HIGHEST)
    if highest < 2.0 * _LOWEST:
        return Absent(reason=f"At {sample_rate:g} samples a second there is no shock response spectrum worth showing.")
    if motion.velocity_jumps:
        # An oscillator's first extreme is exp(-zeta t) of the jump with t = arccos(zeta) / sqrt(1 - zeta^2), in radians of its
        # undamped frequency.
        zeta = 0.5 / Q
        jump_ratio = math.exp(-zeta * math.acos(zeta) / math.sqrt(1.0 - zeta * zeta))
        return Absent(
            reason="The base's velocity jumps: its acceleration is not finite, and a single jump has the same "
            f"pseudo-velocity at every frequency, {jump_ratio:.3g} of it at Q = {Q:g} (the jump itself without damping). "
            "No shock response spectrum is shown."
        )
    frequencies = octave_grid(_LOWEST, highest, per_octave=_LINES if response.time.size <= _LONG_RUN else _FEW_LINES)
    fine = fine_base(motion, response)
    q = 0.5 / motion.targets[0].damping if motion.targets else Q  # that of the spectrum which the motion was made for
    spectra: dict[str, dict[str, ShockResponseSpectrum]] = {}
    for axis in axes:
        along = spectra["xyz"[axis]] = {}
        for name in (BASE, *names):
            time, acceleration, lines = response.time, acceleration_along(response, name, axis), frequencies
            if name == BASE and fine is not None:
                time, acceleration, lines = fine[0], fine[1][:, axis], octave_grid(_LOWEST, _HIGHEST, per_octave=_LINES)
            along[name] = shock_response_spectrum(time, acceleration, lines, q=q)
    return spectra


def run_densities(
    motion: BaseMotion, response: Response, names: Sequence[str]
) -> Mapping[str, Mapping[str, PowerSpectralDensity]]:
    """Compute power spectral densities of a random vibration while it is stationary, by axis and name.

    All begin at the same instant, when the base is stationary and the response has settled: the longest `settling` of first
    estimates over the whole stationary part.
    """
    alone, first, last = steady_interval(motion.to_dict())
    axes = moving_axes(response)
    if not (alone and axes):
        return {}
    rows = slice(*np.searchsorted(response.time, [first, last]))
    if not _long_enough(response.time[rows]):
        return {}
    unsettled = _densities(response, names, axes, rows)
    settling = max(float(density.settling) for along in unsettled.values() for density in along.values())
    rows = slice(*np.searchsorted(response.time, [response.time[rows][0] + settling, last]))
    return _densities(response, names, axes, rows) if _long_enough(response.time[rows]) else {}


def _long_enough(time: Array) -> bool:
    return time.size > 1 and float(time[-1] - time[0]) >= _LEAST_STEADY


def _densities(
    response: Response, names: Sequence[str], axes: Sequence[int], rows: slice
) -> dict[str, dict[str, PowerSpectralDensity]]:
    return {
        "xyz"[axis]: {
            name: power_spectral_density(response.time[rows], acceleration_along(response, name, axis)[rows])
            for name in (BASE, *names)
        }
        for axis in axes
    }


def fine_base(motion: BaseMotion, response: Response) -> tuple[Array, Array] | None:
    """Sample the closed form of the base's motion at 10 kHz: instants [s], (n,), and accelerations [m/s^2], (n, 3).

    None if the motion has no closed form, jumps in velocity or lasts too long, or if the run's samples are as fine.
    """
    fine = int(float(response.time[-1]) * _FINE_RATE) + 1
    if motion.files or motion.velocity_jumps or fine > _MOST_FINE_SAMPLES or fine <= response.time.size:
        return None
    time = np.arange(fine) / _FINE_RATE
    return time, motion.acceleration(time)


def held_text(held: float) -> str:
    """Describe the frequency [Hz] up to which samples give a spectrum within 1 %; 0 if they give no line of it so."""
    return f"within 1 % {f'up to {held:.3g} Hz' if held else 'at no frequency'}"


def moving_axes(response: Response) -> list[int]:
    """List the axes along which the base moves."""
    return [axis for axis in range(3) if np.abs(response.base.displacement[:, axis]).max(initial=0.0) > _STILL]


def acceleration_along(response: Response, name: str, axis: int) -> Array:
    """Read the acceleration of a body, a point or the "base" along an axis [m/s^2], (n_t,)."""
    group = "base" if name == "base" else f"bodies/{name}" if name in response.bodies else f"points/{name}"
    return response.column(f"{group}/acceleration/{'xyz'[axis]}")
