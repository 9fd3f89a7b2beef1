"""Deflection and force at a turning point, from the samples before and after it.

A mean over samples on both sides of a turning point lies below it, that of a triangle by an eighth of the way that the samples
cover, and its energy with it. Here either side goes to the turning point by a parabola of its own, which fits a sine, a
triangle and a hold alike.
"""

import numpy as np

from wirerope_mj.foundation.arrays import Array

REACH = 0.03  # Fraction of a cycle on either side: a sine is a parabola there to 1e-4 of its amplitude
BINS = 3.0  # Bins on either side at least, so that three samples of it give a parabola


def reach_of(bins: int) -> float:
    """Return the fraction of a cycle beside a turning point that shows what happens there, for a number of bins in a cycle."""
    return max(REACH, BINS / bins)


def tip_of(distance: Array, deflection: Array, force: Array) -> tuple[float, float]:
    """Return deflection [m] and force [N] at a turning point.

    The deflection takes the same parabola over the phase to both sides; the force one parabola over the deflection before
    the turning point and another behind it, which meet there.

    Args:
        distance: in phase from the turning point, negative before it, (n,).
        deflection: of the samples [m], (n,).
        force: of the samples [N], (n,).
    """
    tip = _value([np.abs(distance), distance**2], deflection)
    before, after = (np.where(side, deflection - tip, 0.0) for side in (distance < 0.0, distance > 0.0))
    return tip, _value([before, before**2, after, after**2], force)


def _value(terms: list[Array], values: Array) -> float:
    """Return the constant beside terms that vanish at the turning point, by least squares."""
    mean = float(values.mean())
    matrix = np.stack([np.ones(values.size), *terms], axis=1)
    sizes = np.maximum(np.abs(matrix).max(axis=0), 1e-300)
    return mean + float(np.linalg.lstsq(matrix / sizes, values - mean, rcond=None)[0][0])
