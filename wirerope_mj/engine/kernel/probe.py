"""Accelerations and state rates in many states of one system, to be compared with MuJoCo's."""

from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.engine.kernel.steps import forward
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import rows, table


@njit
def probe(structure, shared, numbers, states, memory, base, out):
    """Write accelerations and state rates, (n_groups, nv + n_states, WIDTH), in states (n_groups, n_state, WIDTH).

    `base` is the acceleration of the base in each, (n_groups, 3, WIDTH).
    """
    lay, fix, num, work = table(structure), table(shared), rows(numbers), rows(memory)
    nv, n_states = lay[at.NV], lay[at.N_STATES]
    for group in range(states.shape[0]):
        y, a, result = rows(states[group]), rows(base[group]), rows(out[group])
        forward(lay, fix, num, y, work, (a[0], a[1], a[2]))
        for i in range(nv):
            result[i] = work[lay[at.RHS] + i]
        for i in range(n_states):
            result[nv + i] = work[lay[at.RATES] + i]
