"""A mass on one mount that is shaken by sines, and the closed form of its response."""

import numpy as np
from house import hysteresis, sdof

import wirerope_mj as wr

MASS, RESONANCE, DAMPING = 3.5, 10.0, 0.25
LEVEL = 2.0
MOUNT = {"payload": "mass", "response_direction": "z"}


def linear(resonance=RESONANCE, damping=DAMPING):
    omega = 2 * np.pi * resonance
    return wr.KelvinVoigt(k=MASS * omega**2, c=2 * damping * omega * MASS)


def transmitted(frequency, resonance=RESONANCE, damping=DAMPING):
    """Absolute transmissibility of a mass on a spring and a damper in parallel."""
    r = np.asarray(frequency) / resonance
    return np.sqrt((1 + (2 * damping * r) ** 2) / ((1 - r**2) ** 2 + (2 * damping * r) ** 2))


def hysteretic(*, gravity=0.0):
    return sdof(wr.BoucWen(**hysteresis(alpha=6e4, z_max=40.0), k=2e4), mass=MASS, gravity=gravity)


def up(rate, start=5.0, stop=20.0, **level):
    return wr.Sweep(start=start, stop=stop, rate=rate, direction="z", **(level or {"acceleration": LEVEL}))
