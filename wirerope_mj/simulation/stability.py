"""How fast a system's own motion is, from its mounts' tangents, and the step that RK4 can take of it."""

import mujoco
import numpy as np
import numpy.typing as npt

from wirerope_mj.system import System

RK4_LIMIT = 2.7
"""RK4 is stable for |lambda| h < 2.785 on the negative real axis and 2.828 on the imaginary one; a little less is used."""


SLOWEST_RATE = 1.0
"""Angular frequency [rad/s] below which a mode is no oscillation on mounts, but a body that hangs or slides freely."""


def _as_modelled(system: System) -> mujoco.MjData:
    data = mujoco.MjData(system.model)
    mujoco.mj_fwdPosition(system.model, data)
    return data


def _mount_matrices(system: System, data: mujoco.MjData) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return stiffness [N/m, ...] and damping of all mounts in MuJoCo's velocity coordinates, (n_v, n_v) each.

    Stiffness is that of the unloaded mounts in the modelled geometry, damping the laws' largest.
    """
    model, rows, stiffness, damping = system.model, [np.zeros((0, system.model.nv))], [], []
    payload, base, unused = np.zeros((3, model.nv)), np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for mount in system.mounts.values():
        site = model.site(mount.payload_site)
        point = data.site_xpos[site.id]
        mujoco.mj_jac(model, data, payload, unused, point, site.bodyid[0])
        mujoco.mj_jac(model, data, base, unused, point, model.site(mount.base_site).bodyid[0])
        rows.append(mount.axes.T @ (payload - base))  # of the deflections, (3, n_v)
        for law in mount.isolator.axes.values():
            stiffness.append(law.initial_stiffness if law is not None else 0.0)
            damping.append(law.damping_coefficient if law is not None else 0.0)
    to_deflections = np.concatenate(rows)
    along, resisting = (to_deflections.T * np.array(numbers) @ to_deflections for numbers in (stiffness, damping))
    return along, resisting


def eigenvalues(system: System) -> npt.NDArray[np.complex128]:
    """Return the eigenvalues [1/s] of the linear system of unloaded mounts without the driven base, (2 n,)."""
    model, data = system.model, _as_modelled(system)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    free = np.setdiff1d(np.arange(model.nv), system.assembly.driven_dofs)
    stiffness, damping = (matrix[np.ix_(free, free)] for matrix in _mount_matrices(system, data))
    inverse = np.linalg.inv(mass[np.ix_(free, free)])
    zero, one = np.zeros_like(inverse), np.eye(free.size)
    return np.linalg.eigvals(np.block([[zero, one], [-inverse @ stiffness, -inverse @ damping]]))


def stable_step(system: System) -> float:
    """Return the largest step [s] with which RK4 is stable on the unloaded mounts."""
    laws = [law for mount in system.mounts.values() for law in mount.isolator.axes.values() if law is not None]
    decay = max((law.relaxation_rate for law in laws), default=0.0)
    fastest = max(float(np.abs(eigenvalues(system)).max(initial=0.0)), decay)
    return RK4_LIMIT / fastest if fastest > 0.0 else np.inf


def slowest_period(system: System) -> float:
    """Return the period of the slowest mode [s] for small amplitudes of the unloaded mounts, 1 s if nothing oscillates."""
    rates = np.abs(eigenvalues(system).imag)
    moving = rates[rates > SLOWEST_RATE]
    return float(2.0 * np.pi / moving.min()) if moving.size else 1.0
