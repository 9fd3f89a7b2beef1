"""A room in which equipment and its mounts must stay: the clearances that it leaves the payload's points."""

import math

import numpy as np

from wirerope_mj.engine.statics.payloads import point_positions
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import SIDES, PayloadLimit
from wirerope_mj.studies.measures import payload_points

NO_ROOM = "it does not fit into the room"
LEAST_ROOM = 1e-6  # of a point that stands at a wall [m]: a clearance of zero would not be judged


def limits_in_room(system: System, room: Array) -> tuple[PayloadLimit, ...]:
    """Return the system's limits with clearances that keep the payload's points off the walls of a room, (3,) [m].

    The ends of the mounts on the base's side stand at the walls; where mounts stand at neither or at both of two opposite
    walls, the equipment stands in the middle between them. Clearances that are stated already hold where they are smaller.

    ModelError if the equipment and its mounts at rest are larger than the room, or the payload has no points.
    """
    kept = payload_points(system)
    points = {name: position for name, position in point_positions(system).items() if name in kept}
    if not points:
        raise ModelError("the model has no points to keep in a `--room`: give it sites called point/NAME.")
    mounts = [mount for mount in system.mounts.values() if not mount.isolator.is_stop]
    heights = [mount.isolator.geometry.height if mount.isolator.geometry else None for mount in mounts]
    bars = np.array([mount.position - 0.5 * (h or 0.0) * mount.axes[:, 2] for mount, h in zip(mounts, heights, strict=True)])
    corners = np.array(list(points.values()))
    low, high = corners.min(axis=0), corners.max(axis=0)
    before, behind = np.maximum(low - bars.min(axis=0), 0.0), np.maximum(bars.max(axis=0) - high, 0.0)
    rest = room - (high - low) - before - behind
    if lacking := [axis for axis, clearance in zip("xyz", rest, strict=True) if clearance < 0.0]:
        raise ModelError(f"{NO_ROOM} along {' and '.join(lacking)}, even at rest")
    alone = (before > 0.0) == (behind > 0.0)
    under = before + np.where(alone, 0.5 * rest, np.where(before > 0.0, 0.0, rest))
    over = behind + np.where(alone, 0.5 * rest, np.where(before > 0.0, rest, 0.0))
    stated = {limit.name: limit.ways for limit in system.limits if limit.kind == "clearance" and limit.name in points}
    limits = {(limit.kind, limit.name): limit for limit in system.limits}
    for name, position in points.items():
        walls = np.column_stack([position - low + under, high - position + over]).ravel()
        least = [min(wall, stated.get(name, {}).get(side, math.inf)) for side, wall in zip(SIDES, walls, strict=True)]
        values = tuple(max(float(value), LEAST_ROOM) for value in least)
        limits["clearance", name] = PayloadLimit(kind="clearance", name=name, values=values)
    return tuple(limits.values())
