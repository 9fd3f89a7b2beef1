"""Stiffness of a mount in its three axes, two of them coupled where the isolator couples them."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.modes.axis import closed_cycle, lasting, loading_and_unloading, vanishing_cycle
from wirerope_mj.dynamics.modes.plane import SMALL, loop_cycle, plane_cycle, plane_tangents
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator import Isolator

ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class MountAtRest:
    """A mount where it rests.

    Attributes:
        isolator: the device.
        deflection: roll, shear, axial [m], (3,).
        force: restoring force [N], (3,).
        states: internal states of each axis.
        jacobian: deflection by free velocity coordinates, (3, n).
    """

    isolator: Isolator
    deflection: Array
    force: Array
    states: tuple[Array, Array, Array]
    jacobian: Array

    def tangents(self) -> tuple[Array, Array]:
        """Return the stiffness on further loading and on unloading of every axis [N/m], (3, 3) each."""
        loading, unloading = np.zeros((3, 3)), np.zeros((3, 3))
        for axis, law in enumerate(self.isolator.axes.values()):
            if law is not None:
                slopes = loading_and_unloading(law, float(self.deflection[axis]), self.states[axis])
                loading[axis, axis], unloading[axis, axis] = slopes
        coupled = self.isolator.coupled
        if coupled is not None:
            axes = list(self.isolator.coupled_axes)
            z = np.concatenate([self.states[axis] for axis in axes])
            loading[np.ix_(axes, axes)], unloading[np.ix_(axes, axes)] = plane_tangents(
                coupled, self.deflection[axes], z
            )
        return loading, unloading

    def lasting(self) -> Array:
        """Return the stiffness of every axis that is left after long vibration [N/m], (3, 3)."""
        laws = self.isolator.axes.values()
        slopes = [
            0.0 if law is None else lasting(law, x) for law, x in zip(laws, self.deflection.tolist(), strict=True)
        ]
        return np.diag(slopes) + self.loop_stiffness(np.zeros(3))

    def loop_stiffness(self, amplitude: Array) -> Array:
        """Return what a loop's elastic energy adds to the stiffness of the axes in closed cycles [N/m], (3, 3).

        Args:
            amplitude: of every axis, with signs, as they move against each other [m], (3,); zero for small cycles.
        """
        stiffness, axes, loop = np.zeros((3, 3)), list(self.isolator.coupled_axes), self.isolator.loop
        if loop is not None:
            stiffness[np.ix_(axes, axes)] = loop_cycle(loop, self.deflection[axes], amplitude[axes])
        return stiffness

    def stiffness(self, amplitude: Array, frequency: float) -> ComplexArray:
        """Return stiffness + i * loss of closed cycles about the deflection at rest [N/m], (3,), without a loop's energy.

        Args:
            amplitude: of every axis [m], (3,); zero for the limit of small cycles.
            frequency: of the cycle [Hz].
        """
        complex_stiffness = np.zeros(3, dtype=np.complex128)
        for axis, law in enumerate(self.isolator.axes.values()):
            if law is None:
                continue
            x, size = float(self.deflection[axis]), float(amplitude[axis])
            if size < SMALL:
                complex_stiffness[axis] = vanishing_cycle(law, x, self.states[axis], frequency=frequency)
            else:
                complex_stiffness[axis] = closed_cycle(law, x, size, frequency=frequency)
        axes = list(self.isolator.coupled_axes)
        if self.isolator.coupled is not None and float(np.hypot(*amplitude[axes])) >= SMALL:
            complex_stiffness[axes] = plane_cycle(self.isolator.coupled, self.deflection[axes], amplitude[axes])
        return complex_stiffness
