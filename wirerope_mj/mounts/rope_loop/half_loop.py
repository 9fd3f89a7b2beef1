"""The centre line of half a rope loop, as straight segments and arcs, and its equilibria between clamped ends.

Cubic finite elements with four points of Gauss each.
"""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arguments import finite, not_negative, positive
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.errors import ConvergenceError

# Size of an isolator over the diameter of its rope, at most: those that are sold have 5 to 15, and ten times that is slack.
LARGEST_LOOP = 1000.0


@dataclass(frozen=True, kw_only=True)
class LoopShape:
    """The unloaded centre line of the half loop on the side of positive roll; the other half is its mirror image.

    It begins in the base's bar at roll = `arm`, goes out of the bar in the direction `start` and ends in the payload's bar
    at the same distance `arm` from that bar's middle. Both ends are clamped. Angles are counted from the roll axis towards
    the axial axis.
    """

    # length [m] and natural curvature [1/m] of each segment, from the base's bar to the payload's bar
    segments: tuple[tuple[float, float], ...]
    start: float = 0.0  # direction of the rope where it leaves the base's bar [rad]
    arm: float = 0.0  # distance of the clamped ends from the middle of their bars [m]

    def __post_init__(self) -> None:
        if not self.segments or not all(0.0 < length < math.inf and math.isfinite(bend) for length, bend in self.segments):
            raise ValueError(f"`segments` must be pairs of a length > 0 [m] and a finite curvature, got {self.segments!r}.")
        not_negative("arm", self.arm)
        finite("start", self.start)

    @property
    def length(self) -> float:
        return sum(length for length, _ in self.segments)

    @property
    def span(self) -> tuple[float, float]:
        """Distance of the two clamped ends in roll and axial direction, unloaded [m]."""
        direction, total = self.start, np.zeros(2)
        for length, curvature in self.segments:
            turned = length * curvature
            middle = direction + 0.5 * turned
            # The chord of an arc; sinc keeps the straight segment a limit and not a case.
            total += length * np.sinc(0.5 * turned / math.pi) * np.array([math.cos(middle), math.sin(middle)])
            direction += turned
        return float(total[0]), float(total[1])

    def taut(self, roll: float = 0.0) -> float:
        """Axial deflection [m] at which the inextensible rope of one half is a straight line; NaN if it never is."""
        across, along = self.span
        rest = self.length**2 - (abs(across) + abs(roll)) ** 2
        return math.sqrt(rest) - along if rest >= 0.0 else math.nan


def loop_shape(*, height: float, width: float, bar: float, rope: float) -> LoopShape:
    """Draw the half loop of an isolator from its envelope [m]: unloaded height over both bars, width over the ropes.

    The rope leaves both bars level and half way up their thickness, so that the centre line rises by `height` - `bar`; it
    reaches (`width` - `rope`) / 2 to the side. The roundest line through these points is a stadium: a half circle between two
    straight level segments where the loop is wider than high, and two quarter circles with a straight upright segment between
    them where it is not. The straight segments begin in the middle of the bar: no vendor states how much of them the bar holds.
    ValueError: an argument is not a finite number > 0, a bar is thinner than its rope, or no loop is left between them.
    """
    for name, value in {"height": height, "width": width, "bar": bar, "rope": rope}.items():
        if positive(name, value) > LARGEST_LOOP * rope:
            raise ValueError(f"`{name}` must be at most {LARGEST_LOOP:g} times the `rope` of {rope:g} m, got {value:g} m.")
    if bar < rope:
        raise ValueError(f"`bar` must be at least as thick as the `rope` that it holds, {rope:g} m, got {bar:g} m.")
    rise, reach = height - bar, 0.5 * (width - rope)
    if rise <= rope or bar >= 0.5 * height:
        raise ValueError(f"`height` of {height:g} m leaves no loop between two bars of {bar:g} m and {rope:g} m of rope.")
    if reach <= rope:
        raise ValueError(f"`width` of {width:g} m leaves no loop of a rope of {rope:g} m.")
    radius = min(0.5 * rise, reach)
    arc, level, upright = 0.5 * math.pi * radius, reach - radius, rise - 2.0 * radius
    segments = ((level, 0.0), (arc, 1.0 / radius), (upright, 0.0), (arc, 1.0 / radius), (level, 0.0))
    return LoopShape(segments=tuple(segment for segment in segments if segment[0] > 1e-9 * rise))


# Degree of the shape functions. Energy and force then err by h^6, as tests/mounts/test_rope_loop.py measures by halving h.
DEGREE = 3


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Shape functions of one half loop; lengths in units of the half loop's length."""

    value: Array  # shape functions at the points of Gauss, (q, n)
    slope: Array  # their derivatives, (q, n)
    weight: Array  # weights of the points, (q,)
    curvature: Array  # natural curvature at the points, (q,)
    natural: Array  # natural direction at the nodes [rad], (n,)


