"""Logarithmic sine sweep of constant acceleration, velocity or displacement amplitude, by integrals that do not drift."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import as_times, the_one_given
from wirerope_mj.foundation.arrays import Array, ArrayLike, ComplexArray
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.doubts import doubt_of_swing
from wirerope_mj.motions.motion import Said, StraightMotion
from wirerope_mj.motions.phrases import SpokenMotion

# From here on thirty terms of the series are exact to 1e-15 of the leading one: 30! / 50^30 is 3e-19.
_SERIES_FROM = 50.0
_FACTORIALS = np.array([math.factorial(n) for n in range(30)], dtype=float)
_HARMONIC_FACTORIALS = _FACTORIALS * np.concatenate([[0.0], np.cumsum(1 / np.arange(1.0, 30.0))])
_FASTEST, _HIGHEST = 50.0, 5e3  # rate [octaves/min], five times what tests ask for, and the last [Hz] of IEC 60068-2-6
_FEW_FROM, _FEW_TERMS = 1000.0, 16  # u from which 16 terms give every bit of the sum: 16! / 1000^16 is 2e-35.
# Step of the double-exponential rule: measured error 4e-10 at 1/10, 5e-12 at 1/12, roundoff (2e-15) from 1/16 on.
# Its nodes run from where exp(-exp(4)) to where exp(-exp(3.8)) is below 1e-19.
_STEP = 1 / 16
_S = _STEP * np.arange(-64, 61)
_NODES = np.exp(_S - np.exp(-_S))
_WEIGHTS = _STEP * _NODES * (1 + np.exp(-_S)) * np.exp(-_NODES)


def oscillating_tail(u: Array, order: int) -> ComplexArray:
    """Return h1 (order 1) or h2 (order 2) of the integrals from u > 0, (n,), to infinity, without their fast factor e^(iu).

        int e^(is) / s ds          = e^(iu) h1(u)    (so e^(iu) h1 = E1(-iu) = -Ci(u) + i (pi/2 - Si(u)))
        int e^(is) ln(s/u) / s ds  = e^(iu) h2(u)    (the integral of the first one over ln u)

    On the path s = u + iy the oscillation becomes a decay,

        h1 = i int e^(-y) / (u + iy) dy,    h2 = i int e^(-y) ln(1 + iy/u) / (u + iy) dy,    y from 0 to infinity,

    which is expanded in -i/u where u is large and integrated by the double-exponential rule where it is not. Both
    tend to zero as u grows, which is what makes velocity and displacement of a sweep free of drift.
    """
    large = u >= _SERIES_FROM
    if large.all():  # as in every sweep but the slowest; the rule's sum costs as much for no argument as for many
        return _by_series(u, order)
    h, small = np.empty(u.shape, dtype=complex), u[~large]
    total = np.zeros(small.shape, dtype=complex)
    for y, weight in zip(_NODES, _WEIGHTS, strict=True):
        term = 1j * weight / (small + 1j * y)
        if order == 2:
            ratio = y / small
            term = term * (0.5 * np.log1p(ratio**2) + 1j * np.arctan(ratio))  # ln(1 + i ratio), exact for small ratios
        total += term
    h[large], h[~large] = _by_series(u[large], order), total
    return h


def _by_series(u: Array, order: int) -> ComplexArray:
    """Return h1 or h2 by series in q = -i/u: h1 = (i/u) sum n! q^n and h2 = -(i/u) sum n! (1 + 1/2 + ... + 1/n) q^n, (n,)."""
    factors = _FACTORIALS if order == 1 else _HARMONIC_FACTORIALS
    factors = factors[:_FEW_TERMS] if u.min(initial=np.inf) >= _FEW_FROM else factors
    q = -1j / u
    total = np.full(u.shape, factors[-1], dtype=complex)
    for factor in factors[-2::-1]:  # in place: as `polyval` has it, which takes new memory for every term
        total *= q
        total += factor
    return (1j if order == 1 else -1j) / u * total


@dataclass(frozen=True, kw_only=True)
class Course:
    """Frequency and phase of a logarithmic sweep over time.

    With w0 = 2 pi start, K = rate ln 2 / 60 and s = +1 (up) or -1 (down): w(t) = w0 e^(s K t), u = w/K, u0 = w0/K,
    phase = s (u - u0); from `duration` on the frequency stays at `stop`.
    """

    start: float  # frequency at time 0 [Hz]
    stop: float  # frequency at the end [Hz]
    rate: float  # sweep rate [octaves/min]

    @property
    def duration(self) -> float:
        """Instant at which the stop frequency is reached [s]."""
        return 60 * abs(math.log2(self.stop / self.start)) / self.rate

    @property
    def sign(self) -> float:
        return 1.0 if self.stop > self.start else -1.0

    @property
    def growth(self) -> float:
        """K: the relative growth of the frequency, either way [1/s]."""
        return self.rate * math.log(2) / 60

    @property
    def last(self) -> float:
        """Angular frequency at which the oscillation goes on after the sweep [rad/s]."""
        return 2 * math.pi * self.stop

    def within(self, t: Array) -> Array:
        """Return the times [s], those after the end of the sweep replaced by its end."""
        return np.minimum(t, self.duration)

    def frequency(self, t: Array) -> Array:
        """Return the frequency at the times [Hz]."""
        swept = self.start * np.exp(self.sign * self.growth * self.within(t))
        return np.where(t < self.duration, swept, self.stop)

    def omega(self, t: Array) -> Array:
        """Return the angular frequency at the times [rad/s]."""
        return 2 * math.pi * self.frequency(t)

    def u(self, within: Array) -> Array:
        """Return u = w/K, the angular frequency over its growth, at times up to the end of the sweep, (n_t,)."""
        return 2 * math.pi * self.start / self.growth * np.exp(self.sign * self.growth * within)

    def angle(self, within: Array) -> Array:
        """Return u - u0, the change of u = w/K since the start, at times up to the end of the sweep, without cancellation."""
        return 2 * math.pi * self.start / self.growth * np.expm1(self.sign * self.growth * within)

    def phase(self, t: Array) -> Array:
        """Return the phase [rad]."""
        within = self.within(t)
        return self.sign * self.angle(within) + self.last * (t - within)

    def whole_cycles(self) -> Array:
        """Return the instants at which the cycles that the sweep completes begin and end [s], (n + 1,)."""
        u0 = 2 * math.pi * self.start / self.growth
        turns = float(self.phase(np.array([self.duration]))[0]) / (2 * math.pi)
        count = math.floor(turns * (1 + 1e-12))  # a sweep of an integer number of cycles must not lose one by rounding
        passed = 2 * math.pi * self.sign * np.arange(count + 1) / u0
        return self.sign * np.log1p(passed) / self.growth


def _tail(course: Course, within: Array, order: int) -> ComplexArray:
    """Return e^(i (u - u0)) h1(u) for order 1 and e^(i (u - u0)) h2(u) for order 2, u and h1, h2 as in `Sweep`, (n_t,)."""
    return np.exp(1j * course.angle(within)) * oscillating_tail(course.u(within), order)


def _passes_end(course: Course, t: Array) -> bool:
    return bool((t > course.duration).any())


def _after(course: Course, t: Array, function: Callable[[Array], Array]) -> Array:
    """Return the change of `function` of the phase since the end of the sweep; zero before it."""
    return function(course.phase(t)) - function(course.phase(course.within(t)))


def _velocity_of_acceleration(course: Course, t: Array) -> Array:
    swept = -np.imag(_tail(course, course.within(t), 1)) / course.growth
    return swept - _after(course, t, np.cos) / course.last if _passes_end(course, t) else swept


def _displacement_of_acceleration(course: Course, t: Array) -> Array:
    within = course.within(t)
    swept = course.sign * np.imag(_tail(course, within, 2)) / course.growth**2
    if not _passes_end(course, t):
        return swept
    drift = _velocity_of_acceleration(course, within) + np.cos(course.phase(within)) / course.last
    return swept + drift * (t - within) - _after(course, t, np.sin) / course.last**2


def _displacement_of_velocity(course: Course, t: Array) -> Array:
    swept = course.sign * np.real(_tail(course, course.within(t), 1)) / course.growth
    return swept - _after(course, t, np.sin) / course.last if _passes_end(course, t) else swept


def _acceleration_of_displacement(course: Course, t: Array) -> Array:
    omega, phase = course.omega(t), course.phase(t)
    omega_rate = np.where(t < course.duration, course.sign * course.growth * omega, 0.0)
    return omega**2 * np.sin(phase) - omega_rate * np.cos(phase)


Form = Callable[[Course, Array], Array]
# by the quantity whose amplitude is constant: displacement, velocity and acceleration for an amplitude of 1
FORMS: dict[str, tuple[Form, Form, Form]] = {
    "acceleration": (_displacement_of_acceleration, _velocity_of_acceleration, lambda course, t: np.sin(course.phase(t))),
    "velocity": (
        _displacement_of_velocity, lambda course, t: -np.cos(course.phase(t)),
        lambda course, t: course.omega(t) * np.sin(course.phase(t)),
    ),
    "displacement": (
        lambda course, t: -np.sin(course.phase(t)), lambda course, t: -course.omega(t) * np.cos(course.phase(t)),
        _acceleration_of_displacement,
    ),
}  # fmt: skip


@dataclass(frozen=True, init=False)
class Sweep(StraightMotion):
    """Logarithmic sine sweep, up or down, of constant acceleration, velocity or displacement amplitude.

    With w0 = 2 pi start, K = rate ln 2 / 60, s = +1 (up) or -1 (down), and u = w/K, u0 = w0/K,

        w(t) = w0 e^(s K t),    phase = s (u - u0),

        acceleration A:  a = A sin(phase),   v = -(A/K) Im[e^(i (u - u0)) h1(u)],   x = s (A/K^2) Im[e^(i (u - u0)) h2(u)]
        velocity V:      a = V w sin(phase),   v = -V cos(phase),   x = s (V/K) Re[e^(i (u - u0)) h1(u)]
        displacement X:  a = X (w^2 sin(phase) - s K w cos(phase)),   v = -X w cos(phase),   x = -X sin(phase)

    where h1 and h2 are the integrals of `oscillating_tail`. They vanish for large u, so that the base starts on the steady
    oscillation, but for a fraction of the order of 1/u, and drifts nowhere.

    After `duration` the oscillation goes on at the stop frequency with neither velocity nor displacement jumping. A fraction of
    1/u stays as a slow drift, at 2 octaves/min and 30 Hz at most 1/8160 of the velocity amplitude; end a run where the sweep
    ends.

    Args:
        start: frequency at time 0 [Hz].
        stop: frequency at the end [Hz]; below `start` the sweep goes down.
        rate: sweep rate [octaves/min], positive in both directions.
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        acceleration: acceleration amplitude A [m/s^2]; exactly one of the three amplitudes is given.
        velocity: velocity amplitude V [m/s].
        displacement: displacement amplitude X [m], half of what runs from peak to peak.
    """

    kind: ClassVar[str] = "sweep"
    renamed: ClassVar[Mapping[str, str]] = dict.fromkeys(FORMS, "amplitude")
    phrases = (
        SpokenMotion(
            name="sweep", example="0.5 g 5 to 50 Hz 2 oct/min z",
            summary="logarithmic sine sweep: amplitude, frequencies, rate, direction.",
            needs={"acceleration": 1, "frequency": 2, "sweep rate": 1}, words={},
            make=lambda shape, phrase, direction, *_: shape(
                start=phrase.quantities["frequency"][0], stop=phrase.quantities["frequency"][1], direction=direction,
                rate=phrase.one("sweep rate"), acceleration=phrase.one("acceleration"),
            ),
        ),
    )  # fmt: skip

    start: float
    stop: float
    rate: float
    quantity: str
    amplitude: float
    direction: Direction
    duration: float

    def __init__(
        self, *, start: float, stop: float, rate: float, acceleration: float | None = None, velocity: float | None = None,
        displacement: float | None = None, direction: str | Sequence[float],
    ) -> None:  # fmt: skip
        self._set(start=ranges.frequency("start", start), stop=ranges.frequency("stop", stop))
        if self.start == self.stop:
            raise ValueError(f"`stop` must differ from `start`, got {self.stop!r} Hz for both; use Sine instead.")
        self._set(rate=ranges.sweep_rate("rate", rate))
        given = {"acceleration": acceleration, "velocity": velocity, "displacement": displacement}
        quantity, amplitude = the_one_given(given)
        self._set(quantity=quantity, amplitude=ranges.level(quantity, amplitude))
        self._set(direction=checked_direction(direction), duration=self.course.duration)

    @cached_property
    def course(self) -> Course:
        """Frequency and phase over time."""
        return Course(start=self.start, stop=self.stop, rate=self.rate)

    @property
    def doubt(self) -> str:
        """Question whether the unit of the rate or of the frequencies is another, if no test sweeps so; else ""."""
        if self.rate > _FASTEST:
            return f"{self.rate:.4g} octaves/min are faster than tests sweep: were {self.rate / 60.0:.3g} oct/min meant?"
        highest = max(self.start, self.stop)
        for frequency in (self.start, self.stop):
            per_peak = {
                "acceleration": 1.0,
                "velocity": 2.0 * math.pi * frequency,
                "displacement": (2.0 * math.pi * frequency) ** 2,
            }
            if doubt := doubt_of_swing(frequency, self.amplitude * per_peak[self.quantity]):
                return doubt
        return f"it reaches {highest:.4g} Hz, and tests end at 5000: are its frequencies in Hz?" if highest > _HIGHEST else ""

    def frequency(self, time: ArrayLike) -> Array:
        """Return the instantaneous frequency [Hz] at the times [s], (n_t,)."""
        return self.course.frequency(as_times(time))

    @property
    def corners(self) -> Array:
        return np.array([self.duration])

    @cached_property
    def _said(self) -> Said:
        """Describe the sweep, such as `sweep 0.1 to 30 Hz, 2 octaves/min, 0.1 g along z`, or `... 50 mm/s along z`."""
        course = f"sweep {self.start:.4g} to {self.stop:.4g} Hz, {self.rate:.4g} octaves/min"
        if self.quantity == "acceleration":
            level = f"{self.amplitude / STANDARD_GRAVITY:.4g} g"
        else:
            level = f"{1e3 * self.amplitude:.4g} {'mm/s' if self.quantity == 'velocity' else 'mm'}"
        text = f"{course}, {level} along {direction_text(self.direction)}"
        events = (0.0, f"sweep begins at {self.start:.4g} Hz"), (self.duration, f"sweep reaches {self.stop:.4g} Hz")
        return Said(text, events, shortest_time=1 / max(self.start, self.stop))

    def _along(self, t: Array, order: int) -> Array:
        return self.amplitude * FORMS[self.quantity][order](self.course, t)
