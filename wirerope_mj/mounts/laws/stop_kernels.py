"""The kernel of a bump stop: its force, and the work along a path that its corners cut into smooth segments."""

import math

import numpy as np

from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import count, raised, some, where
from wirerope_mj.mounts.laws.cubic import NODES, WEIGHTS, position, speed, zero_between
from wirerope_mj.mounts.laws.table_kernels import ROW, cubics, row_at

# Offsets of a stop's parameters behind 1 / reversal (twice), 0 and 1, which are those of a Bouc-Wen law with n = 1.
LOSS, VISCOUS, BELOW, ABOVE, ROUNDING, STIFFNESS, EXPONENT, N_POINTS, POINTS = range(4, 13)
_SHORTEST = 1e-12  # Fraction of an interval that is passed over where rounding holds a path on a corner
_NO_ROUNDING = 1e-300  # Taken for a rounding of zero [m], of which no depth is a fraction
# Panels at least: within its rounding a hardening stop begins as depth^(3 exponent), which eight points have to 1e-10 then.
_PANELS = 4
_STEEPEST = 4.0  # Largest slope of `graded_node`


@njit
def rounded_depth(depth, rounding):
    """Return a depth > 0 [m] after rounding, r (t^3 - t^4 / 2) up to t = depth / r = 1, then depth - r / 2, and its slope."""
    t = min(depth / max(rounding, _NO_ROUNDING), 1.0)
    within = rounding * t * t * t * (1.0 - 0.5 * t)
    return where(depth >= rounding, depth - 0.5 * rounding, within), t * t * (3.0 - 2.0 * t)


@njit
def elastic(p, i, depth):
    """Return the elastic force of the stop [N] at a rounded depth [m]."""
    if count(p, i + N_POINTS) > 0:
        table = i + N_POINTS - 4  # as in a tabulated law
        return cubics(p, table, row_at(p, table, depth), depth)[0]
    return p[i + STIFFNESS] * raised(depth, p[i + EXPONENT])


@njit
def stop_force(p, i, x, v, w):
    """Return the force of a stop [N] with the state w of its loss."""
    below, above = p[i + BELOW], p[i + ABOVE]
    pressed, pulled = x < -below, x > above
    if not some(pressed | pulled):
        return 0.0
    side = where(pressed, -1.0, 1.0)
    depth = where(pressed, -x - below, x - above)
    counted, slope = rounded_depth(depth, p[i + ROUNDING])
    force = elastic(p, i, counted) * (1.0 + p[i + LOSS] * side * w) + p[i + VISCOUS] * slope * side * v
    return where(pressed | pulled, side * max(force, 0.0), 0.0)


@njit
def stop(p, i, x, v, z, j, zdot, k):
    """Return the force of a stop [N]; the state w of a lossy one follows w' = (v - |v| w) / reversal, the only state.

    p = 1 / reversal, 1 / reversal, 0, 1, loss, c, gap below, gap above, rounding, k, exponent, number n of knots, and of the
    points what a tabulated law has behind that, then the knots as depths behind the gap (n,).
    """
    w = 0.0
    if some(p[i + LOSS] != 0.0):  # then in every lane: without loss there is no state
        w = z[j]
        zdot[k] = p[i] * (v - abs(v) * w)
    return stop_force(p, i, x, v, w)


@njit
def loss_state_after(p, i, w, s, length):
    """Return the state w of a stop's loss after a length [m] in the direction s, 1 or -1."""
    return s + (w - s) * math.exp(-p[i] * length)


@njit
def next_corner(p, i, x, s):
    """Return the next corner of a stop's force (touch, end of rounding, knot) from x in the direction s [m]; or infinity."""
    best, n = np.inf, int(p[i + N_POINTS])
    for side in (-1.0, 1.0):
        gap, r = (p[i + BELOW] if side < 0.0 else p[i + ABOVE]), p[i + ROUNDING]
        for corner in range(2 + n):
            depth = 0.0
            if corner == 1:
                depth = r
            elif corner > 1:
                depth = p[i + POINTS + n + ROW * (n + 1) + corner - 2]
            ahead = s * (side * (gap + depth) - x)
            if 0.0 < ahead < best:
                best = ahead
    return x + s * best


@njit
def starts_at_touch(p, i, x, length):
    """True if the force is not smooth, or hardly so, at the start x of an interval: where the stop touches.

    x is at the touch of a stop without rounding, or beyond a touch by less than a quarter of the interval.
    """
    depth = max(-x - p[i + BELOW], x - p[i + ABOVE])
    return (p[i + ROUNDING] == 0.0 and depth == 0.0) or 0.0 < depth < 0.25 * length


@njit
def graded_node(u, touch):
    """Return a fraction of an interval and its slope over u, 0 to 1: u^4 from a touch at the interval's start (-1) or end (1).

    At a touch a force d^exponent is not smooth over the depth d, but over u it is as smooth as u^(4 exponent + 3).
    """
    if touch == 0:
        return u, 1.0
    u = u if touch < 0 else 1.0 - u
    part = u * u * u * u
    return (part if touch < 0 else 1.0 - part), _STEEPEST * u * u * u


