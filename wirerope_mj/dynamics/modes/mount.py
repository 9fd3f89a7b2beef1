"""Stiffness of a mount at rest along its three axes, on loading and in closed cycles; also of coupled axes."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from wirerope_mj.dynamics.single_mass.cycle import cycle_force, require_steady
from wirerope_mj.foundation.arrays import AnyArray, Array, ComplexArray
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.laws import BiaxialBoucWen, BoucWen, Law, LoopBoucWen, LoopCoupling
from wirerope_mj.mounts.laws.plane import asymmetry_of, elastic_of
from wirerope_mj.mounts.laws.registry import evaluate

SAMPLES = 256  # samples of a closed cycle: the area of a loop with sharp tips is then right to 1e-6
# Step [m] of the elastic part's central difference: its error is below 1e-9 of the slope for travels of millimetres.
_STEP = 1e-6
_SPEED = 1e-9  # step [m/s] of the derivative by the rate: far below any velocity over which a law smooths its friction
Evaluated = Callable[[float, float, Array], tuple[float, Array]]  # force and rates of the states, see `_evaluator`


def one_sided_tangents(law: Law, deflection: float, states: Array) -> tuple[float, float]:
    """Evaluate the slopes of a law's force as the deflection begins to fall, and to rise, from `deflection` [N/m].

    Exact for every rate-independent law F(x, z): dF/dx = F_x + F_z dz/dx, with the law's own dz/dx for either direction.
    """
    evaluated = _evaluator(law)
    elastic, (force, _) = _slope(evaluated, deflection, states), evaluated(deflection, 0.0, states)

    def slope(direction: float) -> float:
        _, rates = evaluated(deflection, direction, states)
        # Forces are linear in the states, but for sliders at their slip force: a step along the rates is exact.
        moved, _ = evaluated(deflection, 0.0, states + _STEP * rates)
        return elastic + (moved - force) / (_STEP * direction)

    return slope(-1.0), slope(1.0)


def loading_and_unloading(law: Law, deflection: float, states: Array) -> tuple[float, float]:
    """Evaluate the slopes on further loading and on unloading of the hysteretic force [N/m].

    Bouc-Wen's are alpha - (beta + gamma) |z|^n and alpha + (beta - gamma) |z|^n, each with the elastic part. Without a
    hysteretic force the sense is that of the deflection. A law that depends on the rate has one slope at rest.
    """
    if len(law.components) > 1:
        pairs = [loading_and_unloading(part, deflection, z) for part, z in _component_states(law, states)]
        return sum(on for on, _ in pairs), sum(back for _, back in pairs)
    if not law.rate_independent:
        slope = elastic_slope(law, deflection, states)
        return slope, slope
    down, up = one_sided_tangents(law, deflection, states)
    z = sum(states[i] for i in _force_states(law))
    sense = z if z != 0.0 else deflection
    return (up, down) if sense >= 0.0 else (down, up)


def vanishing_cycle(law: Law, deflection: float, states: Array, *, frequency: float) -> complex:
    """Evaluate stiffness + i * loss [N/m] of a closed cycle about `deflection` as its amplitude goes to zero.

    Cycles of a rate-independent law with one hysteretic force carry it to where both directions have the same slope dz/dx: to
    zero for Bouc-Wen's law, so that its slope is alpha there. Masing's sliders all stick. Nothing is lost in the limit. A
    law that depends on the rate is linearised at rest: F_x + i w F_v + F_z (i w - G_z)^-1 (G_x + i w G_v) with zdot = G. Of
    the `states` only wear matters.
    """
    if len(law.components) > 1:
        parts = _component_states(law, states)
        return sum((vanishing_cycle(part, deflection, z, frequency=frequency) for part, z in parts), 0j)
    if law.rate_independent:
        steady, forces = states.copy(), _force_states(law)
        steady[forces] = 0.0
        if len(forces) == 1:
            steady[forces[0]] = balanced_force(law, deflection, steady, forces[0])
        down, up = one_sided_tangents(law, deflection, steady)
        return complex(0.5 * (down + up), 0.0)

    evaluated = _evaluator(law)

    def slopes(deflection_step: float, rate_step: float, state_step: Array, size: float) -> tuple[float, Array]:
        (f_up, g_up), (f_down, g_down) = (
            evaluated(deflection + sign * deflection_step, sign * rate_step, states + sign * state_step) for sign in (1.0, -1.0)
        )
        return (f_up - f_down) / (2.0 * size), (g_up - g_down) / (2.0 * size)

    s, n, none = 1j * (2.0 * np.pi * frequency), law.n_states, np.zeros(law.n_states)
    f_x, g_x = slopes(_STEP, 0.0, none, _STEP)
    f_v, g_v = slopes(0.0, _SPEED, none, _SPEED)
    stiffness = f_x + s * f_v
    if n:
        by_state = [slopes(0.0, 0.0, unit, 1.0) for unit in np.eye(n)]
        f_z, g_z = np.array([f for f, _ in by_state]), np.stack([g for _, g in by_state], axis=1)
        stiffness += f_z @ np.linalg.solve(s * np.eye(n) - g_z, g_x + s * g_v)
    return complex(stiffness)


def balanced_force(law: Law, deflection: float, states: Array, index: int) -> float:
    """Find the hysteretic force that a small closed cycle neither raises nor lowers [N]."""
    evaluated = _evaluator(law)

    def gain(z: float) -> float:
        trial = states.copy()
        trial[index] = z
        (_, up), (_, down) = (evaluated(deflection, rate, trial) for rate in (1.0, -1.0))
        return float(up[index] + down[index])  # gain of a step up and a step down

    at_zero = gain(0.0)
    if at_zero == 0.0:
        return 0.0
    reach = law.initial_stiffness * _STEP
    for _ in range(100):
        end = reach if at_zero > 0.0 else -reach
        if gain(end) * at_zero <= 0.0:
            return float(scipy.optimize.brentq(gain, 0.0, end, xtol=1e-14 * reach, rtol=1e-14))
        reach *= 2.0
    return 0.0


def closed_cycle(law: Law, deflection: float, amplitude: float, *, frequency: float) -> complex:
    """Evaluate stiffness + i * loss [N/m] of the closed cycle deflection + amplitude cos(w t): its first harmonic.

    F ~ mean + Re[(K + i H) amplitude exp(i w t)]: K is the describing function, H = W / (pi amplitude^2) with the energy W of
    the cycle.

    Raises:
        ValueError: the law wears and has no closed cycle, or its force leaves the finite numbers on the way.
    """
    angle, force = cycle_samples(law, deflection, amplitude, frequency)
    if not np.isfinite(force).all():
        raise ValueError(
            f"`amplitude` is too large: the force of {law.name} leaves the finite numbers within {amplitude:.6g} m of the "
            f"deflection of {deflection:.6g} m."
        )
    return 2.0 * complex(force @ np.exp(-1j * angle)) / (SAMPLES * amplitude)


def cycle_samples(law: Law, deflection: float, amplitude: float, frequency: float) -> tuple[Array, Array]:
    """Sample phase and force of a closed cycle, (SAMPLES,) each."""
    require_steady(law)
    angle = 2.0 * np.pi * np.arange(SAMPLES + 1) / SAMPLES
    shape, rate = amplitude * np.cos(angle), -2.0 * np.pi * frequency * amplitude * np.sin(angle)
    with np.errstate(over="ignore", invalid="ignore"):
        force = cycle_force(law, deflection + shape, rate, period=1.0 / frequency)
    return angle[:-1], force[:-1]


@lru_cache(maxsize=256)
def _evaluator(law: Law) -> Evaluated:
    """Make a function of deflection [m], its rate [m/s] and states, (n_z,), for the force [N] and the rates of the states."""
    parameters, n_states = law.kernel_parameters(), law.n_states  # once: there are many evaluations

    def evaluated(deflection: float, rate: float, states: Array) -> tuple[float, Array]:
        rates, held = np.zeros(max(n_states, 1)), states if n_states else np.zeros(1)
        return float(evaluate(law.kernel, parameters, 0, deflection, rate, held, 0, rates, 0)), rates[:n_states]

    return evaluated


def _force_states(law: Law) -> list[int]:
    return [i for i, name in enumerate(law.state_names) if name.startswith(("z", "w"))]


def elastic_slope(law: Law, deflection: float, states: Array) -> float:
    """Differentiate the force by the deflection with the states held [N/m]."""
    return _slope(_evaluator(law), deflection, states)


def _slope(evaluated: Evaluated, deflection: float, states: Array) -> float:
    (above, _), (below, _) = (evaluated(deflection + step, 0.0, states) for step in (_STEP, -_STEP))
    return (above - below) / (2.0 * _STEP)


def _component_states(law: Law, states: Array) -> list[tuple[Law, Array]]:
    ends = np.cumsum([part.n_states for part in law.components])
    return list(zip(law.components, np.split(states, ends[:-1]), strict=True))


Coupled = BiaxialBoucWen | LoopBoucWen
# Amplitude [m] below which a cycle is the vanishing one: forces of kilonewtons are rounded at 1e-4 N/m of slope there.
SMALL = 1e-8
# Samples of a cycle of the loop's energy, whose stiffness jumps at the ends of its box: a few parts in ten thousand there.
FINE = 2048
# Most iterations of a cycle on brackets, and the change of its amplitudes, relative to the whole amplitude, that ends them.
ROUNDS, ALIKE = 100, 1e-10


def plane_tangents(coupled: Coupled, deflection: Array, z: Array) -> tuple[Array, Array]:
    """Evaluate the stiffness of two coupled axes on further loading and on unloading [N/m], (2, 2) each.

    With the bounds z_m of the forces z, the yield deflections x_y, w = z / z_m and its unit vector e:

        dz/dx = diag(z_m) [1 - c |w|^n e e^T] diag(1 / x_y),   c = 1 on loading and 1 - 2 sigma on unloading;

    the axial row is multiplied by F2 = exp(b x), and a rope loop's energy adds its stiffness. Where the axes' energies z_m x_y
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
        held = np.diag([_slope_at_force(law, place, push) for law, place, push in axes])
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
    """Evaluate stiffness + i * loss of both axes in a closed cycle along a line [N/m], (2,), without the loop's energy.

    The closed cycle has w parallel to the scaled motion u = x / x_y, so that the hysteretic force of each axis is that of its
    own law at the amplitude x_y |u|, in proportion to its own motion; the elastic parts, and F2, stay those of the axes.
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
            elastic = _slope_at_force(law, x, 0.0)
        else:
            elastic = float(2.0 * _elastic_force(law, x + moved * cosine) @ cosine / (SAMPLES * moved))
        stiffness[axis] = hysteretic + elastic
    return stiffness


def loop_cycle(loop: LoopCoupling, deflection: Array, amplitude: Array) -> Array:
    """Evaluate the stiffness of a rope loop's elastic energy in the cycle deflection + amplitude cos(w t) [N/m], (2, 2).

    Times the amplitude it is the first harmonic of the force: the mean of the second derivatives with the weight 2 sin^2.
    """
    if float(np.hypot(*amplitude)) < SMALL:
        return loop.stiffness(deflection)
    angle = np.pi * (np.arange(FINE) + 0.5) / FINE  # half a cycle: the return passes the same deflections
    along = loop.stiffness(deflection + np.cos(angle)[:, None] * amplitude)
    return np.asarray(np.einsum("t,tij->ij", 2.0 / FINE * np.sin(angle) ** 2, along))


def plane_stiffness(coupled: Coupled, deflection: Array, amplitude: Array) -> ComplexArray:
    """Evaluate the complex stiffness of two coupled axes in a closed cycle [N/m], (2, 2), for signed amplitudes [m], (2,).

    On brackets the mount's own cycle is taken for a straight line, too, with its share of the amplitudes by its stiffness.
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
    """Compute the stiffness of two axes on brackets K [N/m], (2, 2): F = T d and x = d + F / K give T (1 + T / K)^-1."""
    if brackets is None:
        return stiffness
    return np.asarray(stiffness @ np.linalg.inv(np.eye(2) + stiffness / np.array(brackets)[:, None]))


