"""Laws without a closed form, such as Baber and Noori's and the coupled axes, integrated along a straight line of deflections.

States and work follow the adaptive Dormand-Prince pair 5(4) (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations
I, table II.5.2). Steps end where a hysteretic force changes its sign, so that no kink of a law lies inside one. The pair is
written out: loops over its coefficients would take several times as long as the law itself.
"""

import math

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.plane_kernels import BIAXIAL, LOOP, ON_BRACKETS, biaxial, loop_plane, on_brackets_along
from wirerope_mj.mounts.laws.registry import evaluate_rarer
from wirerope_mj.mounts.laws.softening import BABER_NOORI, SCRAGGED_BOUC_WEN, WORN_OUT, baber_noori

# Relative error allowed in one step. The pair's estimate is that of its lower order: traces are a tenth to a hundredth of it
# from their limit, and 1e-8 is what they promise.
TOLERANCE = 1e-9
# The same where steps do not land on kinks: a component of coupled axes that passes through zero beside a large other one, and
# the largest deflection so far.
TOLERANCE_OF_KINKS = 1e-11
# Fraction of the yield deflection that a step within the tolerance covers where z is neither zero nor at its bound.
FIRST_STEP = 0.2
# Fraction of a segment below which a failing step can only be a kink, whose contribution is below rounding.
_SMALLEST = 1e-9
_NARROWEST = 1e-9  # Fraction of the bound of z that a step covers at the least
_AT_ZERO = 1e-13  # Fraction of what z gains over the segment's length that counts as zero
# Newton steps in which a step's end is moved onto a change of sign of z; they converge quadratically, four suffice.
_LANDINGS = 8


@njit
def switch(law, p, i, z, j):
    """Return the quantity whose change of sign is a kink of the law: z, or its part along the path."""
    if law in (BIAXIAL, LOOP):
        return z[j] * p[i + 14] / (p[i + 2] * p[i + 4]) + z[j + 1] * p[i + 15] / (p[i + 3] * p[i + 5])
    return 1.0 if law == ON_BRACKETS else z[j]  # of the others several scales turn, each at its own place


@njit
def first_step(law, p, i, length):
    """Return a step that is likely to be accepted: a fifth of the yield deflection, or the whole length."""
    if law != BABER_NOORI:
        return length
    return min(length, FIRST_STEP * (p[i] / (p[i + 1] + p[i + 2])) ** (1.0 / p[i + 3]) / p[i])


@njit
def longest_step(law, p, i, direction, z, e):
    """Return the longest step that cannot leap over what a law does in a narrow range of its force.

    Only pinching is narrow: over a step z gains two widths of it at most, or a quarter of the way to where it is. Its width may
    begin at zero and grows with the work e done on the law; what is narrower than `_NARROWEST` of the bound of z may be missed.
    """
    if law != BABER_NOORI or p[i + 8] == 0.0:
        return np.inf
    slip = p[i + 8] * -math.expm1(-p[i + 10] * e)
    width = (p[i + 11] + p[i + 12] * e) * (p[i + 13] + slip)
    alpha = max(p[i] - p[i + 5] * e, WORN_OUT * p[i])
    bound = (alpha / ((1.0 + p[i + 6] * e) * (p[i + 1] + p[i + 2]))) ** (1.0 / p[i + 3])
    return max(2.0 * width, 0.25 * abs(direction * z - p[i + 9] * bound), _NARROWEST * bound) / p[i]


@njit
def slope_at(law, p, i, x, direction, z, j, n, k, stage):
    """Write the derivatives of the n states and of the work by the length to `k[stage * (n + 1):]`."""
    row = stage * (n + 1)
    # Not `evaluate`: of a few laws the compiler makes one function with the loop, which then takes half the time.
    if law == BABER_NOORI:
        k[row + n] = direction * baber_noori(p, i, x, direction, z, j, k, row)
    elif law == BIAXIAL:
        k[row + n] = direction * biaxial(p, i, x, direction, z, j, k, row)
    elif law == LOOP:
        k[row + n] = direction * loop_plane(p, i, x, direction, z, j, k, row)
    elif law == ON_BRACKETS:
        k[row + n] = direction * on_brackets_along(p, i, x, direction, z, j, k, row)
    else:
        k[row + n] = direction * evaluate_rarer(law, p, i, x, direction, z, j, k, row)


