"""The vendor's loops by the elastica: the rope's bending stiffness from one value, and two others predicted."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from wirerope_mj.mounts.estimate.vendor_loops import VendorLoop, vendor_loops
from wirerope_mj.mounts.rope_loop import LoopShape, RopeLoop


@dataclass(frozen=True, kw_only=True)
class Secants:
    """Force over deflection of a loop at three deflections from the unloaded position [N/m].

    Attributes:
        compression: straight down.
        roll: straight across the bars.
        diagonal: straight at 45 degrees between both; the force is the component along that line.
    """

    compression: float
    roll: float
    diagonal: float


@dataclass(frozen=True, kw_only=True)
class LoopCheck:
    """One isolator of a vendor beside the elastica; errors are prediction over catalogue - 1.

    Attributes:
        part: row of the table.
        bending_stiffness: EI of the rope [N m^2] that gives the catalogue's shock stiffness in compression.
        roll_error: of the shock stiffness in roll, which the catalogue has in one table with shear.
        diagonal_error: of the shock stiffness at 45 degrees.
    """

    part: VendorLoop
    bending_stiffness: float
    roll_error: float
    diagonal_error: float


def loop_secants(shape: LoopShape, *, compression: float, roll: float, diagonal: float) -> Secants:
    """Return the secants of one loop of EI = 1 N m^2 at three travels [m], each > 0."""
    across = diagonal / np.sqrt(2.0)
    state = RopeLoop(shape).state([0.0, roll, across], [-compression, 0.0, -across])
    return Secants(
        compression=float(-state.axial_force[0] / compression),
        roll=float(state.roll_force[1] / roll),
        diagonal=float((state.roll_force[2] - state.axial_force[2]) / np.sqrt(2.0) / diagonal),
    )


@cache
def check_vendor_loops() -> tuple[LoopCheck, ...]:
    """Return all 50 rows beside the elastica; nothing is fitted but one EI for each row, to its compression."""
    return tuple(_check(part) for part in vendor_loops())


@cache
def coupled_diagonal_errors() -> tuple[tuple[float, float, float], ...]:
    """Return the errors at 45 degrees of axes that are those of the catalogue, coupled by the elastica, for each row.

    The force along 45 degrees is that of the catalogue's shock stiffness in compression and in roll, each over its component of
    the travel, and that of U(u, w) - U(u, 0) - U(0, w). Three errors: without it; with it scaled by the EI of compression; and
    by the geometric mean of the EI of compression and of roll.
    """
    return tuple(_coupled(check) for check in check_vendor_loops())


def _coupled(check: LoopCheck) -> tuple[float, float, float]:
    """Return the errors of one row."""
    part = check.part
    x = part.travel["45"] / np.sqrt(2.0)
    state = RopeLoop(part.shape).state([x, x, 0.0], [-x, 0.0, -x])
    across = state.roll_force[0] - state.roll_force[1]
    down = state.axial_force[2] - state.axial_force[0]
    coupling = float(part.loops * (across + down) / np.sqrt(2.0) / part.travel["45"])
    uncoupled = 0.5 * (part.shock["compression"] + part.shock["shear"])
    from_roll = check.bending_stiffness / (1.0 + check.roll_error)
    scales = (0.0, check.bending_stiffness, np.sqrt(check.bending_stiffness * from_roll))
    errors = [float((uncoupled + scale * coupling) / part.shock["45"] - 1.0) for scale in scales]
    return errors[0], errors[1], errors[2]


def _check(part: VendorLoop) -> LoopCheck:
    """Return one row beside the elastica."""
    travel = part.travel
    secants = loop_secants(part.shape, compression=travel["compression"], roll=travel["shear"], diagonal=travel["45"])
    stiffness = part.shock["compression"] / (part.loops * secants.compression)
    scale = stiffness * part.loops
    return LoopCheck(
        part=part,
        bending_stiffness=stiffness,
        roll_error=scale * secants.roll / part.shock["shear"] - 1.0,
        diagonal_error=scale * secants.diagonal / part.shock["45"] - 1.0,
    )
