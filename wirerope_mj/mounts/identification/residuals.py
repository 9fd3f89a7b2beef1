"""Residuals of a search: forces, their Fourier coefficients, mid-lines, areas."""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.laws import Law

Residual = Callable[[Law], Array]
Data = Literal["loops", "skeleton"]
# Fraction of the rectangle about a loop below which its area is no size to divide by; wire rope has 0.1 to 0.5.
THIN = 0.01


def loop_residual(loops: Sequence[MeasuredLoop], data: Data = "loops") -> Residual:
    """Return the residual of all loops: force of the law minus measured, each loop without its mean, over its weight.

    The mean is what a drifting zero of the load cell adds; the law's own is lost with it. Data are "loops", all samples, or
    "skeleton", the forces at the turning points alone.
    """

    def whole(law: Law) -> Array:
        differences = [(loop.model_force(law) - loop.force) / loop.weight for loop in loops]
        return np.concatenate([difference - difference.mean() for difference in differences])

    def tips(law: Law) -> Array:
        parts = []
        for loop in loops:
            ends = [int(np.argmax(loop.deflection)), int(np.argmin(loop.deflection))]
            difference = (loop.model_force(law) - loop.force)[ends] / loop.weight
            parts.append(difference[0] - difference[1])
        return np.array(parts)

    return whole if data == "loops" else tips


def harmonic_residual(loops: Sequence[MeasuredLoop], *, harmonics: int = 7) -> Residual:
    """Return the residual in the frequency domain: the Fourier coefficients of the force over the cycle's phase.

    Samples count as uniform over the phase, as those of a sine sampled in time are.
    """

    def residual(law: Law) -> Array:
        parts = []
        for loop in loops:
            spectrum = np.fft.rfft((loop.model_force(law) - loop.force)[:-1])[1 : harmonics + 1]
            scaled = spectrum * np.sqrt(2.0 / (loop.force.size - 1)) / loop.weight
            parts += [scaled.real, scaled.imag]
        return np.concatenate(parts)

    return residual


def mid_line_residual(loops: Sequence[MeasuredLoop], *, points: int = 41) -> Residual:
    """Return the residual of the loops' mid-lines (F_up + F_down) / 2, which show the elastic part: the first stage's."""

    def residual(law: Law) -> Array:
        parts = []
        for loop in loops:
            difference = loop.mid_line(loop.model_force(law) - loop.force, points) / loop.weight
            parts.append(difference - difference.mean())
        return np.concatenate(parts)

    return residual


def area_residual(loops: Sequence[MeasuredLoop]) -> Residual:
    """Return the residual of the loops' areas, relative to the measured ones: the second stage's.

    A loop thinner than `THIN` of the rectangle about it counts relative to that fraction of the rectangle: noise of the force
    makes such an area small, zero or negative.
    """
    thin = [THIN * float(np.ptp(loop.deflection) * np.ptp(loop.force)) for loop in loops]
    sizes = [max(loop.area(loop.force), least) for loop, least in zip(loops, thin, strict=True)]

    def residual(law: Law) -> Array:
        differences = [loop.area(loop.model_force(law) - loop.force) for loop in loops]
        return np.array([one / size for one, size in zip(differences, sizes, strict=True)])

    return residual


def joined(loops: Residual, extra: Sequence[Residual]) -> Residual:
    """Return the residual of the loops and of everything that joins them."""
    if not extra:
        return loops
    return lambda law: np.concatenate([loops(law), *(np.ravel(other(law)) for other in extra)])


def rms(residual: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(residual**2)))
