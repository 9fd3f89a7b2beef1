"""The rope spring that stands in for the thesis' five: friction on three scales, an asymmetry, 50 kg. Our own numbers."""

import math
from functools import cache

import numpy as np

import wirerope_mj as wr
from wirerope_mj.mounts.test_rig import measured

MASS = 50.0
"""[kg]: what an MP14-345 is designed to carry."""
G = wr.STANDARD_GRAVITY
MM = 1e3
SCALES = ((600.0, 8e-3), (90.0, 1e-3), (12.0, 1e-4))
"""Bound [N] and yield deflection [m] of the friction on each scale."""
AMPLITUDES = (0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3, 15e-3)
NAMES = ("log1", "log2", "log3", "lab1", "lab2")
SPREAD = 0.05
"""Standard deviation of the five springs' forces, yield deflections and asymmetry: our assumption, the thesis' is lost."""


def spring(stiffness: float = 1.0, yielding: float = 1.0, asymmetry: float = 1.0) -> wr.Parallel:
    """Return the spring with factors on its forces, on its yield deflections and on its asymmetry."""
    laws = [
        wr.AsymmetricBoucWen.from_normalised(
            z_max=stiffness * bound, x_y=yielding * x_y, sigma=0.7, n=1.0, k1=stiffness * 3e4 * (first == 0), k2=0.0,
            k3=stiffness * 2e8 * (first == 0), b=math.e, c=asymmetry * 25.0,
        )
        for first, (bound, x_y) in enumerate(SCALES)
    ]  # fmt: skip
    return wr.Parallel(laws=laws)


@cache
def five() -> dict[str, wr.Parallel]:
    """Return five springs of one make, by the thesis' names for its own."""
    rng = np.random.default_rng(2004)
    return {name: spring(*(1.0 + SPREAD * rng.standard_normal(3))) for name in NAMES}


@cache
def record(law: wr.Parallel, operating_point: float = 0.0) -> tuple[wr.Loop, ...]:
    """Return closed cycles as a rig would measure them: 200 samples each, noise of 0.5 % of the smallest loop."""
    loops = wr.cyclic_test(law, AMPLITUDES, operating_point=operating_point)
    return tuple(measured(loops, seed=3, force_noise=0.005 * float(np.ptp(loops[0].force)) / 2.0))
