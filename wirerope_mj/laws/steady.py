"""Forces of rate-independent laws without wear, in the steady state of a cycle; no work is summed, which costs most.

The laws are those with a closed form and all of the Bouc-Wen family, for any exponent.
"""

import numpy as np

from wirerope_mj.jit import njit
from wirerope_mj.laws.exact import carry_exactly, has_closed_form
from wirerope_mj.laws.kernels import evaluate
from wirerope_mj.laws.power import ORDER, carry_power, follow_power


@njit
def carry(law, p, x0, x1, z, c, a):
    """Carry the states of a law in place from deflection x0 to x1 and return whether they are finite.

    Closed forms where there are any, else the power series of the Bouc-Wen laws with their scratch arrays `c` and `a`.
    """
    if x0 != x1:
        if has_closed_form(law, p, 0):
            carry_exactly(law, p, 0, x0, x1, z, 0)
        else:
            carry_power(p, 0, x0, x1, z, 0, c, a)
    return abs(z[0]) < np.inf


@njit
def follow_force(law, p, deflection, z, n_states):
    """Return the force (n_t,) along `deflection`, entered with states `z`; NaN from where they leave the finite numbers."""
    n_t = deflection.size
    force, states = np.empty(n_t), np.empty(n_t)
    c, a, unused = np.empty(ORDER + 1), np.empty(ORDER + 1), np.empty(n_states + 1)
    if not has_closed_form(law, p, 0):
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
def settle(law, p, turning, n_states, tolerance):
    """Return the states (n_states,) at the start of a cycle of turning points once they repeat within `tolerance` [N].

    After 200 cycles they are returned as they are; NaN if the law leaves the finite numbers.
    """
    z, before, last = np.zeros(n_states), np.zeros(n_states), 0.0
    c, a = np.empty(ORDER + 1), np.empty(ORDER + 1)
    for cycle in range(200):
        before[:] = z
        for t in range(1, turning.size):
            if not carry(law, p, turning[t - 1], turning[t], z, c, a):
                z[:] = np.nan
                return z
        step = 0.0
        for e in range(n_states):
            step = max(step, abs(z[e] - before[e]))
        if step <= tolerance:
            break
        # The memory of the start fades geometrically, slowly in small loops: two steps tell where it ends (Aitken).
        change = z[0] - before[0]
        if n_states == 1 and cycle % 3 == 2 and 0.0 < abs(change) < 0.999 * abs(last):
            z[0] = before[0] + change / (1.0 - change / last)
        last = change
    return z
