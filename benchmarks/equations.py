"""The benchmark problems as equations written by hand: for SciPy with NumPy, and as a numba RK4 loop."""

import numpy as np
import numpy.typing as npt
from floor import ALPHA, AXIS, CENTRE, INERTIA, MASS, K, mount_positions
from numba import njit

import wirerope_mj as wr

Array = npt.NDArray[np.float64]
G = wr.STANDARD_GRAVITY

# Floor: 10 g vertical and 5 g longitudinal half-sine of 10 ms. State: position relative to the deck (3), velocity (3),
# quaternion (4), angular velocity in the floor's frame (3), z (24).
PULSE, SHOCK = 0.01, np.array([5.0 * G, 0.0, 10.0 * G])
ARMS = mount_positions(8) - np.array(CENTRE)  # from the floor's centre of mass to its mounts
J = np.array(INERTIA)
BETA, GAMMA = AXIS.beta, AXIS.gamma
FLOOR_START = np.concatenate([np.zeros(6), [1.0], np.zeros(6), np.zeros(24)])

# One mass: 3.5 kg on Bouc-Wen and a cubic spring, 0.5 g sweep from 5 Hz at 2 octaves per minute. State: x, v, z.
SDOF_MASS = 3.5
SDOF_LAW = wr.SymmetricBoucWen(
    alpha=8000.0, beta=0.6 * 8000.0 / 8.0**1.2, gamma=0.4 * 8000.0 / 8.0**1.2, n=1.2, k1=4000.0, k2=0.0, k3=1e7
)
SDOF = SDOF_LAW.kernel_parameters()  # alpha, beta, gamma, n, k1, k2, k3
SWEEP_FROM, GROWTH, SWEEP_LEVEL = 5.0, 2.0 * np.log(2.0) / 60.0, 0.5 * G
SDOF_START = np.zeros(3)


def floor_rates(t: float, y: Array) -> Array:
    """Return dy/dt of the floor in NumPy, as one would write it for `solve_ivp`."""
    w, x, v, u = y[6], y[7], y[8], y[9]
    rotation = np.array(
        [
            [1 - 2 * (v * v + u * u), 2 * (x * v - w * u), 2 * (x * u + w * v)],
            [2 * (x * v + w * u), 1 - 2 * (x * x + u * u), 2 * (v * u - w * x)],
            [2 * (x * u - w * v), 2 * (v * u + w * x), 1 - 2 * (x * x + v * v)],
        ]
    )
    omega, z = y[10:13], y[13:].reshape(8, 3)
    arms = ARMS @ rotation.T
    deflection = y[:3] + arms - ARMS
    rate = y[3:6] + np.cross(rotation @ omega, arms)
    force = -(K * deflection + z)
    torque = rotation.T @ np.cross(arms, force).sum(axis=0)
    shock = SHOCK * np.sin(np.pi * t / PULSE) if t < PULSE else np.zeros(3)
    out = np.empty_like(y)
    out[:3] = y[3:6]
    out[3:6] = force.sum(axis=0) / MASS - shock
    a, b, c = omega
    out[6:10] = 0.5 * np.array([-x * a - v * b - u * c, w * a + v * c - u * b, w * b - x * c + u * a, w * c + x * b - v * a])
    out[10:13] = (torque - np.cross(omega, J * omega)) / J
    out[13:] = (ALPHA * rate - (BETA * np.abs(rate) * z + GAMMA * rate * np.abs(z))).ravel()
    return out


def sdof_rates(t: float, y: Array) -> Array:
    """Return dy/dt of the mass in NumPy."""
    alpha, beta, gamma, n, k1, _, k3 = SDOF
    x, v, z = y
    phase = 2.0 * np.pi * SWEEP_FROM / GROWTH * np.expm1(GROWTH * t)
    zdot = (alpha - (gamma + beta * np.sign(v) * np.sign(z)) * np.abs(z) ** n) * v
    return np.array([v, -(z + k1 * x + k3 * x**3) / SDOF_MASS - SWEEP_LEVEL * np.sin(phase), zdot])


