"""Question (c): stability of periodic motions by differences of a stepped map, by ours, and by waiting."""

from functools import cache

import numba
import numpy as np
import numpy.typing as npt
from figures.drawing import COLOURS, GUIDE, canvas, explain, inscribe
from figures.oscillator import oscillator
from matplotlib.figure import Figure as Picture
from scipy.integrate import solve_ivp

import wirerope_mj as wr

Array = npt.NDArray[np.float64]
MASS, LEVEL = 3.5, 5.0  # [kg], [m/s^2]
RANGE = (25.0, 45.0)  # [Hz]
EXPONENTS = (0.2, 0.3, 0.5, 1.0, 2.0)
TOLERANCES = (1e-3, 1e-6, 1e-9)
"""Of an adaptive integrator, relative; 1e-3 is the default of the usual programs."""
OFFSET = 1e-5
"""Of the differences of its map, relative to the motion's ranges."""
TRIED = 12
"""Motions of each branch, equally many points apart."""
WIDTH, SMOOTH_TOLERANCE, SETTLED = 0.1, 1e-6, 20
"""Of the smooth law over the motion's largest velocity, the tolerance that it is tried with, and periods that it settles."""
STEPS, WAITED, KICK = 256, 200, 1e-3
"""Of the judge: steps in a period, periods, and the disturbance relative to the ranges."""


def law(n: float) -> wr.BoucWen:
    """Return the softening law of 3.5 kg at about 40 Hz."""
    return wr.BoucWen.from_normalised(z_max=60.0, x_y=6e-4, sigma=0.7, n=n, k=1e5)


@numba.njit
def slopes(p, push, d, v, z):  # type: ignore[no-untyped-def]
    """Return the rates of velocity and z; p = alpha, beta, gamma, n, k, and the width of tanh for the sign of v, 0 for none."""
    sign = np.sign(v) if p[5] == 0.0 else np.tanh(v / p[5])
    rate = (p[0] - (p[2] + p[1] * sign * np.sign(z)) * abs(z) ** p[3]) * v
    return -(p[4] * d + z) / MASS - push, rate


@numba.njit
def period(p, omega, y, steps):  # type: ignore[no-untyped-def]
    """Return deflection, velocity and z after a period in `steps` steps of Runge and Kutta's method, and their ranges."""
    h = 2.0 * np.pi / omega / steps
    d, v, z = y
    low, high = y.copy(), y.copy()
    for i in range(steps):
        one, two, three = (
            LEVEL * np.sin(omega * h * i),
            LEVEL * np.sin(omega * h * (i + 0.5)),
            LEVEL * np.sin(omega * h * (i + 1)),
        )
        a0, r0 = slopes(p, one, d, v, z)
        v1 = v + 0.5 * h * a0
        a1, r1 = slopes(p, two, d + 0.5 * h * v, v1, z + 0.5 * h * r0)
        v2 = v + 0.5 * h * a1
        a2, r2 = slopes(p, two, d + 0.5 * h * v1, v2, z + 0.5 * h * r1)
        v3 = v + h * a2
        a3, r3 = slopes(p, three, d + h * v2, v3, z + h * r2)
        d += h / 6.0 * (v + 2.0 * v1 + 2.0 * v2 + v3)
        v += h / 6.0 * (a0 + 2.0 * a1 + 2.0 * a2 + a3)
        z += h / 6.0 * (r0 + 2.0 * r1 + 2.0 * r2 + r3)
        for place, value in enumerate((d, v, z)):
            low[place], high[place] = min(low[place], value), max(high[place], value)
    return np.array([d, v, z]), high - low


@numba.njit
def waited(p, omega, y):  # type: ignore[no-untyped-def]
    """Return how a disturbance of a motion has changed after a wait, relative to what it was."""
    for _ in range(WAITED):
        y, ranges = period(p, omega, y, STEPS)
    other = y + KICK * ranges
    for _ in range(WAITED):
        y = period(p, omega, y, STEPS)[0]
        other = period(p, omega, other, STEPS)[0]
    return np.abs((other - y) / ranges).max() / KICK


