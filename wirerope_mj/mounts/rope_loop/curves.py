"""Elastic force of a rope loop along each of its axes, in the terms of Ni's laws."""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.rope_loop.coupling_energy import ELEMENTS
from wirerope_mj.mounts.rope_loop.elastica import RopeLoop
from wirerope_mj.mounts.rope_loop.shape import LoopShape, loop_shape

# Tension up to which the curves are followed, as a fraction of the rated compression: beyond, some loops come near to taut.
TENSION = 0.5


@dataclass(frozen=True, kw_only=True)
class AxisCurves:
    """Shape of a loop's elastic force along one axis while the other one rests; the stiffness k is left open.

        axial  F = k exp(asymmetry x) (x + axial_cubic x^3),  x positive in tension
        roll   F = k (x + roll_cubic x^3)

    Attributes:
        asymmetry: exponent lambda = c ln b of Ni's F2 [1/m].
        axial_cubic: k3 / k1 of the axial law [1/m^2].
        roll_cubic: k3 / k1 of the roll law [1/m^2].
        asymmetry_deviation: standard deviation of the asymmetry [1/m]: half of what it changes if the bars hold the rope on
            their whole thickness instead of in their middle, which no vendor states.
        misfit: largest relative difference of the axial secants from the loop's own [-].
        axial_stiffness, roll_stiffness: of one loop of EI = 1 N m^2 at rest [N/m].
    """

    asymmetry: float
    axial_cubic: float
    roll_cubic: float
    asymmetry_deviation: float
    misfit: float
    axial_stiffness: float
    roll_stiffness: float


def axis_curves(
    *, height: float, width: float, bar: float, rope: float, compression: float, roll: float | None
) -> AxisCurves:
    """Return the curves of an isolator's loop from its envelope.

    Args:
        height: unloaded, over both bars [m].
        width: over the ropes [m].
        bar: thickness of one bar [m].
        rope: diameter [m].
        compression: rated travel [m], as far as the axial curve is followed; in tension to `TENSION` of it.
        roll: rated travel [m]; None where it is not known: as far as the compression.

    Raises:
        ValueError: no loop has these measures, or its rope is taut within the travel.
    """
    shape = loop_shape(height=height, width=width, bar=bar, rope=rope)
    loop = RopeLoop(shape, ELEMENTS)
    asymmetry, cubic, misfit = _axial(loop, compression)
    stiffness = loop.stiffness()
    clamped = _axial(RopeLoop(_held(shape, 0.5 * bar), ELEMENTS), compression)[0]
    return AxisCurves(
        asymmetry=asymmetry,
        axial_cubic=cubic,
        roll_cubic=_roll(loop, compression if roll is None else roll),
        asymmetry_deviation=0.5 * abs(clamped - asymmetry),
        misfit=misfit,
        axial_stiffness=float(stiffness[1, 1]),
        roll_stiffness=float(stiffness[0, 0]),
    )


def _axial(loop: RopeLoop, compression: float) -> tuple[float, float, float]:
    """Return asymmetry, cubic term and largest relative misfit of the secants."""
    x = np.concatenate([np.linspace(-1.0, -0.1, 10), np.linspace(0.1, TENSION, 5)])  # over the rated compression
    secant = loop.state(0.0, x * compression).axial_force / (x * compression)
    secant /= loop.stiffness()[1, 1]

    def misses(parameters: Array) -> Array:
        return np.exp(parameters[0] * x) * (1.0 + parameters[1] * x**2) / secant - 1.0

    fit = scipy.optimize.least_squares(misses, [0.3, 0.1])
    exponent, cubic = fit.x.tolist()
    return exponent / compression, cubic / compression**2, float(np.abs(fit.fun).max())


def _roll(loop: RopeLoop, travel: float) -> float:
    """Return the cubic term of roll, by least squares of the secants."""
    x = np.linspace(0.1, 1.0, 10) * travel
    growth = loop.state(x, 0.0).roll_force / x / loop.stiffness()[0, 0] - 1.0
    return float(growth @ x**2 / (x**2 @ x**2))


def _held(shape: LoopShape, length: float) -> LoopShape:
    """Return the shape whose level segments at both bars are shorter by a length [m], as far as there is a level segment."""
    segments = list(shape.segments)
    for end in (0, -1):
        whole, bend = segments[end]
        if bend == 0.0:
            segments[end] = (max(whole - length, 0.05 * whole), bend)
    return replace(shape, segments=tuple(segments))
