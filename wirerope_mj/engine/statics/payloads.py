"""Payloads, and their motions that no mount resists.

A payload is a body that mounts carry, with everything that stands on it or is joined to it by equality constraints. On one
mount, or on mounts in line, it turns about them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
import scipy

from wirerope_mj.engine.system import System, mount_rates, once_per_system
from wirerope_mj.engine.system.equalities import jacobian
from wirerope_mj.foundation.arrays import Array, Integers

MOVES = 1e-9  # rate of a deflection per unit of the payload's velocity below which it is rounding
# turn of the differences [rad]: rounding of accelerations, 1e-14 m/s^2, and their curvature both leave less than `SLOW`
TURN = 1e-5
SLOW = 1e-4  # rate of return below which a motion is free [1/s^2]: a pendulum of 100 km


@dataclass(frozen=True, kw_only=True)
class Payload:
    """A payload."""

    name: str  # of its lowest body, the first that moves on its own
    root: int  # id of that body
    bodies: tuple[int, ...]  # ids of all that stand on it or are joined to it, itself included
    mass: float  # of all of them [kg]
    joined: tuple[int, ...] = ()  # ids of the lowest bodies of what is joined to it, and does not stand on it

    def centre(self, data: mujoco.MjData, masses: Array) -> Array:
        """Compute the payload's centre of mass in `data` [m], (3,), from the masses of all subtrees [kg]."""
        if not self.joined:
            return data.subtree_com[self.root].copy()
        roots = [self.root, *self.joined]
        return np.asarray(masses[roots] @ data.subtree_com[roots] / self.mass)


def movers_of(system: System) -> tuple[Payload, ...]:
    """Return the payloads, then the other bodies that move on their own, such as a frame below the mounts."""
    model, payloads = system.model, payloads_of(system)
    known = {body for payload in payloads for body in payload.bodies}
    known |= {mode.body for mode in system.assembly.subjects.modes}
    return payloads + tuple(_payload(model, [root]) for root in _roots(system) if root not in known)


def point_positions(system: System) -> dict[str, Array]:
    """Compute the positions of a system's points in the modelled geometry, world frame [m], (3,) by name."""
    subjects = system.assembly.subjects
    with system.assembly.scratch.data(system.model) as data:
        mujoco.mj_kinematics(system.model, data)
        return {name: data.site_xpos[site].copy() for name, site in zip(subjects.point_names, subjects.points, strict=True)}


@once_per_system
def payloads_of(system: System) -> tuple[Payload, ...]:
    """Return the payloads of a system, in the order in which its mounts name them."""
    with system.assembly.scratch.data(system.model) as data:
        if system.model.neq:
            mujoco.mj_fwdPosition(system.model, data)
        return payloads_in(system, data, of_contacts=False)


def payloads_in(system: System, data: mujoco.MjData, *, of_contacts: bool = True) -> tuple[Payload, ...]:
    """Return the payloads in a position, with the bodies that equality constraints join to them.

    `of_contacts`: also with what presses on them, or hangs on them by a tendon or its limit, and is not carried otherwise.
    """
    model, roots = system.model, _roots(system)
    carriers_of_mounts = [_lowest(model, model.body(mount.payload_body).id, roots) for mount in system.mounts.values()]
    frames = {_lowest(model, model.body(mount.base_body).id, roots) for mount in system.mounts.values()}
    groups = {root: [root] for root in carriers_of_mounts}
    taken, joined = (
        {*groups, *frames},
        [
            {_lowest(model, int(model.dof_bodyid[dof]), roots) for dof in np.flatnonzero(row)} - {0}
            for row in _joined_coordinates(model, data, of_contacts=of_contacts)
        ],
    )
    grown = True
    while grown:
        grown = False
        for group in groups.values():
            for together in joined:
                if not together.isdisjoint(group) and (more := sorted(together - taken)):
                    group += more
                    taken.update(more)
                    grown = True
    return tuple(_payload(model, group) for group in groups.values())


def _joined_coordinates(model: mujoco.MjModel, data: mujoco.MjData, *, of_contacts: bool) -> Iterator[Array]:
    """Yield for each constraint or tendon that joins bodies a mask (n_v,) of the velocity coordinates that move it."""
    equal, limit = int(mujoco.mjtConstraint.mjCNSTR_EQUALITY), int(mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT)
    rates = np.abs(jacobian(model, data)) > MOVES if model.neq or of_contacts else np.zeros((0, model.nv), dtype=bool)
    for kind, number in dict.fromkeys(zip(data.efc_type.tolist(), data.efc_id.tolist(), strict=True)) if len(rates) else ():
        rows = (data.efc_type == kind) & (data.efc_id == number)
        if kind == equal or (of_contacts and kind >= limit and data.efc_force[rows].any()):
            yield rates[rows].any(axis=0)
    for tendon in np.flatnonzero(model.tendon_stiffness > 0.0) if of_contacts else ():
        first, size = int(model.ten_J_rowadr[tendon]), int(model.ten_J_rownnz[tendon])
        row = np.zeros(model.nv)
        row[model.ten_J_colind[first : first + size]] = data.ten_J[first : first + size]
        yield row


