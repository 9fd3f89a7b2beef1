"""Course of a logarithmic sweep, and its motion for an amplitude that is constant in acceleration, velocity or displacement."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.sweep_integrals import oscillating_tail


@dataclass(frozen=True, kw_only=True)
class Course:
    """Frequency and phase of a logarithmic sweep over time.

    With w0 = 2 pi start, K = rate ln 2 / 60 and s = +1 (up) or -1 (down): w(t) = w0 e^(s K t), u = w/K, u0 = w0/K,
    phase = s (u - u0); from `duration` on the frequency stays at `stop`.

    Args:
        start: frequency at time 0 [Hz].
        stop: frequency at the end [Hz].
        rate: sweep rate [octaves/min].
    """

    start: float
    stop: float
    rate: float

    @property
    def duration(self) -> float:
        """Instant at which the stop frequency is reached [s]."""
        return 60 * abs(math.log2(self.stop / self.start)) / self.rate

    @property
    def sign(self) -> float:
        """s: 1 for a sweep up, -1 for a sweep down."""
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
        """Return u at times up to the end of the sweep."""
        return 2 * math.pi * self.start / self.growth * np.exp(self.sign * self.growth * within)

    def angle(self, within: Array) -> Array:
        """Return u - u0 at times up to the end of the sweep, taken without cancellation."""
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


def _tail(course: Course, within: Array, order: int) -> NDArray[np.complex128]:
    """Return e^(i (u - u0)) h1(u) for order 1 and e^(i (u - u0)) h2(u) for order 2."""
    return np.exp(1j * course.angle(within)) * oscillating_tail(course.u(within), order)


def _ends(course: Course, t: Array) -> bool:
    """Return whether the sweep is over at one of the times: until then nothing is added to it."""
    return bool((t > course.duration).any())


def _after(course: Course, t: Array, function: Callable[[Array], Array]) -> Array:
    """Return how far `function` of the phase has gone from its value at the end of the sweep; zero until then."""
    return function(course.phase(t)) - function(course.phase(course.within(t)))


def _velocity_of_acceleration(course: Course, t: Array) -> Array:
    swept = -np.imag(_tail(course, course.within(t), 1)) / course.growth
    return swept - _after(course, t, np.cos) / course.last if _ends(course, t) else swept


def _displacement_of_acceleration(course: Course, t: Array) -> Array:
    within = course.within(t)
    swept = course.sign * np.imag(_tail(course, within, 2)) / course.growth**2
    if not _ends(course, t):
        return swept
    drift = _velocity_of_acceleration(course, within) + np.cos(course.phase(within)) / course.last
    return swept + drift * (t - within) - _after(course, t, np.sin) / course.last**2


def _displacement_of_velocity(course: Course, t: Array) -> Array:
    swept = course.sign * np.real(_tail(course, course.within(t), 1)) / course.growth
    return swept - _after(course, t, np.sin) / course.last if _ends(course, t) else swept


def _acceleration_of_displacement(course: Course, t: Array) -> Array:
    omega, phase = course.omega(t), course.phase(t)
    quickening = np.where(t < course.duration, course.sign * course.growth * omega, 0.0)
    return omega**2 * np.sin(phase) - quickening * np.cos(phase)


Form = Callable[[Course, Array], Array]

# by the quantity whose amplitude is constant: displacement, velocity and acceleration for an amplitude of 1
FORMS: dict[str, tuple[Form, Form, Form]] = {
    "acceleration": (
        _displacement_of_acceleration,
        _velocity_of_acceleration,
        lambda course, t: np.sin(course.phase(t)),
    ),
    "velocity": (
        _displacement_of_velocity,
        lambda course, t: -np.cos(course.phase(t)),
        lambda course, t: course.omega(t) * np.sin(course.phase(t)),
    ),
    "displacement": (
        lambda course, t: -np.sin(course.phase(t)),
        lambda course, t: -course.omega(t) * np.cos(course.phase(t)),
        _acceleration_of_displacement,
    ),
}
