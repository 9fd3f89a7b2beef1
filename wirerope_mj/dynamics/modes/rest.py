"""Linearisation of a system at rest, motions of its payloads in a mode, and the shares of its strain energy."""

from dataclasses import dataclass

import mujoco
import numpy as np
import scipy

from wirerope_mj.dynamics.modes.mount import MountAtRest
from wirerope_mj.dynamics.modes.result import Modes, PayloadShape
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import righting_torque
from wirerope_mj.engine.statics import Equilibrium
from wirerope_mj.engine.statics.linear import STEP, beyond_joints, smooth_slopes
from wirerope_mj.engine.statics.payloads import Payload, carriers, movers_of, payloads_of
from wirerope_mj.engine.system import System, mount_rates, shapes_at
from wirerope_mj.engine.system.equalities import equality_rows, free_motions, jacobian
from wirerope_mj.foundation.arrays import Array, Integers

STATE = mujoco.mjtState.mjSTATE_INTEGRATION
NAMED = 0.15  # fraction of the kinetic energy from which a component of the motion is named
# Fraction of the model's mass, or of the kinetic energy, below which a part of it is rounding.
_ROUNDING = 1e-9
SHARES = ("mounts", "deck", "equipment")
_LIMIT = int(mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT)
_CONTACT, _PYRAMIDAL = (
    int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS), int(mujoco.mjtConstraint.mjCNSTR_CONTACT_PYRAMIDAL),
)  # fmt: skip
_SPRUNG = (mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE)
_TRANSLATIONS = ("sway x", "sway y", "bounce z")
_ROTATIONS = ("rocking about x", "rocking about y", "yaw about z")


@dataclass(frozen=True, kw_only=True)
class AtRest:
    """A system at rest in its free velocity coordinates; the base does not move."""

    free: Integers  # indices of the free ones among MuJoCo's velocity coordinates, (n,)
    mass: Array  # mass matrix, with what contacts and limits at rest add, (n, n)
    # stiffness besides the mounts' tangents: springs, contacts and limits, and the mounts' rotational stiffness, (n, n)
    other: Array
    # stiffness that weight, the mounts' preload and forces of constraints add, -W h of a centre of mass above its mounts
    # included, (n, n)
    weight: Array
    damping: Array  # of joints, tendons, actuators, contacts and limits, (n, n)
    motions: Array  # motions that equality constraints allow, as columns, (n, n_modes); the unit matrix without constraints
    pressed: "Pressed"  # contacts and limits that act at rest
    mounts: dict[str, MountAtRest]  # mounts by name
    data: mujoco.MjData  # MuJoCo's data in that state


@dataclass(frozen=True, kw_only=True)
class Pressed:
    """Mass, damping and stiffness of contacts and limits that act at rest, by MuJoCo's force on a constraint.

    force = -D (J a + b J v + k I d) with the jacobian J, acceleration a, velocity v, depth d; D, b, k and I are MuJoCo's.
    """

    names: tuple[str, ...]  # of those given by a time constant, which stand for rigid contact and not for springs
    rows: Array  # J of the named ones, (n_rows, n)
    mass: Array  # of all, (n, n)
    damping: Array  # of all, (n, n)
    stiffness: Array  # of all, (n, n)


def linearise(system: System, equilibrium: Equilibrium) -> AtRest:
    """Linearise `system` about `equilibrium`, the mounts' laws left out; equality constraints are rigid."""
    model = system.model.__copy__()
    model.actuator_dynprm[-1, 0] = 0.0  # the callback no longer knows the model: forces are put on it here
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS  # dry friction of joints has no stiffness
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, equilibrium.state.values, STATE)
    data.xfrc_applied[:] = 0.0  # the mounts' forces, which `_forward_at_rest` applies
    mujoco.mj_fwdPosition(model, data)
    free = np.setdiff1d(np.arange(model.nv), system.assembly.driven_dofs)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    mass = mass[np.ix_(free, free)]
    loaded = _stiffness_at_rest(system, data, equilibrium, free)
    pressed, mounts, first = _contacts_at_rest(model, data, free), {}, system.assembly.activation
    for (name, mount), (moves, _) in zip(system.mounts.items(), mount_rates(system, data), strict=True):
        axes = data.site(mount.base_site).xmat.reshape(3, 3)
        roll, shear, axial = (data.act[first + part.start : first + part.stop].copy() for part in mount.states)
        mounts[name] = MountAtRest(
            isolator=mount.isolator, deflection=equilibrium.mounts[name].deflection, states=(roll, shear, axial),
            jacobian=axes.T @ moves[:, free],
        )  # fmt: skip
    motions = free_motions(jacobian(model, data)[np.ix_(equality_rows(data), free)]) if model.neq else np.eye(free.size)
    damping = np.diag(model.dof_damping)
    gravity = model.opt.gravity.copy()
    model.opt.gravity[:] = 0.0
    other = _stiffness_at_rest(system, data, None, free)
    if beyond_joints(model):
        slopes = mujoco.MjData(model)
        slopes.qpos[:] = data.qpos
        _, damping = smooth_slopes(model, slopes)
    model.opt.gravity[:] = gravity
    _forward_at_rest(system, data, equilibrium)
    return AtRest(
        free=free, mass=mass + pressed.mass, other=other + pressed.stiffness, weight=loaded - other,
        damping=damping[np.ix_(free, free)] + pressed.damping, motions=motions, pressed=pressed, mounts=mounts, data=data,
    )  # fmt: skip