def _roots(system: System) -> list[int]:
    """Return the ids of bodies that move relative to base or world and stand directly on one of these, in model order."""
    model, fixed = system.model, {0, system.model.body(system.base).id} if system.base else {0}
    weld = model.body_weldid.tolist()
    return [
        body for body in range(1, model.nbody)
        if weld[body] not in fixed and weld[int(model.body_parentid[body])] in fixed
    ]  # fmt: skip


def _lowest(model: mujoco.MjModel, body: int, roots: list[int]) -> int:
    """Find which of the bodies `roots` carries a body; 0 if none does."""
    return next((carrier for carrier in carriers(model, body) if carrier in roots), 0)


def _payload(model: mujoco.MjModel, roots: list[int]) -> Payload:
    return Payload(
        name=model.body(roots[0]).name, root=roots[0], joined=tuple(roots[1:]),
        bodies=tuple(body for body in range(1, model.nbody) if not set(roots).isdisjoint(carriers(model, body))),
        mass=float(sum(model.body_subtreemass[root] for root in roots)),
    )  # fmt: skip


def carriers(model: mujoco.MjModel, body: int) -> Iterator[int]:
    """Yield a body and all bodies that carry it, downwards."""
    while body > 0:
        yield body
        body = int(model.body_parentid[body])


def unresisted(system: System, data: mujoco.MjData, free: Integers, accelerations: Callable[[Array], Array]) -> tuple[str, ...]:
    """Return a message for each motion of a body on mounts that no mount, joint, stop or weight resists.

    Mounts count as resisting in all three directions here: an axis without a law is the isolator's own property.
    `free` are the velocity coordinates that can move, (n,); `accelerations` returns theirs after a small step of them.
    """
    model = data.model
    jacobians = [rates[:, free] for rates, _ in mount_rates(system, data)]
    motions = scipy.linalg.null_space(np.concatenate(jacobians), rcond=1e-9)  # columns
    if not motions.size:
        return ()
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    mass = mass[np.ix_(free, free)]
    returns = np.stack([(accelerations(-TURN * m) - accelerations(TURN * m)) / (2.0 * TURN) for m in motions.T], axis=1)
    stiffness = motions.T @ mass @ returns
    if not np.isfinite(stiffness).all():
        return ()
    try:
        rates, shapes = scipy.linalg.eigh(0.5 * (stiffness + stiffness.T), motions.T @ mass @ motions)
    except np.linalg.LinAlgError:  # masses so far apart that rounding leaves nothing of the least
        return ()
    motions_of: dict[tuple[int, bool], list[str]] = {}
    for rate, shape in zip(rates, shapes.T, strict=True):
        if rate < SLOW:
            body, motion_text = _rotation(model, data, free, motions @ shape)
            if _mounts_below(system, body):  # what swings on a joint of its own alone was meant to
                motions_of.setdefault((body, rate < -SLOW), []).append(motion_text)
    return tuple(
        f"body {model.body(body).name!r} on {', '.join(map(repr, _mounts_below(system, body)))}: no mount, joint or stop "
        f"resists {'any rotation' if len(texts) == 3 else ' or '.join(sorted(texts))}; "
        f"{'its weight tips it over' if tips else 'it is free'}. Three mounts out of line hold a body, or a joint guides it."
        for (body, tips), texts in motions_of.items()
    )


def _mounts_below(system: System, body: int) -> list[str]:
    model, mounts = system.model, system.mounts.items()
    return [name for name, mount in mounts if body in carriers(model, model.body(mount.payload_body).id)]


def _rotation(model: mujoco.MjModel, data: mujoco.MjData, free: Integers, motion: Array) -> tuple[int, str]:
    """Return the body that moves most in a motion of the free coordinates, (n,), and describe the motion with its axis."""
    body = int(model.dof_bodyid[free[int(np.argmax(np.abs(motion)))]])
    turn, unused = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jacBody(model, data, unused, turn, body)
    about = turn[:, free] @ motion
    size = float(np.linalg.norm(about))
    if size < 1e-9:  # of a motion of unit mass
        return body, "a displacement"
    axis = about / size
    main = int(np.argmax(np.abs(axis)))
    if abs(axis[main]) > 0.999:  # within 2.6 degrees
        return body, f"a rotation about {'xyz'[main]}"
    return body, f"a rotation about ({', '.join(f'{value:.2f}' for value in axis * np.sign(axis[main]))})"
