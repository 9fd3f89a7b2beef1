"""Payloads, their motions that no mount resists, and probable modelling errors.

A payload is a body that mounts carry, with everything that stands on it or is joined to it by equality constraints. On one
mount, or on mounts in line, it turns about them. Axes without a law, a strange gravity, masses far away and masses in other
units can be simulated, and are warned of.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
import scipy

from wirerope_mj.engine.statics.linear import dry_friction, soft_equalities
from wirerope_mj.engine.system import System, mount_rates, once_per_system
from wirerope_mj.engine.system.equalities import equality_rows, free_motions, jacobian
from wirerope_mj.foundation.arrays import Array, Integers
from wirerope_mj.foundation.units import STANDARD_GRAVITY, UNITS, significant

_MOVES = 1e-9  # rate of a deflection per unit of the payload's velocity below which it is rounding
# relative distance from standard gravity that no place on the earth reaches: the poles are 0.26 % above it
_EARTH = 0.01
# reach of a payload: so many times the distance of its mounts, or of [m] where there is one; or twice its own geoms. A mast
# three times as high as its feet are apart is within; a millimetre taken for a metre is 1000 times beyond.
_REACH, _LEAST = 5.0, 0.3
# weight over the rated static load of all mounts together: mounts picked for what they carry are within; tonnes taken for
# kilograms are 1000 times below
_RATED = (0.02, 3.0)
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
    """Yield for each constraint or tendon that joins bodies which velocity coordinates move it, (n_v,)."""
    equal, limit = int(mujoco.mjtConstraint.mjCNSTR_EQUALITY), int(mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT)
    rates = np.abs(jacobian(model, data)) > _MOVES if model.neq or of_contacts else np.zeros((0, model.nv), dtype=bool)
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
    """Return the ids of the lowest bodies that move on their own, in model order."""
    model, fixed = system.model, {0, system.model.body(system.base).id} if system.base else {0}
    weld = model.body_weldid.tolist()
    return [
        body for body in range(1, model.nbody)
        if weld[body] not in fixed and weld[int(model.body_parentid[body])] in fixed
    ]  # fmt: skip


def _lowest(model: mujoco.MjModel, body: int, roots: list[int]) -> int:
    """Find the lowest body that carries a body; 0 if none does."""
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


def model_warnings(system: System, *, turned: bool = False) -> tuple[str, ...]:
    """Return a sentence on each probable modelling error, with its element and the remedy.

    `turned`: the direction of gravity is meant, as where a model falls onto another side than its bottom.
    """
    said = (
        *_axes_without_law(system),
        *_unusual_gravity(system, turned=turned),
        *_distant_masses(system),
        *_misrated_loads(system),
    )
    return (*said, *soft_equalities(system), *dry_friction(system))


def _axes_without_law(system: System) -> list[str]:
    """Return a warning for each isolator and axis without a law along which a payload can move."""
    model, data = system.model, mujoco.MjData(system.model)
    mujoco.mj_fwdPosition(model, data)
    free = np.delete(np.arange(model.nv), system.assembly.driven_dofs)
    rows = jacobian(model, data)[equality_rows(data)] if model.neq else np.zeros((0, model.nv))
    possible = np.eye(model.nv)[:, free] @ free_motions(rows[:, free])  # motions that joints and equality constraints leave
    motions = [rates @ possible for rates, _ in mount_rates(system, data)]
    lacking: dict[tuple[str, str], list[str]] = {}
    for mount, rates in zip(system.mounts.values(), motions, strict=True):
        device = mount.written
        for number, (axis, law) in enumerate(device.axes.items()):
            meant = law is not None or axis in device.free or device.is_stop
            if not meant and np.abs(mount.axes[:, number] @ rates).max(initial=0.0) > _MOVES:
                lacking.setdefault((mount.isolator_name, axis), []).append(mount.name)
    return [
        f"{'mounts' if names[1:] else 'mount'} {', '.join(names)} {'have' if names[1:] else 'has'} no law in {axis} (isolator "
        f"{isolator!r}): {'they do' if names[1:] else 'it does'} not resist motion in that axis, along which the payload can "
        f'move. Add the table [{axis}] to the isolator, or free = ["{axis}"] if that is meant.'
        for (isolator, axis), names in lacking.items()
    ]


def _unusual_gravity(system: System, *, turned: bool) -> list[str]:
    """Return a warning of a gravity that is not the earth's, downwards along z, in m/s^2."""
    gravity = system.model.opt.gravity
    size = float(np.linalg.norm(gravity))
    written = f'<option gravity="{" ".join(f"{value:g}" for value in gravity)}">'
    remedy = f'Standard gravity is gravity="0 0 -{STANDARD_GRAVITY}".'
    if size == 0.0:
        return [f"{written}: there is no gravity, so that nothing has weight and no mount sags. {remedy}"]
    if abs(size / (1e3 * STANDARD_GRAVITY) - 1.0) <= _EARTH:
        return [f"{written}: gravity is that of the earth in mm/s^2, and must be in m/s^2. {remedy}"]
    said = []
    if abs(size / STANDARD_GRAVITY - 1.0) > _EARTH:
        said.append(f"gravity is {size / STANDARD_GRAVITY:.4g} times the earth's")
    if gravity[2] > 0.5 * size and not turned:
        said.append("gravity points upwards, and the payload hangs on its mounts towards the sky")
    return [f"{written}: {' and '.join(said)}. {remedy}"] if said else []


