"""Rope loops for tests: the textbook ring, the elastica beside a vendor's parts, and how far a coupling energy is from it."""

from functools import cache
from typing import NamedTuple

import numpy as np

from wirerope_mj.mounts.estimate.trends import VendorLoop, vendor_loops
from wirerope_mj.mounts.rope_loop import LoopShape, RopeLoop
from wirerope_mj.mounts.rope_loop.elastica import ELEMENTS, coupling_forces


def ring(radius):
    """Return the half of a circular ring [m] that is clamped in two points."""
    return LoopShape(segments=((np.pi * radius, 1.0 / radius),))


class Secants(NamedTuple):
    """Force over deflection of a loop of EI = 1 N m^2 from the unloaded position [N/m]; at 45 degrees along that line."""

    compression: float
    roll: float
    diagonal: float


def loop_secants(shape, values):
    """Return the secants of one loop at the travels that a vendor states."""
    down, across, slanted = (values[f"{mode} travel"] for mode in ("compression", "shear", "45"))
    share = slanted / np.sqrt(2.0)
    state = RopeLoop(shape).state([0.0, across, share], [-down, 0.0, -share])
    diagonal = (state.roll_force[2] - state.axial_force[2]) / np.sqrt(2.0)
    return Secants(-state.axial_force[0] / down, state.roll_force[1] / across, diagonal / slanted)


class LoopCheck(NamedTuple):
    """One part of the vendor beside the elastica with EI of its compression; errors are prediction over catalogue - 1."""

    part: VendorLoop
    roll_error: float  # of the shock stiffness in roll, which the catalogue has in one table with shear
    diagonal_error: float


@cache
def checked_loops():
    """Return all 50 parts beside the elastica; nothing is fitted but one EI for each, to its compression."""
    checks = []
    for part in vendor_loops():
        secants, scale = loop_secants(part.shape, part.values), part.bending_stiffness * part.loops
        errors = scale * secants.roll / part.values["shear shock"], scale * secants.diagonal / part.values["45 shock"]
        checks.append(LoopCheck(part, *(error - 1.0 for error in errors)))
    return checks


def coupling_error(coupling, shape, size):
    """Return the largest error of a coupling force over the box, over the largest one of loops of the EI `size` there.

    It is measured at 10 x 10 points between those of the fit, the edges of the box included.
    """
    between = np.linspace(0.0, 1.0, 10)
    axial = -coupling.compression + (coupling.compression + coupling.tension) * between
    points, exact = coupling_forces(RopeLoop(shape, ELEMENTS), coupling.roll * between, axial)
    miss = np.linalg.norm(coupling.force(points) - size * exact, axis=-1).max()
    return miss / np.linalg.norm(size * exact, axis=-1).max()
