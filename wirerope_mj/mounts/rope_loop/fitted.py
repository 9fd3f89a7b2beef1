"""The rope loop in the terms of a mount's laws: curves of its axes, and the energy that couples roll and axial direction."""

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import LoopCoupling
from wirerope_mj.mounts.rope_loop.elastica import RopeLoop
from wirerope_mj.mounts.rope_loop.half_loop import LoopShape

# Numbers of powers (u^2, u^4, u^6 and w to w^6): the fewest that keep the largest error of a force below 2 % of the largest
# coupling force over the rated travels of all 50 parts of Enidine's table (1.8 %), with as much tension as compression where
# the rope is slack so far.
ROLL_TERMS, AXIAL_TERMS = 3, 6
# Distance of a half loop's ends over its rope up to which the polynomial is fitted: nearer to the taut rope the force grows
# without bound, which no polynomial follows and no inextensible model should be believed in.
SLACK_REACH = 0.85
# Of a half loop: their forces are within 1e-6 of those of four times as many, far below what the polynomial misses.
ELEMENTS = 9
_POINTS = 9


def fit_coupling(
    shape: LoopShape, *, bending_stiffness: float, loops: float, roll: float, compression: float, tension: float,
    terms: tuple[int, int] = (ROLL_TERMS, AXIAL_TERMS),
) -> LoopCoupling:  # fmt: skip
    """Fit the coupling energy U(u, w) - U(u, 0) - U(0, w) of an isolator's loops as I x J powers.

    The coefficients are a least-squares fit of the two coupling forces at 9 x 9 Chebyshev points of the box. The box ends at
    roll, compression and tension [m], where the rope of a half loop at full roll would be stretched to more than 85 % of its
    length (`SLACK_REACH`) before; `bending_stiffness` is EI [N m^2].

    Raises:
        ValueError: an argument is not a finite number > 0, or full roll leaves no tension.
        ConvergenceError: the elastica has no equilibrium in some corner.
    """
    values = {"bending_stiffness": bending_stiffness, "loops": loops, "roll": roll, "compression": compression}
    for name, value in (values | {"tension": tension}).items():
        positive(name, value)
    across, along = shape.span
    rest = (SLACK_REACH * shape.length) ** 2 - (abs(across) + roll) ** 2
    if rest <= along**2:
        raise ValueError(
            f"`roll` of {roll:.6g} m stretches the rope of a half loop to more than {100.0 * SLACK_REACH:g} % of its length; "
            "its coupling is not fitted so far."
        )
    tension = min(tension, math.sqrt(rest) - along)
    loop, scale = RopeLoop(shape, ELEMENTS), bending_stiffness * loops

    def polynomial(coefficients: npt.NDArray[np.floating]) -> LoopCoupling:
        return LoopCoupling(roll=roll, compression=compression, tension=tension, coefficients=coefficients.tolist())

    knots = 0.5 * (1.0 - np.cos(np.pi * (np.arange(_POINTS) + 0.5) / _POINTS))
    points, target = coupling_forces(loop, roll * knots, -compression + (compression + tension) * knots)
    units = np.eye(terms[0] * terms[1]).reshape(-1, *terms)
    columns = np.stack([polynomial(unit).force(points).ravel() for unit in units], axis=1)
    solution = np.linalg.lstsq(columns, target.ravel(), rcond=None)[0].reshape(terms)
    return polynomial(scale * solution)


def coupling_forces(loop: RopeLoop, roll: Array, axial: Array) -> tuple[Array, Array]:
    """List all pairs (u, w) [m], (n, 2), and for EI = 1 N m^2 the forces there beyond those of (u, 0) and (0, w), (n, 2)."""
    u, w = (axis.ravel() for axis in np.meshgrid(roll, axial, indexing="ij"))
    state = loop.state(u, w)
    across = state.roll_force - np.repeat(loop.state(roll, 0.0).roll_force, len(axial))
    along = state.axial_force - np.tile(loop.state(0.0, axial).axial_force, len(roll))
    return np.stack([u, w], axis=-1), np.stack([across, along], axis=-1)


# Tension up to which the curves are followed, as a fraction of the rated compression: beyond, some loops come near to taut.
TENSION = 0.5


@dataclass(frozen=True, kw_only=True)
class AxisCurves:
    """Shape of a loop's elastic force along one axis while the other one rests; the stiffness k is left open.

        axial  F = k exp(asymmetry x) (x + axial_cubic x^3)
        roll   F = k (x + roll_cubic x^3)

    x is positive in tension.
    """

    asymmetry: float  # exponent lambda = c ln b of Ni's F2 [1/m]
    axial_cubic: float  # k3 / k1 of the axial law [1/m^2]
    roll_cubic: float  # k3 / k1 of the roll law [1/m^2]
    # standard deviation of the asymmetry [1/m]: half of what it changes if the bars hold the rope on their whole thickness
    # instead of in their middle, which no vendor states
    asymmetry_deviation: float
    misfit: float  # largest relative difference of the axial secants from the loop's own [-]
    # of one loop of EI = 1 N m^2 at rest [N/m]
    axial_stiffness: float
    roll_stiffness: float


def axis_curves(shape: LoopShape, *, bar: float, compression: float, roll: float | None) -> AxisCurves:
    """Fit the curves of an isolator's loop between bars of a thickness [m] from its rated travels [m].

    The axial curve is followed to the compression, in tension to `TENSION` of it, that of roll as far if its own is not
    known. ValueError: its rope is taut within the travel.
    """
    loop = RopeLoop(shape, ELEMENTS)
    asymmetry, cubic, misfit = _axial(loop, compression)
    stiffness = loop.stiffness()
    x = np.linspace(0.1, 1.0, 10) * (compression if roll is None else roll)
    growth = loop.state(x, 0.0).roll_force / x / stiffness[0, 0] - 1.0  # of the secants, by least squares
    segments = list(shape.segments)  # level ones at both bars shorter by half a bar
    for end in (0, -1):
        whole, bend = segments[end]
        if bend == 0.0:
            segments[end] = (max(whole - 0.5 * bar, 0.05 * whole), bend)
    clamped = _axial(RopeLoop(replace(shape, segments=tuple(segments)), ELEMENTS), compression)[0]
    return AxisCurves(
        asymmetry=asymmetry, axial_cubic=cubic, roll_cubic=float(growth @ x**2 / (x**2 @ x**2)),
        asymmetry_deviation=0.5 * abs(clamped - asymmetry), misfit=misfit, axial_stiffness=float(stiffness[1, 1]),
        roll_stiffness=float(stiffness[0, 0]),
    )  # fmt: skip


def _axial(loop: RopeLoop, compression: float) -> tuple[float, float, float]:
    """Fit asymmetry, cubic term and largest relative misfit of the secants."""
    x = np.concatenate([np.linspace(-1.0, -0.1, 10), np.linspace(0.1, TENSION, 5)])  # over the rated compression
    secant = loop.state(0.0, x * compression).axial_force / (x * compression)
    secant /= loop.stiffness()[1, 1]

    def misses(parameters: Array) -> Array:
        return np.exp(parameters[0] * x) * (1.0 + parameters[1] * x**2) / secant - 1.0

    fit = scipy.optimize.least_squares(misses, [0.3, 0.1])
    exponent, cubic = fit.x.tolist()
    return exponent / compression, cubic / compression**2, float(np.abs(fit.fun).max())
