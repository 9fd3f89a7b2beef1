"""The loop that a law draws along a path of deflections, in time where it depends on the rate.

Where the state has a closed form, or there is none, what is left is the work, a Gauss-Legendre sum on intervals that end at
reversals. A smoothed law, and any other with one state, is integrated by Dormand and Prince's adaptive pair 5(4).
"""

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.cubic import NODES, WEIGHTS, position, reversals, shifted, speed, zero_between
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.loop import Loop
from wirerope_mj.mounts.laws.path import SCRATCH, advance_single, follow_path, put
from wirerope_mj.mounts.laws.registry import PARALLEL, RATE_DEPENDENT, component, evaluate, evaluate_single
from wirerope_mj.mounts.laws.stop import STOP
from wirerope_mj.mounts.laws.stop_kernels import VISCOUS, stop_work
from wirerope_mj.mounts.laws.viscous import KELVIN_VOIGT, TINKER_CUTCHINS, ZENER, zener_state
from wirerope_mj.mounts.laws.wrapped import SMOOTHED

# Error of a step as a fraction of the state, or of what it would gain over the interval, and likewise of the work, whose power
# has kinks of its own at the knots of a table; hundreds of steps stay below 1e-8.
TOLERANCE = 1e-11
# Fraction of an interval below which a failing step can only be a kink, whose contribution is below rounding.
_SMALLEST = 1e-9
# Fraction below which steps are rare, around kinks; where they are not, errors are rounding, which no shorter step mends: each
# raises the smallest by this much, so that an interval takes some 1e4 steps at most.
_RARE, _RAISED = 1e-4, 1.02
# Fraction of an interval that a step takes at most: the first has nothing to go by.
_WIDEST = 0.5
_ABSCISSAE = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_STAGES = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_ERROR = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@njit
def slope_at(law, p, i, cubic, t, z, scratch):
    """Return the rate of the state [N/s] and the power [W] at the instant t of a cubic path in the state z."""
    scratch[0], v = z, speed(cubic, t)
    force = evaluate_single(law, p, i, position(cubic, t), v, scratch, 0, scratch, 1)
    return scratch[1], force * v


@njit
def integrate_in_time(law, p, i, cubic, start, end, z, j):
    """Carry the state `z[j]` in place from `start` to `end` and return the work done on the law [J]; NaN if it diverges."""
    k, scratch = np.empty((7, 2)), np.empty(2)
    t, step, smallest, work, now = start, _WIDEST * (end - start), _SMALLEST * (end - start), 0.0, z[j]
    # Beside a reversal, or where the force is the small difference of its parts, there is little but rounding of what is large
    # elsewhere: errors are fractions of what the whole path from its sample on would lead to.
    farthest, fastest, most_gain, most_force = 0.0, 0.0, 0.0, abs(now)
    for quarter in range(5):
        farthest = max(farthest, abs(position(cubic, 0.25 * quarter * end)))
        fastest = max(fastest, abs(speed(cubic, 0.25 * quarter * end)))
    for sign in (-1.0, 1.0):
        scratch[0] = now
        force = evaluate_single(law, p, i, sign * farthest, sign * fastest, scratch, 0, scratch, 1)
        if np.isfinite(force) and np.isfinite(scratch[1]):
            most_gain, most_force = max(most_gain, abs(scratch[1])), max(most_force, abs(force))
    floors = (most_gain * (end - start), most_force * fastest * (end - start))
    k[0] = slope_at(law, p, i, cubic, t, now, scratch)
    while t < end:
        step = min(step, end - t)
        for stage in range(1, 7):
            after, gain = now, 0.0
            for before in range(stage):
                after += step * _STAGES[stage, before] * k[before, 0]
                gain += step * _STAGES[stage, before] * k[before, 1]
            k[stage] = slope_at(law, p, i, cubic, t + _ABSCISSAE[stage] * step, after, scratch)
        ratio = 0.0
        for column, first, last in ((0, now, after), (1, work, work + gain)):
            size, error = max(abs(first), abs(last), floors[column]), 0.0
            for stage in range(7):
                size = max(size, abs(k[stage, column]) * (end - start))
                error += step * _ERROR[stage] * k[stage, column]
            ratio = max(ratio, abs(error) / (TOLERANCE * size + 1e-300))
        if not (np.isfinite(after) and np.isfinite(gain)):
            ratio = np.inf
        if ratio > 1.0 and step > smallest:
            step *= max(0.2, 0.9 * ratio**-0.2)
            continue
        if ratio == np.inf:
            z[j] = np.nan
            return np.nan
        if step < _RARE * (end - start):
            smallest *= _RAISED
        # An interval between a reversal and a sample may be as short as the rounding of its instants.
        t = end if step >= end - t or t + step <= t else t + step
        now, work = after, work + gain
        k[0, 0], k[0, 1] = k[6, 0], k[6, 1]
        step = max(smallest, min(step * min(5.0, 0.9 * (min(ratio, 1.0) + 1e-10) ** -0.2), _WIDEST * (end - start)))
    z[j] = now
    return work


