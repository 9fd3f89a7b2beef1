"""Power spectral densities of random vibration, their statistical uncertainty, responses of oscillators, and fatigue damage."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import not_negative, one_of, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.summary import Brief, Summarised, quantity
from wirerope_mj.motions.psd_lines import Points, checked_points
from wirerope_mj.motions.spectra.ramp import check_samples

# half-overlapping segments by default: 28 degrees of freedom, a density within about 27 % (one standard error)
SEGMENTS = 15
# statistical bandwidth of a line seen through a Hann window, in resolutions: 1 / (2 int rho^2) with rho the window's
# autocorrelation over lags of 0 to 1 segment
WINDOW_BANDWIDTH = 2.079
# exponent p by which bandwidths add up, seen^p = resonance^p + window^p: within 7 % for resonances of a resolution and wider
BLUR = 1.25
# samples a segment must have: fewer leave a window with hardly a frequency between its main lobe and half the rate
LEAST_SAMPLES = 8


@dataclass(frozen=True, kw_only=True, repr=False)
class PowerSpectralDensity(Summarised):
    """Mean square per frequency of a stationary acceleration, one-sided, (n_f,), or (n_f, k) for k of them side by side."""

    frequency: Array  #: [Hz], (n_f,), evenly spaced from 0
    density: Array  #: [(m/s^2)^2/Hz]
    resolution: float  #: distance of the frequencies, one over the length of a segment [Hz]
    duration: float  #: length of the record after what was discarded [s]
    segments: int  #: number of half-overlapping segments that were averaged
    #: of the chi-squared distribution that every density has about its true value: 2 for each segment, less what their
    #: overlap shares
    degrees_of_freedom: float

    def _summary(self) -> tuple[str, dict[str, str]]:
        rms = ", ".join(quantity(float(value), "m/s^2") for value in np.atleast_1d(self.rms))
        return "PowerSpectralDensity", {
            "frequencies": f"0 to {self.frequency[-1]:.4g} Hz, {self.resolution:.4g} Hz apart",
            "rms": rms,
            "segments": f"{self.segments} of {self.duration:.4g} s",
            "standard error": f"{100.0 * self.standard_error:.3g} % of each density",
        }

    @property
    def standard_error(self) -> float:
        """Relative standard error of a density, sqrt(2 / degrees of freedom)."""
        return math.sqrt(2.0 / self.degrees_of_freedom)

    @property
    def rms(self) -> Array:
        """Root of the mean square about the mean [m/s^2], (), or (k,)."""
        return self.rms_between(0.0, math.inf)

    def rms_between(self, low: float, high: float) -> Array:
        """Return the root mean square over the frequencies from `low` to `high` [Hz], [m/s^2], (), or (k,).

        A line stands for the width of one resolution about it; of a line that is cut only the part inside counts.
        """
        if not 0.0 <= low < high:
            raise ValueError(f"`low` and `high` must be 0 <= low < high, got {low!r} and {high!r}.")
        half = 0.5 * self.resolution
        widths = np.minimum(self.frequency + half, high) - np.maximum(self.frequency - half, low)
        return np.sqrt(np.tensordot(np.clip(widths, 0.0, self.resolution), self.density, axes=(0, 0)))

    @property
    def bandwidth(self) -> Array:
        """Statistical bandwidth [Hz], (), or (k,): (integral of the density)^2 over the integral of its square.

        A band of this width with a constant density would have a mean square as uncertain as this one. The scatter of the
        densities, which enlarges the mean of their squares by 1 + 2 / degrees of freedom, is taken out, and so is what the
        window widens: with w that of a line, b^BLUR = seen^BLUR - w^BLUR. Never less than 1 / duration, at which the mean
        square has two degrees of freedom: what is narrower cannot be told from a sine.
        """
        square = self.resolution * np.sum(self.density**2, axis=0) / (1.0 + 2.0 / self.degrees_of_freedom)
        with np.errstate(invalid="ignore"):
            seen = (self.resolution * np.sum(self.density, axis=0)) ** 2 / square
        blur = np.clip(seen**BLUR - (WINDOW_BANDWIDTH * self.resolution) ** BLUR, 0.0, None)
        return np.maximum(blur ** (1.0 / BLUR), 1.0 / self.duration)

    @property
    def settling(self) -> Array:
        """Time in which a response of this bandwidth forgets its start [s], (), or (k,): 3 / bandwidth.

        An oscillator's bandwidth is 2 pi damping frequency, with which its free vibration decays; after this time its mean
        square lacks exp(-6) = 0.25 %. Of several resonances the one that dominates counts.
        """
        return 3.0 / self.bandwidth

    @property
    def rms_error(self) -> Array:
        """Relative standard error of the root mean square, 1 / (2 sqrt(bandwidth duration)), (), or (k,)."""
        return 0.5 / np.sqrt(self.bandwidth * self.duration)


def power_spectral_density(
    time: ArrayLike, acceleration: ArrayLike, *, discard: float = 0.0, resolution: float | None = None
) -> PowerSpectralDensity:
    """Return the one-sided power spectral density by Welch's method: Hann windows that overlap by half, means removed.

    Args:
        time: uniform instants [s], (n,).
        acceleration: [m/s^2], (n,), or (n, k) for k of them, each by itself.
        discard: length at the beginning that is left out [s]: until the response has settled.
        resolution: distance of the frequencies [Hz]: finer tells narrow peaks apart, coarser is more certain. Without it,
            that of 15 segments.

    Raises:
        ValueError: the samples are not uniform or not finite, or what is left is too short for the resolution.
    """
    values, step = check_samples(time, acceleration)
    discard = not_negative("discard", discard, unit="s")
    length = step * values.shape[0]
    kept = values[min(math.ceil(discard / step - 1e-9), values.shape[0]) :]
    remaining = step * kept.shape[0]
    size = int(2 * kept.shape[0] // (SEGMENTS + 1))
    if resolution is not None:
        size = round(1.0 / (positive("resolution", resolution, unit="Hz") * step))
    if size < LEAST_SAMPLES or size > kept.shape[0]:
        wanted = "" if resolution is None else f" at {resolution:.6g} Hz"
        least = LEAST_SAMPLES * step if resolution is None else max(1.0 / resolution, LEAST_SAMPLES * step)
        if size < LEAST_SAMPLES and resolution is not None and size <= kept.shape[0]:
            raise ValueError(
                f"`resolution` must leave at least {LEAST_SAMPLES} samples to a segment: at most "
                f"{1.0 / (LEAST_SAMPLES * step):.6g} Hz, got {resolution:.6g}."
            )
        raise ValueError(
            f"`time` is too short for a density{wanted}: of {length:.6g} s the first {discard:.6g} s do not count; at least "
            f"{discard + least:.6g} s are needed, several times that beyond the first to be certain of anything."
        )
    window = scipy.signal.windows.hann(size, sym=False)
    hop = size - size // 2
    segments = (kept.shape[0] - size) // hop + 1
    frequency, density = scipy.signal.welch(
        kept, fs=1.0 / step, window=window, noverlap=size // 2, detrend="constant", scaling="density", axis=0
    )
    # Two segments h apart are correlated by r = (sum w[t] w[t + h])^2 / (sum w^2)^2, and the mean of K of them has
    # 2 K / (1 + 2 sum (1 - j / K) r_j) degrees of freedom (Welch 1967, Percival and Walden 1993 section 6.17); for
    # half-overlapping Hann windows only r_1 = 1/36 counts.
    shared = float(window[hop:] @ window[: window.size - hop]) / float(window @ window)
    degrees = 2.0 * segments / (1.0 + 2.0 * (1.0 - 1.0 / segments) * shared**2)
    return PowerSpectralDensity(
        frequency=frequency, density=density, resolution=1.0 / (size * step), duration=remaining, segments=segments,
        degrees_of_freedom=degrees,
    )  # fmt: skip


Method = Literal["dirlik", "narrow-band"]
_POWERS = (0, 1, 2, 4)  # powers of the frequency in the moments that the rules of damage take
_PER_OCTAVE = 400  # Frequencies to an octave by which a density is integrated: 1e-4 of the moments of Q = 50
_ROUNDS, _DAMAGE_ERROR = 100, 1e-3  # Corrections of an equivalent density, and the relative error of its damage that ends them
_LEAST_LEVEL = 1e-6  # smallest level of an equivalent density, as a fraction of the largest
# half-power bandwidths on both sides of a resonance where the integral is split, so that the quadrature resolves the peak
_PEAK_WIDTHS = 40.0


def isolation_frequency(frequency: Array, transmissibility: Array) -> float:
    """Find the frequency [Hz] above which a transmissibility stays below 1; NaN if it is above 1 at the end, or nowhere.

    Both are (n,), in order along a curve that may turn back in frequency, joined by straight lines on logarithmic axes.
    """
    f, t = np.log(frequency), np.log(np.maximum(transmissibility, 1e-300))
    crossings = np.flatnonzero((t[:-1] >= 0.0) != (t[1:] >= 0.0))
    if crossings.size == 0 or t[int(np.argmax(f))] >= 0.0:
        return math.nan
    part = t[crossings] / (t[crossings] - t[crossings + 1])
    return float(np.exp((f[crossings] + part * (f[crossings + 1] - f[crossings])).max()))


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
        """Return the fatigue damage of a duration [s] at every frequency, (n,), by pseudo-velocity amplitudes A, with C = 1.

        Args:
            exponent: b of N = C / A^b, the cycles N to failure.
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
        # Dirlik's rainflow amplitudes: an exponential and two Rayleigh distributions, weighted by d1, d2 and d3.
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

    The squared transfer functions are integrated over the density segment by segment, each straight on logarithmic axes.

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
        if np.abs(least - 1.0).max() < _DAMAGE_ERROR:
            break
        levels = levels * least ** (-2.0 / b)
        levels = np.maximum(levels, _LEAST_LEVEL * levels.max())
    relative = relative_damage(levels)
    lack = min(1.0, float(relative.min()))  # what the corrections have left: damage goes with the level to the power b / 2
    return tuple(zip(corners.tolist(), (levels * lack ** (-2.0 / b)).tolist(), strict=True)), relative / lack