def mesh(shape: LoopShape, elements: int) -> Mesh:
    """Divide a half loop into elements; none reaches over a jump of the natural curvature.

    They are shared among the segments in proportion to their lengths, at least one for each.
    """
    lengths = np.array([length for length, _ in shape.segments]) / shape.length
    bends = np.array([curvature for _, curvature in shape.segments]) * shape.length
    counts = np.maximum(1, np.round(elements * lengths).astype(int))
    sizes, curvatures = np.repeat(lengths / counts, counts), np.repeat(bends, counts)
    points, weights = np.polynomial.legendre.leggauss(DEGREE + 1)
    inside = np.linspace(-1.0, 1.0, DEGREE + 1)
    basis = np.linalg.inv(np.vander(inside, increasing=True))  # columns: coefficients of the shape functions
    at_points = np.vander(points, DEGREE + 1, increasing=True) @ basis
    powers = np.arange(1, DEGREE + 1)
    slopes = (powers * np.vander(points, DEGREE, increasing=True)) @ basis[1:]

    total, per = len(sizes), DEGREE + 1
    value, slope = np.zeros((total * per, DEGREE * total + 1)), np.zeros((total * per, DEGREE * total + 1))
    for index, size in enumerate(sizes):
        rows, columns = slice(index * per, (index + 1) * per), slice(DEGREE * index, DEGREE * (index + 1) + 1)
        value[rows, columns], slope[rows, columns] = at_points, slopes * (2.0 / size)
    steps = np.repeat(sizes * curvatures, DEGREE) / DEGREE
    return Mesh(
        value=value, slope=slope, weight=np.outer(0.5 * sizes, weights).ravel(), curvature=np.repeat(curvatures, per),
        natural=shape.start + np.concatenate([[0.0], np.cumsum(steps)]),
    )  # fmt: skip


# Change of the directions [rad] after which one more step of Newton, which squares it, leaves rounding only.
_CONVERGED = 1e-10
_ITERATIONS = 12
# First step along the path of the end, in lengths of the rope, and the smallest step, as a fraction of the first one, below
# which there is no equilibrium.
_FIRST_STEP, _SMALLEST_STEP = 0.1, 1e-3
_TURN = 0.5  # Largest change of a direction in one step [rad]: more may jump to another equilibrium


@dataclass(frozen=True, kw_only=True)
class HalfState:
    """Equilibria of half a rope loop, EI = 1 N m^2, at m displacements of the payload's bar, in which one end is clamped."""

    direction: Array  # of the rope at the nodes [rad], (m, n)
    energy: Array  # of bending [J], (m,)
    force: Array  # on the clamped end in the payload's bar that holds it there, roll and axial [N], (m, 2)
    moment: Array  # bending moment at that end [N m], positive where the rope turns more than unloaded, (m,)


