"""Bouc-Wen's state along a monotone segment for any exponent, to rounding: power series instead of an integration.

In the direction of the path the size u of the state follows u' = +-(alpha - b u^n). Near zero, where u^n is not smooth, the
length to zero is known, l = (u / alpha) 2F1(1, 1/n; 1 + 1/n; q) with q = b u^n / alpha, and is inverted by Newton steps. With
n >= 1 its power series in q is summed, sum_k q^k / (k n + 1). With n < 1 almost all of the length lies where q is no longer
small, and Pfaff's transformation is summed instead (Abramowitz and Stegun 15.3.4); its terms fall the faster the smaller n is:

    l = u / (alpha (1 - q)) sum_k t_k,    t_0 = 1,  t_k+1 / t_k = w n (k + 1) / (n (k + 1) + 1),    w = q / (q - 1)

The work of the state from there, the integral of u over the length, is the same series with n / 2: no sum of values follows the
broken powers of u near zero.

Elsewhere u is its Taylor series in the length, whose coefficients follow from u U' = n U u' with U = u^n one after the other,
so that one power is computed for a whole step (Knuth, The Art of Computer Programming 2, 4.7). They are those of u over its
start and of alpha times the length over it: in newtons and metres they would overflow near zero.
"""

import math

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.mounts.laws.cubic import NODES, WEIGHTS
from wirerope_mj.mounts.laws.ni import ASYMMETRIC_BOUC_WEN, bouc_wen_force

ORDER = 16  # Terms of a Taylor series: a step takes a tenth of the distance to where the series ends
NEAR = 0.1  # |q| up to which the power series of the length from zero is summed: 16 terms reach rounding
# |q| up to which Pfaff's series is: |w| is at most 1/2 there, so that 50 terms reach rounding, 15 with n = 0.1.
_NEAR_BELOW_1 = 1.0 / 3.0
ROUNDING = 1e-16  # Fraction of the state below which a term does not count
_STEPS = 10_000
# n from which on a power of the length is too high for eight points in one panel from zero, and growth of q in a panel.
_SHARP, _GROWTH = 4.0, 20.0
_AT_BOUND = 1e-15  # |1 - q| over 1 + n below which rounding alone moves the state: it stands at its bound


@njit
def edge_of(alpha, b, n):
    """Return the size u of the state up to which `length_from_zero` holds, near zero; infinite for b = 0."""
    if b == 0.0:
        return np.inf
    return ((NEAR if n >= 1.0 else _NEAR_BELOW_1) * alpha / abs(b)) ** (1.0 / n)


@njit
def series_from_zero(q, n):
    """Return sum_k q^k / (k n + 1), for |q| up to that of `edge_of`."""
    if n < 1.0:
        total, term, k, w = 1.0, 1.0, 1.0, q / (q - 1.0)
        while abs(term) > ROUNDING:
            term *= w * n * k / (n * k + 1.0)
            total += term
            k += 1.0
        return total / (1.0 - q)
    total, power, k = 1.0, q, 1.0
    while abs(power) > ROUNDING:
        total += power / (k * n + 1.0)
        power *= q
        k += 1.0
    return total


@njit
def length_from_zero(alpha, b, n, u):
    """Return the length over which u grows from zero along u' = alpha - b u^n, for u up to `edge_of`."""
    return u / alpha * series_from_zero(b / alpha * u**n, n)


@njit
def work_from_zero(alpha, b, n, u):
    """Return the integral of u over the length in which it grows from zero to u, for u up to `edge_of`."""
    return 0.5 * u * u / alpha * series_from_zero(b / alpha * u**n, 0.5 * n)


@njit
def next_panel(alpha, b, n, u, way):
    """Return the u > 0 up to which q = b u^n / alpha is negligible or changes by `_GROWTH` at most; 0 or `edge_of` if near."""
    edge, unseen = edge_of(alpha, b, n), (ROUNDING * alpha / abs(b)) ** (1.0 / n) if b != 0.0 else np.inf
    if way > 0.0:
        return min(edge, unseen if u < unseen else u * _GROWTH ** (1.0 / n))
    return 0.0 if u <= unseen else max(unseen, u * _GROWTH ** (-1.0 / n))


