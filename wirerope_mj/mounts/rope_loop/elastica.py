"""A whole rope loop between two bars: energy, force and moment for a deflection and a turn, and loops along the bars."""

from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arguments import integer, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.mounts.rope_loop.half_loop import HalfLoop, LoopShape

# Distance of the clamped ends over the rope's length up to which a loop is solved: beyond, an inextensible rope is taut, its
# force goes to infinity, and a real one is held by what it stretches and by how it is clamped.
LARGEST_REACH = 0.95


@dataclass(frozen=True, kw_only=True)
class LoopState:
    """A loop of EI = 1 N m^2 held at deflections; multiply by EI [N m^2] and by the number of loops."""

    energy: Array  # of bending [J], of the shape of the deflections
    roll_force: Array  # restoring force, +k x for a spring [N]
    axial_force: Array  # the same; positive in tension [N]
    moment: Array  # restoring moment about the middle of the payload's bar, about the shear axis [N m]


class RopeLoop:
    """A planar loop of inextensible, naturally curved rope with its two halves clamped in both bars."""

    def __init__(self, shape: LoopShape, elements: int | None = None) -> None:
        self.shape = shape
        self._half = HalfLoop(shape, elements)

    def state(self, roll: ArrayLike, axial: ArrayLike, turn: ArrayLike = 0.0) -> LoopState:
        """Compute energy, force and moment for EI = 1 N m^2 at deflections [m] and turns [rad], of their common shape.

        Deflections are the payload's bar minus the base's, roll across the bars, axial positive in tension. The payload's bar
        turns about the shear axis, through its middle, right-handed: that lowers the end of the bar on the side of positive
        roll.

        Raises:
            ValueError: the rope is taut (`LARGEST_REACH`), or an argument is not finite.
            ConvergenceError: no equilibrium on the straight path from the unloaded loop.
        """
        u, w, t = (np.asarray(values, dtype=float) for values in np.broadcast_arrays(roll, axial, turn))
        # The other half is a mirror image: roll and turn change their signs in it.
        side = np.repeat([1.0, -1.0], u.size)
        across, along, turned = side * np.tile(u.ravel(), 2), np.tile(w.ravel(), 2), side * np.tile(t.ravel(), 2)
        arm = self.shape.arm
        moved = np.column_stack([across + arm * (np.cos(turned) - 1.0), along - arm * np.sin(turned)])
        if not np.all(np.isfinite(moved)):
            raise ValueError("`roll`, `axial` and `turn` must be finite.")
        reach = np.linalg.norm(moved + np.array(self.shape.span), axis=1) / self.shape.length
        if np.any(reach > LARGEST_REACH):
            worst = moved[np.argmax(reach)]
            raise ValueError(
                f"the rope is taut: a deflection of {1e3 * worst[0]:.6g} mm in roll and {1e3 * worst[1]:.6g} mm in axial "
                f"direction needs {100.0 * reach.max():.4g} % of the free rope; a loop is solved up to "
                f"{100.0 * LARGEST_REACH:g} %. It is taut at {1e3 * self.shape.taut():.6g} mm without roll."
            )
        half = self._half.move(moved, -turned)
        lever = -arm * (half.force[:, 0] * np.sin(turned) + half.force[:, 1] * np.cos(turned))
        moment = side * (lever - half.moment)
        values = (half.energy, side * half.force[:, 0], half.force[:, 1], moment)
        energy, roll_force, axial_force, turning = (value.reshape(2, *u.shape).sum(axis=0) for value in values)
        return LoopState(energy=energy, roll_force=roll_force, axial_force=axial_force, moment=turning)

    def stiffness(self) -> Array:
        """Compute the matrix of small deflections about the unloaded loop (roll, axial, turn) for EI = 1 N m^2, (3, 3).

        Units N/m, N and N m/rad; from central differences of the force. Turn is that of `state`, about the payload's bar.
        """
        length = self.shape.length
        # A ten-thousandth of the length: the differences err by its square, rounding by 1e-12 over it.
        steps = np.array([1e-4 * length, 1e-4 * length, 1e-4])
        points = np.concatenate([np.diag(steps), -np.diag(steps)])
        state = self.state(points[:, 0], points[:, 1], points[:, 2])
        forces = np.stack([state.roll_force, state.axial_force, state.moment], axis=1)
        matrix = (forces[:3] - forces[3:]).T / (2.0 * steps)
        return 0.5 * (matrix + matrix.T)


def loop_positions(loops: int, bar_length: float) -> Array:
    """Spread an isolator's loops evenly along its bars: their positions [m] from the middle."""
    integer("loops", loops, least=1)
    positive("bar_length", bar_length)
    return (np.arange(loops) - 0.5 * (loops - 1)) * bar_length / loops


def rotational_stiffness(
    shape: LoopShape, *, bending_stiffness: float, positions: ArrayLike, axial: float | None = None, roll: float | None = None
) -> Array:
    """Compute the rotational stiffness of an isolator about its own axes x (roll), y (shear) and z (axial) [N m/rad], (3,).

    It belongs to a small turn of the payload about the unloaded isolator's middle: half way between the bars, in the middle
    of their length. There turns and deflections do not act on each other, so that the forces of the three axes and these
    moments can be put at one point, where both of a mount's sites lie.

        about x: k_axial mean(y_i^2)     about z: k_roll mean(y_i^2)
        about y: n EI (K_tt + h K_ut + h^2 K_uu / 4), with the elastica's matrix K of one loop at the payload's bar (roll u,
                 turn t) and the distance h of the two clamps: the bar turns and moves sideways by h / 2 times the turn

    The torsion of single loops about x and z is left out: it is small against loops that are spread out. EI is the bending
    stiffness of the rope [N m^2], y_i the positions of the loops along the bars from their middle [m], (n,). Stiffnesses of
    all loops along the axis and across the bars [N/m] take the place of the elastica's where they are known, except about y.
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
