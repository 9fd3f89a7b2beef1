"""The energy that couples roll and axial direction of a rope loop, as a polynomial that a mount can evaluate."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.rope_loop.elastica import RopeLoop
from wirerope_mj.rope_loop.shape import LoopShape

Array = npt.NDArray[np.float64]

ROLL_TERMS, AXIAL_TERMS = 3, 6
"""Numbers of powers (u^2, u^4, u^6 and w to w^6): the fewest that keep the largest error of a force below 2 % of the largest
coupling force over the rated travels of all 50 parts of Enidine's table (1.8 %), with as much tension as compression where the
rope is slack so far."""

SLACK_REACH = 0.85
"""Distance of a half loop's ends over its rope up to which the polynomial is fitted: nearer to the taut rope the force grows
without bound, which no polynomial follows and no inextensible model should be believed in."""

_POINTS = 13


@dataclass(frozen=True, kw_only=True)
class LoopCoupling:
    """Elastic energy of a wire-rope isolator that neither axis has alone.

        U_c(u, w) = sum_ij c_ij (u / roll)^(2 i) (w / max(compression, tension))^j,   i = 1..I, j = 1..J

    with u in roll and w in axial direction [m], positive in tension. It vanishes with either deflection, so that the laws of
    the two axes stay what they are; the force is its gradient. It holds for |u| <= roll, -compression <= w <= tension.

    Attributes:
        roll, compression, tension: ends of the box [m], all positive.
        coefficients: c [J], I rows of J.
    """

    roll: float
    compression: float
    tension: float
    coefficients: tuple[tuple[float, ...], ...]

    def energy(self, roll: npt.ArrayLike, axial: npt.ArrayLike) -> Array:
        """Return U_c [J] at deflections [m], of their common shape."""
        u2, w = self._scaled(roll, axial)
        return np.asarray(np.polynomial.polynomial.polyval2d(u2, w, self._padded()))

    def force(self, roll: npt.ArrayLike, axial: npt.ArrayLike) -> Array:
        """Return the restoring force in roll and axial direction [N], +k x for a spring, with a last axis of 2."""
        u2, w = self._scaled(roll, axial)
        padded = self._padded()
        by_square = np.polynomial.polynomial.polyval2d(u2, w, np.polynomial.polynomial.polyder(padded, axis=0))
        along = np.polynomial.polynomial.polyval2d(u2, w, np.polynomial.polynomial.polyder(padded, axis=1))
        across = by_square * 2.0 * np.asarray(roll) / self.roll**2
        return np.stack(np.broadcast_arrays(across, along / max(self.compression, self.tension)), axis=-1)

    def _scaled(self, roll: npt.ArrayLike, axial: npt.ArrayLike) -> tuple[Array, Array]:
        """Return (u / roll)^2 and w over its range."""
        u2 = (np.asarray(roll, dtype=float) / self.roll) ** 2
        w = np.asarray(axial, dtype=float) / max(self.compression, self.tension)
        one, other = np.broadcast_arrays(u2, w)
        return one, other

    def _padded(self) -> Array:
        """Return the coefficients with the powers 0 in front, which are zero."""
        return np.pad(np.asarray(self.coefficients), ((1, 0), (1, 0)))


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

    The coefficients are a least-squares fit of the two coupling forces at 13 x 13 Chebyshev points of the box; the error is
    measured at 14 x 14 others, its edges included.

    Args:
        shape: of the half loop.
        bending_stiffness: EI of the rope [N m^2].
        loops: how many.
        roll: half side of the box across the bars [m].
        compression: its lower side [m], > 0.
        tension: its upper side [m]; it ends where the ends of a half loop at full roll are 85 % of its rope apart
            (`SLACK_REACH`).
        terms: I and J.

    Raises:
        ValueError: an argument is not a finite number > 0, or full roll leaves no tension.
        ConvergenceError: the elastica is not found in some corner.
    """
    values = {"bending_stiffness": bending_stiffness, "loops": loops, "roll": roll, "compression": compression}
    for name, value in (values | {"tension": tension}).items():
        if not 0.0 < value < math.inf:
            raise ValueError(f"`{name}` must be a finite number > 0, got {value!r}.")
    tension = min(tension, _slack_tension(shape, roll))
    loop, scale = RopeLoop(shape), bending_stiffness * loops
    knots = 0.5 * (1.0 - np.cos(np.pi * (np.arange(_POINTS) + 0.5) / _POINTS))
    u, w, target, _ = _coupling_forces(loop, roll * knots, -compression + (compression + tension) * knots)
    blank = LoopCoupling(roll=roll, compression=compression, tension=tension, coefficients=())
    columns = []
    for index in range(terms[0] * terms[1]):
        unit = np.zeros(terms)
        unit.flat[index] = 1.0
        columns.append(_with(blank, unit).force(u, w).ravel())
    solution = np.linalg.lstsq(np.stack(columns, axis=1), target.ravel(), rcond=None)[0].reshape(terms)
    fitted = _with(blank, solution)
    between = np.linspace(0.0, 1.0, _POINTS + 1)
    u, w, exact, whole = _coupling_forces(loop, roll * between, -compression + (compression + tension) * between)
    miss = np.linalg.norm(fitted.force(u, w) - exact, axis=-1).max()
    return CouplingFit(
        coupling=_with(blank, scale * solution),
        force_error=float(miss / np.linalg.norm(exact, axis=-1).max()),
        whole_force_error=float(miss / np.linalg.norm(whole, axis=-1).max()),
    )


def _with(coupling: LoopCoupling, coefficients: npt.NDArray[Any]) -> LoopCoupling:
    """Return the same box with other coefficients."""
    return LoopCoupling(
        roll=coupling.roll,
        compression=coupling.compression,
        tension=coupling.tension,
        coefficients=tuple(tuple(float(value) for value in row) for row in coefficients),
    )


def _coupling_forces(loop: RopeLoop, roll: Array, axial: Array) -> tuple[Array, Array, Array, Array]:
    """Return all pairs (u, w) of two lists of deflections [m], (n,) each, and the forces there for EI = 1 N m^2, (n, 2).

    First those beyond what (u, 0) and (0, w) have alone, then the whole ones.
    """
    u, w = (part.ravel() for part in np.meshgrid(roll, axial, indexing="ij"))
    state = loop.state(u, w)
    across = np.repeat(loop.state(roll, 0.0).roll_force, len(axial))
    along = np.tile(loop.state(0.0, axial).axial_force, len(roll))
    whole = np.stack([state.roll_force, state.axial_force], axis=-1)
    return u, w, whole - np.stack([across, along], axis=-1), whole


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
