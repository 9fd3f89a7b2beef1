"""Centres of mass of bodies as the compiled model has them, and the axes in which they are given."""

import mujoco
import numpy as np

from wirerope_mj.engine.system.system import System
from wirerope_mj.foundation.arrays import Array


def centre_of_mass(system: System, body: str) -> Array:
    """Return the centre of mass of a body in its own axes, from its own origin [m], (3,).

    It is what `<inertial pos="...">` says in the model; without one, what MuJoCo makes of the body's geoms. Bodies that are
    fixed to this one are bodies of their own and do not count.
    """
    return np.array(system.model.body(body).ipos, dtype=np.float64)


def body_axes(system: System, body: str) -> Array:
    """Return the axes of a body in the modelled geometry as the columns of a rotation, (3, 3): world = axes @ own."""
    with system.assembly.scratch.data(system.model) as data:
        mujoco.mj_kinematics(system.model, data)
        return np.array(data.body(body).xmat, dtype=np.float64).reshape(3, 3)


def is_aligned(system: System, body: str) -> bool:
    """Return whether MuJoCo has moved the body's origin into its centre of mass (`align` of its free joint, `alignfree`).

    Then its centre of mass is at 0 in the compiled model, wherever the model as written has it.
    """
    spec = mujoco.MjSpec.from_file(str(system.path)) if system.path else mujoco.MjSpec.from_string(system.mjcf)
    written = spec.body(body)
    if written is None:  # it has its name from us
        return False
    auto, yes = mujoco.mjtAlignFree.mjALIGNFREE_AUTO, mujoco.mjtAlignFree.mjALIGNFREE_TRUE
    free = [joint for joint in written.joints if joint.type == mujoco.mjtJoint.mjJNT_FREE]
    return any(joint.align == yes or (joint.align == auto and spec.compiler.alignfree) for joint in free)
