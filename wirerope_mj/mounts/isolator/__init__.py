"""The isolator: three restoring-force laws, what they are rated for, and where they come from."""

from wirerope_mj.mounts.isolator.device import BOTTOM, Isolator, bottom_in_place, bottom_stop, isolators_at
from wirerope_mj.mounts.isolator.parts import (
    Bracket,
    Geometry,
    Limits,
    MeasuredRange,
    Provenance,
    Rotation,
    Spread,
    Stiffening,
    Temperature,
    Travel,
    Validity,
)
from wirerope_mj.mounts.isolator.tables import AXES, read_law
from wirerope_mj.mounts.laws import LoopCoupling