@njit
def at_length(alpha, b, n, length):
    """Return the u to which the state has grown at a length from zero, for u up to `edge_of`."""
    u = alpha * length
    for _ in range(30):
        step = (length_from_zero(alpha, b, n, u) - length) * (alpha - b * u**n)
        u -= step
        if abs(step) <= 1e-15 * u:
            break
    return u


@njit
def series(alpha, b, n, u, way, c, a):
    """Write the Taylor series of u' = way (alpha - b u^n) from u > 0 on for `summed`, and return the length that it reaches.

    `c` and `a` are arrays of ORDER + 1, `a` scratch.
    """
    q = b / alpha * u**n
    a[0] = 1.0
    c[0], c[1] = 1.0, way * (1.0 - q)
    if way > 0.0 and abs(c[1]) <= (1.0 + n) * _AT_BOUND:
        c[1:] = 0.0
        return np.inf
    for k in range(1, ORDER):
        value = 0.0
        for j in range(1, k + 1):
            value += (n * j - (k - j)) * c[j] * a[k - j]
        a[k] = value / k
        c[k + 1] = -way * q * a[k] / (k + 1)
    largest = max(abs(c[ORDER]) ** (1.0 / ORDER), (abs(c[ORDER - 1]) + 1e-300) ** (1.0 / (ORDER - 1)))
    reach = ROUNDING ** (1.0 / ORDER) / largest
    # Beyond zero another equation holds, which the series of a whole exponent would not notice.
    return u / alpha * (reach if way > 0.0 else min(reach, 0.9 / max(1.0, abs(c[1]))))


@njit
def summed(alpha, u, c, length):
    """Return u after a length along a series that starts at `u`."""
    total, part = c[ORDER], alpha * length / u
    for k in range(ORDER - 1, -1, -1):
        total = total * part + c[k]
    return u * total


@njit
def state_after(alpha, b, n, u, length, way, c, a):
    """Return u after a length along u' = way (alpha - b u^n), and the length that remains from where u reached zero."""
    edge = edge_of(alpha, b, n)
    for _ in range(_STEPS):
        if length <= 0.0:
            return u, 0.0
        if b == 0.0:
            return (u + alpha * length, 0.0) if way > 0.0 else (max(u - alpha * length, 0.0), length - u / alpha)
        if u < edge:
            begin, end = length_from_zero(alpha, b, n, u), length_from_zero(alpha, b, n, edge)
            if way < 0.0:
                if length >= begin:
                    return 0.0, length - begin
                return at_length(alpha, b, n, begin - length), 0.0
            if begin + length <= end:
                return at_length(alpha, b, n, begin + length), 0.0
            length -= end - begin
            u = edge
        step = min(length, series(alpha, b, n, u, way, c, a))
        u, length = summed(alpha, u, c, step), length - step
    return np.nan, 0.0


@njit
def carry_power(p, i, x0, x1, z, j, c, a):
    """Carry a Bouc-Wen law's state in place from deflection x0 to x1; `p[i:]` begins with alpha, beta, gamma, n."""
    alpha, beta, gamma, n = p[i], p[i + 1], p[i + 2], p[i + 3]
    s, length = 1.0 if x1 > x0 else -1.0, abs(x1 - x0)
    y = s * z[j]
    if y < 0.0:
        u, length = state_after(alpha, gamma - beta, n, -y, length, -1.0, c, a)
        if u > 0.0 or length <= 0.0:
            z[j] = -s * u
            return
        y = 0.0
    u, _ = state_after(alpha, beta + gamma, n, y, length, 1.0, c, a)
    z[j] = s * u


