"""Devices of other kinds than the laws of the package, for records that no law of it follows exactly."""

import numpy as np


def iwan(x, *, sliders=40, stiffness=6e4, friction=700.0, spread=(0.02e-3, 8e-3), elastic=2e4):
    """Return the force of many Jenkin elements in parallel, their slips spaced by a constant ratio, and a spring."""
    slip = np.geomspace(*spread, sliders)
    each = np.full(sliders, friction / sliders) / slip + stiffness / sliders * 0.0
    return elastic * x + played(x, slip) @ each


def few_sliders(x):
    """Return the force of five Jenkin elements, whose corners a record shows one by one, and a spring."""
    slip = np.array([0.1e-3, 0.4e-3, 1.1e-3, 2.7e-3, 6.1e-3])
    return 2.5e4 * x + played(x, slip) @ np.array([4e5, 2e5, 1e5, 6e4, 4e4])


def dead_zone(x):
    """Return the force of Prandtl and Ishlinskii's elements behind dead zones: it hardens where they close."""
    gaps = np.array([1.2e-3, 2.9e-3, 5.3e-3])
    behind = np.maximum(np.abs(x)[:, np.newaxis] - gaps, 0.0) * np.sign(x)[:, np.newaxis]
    return iwan(x, sliders=20) + behind @ np.array([1e4, 2e4, 4e4])


def played(x, slip):
    """Return the deflections of Jenkin elements' springs (n_t, n) that slip at `slip` [m], from the unloaded device."""
    held = np.zeros((x.size, slip.size))
    for row in range(1, x.size):
        held[row] = np.clip(held[row - 1] + x[row] - x[row - 1], -slip, slip)
    return held


def lugre(x, *, time, stribeck=0.15, viscous=0.0):
    """Return the force of Canudas de Wit's bristles, whose friction falls by a fraction with the rate, and a spring."""
    z, forces = 0.0, np.zeros(x.size)
    for row in range(1, x.size):
        step = x[row] - x[row - 1]
        rate = abs(step) / (time[row] - time[row - 1])
        bound = 6e-4 * (1.0 + stribeck * np.exp(-((rate / 5e-3) ** 2)))
        # Along one step the equation dz/dx = 1 - sign z / bound is linear.
        limit = bound * np.sign(step)
        z = limit + (z - limit) * np.exp(-abs(step) / bound) if step else z
        forces[row] = 1e6 * z + 4e4 * x[row] + viscous * step / (time[row] - time[row - 1])
    return forces
