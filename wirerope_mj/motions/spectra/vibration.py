"""Response and fatigue damage spectra of random vibration, from its power spectral density."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.motions.psd_lines import Points, checked_points

_NEAR = 40.0
"""Half-power bandwidths to either side of a resonance between which the integral is parted, so that it sees the peak."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class VibrationSpectrum(Brief):
    """Responses of oscillators of quality `q` to stationary random vibration of the base.

    Attributes:
        frequencies: natural frequencies [Hz], (n,).
        acceleration: rms of the absolute acceleration [m/s^2], (n,).
        deflection: rms of the deflection relative to the base [m], (n,).
        q: quality, 1/(2 damping ratio).
    """

    frequencies: Array
    acceleration: Array
    deflection: Array
    q: float

    @property
    def pseudo_velocity(self) -> Array:
        """Rms of the deflection times 2 pi f [m/s], (n,), to which the stress in a part is in proportion."""
        return 2.0 * math.pi * self.frequencies * self.deflection

    def fatigue_damage(self, exponent: float, duration: float) -> Array:
        """Return the damage of a duration [s] at every frequency, (n,), of pseudo-velocity amplitudes with C = 1.

        The response is taken as narrow-band: f0 T cycles with Rayleigh's amplitudes, D = f0 T (sqrt(2) s)^b Gamma(1 + b/2).

        Args:
            exponent: b of N = C / A^b.
            duration: T [s].
        """
        b, time = positive("exponent", exponent), positive("duration", duration, unit="s")
        size = (math.sqrt(2.0) * self.pseudo_velocity) ** b
        return np.asarray(self.frequencies * time * size * math.gamma(1.0 + 0.5 * b))


def vibration_response_spectrum(
    psd: Sequence[Sequence[float]], frequencies: npt.ArrayLike, *, q: float = 10.0
) -> VibrationSpectrum:
    """Return the rms responses of oscillators to random vibration of a power spectral density.

    The squared transfer functions are integrated over the density segment by segment, straight on logarithmic axes as it is.

    Args:
        psd: points (frequency [Hz], level [(m/s^2)^2/Hz]); zero outside.
        frequencies: natural frequencies [Hz], (n,).
        q: quality of the oscillators.

    Raises:
        ValueError: an argument is out of its range.
    """
    points = checked_points("psd", psd, quantity="level [(m/s^2)^2/Hz]")
    quality = positive("q", q)
    at = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
    if at.ndim != 1 or not (np.isfinite(at).all() and (at > 0.0).all()):
        raise ValueError("`frequencies` must be finite numbers > 0, (n,).")
    squares = np.array([_mean_squares(points, float(f), quality) for f in at])
    return VibrationSpectrum(
        frequencies=at, acceleration=np.sqrt(squares[:, 0]), deflection=np.sqrt(squares[:, 1]), q=quality
    )


def _mean_squares(points: Points, natural: float, q: float) -> tuple[float, float]:
    """Return mean squares of absolute acceleration and of deflection of one oscillator."""
    damping, total = 0.5 / q, np.zeros(2)
    near = natural * (1.0 + _NEAR * np.array([-1.0, 0.0, 1.0]) / q)
    for (f1, s1), (f2, s2) in zip(points[:-1], points[1:], strict=True):
        slope = math.log(s2 / s1) / math.log(f2 / f1)

        def density(f: float, *, start: float = f1, level: float = s1, slope: float = slope) -> float:
            ratio = f / natural
            return level * (f / start) ** slope / ((1.0 - ratio**2) ** 2 + (2.0 * damping * ratio) ** 2)

        ends = [f1, *(f for f in near if f1 < f < f2), f2]
        for low, high in zip(ends[:-1], ends[1:], strict=True):
            deflection = scipy.integrate.quad(density, low, high, limit=200, epsabs=0.0, epsrel=1e-10)[0]
            acceleration = scipy.integrate.quad(
                lambda f: density(f) * (1.0 + (2.0 * damping * f / natural) ** 2), low, high, limit=200, epsabs=0.0,
                epsrel=1e-10,
            )[0]  # fmt: skip
            total += acceleration, deflection / (2.0 * math.pi * natural) ** 4
    return float(total[0]), float(total[1])
