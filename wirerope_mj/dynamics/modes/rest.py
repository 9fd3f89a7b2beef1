"""A system linearised where it rests: masses, what holds it besides its mounts, and how coordinates deflect the mounts."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.modes.mount import MountAtRest
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import righting_torque
from wirerope_mj.engine.statics import Equilibrium
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array

STEP = 1e-6
"""Step [m or rad] of central differences: their error and that of rounding are both near 1e-9 of the stiffness."""

STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@dataclass(frozen=True, kw_only=True)
class AtRest:
    """A system at rest in its free velocity coordinates; the base does not move.

    Attributes:
        free: which of MuJoCo's velocity coordinates these are, (n,).
        mass: mass matrix, (n, n).
        other: stiffness besides the mounts' tangents: joint springs, contacts and what the mounts resist turning with, (n, n).
        weight: stiffness that weight and the mounts' preload add, -W h of a centre of mass above its mounts included, (n, n).
        damping: of joints, (n, n).
        mounts: mounts by name.
        data: MuJoCo's data in that state.
    """

    free: npt.NDArray[np.int64]
    mass: Array
    other: Array
    weight: Array
    damping: Array
    mounts: dict[str, MountAtRest]
    data: mujoco.MjData


def linearise(system: System, equilibrium: Equilibrium) -> AtRest:
    """Return `system` linearised about `equilibrium`, laws aside."""
    model = system.model.__copy__()
    model.actuator_dynprm[-1, 0] = 0.0  # the callback no longer knows the model: forces are put on it here
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS  # dry friction of joints has no stiffness
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, equilibrium.state.values, STATE)
    data.xfrc_applied[:] = 0.0  # the mounts' forces, which `_push` applies
    mujoco.mj_fwdPosition(model, data)
    free = np.setdiff1d(np.arange(model.nv), system.assembly.driven_dofs)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    mass = mass[np.ix_(free, free)]
    loaded = _held(system, model, data, equilibrium, free)
    mounts = {name: _mount(system, model, data, equilibrium, name, free) for name in system.mounts}
    gravity = model.opt.gravity.copy()
    model.opt.gravity[:] = 0.0
    other = _held(system, model, data, None, free)
    model.opt.gravity[:] = gravity
    return AtRest(
        free=free,
        mass=mass,
        other=other,
        weight=loaded - other,
        damping=np.diag(model.dof_damping[free]),
        mounts=mounts,
        data=data,
    )


def _held(
    system: System,
    model: mujoco.MjModel,
    data: mujoco.MjData,
    equilibrium: Equilibrium | None,
    free: npt.NDArray[np.int64],
) -> Array:
    """Return -d(force)/dq with mount forces that stay as they are in the mounts' axes (None: without forces).

    Torques of mounts that resist turning follow the motion, as joint springs do.

    Generalised forces, not M times accelerations: without weight a loaded joint spring accelerates what it holds, and then
    the mass matrix, which changes with position, would pass for stiffness.
    """
    rest = data.qpos.copy()

    def forces(dof: int, step: float) -> Array:
        velocity = np.zeros(model.nv)
        velocity[dof] = step
        data.qpos[:] = rest
        mujoco.mj_integratePos(model, data.qpos, velocity, 1.0)
        data.qvel[:] = 0.0
        _push(system, model, data, equilibrium)
        mujoco.mj_forward(model, data)
        return np.asarray((data.qfrc_smooth + data.qfrc_constraint)[free])

    columns = [(forces(int(dof), STEP) - forces(int(dof), -STEP)) / (2.0 * STEP) for dof in free]
    data.qpos[:] = rest
    _push(system, model, data, equilibrium)
    mujoco.mj_forward(model, data)
    stiffness = -np.stack(columns, axis=1)
    return np.asarray(0.5 * (stiffness + stiffness.T))


def _push(system: System, model: mujoco.MjModel, data: mujoco.MjData, equilibrium: Equilibrium | None) -> None:
    """Apply the mounts' forces at rest, turned with their axes, their torques of this position, and hold the base."""
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    data.qfrc_applied[:] = 0.0
    layout = system.assembly.tables.layout
    for number, (name, mount) in enumerate(system.mounts.items()):
        if equilibrium is None and mount.isolator.rotation is None:
            continue
        axes = data.site(mount.base_site).xmat.reshape(3, 3)
        force = axes @ equilibrium.mounts[name].force if equilibrium is not None else np.zeros(3)
        row = int(layout[at.MOUNTS]) + at.MOUNT_COLUMNS * number
        torque = axes @ np.array(righting_torque(layout, row, data.site_xquat.reshape(-1)))
        point = data.site(mount.payload_site).xpos
        payload, base = (int(model.site(site).bodyid[0]) for site in (mount.payload_site, mount.base_site))
        mujoco.mj_applyFT(model, data, -force, torque, point, payload, data.qfrc_applied)
        mujoco.mj_applyFT(model, data, force, -torque, point, base, data.qfrc_applied)
    driven = system.assembly.driven_dofs
    data.qfrc_applied[driven] = data.qfrc_bias[driven] - data.qfrc_passive[driven]


def _mount(
    system: System,
    model: mujoco.MjModel,
    data: mujoco.MjData,
    equilibrium: Equilibrium,
    name: str,
    free: npt.NDArray[np.int64],
) -> MountAtRest:
    mount, load = system.mounts[name], equilibrium.mounts[name]
    point = data.site(mount.payload_site).xpos
    payload, base, unused = (np.zeros((3, model.nv)) for _ in range(3))
    mujoco.mj_jac(model, data, payload, unused, point, int(model.site(mount.payload_site).bodyid[0]))
    mujoco.mj_jac(model, data, base, unused, point, int(model.site(mount.base_site).bodyid[0]))
    axes = data.site(mount.base_site).xmat.reshape(3, 3)
    first = system.assembly.activation
    states = [data.act[first + part.start : first + part.stop].copy() for part in mount.states]
    return MountAtRest(
        isolator=mount.isolator,
        deflection=load.deflection,
        force=load.force,
        states=(states[0], states[1], states[2]),
        jacobian=axes.T @ (payload - base)[:, free],
    )
