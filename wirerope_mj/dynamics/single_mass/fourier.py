"""The equation of motion of one mass on one isolator axis in the frequency domain, and Newton's method on it."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.single_mass.cycle import cycle_force, is_neutral
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import Law

_STEP = 1e-6
"""Differences of the Jacobian relative to the deflection: far above rounding, far below what bends the force."""

_ITERATIONS, _HALVINGS = 40, 8
"""Newton steps, and halvings of one: a good start needs five steps, and a step cut to 1/256 leads nowhere."""


@dataclass(frozen=True)
class Solution:
    """The point at which Newton's method stopped.

    Attributes:
        u: unknowns: the mean, the cosines, the sines [m], (2 H + 1,).
        residual: largest |R_k| over m a.
        iterations: steps taken.
    """

    u: Array
    residual: float
    iterations: int


class Balance:
    """The residual of the equation of motion in the frequency domain, for real unknowns u: the mean, the cosines, the sines."""

    def __init__(self, law: Law, mass: float, gravity: float, harmonics: int, samples: int) -> None:
        self.law, self.mass, self.gravity = law, mass, gravity
        self.harmonics, self.samples = harmonics, samples
        self.neutral = is_neutral(law)

    @property
    def orders(self) -> Array:
        """Order of each unknown, (2 H + 1,)."""
        k = np.arange(1.0, self.harmonics + 1.0)
        return np.concatenate([[0.0], k, k])

    def from_coefficients(self, c: npt.NDArray[np.complex128]) -> Array:
        """Return the unknowns of complex coefficients, those beyond them zero, (2 H + 1,)."""
        full = np.zeros(self.harmonics + 1, dtype=np.complex128)
        count = min(c.size, full.size)
        full[:count] = c[:count]
        return np.concatenate([full.real, -full.imag[1:]])

    def coefficients(self, u: Array) -> npt.NDArray[np.complex128]:
        """Return the complex coefficients c_k of the unknowns, (H + 1,)."""
        h = self.harmonics
        return np.concatenate([[u[0]], u[1 : h + 1] - 1j * u[h + 1 :]])

    def in_time(self, u: Array, omega: float, samples: int) -> tuple[Array, Array]:
        """Return deflection [m] and rate [m/s] at the samples of one period and its end, (samples + 1,)."""
        spectrum = np.zeros(samples // 2 + 1, dtype=np.complex128)
        c = self.coefficients(u)
        spectrum[: c.size] = 0.5 * samples * c
        spectrum[0] *= 2.0
        x = np.fft.irfft(spectrum, samples)
        v = np.fft.irfft(1j * omega * np.arange(spectrum.size) * spectrum, samples)
        return np.append(x, x[0]), np.append(v, v[0])

    def force(self, u: Array, omega: float) -> Array:
        """Return the harmonics of the law's force in the order of the unknowns [N], (2 H + 1,)."""
        x, v = self.in_time(u, omega, self.samples)
        f = cycle_force(self.law, x, v, period=2.0 * np.pi / omega)[:-1]
        spectrum = np.fft.rfft(f)[: self.harmonics + 1] * (2.0 / self.samples)
        return np.concatenate([[0.5 * spectrum[0].real], spectrum[1:].real, -spectrum[1:].imag])

    def residual(self, u: Array, omega: float, acceleration: float) -> Array:
        """Return R over m a, (2 H + 1,); of a law without a preferred position the first is its mean deflection's."""
        r = self.force(u, omega) - (self.orders * omega) ** 2 * self.mass * u
        r[self.harmonics + 1] += self.mass * acceleration
        r[0] = u[0] * self.mass * omega**2 if self.neutral else r[0] + self.mass * self.gravity
        return r / (self.mass * acceleration)

    def jacobian(self, u: Array, omega: float, acceleration: float, residual: Array) -> Array:
        """Return dR/du by differences, (2 H + 1, 2 H + 1)."""
        step = _STEP * max(float(np.abs(u[1:]).max()), acceleration / omega**2 * 1e-3)
        columns = []
        for i in range(u.size):
            moved = u.copy()
            moved[i] += step
            columns.append((self.residual(moved, omega, acceleration) - residual) / (moved[i] - u[i]))
        return np.array(columns).T


def newton(balance: Balance, u: Array, omega: float, acceleration: float, tolerance: float) -> Solution:
    """Return the end of Newton's method with halved steps from `u`, converged or not."""
    residual = balance.residual(u, omega, acceleration)
    for iteration in range(_ITERATIONS):
        size = float(np.abs(residual).max())
        if size <= tolerance or not np.isfinite(size):
            return Solution(u, size if np.isfinite(size) else np.inf, iteration)
        jacobian = balance.jacobian(u, omega, acceleration, residual)
        if not np.isfinite(jacobian).all():
            return Solution(u, size, iteration)
        step = np.linalg.lstsq(jacobian, -residual, rcond=None)[0]
        for _ in range(_HALVINGS):
            trial = balance.residual(u + step, omega, acceleration)
            # The norm of all of them: the largest alone may have to grow.
            if np.linalg.norm(trial) < np.linalg.norm(residual):
                break
            step *= 0.5
        else:
            return Solution(u, size, iteration)
        u, residual = u + step, trial
    return Solution(u, float(np.abs(residual).max()), _ITERATIONS)
