"""Harmonic balance of one mass on one isolator axis: periodic motions by alternating between frequency and time.

    m (d'' + a sin w t) = -F(d) - m g,      d = sum over k <= H of Re[c_k exp(i k w t)]

The unknowns are the Fourier coefficients of the deflection alone. Its samples in time are followed by the law's own exact steps
until the cycle closes; the Fourier coefficients of that force stand in the equation of motion,

    R_k = -(k w)^2 m c_k + F_k - i m a [k = 1] + m g [k = 0]

and Newton's method makes the retained ones zero. Wong, Ni and Lau (1994) carry the hysteretic force as further unknowns and
balance the constitutive equation too, whose kinks then limit the convergence. Followed in time, a force whose second derivative
jumps at reversals has coefficients that fall as k^-3, those of the deflection fall as k^-5, and the tips as H^-4.

No engine and no shooting here: it is an independent check of both.
"""

from dataclasses import dataclass, field
from itertools import chain

import numpy as np

from wirerope_mj.dynamics.single_mass.cycle import cycle_force, is_neutral, largest, steady_cycle
from wirerope_mj.dynamics.single_mass.equivalent import linearised_orbits, require_oscillator
from wirerope_mj.foundation.arguments import integer
from wirerope_mj.foundation.arrays import Array, ArrayLike, ComplexArray
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.summary import Summarised, quantity, span
from wirerope_mj.mounts.laws import Law

# Steps of the Jacobian's difference quotients over the deflection: far above rounding, far below the curvature of the force.
_STEP = 1e-6
# Most Newton steps, and halvings of a step: a good start needs five steps, and a step cut to 1/256 is given up.
_ITERATIONS, _HALVINGS = 40, 8
# Samples of the cycle whose extremes are read: a smooth extreme between two samples is missed by 7e-8 of itself.
_FINE = 8192
# Fraction of the acceleration at which raising it from small excitations begins, where every law is close to a spring.
_SMALLEST_LEVEL = 1e-3


@dataclass(frozen=True)
class Solution:
    """Unknowns at which Newton's method stopped, and their residual."""

    u: Array  # unknowns: the mean, the cosines, the sines [m], (2 H + 1,)
    residual: float  # largest |R_k| over m a
    iterations: int  # steps taken