def by_differences(p: Array, omega: float, y: Array, ranges: Array, tolerance: float, settled: int = 0) -> float:
    """Return the largest multiplier by differences of the map that an adaptive integrator makes, after some periods."""

    def rates(t: float, state: Array) -> Array:
        acceleration, rate = slopes(p, LEVEL * np.sin(omega * t), *state)
        return np.array([state[1], acceleration, rate])

    def after(start: Array) -> Array:
        end = solve_ivp(rates, (0.0, 2.0 * np.pi / omega), start, "RK45", rtol=tolerance, atol=1e-3 * tolerance * ranges)
        return np.asarray(end.y[:, -1])

    for _ in range(settled):
        y = after(y)
    there = after(y)
    columns = [(after(y + OFFSET * ranges * unit) - there) / ranges / OFFSET for unit in np.eye(3)]
    return float(np.abs(np.linalg.eigvals(np.stack(columns, axis=1))).max())


@cache
def ours(n: float) -> wr.Branch:
    """Return the branch of periodic motions with its multipliers."""
    system = oscillator(law(n), mass=MASS)
    return wr.follow_branch(
        system, start=RANGE[0], stop=RANGE[1], acceleration=LEVEL, direction="z", payload="mass", accuracy=1e-3,
        tolerance=1e-4,
    )  # fmt: skip


@cache
def tried(n: float) -> tuple[Array, Array, Array]:
    """Return frequencies, what a disturbance became, and largest multipliers: at each tolerance, and of the smooth law.

    The multipliers, which stand between the two, are (n_f, n_tolerances + 1).
    """
    one, found = law(n), ours(n)
    p = np.array([one.alpha, one.beta, one.gamma, one.n, one.k, 0.0])
    frequencies, multipliers, left = [], [], []
    for index in np.linspace(0, found.frequency.size - 1, TRIED).astype(int):
        run = found.orbit(int(index)).response
        mount, mass = run.mounts["m1"], run.bodies["mass"]
        path = np.stack([mount.deflection[:, 2], mass.velocity[:, 2] - run.base.velocity[:, 2], mount.hysteretic_state[:, 2]])
        omega, y = 2.0 * np.pi * found.frequency[index], path[:, 0].copy()
        ranges, smooth = np.ptp(path, axis=1), p.copy()
        smooth[5] = WIDTH * np.abs(path[1]).max()
        frequencies.append(found.frequency[index])
        multipliers.append([by_differences(p, omega, y, ranges, tolerance) for tolerance in TOLERANCES])
        multipliers[-1].append(by_differences(smooth, omega, y, ranges, SMOOTH_TOLERANCE, SETTLED))
        left.append(waited(p, omega, y))
    return np.array(frequencies), np.array(multipliers), np.array(left)


def numbers() -> dict[str, float]:
    """Return how many motions each way calls unstable, and how many waiting does."""
    found: dict[str, float] = {"tried": float(TRIED)}
    for place, n in enumerate(EXPONENTS, 1):
        frequencies, multipliers, left = tried(n)
        same = np.isin(ours(n).frequency, frequencies)
        found |= {f"motions_{place}": float(same.size), f"ours_{place}": float(np.sum(~ours(n).stable))}
        for column in range(len(TOLERANCES)):
            found[f"naive_{place}_{column + 1}"] = float(np.sum(multipliers[:, column] > 1.0))
        found[f"smooth_{place}"] = float(np.sum(multipliers[:, -1] > 1.0))
        found[f"waited_{place}"] = float(np.sum(left > 1.0))
        found[f"left_{place}"] = float(left.max())
    found["smooth"] = sum(found[f"smooth_{place}"] for place in range(1, len(EXPONENTS) + 1))
    found["naive"] = sum(found[f"naive_{place}_2"] for place in range(1, len(EXPONENTS) + 1))
    return found


def draw() -> Picture:
    """Draw the largest multipliers of both ways for n = 0.3."""
    picture, (panel,) = canvas(1, height=3.6)
    for line in panel.lines[:2]:
        line.remove()
    frequencies, multipliers, _ = tried(0.3)
    for column, (tolerance, colour) in enumerate(zip(TOLERANCES, COLOURS[1:], strict=False)):
        panel.plot(frequencies, multipliers[:, column], "o", ms=4, color=colour, label=f"differences, tolerance {tolerance:g}")
    largest = np.abs(ours(0.3).floquet_multipliers).max(axis=1)
    panel.plot(ours(0.3).frequency, largest, color=COLOURS[0], lw=2.0, label="ours")
    panel.axhline(1.0, color=GUIDE, lw=1.0, ls="--")
    panel.set_yscale("log")
    panel.set_xlim(RANGE[0] - 0.5, RANGE[1] + 0.5)
    inscribe(panel, "n = 0.3", "frequency [Hz]", "largest multiplier [-]")
    explain(panel, place="below", columns=4)
    return picture
