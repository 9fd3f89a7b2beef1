"""Deflections at which a law's force falls while the deflection grows: beyond them an isolator pushes its load away."""

import math

import numpy as np

from wirerope_mj.mounts.laws import Law

STEPS = 400  # Steps of a stroke, and of the step in which its force begins to fall
# Of the stiffness of the unloaded device: a slope below zero by less is that of a force which has saturated.
_ROUNDING = 1e-9


def falling_from(law: Law, lowest: float, highest: float) -> dict[float, float]:
    """Return the deflection from which on the force falls on further loading, by side (-1.0, 1.0) [m].

    Each side is run through from the unloaded device, as a shock does. A law that depends on the rate, and one that cannot go
    there, are left out, as are sides on which the force grows all the way.

    Args:
        law: of one axis.
        lowest: end of the stroke below zero [m], <= 0.
        highest: end of the stroke above zero [m], >= 0.
    """
    found: dict[float, float] = {}
    if not law.rate_independent:
        return found
    for side, end, most in zip((-1.0, 1.0), (-lowest, highest), law.travel_ends, strict=True):
        reach = min(end, 0.999 * most)
        if 0.0 < reach < math.inf and (coarse := _fall(law, side, 0.0, reach)):
            # A chord falls from up to a step before the top of the force on.
            found[side] = side * (_fall(law, side, max(coarse - 2.0 * reach / STEPS, 0.0), coarse) or coarse)
    return found


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
    """Return from which deflections on the tangent stiffness is negative, as text; "" where it is not."""
    places = [
        f"{'below' if x < 0.0 else 'above'} {1e3 * x:.3g} mm" for x in falling_from(law, lowest, highest).values()
    ]
    return f"the tangent stiffness is negative {' and '.join(places)}" if places else ""