class HalfLoop:
    """An inextensible rope of EI = 1 N m^2, naturally curved, clamped at both ends, in its plane (Euler's elastica).

    With the direction theta(s) it has the energy 1/2 integral (theta' - kappa_0)^2 ds; the ends' distance is the integral of
    (cos theta, sin theta), kept by two multipliers, which are the force: it is the gradient of the discrete energy exactly.
    """

    def __init__(self, shape: LoopShape, elements: int | None = None) -> None:
        self.shape = shape
        turned = sum(abs(length * curvature) for length, curvature in shape.segments)
        # One for every 12 degrees has the force to about 1e-6 of itself away from the taut rope.
        usual = max(15, math.ceil(turned / math.radians(12.0)))
        self.mesh: Mesh = mesh(shape, usual if elements is None else elements)
        weighted = self.mesh.slope * self.mesh.weight[:, None]
        self._stiffness = weighted.T @ self.mesh.slope
        self._bent = weighted.T @ self.mesh.curvature

    def move(self, displacement: Array, turn: Array) -> HalfState:
        """Follow the equilibria as the clamped end moves straight from its unloaded position by roll and axial [m], (m, 2).

        Its direction turns by `turn` [rad], (m,). ConvergenceError says where on the path there is no equilibrium.
        """
        m = len(displacement)
        goal = np.column_stack([displacement / self.shape.length, turn])
        direction, force = np.tile(self.mesh.natural, (m, 1)), np.zeros((m, 2))
        done = np.zeros(m)
        size = np.max(np.abs(goal), axis=1, initial=1e-12)
        step = np.minimum(1.0, _FIRST_STEP / size)
        while (active := np.flatnonzero(done < 1.0)).size:
            trial = np.minimum(1.0, done[active] + step[active])
            new_direction, new_force, converged = self.equilibrium(
                direction[active], force[active], trial[:, None] * goal[active]
            )
            calm = np.max(np.abs(new_direction - direction[active]), axis=1, initial=0.0) < _TURN
            good = converged & calm
            kept = active[good]
            direction[kept], force[kept], done[kept] = new_direction[good], new_force[good], trial[good]
            step[kept] *= 1.5
            step[active[~good]] *= 0.5
            if np.any(stuck := step < _SMALLEST_STEP * np.minimum(1.0, _FIRST_STEP / size)):
                roll, axial = 1e3 * displacement[stuck][0]
                raise ConvergenceError(
                    f"the rope loop finds no equilibrium beyond {100.0 * done[stuck][0]:.3g} % of the path to {roll:.6g} mm in "
                    f"roll, {axial:.6g} mm in axial direction and a turn of {np.degrees(turn[stuck][0]):.4g} degrees; one half "
                    f"is taut at {1e3 * self.shape.taut(float(displacement[stuck][0][0])):.6g} mm in axial direction."
                )
        length = self.shape.length
        strain = direction @ self.mesh.slope.T - self.mesh.curvature
        distance_gradient = self._ends(direction, np.zeros((m, 2)))[2]
        return HalfState(
            direction=direction, energy=0.5 * (strain**2 @ self.mesh.weight) / length, force=force / length**2,
            moment=self._unbalanced(direction, force, distance_gradient)[:, -1] / length,
        )  # fmt: skip

    def equilibrium(self, direction: Array, force: Array, goal: Array) -> tuple[Array, Array, Booleans]:
        """Find directions, forces and whether they are an equilibrium, by Newton's method from a guess.

        The guess is the direction at the nodes [rad], (m, n), and the force, (m, 2), with the length of the rope as unit of
        length; the end goes to its displacement in lengths of the rope and change of direction [rad], (m, 3).
        """
        direction, force = direction.copy(), force.copy()
        direction[:, 0] = self.mesh.natural[0]
        direction[:, -1] = self.mesh.natural[-1] + goal[:, 2]
        end = np.array(self.shape.span) / self.shape.length + goal[:, :2]
        converged = np.zeros(len(direction), dtype=bool)
        unsolved = np.arange(len(direction))
        for _ in range(_ITERATIONS):
            change = self._newton_step(direction[unsolved], force[unsolved], end[unsolved])
            largest = np.max(np.abs(change[:, :-2]), axis=1, initial=0.0)
            damped = np.minimum(1.0, _TURN / np.maximum(largest, 1e-300))[:, None]
            direction[unsolved, 1:-1] += damped * change[:, :-2]
            force[unsolved] += damped * change[:, -2:]
            converged[unsolved] = largest < _CONVERGED
            unsolved = unsolved[np.isfinite(largest) & (largest >= _CONVERGED)]
            if not unsolved.size:
                break
        return direction, force, converged

    def _newton_step(self, direction: Array, force: Array, end: Array) -> Array:
        """Solve for Newton's change of the inner directions and of the force, (m, n - 2 + 2)."""
        cosine, sine, distance_gradient, distance_error = self._ends(direction, end)
        inner = direction.shape[1] - 2
        bend = np.einsum("mq,qi,qj->mij", (force[:, :1] * cosine + force[:, 1:] * sine) * self.mesh.weight,
                         self.mesh.value[:, 1:-1], self.mesh.value[:, 1:-1], optimize=True)  # fmt: skip
        matrix = np.zeros((len(direction), inner + 2, inner + 2))
        matrix[:, :inner, :inner] = self._stiffness[1:-1, 1:-1] + bend
        matrix[:, :inner, inner:] = -distance_gradient[:, 1:-1]
        matrix[:, inner:, :inner] = -np.swapaxes(distance_gradient[:, 1:-1], 1, 2)
        rest = np.concatenate([self._unbalanced(direction, force, distance_gradient)[:, 1:-1], -distance_error], axis=1)
        try:
            return np.linalg.solve(matrix, -rest[:, :, None])[:, :, 0]
        except np.linalg.LinAlgError:  # one singular matrix among many: none of this step is used, smaller ones follow
            return np.full_like(rest, np.nan)

    def _ends(self, direction: Array, end: Array) -> tuple[Array, Array, Array, Array]:
        """Evaluate cosine, sine of the directions (m, q), derivatives of the ends' distance (m, n, 2) and its error (m, 2)."""
        angle = direction @ self.mesh.value.T
        cosine, sine = np.cos(angle), np.sin(angle)
        weight = self.mesh.weight
        distance_gradient = np.stack([-(sine * weight) @ self.mesh.value, (cosine * weight) @ self.mesh.value], axis=2)
        return cosine, sine, distance_gradient, np.stack([cosine @ weight, sine @ weight], axis=1) - end

    def _unbalanced(self, direction: Array, force: Array, distance_gradient: Array) -> Array:
        """Compute the gradient of energy minus force times distance, (m, n); at the last node it is the end's moment."""
        return direction @ self._stiffness - self._bent - np.einsum("mnk,mk->mn", distance_gradient, force)
