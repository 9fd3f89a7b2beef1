"""A mass under the shock of its base on devices, and in systems, that no law of the package follows, by a loop of its own.

Sliders and a cubic spring, LuGre's bristles, a fixture that gives below a device, a payload of two masses.
"""

from dataclasses import dataclass, replace

import numpy as np
from numba import njit

import wirerope_mj as wr

GRAVITY = 9.80665
STEP = 1e-5  # [s]: of a Bouc-Wen mass peaks are within 1e-3 of `simulate`
KINDS = ("sliders", "lugre", "fixture", "second mode")


@dataclass(frozen=True)
class Foreign:
    """A mass on a device; forces of the device are those of its bristles or sliders and of a polynomial."""

    kind: str
    slip: np.ndarray  # of the sliders [m]
    stiffness: np.ndarray  # of the sliders [N/m]
    linear: float  # [N/m]
    cubic: float  # [N/m^3]
    mass: float = 20.0  # [kg]
    bristle: bool = False  # sliders are LuGre's, which bend before they slip
    stribeck: float = 0.0  # part of friction that a rate takes away
    fixture: tuple[float, float, float] = (0.0, 0.0, 0.0)  # mass, stiffness, viscous damping below the device
    inner: tuple[float, float, float] = (0.0, 0.0, 0.0)  # part of the mass that hangs on a spring, its stiffness and damping

    def row(self):
        """Return the numbers that the loop takes."""
        head = [self.linear, self.cubic, float(self.bristle), self.stribeck, self.mass, *self.fixture, *self.inner]
        return np.array(head), self.slip, self.stiffness

    def loops(self, sizes, noise, seed):
        """Return steady loops of the device alone about zero."""
        time = np.arange(0.0, 4.0 * len(sizes), 1.0 / 2000.0)
        path = np.repeat(sizes, 4)[time.astype(int)] * np.sin(2.0 * np.pi * time)
        force = _traced(*self.row(), path, 1.0 / 2000.0)[::5]
        force = force + noise * 0.5 * np.ptp(force) * np.random.default_rng(seed).standard_normal(force.size)
        return wr.steady_loops(path[::5], force, time=time[::5])

    def along(self, path, step):
        """Return the forces along a path of the device alone, from the unloaded one, a step [s] between samples."""
        return _traced(*self.row(), path, step)

    def struck(self, motion, duration):
        """Return instants, absolute acceleration of the mass, deflection and force of the device, (n_t,) each."""
        count = int(duration / STEP)
        base = motion.acceleration((np.arange(count) + 0.5) * STEP)[:, 2]
        acceleration, deflection, force = _stepped(*self.row(), base, STEP)
        return (np.arange(count) + 1.0) * STEP, acceleration, deflection, force


@njit(cache=True)
def _force(head, slip, stiffness, held, x, step, rate):
    """Return the force at x after a step there; `held` is changed."""
    total = head[0] * x + head[1] * x**3
    fall = 1.0 + head[3] * np.exp(-((rate / 5e-3) ** 2)) if head[2] else 1.0
    for k in range(slip.size):
        if head[2]:
            if step != 0.0:
                limit = np.sign(step) * slip[k] * fall
                held[k] = limit + (held[k] - limit) * np.exp(-abs(step) / (slip[k] * fall))
        else:
            held[k] = min(max(held[k] + step, -slip[k]), slip[k])
        total += stiffness[k] * held[k]
    return total


@njit(cache=True)
def _traced(head, slip, stiffness, path, step):
    held, forces = np.zeros(slip.size), np.zeros(path.size)
    for row in range(1, path.size):
        move = path[row] - path[row - 1]
        forces[row] = _force(head, slip, stiffness, held, path[row], move, abs(move) / step)
    return forces


@njit(cache=True)
def _stepped(head, slip, stiffness, base, h):
    """Return absolute acceleration, deflection, force: symplectic steps from the equilibrium of a slow load."""
    mass, below, k_f, c_f, part, k_i, c_i = head[4], head[5], head[6], head[7], head[8], head[9], head[10]
    held, x = np.zeros(slip.size), 0.0
    force = 0.0
    while force > -mass * 9.80665:  # loaded slowly from zero
        x -= 1e-6
        force = _force(head, slip, stiffness, held, x, -1e-6, 0.0)
    outer, hung = mass * (1.0 - part), mass * part
    v, f, vf, y, vy = 0.0, 0.0, 0.0, 0.0, 0.0  # rates and places over the base, from the equilibrium: outer, fixture, hung
    place, rest = 0.0, force
    n = base.size
    acceleration, deflection, forces = np.zeros(n), np.zeros(n), np.zeros(n)
    for row in range(n):
        spring = k_i * (place - y) + c_i * (v - vy)
        pull = force - rest  # the weight is carried
        a = -(pull + spring) / outer
        acceleration[row] = a
        v += h * (a - base[row])
        place += h * v
        if part > 0.0:
            vy += h * (spring / hung - base[row])
            y += h * vy
        if below > 0.0:
            vf += h * ((pull - k_f * f - c_f * vf) / below - base[row])
            f += h * vf
        move = h * (v - vf)
        x += move
        force = _force(head, slip, stiffness, held, x, move, abs(v - vf))
        deflection[row], forces[row] = x, force
    return acceleration, deflection, forces


def drawn(kind, rng):
    """Return a foreign system of a kind."""
    count = 2 if kind == "lugre" else 12
    low, high = rng.uniform(0.05e-3, 0.2e-3), rng.uniform(4e-3, 9e-3)
    slip = np.geomspace(low, high, count) if count > 2 else np.array([0.5e-3, 1.5e-3])
    friction = rng.uniform(100.0, 200.0)
    device = Foreign(
        kind=kind, slip=slip, stiffness=friction / count / slip, linear=rng.uniform(2e4, 4e4),
        cubic=rng.uniform(5e6, 4e7), mass=20.0 * (1.0 + 0.03 * rng.standard_normal()),
    )  # fmt: skip
    if kind == "lugre":
        return replace(device, bristle=True, stribeck=rng.uniform(0.0, 0.2))
    omega = np.sqrt(device.linear / device.mass)
    if kind == "fixture":  # 2 to 4 times as stiff as the device's spring
        mass, stiffness = 1.0, device.linear * rng.uniform(3.0, 8.0)
        return replace(device, fixture=(mass, stiffness, 0.05 * np.sqrt(mass * stiffness)))
    if kind == "second mode":
        part, ratio = rng.uniform(0.1, 0.3), rng.uniform(2.5, 5.0)
        hung = part * device.mass
        return replace(device, inner=(part, hung * (ratio * omega) ** 2, 2.0 * 0.03 * hung * ratio * omega))
    return device
