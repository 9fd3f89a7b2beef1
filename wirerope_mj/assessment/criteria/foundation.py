"""Force on the foundation: what all mounts together exert on the base."""

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.rotation import rotation_matrices


def foundation_force(response: Response) -> Array:
    """Return the sum of the mounts' forces on what carries them, weight included [N], world axes, (n_t, 3).

    A mount pulls its payload by minus R F and its base by R F, with R the axes of the base site, see
    `wirerope_mj.engine.control.mounts`; those whose base moves by itself, such as a frame between two stages, are left out.
    """
    scene = response.scene
    bodies = {body.name: body for body in scene.bodies}
    total = np.zeros((response.time.size, 3))
    for mount in scene.mounts:
        body = bodies.get(mount.base_body)  # None: the world
        if body is None or body.on_base or not body.moves:
            axes = mount.axes if body is None else rotation_matrices(body.orientation) @ mount.axes
            total += response.mounts[mount.name].force @ axes.T
    return total
