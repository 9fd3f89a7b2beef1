"""Rope loops between two bars: forces of one loop, loops along the bars, curves and coupling energy for a mount's laws."""

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from wirerope_mj.foundation.arguments import integer, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.mounts.laws import LoopCoupling
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


# Numbers of powers (u^2, u^4, u^6 and w to w^6): the fewest that keep the largest error of a force below 2 % of the largest
# coupling force over the rated travels of all 50 parts of Enidine's table (1.8 %), with as much tension as compression where
# the rope is slack so far.
ROLL_TERMS, AXIAL_TERMS = 3, 6
# Distance of a half loop's ends over its rope up to which the polynomial is fitted: nearer to the taut rope the force grows
# without bound, which no polynomial follows and no inextensible model should be believed in.
SLACK_REACH = 0.85
# Elements of a half loop: their forces are within 1e-6 of those of four times as many, far below what the polynomial misses.
ELEMENTS = 9
_POINTS = 9


def fit_coupling(
    shape: LoopShape, *, bending_stiffness: float, loops: float, roll: float, compression: float, tension: float,
    terms: tuple[int, int] = (ROLL_TERMS, AXIAL_TERMS),
) -> LoopCoupling:  # fmt: skip
    """Fit the energy U(u, w) - U(u, 0) - U(0, w) that couples roll u and axial deflection w of loops, by I x J powers.

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
    """List all pairs of roll u and axial w [m], (n, 2), and forces beyond those of (u, 0) and (0, w) for EI = 1, (n, 2)."""
    u, w = (axis.ravel() for axis in np.meshgrid(roll, axial, indexing="ij"))
    state = loop.state(u, w)
    across = state.roll_force - np.repeat(loop.state(roll, 0.0).roll_force, len(axial))
    along = state.axial_force - np.tile(loop.state(0.0, axial).axial_force, len(roll))
    return np.stack([u, w], axis=-1), np.stack([across, along], axis=-1)


# Tension up to which the curves are followed, as a fraction of the rated compression: beyond, some loops come near to taut.
TENSION = 0.5


@dataclass(frozen=True, kw_only=True)
class AxisCurves:
    """Shape of a loop's elastic force along either axis with the other axis at rest; the stiffness k is left open.

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
    """Fit asymmetry [1/m] and cubic term [1/m^2] to the axial secants; return both and the largest relative misfit."""
    x = np.concatenate([np.linspace(-1.0, -0.1, 10), np.linspace(0.1, TENSION, 5)])  # over the rated compression
    secant = loop.state(0.0, x * compression).axial_force / (x * compression)
    secant /= loop.stiffness()[1, 1]

    def relative_errors(parameters: Array) -> Array:
        return np.exp(parameters[0] * x) * (1.0 + parameters[1] * x**2) / secant - 1.0

    fit = scipy.optimize.least_squares(relative_errors, [0.3, 0.1])
    exponent, cubic = fit.x.tolist()
    return exponent / compression, cubic / compression**2, float(np.abs(fit.fun).max())
