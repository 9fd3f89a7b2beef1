"""Rotational stiffness of an isolator, from its loops spread along the bars."""

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arguments import integer, positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.rope_loop.elastica import RopeLoop
from wirerope_mj.mounts.rope_loop.shape import LoopShape


def loop_positions(loops: int, bar_length: float) -> Array:
    """Return the positions of an isolator's loops along its bars [m], from the middle, evenly spread."""
    integer("loops", loops, least=1)
    positive("bar_length", bar_length)
    return (np.arange(loops) - 0.5 * (loops - 1)) * bar_length / loops


def rotational_stiffness(
    shape: LoopShape,
    *,
    bending_stiffness: float,
    positions: npt.ArrayLike,
    axial: float | None = None,
    roll: float | None = None,
) -> Array:
    """Return the rotational stiffness of an isolator about its own axes x (roll), y (shear) and z (axial) [N m/rad], (3,).

    It belongs to a small turn of the payload about the unloaded isolator's middle: half way between the bars, in the middle of
    their length. There turns and deflections do not act on each other, so that the forces of the three axes and these moments
    can be put at one point, where both of a mount's sites lie.

        about x: k_axial mean(y_i^2)     about z: k_roll mean(y_i^2)
        about y: n EI (K_tt + h K_ut + h^2 K_uu / 4), with the elastica's matrix K of one loop at the payload's bar (roll u,
                 turn t) and the distance h of the two clamps: the bar turns and moves sideways by h / 2 times the turn

    The torsion of single loops about x and z is left out: it is small against loops that are spread out.

    Args:
        shape: of the half loop.
        bending_stiffness: EI of the rope [N m^2]: that of small vibration for small vibration.
        positions: of the loops along the bars, from their middle [m], (n,).
        axial: stiffness of all loops [N/m] where it is known; otherwise the elastica's.
        roll: the same across the bars; it also takes the place of the elastica's in the moment about z alone.

    Raises:
        ValueError: an argument is out of range.
    """
    y = np.asarray(positions, dtype=float)
    if y.ndim != 1 or y.size == 0 or not np.all(np.isfinite(y)):
        raise ValueError(f"`positions` must be finite numbers in one row, got {positions!r}.")
    if abs(y.sum()) > 1e-6 * np.abs(y).sum():
        raise ValueError(f"`positions` must be counted from the middle of the loops; their mean is {y.mean():.6g} m.")
    for name, value in {"bending_stiffness": bending_stiffness, "axial": axial, "roll": roll}.items():
        if value is not None:
            positive(name, value)
    matrix = y.size * bending_stiffness * RopeLoop(shape).stiffness()
    spread, rise = float(np.mean(y**2)), shape.span[1]
    about_bars = matrix[2, 2] + rise * matrix[0, 2] + 0.25 * rise**2 * matrix[0, 0]
    about_roll = (matrix[1, 1] if axial is None else axial) * spread
    about_axial = (matrix[0, 0] if roll is None else roll) * spread
    return np.array([about_roll, about_bars, about_axial])
