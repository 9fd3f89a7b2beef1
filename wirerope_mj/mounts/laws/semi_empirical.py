"""Semi-empirical laws without internal states: Tinker and Cutchins' law and Ko's equivalent viscous law."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import raised, some, where
from wirerope_mj.mounts.laws.law import Law, require_not_negative, require_positive
from wirerope_mj.mounts.laws.loop import Loop

TINKER_CUTCHINS = 5


@dataclass(frozen=True, kw_only=True)
class TinkerCutchins(Law):
    """Tinker and Cutchins' law: nonlinear stiffness, n-th power damping and Coulomb friction that varies with deflection.

        F = k1 x + k2 x^2 + k3 x^3 + c |xdot|^n sgn(xdot) + (f0 + f1 |x| + f2 x^2) tanh(xdot / smoothing)

    k1 [N/m], k2 [N/m^2], k3 [N/m^3], c [N (s/m)^n], f0 [N], f1 [N/m], f2 [N/m^2], smoothing [m/s]. Over a cycle A sin(w t) the
    n-th power term takes gamma_n c w^n A^(n+1) with gamma_n = 2 sqrt(pi) Gamma((n+2)/2) / Gamma((n+3)/2), friction
    4 f0 A + 2 f1 A^2 + (4/3) f2 A^3 for a small smoothing. The springs are stable if 2 k2^2 <= 9 k1 k3.

    Source: Tinker and Cutchins (1992), thesis 2.5.2; how the friction
    varies is our choice, the published polynomial was not reachable.

    Coulomb friction is undefined at rest, so it is smoothed: at the rate xdot the force is tanh(xdot / smoothing) times
    it. The price is creep: a load F below the friction f0 is not held but sinks with smoothing * atanh(F / f0), and a static
    equilibrium rests on the springs alone. Choose `smoothing` near a hundredth of the rates that matter. The same velocity
    rounds |xdot|^n at rest if n < 1.
    """

    name: ClassVar[str] = "tinker-cutchins"
    kernel: ClassVar[int] = TINKER_CUTCHINS
    rate_independent: ClassVar[bool] = False
    force_powers: ClassVar[Mapping[str, float]] = dict.fromkeys(("k1", "k2", "k3", "c", "f0", "f1", "f2"), 1.0)

    k1: float
    k2: float = 0.0
    k3: float = 0.0
    c: float = 0.0
    n: float = 1.0
    f0: float = 0.0
    f1: float = 0.0
    f2: float = 0.0
    smoothing: float

    def _validate(self) -> None:
        require_not_negative(self, "k1", "k3", "c", "f0", "f1", "f2")
        require_positive(self, "n", "smoothing")

    @property
    def damping_parameters(self) -> tuple[str, ...]:
        """Damper and friction."""
        return ("c", "f0", "f1", "f2")

    def kernel_parameters(self) -> Array:
        """Return k1, k2, k3, c, n, f0, f1, f2, smoothing."""
        return np.array(
            [self.k1, self.k2, self.k3, self.c, self.n, self.f0, self.f1, self.f2, self.smoothing], dtype=np.float64
        )

    @property
    def initial_stiffness(self) -> float:
        """Stiffness k1 [N/m]."""
        return self.k1

    @property
    def damping_coefficient(self) -> float:
        """Slope of damping and friction at rest, at x = 0 [N s/m]."""
        damping = self.c if self.n == 1.0 else self.c * self.smoothing ** (self.n - 1.0) if self.n < 1.0 else 0.0
        return damping + self.f0 / self.smoothing

    @property
    def largest_force(self) -> float:
        """Zero at rest without springs, else infinite [N]."""
        return 0.0 if self.k1 == self.k2 == self.k3 == 0.0 else math.inf


@dataclass(frozen=True, kw_only=True)
class EquivalentViscous(Law):
    """Ko's decomposition of a loop: its mid-line, and a viscous ellipse of the same area, at one amplitude and frequency.

        F = k1 x + k2 x^2 + k3 x^3 + c_eq xdot,   c_eq = W / (pi w A^2)

    k1 [N/m], k2 [N/m^2], k3 [N/m^3]: mid-line at the amplitude A [m]; W: `energy` per cycle there [J]; w = 2 pi `frequency`
    [Hz].
    Away from that amplitude and frequency the law does not hold: its ellipse grows with both, where a rope's loop does not know
    the frequency. Source: Ko et al. (1992), thesis 2.5.2.
    """

    name: ClassVar[str] = "equivalent-viscous"
    kernel: ClassVar[int] = TINKER_CUTCHINS
    rate_independent: ClassVar[bool] = False
    force_powers: ClassVar[Mapping[str, float]] = dict.fromkeys(("k1", "k2", "k3", "energy"), 1.0)

    k1: float
    k2: float = 0.0
    k3: float = 0.0
    energy: float
    amplitude: float
    frequency: float

    def _validate(self) -> None:
        require_not_negative(self, "energy")
        require_positive(self, "amplitude", "frequency")
        with np.errstate(all="ignore"):
            damping = np.divide(self.energy, self.frequency * np.square(self.amplitude))
        if not np.all(np.isfinite(damping)):
            raise ValueError(f"`amplitude` must not be so small that the damping is infinite, got {self.amplitude}.")

    @classmethod
    def from_loops(cls, loops: Sequence[Loop], *, amplitude: float, frequency: float) -> Self:
        """Return the law of an amplitude between those of closed loops about zero.

        The mid-line (F_up + F_down) / 2 of each loop is fitted by k1 x + k2 x^2 + k3 x^3 through its tips. Between two
        loops k_p A^(p-1), parts
        of the secant stiffness, are interpolated over log A, and the energy by a power law W = a A^p.

        Args:
            loops: closed loops, one for each amplitude.
            amplitude: the amplitude wanted [m], within those of the loops.
            frequency: at which the law is to be used [Hz].

        Raises:
            ValueError: no loops, one that is not closed or not about zero, or the amplitude lies outside theirs.
        """
        ordered = sorted(loops, key=lambda loop: loop.amplitude)
        if not ordered:
            raise ValueError("`loops` must hold at least one loop.")
        for loop in ordered:
            if not abs(loop.deflection[-1] - loop.deflection[0]) <= 2.0 * np.abs(np.diff(loop.deflection)).max():
                raise ValueError("`loops` must be closed cycles, got an open path.")
            if abs(loop.operating_point) > 0.01 * loop.amplitude:
                raise ValueError(f"`loops` must be about zero, got one about {loop.operating_point:.6g} m.")
        sizes = np.array([loop.amplitude for loop in ordered])
        # The amplitude of a sampled loop differs from the one that was asked for by rounding.
        if not sizes[0] * (1.0 - 1e-9) <= amplitude <= sizes[-1] * (1.0 + 1e-9):
            raise ValueError(
                f"`amplitude` must lie within those of the loops, {sizes[0]:.6g} to {sizes[-1]:.6g} m, got {amplitude}."
            )
        terms = np.array([_mid_line(loop) for loop in ordered]) * sizes[:, None] ** np.arange(3)
        log_amplitude = np.log(amplitude)
        k1, k2, k3 = (
            float(np.interp(log_amplitude, np.log(sizes), term)) / amplitude**p for p, term in enumerate(terms.T)
        )
        # An elastic loop has an area of rounding.
        energies = np.maximum([loop.dissipated_energy for loop in ordered], 0.0)
        if (energies > 0.0).all():
            energy = float(np.exp(np.interp(log_amplitude, np.log(sizes), np.log(energies))))
        else:
            energy = float(np.interp(log_amplitude, np.log(sizes), energies))
        return cls(k1=k1, k2=k2, k3=k3, energy=energy, amplitude=float(amplitude), frequency=float(frequency))

    @property
    def damping_parameters(self) -> tuple[str, ...]:
        """The energy of its ellipse."""
        return ("energy",)

    def kernel_parameters(self) -> Array:
        """Return the parameters of Tinker and Cutchins' kernel: the mid-line and linear damping, no friction."""
        return np.array([self.k1, self.k2, self.k3, self.damping_coefficient, 1.0, 0.0, 0.0, 0.0, 1.0])

    @property
    def initial_stiffness(self) -> float:
        """Slope k1 of the mid-line at zero [N/m]."""
        return self.k1

    @property
    def damping_coefficient(self) -> float:
        """Equivalent viscous coefficient c_eq [N s/m]."""
        return self.energy / (math.pi * 2.0 * math.pi * self.frequency * self.amplitude**2)


