"""Equilibrium of a system: deflections and forces of its mounts, and the state to start from."""

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from wirerope_mj.engine.control.state import STATE
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State
from wirerope_mj.foundation.summary import Summarised, quantity

History = Literal["virgin", "relaxed"]
HISTORIES: tuple[History, History] = ("virgin", "relaxed")


@dataclass(frozen=True, kw_only=True)
class MountLoad:
    """Deflection [m] and force [N] of a mount in its axes roll, shear, axial, (3,)."""

    deflection: Array
    force: Array


@dataclass(frozen=True, kw_only=True, repr=False)
class Equilibrium(Summarised):
    """Equilibrium of a system under its weight.

    Attributes:
        state: integration state to start a simulation from.
        mounts: deflection and force of every mount.
        history: "virgin" (gravity applied slowly to the unloaded mounts) or "relaxed" (z = 0 throughout, after long
            vibration has let the hysteretic part of the load leak away).
        residual: largest acceleration left [m/s^2 or rad/s^2].
        free: a message about the motions of each body that no mount, joint or stop resists, such as the rotation of a body on
            mounts that stand in line.
    """

    state: State
    mounts: dict[str, MountLoad]
    history: History
    residual: float
    free: tuple[str, ...] = ()

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {
            name: f"axial {quantity(mount.deflection[2], 'm')}, {quantity(mount.force[2], 'N')}"
            for name, mount in self.mounts.items()
        }
        return f"Equilibrium, {self.history}: largest acceleration left {self.residual:.1e} m/s^2", lines


def forces_at_rest(system: System, state: State) -> Array:
    """Return the forces of all mounts in an equilibrium's state, roll, shear, axial [N], (n_mounts, 3).

    The state holds them, since the callback's memory is part of it: nothing is computed.
    """
    assembly, memory = system.assembly, np.empty(system.model.nuserdata)
    mujoco.mj_extractState(system.model, state.values, STATE, memory, mujoco.mjtState.mjSTATE_USERDATA)
    return assembly.tables.user.mount_rows(assembly.user(memory))[:, 1]
