"""Shock response spectra: the largest responses of oscillators of all frequencies to an acceleration."""

import math
import warnings
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.budget import require_memory, require_time
from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.foundation.exports import Exported
from wirerope_mj.foundation.summary import Brief, Summarised, quantity, span
from wirerope_mj.motions.spectra.ramp import (
    ACCELERATION,
    DISPLACEMENT,
    EXTREMES,
    VELOCITY,
    check_samples,
    octave_grid,
    ramp_extremes,
)

# ISO 18431-4's least number of samples per period of the highest oscillator: straight lines between the samples then lack at
# most 3 % (sinc^2 of a tenth) of a sine of that frequency
SAMPLES_PER_PERIOD = 10.0
OSCILLATOR = 1e-8  # time of a step of an oscillator at the least [s]
OF_A_LINE = 3 * 128.0  # bytes of a line: exponentials, (4, 4), and what they are made of
HALVINGS, TERMS = 4, 18  # of the series of an exponential: what is left out of a norm of 10 is 1e-20
LOWEST_FREQUENCY = 1.0  # first of the default frequencies [Hz], below what equipment on isolators answers with
_QUANTITIES = (
    ("acceleration/positive", "m/s^2", lambda s: s.acceleration.positive),
    ("acceleration/negative", "m/s^2", lambda s: s.acceleration.negative),
    ("acceleration/maximax", "m/s^2", lambda s: s.acceleration.maximax),
    ("relative_displacement/maximax", "m", lambda s: s.displacement.maximax),
    ("pseudo_velocity/maximax", "m/s", lambda s: 2.0 * np.pi * s.frequencies[:, None] * s.displacement.maximax),
)


@dataclass(frozen=True, kw_only=True, repr=False)
class Extremes(Brief):
    """Largest magnitudes of a quantity of oscillators, (n_f,) or (n_f, k)."""

    positive: Array  # in the positive and in the negative direction
    negative: Array
    primary: Array  # the larger of both while the base accelerates
    residual: Array  # the larger of both afterwards, when the base's acceleration is zero

    @property
    def maximax(self) -> Array:
        """Largest magnitude of either sign."""
        return np.maximum(self.positive, self.negative)

    @classmethod
    def of(cls, during: Array, after: Array, quantity: int, scale: float) -> "Extremes":
        """Return the magnitudes of a quantity from its highest and lowest values while the base moves and after, (6, ...)."""
        high, low = quantity, quantity + 1
        return cls(
            positive=scale * np.maximum(during[high], after[high]), negative=-scale * np.minimum(during[low], after[low]),
            primary=scale * np.maximum(during[high], -during[low]), residual=scale * np.maximum(after[high], -after[low]),
        )  # fmt: skip


def _of_acceleration(name: str, which: str) -> Any:
    doc = f"Largest absolute acceleration {which} [m/s^2]."
    return property(lambda self: getattr(self.acceleration, name), doc=doc)


@dataclass(frozen=True, kw_only=True, repr=False)
class ShockResponseSpectrum(Summarised):
    """Peaks of oscillators on a base that moves with an acceleration, over their undamped frequency (ISO 18431-4).

    All are magnitudes, (n_f,) for one acceleration, (n_f, k) for k of them side by side.
    """

    frequencies: Array  #: of the oscillators [Hz], (n_f,)
    acceleration: Extremes  #: absolute acceleration of the mass [m/s^2]
    #: of the mass from the base [m]; times 2 pi f the pseudo-velocity of either sign and phase, times its square the
    #: equivalent static acceleration
    displacement: Extremes
    velocity: Extremes  #: of the mass relative to the base [m/s]
    q: float  #: amplification at resonance, 1 / (2 zeta); infinite = undamped

    positive = _of_acceleration("positive", "in the positive direction")
    negative = _of_acceleration("negative", "in the negative direction")
    primary = _of_acceleration("primary", "while the base accelerates")
    residual = _of_acceleration("residual", "afterwards")
    maximax = _of_acceleration("maximax", "of all")

    @property
    def relative_displacement(self) -> Array:
        """Largest displacement of the mass from the base [m]."""
        return self.displacement.maximax

    def _summary(self) -> tuple[str, dict[str, str]]:
        peak = np.unravel_index(int(np.argmax(self.maximax)), self.maximax.shape)
        return f"ShockResponseSpectrum, Q = {self.q:.4g}", {
            "frequencies": f"{span((self.frequencies[0], self.frequencies[-1]), 'Hz')}, {self.frequencies.size} of them",
            "largest acceleration": f"{quantity(self.maximax[peak], 'm/s^2')} at {self.frequencies[peak[0]]:.4g} Hz",
            "largest pseudo-velocity": f"{self.pseudo_velocity.max():.4g} m/s",
        }

    @property
    def pseudo_velocity(self) -> Array:
        """2 pi f times the relative displacement [m/s]."""
        return 2.0 * math.pi * self.frequencies.reshape((-1,) + (1,) * (self.maximax.ndim - 1)) * self.relative_displacement