def _mid_line(loop: Loop) -> Array:
    """Return k1, k2, k3 of the polynomial through the tips of a closed loop that is nearest to its mid-line."""
    (x_up, up), (x_down, down) = loop.branch(rising=True), loop.branch(rising=False)
    middle = 0.5 * (up + np.interp(x_up, x_down[::-1], down[::-1]))
    x, amplitude = x_up - loop.operating_point, loop.amplitude
    even, odd = 0.5 * (middle[-1] + middle[0]) / amplitude**2, 0.5 * (middle[-1] - middle[0]) / amplitude
    # With k1 = odd - k3 A^2 and k2 = even the tips are met for every k3.
    bend = x**3 - amplitude**2 * x
    k3 = float(bend @ (middle - odd * x - even * x**2) / (bend @ bend))
    return np.array([odd - k3 * amplitude**2, even, k3])


@njit
def tinker_cutchins(p, i, x, v, z, j, zdot, k):
    """Return k1 x + k2 x^2 + k3 x^3 + c |v|^n sgn(v) + Fc(x) tanh(v/s) [N]; p = k1, k2, k3, c, n, f0, f1, f2, s."""
    n, s = p[i + 4], p[i + 8]
    size = 1.0
    if some(n != 1.0):
        above = n > 1.0
        # |v|^n has an infinite slope at rest if n < 1: smoothed over the same velocity as the friction
        size = raised(where(above, abs(v), v * v + s * s), where(above, 1.0, 0.5) * (n - 1.0))
    damping = p[i + 3] * size * v
    friction = (p[i + 5] + p[i + 6] * abs(x) + p[i + 7] * x * x) * math.tanh(v / s)
    return x * (p[i] + x * (p[i + 1] + x * p[i + 2])) + damping + friction
