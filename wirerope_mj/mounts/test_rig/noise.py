"""Noise in a loop's force: how much of it there is, and whether a stiffness or an area stands out of it."""

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.mounts.test_rig.recorded import RecordedLoop
from wirerope_mj.mounts.test_rig.turning import rms_noise

_SURE = 4.0  # standard errors: noise alone goes beyond once in 16 000
_OWN = 1.5  # variance of a series over that of its noise, below which noise is at least two thirds of what it shows
_PROBABILITY = 1e-4  # of noise to look like a cycle
_ENOUGH = 0.5  # fraction of the variance at one frequency that is a cycle, however few the samples
_FEW = 6.0  # four standard errors of the variance of n samples, 4 sqrt(2 / n), rounded up


def is_noise(values: Array, noise: float) -> bool:
    """Return whether a series is no more than its noise.

    Args:
        values: of the series, (n,).
        noise: its standard deviation, in the unit of the values.
    """
    return bool(values.var() <= max(_OWN, 1.0 + _FEW / np.sqrt(values.size)) * noise**2)


def has_cycle(force: Array) -> bool:
    """Return whether a force has more at the frequency of its cycle than noise of its size would have there.

    Of n samples of white noise, the fraction r that one frequency has in their variance is exceeded with the probability
    (1 - r)^((n - 3) / 2), whatever the noise's size.

    Args:
        force: of one cycle without the sample that repeats the first [N], (n,).
    """
    first = np.abs(np.fft.rfft(force - force.mean())[1])
    fraction = 2.0 * first**2 / (force.size**2 * force.var())
    return bool(fraction > min(1.0 - _PROBABILITY ** (2.0 / (force.size - 3)), _ENOUGH))


def no_cycle_text(deflection: Array) -> str:
    """Return that a deflection [m], (n,), is noise, as text with how large it is."""
    noise = rms_noise(deflection)
    return (
        f"the deflection never changes by more than its noise, {1e3 * noise:.3g} mm, "
        f"{100.0 * min(noise / float(deflection.std()), 1.0):.3g} % of its rms value; there is no cycle."
    )


def force_noise(loop: Loop) -> float:
    """Return the standard deviation of the noise in a loop's forces [N].

    It is that from sample to sample, or what the averaged cycles differ by: noise of low frequency shows there alone.
    """
    return max(rms_noise(loop.force), loop.scatter if isinstance(loop, RecordedLoop) else 0.0)


def noise_text(loop: Loop) -> str:
    """Return how large the noise of a loop's force is, as text: `noise of 12 N, 34 % of the force's rms value`."""
    noise, own = force_noise(loop), float(loop.force.std())
    return f"noise of {noise:.3g} N, {100.0 * min(noise / own, 1.0):.3g} % of the force's rms value"


def stiffness_in_noise(loop: Loop) -> bool:
    """Return whether the forces at the two turning points differ by no more than their noise does."""
    return abs(loop.secant_stiffness) * 2.0 * loop.amplitude <= _SURE * np.sqrt(2.0) * force_noise(loop)


def area_in_noise(loop: Loop) -> bool:
    """Return whether the area of a loop [J] is no larger than noise of force and deflection makes it.

    The area is the sum of f_i (x_i+1 - x_i-1) / 2, and of x_i (f_i-1 - f_i+1) / 2, over its samples: independent errors of f
    and x with the standard deviations s_f and s_x give its variance as s_f^2 sum dx_i^2 + s_x^2 sum df_i^2.
    """
    x, f = loop.deflection[:-1], loop.force[:-1]
    dx, df = (0.5 * (np.roll(values, -1) - np.roll(values, 1)) for values in (x, f))
    error = np.hypot(force_noise(loop) * np.linalg.norm(dx), rms_noise(loop.deflection) * np.linalg.norm(df))
    return bool(abs(loop.dissipated_energy) <= _SURE * error)
