"""Independent solutions that simulations are held against: nothing here comes from the library.

One degree of freedom is integrated branch by branch between its events, so that the integrator never meets a kink; a
rigid floor by Newton's and Euler's equations about the centre of mass, written with NumPy and integrated by SciPy.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp


@dataclass(frozen=True)
class Pulse:
    """Acceleration pulse of a base, "half-sine" or "sawtooth" (terminal peak), with its own two integrals."""

    shape: str
    peak: float
    duration: float
    start: float = 0.0

    def acceleration(self, t, *, inside):
        """Return the acceleration; `inside` says which side of a corner is meant."""
        if not inside:
            return 0.0
        s = (t - self.start) / self.duration
        return self.peak * (np.sin(np.pi * s) if self.shape == "half-sine" else s)

    def velocity(self, t):
        """Return the velocity, continuous."""
        s = min(max((t - self.start) / self.duration, 0.0), 1.0)
        if self.shape == "half-sine":
            return self.peak * self.duration / np.pi * (1.0 - np.cos(np.pi * s))
        return self.peak * self.duration * s**2 / 2.0

    def displacement(self, t):
        """Return the displacement."""
        s = min(max((t - self.start) / self.duration, 0.0), 1.0)
        coasting = self.velocity(t) * max(t - self.start - self.duration, 0.0)
        if self.shape == "half-sine":
            return self.peak * self.duration**2 / np.pi * (s - np.sin(np.pi * s) / np.pi) + coasting
        return self.peak * self.duration**2 * s**3 / 6.0 + coasting

    def segments(self, stop):
        """Return (begin, end, inside) of the smooth stretches up to `stop`."""
        a, b = self.start, self.start + self.duration
        parts = [(0.0, a, False), (a, b, True), (b, stop, False)]
        return [part for part in parts if part[1] > part[0]]


@dataclass(frozen=True)
class OscillatorSolution:
    """Deflection, rate and z at the times asked for, and their extremes at the reversals, which are located exactly."""

    x: np.ndarray
    v: np.ndarray
    z: np.ndarray
    peak_x: float
    peak_force: float


def oscillator(*, mass, alpha, beta, gamma, n, k1, k3, pulse, times):
    """Return the motion relative to the base of `mass` on F = k1 x + k3 x^3 + z, at rest at time zero, no gravity.

    Between events the signs of v and z are constants, so the right-hand side is smooth: z' = [alpha - c |z|^n] v with
    c = gamma + beta if z grows in magnitude and gamma - beta if it shrinks.
    """
    times = np.asarray(times)
    out = np.zeros((times.size, 3))
    y, sv, sz = np.zeros(3), 0.0, 0.0
    peak_x = peak_force = 0.0

    def elastic(x):
        return k1 * x + k3 * x**3

    for begin, end, inside in pulse.segments(times[-1]):
        t = begin
        while t < end:
            if not y.any():
                if not inside:
                    break
                # From rest all three follow the first push, which is against the base's acceleration.
                sv = sz = -np.sign(pulse.peak)
            c = gamma + beta * sv * sz

            def rates(t, y, c=c, inside=inside):
                x, v, z = y
                push = pulse.acceleration(t, inside=inside)
                return [v, -(elastic(x) + z) / mass - push, (alpha - c * abs(z) ** n) * v]

            def reversal(t, y):
                return y[1]

            def crossing(t, y):
                return y[2]

            reversal.terminal = crossing.terminal = True
            reversal.direction, crossing.direction = -sv, -sz
            run = solve_ivp(
                rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-14, events=[reversal, crossing],
                dense_output=True, first_step=1e-6 if end - t > 1e-6 else None,
            )  # fmt: skip
            assert run.success, run.message
            inner = (times >= t) & (times <= run.t[-1])
            if inner.any():
                out[inner] = run.sol(times[inner]).T
            t, y = run.t[-1], run.y[:, -1].copy()
            if run.t_events[0].size:
                y[1], sv = 0.0, -sv
                peak_x = max(peak_x, abs(y[0]))
                peak_force = max(peak_force, abs(elastic(y[0]) + y[2]))
            elif run.t_events[1].size:
                y[2], sz = 0.0, -sz
            else:
                t = end
    return OscillatorSolution(*out.T, peak_x=peak_x, peak_force=peak_force)


@dataclass(frozen=True)
class RigidFloor:
    """A rigid floor on mounts that act along fixed axes of a deck that only translates.

    mass [kg], inertia (3, 3) about the centre of mass; `centre` (3,) where it stands unloaded; `points` (n, 3) of the mounts in
    the unloaded geometry; `axes` (n, 3, 3) with roll, shear, axial as columns; the law's parameters (n, 3) by axis:
    F = exp(lam x) [z + k1 x + k2 x |x| + k3 x^3].
    """

    mass: float
    inertia: np.ndarray
    centre: np.ndarray
    points: np.ndarray
    axes: np.ndarray
    law: dict[str, np.ndarray]
    gravity: float

    def mounts(self, y, deck_position, deck_velocity):
        """Return deflection, force, rate of z in mount axes, arms and the world forces on the floor."""
        p, q, v, w = y[0:3], y[3:7] / np.linalg.norm(y[3:7]), y[7:10], y[10:13]
        z = y[13:].reshape(-1, 3)
        turn = matrix(q)
        arm = (self.points - self.centre) @ turn.T
        spin = turn @ w
        d = np.einsum("nij,ni->nj", self.axes, p + arm - self.points - deck_position)
        rate = np.einsum("nij,ni->nj", self.axes, v + np.cross(spin, arm) - deck_velocity)
        c = self.law
        size = np.abs(z)
        z_rate = rate * (c["alpha"] - (c["gamma"] + c["beta"] * np.sign(rate * z)) * size ** c["n"])
        f = np.exp(c["lam"] * d) * (z + c["k1"] * d + c["k2"] * d * np.abs(d) + c["k3"] * d**3)
        return d, f, z_rate, arm, -np.einsum("nij,nj->ni", self.axes, f)

    def rates(self, y, deck_position, deck_velocity):
        """Return dy/dt of position, quaternion, velocity, body angular velocity and z."""
        _, _, z_rate, arm, push = self.mounts(y, deck_position, deck_velocity)
        q, w = y[3:7], y[10:13]
        turn = matrix(q / np.linalg.norm(q))
        force = push.sum(axis=0) + [0.0, 0.0, -self.mass * self.gravity]
        torque = turn.T @ np.cross(arm, push).sum(axis=0)
        spin_rate = np.linalg.solve(self.inertia, torque - np.cross(w, self.inertia @ w))
        q_rate = 0.5 * np.array([
            -q[1] * w[0] - q[2] * w[1] - q[3] * w[2],
            q[0] * w[0] + q[2] * w[2] - q[3] * w[1],
            q[0] * w[1] + q[3] * w[0] - q[1] * w[2],
            q[0] * w[2] + q[1] * w[1] - q[2] * w[0],
        ])  # fmt: skip
        return np.concatenate([y[7:10], q_rate, force / self.mass, spin_rate, z_rate.ravel()])

    def solve(self, pulses, times, *, corners):
        """Return states (n_t, 13 + 3 n) at `times`, released at rest from the unloaded geometry.

        `pulses` is a list of (Pulse, unit vector). The integrator is restarted at `corners`; the mounts' own kinks are left to
        its error control, with steps short enough to see every one of them.
        """
        y = np.concatenate([self.centre, [1.0, 0, 0, 0], np.zeros(6 + 3 * len(self.points))])
        out = np.empty((times.size, y.size))

        def right_hand_side(t, y):
            # The deck's acceleration does not occur: only its position and velocity reach the floor.
            position = sum(pulse.displacement(t) * unit for pulse, unit in pulses)
            velocity = sum(pulse.velocity(t) * unit for pulse, unit in pulses)
            return self.rates(y, position, velocity)

        for begin, end in zip(corners, corners[1:], strict=False):
            inner = (times >= begin - 1e-12) & (times <= end + 1e-12)
            # No kink of 24 axes is stepped over unseen: halving step and tolerance changes the result by less than 1e-6.
            run = solve_ivp(
                right_hand_side,
                (begin, end),
                y,
                method="DOP853",
                rtol=1e-9,
                atol=1e-11,
                max_step=5e-4,
                dense_output=True,
            )
            assert run.success, run.message
            out[inner] = run.sol(np.clip(times[inner], begin, end)).T
            y = run.y[:, -1]
        return out


def matrix(q):
    """Return the rotation matrix of a unit quaternion, w first, by Rodrigues' formula."""
    u = q[1:]
    cross = np.array([[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]])
    return np.eye(3) + 2.0 * q[0] * cross + 2.0 * cross @ cross


def damped_step(*, k, c, mass, velocity, time):
    """Return deflection and rate of a mass on k, c after the base starts at `velocity`: x(0) = 0, v(0) = -velocity."""
    omega, zeta = np.sqrt(k / mass), c / (2.0 * np.sqrt(k * mass))
    damped = omega * np.sqrt(1.0 - zeta**2)
    decay = np.exp(-zeta * omega * time)
    x = -velocity / damped * decay * np.sin(damped * time)
    v = -velocity * decay * (np.cos(damped * time) - zeta * omega / damped * np.sin(damped * time))
    return x, v
