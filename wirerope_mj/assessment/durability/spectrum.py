"""Fatigue damage spectrum of a measured acceleration: the damage to oscillators of all frequencies, counted cycle by cycle."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from wirerope_mj.assessment.durability.cycles import rainflow_cycles
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.motions.spectra.ramp import check_samples, octave_grid
from wirerope_mj.motions.spectra.srs import SAMPLES_PER_PERIOD, ramp_steps


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class DamageSpectrum(Brief):
    """Damage to oscillators of quality `q` on a base that moves with an acceleration.

    Attributes:
        frequencies: of the oscillators [Hz], (n,).
        damage: Miner's sum with N = C / A^b and C = 1, A being amplitudes of the pseudo-velocity [m/s], (n,).
        exponent: b.
        q: amplification at resonance, 1 / (2 damping ratio).
    """

    frequencies: Array
    damage: Array
    exponent: float
    q: float


def fatigue_damage_spectrum(
    time: npt.ArrayLike,
    acceleration: npt.ArrayLike,
    *,
    exponent: float,
    frequencies: npt.ArrayLike | None = None,
    q: float = 10.0,
) -> DamageSpectrum:
    """Return the fatigue damage spectrum of a sampled acceleration.

    The oscillators start at rest and are solved exactly for an acceleration that is straight between the samples, as for shock
    response spectra; cycles of the samples are counted by the rainflow method. What vibrates on after the last sample is not
    counted.

    Args:
        time: uniform instants [s], (n,).
        acceleration: of the base [m/s^2], (n,).
        exponent: b of the fatigue curve.
        frequencies: of the oscillators [Hz], (n_f,); without them six to an octave, from one over the record's length to a
            fortieth of the sampling rate. Straight lines and peaks between the samples take some 5 % of the amplitudes at a
            tenth of it, 1 % at a twentieth, and b times as much of the damage.
        q: amplification at resonance, > 0.5.

    Raises:
        ValueError: an argument is out of its range, or a frequency above a tenth of the sampling rate, from where on turning
            points between the samples are missed.
    """
    values, step = check_samples(time, acceleration)
    b, quality = positive("exponent", exponent), positive("q", q)
    if values.ndim != 1 or quality <= 0.5:
        raise ValueError("`acceleration` must be one history, (n,), and `q` above 0.5.")
    highest = 1.0 / (SAMPLES_PER_PERIOD * step)
    if frequencies is None:
        top = 0.25 * highest
        at = octave_grid(min(1.0 / (step * (values.size - 1)), top), top, per_octave=6)
    else:
        at = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
        if at.ndim != 1 or not (np.isfinite(at).all() and (at > 0.0).all() and at.max() <= highest * (1.0 + 1e-9)):
            raise ValueError(f"`frequencies` must be numbers > 0 up to {highest:.6g} Hz, a tenth of the sampling rate.")
    steps = ramp_steps(2.0 * math.pi * at * step, 0.5 / quality)
    damage = [
        rainflow_cycles(2.0 * math.pi * frequency * step**2 * _deflection(values, one)).damage(b)
        for frequency, one in zip(at, steps, strict=True)
    ]
    return DamageSpectrum(frequencies=at, damage=np.array(damage), exponent=b, q=quality)


def _deflection(x: Array, step: Array) -> Array:
    """Return an oscillator's deflection over the step squared at every sample, from rest; `step` is of `ramp_steps`, (2, 4).

    The two states of a step u, v -> A (u, v) + b0 x + b1 x' as one recursion of second order in u.
    """
    (a11, a12, b01, b11), (a21, a22, b02, b12) = step
    above = np.array([b11, b01 - a22 * b11 + a12 * b12, a12 * b02 - a22 * b01])
    below = np.array([1.0, -(a11 + a22), a11 * a22 - a12 * a21])
    at_rest = x[0] * np.array([-b11, b01 - above[1]])  # the first sample moves nothing yet
    return np.asarray(scipy.signal.lfilter(above, below, x, zi=at_rest)[0])
