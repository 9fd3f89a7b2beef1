"""The response of one oscillator to samples joined by straight lines: exact steps, and extremes between them; the samples."""

import math

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.jit import inlined, njit

# indices of the extremes: the highest of the absolute acceleration, of displacement and velocity relative to the base; behind
# each stands the lowest
ACCELERATION, DISPLACEMENT, VELOCITY = 0, 2, 4
EXTREMES = 6
# largest distance of an instant from its uniform position, in steps: what rounding to a few digits leaves in a file
JITTER = 0.01


@njit
def extreme_between(y0: float, y1: float, d0: float, d1: float) -> float:
    """Return the extreme of the cubic with values y and slopes d at both ends of a step of length 1; d changes its sign."""
    c3 = d0 + d1 - 2.0 * (y1 - y0)
    c2 = 3.0 * (y1 - y0) - 2.0 * d0 - d1
    root = math.sqrt(max(c2 * c2 - 3.0 * c3 * d0, 0.0))
    # The two roots of d0 + 2 c2 s + 3 c3 s^2, without subtracting numbers that are nearly equal.
    q = -(c2 + math.copysign(root, c2))
    s = q / (3.0 * c3) if c3 != 0.0 else -1.0
    if not 0.0 <= s <= 1.0:
        s = d0 / q if q != 0.0 else 0.0
    return y0 + s * (d0 + s * (c2 + s * c3))


@njit
def free_extremes(u: float, v: float, frequency: float, damping: float, extremes: Array) -> None:
    """Widen `extremes` by those of an oscillator's free vibration that starts from displacement `u` and rate `v`.

    With theta the angle per unit of time (2 pi f T), zeta the damping and w = theta sqrt(1 - zeta^2), displacement, velocity
    and the acceleration y = -(theta^2 u + 2 zeta theta v) are exp(-zeta theta t) (y0 cos w t + (y0' + zeta theta y0) / w
    sin w t). The first extreme lies where tan w t = w y0' / (theta^2 y0 + zeta theta y0'), the next half a turn later
    with the opposite sign and exp(-pi zeta / sqrt(1 - zeta^2)) times as large; later ones are smaller.
    """
    theta, zeta = frequency, damping
    root = math.sqrt(1.0 - zeta * zeta)
    y = -(theta * theta * u + 2.0 * zeta * theta * v)
    rate = -(theta * theta * v + 2.0 * zeta * theta * y)
    for quantity in (ACCELERATION, DISPLACEMENT, VELOCITY):
        start, slope = (y, rate) if quantity == ACCELERATION else (u, v) if quantity == DISPLACEMENT else (v, y)
        angle = math.atan2(root * slope, theta * start + zeta * slope)
        if angle < 0.0:
            angle += math.pi
        decay = math.exp(-zeta * angle / root)
        first = decay * (start * math.cos(angle) + (slope / theta + zeta * start) / root * math.sin(angle))
        second = -first * math.exp(-math.pi * zeta / root)
        extremes[quantity] = max(extremes[quantity], start, first, second)
        extremes[quantity + 1] = min(extremes[quantity + 1], start, first, second)


@inlined
def widen(extremes, quantity, value):  # type: ignore[no-untyped-def]
    """Raise the highest or lower the lowest value of a quantity among `extremes`, in place, if `value` is beyond it."""
    extremes[quantity] = max(extremes[quantity], value)
    extremes[quantity + 1] = min(extremes[quantity + 1], value)


@njit
def ramp_extremes(x: Array, step: Array, frequency: float, damping: float, primary: Array, residual: Array) -> None:
    """Find the extremes of one oscillator that starts at rest, while its base is accelerated by `x` and after.

    Lengths of time are steps of the record: u is in m/s^2 times the step squared, v in m/s^2 times the step.

    Args:
        x: base acceleration [m/s^2], (n,), straight between the samples and zero after the last.
        step: what u, v, x at the start and x at the end of a step give for u and v at its end, (2, 4).
        frequency: angle per step theta = 2 pi f T [rad].
        damping: ratio.
        primary: extremes while it is driven, (6,), zero before.
        residual: those of what follows, in the same way.
    """
    stiffness, viscosity = frequency * frequency, 2.0 * damping * frequency
    u, v, y = 0.0, 0.0, 0.0
    rate = viscosity * x[0]
    for i in range(x.size - 1):
        a, b = x[i], x[i + 1]
        u_next = step[0, 0] * u + step[0, 1] * v + step[0, 2] * a + step[0, 3] * b
        v_next = step[1, 0] * u + step[1, 1] * v + step[1, 2] * a + step[1, 3] * b
        y_next = -stiffness * u_next - viscosity * v_next
        rate_next = -stiffness * v_next - viscosity * (y_next - b)
        widen(primary, ACCELERATION, y_next)
        widen(primary, DISPLACEMENT, u_next)
        widen(primary, VELOCITY, v_next)
        if rate * rate_next < 0.0:
            widen(primary, ACCELERATION, extreme_between(y, y_next, rate, rate_next))
        if v * v_next < 0.0:
            widen(primary, DISPLACEMENT, extreme_between(u, u_next, v, v_next))
        if (y - a) * (y_next - b) < 0.0:
            widen(primary, VELOCITY, extreme_between(v, v_next, y - a, y_next - b))
        u, v, y, rate = u_next, v_next, y_next, rate_next
    free_extremes(u, v, frequency, damping, residual)


def check_samples(time: ArrayLike, acceleration: ArrayLike) -> tuple[Array, float]:
    """Return the samples as an array, (n,) or (n, k), and their step [s].

    ValueError: instants and samples do not belong together, are too few, not finite or not uniform.
    """
    instants, values = np.asarray(time, dtype=np.float64), np.asarray(acceleration, dtype=np.float64)
    if instants.ndim != 1 or instants.size < 2:
        raise ValueError(f"`time` must hold at least two instants in a row, got the shape {instants.shape}.")
    if values.ndim not in (1, 2) or values.shape[0] != instants.size:
        raise ValueError(
            f"`acceleration` must hold one row for each of the {instants.size} instants, got the shape {values.shape}."
        )
    if not np.isfinite(instants).all():
        raise ValueError(f"`time` must be finite; instant {int(np.flatnonzero(~np.isfinite(instants))[0])} is not.")
    if not np.isfinite(values).all():
        row = int(np.argwhere(~np.isfinite(values))[0, 0])
        raise ValueError(f"`acceleration` must be finite; the sample at {instants[row]:.6g} s is not.")
    step = float(instants[-1] - instants[0]) / (instants.size - 1)
    if not step > 0.0:
        raise ValueError("`time` must increase.")
    away = np.abs(instants - (instants[0] + step * np.arange(instants.size))) / step
    if away.max() > JITTER:
        row = int(np.argmax(away > JITTER))
        raise ValueError(
            f"`time` must be uniform: {instants[row]:.9g} s lies {away[row]:.3g} steps of {step:.6g} s away from its position; "
            "resample the record first."
        )
    return values, step


def octave_grid(low: float, high: float, *, per_octave: int = 12) -> Array:
    """Return frequencies evenly spaced in logarithm, `per_octave` to an octave, that include 1000 Hz if it is within [Hz]."""
    first = math.ceil(per_octave * math.log2(low / 1000.0) - 1e-9)
    last = math.floor(per_octave * math.log2(high / 1000.0) + 1e-9)
    return 1000.0 * 2.0 ** (np.arange(first, max(first, last) + 1) / per_octave)
