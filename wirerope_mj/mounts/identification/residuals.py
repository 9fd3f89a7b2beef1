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


def _of_each(loops: Sequence[MeasuredLoop], part: Callable[[MeasuredLoop, Array], Array | float]) -> Residual:
    """Return the residual that has a part for each loop, made of the law's force minus the measured one."""
    return lambda law: np.concatenate([np.ravel(part(loop, loop.model_force(law) - loop.force)) for loop in loops])


def _centred(values: Array) -> Array:
    return values - values.mean()


def loop_residual(loops: Sequence[MeasuredLoop], data: Data = "loops") -> Residual:
    """Return the residual of all loops: force of the law minus measured, each loop without its mean, over its weight.

    The mean is what a drifting zero of the load cell adds; the law's own is lost with it. Data are "loops", all samples, or
    "skeleton", the forces at the turning points alone.
    """

    def tips(loop: MeasuredLoop, misfit: Array) -> float:
        relative = misfit / loop.weight
        return relative[np.argmax(loop.deflection)] - relative[np.argmin(loop.deflection)]

    return _of_each(loops, tips if data == "skeleton" else lambda loop, misfit: _centred(misfit / loop.weight))


def harmonic_residual(loops: Sequence[MeasuredLoop], *, harmonics: int = 7) -> Residual:
    """Return the residual in the frequency domain: the Fourier coefficients of the force over the cycle's phase.

    Samples count as uniform over the phase, as those of a sine sampled in time are.
    """

    def coefficients(loop: MeasuredLoop, misfit: Array) -> Array:
        spectrum = np.fft.rfft(misfit[:-1])[1 : harmonics + 1] * np.sqrt(2.0 / (misfit.size - 1)) / loop.weight
        return np.concatenate([spectrum.real, spectrum.imag])

    return _of_each(loops, coefficients)


def mid_line_residual(loops: Sequence[MeasuredLoop], *, points: int = 41) -> Residual:
    """Return the residual of the loops' mid-lines (F_up + F_down) / 2, which show the elastic part: the first stage's."""
    return _of_each(loops, lambda loop, misfit: _centred(loop.mid_line(misfit, points) / loop.weight))


def area_residual(loops: Sequence[MeasuredLoop]) -> Residual:
    """Return the residual of the loops' areas, relative to the measured ones: the second stage's.

    A loop thinner than `THIN` of the rectangle about it counts relative to that fraction of the rectangle: noise of the force
    makes such an area small, zero or negative.
    """

    def area(loop: MeasuredLoop, misfit: Array) -> float:
        thin = THIN * float(np.ptp(loop.deflection) * np.ptp(loop.force))
        return loop.area(misfit) / max(loop.area(loop.force), thin)

    return _of_each(loops, area)


def joined(loops: Residual, extra: Sequence[Residual]) -> Residual:
    """Return the residual of the loops and of everything that joins them."""
    if not extra:
        return loops
    return lambda law: np.concatenate([loops(law), *(np.ravel(other(law)) for other in extra)])


def rms(residual: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(residual**2)))
