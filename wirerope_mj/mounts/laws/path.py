"""Laws along a path of deflections: by closed forms or series where there are any, else integrated."""

import math

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.adaptive import integrate
from wirerope_mj.mounts.laws.ni import polynomial
from wirerope_mj.mounts.laws.plane_kernels import LINE, LOOP, ON_BRACKETS, loop_plane_force, on_brackets
from wirerope_mj.mounts.laws.power import advance_power
from wirerope_mj.mounts.laws.registry import (
    BOUC_WEN_LAWS,
    HEAD,
    ON_BRACKET,
    PARALLEL,
    RATE_DEPENDENT,
    advance_exactly,
    behind_bracket,
    component,
    evaluate,
    has_closed_form,
    on_bracket,
)

# Scratch numbers for each state and the work: seven slopes of a step, or the series of a Bouc-Wen law and one more.
SCRATCH = 18
_SECANTS, _ROUNDED = 60, 1e-15  # of a law's deflection on a bracket: ten are usual; what rounding leaves of it


@njit
def put(values, i, out, j, n):
    """Copy n values: an assignment of arrays would compile the texts of Numba's complaint about their shapes."""
    for k in range(n):
        out[j + k] = values[i + k]


@njit
def advance(law, p, i, x0, x1, z, j, n_states, slopes, trial):
    """Advance a rate-independent law's states in place from deflection x0 to x1; return the work done on the law [J].

    The arguments are those of `integrate`.
    """
    if x0 * x1 < 0.0:  # Ni's polynomial has a kink at zero
        work = segment(law, p, i, x0, 0.0, z, j, n_states, slopes, trial)
        return work + segment(law, p, i, 0.0, x1, z, j, n_states, slopes, trial)
    return segment(law, p, i, x0, x1, z, j, n_states, slopes, trial)


@njit
def segment(law, p, i, x0, x1, z, j, n_states, slopes, trial):
    """Advance a law's states in place from deflection x0 to x1, both on one side of zero; return the work done on it [J]."""
    if law != PARALLEL:
        return advance_single(law, p, i, x0, x1, z, j, n_states, slopes, trial)
    work = 0.0
    for part in range(int(p[i])):
        one, first, state, count = component(p, i, part, n_states)
        if one in RATE_DEPENDENT:  # infinitely slow: their states stay at zero
            continue
        work += advance_single(one, p, first, x0, x1, z, j + state, count, slopes, trial)
    return work


@njit
def advance_single(law, p, i, x0, x1, z, j, n_states, slopes, trial):
    """Advance the states of one law, not several in parallel, from x0 to x1 on one side of zero; return the work [J]."""
    if x0 == x1:
        return 0.0
    if law == ON_BRACKET:
        return segment_on_bracket(p, i, x0, x1, z, j, n_states, slopes, trial)
    if has_closed_form(law, p, i):
        return advance_exactly(law, p, i, x0, x1, z, j, trial, slopes)
    if law in BOUC_WEN_LAWS:
        return advance_power(law, p, i, x0, x1, z, j, slopes, trial)
    direction = 1.0 if x1 > x0 else -1.0
    return integrate(law, p, i, x0, direction, abs(x1 - x0), z, j, n_states, slopes, trial)


@njit
def advance_behind_bracket(p, i, d0, d1, z, n_states, slopes, trial):
    """Advance the states `z` of all laws on a bracket along their own deflection, d0 to d1; return the work on them [J]."""
    work = 0.0
    for part in range(int(p[i + HEAD])):
        law, first, state, count = component(p, i + HEAD, part, n_states)
        for start, end in ((d0, 0.0), (0.0, d1)) if d0 * d1 < 0.0 else ((d0, d1), (d1, d1)):
            if start == end:
                continue
            if has_closed_form(law, p, first):
                work += advance_exactly(law, p, first, start, end, z, state, trial, slopes)
            else:  # Bouc-Wen's: all others that may stand there have one
                work += advance_power(law, p, first, start, end, z, state, slopes, trial)
    return work