@njit
def advance_power(law, p, i, x0, x1, z, j, scratch, trial):
    """Advance a Bouc-Wen law's state in place from deflection x0 to x1 and return the work done on the law [J].

    The work is an eight-point Gauss-Legendre sum along each series; near zero it is that of the rest of the force alone.
    `scratch` holds 2 (ORDER + 1) numbers and one more.
    """
    c, a, unused = scratch[: ORDER + 1], scratch[ORDER + 1 : 2 * ORDER + 2], scratch[2 * ORDER + 2 :]
    alpha, n, s = p[i], p[i + 3], 1.0 if x1 > x0 else -1.0
    slope = p[i + 7] if law == ASYMMETRIC_BOUC_WEN else 0.0  # of the logarithm of F2
    bend = 0.5 / abs(slope) if slope != 0.0 else np.inf
    work, x, length, y = 0.0, x0, abs(x1 - x0), s * z[j]
    way, u = (1.0, y) if y >= 0.0 else (-1.0, -y)
    for _ in range(_STEPS):
        if length <= 0.0:
            z[j] = s * way * u
            return work
        b = p[i + 2] + way * p[i + 1]
        edge = edge_of(alpha, b, n)
        if u < edge:  # counted from where the state is zero
            begin = length_from_zero(alpha, b, n, u)
            goal = 0.0 if way < 0.0 else edge
            if slope != 0.0 and n > _SHARP:
                goal = next_panel(alpha, b, n, u, way)
            left = way * (length_from_zero(alpha, b, n, goal) - begin) if goal < np.inf else np.inf
            step = min(length, left, bend)
            end = begin + way * step if step < left or goal > 0.0 else 0.0
            done, u = work_from_zero(alpha, b, n, u), at_length(alpha, b, n, end) if step < left else goal
            work += math.exp(slope * (x + s * step)) * work_from_zero(alpha, b, n, u) - math.exp(slope * x) * done
            # By parts: what F2 changes over the work of the state. Over a root of the length that is smooth enough.
            first, last = math.sqrt(begin), math.sqrt(end)
            for node in range(8):
                trial[0], part = 0.0, step * NODES[node]
                work += s * step * WEIGHTS[node] * bouc_wen_force(law, p, i, x + s * part, 0.0, trial, 0, unused, 0)
                if slope != 0.0:
                    root = first + (last - first) * NODES[node]
                    there = x + s * way * (root * root - begin)
                    grown = work_from_zero(alpha, b, n, at_length(alpha, b, n, root * root))
                    work -= 2.0 * s * way * slope * (last - first) * root * WEIGHTS[node] * math.exp(slope * there) * grown
            if u == 0.0:
                way = 1.0
        else:
            step = min(length, series(alpha, b, n, u, way, c, a), bend)
            for node in range(8):
                part = step * NODES[node]
                trial[0] = s * way * summed(alpha, u, c, part)
                work += s * step * WEIGHTS[node] * bouc_wen_force(law, p, i, x + s * part, 0.0, trial, 0, unused, 0)
            u = summed(alpha, u, c, step)
        x, length = x + s * step, length - step
    return np.nan


@njit
def follow_power(p, deflection, z, out):
    """Write a Bouc-Wen law's state along `deflection` to `out`, (n_t,), entered with `z`, which is carried to the end.

    A series serves all samples within its reach, until the path turns round.
    """
    c, a = np.empty(ORDER + 1), np.empty(ORDER + 1)
    s, sign, start, done, reach = 0.0, 1.0, 0.0, 0.0, -1.0
    out[0] = z[0]
    for t in range(1, deflection.size):
        dx = deflection[t] - deflection[t - 1]
        if dx * s > 0.0 and done + abs(dx) <= reach:
            done += abs(dx)
            z[0] = sign * summed(p[0], start, c, done)
        elif dx != 0.0:
            carry_power(p, 0, deflection[t - 1], deflection[t], z, 0, c, a)
            s, start, done, reach = math.copysign(1.0, dx), abs(z[0]), 0.0, -1.0
            sign, way = math.copysign(1.0, z[0]), math.copysign(1.0, z[0] * s)
            # Near zero a series of a high power has gaps as long as itself, and its last terms say nothing of its reach.
            b = p[2] + way * p[1]
            if z[0] != 0.0 and (2.0 * p[3] < ORDER or abs(b) * abs(z[0]) ** p[3] >= NEAR * p[0]):
                reach = series(p[0], b, p[3], start, way, c, a)
        out[t] = z[0]
