"""Modes about the sagged position, for small amplitudes and for given ones, and the distance from tipping over."""

import math
import warnings
from collections.abc import Callable
from functools import partial
from typing import TypeVar

import mujoco
import numpy as np
import scipy

from wirerope_mj.dynamics.modes.rest import (
    AtRest,
    description_of,
    held_rigidly,
    linearise,
    participation_of,
    payload_shapes,
)
from wirerope_mj.dynamics.modes.result import Modes, NaturalFrequencies, TippingStability, paired
from wirerope_mj.engine.statics import Equilibrium, History, equilibrium
from wirerope_mj.engine.statics.linear import GIVES_WAY
from wirerope_mj.engine.statics.payloads import movers_of
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, ComplexArray
from wirerope_mj.foundation.errors import ConvergenceError, ModelWarning

CLOSE = 1e-6  # relative distance of eigenvalues whose shapes may turn into one another
# Relative change of the eigenvalue at which an iterated mode has converged, at the last amplitude and at those before.
TOLERANCE, LEADING = 1e-9, 1e-5
# Most iterations of a mode, those in which its shape may change, and those without damping.
ROUNDS, DISTINCT, DIRECT = 100, 40, 15
# Fraction of the largest eigenvalue below which an eigenvalue is rounding: the motion has no stiffness.
FREE = 1e-9
AnyArray = TypeVar("AnyArray", Array, ComplexArray)
# Amplitudes, each twice the last, over which a mode is followed from small amplitudes to the given one.
STEPS = 6


def solve(stiffness: Array, mass: Array, motions: Array) -> tuple[Array, Array]:
    """Find the eigenvalues [(rad/s)^2], (n_modes,), from the lowest on, and the shapes, phi^T M phi = 1, as columns.

    `motions` are the motions that equality constraints allow, as columns (n, n_modes): shapes are combinations of these.
    """
    values, shapes = scipy.linalg.eigh(motions.T @ stiffness @ motions, motions.T @ mass @ motions)
    values[np.abs(values) < FREE * np.abs(values).max(initial=0.0)] = 0.0
    return values, motions @ shapes


def frequency_of(values: Array) -> Array:
    """Convert eigenvalues [(rad/s)^2] to frequencies [Hz]; NaN for negative ones, whose motion is unstable."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sqrt(values) / (2.0 * np.pi))


def follow(values: Array, shapes: Array, mass: Array, known: Array, mode: int) -> tuple[float, Array]:
    """Find eigenvalue and shape of the mode that corresponds to column `mode` of the shapes `known`, (n, n_known).

    Each known shape is paired with a mode so that the sum of (phi^T M phi)^2 is largest: two modes whose frequencies come close
    are not confused. Modes of one frequency are combined to be as like the known shape as possible.
    """
    likeness = shapes.T @ mass @ known
    best = int(np.flatnonzero(paired(likeness**2) == mode)[0])
    close = np.abs(values - values[best]) <= CLOSE * np.abs(values).max()
    shape = shapes[:, close] @ likeness[close, mode]
    return float(values[best]), np.asarray(shape / np.sqrt(shape @ mass @ shape))


def iterate(
    stiffness: Callable[[Array, float], ComplexArray], rest: AtRest, known: Array, mode: int, start: tuple[float, Array],
    tolerance: float = TOLERANCE,
) -> tuple[float, Array, ComplexArray]:  # fmt: skip
    """Find eigenvalue, shape and complex stiffness of a mode by iteration: the stiffness follows from shape and frequency.

    Two modes of nearly one frequency mix easily, and may swap without end; then each keeps its known shape, whose Rayleigh
    quotient is right to the second order of the shape's error. `known` are the shapes of all modes for small
    amplitudes, phi^T M phi = 1, as columns; column `mode` is followed, from an eigenvalue and a shape, until the eigenvalue
    changes by less than `tolerance` of itself.
    """
    value, shape = start
    matrix = stiffness(shape, value)
    for count in range(ROUNDS):
        before = value
        if count < DISTINCT:
            value, shape = follow(*solve(matrix.real, rest.mass, rest.motions), rest.mass, known, mode)
        else:
            shape = known[:, mode]
            value = float(shape @ matrix.real @ shape)
        renewed = stiffness(shape, value)
        if abs(value - before) <= tolerance * max(abs(value), abs(before)):
            return value, shape, renewed
        matrix = renewed if count < DIRECT else 0.5 * (matrix + renewed)  # damps an alternating iteration
    return value, shape, matrix


def stability_of(system: System, rest: AtRest, tangent: Array, loading: Array) -> TippingStability:
    """Judge the stability against tipping from the mounts' stiffness: `tangent` at rest, and on further `loading`, (n, n)."""
    model, stiffness = system.model, rest.other + rest.weight + tangent
    values, _ = solve(stiffness, rest.mass, rest.motions)

    def critical(stiffness: Array, load: Array) -> float:
        """Find the smallest factor > 0 at which stiffness - factor * load is no longer positive definite."""
        stiffness, load = (rest.motions.T @ part @ rest.motions for part in (stiffness, load))
        try:
            grows = scipy.linalg.eigvalsh(load, stiffness)  # load v = (1 / factor) stiffness v
        except np.linalg.LinAlgError:
            return 0.0  # not positive definite without any load
        largest = float(grows.max(initial=0.0))
        return 1.0 / largest if largest > FREE else np.inf

    rise, up = np.inf, -model.opt.gravity
    size = float(np.linalg.norm(up))
    if size > 0.0:
        level = np.eye(3) - np.outer(up, up) / size**2
        for body in (body for mover in movers_of(system) for body in mover.bodies if model.body_dofnum[body]):
            turn, unused = np.zeros((3, model.nv)), np.zeros((3, model.nv))
            mujoco.mj_jacBody(model, rest.data, unused, turn, body)
            tilt = level @ turn[:, rest.free]
            # reduction of the stiffness against tilting by the body's weight per metre of height [N]
            rise = min(rise, critical(stiffness, float(model.body_subtreemass[body]) * size * tilt.T @ tilt))
    return TippingStability(
        smallest_eigenvalue=float(values.min(initial=np.inf)), gravity_factor=critical(rest.other + tangent, -rest.weight),
        rise=rise, softest=critical(rest.other + loading, -rest.weight),
    )  # fmt: skip