@njit
def stages(law, p, i, x, direction, h, z, j, n, k, trial):
    """Fill the slopes `k` of the seven stages of a step h from x, those of the first given; leave the end state in `trial`."""
    s, m = direction * h, n + 1
    for c in range(n):
        trial[c] = z[j + c] + h * (1 / 5 * k[c])
    slope_at(law, p, i, x + 1 / 5 * s, direction, trial, 0, n, k, 1)
    for c in range(n):
        trial[c] = z[j + c] + h * (3 / 40 * k[c] + 9 / 40 * k[m + c])
    slope_at(law, p, i, x + 3 / 10 * s, direction, trial, 0, n, k, 2)
    for c in range(n):
        trial[c] = z[j + c] + h * (44 / 45 * k[c] - 56 / 15 * k[m + c] + 32 / 9 * k[2 * m + c])
    slope_at(law, p, i, x + 4 / 5 * s, direction, trial, 0, n, k, 3)
    for c in range(n):
        trial[c] = z[j + c] + h * (
            19372 / 6561 * k[c] - 25360 / 2187 * k[m + c] + 64448 / 6561 * k[2 * m + c] - 212 / 729 * k[3 * m + c]
        )
    slope_at(law, p, i, x + 8 / 9 * s, direction, trial, 0, n, k, 4)
    for c in range(n):
        trial[c] = z[j + c] + h * (
            9017 / 3168 * k[c]
            - 355 / 33 * k[m + c]
            + 46732 / 5247 * k[2 * m + c]
            + 49 / 176 * k[3 * m + c]
            - 5103 / 18656 * k[4 * m + c]
        )
    slope_at(law, p, i, x + s, direction, trial, 0, n, k, 5)
    for c in range(n):
        trial[c] = z[j + c] + h * mean_slope(k, m, c)
    slope_at(law, p, i, x + s, direction, trial, 0, n, k, 6)


@njit
def mean_slope(k, m, c):
    """Return the mean slope of state c, or of the work, over the step, to fifth order."""
    return (
        35 / 384 * k[c]
        + 500 / 1113 * k[2 * m + c]
        + 125 / 192 * k[3 * m + c]
        - 2187 / 6784 * k[4 * m + c]
        + 11 / 84 * k[5 * m + c]
    )


@njit
def error_slope(k, m, c):
    """Estimate the error of a step's mean slope of state `c`, or of the work: that of fifth order less that of fourth."""
    return (
        71 / 57600 * k[c]
        - 71 / 16695 * k[2 * m + c]
        + 71 / 1920 * k[3 * m + c]
        - 17253 / 339200 * k[4 * m + c]
        + 22 / 525 * k[5 * m + c]
        - 1 / 40 * k[6 * m + c]
    )


@njit
def integrate(law, p, i, x0, direction, length, z, j, n_states, slopes, trial):
    """Advance a law's states `z[j:j + n_states]` in place over a length from x0; return the work done on the law [J].

    `slopes` (7 (n_states + 1),) and `trial` (n_states + 1,) are scratch arrays. Returns NaN if the state leaves the finite
    numbers.
    """
    work, power, done, landing, m = 0.0, 0.0, 0.0, 0, n_states + 1
    longest = longest_step(law, p, i, direction, z[j], z[j + n_states - 1])
    step = min(first_step(law, p, i, length), longest)
    tolerance = TOLERANCE_OF_KINKS if law in (BIAXIAL, LOOP, SCRAGGED_BOUC_WEN) else TOLERANCE
    slope_at(law, p, i, x0, direction, z, j, n_states, slopes, 0)
    while done < length:
        step = min(step, length - done)
        stages(law, p, i, x0 + direction * done, direction, step, z, j, n_states, slopes, trial)
        for stage in range(7):  # of the whole segment: where the force is zero, rounding is not
            power = max(power, abs(slopes[stage * m + n_states]))
        error = abs(error_slope(slopes, m, n_states)) / (tolerance * power + 1e-300)
        for c in range(n_states):
            scale = max(abs(z[j + c]), abs(trial[c]), abs(slopes[c]) * step)
            ratio = abs(step * error_slope(slopes, m, c)) / (tolerance * scale + 1e-300)
            error = max(error, ratio) if ratio >= 0.0 else math.inf  # max() would lose a NaN
        if not error < math.inf:  # the trial left the finite numbers: shorter, unless the path itself does
            if step < _SMALLEST * length:
                return np.nan
            step *= 0.2
            continue
        if error > 1.0 and step >= _SMALLEST * length:
            step *= max(0.2, 0.9 * error**-0.2)
            continue
        before, after = switch(law, p, i, z, j), switch(law, p, i, trial, 0)
        if (landing > 0 or before * after < 0.0) and landing < _LANDINGS:
            slope = switch(law, p, i, slopes, 6 * m)
            zero = _AT_ZERO * abs(slope) * length
            if abs(before) > zero and abs(after) > zero:
                landing += 1
                step -= min(after / slope, 0.999 * step) if slope != 0.0 else 0.5 * step
                continue
        landing = 0
        done = length if step >= length - done else done + step
        work += step * mean_slope(slopes, m, n_states)
        for c in range(n_states):
            z[j + c] = trial[c]
        for c in range(m):
            slopes[c] = slopes[6 * m + c]
        longest = longest_step(law, p, i, direction, z[j], z[j + n_states - 1])
        step = min(longest, step * min(5.0, max(0.2, 0.9 * (error + 1e-10) ** -0.2)))
    return work
