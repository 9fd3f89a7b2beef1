"""Stiffness of a mount in its three axes, two of them coupled where the isolator couples them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from wirerope_mj.dynamics.modes.axis import (
    SAMPLES,
    closed_cycle,
    cycle_samples,
    elastic_slope,
    loading_and_unloading,
    vanishing_cycle,
)
from wirerope_mj.foundation.arrays import AnyArray, Array, ComplexArray
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws import BiaxialBoucWen, BoucWen, Law, LoopBoucWen, LoopCoupling
from wirerope_mj.mounts.laws.plane import asymmetry_of, elastic_of

Coupled = BiaxialBoucWen | LoopBoucWen
# Amplitude [m] below which a cycle is the vanishing one: forces of kilonewtons are rounded at 1e-4 N/m of slope there.
SMALL = 1e-8
# Samples of a cycle of the loop's energy, whose stiffness jumps at the ends of its box: a few parts in ten thousand there.
FINE = 2048
# Iterations of a cycle on brackets, and the change of its amplitudes, relative to those of both, that ends them.
ROUNDS, ALIKE = 100, 1e-10


def plane_tangents(coupled: Coupled, deflection: Array, z: Array) -> tuple[Array, Array]:
    """Evaluate the stiffness of two coupled axes on further loading and on unloading [N/m], (2, 2) each.

    With w = z / z_m and its unit vector e:  dz/dx = diag(z_m) [1 - c |w|^n e e^T] diag(1 / x_y), c = 1 on loading and
    1 - 2 sigma on unloading; F2 multiplies the axial row, and the loop's energy adds its own. Where the axes' energies z_m x_y
    or F2 differ it is not symmetric, and its symmetric part is taken. Scales add up. `z` are the hysteretic forces [N], those
    of roll on every scale, then those of the other axis, (2 n_scales,).
    """
    x, forces = coupled.own_deflection(deflection, z), z.reshape(2, -1).T  # of both axes, scale by scale
    scales: Sequence[Coupled] = coupled.scales
    totals: list[Array] = []
    for scale, force in zip(scales, forces, strict=True):
        parameters = scale.rate_parameters()
        sigma, n, bound, yields = parameters[0], parameters[1], parameters[2:4], parameters[4:6]
        w = force / bound
        size = float(np.hypot(*w))
        along = np.outer(w, w) / size**2 if size > 0.0 else np.zeros((2, 2))
        axes = list(zip(scale.laws, x.tolist(), force.tolist(), strict=True))
        held = np.diag([_held_slope(law, place, push) for law, place, push in axes])
        factor = np.array([math.exp(asymmetry_of(law) * place) for law, place, _ in axes])
        loop = scale.loop.stiffness(x) if isinstance(scale, LoopBoucWen) else np.zeros((2, 2))
        slopes = [
            factor[:, None] * (bound[:, None] * (np.eye(2) - c * size**n * along) / yields) + held + loop
            for c in (1.0, 1.0 - 2.0 * sigma)
        ]
        totals = [total + slope for total, slope in zip(totals, slopes, strict=True)] if totals else slopes
    on, back = (in_series(total, coupled.brackets) for total in totals)
    return 0.5 * (on + on.T), 0.5 * (back + back.T)


def plane_cycle(coupled: Coupled, deflection: Array, amplitude: Array) -> ComplexArray:
    """Evaluate stiffness + i * loss of both axes in a closed cycle along a straight line [N/m], (2,), the loop's energy aside.

    The closed cycle has w parallel to the scaled motion u = x / x_y, so that the hysteretic force of each axis is that of its
    own law at the amplitude x_y |u|, as far as it moves; the elastic parts, and F2, stay those of the axes.
    """
    if len(coupled.scales) > 1:
        return np.sum([plane_cycle(scale, deflection, amplitude) for scale in coupled.scales], axis=0)
    yields = coupled.rate_parameters()[4:6]
    size = float(np.hypot(*(amplitude / yields)))
    stiffness = np.zeros(2, dtype=np.complex128)
    cosine = np.cos(2.0 * np.pi * np.arange(SAMPLES) / SAMPLES)
    for axis, law in enumerate(coupled.laws):
        x, moved, reach = float(deflection[axis]), float(amplitude[axis]), float(yields[axis]) * size
        if asymmetry_of(law) != 0.0 and moved >= SMALL:  # the first harmonic of F2 (z + F1)
            angle, z = cycle_samples(_without_elastic_part(law), 0.0, reach, 1.0)
            path = x + moved * np.cos(angle)
            force = np.exp(asymmetry_of(law) * path) * (moved / reach * z + _elastic_force(law, path))
            stiffness[axis] = 2.0 * complex(force @ np.exp(-1j * angle)) / (SAMPLES * moved)
            continue
        hysteretic = closed_cycle(_without_elastic_part(law), 0.0, reach, frequency=1.0)
        if asymmetry_of(law) != 0.0:
            hysteretic *= math.exp(asymmetry_of(law) * x)
        if moved < SMALL:
            elastic = _held_slope(law, x, 0.0)
        else:
            elastic = float(2.0 * _elastic_force(law, x + moved * cosine) @ cosine / (SAMPLES * moved))
        stiffness[axis] = hysteretic + elastic
    return stiffness


def loop_cycle(loop: LoopCoupling, deflection: Array, amplitude: Array) -> Array:
    """Evaluate the stiffness of the loop's elastic energy over deflection + amplitude cos [N/m], (2, 2); both with signs [m].

    Times the amplitude it is the first harmonic of the force: the mean of the second derivatives with the weight 2 sin^2.
    """
    if float(np.hypot(*amplitude)) < SMALL:
        return loop.stiffness(deflection)
    angle = np.pi * (np.arange(FINE) + 0.5) / FINE  # the way back passes the same deflections
    along = loop.stiffness(deflection + np.cos(angle)[:, None] * amplitude)
    return np.asarray(np.einsum("t,tij->ij", 2.0 / FINE * np.sin(angle) ** 2, along))


def plane_stiffness(coupled: Coupled, deflection: Array, amplitude: Array) -> ComplexArray:
    """Evaluate stiffness + i * loss of both axes in a closed cycle [N/m], (2, 2), amplitudes with signs [m], (2,).

    On brackets the mount's own cycle is taken for a straight line, too, of the amplitudes that its stiffness leaves it.
    """
    x = coupled.own_deflection(deflection, np.zeros(2 * len(coupled.scales)))

    def without_brackets(amplitude: Array) -> ComplexArray:
        if float(np.hypot(*amplitude)) < SMALL:
            pairs = zip(coupled.laws, x.tolist(), strict=True)
            axes = np.array([vanishing_cycle(law, place, np.zeros(law.n_states), frequency=1.0) for law, place in pairs])
        else:
            axes = plane_cycle(coupled, x, np.abs(amplitude))
        loop = loop_cycle(coupled.loop, x, amplitude) if isinstance(coupled, LoopBoucWen) else np.zeros((2, 2))
        return np.asarray(np.diag(axes) + loop)

    moved, stiffness = amplitude, without_brackets(amplitude)
    if coupled.brackets is None:
        return stiffness
    for _ in range(ROUNDS):
        before, share = moved, np.linalg.solve(np.eye(2) + stiffness / np.array(coupled.brackets)[:, None], amplitude)
        moved = np.copysign(np.abs(share), share.real)
        if np.abs(moved - before).max() <= ALIKE * np.abs(amplitude).max():
            break
        stiffness = without_brackets(moved)
    return in_series(stiffness, coupled.brackets)


def in_series(stiffness: AnyArray, brackets: tuple[float, float] | None) -> AnyArray:
    """Put two axes on brackets [N/m], (2, 2): F = T d and x = d + F / K give T (1 + T / K)^-1."""
    if brackets is None:
        return stiffness
    return np.asarray(stiffness @ np.linalg.inv(np.eye(2) + stiffness / np.array(brackets)[:, None]))


@lru_cache(maxsize=64)
def _without_elastic_part(law: Law) -> Law:
    alpha, beta, gamma, n = (float(value) for value in law.kernel_parameters()[:4])
    return BoucWen(alpha=alpha, beta=beta, gamma=gamma, n=n)


def _elastic_force(law: Law, x: Array | float) -> Array:
    k1, k2, k3 = elastic_of(law)
    return np.asarray(x * (k1 + k2 * np.abs(x) + k3 * x * x))


def _held_slope(law: Law, x: float, z: float) -> float:
    """Slope of F2 (z + F1) with the hysteretic force held [N/m]."""
    k1, k2, k3 = elastic_of(law)
    slope = float(k1 + 2.0 * k2 * abs(x) + 3.0 * k3 * x * x)
    exponent = asymmetry_of(law)
    if exponent == 0.0:
        return slope
    return math.exp(exponent * x) * (slope + exponent * (z + float(_elastic_force(law, x))))


@dataclass(frozen=True, kw_only=True)
class MountAtRest:
    """A mount where it rests."""

    isolator: Isolator
    deflection: Array  # roll, shear, axial [m], (3,)
    states: tuple[Array, Array, Array]  # internal states of each axis
    jacobian: Array  # deflection by free velocity coordinates, (3, n)

    def tangents(self) -> tuple[Array, Array]:
        """Evaluate the stiffness on further loading and on unloading of every axis [N/m], (3, 3) each."""
        loading, unloading = np.zeros((3, 3)), np.zeros((3, 3))
        for axis, law in enumerate(self.isolator.axes.values()):
            if law is not None:
                slopes = loading_and_unloading(law, float(self.deflection[axis]), self.states[axis])
                loading[axis, axis], unloading[axis, axis] = slopes
        coupled, axes = self.isolator.coupled, list(self.isolator.coupled_axes)
        if coupled is not None:
            z = np.concatenate([self.states[axis] for axis in axes])
            both = np.ix_(axes, axes)
            loading[both], unloading[both] = plane_tangents(coupled, self.deflection[axes], z)
        return loading, unloading

    def lasting(self) -> Array:
        """Evaluate the stiffness of every axis that is left after long vibration [N/m], (3, 3)."""
        stiffness, coupled, axes = np.zeros((3, 3)), self.isolator.coupled, list(self.isolator.coupled_axes)
        for axis, law in enumerate(self.isolator.axes.values()):
            if law is not None:
                stiffness[axis, axis] = elastic_slope(law, float(self.deflection[axis]), np.zeros(law.n_states))
        if coupled is not None:
            x = coupled.own_deflection(self.deflection[axes], np.zeros(2 * len(coupled.scales)))
            pairs = zip(coupled.laws, x.tolist(), strict=True)
            elastic = np.diag([elastic_slope(law, place, np.zeros(law.n_states)) for law, place in pairs])
            if isinstance(coupled, LoopBoucWen):
                elastic += coupled.loop.stiffness(x)
            stiffness[np.ix_(axes, axes)] = in_series(elastic, coupled.brackets)
        return stiffness

    def cycles(self, amplitude: Array, frequency: float) -> ComplexArray:
        """Evaluate stiffness + i * loss of closed cycles about rest of amplitudes with signs [m], (3,), as [N/m], (3, 3)."""
        stiffness, coupled = np.zeros((3, 3), dtype=np.complex128), self.isolator.coupled
        axes = list(self.isolator.coupled_axes)
        for axis, law in enumerate(self.isolator.axes.values()):
            if law is None or axis in axes:
                continue
            x, size = float(self.deflection[axis]), abs(float(amplitude[axis]))
            if size < SMALL:
                stiffness[axis, axis] = vanishing_cycle(law, x, self.states[axis], frequency=frequency)
            else:
                stiffness[axis, axis] = closed_cycle(law, x, size, frequency=frequency)
        if coupled is not None:
            stiffness[np.ix_(axes, axes)] = plane_stiffness(coupled, self.deflection[axes], amplitude[axes])
        return stiffness
