"""Forces of rate-independent laws without wear, in the steady state of a cycle; no work is summed, which costs most.

Paths of one state do not cross, and a cycle forgets: from where a cycle gains the closed one starts higher, from where it loses
lower. Every cycle followed so brackets the closed one, whatever the kinks between. A secant without the bracket was thrown to
1e16 N by the bend of a Bouc-Wen law with n < 1, where nothing changes any more and all seems closed.
"""

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.adaptive import integrate
from wirerope_mj.mounts.laws.path import SCRATCH, put, segment_on_bracket
from wirerope_mj.mounts.laws.power import ORDER, carry_power, follow_power
from wirerope_mj.mounts.laws.registry import (
    BOUC_WEN_LAWS,
    ON_BRACKET,
    PARALLEL,
    carry_exactly,
    component,
    evaluate,
    has_closed_form,
)


@njit
def carry(law, p, x0, x1, z, c, a):
    """Carry the states of a law in place from deflection x0 to x1 and return whether they are finite.

    Closed forms where there are any, the power series of the Bouc-Wen laws with their scratch arrays `c` and `a`; the rest is
    integrated.
    """
    if law == PARALLEL:
        for part in range(int(p[0])):
            one, first, state, count = component(p, 0, part, z.size)
            carry_single(one, p, first, x0, x1, z, state, count, c, a)
    else:
        carry_single(law, p, 0, x0, x1, z, 0, z.size, c, a)
    finite = True
    for state in range(z.size):
        finite = finite and abs(z[state]) < np.inf
    return finite


@njit
def carry_single(law, p, i, x0, x1, z, j, n_states, c, a):
    """Carry the states `z[j:]` of one law, not several in parallel, with the parameters `p[i:]` in place from x0 to x1."""
    if x0 == x1:
        return
    if has_closed_form(law, p, i):
        carry_exactly(law, p, i, x0, x1, z, j)
    elif law in BOUC_WEN_LAWS:
        carry_power(p, i, x0, x1, z, j, c, a)
    else:
        slopes, trial = np.empty(SCRATCH * (n_states + 1)), np.empty(n_states + 1)
        if law == ON_BRACKET:
            segment_on_bracket(p, i, x0, x1, z, j, n_states, slopes, trial)
            return
        integrate(law, p, i, x0, 1.0 if x1 > x0 else -1.0, abs(x1 - x0), z, j, n_states, slopes, trial)


@njit
def follow_force(law, p, deflection, z, n_states):
    """Return the force (n_t,) along `deflection`, entered with states `z`; NaN from where they leave the finite numbers."""
    n_t = deflection.size
    force, states = np.empty(n_t), np.empty(n_t)
    c, a, unused = np.empty(ORDER + 1), np.empty(ORDER + 1), np.empty(n_states + 1)
    if law in BOUC_WEN_LAWS and not has_closed_form(law, p, 0):
        follow_power(p, deflection, z, states)
        for t in range(n_t):
            z[0] = states[t]
            force[t] = evaluate(law, p, 0, deflection[t], 0.0, z, 0, unused, 0)
        return force
    for t in range(n_t):
        if t > 0 and not carry(law, p, deflection[t - 1], deflection[t], z, c, a):
            z[:] = np.nan
        force[t] = evaluate(law, p, 0, deflection[t], 0.0, z, 0, unused, 0)
    return force


@njit
def next_start(starts, gains, bracket):
    """Estimate the state at which a cycle closes from those that began the last two and their gains; update `bracket`, (2,).

    The secant through the two, at most eight times their distance; the middle of the bracket where the last step did not
    halve the gain or the secant leaves the bracket; where the last cycle ended, which is inside, while there is no bracket.
    A gain of zero before the last says that there was no cycle before it.
    """
    start, gain = starts[1], gains[1]
    if gain > 0.0:
        bracket[0] = max(bracket[0], start)
    else:
        bracket[1] = min(bracket[1], start)
    bounded = bracket[1] - bracket[0] < np.inf
    if bounded and abs(gain) > 0.5 * abs(gains[0]):
        return 0.5 * (bracket[0] + bracket[1])
    step = gain
    if gains[0] != 0.0 and starts[0] != start:
        slope = (gain - gains[0]) / (start - starts[0])
        # A cycle that forgets gains less the farther it starts: a slope outside (-1, 0) comes from a kink between the two.
        if -1.0 < slope < 0.0:
            most = 8.0 * max(abs(start - starts[0]), abs(gain))
            step = min(max(-gain / slope, -most), most)
    if bracket[0] < start + step < bracket[1]:
        return start + step
    return 0.5 * (bracket[0] + bracket[1]) if bounded else start + gain


@njit
def settle(law, p, turning, n_states, tolerance):
    """Return the states (n_states,) at the start of a steady cycle of turning points: repeated within `tolerance` [N].

    After 200 cycles they are returned as they are; NaN if the law leaves the finite numbers.
    """
    z, before = np.zeros(n_states), np.zeros(n_states)
    starts, gains, bracket = np.zeros(2), np.zeros(2), np.array([-np.inf, np.inf])
    c, a = np.empty(ORDER + 1), np.empty(ORDER + 1)
    for _ in range(200):
        put(z, 0, before, 0, n_states)
        for t in range(1, turning.size):
            if not carry(law, p, turning[t - 1], turning[t], z, c, a):
                z[:] = np.nan
                return z
        step = 0.0
        for e in range(n_states):
            step = max(step, abs(z[e] - before[e]))
        if step <= tolerance:
            break
        if n_states == 1:
            starts[0], gains[0] = starts[1], gains[1]
            starts[1], gains[1] = before[0], z[0] - before[0]
            z[0] = next_start(starts, gains, bracket)
    return z
