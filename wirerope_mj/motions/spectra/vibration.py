"""Response and fatigue damage spectra of random vibration, from its power spectral density."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.motions.psd_lines import Points, checked_points

Method = Literal["dirlik", "narrow-band"]
_POWERS = (0, 1, 2, 4)  # powers of the frequency in the moments that the rules of damage take
_PER_OCTAVE = 400  # Frequencies to an octave by which a density is integrated: 1e-4 of the moments of Q = 50
_ROUNDS, _EQUAL = 100, 1e-3  # Corrections of an equivalent density, and the relative error of its damage that ends them
_LEAST = 1e-6  # of the largest level
# half-power bandwidths to either side of a resonance between which the integral is parted, so that it sees the peak
_NEAR = 40.0


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class VibrationSpectrum(Brief):
    """Responses of oscillators of quality `q` to stationary random vibration of the base."""

    frequencies: Array  #: natural frequencies [Hz], (n,)
    acceleration: Array  #: rms of the absolute acceleration [m/s^2], (n,)
    deflection: Array  #: rms of the deflection relative to the base [m], (n,)
    moments: Array  #: of the deflection's density W, the integrals of f^k W for k = 0, 1, 2 and 4 [m^2 Hz^k], (n, 4)
    q: float  #: quality, 1/(2 damping ratio)

    @property
    def pseudo_velocity(self) -> Array:
        """Rms of the deflection times 2 pi f [m/s], (n,), to which the stress in a part is in proportion."""
        return 2.0 * math.pi * self.frequencies * self.deflection

    @property
    def upcrossings(self) -> Array:
        """Expected rate at which the deflection passes zero upwards [Hz], (n,): the natural frequency only near resonance."""
        return np.asarray(np.sqrt(self.moments[:, 2] / self.moments[:, 0]))

    def fatigue_damage(self, exponent: float, duration: float, *, method: Method = "dirlik") -> Array:
        """Return the damage of a duration [s] at every frequency, (n,), of pseudo-velocity amplitudes with C = 1.

        Args:
            exponent: b of N = C / A^b.
            duration: T [s].
            method: "dirlik" (1985): rainflow amplitudes of a Gaussian process of any bandwidth; "narrow-band": as many cycles
                as upward crossings, with Rayleigh's amplitudes, D = v0 T (sqrt(2) s)^b Gamma(1 + b/2).

        ValueError: an argument is out of its range.
        """
        b, time = positive("exponent", exponent), positive("duration", duration, unit="s")
        one_of("method", method, get_args(Method))
        rayleigh = 2.0 ** (0.5 * b) * math.gamma(1.0 + 0.5 * b)
        if method == "narrow-band":
            return np.asarray(self.upcrossings * time * self.pseudo_velocity**b * rayleigh)
        m0, m1, m2, m4 = self.moments.T
        mean, regular = m1 / m0 * np.sqrt(m2 / m4), m2 / np.sqrt(m0 * m4)
        d1 = 2.0 * (mean - regular**2) / (1.0 + regular**2)
        r = (regular - mean - d1**2) / (1.0 - regular - d1 + d1**2)
        d2 = (1.0 - regular - d1 + d1**2) / (1.0 - r)
        d3 = 1.0 - d1 - d2
        scale = 1.25 * (regular - d3 - d2 * r) / d1
        power = d1 * scale**b * math.gamma(1.0 + b) + rayleigh * (d2 * np.abs(r) ** b + d3)
        return np.asarray(np.sqrt(m4 / m2) * time * self.pseudo_velocity**b * power)


def vibration_response_spectrum(
    psd: Sequence[Sequence[float]], frequencies: ArrayLike, *, q: float = 10.0
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
    points = checked_points("psd", psd, quantity="level [(m/s^2)^2/Hz]", steps=True)
    quality = positive("q", q)
    at = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
    if at.ndim != 1 or not (np.isfinite(at).all() and (at > 0.0).all()):
        raise ValueError("`frequencies` must be finite numbers > 0, (n,).")
    integrals = np.array([_integrals(points, float(f), quality) for f in at])
    return VibrationSpectrum(
        frequencies=at, acceleration=np.sqrt(integrals[:, -1]), deflection=np.sqrt(integrals[:, 0]),
        moments=integrals[:, :-1], q=quality,
    )  # fmt: skip


def equivalent_psd(
    frequencies: ArrayLike, damage: ArrayLike, *, exponent: float, duration: float, q: float = 10.0,
    method: Method = "dirlik", every: int = 1,
) -> tuple[Points, Array]:  # fmt: skip
    """Find the power spectral density that does at least the damage of a damage spectrum within a duration [s].

    The density has a point at every so many of the frequencies, and is zero outside the first and the last of them. Its levels
    are corrected by (wanted / found)^(2 / b), at the frequency about the point that lacks most, until nothing lacks. Where the
    spectrum falls more steeply than the skirts of an oscillator let it, the level goes to its least, a millionth of the
    largest, and the damage stays above the wanted one: on the safe side. The levels at the ends stand for all that lies
    beyond them, too.

    The damage, (n,), is that of pseudo-velocity amplitudes with C = 1 at natural frequencies [Hz], increasing, (n,), and the
    exponent b of N = C / A^b, as `fatigue_damage_spectrum` counts it; `every` divides n - 1. What comes back are points
    (frequency [Hz], level [(m/s^2)^2/Hz]), and their damage over the wanted one, (n,). ValueError: an argument is out of its
    range.
    """
    at, wanted = np.array(checked_points("damage", list(zip(frequencies, damage, strict=True)), quantity="damage")).T  # type: ignore[arg-type]
    b, quality = positive("exponent", exponent), positive("q", q)
    grid = np.geomspace(at[0], at[-1], math.ceil(_PER_OCTAVE * math.log2(at[-1] / at[0])) + 1)
    ratio = grid / at[:, None]
    squared = 1.0 / ((1.0 - ratio**2) ** 2 + (ratio / quality) ** 2) / (2.0 * math.pi * at[:, None]) ** 4
    steps = np.gradient(np.log(grid))
    steps[[0, -1]] *= 0.5  # the trapezoidal rule
    weights = np.stack([steps * grid ** (k + 1) for k in _POWERS])  # f^k df = f^(k + 1) dlog f
    corners = at[::every]
    if corners[-1] != at[-1]:
        raise ValueError(f"`every` must divide the number of intervals between the frequencies, {at.size - 1}, got {every}.")

    def relative_damage(levels: Array) -> Array:
        """Return the damage of the density over the wanted one, (n,)."""
        density = np.exp(np.interp(np.log(grid), np.log(corners), np.log(levels)))
        moments = squared @ (weights * density).T
        spectrum = VibrationSpectrum(
            frequencies=at, acceleration=np.full(at.size, math.nan), deflection=np.sqrt(moments[:, 0]), moments=moments,
            q=quality,
        )  # fmt: skip
        return spectrum.fatigue_damage(b, duration, method=method) / wanted

    levels = np.ones(corners.size)
    for _ in range(_ROUNDS):
        least = scipy.ndimage.minimum_filter1d(relative_damage(levels), every // 2 * 2 + 1, mode="nearest")[::every]
        if np.abs(least - 1.0).max() < _EQUAL:
            break
        levels = levels * least ** (-2.0 / b)
        levels = np.maximum(levels, _LEAST * levels.max())
    relative = relative_damage(levels)
    lack = min(1.0, float(relative.min()))  # what the corrections have left: damage goes with the level to the power b / 2
    return tuple(zip(corners.tolist(), (levels * lack ** (-2.0 / b)).tolist(), strict=True)), relative / lack


def _integrals(points: Points, natural: float, q: float) -> Array:
    """Return the moments of the deflection's density and the mean square of the absolute acceleration, (5,)."""
    total = np.zeros(len(_POWERS) + 1)
    near = natural * (1.0 + _NEAR * np.array([-1.0, 0.0, 1.0]) / q)
    for (f1, s1), (f2, s2) in zip(points[:-1], points[1:], strict=True):
        if f1 == f2:  # a step
            continue
        slope = math.log(s2 / s1) / math.log(f2 / f1)

        def density(f: float, *, start: float = f1, level: float = s1, slope: float = slope) -> float:
            """Return the density of the pseudo-acceleration."""
            ratio = f / natural
            return level * (f / start) ** slope / ((1.0 - ratio**2) ** 2 + (ratio / q) ** 2)

        def parts(f: float) -> Array:
            moments = [f**power * density(f) / (2.0 * math.pi * natural) ** 4 for power in _POWERS]
            return np.array([*moments, density(f) * (1.0 + (f / natural / q) ** 2)])

        ends = [f1, *(f for f in near if f1 < f < f2), f2]
        for low, high in zip(ends[:-1], ends[1:], strict=True):
            total += [
                scipy.integrate.quad(lambda f, k: parts(f)[k], low, high, args=(k,), limit=200, epsabs=0.0, epsrel=1e-10)[0]
                for k in range(total.size)
            ]
    return total