@njit(error_model="numpy")
def _floor_rates(y, shock, arms, out):
    w, x, v, u = y[6], y[7], y[8], y[9]
    r00, r01, r02 = 1 - 2 * (v * v + u * u), 2 * (x * v - w * u), 2 * (x * u + w * v)
    r10, r11, r12 = 2 * (x * v + w * u), 1 - 2 * (x * x + u * u), 2 * (v * u - w * x)
    r20, r21, r22 = 2 * (x * u - w * v), 2 * (v * u + w * x), 1 - 2 * (x * x + v * v)
    a, b, c = y[10], y[11], y[12]
    ox, oy, oz = r00 * a + r01 * b + r02 * c, r10 * a + r11 * b + r12 * c, r20 * a + r21 * b + r22 * c
    fx, fy, fz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for m in range(arms.shape[0]):
        px, py, pz = arms[m, 0], arms[m, 1], arms[m, 2]
        ax = r00 * px + r01 * py + r02 * pz
        ay = r10 * px + r11 * py + r12 * pz
        az = r20 * px + r21 * py + r22 * pz
        i = 13 + 3 * m
        qx = -(K * (y[0] + ax - px) + y[i])
        qy = -(K * (y[1] + ay - py) + y[i + 1])
        qz = -(K * (y[2] + az - pz) + y[i + 2])
        fx, fy, fz = fx + qx, fy + qy, fz + qz
        tx, ty, tz = tx + ay * qz - az * qy, ty + az * qx - ax * qz, tz + ax * qy - ay * qx
        sx, sy, sz = y[3] + oy * az - oz * ay, y[4] + oz * ax - ox * az, y[5] + ox * ay - oy * ax
        out[i] = ALPHA * sx - (BETA * abs(sx) * y[i] + GAMMA * sx * abs(y[i]))
        out[i + 1] = ALPHA * sy - (BETA * abs(sy) * y[i + 1] + GAMMA * sy * abs(y[i + 1]))
        out[i + 2] = ALPHA * sz - (BETA * abs(sz) * y[i + 2] + GAMMA * sz * abs(y[i + 2]))
    out[0], out[1], out[2] = y[3], y[4], y[5]
    out[3] = fx / MASS - shock * SHOCK[0]
    out[4] = fy / MASS - shock * SHOCK[1]
    out[5] = fz / MASS - shock * SHOCK[2]
    out[6], out[7] = 0.5 * (-x * a - v * b - u * c), 0.5 * (w * a + v * c - u * b)
    out[8], out[9] = 0.5 * (w * b - x * c + u * a), 0.5 * (w * c + x * b - v * a)
    out[10] = (r00 * tx + r10 * ty + r20 * tz - b * c * (J[2] - J[1])) / J[0]
    out[11] = (r01 * tx + r11 * ty + r21 * tz - c * a * (J[0] - J[2])) / J[1]
    out[12] = (r02 * tx + r12 * ty + r22 * tz - a * b * (J[1] - J[0])) / J[2]


@njit(error_model="numpy")
def floor_rk4(y0, h, every, rows):
    """Return the state after each `every` steps of `h` [s], (rows + 1, 37)."""
    n = y0.size
    out = np.empty((rows + 1, n))
    y, trial = y0.copy(), np.empty(n)
    k1, k2, k3, k4 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    out[0] = y
    for step in range(rows * every):
        t = step * h
        start = np.sin(np.pi * t / PULSE) if t < PULSE else 0.0
        middle = np.sin(np.pi * (t + 0.5 * h) / PULSE) if t + 0.5 * h < PULSE else 0.0
        end = np.sin(np.pi * (t + h) / PULSE) if t + h < PULSE else 0.0
        _floor_rates(y, start, ARMS, k1)
        for i in range(n):
            trial[i] = y[i] + 0.5 * h * k1[i]
        _floor_rates(trial, middle, ARMS, k2)
        for i in range(n):
            trial[i] = y[i] + 0.5 * h * k2[i]
        _floor_rates(trial, middle, ARMS, k3)
        for i in range(n):
            trial[i] = y[i] + h * k3[i]
        _floor_rates(trial, end, ARMS, k4)
        for i in range(n):
            y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])
        if (step + 1) % every == 0:
            out[(step + 1) // every] = y
    return out


@njit(error_model="numpy")
def _sdof_rates(x, v, z, acceleration):
    power = abs(z) ** SDOF[3]
    total = SDOF[2] + SDOF[1] if v * z >= 0.0 else SDOF[2] - SDOF[1]
    return -(z + x * (SDOF[4] + SDOF[6] * x * x)) / SDOF_MASS - acceleration, (SDOF[0] - total * power) * v


@njit(error_model="numpy")
def _sweep(t):
    return SWEEP_LEVEL * np.sin(2.0 * np.pi * SWEEP_FROM / GROWTH * np.expm1(GROWTH * t))


@njit(error_model="numpy")
def sdof_rk4(y0, h, every, rows):
    """Return the state after each `every` steps of `h` [s], (rows + 1, 3)."""
    out = np.empty((rows + 1, 3))
    x, v, z = y0
    out[0] = y0
    end = _sweep(0.0)
    for step in range(rows * every):
        start, middle, end = end, _sweep((step + 0.5) * h), _sweep((step + 1) * h)
        a1, r1 = _sdof_rates(x, v, z, start)
        v2 = v + 0.5 * h * a1
        a2, r2 = _sdof_rates(x + 0.5 * h * v, v2, z + 0.5 * h * r1, middle)
        v3 = v + 0.5 * h * a2
        a3, r3 = _sdof_rates(x + 0.5 * h * v2, v3, z + 0.5 * h * r2, middle)
        v4 = v + h * a3
        a4, r4 = _sdof_rates(x + h * v3, v4, z + h * r3, end)
        x += h / 6.0 * (v + 2.0 * (v2 + v3) + v4)
        v += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
        z += h / 6.0 * (r1 + 2.0 * (r2 + r3) + r4)
        if (step + 1) % every == 0:
            out[(step + 1) // every] = x, v, z
    return out
