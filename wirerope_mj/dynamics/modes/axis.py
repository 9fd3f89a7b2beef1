"""Stiffness of one mount axis about its deflection at rest: tangents, closed cycles, and their limit of small amplitude."""

import numpy as np
import scipy

from wirerope_mj.dynamics.single_mass.cycle import cycle_force, require_steady
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import Law
from wirerope_mj.mounts.laws.registry import evaluate

SAMPLES = 256  # samples of a closed cycle: the area of a loop with sharp tips is then right to 1e-6
# Step [m] of the elastic part's central difference: its error is below 1e-9 of the slope for travels of millimetres.
_STEP = 1e-6
_SPEED = 1e-9  # step [m/s] of the derivative by the rate: far below any velocity over which a law smooths its friction


def one_sided_tangents(law: Law, deflection: float, states: Array) -> tuple[float, float]:
    """Evaluate the slopes of the force just after `deflection`, falling and rising [N/m].

    Exact for every rate-independent law: dF/dx = F_x + F_z dz/dx, with the law's own dz/dx for either direction.
    """
    elastic, force = elastic_slope(law, deflection, states), _force(law, deflection, 0.0, states)[0]

    def slope(direction: float) -> float:
        rates = _force(law, deflection, direction, states)[1]
        # Forces are linear in the states, but for sliders at their slip force: a step towards where they go is exact.
        return elastic + (_force(law, deflection, 0.0, states + _STEP * rates)[0] - force) / (_STEP * direction)

    return slope(-1.0), slope(1.0)


def loading_and_unloading(law: Law, deflection: float, states: Array) -> tuple[float, float]:
    """Evaluate the slopes on further loading and on unloading of the hysteretic force [N/m].

    Bouc-Wen's are alpha - (beta + gamma) |z|^n and alpha + (beta - gamma) |z|^n, each with the elastic part. Without a
    hysteretic force the sense is that of the deflection. A law that depends on the rate has one slope at rest.
    """
    if len(law.components) > 1:
        pairs = [loading_and_unloading(part, deflection, z) for part, z in _parts(law, states)]
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
        parts = _parts(law, states)
        return sum((vanishing_cycle(part, deflection, z, frequency=frequency) for part, z in parts), 0j)
    if law.rate_independent:
        steady, forces = states.copy(), _force_states(law)
        steady[forces] = 0.0
        if len(forces) == 1:
            steady[forces[0]] = balanced_force(law, deflection, steady, forces[0])
        down, up = one_sided_tangents(law, deflection, steady)
        return complex(0.5 * (down + up), 0.0)

    def slopes(deflection_step: float, rate_step: float, state_step: Array, size: float) -> tuple[float, Array]:
        (f_up, g_up), (f_down, g_down) = (
            _force(law, deflection + sign * deflection_step, sign * rate_step, states + sign * state_step)
            for sign in (1.0, -1.0)
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

    def gain(z: float) -> float:
        trial = states.copy()
        trial[index] = z
        up, down = _force(law, deflection, 1.0, trial)[1], _force(law, deflection, -1.0, trial)[1]
        return float(up[index] + down[index])  # of a step up and one down

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


def _force(law: Law, deflection: float, rate: float, states: Array) -> tuple[float, Array]:
    """Evaluate the force and the rates of the states."""
    rates = np.zeros(max(law.n_states, 1))
    held = states if law.n_states else np.zeros(1)
    force = evaluate(law.kernel, law.kernel_parameters(), 0, deflection, rate, held, 0, rates, 0)
    return float(force), rates[: law.n_states]


def _force_states(law: Law) -> list[int]:
    """Indices of the internal states that are hysteretic forces."""
    return [i for i, name in enumerate(law.state_names) if name.startswith(("z", "w"))]


def elastic_slope(law: Law, deflection: float, states: Array) -> float:
    """Differentiate the force by the deflection with the states held [N/m]."""
    above, below = (_force(law, deflection + step, 0.0, states)[0] for step in (_STEP, -_STEP))
    return (above - below) / (2.0 * _STEP)


def _parts(law: Law, states: Array) -> list[tuple[Law, Array]]:
    """Split the states among the laws in parallel."""
    ends = np.cumsum([part.n_states for part in law.components])
    return list(zip(law.components, np.split(states, ends[:-1]), strict=True))
