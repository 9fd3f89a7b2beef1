"""Stationary random vibration of a given power spectral density."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import ClassVar, Literal, get_args

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import integer, one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction
from wirerope_mj.foundation.summary import AsCall
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.envelope import Envelope, check_room, random_amplitudes, random_phases, usual_ramp
from wirerope_mj.motions.motion import Said, StartedMotion
from wirerope_mj.motions.phrases import LASTING, SpokenMotion, file_first, vibration_arguments
from wirerope_mj.motions.piecewise import UniformSpline
from wirerope_mj.motions.psd_lines import checked_points, doubt_of_rms, flat_psd, psd_points, psd_power, psd_rms

Amplitudes = Literal["fixed", "random"]
_DEGREES = {"quintic": 5, "cubic": 3}
KNOTS_PER_PERIOD = 8  # knots of the acceleration in a period of the highest frequency
MOST_POINTS = 1e8  # points of a random vibration: a gigabyte, more than an hour up to 2 kHz


@dataclass(frozen=True, kw_only=True, repr=False)
class RandomVibration(AsCall, StartedMotion):
    """Gaussian vibration of a power spectral density, between a smooth rise from rest and a smooth fall back to it.

    The displacement is a sum of sines of all frequencies k/T in the band with independent random phases, T being the duration
    or a little more, times the envelope. With `amplitudes="fixed"` each sine carries the power of its band 1/T, so that rms and
    density are those asked for in every motion, as a controlled shaker has them, and only the phases are random: the rms of a
    response over a time t scatters from seed to seed with sqrt(1 - t/T) of what Gaussian noise gives. With
    `amplitudes="random"` they are of Rayleigh's distribution with that power in the mean. Such a motion is a segment of a true
    Gaussian process: its rms, and that of a response, scatter by 1/(2 sqrt(B t)), B being the bandwidth.

    The displacement is kept as a spline of degree 5, whose acceleration is one of degree 3 through knots, 8 in a period of the
    highest frequency. What the spline takes from a sine is given back to it beforehand, so the density holds within the band;
    what is left of the segments are images beyond seven times the highest frequency, at most 0.04 % of the amplitude of the
    sines that cause them. At the knots alone, where all images add up, the density at the highest frequency is 0.12 % high.
    Velocity and displacement have no drift, and are zero before the start and after the end.

    Memory is 8 bytes a knot: 80 MB for 10 minutes up to 2000 Hz. The phases are taken from a seed by a generator whose
    stream is the same everywhere; motions of different seeds are independent, those of the same seed, density and duration
    in different directions move together.
    """

    kind: ClassVar[str] = "random-vibration"
    phrases = (
        SpokenMotion(
            name="psd", example="transport.csv 30 s z seed 1",
            summary='random vibration of a file with "frequency [Hz], psd [g^2/Hz]".',
            needs={"time": 1}, says_more=True, words=LASTING, begins=file_first(psd_points),
            make=lambda shape, phrase, direction, n, points: shape(psd=points, **vibration_arguments(phrase, direction, n)),
        ),
        SpokenMotion(
            name="random", example="1 g rms 5 to 200 Hz 30 s z seed 1",
            summary="random vibration of one density over a band: rms, lowest and highest frequency, length.",
            needs={"acceleration": 1, "frequency": 2, "time": 1}, words=LASTING,
            begins=lambda text, _: (None, re.sub(r"(?<=\dg)rms\b|(?<= g)rms\b|\brms\b", "", text)),
            make=lambda shape, phrase, direction, n, _: shape(
                psd=flat_psd(phrase.one("acceleration"), *phrase.quantities["frequency"]),
                **vibration_arguments(phrase, direction, n),
            ),
        ),
    )  # fmt: skip

    #: points (frequency [Hz], level [(m/s^2)^2/Hz]) with straight lines between them on logarithmic axes, and a step at two of
    #: one frequency; zero outside. `psd_from_g` makes them from g^2/Hz
    psd: Sequence[Sequence[float]]
    duration: float  #: length of the vibration with rise and fall [s]
    seed: int  #: integer >= 0 that chooses the phases, and the amplitudes if they are random
    direction: Direction  #: `"x"`, `"y"`, `"z"` or a 3-vector
    #: length of the rise [s], at least a period of the lowest frequency; None: ten such periods, or a tenth of the duration if
    #: that is shorter
    rise: float = None  # type: ignore[assignment]
    fall: float = None  # type: ignore[assignment]  #: the same for the fall
    start: float = 0.0  #: instant at which the vibration begins [s]
    amplitudes: Amplitudes = "fixed"  #: or "random", see above; the phases of a seed are the same in both
    #: of the displacement; "cubic" as versions before 0.2.1 had it: acceleration in straight lines, at knots up to 11 % high in
    #: density
    spline: Literal["quintic", "cubic"] = "quintic"

    def __post_init__(self) -> None:
        self._set(psd=checked_points("psd", self.psd, quantity="level", steps=True))
        self._set(duration=ranges.length("duration", self.duration))
        self._set(seed=integer("seed", self.seed, least=0), direction=checked_direction(self.direction))
        for name, length in (("rise", self.rise), ("fall", self.fall)):
            self._set(**{name: usual_ramp(name, length, lowest=self.psd[0][0], duration=self.duration)})
        check_room(self.duration, self.rise, self.fall)
        self._set(start=ranges.start("start", self.start))
        one_of("amplitudes", self.amplitudes, get_args(Amplitudes))
        one_of("spline", self.spline, _DEGREES)

    @classmethod
    def maker(cls) -> "Callable[..., RandomVibration]":
        """Return the constructor with the cubic spline, which versions that stored no `spline` used."""
        return partial(cls, spline="cubic")

    @property
    def rms(self) -> float:
        """Rms acceleration between rise and fall [m/s^2], of the density; the rms of random amplitudes scatters about it."""
        return psd_rms(self.psd)

    @property
    def doubt(self) -> str:
        """Question whether the unit of the density is wrong, if its rms is above 50 g; else ""."""
        return doubt_of_rms(self.rms)

    @property
    def steady(self) -> tuple[float, float]:
        """Instants between which the vibration is stationary [s]."""
        return self.start + self.rise, self.end - self.fall

    @property
    def corners(self) -> Array:
        """Every knot [s], (n,): the third derivative of the acceleration jumps there, with a cubic spline the first."""
        return self.start + self._spacing * np.arange(self._intervals + 1.0)

    @cached_property
    def _said(self) -> Said:
        """Describe the vibration in a line, such as `random 20 to 2000 Hz, 7.69 g rms, 60 s, seed 1 along z`."""
        level = f"{self.psd[0][0]:.4g} to {self.psd[-1][0]:.4g} Hz, {self.rms / STANDARD_GRAVITY:.4g} g rms"
        seed = f"seed {self.seed}" + (", random amplitudes" if self.amplitudes == "random" else "")
        full, falls = self.steady
        events = (
            (self.start, "random vibration begins"), (full, f"full level, {self.rms / STANDARD_GRAVITY:.4g} g rms"),
            (falls, "vibration falls"), (self.end, "random vibration ends"),
        )  # fmt: skip
        return Said(
            f"random {level}, {self.duration:.4g} s, {seed} {self._line_text}", events, shortest_time=1 / self.psd[-1][0]
        )

    @property
    def _intervals(self) -> int:
        """Number of intervals between knots, 8 in a period of the highest frequency; ValueError if they are too many."""
        points = self.duration * self.psd[-1][0] * KNOTS_PER_PERIOD
        if points > MOST_POINTS:
            raise ValueError(
                f"`duration` of {self.duration:.4g} s with up to {self.psd[-1][0]:.4g} Hz takes {points:.3g} points, "
                f"more than {MOST_POINTS:.0g}. Make it shorter; a repeated one adds nothing to the density."
            )
        return math.ceil(points)

    @property
    def _spacing(self) -> float:
        return self.duration / self._intervals

    @cached_property
    def _curve(self) -> UniformSpline:
        """Displacement [m]: inverse FFT of all sines, times the envelope, as coefficients of a spline."""
        h, knots, degree = self._spacing, self._intervals + 1, _DEGREES[self.spline]
        period = scipy.fft.next_fast_len(knots, real=True)
        width = 1 / (period * h)  # of the band of one line [Hz]
        first, last = (round(frequency / width) for frequency in (self.psd[0][0], self.psd[-1][0]))
        frequency = width * np.arange(first, last + 1)
        edges = width * (np.arange(first, last + 2) - 0.5)
        amplitude = np.sqrt(2 * np.diff(psd_power(self.psd, edges)))
        if self.amplitudes == "random":
            amplitude *= random_amplitudes(self.seed, amplitude.size)
        # A sine in the coefficients comes out as sinc^(degree + 1) of itself, and its acceleration is -w^2 times that.
        amplitude /= (2 * np.pi * frequency) ** 2 * np.sinc(frequency * h) ** (degree + 1)
        lines = np.zeros(period // 2 + 1, dtype=complex)
        lines[first : last + 1] = period / 2 * amplitude * np.exp(1j * random_phases(self.seed, amplitude.size))
        coefficients = scipy.fft.irfft(lines, period, overwrite_x=True)[:knots]
        # Two knots inside start and end (one for a cubic), so that the three (two) outermost coefficients there are zero.
        edge = degree // 2
        inner = Envelope(start=edge * h, stop=self.duration - edge * h, rise=self.rise, fall=self.fall)
        rising, falling = math.ceil(self.rise / h) + edge + 1, knots - math.ceil(self.fall / h) - edge - 1
        for first, last in ((0, rising), (max(falling, rising), knots)):
            coefficients[first:last] *= inner.derivatives(h * np.arange(float(first), float(last)))[0]
        return UniformSpline(self.start, h, coefficients, degree=degree)

    def _along(self, t: Array, order: int) -> Array:
        return self._curve.derivative(t, order)
