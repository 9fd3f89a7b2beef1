"""Steady cycles of a law under a periodic deflection, by the law's own exact steps.

A sampled periodic deflection has its turning points between samples. They belong to the path, for the force of a
rate-independent law depends on them alone: without them the loop would lose its tips, and the force would not be smooth in the
samples.
"""

from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws import BoucWenBaberNoori, Law, Loop
from wirerope_mj.mounts.laws.cubic import position, reversals
from wirerope_mj.mounts.laws.path import put
from wirerope_mj.mounts.laws.power import ORDER
from wirerope_mj.mounts.laws.registry import PARALLEL, component, evaluate
from wirerope_mj.mounts.laws.steady import carry, next_start
from wirerope_mj.mounts.laws.timed import follow_time

_ROUNDS = 200  # most cycles until the states are taken for steady; the secant needs fewer than ten, sliders two
_CLOSED = 4e-16  # difference of the states after a cycle, over the largest state, that is rounding


@njit
def path_between(deflection, rate, interval):
    """Insert the turning points between samples into a closed path, and find the samples' indices on it, (n_t,).

    Between samples the deflection is the cubic through deflections and rates; the last sample repeats the first.
    """
    n_t = deflection.size
    path, place, count = np.empty(3 * n_t), np.zeros(n_t, np.int64), 1
    path[0] = deflection[0]
    for t in range(1, n_t):
        cubic, first, second = reversals(deflection[t - 1], deflection[t], rate[t - 1], rate[t], interval)
        for instant in (first, second):
            if 0.0 < instant < interval:
                path[count] = position(cubic, instant)
                count += 1
        path[count] = deflection[t]
        place[t] = count
        count += 1
    return path[:count], place


@njit
def turning_points(path):
    """Select the ends of a closed path and its turning points between them."""
    turning, count = np.empty(path.size), 1
    turning[0] = path[0]
    for t in range(1, path.size - 1):
        if (path[t] - turning[count - 1]) * (path[t + 1] - path[t]) < 0.0:
            turning[count] = path[t]
            count += 1
    turning[count] = path[-1]
    return turning[: count + 1]


@njit
def round_path(law, p, turning, z, c, a):
    """Carry the states `z` of a law with parameters `p` from turning point to turning point [m]; False if one is not finite.

    `c` and `a` are scratch.
    """
    fine = True
    for t in range(1, turning.size):
        fine = fine and carry(law, p, turning[t - 1], turning[t], z, c, a)
    return fine


@njit
def lead_each(p, start, z, memory, cycle):
    """Take a secant step of the start states of laws in parallel towards a closed cycle; False if all cycles are closed.

    The laws are uncoupled. A row of `memory`, (n_states, 6), holds the last two starts and gains, and the bracket.
    """
    moves = False
    for part in range(int(p[0])):
        _, _, state, count = component(p, 0, part, z.size)
        if count != 1:
            continue
        starts, gains, bracket = memory[state, :2], memory[state, 2:4], memory[state, 4:]
        starts[0], gains[0] = starts[1], gains[1]
        starts[1], gains[1] = start[state], z[state] - start[state]
        small = abs(gains[1]) < 1e-13 * abs(z[state])
        if gains[1] == 0.0 or (cycle > 3 and small and abs(gains[1]) >= abs(gains[0])):
            continue  # closed, to rounding
        moves = True
        z[state] = next_start(starts, gains, bracket)
    return moves


@njit
def largest_entry(values):
    """Find the largest magnitude in an array, NaN if it holds one."""
    # no array expression of NumPy's: Numba names its code by an address, and no two builds would give the same bytes
    size = 0.0
    for value in values.flat:
        if abs(value) > size or np.isnan(value):
            size = abs(value)
    return size


@njit
def largest_difference(first, second):
    """Find the largest magnitude by which the entries of two arrays (n,) differ, NaN if one does."""
    difference = np.empty(first.size)
    for k in range(first.size):
        difference[k] = first[k] - second[k]
    return largest_entry(difference)


@njit
def closed_states(law, p, turning, n_states):
    """Find the states (n_states,) of a rate-independent law at the start of a cycle that are the same at its end.

    The law enters unloaded at zero deflection. A single state is found by the secant method on its gain in a cycle, within a
    bracket, as is that of each law in parallel with one state; others by repeating the cycle. NaN if the force is not finite.
    """
    z, start, before = np.zeros(n_states), np.zeros(n_states), np.zeros(n_states)
    memory = np.zeros((n_states, 6))
    memory[:, 4], memory[:, 5] = -np.inf, np.inf
    c, a = np.empty(ORDER + 1), np.empty(ORDER + 1)
    fine = carry(law, p, 0.0, turning[0], z, c, a) if n_states > 0 else True
    starts, gains, bracket = np.zeros(2), np.zeros(2), np.array([-np.inf, np.inf])
    for cycle in range(_ROUNDS if n_states > 0 else 0):
        put(z, 0, start, 0, n_states)
        fine = fine and round_path(law, p, turning, z, c, a)
        if not fine or largest_difference(z, start) <= _CLOSED * max(largest_entry(z), largest_entry(start)):
            break
        if n_states > 1:
            if cycle > 1 and largest_difference(z, before) == 0.0:  # two states that alternate by rounding
                break
            put(start, 0, before, 0, n_states)
            if law == PARALLEL and not lead_each(p, start, z, memory, cycle) and cycle > 3:
                break
            continue
        starts[0], gains[0] = starts[1], gains[1]
        starts[1], gains[1] = start[0], z[0] - start[0]
        if cycle > 3 and abs(gains[1]) >= abs(gains[0]) and abs(gains[1]) < 1e-13 * abs(z[0]):
            break  # rounding
        z[0] = next_start(starts, gains, bracket)
    if not fine:
        start[:] = np.nan
    return start


