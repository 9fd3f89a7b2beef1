"""Measured loops that a law of several scales is fitted to: what was followed once is recalled."""

from dataclasses import dataclass, field, fields
from typing import Self

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.laws import AsymmetricBoucWen, BoucWen, Law, SymmetricBoucWen
from wirerope_mj.mounts.test_rig.recorded import mean_of_cycles

_KEPT = 48  # Shapes that a loop recalls: those of one Jacobian and of the steps about it


@dataclass(frozen=True, kw_only=True)
class ScaleLoop(MeasuredLoop):
    """A measured loop that recalls the hysteretic force of a scale over its bound, which x_y, sigma and n alone bend.

    Most coordinates of a law of several scales leave these of most scales as they are, and following them is what takes time.
    """

    _known: dict[tuple[str, ...], Array] = field(default_factory=dict, init=False, repr=False, compare=False)

    @classmethod
    def of(cls, loop: MeasuredLoop) -> Self:
        """Return a loop with a memory of its own."""
        return cls(**{item.name: getattr(loop, item.name) for item in fields(MeasuredLoop)})

    def model_force(self, law: Law) -> Array:
        """Return the force of a law of one scale or several on the loop's path [N], (n_t,), as `MeasuredLoop` does."""
        if len(law.components) == 1:
            return super().model_force(law)
        x, z, elastic, asymmetry = self.deflection, np.zeros(1), np.zeros(1), 0.0
        for one in law.components:
            assert isinstance(one, BoucWen | SymmetricBoucWen)
            form = one.normalised
            z = z + form.z_max * self.shape(form.x_y, form.sigma, form.n)
            elastic = elastic + (
                one.k * x if isinstance(one, BoucWen) else x * (one.k1 + x * (np.sign(x) * one.k2 + one.k3 * x))
            )
            asymmetry = one.asymmetry if isinstance(one, AsymmetricBoucWen) else 0.0
        return self.as_measured(np.exp(asymmetry * x) * (z + elastic))

    def as_measured(self, forces: Array) -> Array:
        """Return what was measured of the forces of every averaged cycle, (n_cycles, n_t), or of the steady one, (1, n_t)."""
        return mean_of_cycles(forces, self.elapsed) if self.averaged else forces[0]

    def shape(self, x_y: float, sigma: float, n: float) -> Array:
        """Return z / z_max of a scale in every averaged cycle, or in the steady one, (n_cycles, n_t)."""
        key = tuple(f"{value:.12e}" for value in (x_y, sigma, n))  # a millionth of the step of a difference
        if key not in self._known:
            size = 0.5 * float(np.ptp(self.force))  # what counts as steady is a fraction of it
            scale = BoucWen.from_normalised(z_max=size, x_y=x_y, sigma=sigma, n=n)
            forces = self._led_forces(scale) if self.averaged else super().model_force(scale)[None]
            while len(self._known) >= _KEPT:
                del self._known[next(iter(self._known))]
            self._known[key] = forces / size
        return self._known[key]
