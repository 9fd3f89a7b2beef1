"""Bodies on hysteretic mounts by Newton's and Euler's equations, written here without MuJoCo and without the package.

Any number of free bodies, each with quaternion and principal axes, and a frame that the base carries on springs and dampers
along x, y and z. Positions count from the base, whose acceleration acts as a force on every mass. A mount takes its deflection
in the axes of its base site as that site turns, and both of its forces act at the payload's point. Along an axis it has

    F = exp(lam u) [k1 u + k2 u|u| + k3 u^3 + s1] + s2 + c u'  and a stop,    u: the deflection behind the bracket

with states s of Bouc and Wen, of a spring behind a damper, or of a spring behind a slider. SciPy's DOP853 integrates it, anew
behind each corner of the base's pulses, in steps so short that no kink is stepped over unseen.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

Array = np.ndarray

GRAVITY = 9.80665
BASE, FRAME = -2, -1  # what a mount may stand on, besides a body
NONE, BOUC_WEN, MAXWELL, JENKIN = range(4)  # kinds of a state
# columns of an axis: the law, two states with kind and four numbers, the stiffness of its bracket (0: none), the stop
LAM, K1, K2, K3, C, STATES, BRACKET, STOP = 0, 1, 2, 3, 4, 5, 15, 16
BELOW, ABOVE, STIFF, EXPONENT, ROUNDING, LOSS, REVERSAL, VISCOUS = range(STOP, STOP + 8)
COLUMNS = STOP + 8
PARTS = 4  # of a step of the integration, between which a peak is looked for
SLOTS = 4  # states of an axis: two of its law, the stop's, the deflection behind the bracket
_BODY, _FRAME = 13, 6  # position, quaternion, velocity, angular velocity in the body's axes; position and velocity


@dataclass(frozen=True, kw_only=True)
class Problem:
    """Bodies, mounts and the base's motion as tables.

    Attributes:
        masses, inertias, centres: of the bodies [kg], principal [kg m^2] (n, 3), of the modelled geometry [m] (n, 3).
        frame: mass [kg] (0: none), stiffness [N/m] (3,), damping [N s/m] (3,).
        points, axes: of the mounts [m] (m, 3), roll, shear and axial direction as columns (m, 3, 3).
        ends: number of the payload, and `BASE`, `FRAME` or the number of a body, (m, 2).
        laws: (m, 3, `COLUMNS`).
        pulses: sine 0 or sawtooth 1, start, duration [s], peak along x, y, z [m/s^2], (p, 6).
        record: sampling rate [Hz] and samples along x, y, z [m/s^2], (n, 3), linear between; from time zero.
    """

    masses: Array
    inertias: Array
    centres: Array
    frame: Array
    points: Array
    axes: Array
    ends: Array
    laws: Array
    pulses: Array
    record: tuple[float, Array]

    @property
    def tables(self) -> tuple[object, ...]:
        """What `_rates` takes behind instant and state."""
        rate, samples = self.record
        bodies = (self.masses, self.inertias, self.centres, self.frame)
        return (*bodies, self.points, self.axes, self.ends, self.laws, self.pulses, float(rate), samples)


@njit(cache=True)
def rotation_matrix(q: Array) -> Array:
    """Make the rotation matrix (3, 3) of a quaternion (4,), scalar first."""
    w, x, y, z = q / np.sqrt(np.sum(q * q))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@njit(cache=True)
def _base(t: float, pulses: Array, rate: float, samples: Array) -> Array:
    """Evaluate the acceleration of the base."""
    a = np.zeros(3)
    for pulse in pulses:
        s = (t - pulse[1]) / pulse[2]
        if 0.0 <= s <= 1.0:
            a += (np.sin(np.pi * s) if pulse[0] == 0.0 else s) * pulse[3:6]
    i = int(np.floor(t * rate))
    if 0 <= i < samples.shape[0] - 1:
        a += samples[i] + (t * rate - i) * (samples[i + 1] - samples[i])
    return a


@njit(cache=True)
def _state_slope(law: Array, which: int, z: float, sense: float) -> float:
    """Evaluate the rate of a hysteretic state over the deflection, which moves in the direction `sense`."""
    p = law[STATES + 5 * which :]
    if p[0] == BOUC_WEN:
        return p[1] - (p[3] + p[2] * np.sign(sense * z)) * abs(z) ** p[4]
    if p[0] == JENKIN:
        return p[1] if abs(z) < p[2] or z * sense < 0.0 else 0.0
    return p[1] if p[0] == MAXWELL else 0.0


@njit(cache=True)
def _pushed(law: Array, x: float, v: float, w: float) -> float:
    """Evaluate the force of a stop."""
    pressed = x < -law[BELOW]
    if not pressed and x <= law[ABOVE]:
        return 0.0
    side = -1.0 if pressed else 1.0
    depth = -x - law[BELOW] if pressed else x - law[ABOVE]
    r, slope = law[ROUNDING], 1.0
    if depth < r:
        t = depth / r
        depth, slope = r * (t**3 - 0.5 * t**4), t * t * (3.0 - 2.0 * t)
    else:
        depth -= 0.5 * r
    return side * max(law[STIFF] * depth ** law[EXPONENT] * (1.0 + law[LOSS] * side * w) + law[VISCOUS] * slope * side * v, 0.0)


@njit(cache=True)
def _force(law: Array, x: float, v: float, s: Array, rates: Array) -> float:
    """Evaluate the force along an axis and the rates of its states."""
    u, du = x, v
    k, lam = law[BRACKET], law[LAM]
    if k > 0.0:
        u = s[3]
        stretch = np.exp(lam * u)
        elastic = u * (law[K1] + law[K2] * abs(u) + law[K3] * u * u)
        held = stretch * (elastic + s[0]) + s[1]
        if law[C] > 0.0:
            du = (k * (x - u) - held) / law[C]
        else:
            slope = law[K1] + 2.0 * law[K2] * abs(u) + 3.0 * law[K3] * u * u + _state_slope(law, 0, s[0], v)
            du = k * v / (k + lam * stretch * (elastic + s[0]) + stretch * slope + _state_slope(law, 1, s[1], v))
        rates[3] = du
    for which in range(2):
        rates[which] = _state_slope(law, which, s[which], du) * du
        if law[STATES + 5 * which] == MAXWELL:
            rates[which] -= law[STATES + 5 * which + 2] * s[which]
    if law[LOSS] > 0.0:
        rates[2] = (v - abs(v) * s[2]) / law[REVERSAL]
    own = np.exp(lam * u) * (u * (law[K1] + law[K2] * abs(u) + law[K3] * u * u) + s[0]) + s[1] + law[C] * du
    return own + _pushed(law, x, v, s[2])


@njit(cache=True)
def _rates(
    t: float, y: Array, masses: Array, inertias: Array, centres: Array, frame: Array, points: Array, axes: Array, ends: Array,
    laws: Array, pulses: Array, rate: float, samples: Array,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """Evaluate the rates of all states, accelerations of the bodies (n, 3), and deflections and forces of the mounts (m, 3)."""
    bodies, mounts = masses.size, ends.shape[0]
    first = _BODY * bodies + _FRAME
    out, felt = np.zeros(y.size), _base(t, pulses, rate, samples)
    turns, spins = np.empty((bodies, 3, 3)), np.empty((bodies, 3))
    force, torque, on_frame = np.zeros((bodies, 3)), np.zeros((bodies, 3)), np.zeros(3)
    for b in range(bodies):
        state = y[_BODY * b : _BODY * (b + 1)]
        turns[b] = rotation_matrix(state[3:7])
        spins[b] = turns[b] @ state[10:13].copy()
    moved = y[_BODY * bodies : first]
    deflections, forces = np.empty((mounts, 3)), np.empty((mounts, 3))
    for m in range(mounts):
        p, foot = ends[m]
        arm = turns[p] @ (points[m] - centres[p])
        top, top_speed = y[_BODY * p : _BODY * p + 3] + arm, y[_BODY * p + 7 : _BODY * p + 10] + np.cross(spins[p], arm)
        frame_axes, spin, end, end_speed = axes[m].copy(), np.zeros(3), points[m].copy(), np.zeros(3)
        if foot == FRAME:
            end, end_speed = end + moved[:3], moved[3:].copy()
        elif foot >= 0:
            reach = turns[foot] @ (points[m] - centres[foot])
            frame_axes, spin = turns[foot] @ axes[m], spins[foot]
            end = y[_BODY * foot : _BODY * foot + 3] + reach
            end_speed = y[_BODY * foot + 7 : _BODY * foot + 10] + np.cross(spin, reach)
        d = frame_axes.T @ (top - end)
        v = frame_axes.T @ (top_speed - end_speed - np.cross(spin, top - end))
        for a in range(3):
            at = first + SLOTS * (3 * m + a)
            forces[m, a] = _force(laws[m, a], d[a], v[a], y[at : at + SLOTS], out[at : at + SLOTS])
        deflections[m] = d
        push = -frame_axes @ forces[m]
        force[p] += push
        torque[p] += np.cross(arm, push)
        if foot == FRAME:
            on_frame -= push
        elif foot >= 0:
            force[foot] -= push
            torque[foot] -= np.cross(top - y[_BODY * foot : _BODY * foot + 3], push)
    accelerations = np.empty((bodies, 3))
    for b in range(bodies):
        at = _BODY * b
        q, w = y[at + 3 : at + 7], y[at + 10 : at + 13]
        out[at : at + 3] = y[at + 7 : at + 10]
        out[at + 3] = -0.5 * np.sum(q[1:] * w)
        out[at + 4 : at + 7] = 0.5 * (q[0] * w + np.cross(q[1:], w))
        accelerations[b] = force[b] / masses[b]
        accelerations[b, 2] -= GRAVITY
        out[at + 7 : at + 10] = accelerations[b] - felt
        out[at + 10 : at + 13] = (turns[b].T @ torque[b] - np.cross(w, inertias[b] * w)) / inertias[b]
    if frame[0] > 0.0:
        out[first - 6 : first - 3] = moved[3:]
        out[first - 3 : first] = (on_frame - frame[1:4] * moved[:3] - frame[4:7] * moved[3:]) / frame[0] - felt
        out[first - 1] -= GRAVITY
    return out, accelerations, deflections, forces


@njit(cache=True)
def _observed(times: Array, states: Array, masses: Array, inertias: Array, centres: Array, frame: Array, points: Array,
              axes: Array, ends: Array, laws: Array, pulses: Array, rate: float, samples: Array) -> Array:  # fmt: skip
    """Evaluate accelerations of bodies, deflections and forces of mounts at all instants, (n_t, n + 2 m, 3)."""
    bodies, mounts = masses.size, ends.shape[0]
    seen = np.empty((times.size, bodies + 2 * mounts, 3))
    for i in range(times.size):
        _, seen[i, :bodies], seen[i, bodies : bodies + mounts], seen[i, bodies + mounts :] = _rates(
            times[i], states[i], masses, inertias, centres, frame, points, axes, ends, laws, pulses, rate, samples
        )
    return seen


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Accelerations of bodies, deflections and forces of mounts, in this order: channels (n_c,) of vectors.

    Attributes:
        samples: at the instants asked for, (n_t, n_c, 3).
        minimum, maximum: of the components, (n_c, 3).
        largest: of the vectors' norm, (n_c,).
    """

    samples: Array
    minimum: Array
    maximum: Array
    largest: Array