@njit
def steady_force(law, p, deflection, rate, interval, n_states):
    """Evaluate the force of a rate-independent law at the samples of a closed cycle (n_t,); NaN from where it is not finite."""
    path, place = path_between(deflection, rate, interval)
    z = closed_states(law, p, turning_points(path), n_states)
    c, a, unused = np.empty(ORDER + 1), np.empty(ORDER + 1), np.empty(n_states + 1)
    force, sample = np.full(deflection.size, np.nan), 0
    for t in range(path.size):
        if not (largest_entry(z) < np.inf and (t == 0 or carry(law, p, path[t - 1], path[t], z, c, a))):
            break
        if t == place[sample]:
            force[sample] = evaluate(law, p, 0, path[t], 0.0, z, 0, unused, 0)
            sample += 1
    return force


@njit
def closed_states_in_time(law, p, time, deflection, rate, n_states):
    """Find the states at the start of a closed cycle of a law that depends on the rate; `time` [s] is that of its samples."""
    z, start = np.zeros(n_states), np.zeros(n_states)
    starts, gains, bracket = np.zeros(2), np.zeros(2), np.array([-np.inf, np.inf])
    for cycle in range(_ROUNDS if n_states > 0 else 0):
        put(z, 0, start, 0, n_states)
        _, states, _ = follow_time(law, p, time, deflection, rate, z, n_states)
        put(states[-1], 0, z, 0, n_states)
        if not largest_entry(z) < np.inf or largest_difference(z, start) <= 1e-14 * largest_entry(states):
            break
        if n_states > 1:
            continue
        starts[0], gains[0] = starts[1], gains[1]
        starts[1], gains[1] = start[0], z[0] - start[0]
        if cycle > 3 and abs(gains[1]) >= abs(gains[0]) and abs(gains[1]) < 1e-12 * largest_entry(states):
            break  # rounding of the integration
        z[0] = next_start(starts, gains, bracket)
    return start


@dataclass(frozen=True, kw_only=True)
class ClosedCycle:
    """Steady loop of a law over one closed cycle."""

    loop: Loop  # the whole path; with a rate-independent law the turning points between the samples are on it
    samples: Integers  # indices on that path, (n_t,)


def require_steady(law: Law) -> None:
    """Raise ValueError if no cycle of the law repeats the one before."""
    if any(isinstance(part, BoucWenBaberNoori) for part in law.components):
        raise ValueError("a law that wears, bouc-wen-baber-noori, has no steady cycle: take its Bouc-Wen law instead.")


def is_neutral(law: Law) -> bool:
    """Check whether a shift of the deflection leaves the force of the law's cycles unchanged."""
    return law.largest_force < np.inf


def cycle_force(law: Law, deflection: Array, rate: Array, *, period: float) -> Array:
    """Compute the steady force of a law [N], (n_t,), along one cycle; NaN where it is not finite.

    A rate-independent law is followed exactly along the path, from the unloaded state at zero deflection on until its cycle
    closes; one that depends on the rate along the cubic through deflections [m] and rates [m/s], (n_t,), uniform samples over
    one `period` [s], the last the first again. No law that wears has such a cycle.
    """
    p, n = law.kernel_parameters(), law.n_states
    if law.rate_independent:
        return steady_force(law.kernel, p, deflection, rate, period / (deflection.size - 1), n)
    time = np.linspace(0.0, period, deflection.size)
    states = closed_states_in_time(law.kernel, p, time, deflection, rate, n)
    return follow_time(law.kernel, p, time, deflection, rate, states, n)[0]


def steady_cycle(law: Law, deflection: Array, rate: Array, *, period: float) -> ClosedCycle:
    """Compute force, states and work of the cycle of `cycle_force`; ValueError if the force is not finite on the way."""
    p, n = law.kernel_parameters(), law.n_states
    if law.rate_independent:
        path, samples = path_between(deflection, rate, period / (deflection.size - 1))
        states, along = closed_states(law.kernel, p, turning_points(path), n), {}
    else:
        time, path, samples = np.linspace(0.0, period, deflection.size), deflection, np.arange(deflection.size)
        states, along = closed_states_in_time(law.kernel, p, time, deflection, rate, n), {"time": time, "rate": rate}
    held = np.where(np.isfinite(states), states, 0.0)  # from zero states the trace names where the force is not finite
    return ClosedCycle(loop=law.trace(path, initial_states=held, **along), samples=samples)


def largest(values: Array, *, smooth: bool) -> float:
    """Find the largest of the values at uniform samples of one period, of a smooth curve by the parabola's vertex there."""
    top = int(np.argmax(values))
    before, tip, after = values[top - 1], values[top], values[(top + 1) % values.size]
    bend = before - 2.0 * tip + after
    return float(tip - (after - before) ** 2 / (8.0 * bend)) if smooth and bend < 0.0 else float(tip)
