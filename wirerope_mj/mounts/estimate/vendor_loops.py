"""The parts of Enidine's table that state their loops and all three loading modes, each beside the elastica of its loop."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from wirerope_mj.mounts.rope_loop import LoopShape, RopeLoop, loop_shape
from wirerope_mj.mounts.vendor_parts.parts import MODES, SERIES, Series, VendorPart, vendor_parts

ENIDINE: Series = next(series for series in SERIES if series.file == "enidine_wr.csv")


@dataclass(frozen=True, kw_only=True)
class VendorLoop:
    """One isolator of the table, SI units."""

    name: str
    rope: float  # diameter [m]
    loops: int  # their number
    # of the unloaded isolator [m]
    width: float
    height: float
    bar: float  # thickness of one bar [m]
    # largest static load [N], largest deflection [m], stiffness of small vibration and mean stiffness over the travel [N/m],
    # by mode: compression, 45, and shear, which stands for roll as well
    static_load: Mapping[str, float]
    travel: Mapping[str, float]
    vibration: Mapping[str, float]
    shock: Mapping[str, float]

    @property
    def shape(self) -> LoopShape:
        """The half loop of its envelope."""
        return loop_shape(height=self.height, width=self.width, bar=self.bar, rope=self.rope)


@cache
def vendor_loops() -> tuple[VendorLoop, ...]:
    """Return the 50 parts that state geometry and all three modes, in their order.

    Raises:
        ModelError: the table cannot be read.
    """
    loops = (_loop(part) for part in vendor_parts() if part.series is ENIDINE)
    return tuple(loop for loop in loops if loop is not None)


def _loop(part: VendorPart) -> VendorLoop | None:
    """Return a part's loops, None where the table leaves something out."""
    rope, loops, width, height, bar = part.rope, part.loops, part.width, part.height, part.bar
    if rope is None or loops is None or width is None or height is None or bar is None:
        return None

    names = ("static_load", "travel", "vibration", "shock")
    values = {name: {mode: getattr(part.modes[mode], name) for mode in MODES} for name in names}
    if any(value is None for by_mode in values.values() for value in by_mode.values()):
        return None
    return VendorLoop(name=part.name, rope=rope, loops=loops, width=width, height=height, bar=bar, **values)


@dataclass(frozen=True, kw_only=True)
class Secants:
    """Force over deflection of a loop at three deflections from the unloaded position [N/m]."""

    compression: float  # straight down
    roll: float  # straight across the bars
    diagonal: float  # straight at 45 degrees between both; the force is the component along that line


@dataclass(frozen=True, kw_only=True)
class LoopCheck:
    """One isolator of a vendor beside the elastica; errors are prediction over catalogue - 1."""

    part: VendorLoop  # row of the table
    bending_stiffness: float  # EI of the rope [N m^2] that gives the catalogue's shock stiffness in compression
    roll_error: float  # of the shock stiffness in roll, which the catalogue has in one table with shear
    diagonal_error: float  # of the shock stiffness at 45 degrees


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


def _check(part: VendorLoop) -> LoopCheck:
    """Return one row beside the elastica."""
    travel = part.travel
    secants = loop_secants(part.shape, compression=travel["compression"], roll=travel["shear"], diagonal=travel["45"])
    stiffness = part.shock["compression"] / (part.loops * secants.compression)
    scale = stiffness * part.loops
    return LoopCheck(
        part=part, bending_stiffness=stiffness, roll_error=scale * secants.roll / part.shock["shear"] - 1.0,
        diagonal_error=scale * secants.diagonal / part.shock["45"] - 1.0,
    )  # fmt: skip
