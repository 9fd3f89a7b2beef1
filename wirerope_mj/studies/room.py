"""A room in which equipment and its mounts must stay: the clearances that it leaves the payload's points."""

import math
from itertools import product

import numpy as np

from wirerope_mj.engine.statics.payloads import point_positions
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import SIDES, PayloadLimit
from wirerope_mj.mounts.isolator import Geometry
from wirerope_mj.studies.measures import payload_points

NO_ROOM = "it does not fit into the room"
LEAST_ROOM = 1e-6  # of a point that stands at a wall [m]: a clearance of zero would not be judged


def limits_in_room(system: System, room: Array) -> tuple[PayloadLimit, ...]:
    """Return the system's limits with clearances that keep the payload's points off the walls of a room, (3,) [m].

    Mounts are boxes of the height and width that their isolators state, turned as they stand; along their bars, of which no
    length is stated, they reach as far as their bolts. What they have on the payload's side sways with it. The mounts stand at
    the walls on their base's side; where they do so at neither or at both of two opposite walls, everything is in the middle
    between them. Clearances that are stated already hold where they are smaller.

    ModelError if the equipment and its mounts at rest are larger than the room, or the payload has no points.
    """
    kept = payload_points(system)
    points = {name: position for name, position in point_positions(system).items() if name in kept}
    if not points:
        raise ModelError("the model has no points to keep in a `--room`: give it sites called point/NAME.")
    mounts = [mount for mount in system.mounts.values() if not mount.isolator.is_stop]
    sizes = [mount.isolator.geometry or Geometry() for mount in mounts]
    halves = [0.5 * np.array([size.width or 0.0, size.bolts_along_shear or 0.0, size.height or 0.0]) for size in sizes]
    corners = np.array(
        [
            [mount.position + mount.axes @ (half * signs) for signs in product((-1, 1), repeat=3)]
            for mount, half in zip(mounts, halves, strict=True)
        ]
    )  # (n, 8, 3); on the base's side, then on the payload's, in turn
    bars = np.array([mount.position - half[2] * mount.axes[:, 2] for mount, half in zip(mounts, halves, strict=True)])
    equipment, held = np.array(list(points.values())), corners[:, 1::2].reshape(-1, 3)
    low, high = equipment.min(axis=0), equipment.max(axis=0)
    lowest, highest = np.minimum(low, corners.min(axis=(0, 1))), np.maximum(high, corners.max(axis=(0, 1)))
    rest = room - (highest - lowest)
    if lacking := [axis for axis, clearance in zip("xyz", rest, strict=True) if clearance < 0.0]:
        raise ModelError(f"{NO_ROOM} along {' and '.join(lacking)}, even at rest")
    below, above = bars.min(axis=0) < low, bars.max(axis=0) > high
    wall = lowest - rest * np.where(below == above, 0.5, np.where(below, 0.0, 1.0))
    under = np.minimum(low, held.min(axis=0)) - wall
    over = wall + room - np.maximum(high, held.max(axis=0))
    stated = {limit.name: limit.ways for limit in system.limits if limit.kind == "clearance" and limit.name in points}
    limits = {(limit.kind, limit.name): limit for limit in system.limits}
    for name, position in points.items():
        walls = np.column_stack([position - low + under, high - position + over]).ravel()
        least = [min(wall, stated.get(name, {}).get(side, math.inf)) for side, wall in zip(SIDES, walls, strict=True)]
        values = tuple(max(float(value), LEAST_ROOM) for value in least)
        limits["clearance", name] = PayloadLimit(kind="clearance", name=name, values=values)
    return tuple(limits.values())
