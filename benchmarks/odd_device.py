"""A device that no law of the house describes: Jenkin elements with a power-law density of slip, and a cubic spring in series.

Its force is exact along any path: the two halves carry the same force, so the deflection of the sliders follows from bisection
of a sum that grows with it.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from wirerope_mj.mounts.laws import Loop

Array = npt.NDArray[np.float64]

HALVINGS = 60
"""Bisections of the largest deflection: what is left of it is below the rounding of the force."""


@dataclass(frozen=True, kw_only=True)
class OddDevice:
    """Sliders in parallel, beside a spring, in series with a cubic spring.

    Attributes:
        travel: largest deflection of the tests [m].
        elements: number of Jenkin elements, all of the same stiffness.
        sliding: their stiffness together [N/m].
        slip: deflection at which the last of them slips, of the travel.
        power: of the density of slip deflections, p(u) ~ u^power, > -1: many slip early if it is negative.
        beside: stiffness of the spring beside them [N/m].
        series, cubic: of the spring in series, series s + cubic s^3 [N/m], [N/m^3].
    """

    travel: float = 0.03
    elements: int = 300
    sliding: float = 5e5
    slip: float = 0.6
    power: float = -0.7
    beside: float = 4e4
    series: float = 2e6
    cubic: float = 2e9

    def force(self, deflection: Array) -> Array:
        """Return the force along a path that starts unloaded at zero [N], (n_t,)."""
        share = (np.arange(self.elements) + 0.5) / self.elements
        slips = self.slip * self.travel * share ** (1.0 / (1.0 + self.power))
        stiffness = self.sliding / self.elements
        return _forces(deflection, stiffness, stiffness * slips, self.beside, self.series, self.cubic)

    def loop(self, amplitude: float, *, points: int = 200) -> Loop:
        """Return the steady loop of an amplitude [m]: sliders forget a virgin path within one cycle."""
        phase = 2.0 * np.pi * np.arange(2 * points + 1) / points
        path = amplitude * np.sin(phase)
        return Loop.from_samples(path[points:], self.force(path)[points:])

    def measured(self, amplitude: float, *, noise: float, seed: int, points: int = 200) -> Loop:
        """Return the loop with Gaussian noise, relative to half its force range, and a zero of the load cell that drifted."""
        loop, rng = self.loop(amplitude, points=points), np.random.default_rng(seed)
        half = 0.5 * float(np.ptp(loop.force))
        noisy = loop.force + noise * half * rng.standard_normal(loop.force.size) + 0.2 * half * rng.uniform(-1.0, 1.0)
        return Loop.from_samples(loop.deflection, noisy)


@njit
def _forces(path, stiffness, slip_force, beside, series, cubic):
    """Return the force at every point of a path, (n_t,), from rest; equal `stiffness`, `slip_force` (n,)."""
    z, inner, force = np.zeros(slip_force.size), 0.0, np.zeros(path.size)
    for t in range(1, path.size):
        # Every half gives way in the direction of the path: the inner deflection lies between zero and the whole.
        low, high = min(0.0, path[t], inner), max(0.0, path[t], inner)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            carried = beside * middle
            for e in range(slip_force.size):
                carried += min(max(z[e] + stiffness * (middle - inner), -slip_force[e]), slip_force[e])
            rest = path[t] - middle
            if carried < series * rest + cubic * rest**3:
                low = middle
            else:
                high = middle
        moved = 0.5 * (low + high) - inner
        for e in range(slip_force.size):
            z[e] = min(max(z[e] + stiffness * moved, -slip_force[e]), slip_force[e])
        inner += moved
        rest = path[t] - inner
        force[t] = series * rest + cubic * rest**3
    return force