def shock_response_spectrum(
    time: ArrayLike, acceleration: ArrayLike, frequencies: ArrayLike | None = None, *, q: float = 10.0
) -> ShockResponseSpectrum:
    """Return the shock response spectrum of a sampled acceleration.

    Every oscillator, u'' + 2 zeta w u' + w^2 u = -x with the absolute acceleration y = -(w^2 u + 2 zeta w u'), starts at
    rest and is solved exactly for a base acceleration x that is straight between the samples: the ramp-invariant filter of
    Smallwood (1981) and ISO 18431-4, written in u and u', which keeps its digits where the filter's own coefficients
    cancel (f T below 1e-5). Peaks between the samples come from the cubic through values and slopes; the vibration after
    the end is taken in closed form, so that no zeros need to follow the record. The base accelerates from the first sample
    to the last that is not zero (and its way back to zero if zeros follow); before and after it does not.

    Args:
        time: uniform instants [s], (n,).
        acceleration: of the base of the oscillators [m/s^2], (n,), or (n, k) for k of them, each by itself. For the
            spectrum that equipment exerts on what stands in it, the acceleration of the equipment.
        frequencies: of the oscillators [Hz], (n_f,). Without them twelve to an octave from 1 Hz, or from a tenth of one over
            the record's length if that is higher, to a tenth of the sampling rate.
        q: amplification at resonance, 1 / (2 zeta) > 0.5; `math.inf` is undamped.

    Raises:
        ValueError: the samples are not uniform, not finite or fewer than two, or a frequency is not between 0 and half the
            sampling rate.

    Warns:
        RecordWarning: a frequency is above a tenth of the sampling rate.
    """
    values, step = check_samples(time, acceleration)
    wanted = _frequencies(frequencies, step, values.shape[0])
    if not (isinstance(q, Real) and q > 0.5):
        raise ValueError(f"`q` must be a number > 0.5 (below critical damping; infinite: undamped), got {q!r}.")
    damping = 0.5 / q
    channels = values.reshape(values.shape[0], -1).T
    primary, residual = np.zeros((2, channels.shape[0], wanted.size, EXTREMES))
    what, remedy = f"a shock response spectrum of {wanted.size} lines", "Ask for fewer `frequencies`."
    require_time(f"{what} over {values.shape[0]} samples", float(values.size) * wanted.size, remedy, step=OSCILLATOR)
    require_memory(what, OF_A_LINE * wanted.size, remedy)
    angles = 2.0 * math.pi * wanted * step
    steps = ramp_steps(angles, damping)
    for i, channel in enumerate(channels):
        moving = np.flatnonzero(channel)  # up to the first of the zeros that end the record
        driven = np.ascontiguousarray(channel[: int(moving[-1]) + 2 if moving.size else 1])
        for j, angle in enumerate(angles):
            ramp_extremes(driven, steps[j], angle, damping, primary[i, j], residual[i, j])
    # (n_f,) or (n_f, k), the extremes in front
    shape = (EXTREMES, wanted.size, *values.shape[1:])
    during, after = (phase.transpose(2, 1, 0).reshape(shape) for phase in (primary, residual))
    return ShockResponseSpectrum(
        frequencies=wanted, acceleration=Extremes.of(during, after, ACCELERATION, scale=1.0),
        displacement=Extremes.of(during, after, DISPLACEMENT, scale=step**2),
        velocity=Extremes.of(during, after, VELOCITY, scale=step), q=float(q),
    )  # fmt: skip


def _frequencies(frequencies: ArrayLike | None, step: float, samples: int) -> Array:
    """Return the checked frequencies [Hz], or the default frequencies for None."""
    rate = 1.0 / step
    highest = rate / SAMPLES_PER_PERIOD
    if frequencies is None:
        return octave_grid(min(max(LOWEST_FREQUENCY, 0.1 * rate / (samples - 1)), highest), highest)
    wanted = np.atleast_1d(np.asarray(frequencies, dtype=np.float64))
    if wanted.ndim != 1 or not wanted.size:
        raise ValueError(f"`frequencies` must be a row of numbers [Hz], got the shape {wanted.shape}.")
    if not (np.isfinite(wanted).all() and (wanted > 0.0).all()):
        raise ValueError(f"`frequencies` must be finite and > 0 Hz, got {wanted.min():.6g} to {wanted.max():.6g}.")
    if wanted.max() > 0.5 * rate:
        raise ValueError(
            f"`frequencies` reach {wanted.max():.6g} Hz, but samples at {rate:.6g} Hz hold nothing above {0.5 * rate:.6g} Hz; "
            f"ask up to {highest:.6g} Hz, a tenth of the sampling rate."
        )
    if wanted.max() > highest * (1.0 + 1e-9):  # a grid may end on the tenth itself, up to rounding
        warnings.warn(
            f"`frequencies` reach {wanted.max():.6g} Hz: above {highest:.6g} Hz, a tenth of the sampling rate {rate:.6g} Hz, "
            "what the acceleration did between the samples is missing and the spectrum comes out low.",
            RecordWarning,
            stacklevel=3,
        )
    return wanted


