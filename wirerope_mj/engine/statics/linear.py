"""A linear system about the modelled geometry: unloaded mounts, its own springs and dampers, what constraints leave of it."""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
import scipy

from wirerope_mj.engine.system import System, mount_rates, once_per_system
from wirerope_mj.engine.system.equalities import equality_name, equality_rows, free_motions, jacobian
from wirerope_mj.engine.system.tables import rotational_stiffness
from wirerope_mj.foundation.arrays import Array, Integers

# Step [m, rad, m/s or rad/s] of central differences: their error and that of rounding are both near 1e-9 of the stiffness.
STEP = 1e-6
GIVES_WAY = 0.01  # change of a natural frequency from which a constraint of MuJoCo's is not rigid
_SLOWEST = 1.0  # angular frequency [rad/s] below which nothing swings


@dataclass(frozen=True, kw_only=True)
class Linear:
    """A system without its driven base, in the free velocity coordinates."""

    mass: Array  # (n, n)
    stiffness: Array  # (n, n)
    damping: Array  # (n, n)
    motions: Array  # those that equality constraints leave, as columns, (n, n_left)
    equalities: Integers  # which constraint each row is of, (n_rows,)
    rows: Array  # rates of the equality constraints, (n_rows, n)
    # reference of MuJoCo's constraints, force = -weight (rows a + damping rate + stiffness error), (3, n_rows)
    soft: Array

    @property
    def fastest_constraint(self) -> float:
        """Largest rate at which MuJoCo restores an equality constraint [1/s], 0 without any."""
        _, b, k = self.soft
        return float(np.abs(0.5 * b + np.sqrt((0.25 * b * b - k).astype(np.complex128))).max(initial=0.0))


def linear_system(system: System, *, closed: bool) -> Linear:
    """Linearise a system in the modelled geometry with its stops open or closed; damping is the laws' largest."""
    model = system.model
    mass = np.zeros((model.nv, model.nv))
    free = np.delete(np.arange(model.nv), system.assembly.driven_dofs)
    with system.assembly.scratch.data(model) as data:
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fullM(model, data, mass)
        if beyond_joints(model):
            weightless = model.__copy__()
            weightless.actuator_dynprm[-1, 0] = 0.0  # callbacks that are installed no longer know it: its mounts do not act
            weightless.opt.gravity[:] = 0.0
            besides = smooth_slopes(weightless, mujoco.MjData(weightless))
        else:
            single = model.jnt_type[model.dof_jntid] >= int(mujoco.mjtJoint.mjJNT_SLIDE)
            springs = np.where(single, model.jnt_stiffness[model.dof_jntid], 0.0)
            besides = np.diag(springs), np.diag(model.dof_damping)
        rates: list[Array] = [np.zeros((0, system.model.nv))]
        resistances: list[tuple[float, float]] = []
        for mount, (moves, turns) in zip(system.mounts.values(), mount_rates(system, data), strict=True):
            rates.append(mount.axes.T @ moves)  # of the deflections, (3, n_v)
            for law in mount.isolator.axes.values():
                if law is None:
                    resistances.append((0.0, 0.0))
                elif closed:
                    resistances.append((law.closed_stiffness, law.closed_damping))
                else:
                    resistances.append((law.initial_stiffness, law.damping_coefficient))
            if mount.isolator.rotation is not None:
                rates.append(mount.axes.T @ turns)
                resistances += [(stiffness, 0.0) for stiffness in rotational_stiffness(mount.isolator)]
        to_deflections = np.concatenate(rates)
        along, resisting = (to_deflections.T * row @ to_deflections for row in np.array(resistances).reshape(-1, 2).T)
        matrices = zip((along, resisting), besides, strict=True)
        stiffness, damping = ((mounts + of_joints)[np.ix_(free, free)] for mounts, of_joints in matrices)
        numbers = equality_rows(data) if model.neq else np.zeros(0, dtype=np.int64)
        rows = jacobian(model, data)[np.ix_(numbers, free)] if numbers.size else np.zeros((0, free.size))
        k, b, impedance, _ = data.efc_KBIP[numbers].T
        soft = np.array([data.efc_D[numbers], b, impedance * k])
        equalities = data.efc_id[numbers].copy()
    return Linear(
        mass=mass[np.ix_(free, free)], stiffness=stiffness, damping=damping, motions=free_motions(rows), equalities=equalities,
        rows=rows, soft=soft,
    )  # fmt: skip


