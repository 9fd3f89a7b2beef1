"""Exact-to-rounding integration of a rate-independent law along a path of deflections.

A rate-independent law is a differential equation in the deflection: over a monotone segment of direction s = +-1,
dz/dl = zdot(v = s) and dW/dl = s F with l = |x - x0|. It is integrated by the adaptive Dormand-Prince pair 5(4)
(Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, table II.5.2), whose nodes never leave the segment.
"""

import numpy as np

from wirerope_mj.jit import njit
from wirerope_mj.laws.kernels import evaluate

_C = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_A = np.array(
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

TOLERANCE = 1e-11
"""Relative error allowed in one step of the path integration: a thousand steps stay well below 1e-8."""


@njit
def advance(law, p, i, x0, x1, z, j, n_states, slopes, trial):
    """Carry `z[j:j + n_states]` in place from deflection `x0` to `x1` and return the work done on the law [J].

    `slopes` (7, n_states + 1) and `trial` (n_states + 1,) are scratch arrays. Returns NaN if the state leaves the
    finite numbers, as a law that hardens without bound does at its blow-up deflection.
    """
    length = abs(x1 - x0)
    work = 0.0
    if length == 0.0:
        return work
    s = 1.0 if x1 > x0 else -1.0
    done, step = 0.0, length
    while done < length:
        step = min(step, length - done)
        for stage in range(7):
            trial[:] = 0.0
            for earlier in range(stage):
                for c in range(n_states):
                    trial[c] += _A[stage, earlier] * slopes[earlier, c]
            for c in range(n_states):
                trial[c] = z[j + c] + step * trial[c]
            x = x0 + s * (done + _C[stage] * step)
            slopes[stage, n_states] = s * evaluate(law, p, i, x, s, trial, 0, slopes[stage], 0)
        error, gain = 0.0, 0.0
        for stage in range(7):
            gain += _A[6, stage] * slopes[stage, n_states] if stage < 6 else 0.0
        for c in range(n_states):
            difference = 0.0
            for stage in range(7):
                difference += _ERROR[stage] * slopes[stage, c]
            scale = TOLERANCE * max(abs(z[j + c]), abs(trial[c]), abs(slopes[0, c]) * step)
            error = max(error, abs(step * difference) / (scale + 1e-300))
        work_error = 0.0
        for stage in range(7):
            work_error += _ERROR[stage] * slopes[stage, n_states]
        error = max(error, abs(work_error) / (TOLERANCE * abs(slopes[0, n_states]) + TOLERANCE * abs(gain) + 1e-300))
        if not np.isfinite(error):  # the trial left the finite numbers: shorter, unless the path itself does
            if step < 1e-9 * length:
                return np.nan
            step *= 0.2
            continue
        # Below 1e-9 of the segment a failing step can only be a kink at z = 0: its contribution is below rounding.
        if error <= 1.0 or step < 1e-9 * length:
            done = length if step >= length - done else done + step
            work += step * gain
            for c in range(n_states):
                z[j + c] = trial[c]
        step *= min(5.0, max(0.2, 0.9 * (error + 1e-10) ** -0.2))
    return work


@njit
def follow_path(law, p, deflection, z, n_states):
    """Return force (n_t,), states (n_t, n_states) and cumulated work (n_t,) along `deflection`, entered with states `z`."""
    n_t = deflection.size
    force, states, work = np.empty(n_t), np.empty((n_t, n_states)), np.zeros(n_t)
    slopes, trial, unused = np.empty((7, n_states + 1)), np.empty(n_states + 1), np.empty(max(n_states, 1))
    for t in range(n_t):
        if t > 0:
            gain = advance(law, p, 0, deflection[t - 1], deflection[t], z, 0, n_states, slopes, trial)
            work[t] = work[t - 1] + gain
        states[t] = z[:n_states]
        force[t] = evaluate(law, p, 0, deflection[t], 0.0, z, 0, unused, 0)
    return force, states, work
