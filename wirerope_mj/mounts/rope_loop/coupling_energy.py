"""The energy that couples roll and axial direction of a rope loop, as a polynomial that a mount can evaluate."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import LoopCoupling
from wirerope_mj.mounts.rope_loop.elastica import RopeLoop
from wirerope_mj.mounts.rope_loop.shape import LoopShape

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


@dataclass(frozen=True, kw_only=True)
class CouplingFit:
    """A coupling energy and how well it has the forces of the elastica.

    Attributes:
        coupling: the polynomial.
        force_error: largest error of a coupling force over the box, over the largest coupling force there [-].
        whole_force_error: the same error over the largest force of the whole loop in the box [-].
    """

    coupling: LoopCoupling
    force_error: float
    whole_force_error: float


def fit_coupling(
    shape: LoopShape,
    *,
    bending_stiffness: float,
    loops: float,
    roll: float,
    compression: float,
    tension: float,
    terms: tuple[int, int] = (ROLL_TERMS, AXIAL_TERMS),
) -> CouplingFit:
    """Return the coupling energy U(u, w) - U(u, 0) - U(0, w) of an isolator's loops as a polynomial, and its error.

    The coefficients are a least-squares fit of the two coupling forces at 9 x 9 Chebyshev points of the box; the error is
    measured at 10 x 10 others, its edges included.

    Args:
        shape: of the half loop.
        bending_stiffness: EI of the rope [N m^2].
        loops: their number.
        roll: end of the box on both sides [m].
        compression: end of the box in compression [m].
        tension: end of the box in tension [m]; it ends where the rope of a half loop at full roll would be stretched to more
            than 85 % of its length (`SLACK_REACH`).
        terms: I and J.

    Raises:
        ValueError: an argument is not a finite number > 0, or full roll leaves no tension.
        ConvergenceError: the elastica has no equilibrium in some corner.
    """
    values = {"bending_stiffness": bending_stiffness, "loops": loops, "roll": roll, "compression": compression}
    for name, value in (values | {"tension": tension}).items():
        positive(name, value)
    tension = min(tension, _slack_tension(shape, roll))
    loop, scale = RopeLoop(shape, ELEMENTS), bending_stiffness * loops

    def polynomial(coefficients: npt.NDArray[np.floating[Any]]) -> LoopCoupling:
        return LoopCoupling(roll=roll, compression=compression, tension=tension, coefficients=coefficients.tolist())

    knots = 0.5 * (1.0 - np.cos(np.pi * (np.arange(_POINTS) + 0.5) / _POINTS))
    points, target, _ = _coupling_forces(loop, roll * knots, -compression + (compression + tension) * knots)
    units = np.eye(terms[0] * terms[1]).reshape(-1, *terms)
    columns = np.stack([polynomial(unit).force(points).ravel() for unit in units], axis=1)
    solution = np.linalg.lstsq(columns, target.ravel(), rcond=None)[0].reshape(terms)
    between = np.linspace(0.0, 1.0, _POINTS + 1)
    points, exact, whole = _coupling_forces(loop, roll * between, -compression + (compression + tension) * between)
    miss = np.linalg.norm(polynomial(solution).force(points) - exact, axis=-1).max()
    return CouplingFit(
        coupling=polynomial(scale * solution),
        force_error=float(miss / np.linalg.norm(exact, axis=-1).max()),
        whole_force_error=float(miss / np.linalg.norm(whole, axis=-1).max()),
    )


def _coupling_forces(loop: RopeLoop, roll: Array, axial: Array) -> tuple[Array, Array, Array]:
    """Return all pairs (u, w) of two lists of deflections [m], (n, 2), and the forces there for EI = 1 N m^2, (n, 2).

    First those beyond what (u, 0) and (0, w) have alone, then the whole ones.
    """
    u, w = (axis.ravel() for axis in np.meshgrid(roll, axial, indexing="ij"))
    state = loop.state(u, w)
    across = np.repeat(loop.state(roll, 0.0).roll_force, len(axial))
    along = np.tile(loop.state(0.0, axial).axial_force, len(roll))
    whole = np.stack([state.roll_force, state.axial_force], axis=-1)
    return np.stack([u, w], axis=-1), whole - np.stack([across, along], axis=-1), whole


def _slack_tension(shape: LoopShape, roll: float) -> float:
    """Return the largest tension [m] that leaves a half loop slack at full roll; ValueError if there is none."""
    across, along = shape.span
    rest = (SLACK_REACH * shape.length) ** 2 - (abs(across) + roll) ** 2
    if rest <= along**2:
        raise ValueError(
            f"`roll` of {roll:.6g} m stretches the rope of a half loop to more than {100.0 * SLACK_REACH:g} % of its length; "
            "its coupling is not fitted so far."
        )
    return math.sqrt(rest) - along
