"""Travel and static load of a mount: how far and how much, its utilisation of the rating, and where the force falls."""

import math
from collections.abc import Container, Mapping, Sequence

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.mounts.laws.law import ROUNDING, Law


def static_utilisation(force: Sequence[float] | Array, rated: float | None) -> float | None:
    """Return compression over rated static load; None where `static_load_unjudged` says why that is not judged."""
    if rated is None or static_load_unjudged(force, rated):
        return None
    return max(-float(force[2]), 0.0) / rated


def static_load_unjudged(force: Sequence[float] | Array, rated: float | None) -> str:
    """Return the reason why a rated static load [N] does not judge the load of a mount, "" if it does.

    The rating holds for compression: a mount that hangs, or carries more across its axis than along it, is not judged.
    `force` is the restoring force at rest, roll, shear, axial [N], (3,), axial negative in compression; None or NaN: not
    rated.
    """
    if rated is None or math.isnan(rated):
        return "no static load is rated"
    roll, shear, along = map(float, force)
    across = math.hypot(roll, shear)
    if across > abs(along):
        return "the load is across the axis, and the rating holds for compression"
    return HANGS if along > 0.0 else ""


HANGS = "the mount hangs, and the rating holds for compression"


# Rated travels in the order of the tables: the mount's axis, and its sign along it; 0 = both.
RATINGS = {"compression": (2, -1.0), "tension": (2, 1.0), "shear": (1, 0.0), "roll": (0, 0.0)}
# Rated travels of each axis below and above zero.
SIDES = {"roll": ("roll", "roll"), "shear": ("shear", "shear"), "axial": ("compression", "tension")}


def travel_in(rating: str, deflection: Array) -> Array:
    """Measure how far deflections, (..., 3), go in a rated direction, as "tension" [m], (...); 0 in the opposite direction."""
    axis, sign = RATINGS[rating]
    along = deflection[..., axis]
    return np.asarray(np.abs(along) if sign == 0.0 else np.maximum(sign * along, 0.0) + 0.0)  # + 0.0: never -0.0


def travel_reached(lowest: Array, highest: Array) -> dict[str, Array]:
    """Return the largest travel in compression, tension, shear and roll [m], (...), between extreme deflections, (..., 3)."""
    low, high = np.minimum(lowest, highest), np.maximum(lowest, highest)
    both_ways = np.maximum(np.abs(low), np.abs(high))
    reached = {-1.0: np.maximum(-low, 0.0) + 0.0, 0.0: both_ways, 1.0: np.maximum(high, 0.0) + 0.0}  # never -0.0
    return {rating: np.asarray(reached[sign][..., axis]) for rating, (axis, sign) in RATINGS.items()}


def travel_utilisation(reached: Mapping[str, ArrayLike], rated: Mapping[str, float]) -> dict[str, float]:
    """Return travel over rated travel by rating; directions without a rating are left out."""
    return {rating: float(reached[rating]) / rated[rating] for rating in RATINGS if rating in rated}  # type: ignore[arg-type]


def one_way(reached: Mapping[str, ArrayLike], rated: Container[str]) -> str:
    """Find the unrated direction, compression or tension, if a mount moves in it alone and the other direction is rated.

    "" if there is none. A mount that hangs uses 0 % of its rated compression, which says nothing of it.
    """
    for way, other in (("tension", "compression"), ("compression", "tension")):
        if reached[way] > 0.0 == reached[other] and other in rated and way not in rated:  # type: ignore[operator]
            return way
    return ""


def largest_utilisation(reached: Array, rated: Array) -> Array:
    """Return the largest ratio of travels to rated travels [m], (..., 4) each in the order of RATINGS; NaN without a rating.

    Where a mount moves `one_way`, and farther so than in a rated way, that rating counts only if it is exceeded.
    """
    used, axial, stated = reached / rated, reached[..., :2], ~np.isnan(rated[..., :2])
    lone = (axial > 0.0) & (axial[..., ::-1] == 0.0) & ~stated & stated[..., ::-1]
    farther = reached <= np.where(lone, axial, -1.0).max(axis=-1, keepdims=True)
    return np.asarray(np.fmax.reduce(np.where(farther & (used <= 1.0), np.nan, used), axis=-1))


def beyond_law(axes: Mapping[str, Law | None], lowest: Array, highest: Array, *, fraction: float = 1.0) -> str:
    """Describe the first axis beyond a fraction of the deflection its law holds for, "" if there is none.

    Deflections [m] are (3,), at the lowest and at the highest.
    """
    for (axis, law), low, high in zip(axes.items(), lowest, highest, strict=True):
        for sign, reached, end in zip((-1.0, 1.0), (-low, high), law.travel_ends if law else (), strict=False):
            if law is not None and reached > fraction * end + ROUNDING:
                place = f"at {sign * reached:.4g} m on its {axis} axis"
                return f"{place}, whose law holds up to {end:.4g} m, where {law.travel_rule}"
    return ""


STEPS = 400  # Steps of a stroke, and of the step in which its force begins to fall
# Of the stiffness of the unloaded device: a slope below zero by less is that of a force which has saturated.
_ROUNDING = 1e-9


def falling_from(law: Law, lowest: float, highest: float) -> dict[float, float]:
    """Return the deflection from which on the force falls on further loading, by side (-1.0, 1.0) [m].

    Each side is run through from the unloaded device to the end of the stroke [m], as a shock does. A law that depends on the
    rate, and one that cannot go there, are left out, as are sides on which the force grows all the way.
    """
    velocities: dict[float, float] = {}
    if not law.rate_independent:
        return velocities
    for side, end, most in zip((-1.0, 1.0), (-lowest, highest), law.travel_ends, strict=True):
        reach = min(end, 0.999 * most)
        if 0.0 < reach < math.inf and (coarse := _fall(law, side, 0.0, reach)):
            # A chord falls from up to a step before the top of the force on.
            velocities[side] = side * (_fall(law, side, max(coarse - 2.0 * reach / STEPS, 0.0), coarse) or coarse)
    return velocities


def _fall(law: Law, side: float, begin: float, end: float) -> float:
    """Return the end of the first step between two deflections in which the force falls [m]; 0 if it grows all the way."""
    path = side * np.concatenate([[0.0], np.linspace(begin, end, STEPS + 1)])
    try:
        force = law.trace(path).force[1:]
    except ValueError:  # it leaves the finite numbers there
        return 0.0
    falls = side * np.diff(force) < -_ROUNDING * law.initial_stiffness * (end - begin) / STEPS
    return abs(float(path[int(np.argmax(falls)) + 2])) if falls.any() else 0.0


def falling_text(law: Law, lowest: float, highest: float) -> str:
    """Describe the deflections beyond which the tangent stiffness is negative, "" where it is not."""
    ends = falling_from(law, lowest, highest).values()
    places = [f"{'below' if x < 0.0 else 'above'} {1e3 * x:.3g} mm" for x in ends]
    return f"the tangent stiffness is negative {' and '.join(places)}" if places else ""
