"""One row of a branch for each of its points."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.periodic.continuation import Point
from wirerope_mj.dynamics.periodic.observe import amplitude, body_acceleration
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, unit_vector


@dataclass(frozen=True, kw_only=True)
class Row:
    """A point of a branch; the attributes are those of `Branch`."""

    frequency: float
    acceleration: float
    amplitude: float
    stable: bool
    multipliers: npt.NDArray[np.complex128]
    neutral: int
    unknowns: Array
    smoothing_width: float
    steps: int
    tangent: float
    residual: float


def row_of(system: System, point: Point, payload: str, direction: Direction) -> Row:
    """Return the row of a point: the payload's acceleration is taken along `direction`."""
    drive = point.shot.track.drive
    acceleration = body_acceleration(system, point.shot.track, payload)
    return Row(
        frequency=drive.frequency,
        acceleration=drive.acceleration,
        amplitude=amplitude(acceleration @ unit_vector(direction)),
        stable=point.stability.stable,
        multipliers=point.stability.multipliers,
        neutral=point.stability.neutral,
        unknowns=point.shot.x,
        smoothing_width=point.width,
        steps=drive.steps,
        tangent=float(point.tangent[-1]),
        residual=point.shot.residual,
    )
