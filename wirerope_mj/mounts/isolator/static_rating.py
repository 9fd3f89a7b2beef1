"""Static load of a mount against its rating, which holds for a mount that stands."""

import math
from collections.abc import Sequence

from wirerope_mj.foundation.arrays import Array


def static_utilisation(force: Sequence[float] | Array, rated: float | None) -> float | None:
    """Return compression over rated static load; None where `static_load_unjudged` says why that is not judged."""
    if rated is None or static_load_unjudged(force, rated):
        return None
    return max(-float(force[2]), 0.0) / rated


def static_load_unjudged(force: Sequence[float] | Array, rated: float | None) -> str:
    """Return why a rated static load says nothing of the load of a mount, as text; empty where it judges it.

    The rating holds for compression: a mount that hangs, or carries more across its axis than along it, is not judged.

    Args:
        force: restoring force at rest, roll, shear, axial [N], (3,); axial negative in compression.
        rated: static load in compression [N]; None or NaN = not rated.
    """
    if rated is None or math.isnan(rated):
        return "no static load is rated"
    roll, shear, along = map(float, force)
    across = math.hypot(roll, shear)
    if across > abs(along):
        return "the load is across the axis, and the rating holds for compression"
    return "the mount hangs, and the rating holds for compression" if along > 0.0 else ""
