"""Modes about the sagged position, for small amplitudes and for given ones."""

import math
from typing import TypeVar

import numpy as np
import numpy.typing as npt
import scipy

from wirerope_mj.dynamics.modes.eigen import frequency_of, iterate, solve
from wirerope_mj.dynamics.modes.motion import descriptions_of, participation_of, payload_shapes
from wirerope_mj.dynamics.modes.rest import AtRest, linearise
from wirerope_mj.dynamics.modes.result import Modes
from wirerope_mj.dynamics.modes.tipping import stability_of
from wirerope_mj.engine.statics import History, equilibrium
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError

ComplexArray = npt.NDArray[np.complex128]
AnyArray = TypeVar("AnyArray", Array, ComplexArray)

STEPS = 6
"""Amplitudes, each twice the last, by which a mode is led from the small one to the given one: so it stays itself."""


def modes(system: System, *, history: History = "virgin", amplitude: float | None = None) -> Modes:
    """Return the modes of `system` about the position where it sags to, the base at rest.

    Stiffness is that of closed cycles of every mount about its deflection there; weight, preload, joint springs and contacts
    count too. Without `amplitude` it is the limit of small amplitude, in which the hysteretic force of a Bouc-Wen law has faded
    to zero and its slope is alpha, and Masing's sliders stick. With it, every mode has its own: the describing function of
    every axis at the amplitude that the axis has in the mode when the mount that moves most moves by `amplitude`, found by
    iteration; the damping ratio is from the energy that those cycles take. The cycles run about the position of rest; a floor
    under real vibration comes to rest in the relaxed one. Laws that depend on the rate are taken at the mode's frequency.

    Args:
        system: the system.
        history: how it came to rest: "virgin" or "relaxed", see `equilibrium`.
        amplitude: largest deflection amplitude of any mount [m]; None: vanishing.

    Warns:
        ModelWarning: no mount, joint or stop resists a motion of a body, see `equilibrium`.

    Raises:
        ValueError: the amplitude is not a finite number > 0, or a law has no closed cycle of that size.
        ConvergenceError: there is no such equilibrium.
    """
    if amplitude is not None:
        positive("amplitude", amplitude, unit="m")
    static = equilibrium(system, history=history)
    rest = linearise(system, static)
    springs = _Springs(rest)
    held = springs.held(np.zeros(rest.free.size), 0.0, 1.0)
    small = held.real - rest.other - rest.weight
    values, shapes = solve(held.real, rest.mass)
    loading, unloading = springs.tangents()
    bracket = [_matched(rest, shapes, rest.other + rest.weight + part) for part in (loading, unloading)]
    sizes = [0.0] if amplitude is None else [amplitude * 0.5**step for step in range(STEPS - 1, -1, -1)]
    complexes = np.zeros((values.size, *held.shape), dtype=np.complex128)
    known = shapes.copy()
    for mode in range(values.size):
        for size in sizes:
            start = float(values[mode]), shapes[:, mode]
            values[mode], shapes[:, mode], complexes[mode] = springs.mode(known, mode, start, size)
    damping = np.array([_damping(shapes[:, i], values[i], complexes[i], rest) for i in range(values.size)])
    order = np.argsort(values, kind="stable")
    scaled = np.stack([springs.scaled(shapes[:, i]) for i in order], axis=1)
    whole = np.zeros((system.model.nv, order.size))
    whole[rest.free] = scaled
    participation, moving_mass = participation_of(system, rest, scaled)
    return Modes(
        frequencies=np.where((values[order] < 0.0) & bool(static.free), 0.0, frequency_of(values[order])),
        damping_ratio=damping[order],
        loading=bracket[0][order],
        unloading=bracket[1][order],
        shapes=whole,
        payloads=payload_shapes(system, rest, scaled),
        mounts={name: (mount.jacobian @ scaled).T for name, mount in rest.mounts.items()},
        participation=participation,
        moving_mass=moving_mass,
        descriptions=_with_fate(descriptions_of(system, rest, scaled), values[order]),
        history=history,
        amplitude=amplitude,
        stability=stability_of(system, rest, small if history == "virgin" else springs.lasting(), loading),
        free=rest.free,
        mass=rest.mass,
        stiffness=held.real,
        equilibrium=static,
    )