# Ratio of the rates at the ends of an interval up to which |v|^n and tanh(v / s) are smooth on it to 1e-9.
_GROWTH = 3.0
_NARROWEST = 1e-6  # Fraction of a sample's interval below which an interval is not cut any further


@njit
def smooth_interval(law, p, i, cubic, start, end, shortest):
    """Return how far from `start` the next interval may reach, so that the power is smooth on it."""
    width = end - start
    if law == ZENER:
        return min(width, 1.0 / p[i + 2])
    if law == SMOOTHED:
        bend = p[i]
    elif law == TINKER_CUTCHINS and not (p[i + 4] == 1.0 and p[i + 5] == 0.0 and p[i + 6] == 0.0 and p[i + 7] == 0.0):
        bend = p[i + 8]
    else:
        return width
    v0 = abs(speed(cubic, start))
    while width > shortest:
        v1 = abs(speed(cubic, start + width))
        if max(v0, v1) <= _GROWTH * min(v0, v1) + bend:
            break
        width *= 0.5
    return width


@njit
def work_over(law, p, i, cubic, start, end, z, j, n_states, trial, unused):
    """Carry the states `z[j:]` in place over start <= t <= end, without a reversal, and return the work done on the law [J]."""
    if law == STOP and p[i + VISCOUS] != 0.0:
        return stop_work(p, i, cubic, start, end, z, j)
    if law not in RATE_DEPENDENT:
        return advance_single(law, p, i, position(cubic, start), position(cubic, end), z, j, n_states, unused, trial)
    work, shortest = 0.0, _NARROWEST * (end - start)
    origin = z[j] if law == ZENER else 0.0
    begun = start
    while start < end:
        width = smooth_interval(law, p, i, cubic, start, end, shortest)
        if n_states > 0 and law != ZENER:
            work += integrate_in_time(law, p, i, cubic, start, min(start + width, end), z, j)
            start = end if start + width >= end else start + width
            continue
        for node in range(8):
            t = start + width * NODES[node]
            if law == ZENER:
                trial[0] = zener_state(p[i + 1], p[i + 2], shifted(cubic, begun), origin, t - begun)
            v = speed(cubic, t)
            work += width * WEIGHTS[node] * v * evaluate_single(law, p, i, position(cubic, t), v, trial, 0, unused, 0)
        start = end if start + width >= end else start + width
    if law == ZENER:
        z[j] = zener_state(p[i + 1], p[i + 2], shifted(cubic, begun), origin, end - begun)
    return work


@njit
def work_of_law(law, p, cubic, start, end, z, n_states, trial, unused):
    """Advance the states `z` of a law, or of several in parallel, in place over start <= t <= end; return the work [J]."""
    if law != PARALLEL:
        return work_over(law, p, 0, cubic, start, end, z, 0, n_states, trial, unused)
    work = 0.0
    for part in range(int(p[0])):
        one, first, state, count = component(p, 0, part, n_states)
        work += work_over(one, p, first, cubic, start, end, z, state, count, trial, unused)
    return work


