"""Laws along a path: exactly where a closed form exists, else integrated almost to rounding.

Between two samples the deflection is a cubic of one variable: of the distance for a rate-independent law (a straight line), of
time for the others. Where there is no closed form the states and the work are integrated by the adaptive Dormand-Prince pair
5(4) (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, table II.5.2). Steps end at samples, at reversals and
where a hysteretic force changes its sign, so that no kink of a law lies inside one.
"""

import math

import numpy as np

from wirerope_mj.jit import njit
from wirerope_mj.laws.exact import advance_exactly, has_closed_form
from wirerope_mj.laws.kernels import BIAXIAL, KELVIN_VOIGT, TINKER_CUTCHINS, ZENER, evaluate, polynomial

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
"""Relative error allowed in one step of the integration: a thousand steps stay well below 1e-8."""

_SMALLEST = 1e-9
"""Share of a segment below which a failing step can only be a kink, whose contribution is below rounding."""

_AT_ZERO = 1e-13
"""Share of what z gains over the segment's length that counts as zero."""

_LANDINGS = 8
"""Newton steps in which a step's end is moved onto a change of sign of z; they converge quadratically, four suffice."""


@njit
def switch(law, p, i, z, j):
    """Return the quantity whose change of sign is a kink of the law: z, or its part along the path; 1 if there is none."""
    if law == BIAXIAL:
        return z[j] * p[i + 14] / (p[i + 2] * p[i + 4]) + z[j + 1] * p[i + 15] / (p[i + 3] * p[i + 5])
    if law in (KELVIN_VOIGT, TINKER_CUTCHINS, ZENER):
        return 1.0
    return z[j]


@njit
def integrate(law, p, i, cubic, length, z, j, n_states, slopes, trial):
    """Carry `z[j:j + n_states]` in place along x = cubic(t), 0 <= t <= length, and return the work done on the law [J].

    `cubic` holds the coefficients from the constant upwards; `slopes` (7, n_states + 1) and `trial` (n_states + 1,) are
    scratch arrays. Returns NaN if the state leaves the finite numbers.
    """
    work, power, done, step, landing = 0.0, 0.0, 0.0, length, 0
    while done < length:
        step = min(step, length - done)
        for stage in range(7):
            trial[:] = 0.0
            for earlier in range(stage):
                for c in range(n_states):
                    trial[c] += _A[stage, earlier] * slopes[earlier, c]
            for c in range(n_states):
                trial[c] = z[j + c] + step * trial[c]
            t = done + _C[stage] * step
            x = cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3]))
            v = cubic[1] + t * (2.0 * cubic[2] + t * 3.0 * cubic[3])
            slopes[stage, n_states] = v * evaluate(law, p, i, x, v, trial, 0, slopes[stage], 0)
        error, gain = 0.0, 0.0
        for stage in range(7):
            gain += _A[6, stage] * slopes[stage, n_states] if stage < 6 else 0.0
            power = max(power, abs(slopes[stage, n_states]))  # of the segment: where the force is zero, rounding is not
        for c in range(n_states + 1):
            difference = 0.0
            for stage in range(7):
                difference += _ERROR[stage] * slopes[stage, c]
            scale = power * step
            if c < n_states:
                scale = max(abs(z[j + c]), abs(trial[c]), abs(slopes[0, c]) * step)
            share = abs(step * difference) / (TOLERANCE * scale + 1e-300)
            error = max(error, share) if share >= 0.0 else math.inf  # max() would lose a NaN
        if not math.isfinite(error):  # the trial left the finite numbers: shorter, unless the path itself does
            if step < _SMALLEST * length:
                return np.nan
            step *= 0.2
            continue
        if error > 1.0 and step >= _SMALLEST * length:
            step *= max(0.2, 0.9 * error**-0.2)
            continue
        before, after = switch(law, p, i, z, j), switch(law, p, i, trial, 0)
        slope = switch(law, p, i, slopes[6], 0)
        zero = _AT_ZERO * abs(slope) * length
        if abs(before) > zero and abs(after) > zero and (landing > 0 or before * after < 0.0) and landing < _LANDINGS:
            landing += 1
            step -= min(after / slope, 0.999 * step) if slope != 0.0 else 0.5 * step
            continue
        landing = 0
        done = length if step >= length - done else done + step
        work += step * gain
        for c in range(n_states):
            z[j + c] = trial[c]
        step *= min(5.0, max(0.2, 0.9 * (error + 1e-10) ** -0.2))
    return work


@njit
def advance(law, p, i, x0, x1, z, j, n_states, slopes, trial):
    """Carry a rate-independent law's states in place from deflection x0 to x1 and return the work done on it [J].

    The arguments are those of `integrate`.
    """
    if x0 * x1 < 0.0:  # Ni's polynomial has a kink at zero
        work = segment(law, p, i, x0, 0.0, z, j, n_states, slopes, trial)
        return work + segment(law, p, i, 0.0, x1, z, j, n_states, slopes, trial)
    return segment(law, p, i, x0, x1, z, j, n_states, slopes, trial)