def _integrals(points: Points, natural: float, q: float) -> Array:
    """Return the moments of order 0, 1, 2, 4 of an oscillator's deflection and the mean square of its acceleration, (5,)."""
    total = np.zeros(len(_POWERS) + 1)
    splits = natural * (1.0 + _PEAK_WIDTHS * np.array([-1.0, 0.0, 1.0]) / q)
    for (f1, s1), (f2, s2) in zip(points[:-1], points[1:], strict=True):
        if f1 == f2:  # a step
            continue
        slope = math.log(s2 / s1) / math.log(f2 / f1)

        def density(f: float, *, start: float = f1, level: float = s1, slope: float = slope) -> float:
            ratio = f / natural
            return level * (f / start) ** slope / ((1.0 - ratio**2) ** 2 + (ratio / q) ** 2)

        def parts(f: float) -> Array:
            moments = [f**power * density(f) / (2.0 * math.pi * natural) ** 4 for power in _POWERS]
            return np.array([*moments, density(f) * (1.0 + (f / natural / q) ** 2)])

        ends = [f1, *(f for f in splits if f1 < f < f2), f2]
        for low, high in zip(ends[:-1], ends[1:], strict=True):
            total += [
                scipy.integrate.quad(lambda f, k: parts(f)[k], low, high, args=(k,), limit=200, epsabs=0.0, epsrel=1e-10)[0]
                for k in range(total.size)
            ]
    return total