def ramp_steps(angles: Array, damping: float) -> Array:
    """Return the matrices (n_f, 2, 4) that give displacement and rate of oscillators at the end of a step of the record.

    They multiply displacement and rate at its start, and the base's accelerations at both ends; `angles` are omega times the
    step [rad], (n_f,); time is counted in steps. From the exponential of the oscillator with the ramp as two more states: no
    coefficient is a difference of large numbers. Its norm is at most about 10, and it is the series of a sixteenth, squared
    four times: as exact as SciPy's `expm` to a few roundings, without the threads of a linear algebra library, which wait for
    each other for far longer than this takes where all cores are busy.
    """
    rates = np.zeros((angles.size, 4, 4))
    rates[:, 0, 1] = 1.0
    rates[:, 1, 0] = -(angles**2)
    rates[:, 1, 1] = -2.0 * damping * angles
    rates[:, 1, 2] = -1.0
    rates[:, 2, 3] = 1.0  # the acceleration and its rise over the step
    small = rates / 2.0**HALVINGS
    total = np.eye(4) + small / TERMS
    for term in range(TERMS - 1, 0, -1):
        total = np.eye(4) + np.einsum("nij,njk->nik", small, total) / term
    for _ in range(HALVINGS):
        total = np.einsum("nij,njk->nik", total, total)
    steps = total[:, :2, :]
    steps[:, :, 2] -= steps[:, :, 3]
    return np.ascontiguousarray(steps)


_LINE_ERROR = 0.01  # largest relative error of a line that the samples resolve
_COARSER = (2, 3)  # spectra of every second and every third sample are compared


def resolved_frequency(time: Array, acceleration: Array, spectrum: ShockResponseSpectrum) -> float:
    """Return the frequency [Hz] up to which the sampling resolves its spectrum within 1 %; 0 where it resolves no line.

    Errors of samples, of straight lines between them and of what is faster than they can tell, fall with the square of the rate
    as a rule, and by chance do not: lines hold up to the first that every other sample changes by more than 1 %, or every third
    by as much as goes with that, and to a twentieth of the rate at most. Of a pulse of six samples all three have the same
    area, wherever its edges lie between them: so what the two sharpest corners may add to it, a twelfth of a step times the
    change of slope there, must be less than 1 % of the line, too. Instants are uniform [s], (n,), accelerations (n,) or (n, k).
    """
    rate = (time.size - 1) / float(time[-1] - time[0])
    lines = spectrum.frequencies[spectrum.frequencies <= 0.5 * rate / SAMPLES_PER_PERIOD]
    fine = spectrum.maximax[: lines.size]
    if time.size < 2 * max(_COARSER) or not fine.any():  # a short pulse may fall between all samples
        return 0.0
    within = np.ones_like(fine, dtype=bool)
    for every in _COARSER:
        coarse_lines = lines[lines <= rate / (SAMPLES_PER_PERIOD * every)]
        if not coarse_lines.size:
            continue
        coarse = shock_response_spectrum(time[::every], acceleration[::every], coarse_lines, q=spectrum.q).maximax
        allowed = _LINE_ERROR * (every**2 - 1.0) / 3.0 * np.abs(fine[: coarse_lines.size])
        within[: coarse_lines.size] &= np.abs(coarse - fine[: coarse_lines.size]) <= allowed
    corners = np.sort(np.abs(np.diff(acceleration, 2, axis=0)), axis=0)[-2:].sum(axis=0) / (12.0 * rate)
    pulsation = 2.0 * math.pi * lines.reshape((-1,) + (1,) * (fine.ndim - 1))
    within &= pulsation * corners <= _LINE_ERROR * fine
    if fine.ndim > 1:  # a direction in which next to nothing moves holds nothing up
        within = (within | (fine <= 1e-6 * fine.max())).all(axis=1)
    return float(lines[np.flatnonzero(~within)[0] - 1] if not within.all() else lines[-1]) if within[0] else 0.0


def exported_spectra(spectrum: ShockResponseSpectrum) -> Exported:
    """Return spectra of accelerations (n, 3) along x, y, z as a table: frequency, then each quantity along each axis."""
    names, units, columns = ["frequency"], ["Hz"], [spectrum.frequencies]
    for place, axis in enumerate("xyz"):
        for name, unit, values in _QUANTITIES:
            names.append(f"{axis}/{name}")
            units.append(unit)
            columns.append(values(spectrum)[:, place])
    about = {"spectrum": "shock response, ISO 18431-4", "q": f"{spectrum.q:g}"}
    return Exported(names=names, units=units, column=columns.__getitem__, blocks=lambda: iter([columns]), about=about)
