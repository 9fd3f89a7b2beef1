"""Mass properties of rigid parts, and of the body that they make together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arrays import Array

# by how much of the largest principal moment another may miss a bound: a plate lies on it, but for rounding
TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass [kg], centre of mass (3,) [m], and tensor of inertia (3, 3) about it, in the table's axes [kg m^2].

    Off-diagonal elements are those of the tensor: ixy = -sum of x y dm.
    """

    mass: float
    centre: Array
    inertia: Array


def combined(parts: Sequence[MassProperties]) -> MassProperties:
    """Return the mass properties of rigidly joined parts: sums, and the theorem of parallel axes (Huygens-Steiner)."""
    mass = sum(part.mass for part in parts)
    centre = sum((part.mass * part.centre for part in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        arm = part.centre - centre
        inertia += part.inertia + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return MassProperties(mass, centre, inertia)


def why_impossible(inertia: Array) -> str:
    """Return why no body has this tensor of inertia, "" if one has: moments < 0, or the largest above the sum of the others."""
    small, middle, large = np.linalg.eigvalsh(inertia)
    slack = TOLERANCE * max(abs(large), abs(small))
    values = f"its principal moments are {small:.4g}, {middle:.4g} and {large:.4g} kg m^2"
    if small < -slack:
        return f"{values}, and none can be negative"
    if large > small + middle + slack:
        return f"{values}, and none can be larger than the sum of the other two"
    return ""
