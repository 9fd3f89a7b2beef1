"""Stiffness of a mount in its three axes, with roll and shear coupled where the isolator couples them."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from wirerope_mj.isolator import Isolator
from wirerope_mj.laws import BiaxialBoucWen, BoucWen, Law
from wirerope_mj.modes.axis import SAMPLES, closed_cycle, lasting, loading_and_unloading, vanishing_cycle

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

SMALL = 1e-8
"""Amplitude [m] below which a cycle is the vanishing one: forces of kilonewtons are rounded at 1e-4 N/m of slope there."""


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
            z = np.concatenate(self.states[:2])
            loading[:2, :2], unloading[:2, :2] = plane_tangents(coupled, self.deflection[:2], z)
        return loading, unloading

    def lasting(self) -> Array:
        """Return the stiffness of every axis that is left after long vibration [N/m], (3, 3)."""
        laws = self.isolator.axes.values()
        slopes = [
            0.0 if law is None else lasting(law, x) for law, x in zip(laws, self.deflection.tolist(), strict=True)
        ]
        return np.diag(slopes)

    def stiffness(self, amplitude: Array, frequency: float) -> ComplexArray:
        """Return stiffness + i * loss of closed cycles about the deflection at rest [N/m], (3,).

        Args:
            amplitude: of every axis [m], (3,); zero for the limit of small cycles.
            frequency: of the cycle [Hz].
        """
        found = np.zeros(3, dtype=np.complex128)
        for axis, law in enumerate(self.isolator.axes.values()):
            if law is None:
                continue
            x, size = float(self.deflection[axis]), float(amplitude[axis])
            if size < SMALL:
                found[axis] = vanishing_cycle(law, x, self.states[axis], frequency=frequency)
            else:
                found[axis] = closed_cycle(law, x, size, frequency=frequency)
        if self.isolator.coupled is not None and float(np.hypot(*amplitude[:2])) >= SMALL:
            found[:2] = plane_cycle(self.isolator.coupled, self.deflection[:2], amplitude[:2])
        return found


def plane_tangents(coupled: BiaxialBoucWen, deflection: Array, z: Array) -> tuple[Array, Array]:
    """Return the stiffness of roll and shear on further loading and on unloading [N/m], (2, 2) each.

    With w = z / z_m and its unit vector e:  dz/dx = diag(z_m) [1 - c |w|^n e e^T] diag(1 / x_y), c = 1 on loading and
    1 - 2 sigma on unloading. Where the axes' energies z_m x_y differ it is not symmetric, and its symmetric part is taken.
    """
    parameters = coupled.rate_parameters()
    sigma, n, bound, yields = parameters[0], parameters[1], parameters[2:4], parameters[4:6]
    w = z / bound
    size = float(np.hypot(*w))
    along = np.outer(w, w) / size**2 if size > 0.0 else np.zeros((2, 2))
    elastic = np.array(
        [_elastic_slope(law, float(x)) for law, x in zip((coupled.roll, coupled.shear), deflection, strict=True)]
    )
    found = []
    for share in (1.0, 1.0 - 2.0 * sigma):
        slope = bound[:, None] * (np.eye(2) - share * size**n * along) / yields
        found.append(0.5 * (slope + slope.T) + np.diag(elastic))
    return found[0], found[1]


def plane_cycle(coupled: BiaxialBoucWen, deflection: Array, amplitude: Array) -> ComplexArray:
    """Return stiffness + i * loss of roll and shear in a closed cycle along a straight line [N/m], (2,).

    The closed cycle has w parallel to the scaled motion u = x / x_y, so that the hysteretic force of each axis is that of its
    own law at the amplitude x_y |u|, as far as it moves; the elastic parts stay those of the axes.
    """
    yields = coupled.rate_parameters()[4:6]
    size = float(np.hypot(*(amplitude / yields)))
    found = np.zeros(2, dtype=np.complex128)
    for axis, law in enumerate((coupled.roll, coupled.shear)):
        hysteretic = closed_cycle(_without_elastic_part(law), 0.0, float(yields[axis]) * size, frequency=1.0)
        found[axis] = hysteretic + _elastic_harmonic(law, float(deflection[axis]), float(amplitude[axis]))
    return found


@lru_cache(maxsize=64)
def _without_elastic_part(law: Law) -> Law:
    alpha, beta, gamma, n = (float(value) for value in law.kernel_parameters()[:4])
    return BoucWen(alpha=alpha, beta=beta, gamma=gamma, n=n)


def _elastic_parameters(law: Law) -> Array:
    """Return k1, k2, k3 of the elastic part of a Bouc-Wen law."""
    elastic = law.kernel_parameters()[4:]
    return np.concatenate([elastic, np.zeros(3 - elastic.size)])


def _elastic_slope(law: Law, x: float) -> float:
    k1, k2, k3 = _elastic_parameters(law)
    return float(k1 + 2.0 * k2 * abs(x) + 3.0 * k3 * x * x)


def _elastic_harmonic(law: Law, x: float, amplitude: float) -> float:
    """Return the first harmonic of the elastic part over x + amplitude cos, over the amplitude [N/m]."""
    if amplitude < SMALL:
        return _elastic_slope(law, x)
    k1, k2, k3 = _elastic_parameters(law)
    cosine = np.cos(2.0 * np.pi * np.arange(SAMPLES) / SAMPLES)
    path = x + amplitude * cosine
    return float(2.0 * (path * (k1 + k2 * np.abs(path) + k3 * path * path)) @ cosine / (SAMPLES * amplitude))