@lru_cache(maxsize=64)
def _without_elastic_part(law: Law) -> Law:
    alpha, beta, gamma, n = (float(value) for value in law.kernel_parameters()[:4])
    return BoucWen(alpha=alpha, beta=beta, gamma=gamma, n=n)


def _elastic_force(law: Law, x: Array | float) -> Array:
    """Evaluate the elastic force F1 = k1 x + k2 x |x| + k3 x^3 [N], shape of x."""
    k1, k2, k3 = elastic_of(law)
    return np.asarray(x * (k1 + k2 * np.abs(x) + k3 * x * x))


def _slope_at_force(law: Law, x: float, z: float) -> float:
    """Differentiate the force exp(b x) (z + F1(x)) by the deflection x, hysteretic force z held [N/m]; F1: `_elastic_force`."""
    k1, k2, k3 = elastic_of(law)
    slope = float(k1 + 2.0 * k2 * abs(x) + 3.0 * k3 * x * x)
    exponent = asymmetry_of(law)
    if exponent == 0.0:
        return slope
    return math.exp(exponent * x) * (slope + exponent * (z + float(_elastic_force(law, x))))


@dataclass(frozen=True, kw_only=True)
class MountAtRest:
    """A mount at rest: its deflection, states and jacobian, from which its stiffness is evaluated."""

    isolator: Isolator
    deflection: Array  # roll, shear, axial [m], (3,)
    states: tuple[Array, Array, Array]  # internal states of each axis
    jacobian: Array  # derivative of the deflection by the free velocity coordinates, (3, n)

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
        """Evaluate the stiffness after long vibration, without hysteretic forces [N/m], (3, 3)."""
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
        """Evaluate stiffness + i * loss [N/m], (3, 3), of closed cycles about rest with signed amplitudes along the axes."""
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