class Balance:
    """The residual of the equation of motion in the frequency domain, for real unknowns u: the mean, the cosines, the sines."""

    def __init__(self, law: Law, mass: float, gravity: float, harmonics: int, samples: int) -> None:
        self.law, self.mass, self.gravity = law, mass, gravity
        self.harmonics, self.samples = harmonics, samples
        self.neutral = is_neutral(law)
        k = np.arange(1.0, harmonics + 1.0)
        self.orders = np.concatenate([[0.0], k, k])  # harmonic order of each unknown, (2 H + 1,)

    def from_coefficients(self, c: ComplexArray) -> Array:
        """Write complex coefficients as unknowns, (2 H + 1,); missing coefficients are zero."""
        full = np.zeros(self.harmonics + 1, dtype=np.complex128)
        count = min(c.size, full.size)
        full[:count] = c[:count]
        return np.concatenate([full.real, -full.imag[1:]])

    def coefficients(self, u: Array) -> ComplexArray:
        """Write the unknowns as complex coefficients c_k, (H + 1,)."""
        return np.concatenate([[u[0]], u[1 : self.harmonics + 1] - 1j * u[self.harmonics + 1 :]])

    def in_time(self, u: Array, omega: float, samples: int) -> tuple[Array, Array]:
        """Evaluate deflection [m] and rate [m/s] at the samples of one period and its end, (samples + 1,)."""
        spectrum = np.zeros(samples // 2 + 1, dtype=np.complex128)
        c = self.coefficients(u)
        spectrum[: c.size] = 0.5 * samples * c
        spectrum[0] *= 2.0
        x = np.fft.irfft(spectrum, samples)
        v = np.fft.irfft(1j * omega * np.arange(spectrum.size) * spectrum, samples)
        return np.append(x, x[0]), np.append(v, v[0])

    def force(self, u: Array, omega: float) -> Array:
        """Evaluate the harmonics of the law's force in the order of the unknowns [N], (2 H + 1,)."""
        x, v = self.in_time(u, omega, self.samples)
        f = cycle_force(self.law, x, v, period=2.0 * np.pi / omega)[:-1]
        spectrum = np.fft.rfft(f)[: self.harmonics + 1] * (2.0 / self.samples)
        return np.concatenate([[0.5 * spectrum[0].real], spectrum[1:].real, -spectrum[1:].imag])

    def residual(self, u: Array, omega: float, acceleration: float) -> Array:
        """Evaluate the residual over m a, (2 H + 1,); of a law without a preferred position the first demands zero mean."""
        r = self.force(u, omega) - (self.orders * omega) ** 2 * self.mass * u
        r[self.harmonics + 1] += self.mass * acceleration
        r[0] = u[0] * self.mass * omega**2 if self.neutral else r[0] + self.mass * self.gravity
        return r / (self.mass * acceleration)

    def jacobian(self, u: Array, omega: float, acceleration: float, residual: Array) -> Array:
        """Differentiate the residual by the unknowns by difference quotients, (2 H + 1, 2 H + 1)."""
        step = _STEP * max(float(np.abs(u[1:]).max()), acceleration / omega**2 * 1e-3)
        matrix = np.empty((u.size, u.size))
        for i in range(u.size):
            moved = u.copy()
            moved[i] += step
            matrix[:, i] = (self.residual(moved, omega, acceleration) - residual) / (moved[i] - u[i])
        return matrix


def newton(balance: Balance, u: Array, omega: float, acceleration: float, tolerance: float) -> Solution:
    """Run Newton's method with halved steps from the unknowns `u`, to convergence or until no step reduces the residual."""
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
            # The norm decreases; the largest component alone may have to grow.
            if np.linalg.norm(trial) < np.linalg.norm(residual):
                break
            step *= 0.5
        else:
            return Solution(u, size, iteration)
        u, residual = u + step, trial
    return Solution(u, float(np.abs(residual).max()), _ITERATIONS)


@dataclass(frozen=True, kw_only=True, repr=False)
class HarmonicOrbit(Summarised):
    """A periodic motion by harmonic balance; the base's sine begins at the first sample, the last one is a period later."""

    law: Law  #: of the isolator axis
    mass: float  #: [kg]
    frequency: float  #: [Hz]
    acceleration: float  #: amplitude of the base [m/s^2]
    gravity: float  #: [m/s^2]
    #: c_k of the deflection [m], (harmonics + 1,), complex; the mean first
    coefficients: ComplexArray = field(repr=False)
    time: Array = field(repr=False)  #: [s], (n_t,)
    deflection: Array = field(repr=False)  #: [m], (n_t,)
    rate: Array = field(repr=False)  #: [m/s], (n_t,)
    force: Array = field(repr=False)  #: [N], (n_t,)
    hysteretic_state: Array = field(repr=False)  #: [N], (n_t,)
    amplitude: float  #: largest |absolute acceleration| of the mass over the period [m/s^2]
    smallest_deflection: float  #: [m]
    largest_deflection: float  #: [m]
    largest_hysteretic_state: float  #: largest |z| [N]
    dissipated_energy: float  #: work done on the law in the period [J]
    residual: float  #: largest |R_k| of the retained harmonics over m a
    #: root mean square of the force's harmonics that are not retained, over m a: these are unbalanced
    truncation: float
    iterations: int  #: Newton steps taken

    def _summary(self) -> tuple[str, dict[str, str]]:
        return f"HarmonicOrbit of {self.mass:.4g} kg on {type(self.law).__name__}", {
            "base": f"{quantity(self.acceleration, 'm/s^2')} at {self.frequency:.4g} Hz",
            "amplitude": f"{quantity(self.amplitude, 'm/s^2')}, transmissibility {self.transmissibility:.4g}",
            "deflection": span((self.smallest_deflection, self.largest_deflection), "m"),
            "dissipated energy": f"{self.dissipated_energy:.4g} J",
            "residual": f"{self.residual:.1e}, truncation {self.truncation:.1e}",
        }

    @property
    def harmonics(self) -> Array:
        """Amplitudes of the harmonics of the mass' absolute acceleration [m/s^2], (harmonics + 1,); the mean is zero."""
        spectrum = np.fft.rfft(self.force[:-1])[: self.coefficients.size] / (self.force.size - 1)
        spectrum[1:] *= 2.0
        spectrum[0] += self.mass * self.gravity
        return np.abs(spectrum) / self.mass

    @property
    def transmissibility(self) -> float:
        """Largest |absolute acceleration| of the mass over the base's amplitude [-]."""
        return self.amplitude / self.acceleration


def harmonic_balance(
    law: Law, *, mass: float, frequency: float, acceleration: float, gravity: float = 0.0, harmonics: int = 31,
    samples: int = 1024, guess: ArrayLike | None = None, tolerance: float = 1e-10,
) -> HarmonicOrbit:  # fmt: skip
    """Find a periodic motion of one mass on one isolator axis under a sine of base acceleration, a sin(w t).

    It starts from equivalent linearisation, the smallest of its solutions first; if Newton's method fails from all of them, the
    acceleration is raised step by step from where the law is a spring. A law without an elastic part has no preferred position:
    its mean deflection is zero.

    Args:
        law: of the axis; not one that wears. Masing's sliders enter the first cycle unloaded, at zero deflection.
        mass: [kg].
        frequency: of the base and of the motion [Hz].
        acceleration: amplitude of the base, a [m/s^2].
        gravity: acceleration that acts on the mass towards compression [m/s^2].
        harmonics: retained, H.
        samples: of one period, at least 8 for each harmonic.
        guess: the only coefficients to start from, such as those of a neighbouring motion; (n,) complex, the mean first.
        tolerance: of the residual.

    Raises:
        ValueError: an argument is out of its range, or the law cannot carry the weight.
        ConvergenceError: no periodic motion was found; says what was tried.
    """
    require_oscillator(law, mass=mass, frequency=frequency, acceleration=acceleration, gravity=gravity)
    balance = Balance(law, mass, gravity, checked_harmonics(harmonics, samples), samples)
    omega = 2.0 * np.pi * frequency
    if guess is None:
        starts, tried = (_estimates(balance, omega, acceleration), "equivalent linearisation and from small accelerations")
    else:
        starts, tried = [balance.from_coefficients(np.asarray(guess, dtype=np.complex128))], "the `guess`"
    best = np.inf
    solutions = (newton(balance, start, omega, acceleration, tolerance) for start in starts)
    raised = (_solve_by_raising(balance, omega, acceleration, tolerance) for _ in range(guess is None))
    for solution in chain(solutions, raised):
        if solution.residual <= tolerance:
            return orbit_of(balance, solution, omega, acceleration)
        best = min(best, solution.residual)
    raise ConvergenceError(
        f"no periodic motion with {harmonics} harmonics at {frequency:.6g} Hz and {acceleration:.6g} m/s^2: the residual stays "
        f"at {best:.2g} of the excitation, started from {tried}. "
        "Try more harmonics, or `follow_harmonic_balance` from a frequency far from the resonance."
    )


def checked_harmonics(harmonics: int, samples: int) -> int:
    """Check `harmonics` and `samples`: at least one harmonic, and 8 samples for each; returns the harmonics."""
    integer("harmonics", harmonics, least=1)
    if samples < 8 * harmonics or samples % 2:
        raise ValueError(f"`samples` must be even and at least 8 for each of {harmonics} harmonics, got {samples}.")
    return harmonics


def orbit_of(balance: Balance, solution: Solution, omega: float, acceleration: float) -> HarmonicOrbit:
    """Make the periodic motion of converged unknowns."""
    period = 2.0 * np.pi / omega
    x, v = balance.in_time(solution.u, omega, balance.samples)
    cycle = steady_cycle(balance.law, x, v, period=period)
    force, z = cycle.loop.force[cycle.samples], cycle.loop.hysteretic_state[cycle.samples]
    fine = steady_cycle(balance.law, *balance.in_time(solution.u, omega, _FINE), period=period).loop
    spectrum = np.fft.rfft(force[:-1])[balance.harmonics + 1 :] * (2.0 / balance.samples)
    inertia = np.abs(fine.force + balance.mass * balance.gravity) / balance.mass
    return HarmonicOrbit(
        law=balance.law, mass=balance.mass, frequency=omega / (2.0 * np.pi), acceleration=acceleration, gravity=balance.gravity,
        coefficients=balance.coefficients(solution.u),
        time=np.linspace(0.0, period, x.size), deflection=x, rate=v, force=force, hysteretic_state=z,
        amplitude=largest(inertia[:-1], smooth=not balance.law.rate_independent),
        smallest_deflection=float(fine.deflection.min()), largest_deflection=float(fine.deflection.max()),
        largest_hysteretic_state=float(np.abs(fine.hysteretic_state).max()),
        dissipated_energy=fine.dissipated_energy,
        residual=solution.residual, iterations=solution.iterations,
        truncation=float(np.sqrt(0.5 * np.sum(np.abs(spectrum) ** 2))) / (balance.mass * acceleration),
    )  # fmt: skip


def _estimates(balance: Balance, omega: float, acceleration: float) -> list[Array]:
    """Estimate the unknowns by equivalent linearisation of the unsmoothed law, the smallest motion first."""
    frequency = omega / (2.0 * np.pi)
    orbits = linearised_orbits(
        balance.law.unsmoothed, mass=balance.mass, frequency=frequency, acceleration=acceleration, gravity=balance.gravity
    )
    return [balance.from_coefficients(np.array([orbit.oscillator.offset, orbit.phasor])) for orbit in orbits]


def _solve_by_raising(balance: Balance, omega: float, acceleration: float, tolerance: float) -> Solution:
    """Solve for the unknowns at rising accelerations up to `acceleration`, by smaller factors where one fails."""
    level, factor, before = _SMALLEST_LEVEL, 2.0, 0.0
    estimates = _estimates(balance, omega, level * acceleration)
    u = estimates[0] if estimates else np.zeros(2 * balance.harmonics + 1)
    while True:
        solution = newton(balance, u, omega, level * acceleration, tolerance)
        if solution.residual <= tolerance:
            if level == 1.0:
                return solution
            u, before = solution.u, level
        elif before == 0.0 or factor < 1.01:
            return Solution(solution.u, max(solution.residual, 2.0 * tolerance), solution.iterations)
        else:
            factor = np.sqrt(factor)
        level = min(1.0, before * factor)
