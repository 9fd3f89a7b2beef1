"""Closed forms of a circular ring that is clamped in two points opposite each other."""

import math
from dataclasses import dataclass

from wirerope_mj.foundation.arguments import positive


@dataclass(frozen=True, kw_only=True)
class RingStiffness:
    """Stiffness of small deflections [N/m], the ends not free to turn.

    Attributes:
        compression: along the axial axis.
        roll: across the bars, in the plane of the ring.
        shear: along the bars, out of that plane.
    """

    compression: float
    roll: float
    shear: float


def ring_stiffness(
    *, radius: float, bending_stiffness: float, torsional_stiffness: float, loops: float = 1.0
) -> RingStiffness:
    """Return the stiffness of clamped circular rings, from Castigliano's theorem (two half rings in parallel each).

        compression = 2 n EI / (R^3 (pi / 2 - 4 / pi)),   roll = 4 n EI / (pi R^3)
        shear = 2 n GJ / (R^3 [pi - (8 / pi) / (1 + mu)]),   mu = GJ / EI

    Shear is an indication only: GJ of a rope is not known, and the loops of an isolator lean along the bars.

    Args:
        radius: of the centre line [m].
        bending_stiffness: EI [N m^2].
        torsional_stiffness: GJ [N m^2].
        loops: their number.

    Raises:
        ValueError: an argument is not a finite number > 0.
    """
    given = {"radius": radius, "bending_stiffness": bending_stiffness, "torsional_stiffness": torsional_stiffness}
    for name, value in (given | {"loops": loops}).items():
        positive(name, value)
    unit = 2.0 * loops / radius**3
    mu = torsional_stiffness / bending_stiffness
    return RingStiffness(
        compression=unit * bending_stiffness / (math.pi / 2.0 - 4.0 / math.pi),
        roll=unit * bending_stiffness / (math.pi / 2.0),
        shear=unit * torsional_stiffness / (math.pi - 8.0 / math.pi / (1.0 + mu)),
    )