def _with_fate(descriptions: tuple[str, ...], values: Array) -> tuple[str, ...]:
    """Return the descriptions, those of free and of unstable modes marked; `values` are eigenvalues, (n_modes,)."""
    fates = ["" if value > 0.0 else " (free)" if value == 0.0 else " (tips over)" for value in values]
    return tuple(description + fate for description, fate in zip(descriptions, fates, strict=True))


class _Springs:
    """The mounts of a system at rest as complex springs, by shape, amplitude and frequency."""

    def __init__(self, rest: AtRest) -> None:
        self.rest = rest

    def held(self, shape: Array, amplitude: float, frequency: float) -> ComplexArray:
        """Return the complex stiffness of the free coordinates [N/m, ...], (n, n), when the motion is amplitude * shape."""
        total = (self.rest.other + self.rest.weight).astype(np.complex128)
        for name, mount in self.rest.mounts.items():
            moved = amplitude * (mount.jacobian @ shape)
            stiffness = _finite(name, mount.stiffness(np.abs(moved), frequency))
            total += mount.jacobian.T @ (stiffness[:, None] * mount.jacobian)
            if mount.isolator.loop is not None:
                total += mount.jacobian.T @ mount.loop_stiffness(moved) @ mount.jacobian
        return total

    def mode(
        self, known: Array, mode: int, start: tuple[float, Array], amplitude: float
    ) -> tuple[float, Array, ComplexArray]:
        """Return eigenvalue, shape and complex stiffness of a mode whose largest mount deflection is `amplitude` [m]."""

        def stiffness(shape: Array, value: float) -> ComplexArray:
            frequency = float(np.sqrt(max(value, 0.0))) / (2.0 * np.pi) or 1.0  # what does not swing has no frequency
            return self.held(self.scaled(shape), amplitude, frequency)

        return iterate(stiffness, self.rest.mass, known, mode, start)

    def lasting(self) -> Array:
        """Return the stiffness of the mounts that is left after long vibration, (n, n)."""
        parts = [mount.jacobian.T @ mount.lasting() @ mount.jacobian for mount in self.rest.mounts.values()]
        return np.asarray(np.sum(parts, axis=0))

    def tangents(self) -> tuple[Array, Array]:
        """Return the stiffness of the mounts on further loading and on unloading, (n, n) each."""
        loading, unloading = np.zeros_like(self.rest.mass), np.zeros_like(self.rest.mass)
        for name, mount in self.rest.mounts.items():
            on, off = (_finite(name, part) for part in mount.tangents())
            loading += mount.jacobian.T @ on @ mount.jacobian
            unloading += mount.jacobian.T @ off @ mount.jacobian
        return loading, unloading

    def scaled(self, shape: Array) -> Array:
        """Return a shape whose largest mount deflection is 1, its largest coordinate positive."""
        sizes = [float(np.linalg.norm(mount.jacobian @ shape)) for mount in self.rest.mounts.values()]
        largest = float(np.abs(shape).max())
        size = max(sizes) if max(sizes) > 1e-9 * largest else largest  # a motion that deflects no mount
        return np.asarray(shape / size * np.sign(shape[int(np.argmax(np.abs(shape)))]))


def _finite(name: str, stiffness: AnyArray) -> AnyArray:
    """Return the stiffness of a mount, or raise ConvergenceError if it is not finite."""
    if np.isfinite(stiffness).all():
        return stiffness
    raise ConvergenceError(
        f"mount {name!r}: where it rests its laws have a stiffness that is not finite. Check the parameters of its isolator."
    )


def _matched(rest: AtRest, shapes: Array, stiffness: Array) -> Array:
    """Return the frequencies of another stiffness [Hz], each for the shape that its own is most like, (n_modes,)."""
    values, others = solve(stiffness, rest.mass)
    likeness = (shapes.T @ rest.mass @ others) ** 2
    _, matched = scipy.optimize.linear_sum_assignment(-likeness)
    return frequency_of(values[matched])


def _damping(shape: Array, value: float, stiffness: ComplexArray, rest: AtRest) -> float:
    """Return the damping ratio of a mode: loss over twice the stiffness, and of joint dampers; NaN without a frequency."""
    if value <= 0.0:
        return math.nan
    modal = float(shape @ rest.mass @ shape)
    loss = float(shape @ stiffness.imag @ shape) + math.sqrt(value) * float(shape @ rest.damping @ shape)
    return loss / (2.0 * value * modal)
