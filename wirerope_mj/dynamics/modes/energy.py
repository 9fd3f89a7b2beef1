"""Strain energy of modes, shared between mounts, a deck that bends, and equipment that does."""

import mujoco
import numpy as np

from wirerope_mj.dynamics.modes.result import Modes
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array

SHARES = ("mounts", "deck", "equipment")
_SPRUNG = (mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE)


def strain_energy(system: System, modes: Modes) -> Array | None:
    """Compute the shares of `SHARES` in the strain energy of each mode, (n_modes, 3); None where mounts alone are elastic.

    Of a spring on a coordinate q it is k q^2 over omega^2 phi^T M phi, which is all of it; mounts have the rest, with what
    weight and contacts do. What stands between base and mounts is deck; NaN of modes that do not swing.
    """
    model, base = system.model, system.base
    of_part = {mode.dof: mode.part for mode in system.assembly.subjects.modes}
    springs = np.zeros((modes.frequencies.size, 2))
    for joint in range(model.njnt):
        dof, stiffness = int(model.jnt_dofadr[joint]), float(model.jnt_stiffness[joint])
        if stiffness > 0.0 and mujoco.mjtJoint(model.jnt_type[joint]) in _SPRUNG and dof in modes.free:
            body, parents = int(model.jnt_bodyid[joint]), set[str]()
            while body > 0:
                parents.add(model.body(body).name)
                body = int(model.body_parentid[body])
            deck = of_part[dof] == base if dof in of_part else base in parents
            springs[:, 0 if deck else 1] += stiffness * modes.shapes[dof] ** 2
    if not springs.any():
        return None
    free = modes.shapes[modes.free]
    total = (2.0 * np.pi * modes.frequencies) ** 2 * np.einsum("nj,nk,kj->j", free, modes.mass, free)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(total > 0.0, springs.T / total, np.nan).T
    return np.column_stack([1.0 - shares.sum(axis=1), shares])
