"""Cycles of the mounts of a run: their deflections and forces along every axis."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from wirerope_mj.assessment.between_samples import parabolas, path, sample_rate
from wirerope_mj.assessment.durability.cycles import Cycles, rainflow_cycles
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.mounts.isolator import AXES

Quantity = Literal["deflection", "force"]
_LEAST = 16  # Samples from which on every other one alone tells how much hangs on the rate
# Samples to a period of the mean frequency below which a steady vibration may repeat itself in them, and look alike.
_OF_PERIOD = 4.0

ROUNDING = 1e-8  # deflection that bodies far away leave where nothing bends [m]


@dataclass(frozen=True, kw_only=True)
class MountCycles:
    """Cycles of one axis of a mount: of its deflection [m] or its force [N]."""

    mount: str
    axis: str  # "roll", "shear" or "axial"
    cycles: Cycles  # from the turning points, also between the samples
    # of what is counted, and of the deflection that it hangs on, the cycles of all samples and of every other one
    # alone, the even and the odd ones, to tell how much hangs on the rate; empty where there are too few, in all or of a period
    coarser: tuple[tuple[Cycles, Cycles], ...] = field(default=(), compare=False, repr=False)
    frequency: float = 0.0  # mean frequency of the deflection, rms of its rate over 2 pi that of itself [Hz]

    def damage_error(self, exponent: float) -> float:
        """Return the damage of every other sample over that of all less 1, in size; infinite where nothing can be told.

        The damage of all samples is off by about a third of it: errors fall with the square of the rate at the least.
        """
        pairs = [(all_of.damage(exponent), half.damage(exponent)) for all_of, half in self.coarser]
        return max((abs(half / damage - 1.0) if damage else 0.0 for damage, half in pairs), default=math.inf)


def mount_cycles(
    response: Response, *, quantity: Quantity = "deflection", start: float = -math.inf, end: float = math.inf
) -> list[MountCycles]:
    """Return the cycles of every mount but stops along roll, shear and axial, in the order of the model.

    Turning points between the samples are those of cubics through the deflections and their rates, which follow from the motion
    of the bodies; of forces, those of parabolas. `MountCycles.damage_error` says whether the samples are enough for that.

    Args:
        response: of a run; of a long one each mount is read by itself.
        quantity: "deflection" or "force".
        start: instant from which on cycles are counted [s].
        end: instant up to which they are [s].

    Raises:
        ValueError: fewer than two samples lie between `start` and `end`.
    """
    one_of("quantity", quantity, ("deflection", "force"))
    rows = slice(*np.searchsorted(response.time, [start, end + 1e-9]))
    if response.time[rows].size < 2:
        raise ValueError(f"`start` and `end` must hold two samples between them, got {start!r} and {end!r} s.")
    mounts: Sequence[SceneMount] = [mount for mount in response.scene.mounts if not mount.stop]
    return [one for mount in mounts for one in _of_mount(response, mount, quantity, rows)]


def _of_mount(response: Response, mount: SceneMount, quantity: Quantity, rows: slice) -> Iterator[MountCycles]:
    spacing = 1.0 / sample_rate(response.time)
    rates = deflection_rates(response, mount)[rows]
    for number, axis in enumerate(AXES):
        deflection = response.column(f"mounts/{mount.name}/deflection/{axis}")[rows]
        rate, spread = rates[:, number], float(deflection.std())
        several = ((0, 1), (0, 2), (1, 2)) if deflection.size >= _LEAST else ((0, 1),)
        turns = [[path(deflection[at::every], rate[at::every], every * spacing)[0] for at, every in several]]
        if quantity == "force":
            force = response.column(f"mounts/{mount.name}/force/{axis}")[rows]
            turns.append([parabolas(force[at::every]) for at, every in several])
        counted = [tuple(map(rainflow_cycles, each)) for each in turns]
        frequency = float(rate.std()) / (2.0 * math.pi * spread) if spread else 0.0
        told = frequency * spacing * _OF_PERIOD <= 1.0
        yield MountCycles(
            mount=mount.name, axis=axis, cycles=counted[-1][0],
            coarser=tuple((each[0], half) for each in counted for half in each[1:] if told), frequency=frequency,
        )  # fmt: skip


def deflection_rates(response: Response, mount: SceneMount) -> Array:
    """Return the rates of a mount's deflection along roll, shear and axial at the samples [m/s], (n_t, 3)."""
    place, velocity, _, _ = _site(response, mount.payload_body, mount.payload_point)
    base, base_velocity, turn, spin = _site(response, mount.base_body, mount.base_point)
    relative = velocity - base_velocity - np.cross(spin, place - base)
    rates, rigid = (np.einsum("...ij,...i->...j", turn @ mount.axes, one) for one in (relative, place - base))
    bent = response.mounts[mount.name].deflection - rigid  # what a flexible part adds, whose modes are no bodies
    if np.abs(bent).max(initial=0.0) > ROUNDING:
        rates += np.gradient(bent, response.time, axis=0)
    return np.asarray(rates)


def _site(response: Response, body: str, point: Array) -> tuple[Array, Array, Array, Array]:
    """Return place and velocity of a point of a body, the body's axes and its angular velocity, at the samples."""
    if body in response.bodies:
        moved = response.bodies[body]
        turn, spin = rotation_matrices(moved.orientation), moved.angular_velocity
        arm = turn @ point
        return moved.position + arm, moved.velocity + np.cross(spin, arm), turn, spin
    still, none = next((one for one in response.scene.bodies if one.name == body), None), np.zeros(3)
    if still is None:
        return point, none, np.eye(3), none
    turn = rotation_matrices(still.orientation)
    return still.position + turn @ point, none, turn, none