def beyond_joints(model: mujoco.MjModel) -> bool:
    """Tell whether tendons, other actuators or polynomial joint forces act besides linear joint springs and dampers."""
    return bool(model.ntendon or model.nu > 1 or model.nflex or model.jnt_stiffnesspoly.any() or model.dof_dampingpoly.any())


def smooth_slopes(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Array, Array]:
    """Compute stiffness and damping at rest of all forces except of mounts and constraints, (n_v, n_v) each."""
    rest = data.qpos.copy()

    def forces(unit: Array, moves: float, rates: float) -> Array:
        data.qpos[:] = rest
        mujoco.mj_integratePos(model, data.qpos, moves * unit, 1.0)
        data.qvel[:] = rates * unit
        mujoco.mj_forward(model, data)
        return data.qfrc_smooth.copy()

    slopes = [
        [(forces(unit, -a * STEP, -b * STEP) - forces(unit, a * STEP, b * STEP)) / (2.0 * STEP) for unit in np.eye(model.nv)]
        for a, b in ((1.0, 0.0), (0.0, 1.0))
    ]
    data.qpos[:], data.qvel[:] = rest, 0.0
    stiffness, damping = np.array(slopes)
    return 0.5 * (stiffness + stiffness.T), 0.5 * (damping + damping.T)


@once_per_system
def soft_equalities(system: System) -> tuple[str, ...]:
    """Return a sentence on equality constraints that yield in a simulation, with the natural frequency that this changes."""
    if not system.model.neq:
        return ()
    linear = linear_system(system, closed=False)
    weight, _, stiffness = linear.soft
    rigid, shapes = _natural_modes(linear.motions, linear.stiffness, linear.mass)
    sentences = []
    for number in dict.fromkeys(linear.equalities.tolist()):
        of_it = linear.equalities == number
        motions, rows = free_motions(linear.rows[~of_it]), linear.rows[of_it]  # this one soft, and rigid what else there is
        added, stiff = ((rows.T * w) @ rows for w in (weight[of_it], (weight * stiffness)[of_it]))
        soft, soft_shapes = _natural_modes(motions, linear.stiffness + stiff, linear.mass + added)
        if not rigid.size or not soft.size:
            continue
        moved = soft[np.argmax((shapes.T @ linear.mass @ soft_shapes) ** 2, axis=1)]  # each in the shape most like it
        mode = int(np.argmax(np.abs(np.log(moved / rigid))))
        if abs(moved[mode] / rigid[mode] - 1.0) > GIVES_WAY:
            sentences.append(
                f"{equality_name(system.model, number)} is rigid in modes and statics, and gives way in a simulation: the "
                f'natural frequency of {rigid[mode]:.4g} Hz is {moved[mode]:.4g} Hz there. Write solimp="0.9999 0.9999" into '
                "it, or make one body of what it joins."
            )
    return tuple(sentences)


def _natural_modes(motions: Array, stiffness: Array, mass: Array) -> tuple[Array, Array]:
    """Compute the natural frequencies [Hz] within the subspace `motions`, ascending, and the mode shapes as columns."""
    if not motions.shape[1]:
        return np.zeros(0), motions
    values, shapes = scipy.linalg.eigh(*(motions.T @ part @ motions for part in (stiffness, mass)))
    swings = values > _SLOWEST**2
    return np.sqrt(values[swings]) / (2.0 * np.pi), motions @ shapes[:, swings]


def dry_friction(system: System) -> Iterator[str]:
    """Yield a sentence on dry friction in joints and tendons, which modes and statics leave out."""
    model = system.model
    dofs = np.flatnonzero(model.dof_frictionloss > 0.0)
    names = dict.fromkeys(f"joint {model.joint(int(joint)).name!r}" for joint in model.dof_jntid[dofs])
    names |= dict.fromkeys(f"tendon {model.tendon(int(t)).name!r}" for t in np.flatnonzero(model.tendon_frictionloss > 0.0))
    if names:
        yield (
            f"{', '.join(names)}: `frictionloss` acts in a simulation alone. Modes and statics are of what slides without it; "
            "where it sticks, what it holds moves as one. Leave the joint away for the modes of what is held."
        )