@njit
def segment_on_bracket(p, i, x0, x1, z, j, n_states, slopes, trial):
    """Advance the states of a law in series with a bracket K = p[i] as both deflect from x0 to x1; return the work [J].

    The law's own deflection d grows or falls throughout, as x does, so that only its end matters: d + F(d) / K = x1, by
    secants. The work is that on law and bracket.
    """
    own, unused, stiffness = np.empty(n_states), np.empty(n_states), p[i]
    force = on_bracket(p, i, x0, 0.0, z, j, unused, 0)
    d0 = x0 - force / stiffness
    before, last, d, work, f = d0, x0 - x1, d0 + 0.5 * (x1 - x0), 0.0, force
    for _ in range(_SECANTS):
        put(z, j, own, 0, n_states)
        work = advance_behind_bracket(p, i, d0, d, own, n_states, slopes, trial)
        f = behind_bracket(p, i, d, 0.0, own, 0, unused, 0)
        left = d - x1 + f / stiffness
        if abs(left) <= _ROUNDED * (abs(x1) + abs(d)) or d == before or left == last:
            break
        before, last, d = d, left, d - left * (d - before) / (left - last)
    put(own, 0, z, j, n_states)
    return work + 0.5 * (f * f - force * force) / stiffness


@njit
def follow_path(law, p, deflection, z, n_states):
    """Return force (n_t,), states (n_t, n_states) and cumulated work (n_t,) along `deflection`, entered with states `z`."""
    n_t = deflection.size
    force, states, work = np.empty(n_t), np.empty((n_t, n_states)), np.zeros(n_t)
    slopes, trial, unused = np.empty(SCRATCH * (n_states + 1)), np.empty(n_states + 1), np.empty(n_states + 1)
    for t in range(n_t):
        if t > 0:
            gain = advance(law, p, 0, deflection[t - 1], deflection[t], z, 0, n_states, slopes, trial)
            work[t] = work[t - 1] + gain
        put(z, 0, states[t], 0, n_states)
        force[t] = evaluate(law, p, 0, deflection[t], 0.0, z, 0, unused, 0)
    return force, states, work


@njit
def follow_plane(law, p, at, path, n_states):
    """Return force (n_t, 2), states (n_t, n_states) and cumulated work (n_t,) of a kernel in the plane along straight lines.

    `law` is BIAXIAL or LOOP, or ON_BRACKETS, `p` holds the kernel's parameters; start and direction of the line are written to
    `p[at:]`.
    """
    n_t = path.shape[0]
    force, states, work, z = np.empty((n_t, 2)), np.empty((n_t, n_states)), np.zeros(n_t), np.zeros(n_states)
    slopes, trial = np.empty(7 * (n_states + 1)), np.empty(n_states + 1)
    for t in range(n_t):
        if t > 0:
            dx, dy = path[t, 0] - path[t - 1, 0], path[t, 1] - path[t - 1, 1]
            length = math.sqrt(dx * dx + dy * dy)
            work[t] = work[t - 1]
            if length > 0.0:
                p[at], p[at + 1], p[at + 2], p[at + 3] = path[t - 1, 0], path[t - 1, 1], dx / length, dy / length
                work[t] += integrate(law, p, 0, 0.0, 1.0, length, z, 0, n_states, slopes, trial)
        put(z, 0, states[t], 0, n_states)
        if law == ON_BRACKETS:
            n = n_states // 2
            force[t, 0], force[t, 1] = on_brackets(p, LINE, n, path[t, 0], path[t, 1], 0.0, 0.0, z, 0, n, trial, 0, n)
            continue
        if law == LOOP:
            force[t, 0], force[t, 1] = loop_plane_force(p, 0, path[t, 0], path[t, 1], z[0], z[1])
            continue
        force[t, 0] = z[0] + polynomial(p[6], p[7], p[8], path[t, 0])
        force[t, 1] = z[1] + polynomial(p[9], p[10], p[11], path[t, 1])
    return force, states, work