@njit
def segment(law, p, i, x0, x1, z, j, n_states, slopes, trial):
    """Do the same on a path that does not cross zero."""
    if x0 == x1:
        return 0.0
    if has_closed_form(law, p, i):
        return advance_exactly(law, p, i, x0, x1, z, j, trial, slopes[0])
    direction = 1.0 if x1 > x0 else -1.0
    return integrate(law, p, i, (x0, direction, 0.0, 0.0), abs(x1 - x0), z, j, n_states, slopes, trial)


@njit
def follow_path(law, p, deflection, z, n_states):
    """Return force (n_t,), states (n_t, n_states) and cumulated work (n_t,) along `deflection`, entered with states `z`."""
    n_t = deflection.size
    force, states, work = np.empty(n_t), np.empty((n_t, n_states)), np.zeros(n_t)
    slopes, trial, unused = np.empty((7, n_states + 1)), np.empty(n_states + 1), np.empty(n_states + 1)
    for t in range(n_t):
        if t > 0:
            gain = advance(law, p, 0, deflection[t - 1], deflection[t], z, 0, n_states, slopes, trial)
            work[t] = work[t - 1] + gain
        states[t] = z[:n_states]
        force[t] = evaluate(law, p, 0, deflection[t], 0.0, z, 0, unused, 0)
    return force, states, work


@njit
def reversals(x0, x1, v0, v1, h):
    """Return the cubic that joins positions and rates at the ends of a time h, and where inside it the rate is zero.

    Of the two instants, those that do not exist are h.
    """
    b, c = 3.0 * (x1 - x0) / h - 2.0 * v0 - v1, v0 + v1 - 2.0 * (x1 - x0) / h
    cubic = (x0, v0, b / h, c / (h * h))  # the rate over u = t / h is v0 + 2 b u + 3 c u^2
    root = b * b - 3.0 * c * v0
    if root <= 0.0:
        return cubic, h, h
    q = -(b + math.copysign(math.sqrt(root), b))
    one, two = h, h
    if q != 0.0 and 0.0 < v0 / q < 1.0:
        one = h * v0 / q
    if c != 0.0 and 0.0 < q / (3.0 * c) < 1.0:
        two = h * q / (3.0 * c)
    return cubic, min(one, two), max(one, two)


@njit
def follow_time(law, p, time, deflection, rate, z, n_states):
    """Return the same as `follow_path` for a law that depends on the rate, `rate` at the samples `time`."""
    n_t = deflection.size
    force, states, work = np.empty(n_t), np.empty((n_t, n_states)), np.zeros(n_t)
    slopes, trial, unused = np.empty((7, n_states + 1)), np.empty(n_states + 1), np.empty(n_states + 1)
    for t in range(n_t):
        if t > 0:
            h = time[t] - time[t - 1]
            cubic, one, two = reversals(deflection[t - 1], deflection[t], rate[t - 1], rate[t], h)
            work[t], start = work[t - 1], 0.0
            for end in (one, two, h):
                if end > start:
                    piece = shifted(cubic, start)
                    work[t] += integrate(law, p, 0, piece, end - start, z, 0, n_states, slopes, trial)
                    start = end
        states[t] = z[:n_states]
        force[t] = evaluate(law, p, 0, deflection[t], rate[t], z, 0, unused, 0)
    return force, states, work


@njit
def shifted(cubic, t):
    """Return the coefficients of the cubic about the instant t."""
    a, b, c, d = cubic
    return a + t * (b + t * (c + t * d)), b + t * (2.0 * c + t * 3.0 * d), c + 3.0 * d * t, d


@njit
def follow_plane(p, path):
    """Return force (n_t, 2), states (n_t, 2) and cumulated work (n_t,) of the biaxial kernel along straight lines.

    `p` holds the kernel's parameters; start and direction of the line are written to it.
    """
    n_t = path.shape[0]
    force, states, work, z = np.empty((n_t, 2)), np.empty((n_t, 2)), np.zeros(n_t), np.zeros(2)
    slopes, trial = np.empty((7, 3)), np.empty(3)
    for t in range(n_t):
        if t > 0:
            dx, dy = path[t, 0] - path[t - 1, 0], path[t, 1] - path[t - 1, 1]
            length = math.sqrt(dx * dx + dy * dy)
            work[t] = work[t - 1]
            if length > 0.0:
                p[12], p[13], p[14], p[15] = path[t - 1, 0], path[t - 1, 1], dx / length, dy / length
                work[t] += integrate(BIAXIAL, p, 0, (0.0, 1.0, 0.0, 0.0), length, z, 0, 2, slopes, trial)
        states[t] = z
        force[t, 0] = z[0] + polynomial(p[6], p[7], p[8], path[t, 0])
        force[t, 1] = z[1] + polynomial(p[9], p[10], p[11], path[t, 1])
    return force, states, work