def _forward_at_rest(system: System, data: mujoco.MjData, equilibrium: Equilibrium | None) -> None:
    """Compute MuJoCo's forces in the position of `data`, the base fixed, with the mounts' forces at rest (None: without them).

    The mounts' forces are turned with their axes; torques are those of this position.
    """
    model, tables = data.model, system.assembly.tables
    rows = tables.rows(at.MOUNTS, at.MOUNT_COLUMNS, tables.user.n_mounts)
    data.qvel[:] = 0.0
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    data.qfrc_applied[:] = 0.0
    for (name, mount), row in zip(system.mounts.items(), rows, strict=True):
        if mount.isolator.rotation is None and (equilibrium is None or not equilibrium.mounts[name].force.any()):
            continue
        base, payload = int(row[at.BASE_SITE]), int(row[at.PAYLOAD_SITE])
        axes = data.site_xmat[base].reshape(3, 3)
        force = axes @ equilibrium.mounts[name].force if equilibrium is not None else np.zeros(3)
        modelled, stiffness = row[at.MODELLED : at.PARTNER], row[at.TURNING : at.MODELLED]
        torque = axes @ np.array(righting_torque(data.site_xquat[base], data.site_xquat[payload], modelled, stiffness))
        for site, push, turn in ((payload, -force, torque), (base, force, -torque)):
            mujoco.mj_applyFT(model, data, push, turn, data.site_xpos[payload], model.site_bodyid[site], data.qfrc_applied)
            for dof, shape in shapes_at(system, site):
                data.qfrc_applied[dof] += shape @ data.site_xmat[site].reshape(3, 3).T @ push
    driven = system.assembly.driven_dofs
    data.qfrc_applied[driven] = data.qfrc_bias[driven] - data.qfrc_passive[driven]
    mujoco.mj_forward(model, data)


def _stiffness_at_rest(system: System, data: mujoco.MjData, equilibrium: Equilibrium | None, free: Integers) -> Array:
    """Differentiate -force by q, (n, n), with mount forces that are constant in the mounts' axes (None: without forces).

    Forces of constraints are constant along their own directions, too. Torques of mounts that resist turning follow the
    motion, as joint springs do.

    Generalised forces are differentiated, not M times accelerations: without weight a loaded joint spring accelerates its
    body, and the change of the mass matrix with position would appear as stiffness.
    """
    model, rest = data.model, data.qpos.copy()
    _forward_at_rest(system, data, equilibrium)
    contacts, constraint_forces = (data.efc_type.tolist(), data.efc_id.tolist()), data.efc_force.copy()
    at_rest = data.qfrc_constraint.copy()

    def forces(dof: int, step: float) -> Array:
        """Compute the generalised forces, (n,), after a step of one coordinate."""
        velocity, along = np.zeros(model.nv), np.zeros(model.nv)
        velocity[dof] = step
        data.qpos[:] = rest
        mujoco.mj_integratePos(model, data.qpos, velocity, 1.0)
        _forward_at_rest(system, data, equilibrium)
        if equilibrium is not None and constraint_forces.size:
            if (data.efc_type.tolist(), data.efc_id.tolist()) == contacts:
                mujoco.mj_mulJacTVec(model, data, along, constraint_forces)
            else:  # points of contact appear and vanish
                along = at_rest
        return np.asarray((data.qfrc_smooth + along)[free])

    columns = [(forces(int(dof), STEP) - forces(int(dof), -STEP)) / (2.0 * STEP) for dof in free]
    data.qpos[:] = rest
    _forward_at_rest(system, data, equilibrium)
    stiffness = -np.stack(columns, axis=1)
    return np.asarray(0.5 * (stiffness + stiffness.T))


