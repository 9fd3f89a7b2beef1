"""Force on the foundation: what the mounts exert on the base, all together, on each area of the deck, and on their bolts."""

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from wirerope_mj.engine.response import Response, Scene
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices


def foundation_force(response: Response, names: Collection[str] | None = None) -> Array:
    """Sum the mounts' forces on what carries them, weight included [N], world axes, (n_t, 3); of all or of some.

    A mount pulls its payload by minus R F and its base by R F, with R the axes of the base site, see
    `wirerope_mj.engine.control.mounts`; those whose base moves by itself, such as a frame between two stages, are left out.
    """
    bodies = {body.name: body for body in response.scene.bodies}
    total = np.zeros((response.time.size, 3))
    for mount in standing(response.scene):
        if names is None or mount.name in names:
            body = bodies.get(mount.base_body)  # None: the world
            axes = mount.axes if body is None else rotation_matrices(body.orientation) @ mount.axes
            total += response.mounts[mount.name].force @ axes.T
    return total


def standing(scene: Scene) -> list[SceneMount]:
    """List the mounts that stand on the base or on the world, not on what moves by itself."""
    moving = {body.name for body in scene.bodies if body.moves and not body.on_base}
    return [mount for mount in scene.mounts if mount.base_body not in moving]


@dataclass(frozen=True, kw_only=True)
class AreaForce:
    """Loads of the mounts on an area of the deck, the largest over all samples."""

    name: str  # of the area; "" for all mounts together
    mounts: int  # number of mounts that stand on it
    at_rest: float  # downward force at the first sample [N]
    # down, up, across: largest force downwards, upwards and level, >= 0 [N]
    down: float
    # down_time, up_time, across_time: their instants [s]
    down_time: float
    up: float
    up_time: float
    across: float
    across_time: float


def area_forces(response: Response) -> list[AreaForce]:
    """Find the largest forces of all mounts and of those of each area on the deck; contacts of geoms are not among them."""
    time, on_deck = response.time, [mount.name for mount in standing(response.scene)]
    areas: dict[str, Collection[str]] = {"": on_deck, **response.scene.areas}
    loads = []
    for name, mounts in areas.items():
        force = foundation_force(response, mounts)
        across = np.hypot(force[:, 0], force[:, 1])
        low, high, side = int(force[:, 2].argmin()), int(force[:, 2].argmax()), int(across.argmax())
        loads.append(
            AreaForce(
                name=name, mounts=len(set(mounts) & set(on_deck)), at_rest=float(-force[0, 2]),
                down=max(float(-force[low, 2]), 0.0), down_time=float(time[low]),
                up=max(float(force[high, 2]), 0.0), up_time=float(time[high]),
                across=float(across[side]), across_time=float(time[side]),
            )
        )  # fmt: skip
    return loads


@dataclass(frozen=True, kw_only=True)
class BoltLoad:
    """Largest loads of a bolt on the base side of a mount, over the samples: tension and shear [N], and their instants [s]."""

    mount: str
    bolts: int
    tension: float
    tension_time: float
    shear: float
    shear_time: float


def bolt_loads(response: Response) -> list[BoltLoad]:
    """Compute the loads of the bolts of every mount whose isolator says how many it has, the largest tension first.

    The plate is rigid. A bolt has its share of the axial tension and of the force across. That acts at half the height: its
    moment pulls the bolts of one side by F h / 2 over their distance, shared by half of them; a line of bolts bears none about
    itself, where the plate's edges do. Prying and preload are left out.
    """
    loads = []
    for mount in response.scene.mounts:
        number, *apart = mount.bolts
        if math.isnan(number):
            continue
        force = response.mounts[mount.name].force
        height = mount.height if math.isfinite(mount.height) else 0.0
        tension = force[:, 2] / number
        for axis, distance in enumerate(apart):
            if number > 1 and math.isfinite(distance):
                tension = tension + np.abs(force[:, axis]) * 0.5 * height / (distance * 0.5 * number)
        shear = np.hypot(force[:, 0], force[:, 1]) / number
        top, side = int(tension.argmax()), int(shear.argmax())
        loads.append(
            BoltLoad(
                mount=mount.name, bolts=int(number), tension=max(float(tension[top]), 0.0),
                tension_time=float(response.time[top]), shear=float(shear[side]), shear_time=float(response.time[side]),
            )
        )  # fmt: skip
    return sorted(loads, key=lambda load: -load.tension)