@njit
def follow_time(law, p, time, deflection, rate, z, n_states):
    """Return force (n_t,), states (n_t, n_states) and cumulated work (n_t,), with `rate` at the samples `time`."""
    n_t = deflection.size
    force, states, work = np.empty(n_t), np.empty((n_t, n_states)), np.zeros(n_t)
    trial, unused = np.empty(n_states + 1), np.empty(SCRATCH * (n_states + 1))
    for t in range(n_t):
        if t > 0:
            h = time[t] - time[t - 1]
            cubic, one, two = reversals(deflection[t - 1], deflection[t], rate[t - 1], rate[t], h)
            work[t], start = work[t - 1], 0.0
            for end in (one, two, h):
                if end > start and law not in (KELVIN_VOIGT, ZENER) and position(cubic, start) * position(cubic, end) < 0.0:
                    middle = zero_between(cubic, start, end)  # friction or a polynomial may have a kink there
                    work[t] += work_of_law(law, p, cubic, start, middle, z, n_states, trial, unused)
                    start = middle
                if end > start:
                    work[t] += work_of_law(law, p, cubic, start, end, z, n_states, trial, unused)
                    start = end
        put(z, 0, states[t], 0, n_states)
        force[t] = evaluate(law, p, 0, deflection[t], rate[t], z, 0, unused, 0)
    return force, states, work


def trace(
    law: Law, deflection: ArrayLike, *, time: ArrayLike | None = None, rate: ArrayLike | None = None,
    initial_states: ArrayLike | None = None,
) -> Loop:  # fmt: skip
    """Return the loop of a law; arguments and errors as in `Law.trace`."""
    path = np.asarray(deflection, dtype=np.float64)
    law.check_path(path)
    n_states = law.n_states
    states = np.zeros(n_states) if initial_states is None else np.array(initial_states, dtype=np.float64)
    if states.shape != (n_states,) or not np.isfinite(states).all():
        raise ValueError(f"`initial_states` must be {n_states} finite numbers, got {initial_states!r}.")
    if law.rate_independent:
        force, history, work = follow_path(law.kernel, law.kernel_parameters(), path, states, n_states)
    else:
        if time is None:
            raise ValueError(f"`time` must be given: the force of {law.name} depends on the deflection rate.")
        times = np.asarray(time, dtype=np.float64)
        if times.shape != path.shape:
            raise ValueError(f"`time` must have the shape of the deflection, {path.shape}, got {times.shape}.")
        if not np.isfinite(times).all() or (np.diff(times) <= 0.0).any():
            raise ValueError("`time` must be finite and strictly increasing.")
        if rate is None:  # differences that are exact for a parabola
            rates = np.gradient(path, times, edge_order=2 if path.size > 2 else 1)
        else:
            rates = np.asarray(rate, dtype=np.float64)
        if rates.shape != path.shape or not np.isfinite(rates).all():
            raise ValueError(f"`rate` must be finite and of shape {path.shape}, got shape {rates.shape}.")
        force, history, work = follow_time(law.kernel, law.kernel_parameters(), times, path, rates, states, n_states)
    finite = np.isfinite(force) & np.isfinite(work)
    if not finite.all():
        last = max(int(np.argmin(finite)) - 1, 0)
        end = _last_finite(law, path[last], path[last + 1], history[last])
        raise ValueError(f"the force of {law} leaves the finite numbers at a deflection of {end:.6g} m.")
    forces = [i for i, name in enumerate(law.state_names) if name.startswith("z")]
    z = history[:, forces].sum(axis=1)
    return Loop(deflection=path, force=force, hysteretic_state=z, work=work, internal_states=history)


def _last_finite(law: Law, start: float, stop: float, states: Array) -> float:
    """Return the deflection up to which a rate-independent law, from `start` towards `stop`, has a finite force [m]."""
    if not law.rate_independent:
        return stop
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        path = np.array([start, start + middle * (stop - start)])
        force, _, work = follow_path(law.kernel, law.kernel_parameters(), path, states.copy(), law.n_states)
        low, high = (middle, high) if np.isfinite([force[1], work[1]]).all() else (low, middle)
    return start + low * (stop - start)