def _contacts_at_rest(model: mujoco.MjModel, data: mujoco.MjData, free: Integers) -> Pressed:
    """Compute the mass, damping and stiffness of the contacts and limits that act at rest."""
    kinds, acts = data.efc_type, data.efc_state
    held = (kinds >= _LIMIT) & (acts != int(mujoco.mjtConstraintState.mjCNSTRSTATE_SATISFIED))
    rates = jacobian(model, data)[:, free] if held.any() else np.zeros((data.nefc, free.size))
    moves, names, soft = rates.copy(), dict[str, None](), np.zeros(data.nefc, dtype=bool)  # moves: derivatives of the depth d
    for row in np.flatnonzero(held).tolist():
        number = int(data.efc_id[row])
        if kinds[row] < _CONTACT:
            limit = (model.joint, model.jnt_solref) if kinds[row] == _LIMIT else (model.tendon, model.tendon_solref_lim)
            name, reference = f"limit of {limit[0](number).name!r}", limit[1][number, 0]
        else:
            contact = data.contact[number]
            ends = (model.geom(int(geom)) for geom in contact.geom)
            name = "contact of " + " and ".join(repr(end.name or model.body(int(end.bodyid[0])).name) for end in ends)
            reference, first = contact.solref[0], contact.efc_address
            if kinds[row] == _PYRAMIDAL:
                moves[row] = rates[first : first + 2 * (contact.dim - 1)].mean(axis=0)  # edges lean either way of the normal
            elif row != first:
                moves[row] = 0.0  # friction
        if reference > 0.0:
            names[name], soft[row] = None, True
    k, b, impedance, slope = data.efc_KBIP.T
    weights = np.where(held, data.efc_D, 0.0)
    # D = I / (1 - I) / A grows with the depth d as the impedance I does
    deeper = slope * (data.efc_pos - data.efc_margin) * (1.0 + 1.0 / (1.0 - impedance))
    stiffness = rates.T * (weights * k * (impedance + deeper)) @ moves
    return Pressed(
        names=tuple(names), rows=rates[soft], mass=rates.T * weights @ rates, damping=rates.T * (weights * b) @ rates,
        stiffness=0.5 * (stiffness + stiffness.T),
    )  # fmt: skip


def held_rigidly(rest: AtRest, stiffness: Array) -> Array:
    """Compute the frequencies [Hz] with all contacts and limits at rest taken as rigid, (n,)."""
    motions = rest.motions @ free_motions(rest.pressed.rows @ rest.motions)
    parts = (motions.T @ part @ motions for part in (stiffness - rest.pressed.stiffness, rest.mass - rest.pressed.mass))
    return np.asarray(np.sqrt(np.maximum(scipy.linalg.eigvalsh(*parts), 0.0)) / (2.0 * np.pi))


def payload_shapes(system: System, rest: AtRest, shapes: Array) -> dict[str, PayloadShape]:
    """Compute the motion of every payload in the shapes (n, n_modes)."""
    result = {}
    for payload in payloads_of(system):
        centre, turn = _payload_jacobians(system.model, rest, payload)
        result[payload.name] = PayloadShape(
            centre=payload.centre(rest.data, system.model.body_subtreemass), mass=payload.mass,
            inertia=np.diag(_payload_inertia(system.model, rest, payload)).copy(),
            translation=(centre @ shapes).T, rotation=(turn @ shapes).T,
        )  # fmt: skip
    return result


def participation_of(system: System, rest: AtRest, shapes: Array) -> tuple[Array, Array]:
    """Compute effective modal mass fractions along x, y, z, (n_modes, 3), and the moving mass along them [kg], (3,).

    With f = M r the inertia forces of a unit acceleration of the base, (phi^T f)^2 / (phi^T M phi m), where the moving mass
    m = f^T M^-1 f is that of all motions that joints allow: of a free body its mass, of a guided one zero across its guide.
    """
    model = system.model
    force = np.zeros((rest.free.size, 3))
    for mover in movers_of(system):
        for body in mover.bodies:
            force += model.body_mass[body] * _jacobians(model, rest, body)[0].T
    for mode in system.assembly.subjects.modes:
        force[rest.free == mode.dof] += mode.participation
    modal = np.einsum("nj,nk,kj->j", shapes, rest.mass, shapes)
    left = rest.motions.T @ force
    moving = np.einsum("na,na->a", left, np.linalg.solve(rest.motions.T @ rest.mass @ rest.motions, left))
    effective = (shapes.T @ force) ** 2 / modal[:, None]
    with_mass = moving > _ROUNDING * model.body_mass.sum()
    return np.where(with_mass, effective / np.where(with_mass, moving, 1.0), 0.0), np.where(with_mass, moving, 0.0)