def solve(problem: Problem, times: Array, rtol: float) -> Solution:
    """Integrate from rest in the modelled geometry to the last of `times` [s], relative to the tolerance `rtol`."""
    tables = problem.tables
    bodies = problem.masses.size
    y = np.zeros(_BODY * bodies + _FRAME + SLOTS * 3 * len(problem.ends))
    for b in range(bodies):
        y[_BODY * b : _BODY * b + 3], y[_BODY * b + 3] = problem.centres[b], 1.0
    atol = np.full(y.size, 1e-4 * rtol)  # of positions [m] that move by millimetres
    atol[_BODY * bodies + _FRAME :] = np.tile([1e-2 * rtol * 1e3] * 2 + [1e-2 * rtol, 1e-4 * rtol], 3 * len(problem.ends))
    corners = {0.0, float(times[-1])}
    corners |= {float(c) for pulse in problem.pulses for c in (pulse[1], pulse[1] + pulse[2]) if c < times[-1]}
    ends = sorted(corners)
    samples, dense = [], []
    for begin, end in pairwise(ends):
        inner = 1e-12 * (end - begin)  # one side of a jump at a corner is meant

        def rates(t: float, y: Array, low: float = begin + inner, high: float = end - inner) -> Array:
            return _rates(min(max(t, low), high), y, *tables)[0]

        run = solve_ivp(rates, (begin, end), y, "DOP853", rtol=rtol, atol=atol, max_step=5e-4, dense_output=True)
        if not run.success:
            raise RuntimeError(run.message)
        inside = times[(times >= begin) & ((times < end) | (end == ends[-1]))]
        samples += [_seen(run.sol, inside, tables)] if inside.size else []
        parts = [np.linspace(*step, PARTS, endpoint=False) for step in pairwise(run.t)]
        dense.append((run.sol, np.append(np.concatenate(parts), end), inner))
        y = run.y[:, -1]
    least, most, norms = [], [], []
    for sol, instants, inner in dense:
        instants = np.clip(instants, instants[0] + inner, sol.t_max - inner)
        seen = _seen(sol, instants, tables)
        least.append(-_highest(lambda s: -s, seen, sol, instants, tables))
        most.append(_highest(lambda s: s, seen, sol, instants, tables))
        norms.append(_highest(lambda s: np.linalg.norm(s, axis=2)[:, :, np.newaxis], seen, sol, instants, tables)[:, 0])
    return Solution(
        samples=np.concatenate(samples), minimum=np.min(least, axis=0), maximum=np.max(most, axis=0),
        largest=np.max(norms, axis=0),
    )  # fmt: skip


def _seen(sol: Callable[[Array], Array], instants: Array, tables: tuple[object, ...]) -> Array:
    return _observed(instants, np.ascontiguousarray(sol(instants).T), *tables)


def _highest(
    of: Callable[[Array], Array], seen: Array, sol: Callable[[Array], Array], instants: Array, tables: tuple[object, ...]
) -> Array:
    """Find the largest values of what `of` makes of the channels, between the instants, too, (n_c, ..)."""
    values = of(seen)
    at = values.argmax(axis=0)
    best = values.max(axis=0)
    for channel, component in np.ndindex(best.shape):
        i = at[channel, component]
        low, high = instants[max(i - 1, 0)], instants[min(i + 1, instants.size - 1)]
        for _ in range(2):
            near = np.linspace(low, high, 17)
            found = of(_seen(sol, near, tables))[:, channel, component]
            j = int(found.argmax())
            low, high = near[max(j - 1, 0)], near[min(j + 1, 16)]
            best[channel, component] = max(best[channel, component], found[j])
    return best
