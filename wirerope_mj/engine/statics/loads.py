"""What mounts carry in a state at rest."""

import mujoco
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State


def forces_at_rest(system: System, state: State) -> Array:
    """Return the forces of all mounts in an equilibrium's state, roll, shear, axial [N], (n_mounts, 3).

    The state holds them, since the callback's memory is part of it: nothing is computed.
    """
    assembly = system.assembly
    memory = np.empty(system.model.nuserdata)
    mujoco.mj_extractState(
        system.model, state.values, mujoco.mjtState.mjSTATE_INTEGRATION, memory, mujoco.mjtState.mjSTATE_USERDATA
    )
    first, number = assembly.userdata + assembly.tables.user.mounts, len(system.mounts)
    return memory[first : first + at.MOUNT_VALUES * number].reshape(number, 2, 3)[:, 1]