def modes(system: System, *, history: History = "virgin", amplitude: float | None = None) -> Modes:
    """Find the modes of `system` about its sagged position, the base at rest.

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

    Equality constraints are rigid: they leave fewer modes than there are coordinates. Contacts and limits that act at rest are
    as soft as MuJoCo has them.

    Warns:
        ModelWarning: no mount, joint or stop resists a motion of a body, see `equilibrium`; a contact or limit that acts at
            rest gives way.

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
    values, shapes = solve(held.real, rest.mass, rest.motions)
    if rest.pressed.names:
        # The frequencies with contacts and limits at rest taken as rigid must agree with those of their own softness.
        rigid, soft = held_rigidly(rest, held.real), frequency_of(values)
        rigid = rigid[rigid > 0.0]
        nearest = soft[[int(np.nanargmin(np.abs(soft - frequency))) for frequency in rigid]]
        moved = np.abs(nearest / rigid - 1.0)
        if moved.max(initial=0.0) > GIVES_WAY:
            most = int(np.argmax(moved))
            warnings.warn(
                f"{', '.join(rest.pressed.names)}: at rest it gives way as MuJoCo has it, here and in a simulation: a natural "
                f"frequency of {rigid[most]:.4g} Hz, if it were rigid, is {nearest[most]:.4g} Hz. Write "
                'solimp="0.9999 0.9999" into it, or weld what never parts.',
                ModelWarning, stacklevel=2,
            )  # fmt: skip
    tangents, bracket = springs.tangents(), []
    for part in tangents:  # frequencies in the order of the modes, paired by shape
        squares, others = solve(rest.other + rest.weight + part, rest.mass, rest.motions)
        bracket.append(frequency_of(squares[paired((shapes.T @ rest.mass @ others) ** 2)]))
    values, shapes, complexes = springs.iterated(values, shapes, amplitude)
    damping = np.full(values.size, math.nan)
    for i in np.flatnonzero(values > 0.0):  # loss over twice the stiffness, and of joint dampers
        shape, value = shapes[:, i], float(values[i])
        loss = float(shape @ complexes[i].imag @ shape) + math.sqrt(value) * float(shape @ rest.damping @ shape)
        damping[i] = loss / (2.0 * value * float(shape @ rest.mass @ shape))
    order = np.argsort(values, kind="stable")
    scaled = np.stack([springs.scaled(shapes[:, i]) for i in order], axis=1)
    whole = np.zeros((system.model.nv, order.size))
    whole[rest.free] = scaled
    participation, moving_mass = participation_of(system, rest, scaled)
    return Modes(
        frequencies=_frequencies(values[order], static),
        damping_ratio=damping[order], loading=bracket[0][order], unloading=bracket[1][order],
        shapes=whole, payloads=payload_shapes(system, rest, scaled),
        mounts={name: (mount.jacobian @ scaled).T for name, mount in rest.mounts.items()},
        participation=participation, moving_mass=moving_mass,
        descriptions=_descriptions(system, rest, values[order], scaled),
        stability=stability_of(system, rest, small if history == "virgin" else springs.lasting(), tangents[0]),
        history=history, amplitude=amplitude, free=rest.free, mass=rest.mass, stiffness=held.real, equilibrium=static,
    )  # fmt: skip


def natural_frequencies(system: System) -> NaturalFrequencies:
    """Find the frequencies of `modes` about the virgin equilibrium for small amplitude, in a third of its time.

    ConvergenceError: there is no such equilibrium.
    """
    static = equilibrium(system)
    rest = linearise(system, static)
    springs = _Springs(rest)
    values, shapes = solve(springs.held(np.zeros(rest.free.size), 0.0, 1.0).real, rest.mass, rest.motions)
    if len(springs.small) < len(rest.mounts):  # some depend on the frequency
        values, shapes, _ = springs.iterated(values, shapes, None)
    order = np.argsort(values, kind="stable")
    return NaturalFrequencies(
        frequencies=_frequencies(values[order], static),
        descriptions=_descriptions(system, rest, values[order], shapes[:, order]),
    )


def _frequencies(values: Array, static: Equilibrium) -> Array:
    return np.where((values < 0.0) & bool(static.free), 0.0, frequency_of(values))


def _descriptions(system: System, rest: AtRest, values: Array, shapes: Array) -> tuple[str, ...]:
    return tuple(
        description_of(system, rest, shape) + ("" if value > 0.0 else " (free)" if value == 0.0 else " (tips over)")
        for shape, value in zip(shapes.T, values, strict=True)
    )


class _Springs:
    """Complex stiffness of a system about rest, which depends on the shape, amplitude and frequency of the motion."""

    def __init__(self, rest: AtRest) -> None:
        self.rest = rest
        laws = {name: mount.isolator.axes.values() for name, mount in rest.mounts.items()}
        steady = [name for name, of in laws.items() if all(law is None or law.rate_independent for law in of)]
        # Stiffness at vanishing amplitude of rate-independent mounts, for any shape and frequency.
        self.small = {name: self._mount_stiffness(name, np.zeros(3), frequency=1.0) for name in steady}

    def held(self, shape: Array, amplitude: float, frequency: float) -> ComplexArray:
        """Evaluate the complex stiffness of the free coordinates [N/m, ...], (n, n), in the motion amplitude * shape."""
        total = (self.rest.other + self.rest.weight).astype(np.complex128)
        for name, mount in self.rest.mounts.items():
            small = amplitude == 0.0 and name in self.small
            if small:
                total += self.small[name]
            else:
                total += self._mount_stiffness(name, amplitude * (mount.jacobian @ shape), frequency)
        return total

    def _mount_stiffness(self, name: str, amplitude: Array, frequency: float) -> ComplexArray:
        """Evaluate the complex stiffness, (n, n), that a mount adds in cycles of signed amplitudes along its axes [m], (3,)."""
        mount = self.rest.mounts[name]
        return np.asarray(mount.jacobian.T @ _finite(name, mount.cycles(amplitude, frequency)) @ mount.jacobian)

    def at(self, amplitude: float, shape: Array, value: float) -> ComplexArray:
        """Evaluate the complex stiffness in `shape`, scaled to a largest mount deflection `amplitude` [m], at an eigenvalue."""
        frequency = float(np.sqrt(max(value, 0.0))) / (2.0 * np.pi) or 1.0  # an eigenvalue <= 0 has no frequency
        return self.held(self.scaled(shape), amplitude, frequency)

    def iterated(self, values: Array, shapes: Array, amplitude: float | None) -> tuple[Array, Array, ComplexArray]:
        """Iterate all modes from those for small amplitudes: eigenvalues, shapes, and the complex stiffness of each."""
        sizes = [0.0] if amplitude is None else [amplitude * 0.5**step for step in range(STEPS - 1, -1, -1)]
        complexes = np.zeros((values.size, *self.rest.mass.shape), dtype=np.complex128)
        values, shapes, known = values.copy(), shapes.copy(), shapes
        for mode in range(values.size):
            for size in sizes:
                start = float(values[mode]), shapes[:, mode]
                tolerance = TOLERANCE if size == sizes[-1] else LEADING
                mode_found = iterate(partial(self.at, size), self.rest, known, mode, start, tolerance)
                values[mode], shapes[:, mode], complexes[mode] = mode_found
        return values, shapes, complexes

    def lasting(self) -> Array:
        """Evaluate the stiffness of the mounts after long vibration, without hysteretic forces, (n, n)."""
        parts = [mount.jacobian.T @ mount.lasting() @ mount.jacobian for mount in self.rest.mounts.values()]
        return np.asarray(np.sum(parts, axis=0))

    def tangents(self) -> tuple[Array, Array]:
        """Evaluate the stiffness of the mounts on further loading and on unloading, (n, n) each."""
        loading, unloading = np.zeros_like(self.rest.mass), np.zeros_like(self.rest.mass)
        for name, mount in self.rest.mounts.items():
            on_loading, on_unloading = (_finite(name, part) for part in mount.tangents())
            loading += mount.jacobian.T @ on_loading @ mount.jacobian
            unloading += mount.jacobian.T @ on_unloading @ mount.jacobian
        return loading, unloading

    def scaled(self, shape: Array) -> Array:
        """Scale a shape so that its largest mount deflection is 1, its largest coordinate positive."""
        sizes = [float(np.linalg.norm(mount.jacobian @ shape)) for mount in self.rest.mounts.values()]
        largest = float(np.abs(shape).max())
        size = max(sizes) if max(sizes) > 1e-9 * largest else largest  # a motion that deflects no mount
        return np.asarray(shape / size * np.sign(shape[int(np.argmax(np.abs(shape)))]))


def _finite(name: str, stiffness: AnyArray) -> AnyArray:
    """Check the stiffness of a mount; ConvergenceError if it is not finite."""
    if np.isfinite(stiffness).all():
        return stiffness
    raise ConvergenceError(
        f"mount {name!r}: where it rests its laws have a stiffness that is not finite. Check the parameters of its isolator."
    )