def _distant_masses(system: System) -> list[str]:
    """Return a warning for each body whose centre of mass or inertia is far beyond its mounts and its own geoms."""
    model, data = system.model, mujoco.MjData(system.model)
    mujoco.mj_kinematics(model, data)
    places = np.array([mount.position for mount in system.mounts.values()])
    apart = float(np.linalg.norm(np.ptp(places, axis=0)))
    said = []
    for payload in movers_of(system):
        geoms = np.isin(model.geom_bodyid, payload.bodies) & (model.geom_rbound > 0.0)  # planes have no end, and a bound of 0
        distances = np.linalg.norm(data.geom_xpos[geoms] - places.mean(axis=0), axis=1)
        extent = float((distances + model.geom_rbound[geoms]).max(initial=0.0))
        reach = max(_REACH * max(apart, _LEAST), 2.0 * extent)
        for body in payload.bodies:
            mass, name = float(model.body_mass[body]), model.body(body).name
            if mass <= 0.0:
                continue
            away = float(np.linalg.norm(places - data.xipos[body], axis=1).min())
            radius = float(np.sqrt(model.body_inertia[body].max() / mass))
            if away > reach:
                x, y, z = data.xipos[body]
                said.append(
                    f"body {name!r}: its centre of mass at ({x:.4g}, {y:.4g}, {z:.4g}) m is {away:.4g} m from the nearest "
                    f"mount, and the mounts are {apart:.3g} m apart: is `pos` of its <inertial>, or of its geoms, in mm?"
                )
            if radius > reach:
                said.append(
                    f"body {name!r}: its moment of inertia of {model.body_inertia[body].max():.4g} kg m^2 at {mass:.6g} kg is "
                    f"a radius of gyration of {radius:.4g} m, and the mounts are {apart:.3g} m apart: is the inertia of its "
                    "<inertial> in kg mm^2?"
                )
    return said


def _misrated_loads(system: System) -> list[str]:
    """Return a warning for each payload whose weight is far from the rated loads of its mounts."""
    said, payloads, model = [], payloads_of(system), system.model
    mounts = [
        (mount.isolator.limits.static_load, model.body(mount.payload_body).id, model.body(mount.base_body).id)
        for mount in system.mounts.values() if not mount.isolator.is_stop
    ]  # fmt: skip
    for payload in payloads:
        carried = [payload]
        for lower in carried:  # and what stands on it, on mounts of its own
            above = {body for _, body, base in mounts if base in lower.bodies}
            carried += [payload for payload in payloads if payload not in carried and not above.isdisjoint(payload.bodies)]
        rated = [load for load, body, _ in mounts if body in payload.bodies]
        mass, total = sum(payload.mass for payload in carried), sum(filter(None, rated))
        if None in rated or not rated or _RATED[0] <= (used := mass * STANDARD_GRAVITY / total) <= _RATED[1]:
            continue
        slips = [unit for unit, size in UNITS["mass"].items() if _RATED[0] <= used * size <= _RATED[1]]
        said.append(
            f"body {payload.name!r}: the {mass:.6g} kg on its mounts weigh {significant(100.0 * used, 2)} % of the "
            f"{significant(total)} N that these are rated for together: "
            + (f"is its mass in {' or '.join(slips)}?" if slips else "are its mass in kg, and the ratings in N?")
        )
    return said


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
    """Return the mounts that carry a body, or one that is attached to it."""
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
