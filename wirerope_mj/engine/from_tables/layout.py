"""What the tables of a model say, in SI."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wirerope_mj.engine.from_tables.mass_properties import MassProperties, combined
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.vendor_parts import VendorPart


@dataclass(frozen=True, eq=False)
class Mass:
    """A row of the table of masses."""

    name: str
    properties: MassProperties


@dataclass(frozen=True)
class StopLaw:
    """A bump stop as a row of the table of stops states it: gap, rounding [m], stiffness [N/m], damping [N s/m]."""

    gap: float
    stiffness: float
    damping: float
    rounding: float


@dataclass(frozen=True, eq=False)
class Placed:
    """A mount or a stop: name, position of its mid-height (3,) [m], axes, and the isolator's name.

    Attributes:
        axes: roll, shear and axial as rows (3, 3), unit vectors; axial points from the base's side to the payload's.
        location: file and row that say so, for messages.
        law: of a stop with figures of its own; else the isolator's file says it.
    """

    name: str
    position: Array
    axes: Array
    isolator: str
    location: str
    law: StopLaw | None = None


@dataclass(frozen=True, eq=False)
class Point:
    """A point of the payload that is observed: name and position (3,) [m]."""

    name: str
    position: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Layout:
    """A payload on mounts as tables say it.

    Attributes:
        name: of the model and of the payload.
        forces: points at which forces may act on the payload.
        isolators: files, or parts of the vendors' tables, that mounts and stops name, by name.
    """

    name: str
    masses: tuple[Mass, ...]
    mounts: tuple[Placed, ...]
    stops: tuple[Placed, ...] = ()
    points: tuple[Point, ...] = ()
    forces: tuple[Point, ...] = ()
    isolators: Mapping[str, Path | VendorPart] = field(default_factory=dict)

    @property
    def payload(self) -> MassProperties:
        """Mass properties of all masses together."""
        return combined([mass.properties for mass in self.masses])


def axes_along(axial: Array, bars: Array | None = None) -> Array:
    """Return roll, shear and axial as rows (3, 3): the bars' direction made square to axial, else horizontal.

    Without `bars` they run along x under an upright mount, and else horizontally, square to the direction.
    """
    axial = axial / np.linalg.norm(axial)
    if bars is None:
        horizontal = np.cross([0.0, 0.0, 1.0], axial)
        upright = np.linalg.norm(horizontal) < 1e-6  # less than what a table says of a direction
        bars = np.array([-np.sign(axial[2]), 0.0, 0.0]) if upright else horizontal
    shear = bars - (bars @ axial) * axial
    shear /= np.linalg.norm(shear)
    return np.array([np.cross(shear, axial), shear, axial])