def description_of(system: System, rest: AtRest, shape: Array) -> str:
    """Name the motions of payloads that hold most of the kinetic energy of a mode shape (n,), largest first.

    A body's motion relative to its payload, taken as rigid with its lowest body, is named, too.
    """
    model = system.model
    energy = float(shape @ rest.mass @ shape)
    movers = movers_of(system)
    ratios: list[tuple[float, str]] = []
    for payload in movers:
        velocity, turn = (jacobian @ shape for jacobian in _payload_jacobians(model, rest, payload))
        prefix = f"{payload.name}: " if len(movers) > 1 else ""
        ratios += [(payload.mass * v * v / energy, prefix + w) for v, w in zip(velocity, _TRANSLATIONS, strict=True)]
        spin = turn * (_payload_inertia(model, rest, payload) @ turn) / energy
        ratios += [(float(part), prefix + w) for part, w in zip(spin, _ROTATIONS, strict=True)]
        centre = payload.centre(rest.data, model.body_subtreemass)
        for body in payload.bodies:
            moved, turned = (jacobian @ shape for jacobian in _jacobians(model, rest, body))
            along = moved - velocity - np.cross(turn, rest.data.xipos[body] - centre)
            about = turned - turn
            inner = model.body_mass[body] * along @ along + about @ _body_inertia(rest.data, model, body) @ about
            if model.body_weldid[body] != payload.root and inner > _ROUNDING * energy:
                ratios.append((float(inner) / energy, f"{model.body(body).name} on {payload.name}"))
    for mode in system.assembly.subjects.modes:
        name = model.body(mode.body).name.split("mode/")[-1].replace("/", " bends in its mode ")
        ratios.append((float(np.sum(shape[rest.free == mode.dof] ** 2)) / energy, name))
    ratios.sort(reverse=True)
    return " + ".join([description for ratio, description in ratios if ratio >= NAMED] or [ratios[0][1]])


def _payload_jacobians(model: mujoco.MjModel, rest: AtRest, payload: Payload) -> tuple[Array, Array]:
    """Compute a payload's jacobians, (3, n) each: velocity of its centre of mass, and angular velocity of its root body."""
    centre, part = np.zeros((2, 3, model.nv))
    for root in (payload.root, *payload.joined):
        mujoco.mj_jacSubtreeCom(model, rest.data, part, root)
        centre += part * (model.body_subtreemass[root] / payload.mass if payload.joined else 1.0)
    return centre[:, rest.free], _jacobians(model, rest, payload.root)[1]


def _jacobians(model: mujoco.MjModel, rest: AtRest, body: int) -> tuple[Array, Array]:
    """Compute a body's jacobians, (3, n) each: velocity of its centre of mass, and angular velocity, by free coordinates."""
    centre, turn = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jacBodyCom(model, rest.data, centre, turn, body)
    return centre[:, rest.free], turn[:, rest.free]


def _body_inertia(data: mujoco.MjData, model: mujoco.MjModel, body: int) -> Array:
    """Compute a body's inertia about its centre of mass, world axes [kg m^2], (3, 3)."""
    axes = data.ximat[body].reshape(3, 3)
    return np.asarray(axes @ np.diag(model.body_inertia[body]) @ axes.T)


def _payload_inertia(model: mujoco.MjModel, rest: AtRest, payload: Payload) -> Array:
    """Compute a payload's inertia about its centre of mass, world axes [kg m^2], (3, 3)."""
    data, total = rest.data, np.zeros((3, 3))
    centre = payload.centre(data, model.body_subtreemass)
    for body in payload.bodies:
        arm = data.xipos[body] - centre
        steiner = model.body_mass[body] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        total += _body_inertia(data, model, body) + steiner
    return total


def strain_energy(system: System, modes: Modes) -> Array | None:
    """Compute the shares of mounts, deck and equipment in the strain energy of each mode, (n_modes, 3); None without springs.

    The share of a spring on a coordinate q is k q^2 over the whole, omega^2 phi^T M phi; mounts have the rest, with weight and
    contacts. Springs between base and mounts belong to the deck; shares are NaN for modes without a frequency.
    """
    model, base = system.model, system.base
    part_by_dof = {mode.dof: mode.part for mode in system.assembly.subjects.modes}
    springs = np.zeros((modes.frequencies.size, 2))
    for joint in range(model.njnt):
        dof, stiffness = int(model.jnt_dofadr[joint]), float(model.jnt_stiffness[joint])
        if stiffness > 0.0 and mujoco.mjtJoint(model.jnt_type[joint]) in _SPRUNG and dof in modes.free:
            parents = {model.body(body).name for body in carriers(model, int(model.jnt_bodyid[joint]))}
            deck = part_by_dof[dof] == base if dof in part_by_dof else base in parents
            springs[:, 0 if deck else 1] += stiffness * modes.shapes[dof] ** 2
    if not springs.any():
        return None
    free = modes.shapes[modes.free]
    total = (2.0 * np.pi * modes.frequencies) ** 2 * np.einsum("nj,nk,kj->j", free, modes.mass, free)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(total > 0.0, springs.T / total, np.nan).T
    return np.column_stack([1.0 - shares.sum(axis=1), shares])
