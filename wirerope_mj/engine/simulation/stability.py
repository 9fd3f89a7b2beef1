"""Rates of a system's own motion from its mounts' tangents, and the step with which RK4 is stable."""

import mujoco
import numpy as np
import numpy.typing as npt

from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.engine.system.tables import turning
from wirerope_mj.foundation.arrays import Array

# RK4 is stable for |lambda| h < 2.785 on the negative real axis and 2.828 on the imaginary one; a little less is used
RK4_LIMIT = 2.7


# angular frequency [rad/s] below which a mode is no oscillation on mounts, but a body that hangs or slides freely
SLOWEST_RATE = 1.0


def _mount_matrices(system: System, data: mujoco.MjData, closed: bool) -> tuple[Array, Array]:
    """Return stiffness [N/m, ...] and damping of all mounts in MuJoCo's velocity coordinates, (n_v, n_v) each.

    Stiffness is that of the unloaded mounts in the modelled geometry, with stops open or closed, damping the laws' largest.
    """
    model, rows, stiffness, damping = system.model, [np.zeros((0, system.model.nv))], [], []
    payload, base, turn, base_turn = (np.zeros((3, model.nv)) for _ in range(4))
    for mount, (site, base_site) in zip(system.mounts.values(), system.assembly.tables.sites, strict=True):
        point = data.site_xpos[site]
        mujoco.mj_jac(model, data, payload, turn, point, model.site_bodyid[site])
        mujoco.mj_jac(model, data, base, base_turn, point, model.site_bodyid[base_site])
        rows.append(mount.axes.T @ (payload - base))  # of the deflections, (3, n_v)
        for law in mount.isolator.axes.values():
            if law is None:
                stiffness.append(0.0)
                damping.append(0.0)
                continue
            stiffness.append(law.closed_stiffness if closed else law.initial_stiffness)
            damping.append(law.closed_damping if closed else law.damping_coefficient)
        if mount.isolator.rotation is not None:
            rows.append(mount.axes.T @ (turn - base_turn))  # of the turns
            stiffness += turning(mount.isolator)
            damping += [0.0] * 3
    to_deflections = np.concatenate(rows)
    along, resisting = (to_deflections.T * np.array(numbers) @ to_deflections for numbers in (stiffness, damping))
    return along, resisting


def eigenvalues(system: System, *, closed: bool = False) -> npt.NDArray[np.complex128]:
    """Return the eigenvalues [1/s] of the linear system of unloaded mounts without the driven base, (2 n,).

    `closed`: as if all stops were closed.
    """
    model = system.model
    mass = np.zeros((model.nv, model.nv))
    with system.assembly.scratch.data(model) as data:
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fullM(model, data, mass)
        matrices = _mount_matrices(system, data, closed)
    moves = np.ones(model.nv, dtype=bool)
    moves[system.assembly.driven_dofs] = False
    free = np.flatnonzero(moves)
    stiffness, damping = (matrix[np.ix_(free, free)] for matrix in matrices)
    inverse, n = np.linalg.inv(mass[np.ix_(free, free)]), free.size
    rates = np.zeros((2 * n, 2 * n))  # of displacements and velocities
    rates[:n, n:] = np.eye(n)
    rates[n:, :n], rates[n:, n:] = -inverse @ stiffness, -inverse @ damping
    return np.asarray(np.linalg.eigvals(rates), dtype=np.complex128)


@once_per_system
def stable_step(system: System) -> float:
    """Return the largest step [s] with which RK4 is stable on the unloaded mounts and on all stops."""
    laws = [law for mount in system.mounts.values() for law in mount.isolator.axes.values() if law is not None]
    decay = max((law.relaxation_rate for law in laws), default=0.0)
    fastest = max(float(np.abs(eigenvalues(system, closed=True)).max(initial=0.0)), decay)
    return RK4_LIMIT / fastest if fastest > 0.0 else np.inf


def slowest_period(system: System) -> float:
    """Return the period of the slowest mode [s] for small amplitudes of the unloaded mounts, 1 s if nothing oscillates."""
    rates = np.abs(eigenvalues(system).imag)
    moving = rates[rates > SLOWEST_RATE]
    return float(2.0 * np.pi / moving.min()) if moving.size else 1.0