@njit
def advance_stop(p, i, x0, x1, z, j):
    """Carry the state of a stop without viscous loss from x0 to x1 in place and return the work done on it [J]."""
    s, work, x, lossy = 1.0 if x1 > x0 else -1.0, 0.0, x0, p[i + LOSS] > 0.0
    w = z[j] if lossy else 0.0
    while x != x1:
        corner = next_corner(p, i, x, s)
        end = x1 if s * (corner - x1) >= 0.0 else corner
        if not -p[i + BELOW] <= 0.5 * (x + end) <= p[i + ABOVE]:
            # On each panel w is an exponential over at most one of its lengths.
            length = abs(end - x)
            panels = _PANELS + (int(min(_STEEPEST * p[i] * length, 160.0)) if lossy else 0)
            touch = -1 if starts_at_touch(p, i, x, length) else 1 if starts_at_touch(p, i, end, length) else 0
            for panel in range(panels):
                for node in range(8):
                    part, weight = graded_node((panel + NODES[node]) / panels, touch)
                    here = loss_state_after(p, i, w, s, length * part) if lossy else 0.0
                    force = stop_force(p, i, x + s * length * part, 0.0, here)
                    work += s * length / panels * WEIGHTS[node] * weight * force
        if lossy:
            w = loss_state_after(p, i, w, s, abs(end - x))
        x = end
    if lossy:
        z[j] = w
    return work


@njit
def unclipped_push(p, i, cubic, t, x0, w, s):
    """Return a stop's force before it is clipped at 0 [N], > 0 where the stop pushes; w is its state at x0, direction s."""
    x, v = position(cubic, t), speed(cubic, t)
    here = loss_state_after(p, i, w, s, abs(x - x0)) if p[i + LOSS] > 0.0 else 0.0
    below, above = -x - p[i + BELOW], x - p[i + ABOVE]
    side, depth = (-1.0, below) if below > above else (1.0, above)
    if depth <= 0.0:
        return 0.0
    counted, slope = rounded_depth(depth, p[i + ROUNDING])
    return elastic(p, i, counted) * (1.0 + p[i + LOSS] * side * here) + p[i + VISCOUS] * slope * side * v


@njit
def contact_change_time(p, i, cubic, start, end, x0, w, s):
    """Bisect for the instant at which a viscous stop separates or engages, once between `start` and `end`."""
    rising = unclipped_push(p, i, cubic, end, x0, w, s) > 0.0
    for _ in range(60):
        middle = 0.5 * (start + end)
        if (unclipped_push(p, i, cubic, middle, x0, w, s) > 0.0) == rising:
            end = middle
        else:
            start = middle
    return end


@njit
def pushing_work(p, i, cubic, start, end, x0, w, s):
    """Return the work of a stop [J] over an interval in which it pushes throughout or not at all."""
    work, width = 0.0, end - start
    for node in range(8):
        t = start + width * NODES[node]
        force = max(unclipped_push(p, i, cubic, t, x0, w, s), 0.0)
        x = position(cubic, t)
        work += width * WEIGHTS[node] * speed(cubic, t) * (-force if -x - p[i + BELOW] > x - p[i + ABOVE] else force)
    return work


@njit
def stop_work(p, i, cubic, start, end, z, j):
    """Carry the state of a bump stop's loss along a cubic path without a reversal, and return the work done on the stop [J]."""
    x0, x1, lossy = position(cubic, start), position(cubic, end), p[i + LOSS] > 0.0
    s, work, t, w, x = 1.0 if x1 > x0 else -1.0, 0.0, start, z[j] if lossy else 0.0, x0
    while t < end:
        corner = next_corner(p, i, x, s)  # from the last one on, and not from where rounding holds the path before it
        until = end
        if s * (corner - x1) < 0.0:
            until = zero_between((cubic[0] - corner, cubic[1], cubic[2], cubic[3]), t, end)
            if until <= t:  # by rounding the path stands on the corner
                until = min(end, t + _SHORTEST * (end - start))
        panels = _PANELS + (int(min(p[i] * abs(x1 - x0), 40.0)) if lossy else 0)
        for panel in range(panels):
            one, two = t + (until - t) * panel / panels, t + (until - t) * (panel + 1) / panels
            if (unclipped_push(p, i, cubic, one, x0, w, s) > 0.0) != (unclipped_push(p, i, cubic, two, x0, w, s) > 0.0):
                kink = contact_change_time(p, i, cubic, one, two, x0, w, s)
                work += pushing_work(p, i, cubic, one, kink, x0, w, s)
                one = kink
            work += pushing_work(p, i, cubic, one, two, x0, w, s)
        t, x = until, corner
    if lossy:
        z[j] = loss_state_after(p, i, w, s, abs(x1 - x0))
    return work
