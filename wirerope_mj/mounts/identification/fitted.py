"""Measured loops beside those of the law that was fitted to them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.identification.result import Identification
from wirerope_mj.mounts.laws import Law


@dataclass(frozen=True, kw_only=True)
class FittedLoop:
    """One measured loop and the law's.

    Attributes:
        deflection: path [m], (n_t,).
        measured: force [N], (n_t,), with the zero of the load cell taken out.
        fitted: force of the law [N], (n_t,).
        zero: what was taken out [N]: the mean of measured minus fitted.
    """

    deflection: Array
    measured: Array
    fitted: Array
    zero: float

    @property
    def amplitude(self) -> float:
        """Half the range of the deflection [m]."""
        return 0.5 * float(np.ptp(self.deflection))

    @property
    def operating_point(self) -> float:
        """Middle of the deflections [m]."""
        return 0.5 * float(self.deflection.max() + self.deflection.min())

    @property
    def residual(self) -> Array:
        """Fitted minus measured force over half the measured range [-], (n_t,)."""
        return (self.fitted - self.measured) / (0.5 * float(np.ptp(self.measured)))

    @property
    def error(self) -> float:
        """Root mean square of the residual [-]."""
        return float(np.sqrt(np.mean(self.residual**2)))

    def energy(self, force: Array) -> float:
        """Return what a force dissipates over the loop [J]."""
        return float(np.trapezoid(force, self.deflection))

    def secant_stiffness(self, force: Array) -> float:
        """Return a force's difference between the turning points over the stroke [N/m]."""
        top, bottom = int(np.argmax(self.deflection)), int(np.argmin(self.deflection))
        return float((force[top] - force[bottom]) / np.ptp(self.deflection))


def neighbours_correlation(fits: Sequence[FittedLoop]) -> float:
    """Return the correlation of neighbouring residuals [-]: about 0 for noise, towards 1 for what the law cannot follow."""
    products = sum(float(fit.residual[1:] @ fit.residual[:-1]) for fit in fits)
    return products / max(sum(float(fit.residual[1:] @ fit.residual[1:]) for fit in fits), 1e-300)


def fitted_loops(result: Identification) -> list[FittedLoop]:
    """Return every loop of an identification beside the law's, smallest first."""
    return [_beside(result.law, loop) for loop in result.loops]


def _beside(law: Law, loop: MeasuredLoop) -> FittedLoop:
    fitted = loop.model_force(law)
    zero = float(np.mean(loop.force - fitted))
    return FittedLoop(deflection=loop.deflection, measured=loop.force - zero, fitted=fitted, zero=zero)
