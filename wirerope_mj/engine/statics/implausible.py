"""Probable modelling errors: axes without a law, a strange gravity, masses, points and mounts in other units or elsewhere.

All of it can be simulated, and is warned of. Where mounts and masses stand is looked at by `misplaced.py` beside this file.
"""

from collections.abc import Sequence
from difflib import get_close_matches
from xml.etree import ElementTree

import mujoco
import numpy as np

from wirerope_mj.engine.statics.linear import dry_friction, soft_equalities
from wirerope_mj.engine.statics.misplaced import misplaced_elements
from wirerope_mj.engine.statics.payloads import MOVES, movers_of, payloads_of, point_positions
from wirerope_mj.engine.system import System, mount_rates
from wirerope_mj.engine.system.declared import LIMIT
from wirerope_mj.engine.system.equalities import equality_rows, free_motions, jacobian
from wirerope_mj.foundation.payload_limits import KINDS, PayloadLimit
from wirerope_mj.foundation.units import STANDARD_GRAVITY, UNITS, significant
from wirerope_mj.mounts.isolator.implausible import isolator_warnings

# relative distance from standard gravity that no place on the earth reaches: the poles are 0.26 % above it
_EARTH = 0.01
# reach of a payload: so many times the distance of its mounts, or of [m] where there is one; or twice its own geoms. A mast
# three times as high as its feet are apart is within; a millimetre taken for a metre is 1000 times beyond.
_REACH, _LEAST = 5.0, 0.3
_LARGEST = 300.0  # distance of mounts [m] that no floor reaches: a cabinet's in mm are farther apart
# weight over the rated static load of all mounts together: mounts picked for a shock carry a fortieth, tonnes taken for
# kilograms are 1000 times below; at one and a half they rest far beyond what they are made for
_RATED = (0.02, 1.5)
_MOST = 0.8  # of a payload, that one of its many geoms weighs for its mass to be named
_NEWTONS = {"N": 1.0 / STANDARD_GRAVITY}  # a weight that is written for a mass, or ratings in kg


def model_warnings(system: System, *, turned: bool = False) -> tuple[str, ...]:
    """Return a sentence on each probable modelling error, with its element and the remedy.

    `turned`: the direction of gravity is meant, as where a model falls onto another side than its bottom.
    """
    devices = {mount.isolator_name: mount.written for mount in system.mounts.values()}
    said = (
        *_axes_without_law(system),
        *_unusual_gravity(system, turned=turned),
        *_misrated_loads(system),
        *limit_doubts(system, system.limits),
        *_misnamed_limits(system.model),
        *_braked_payloads(system),
        *(_distant_masses(system) or misplaced_elements(system)),
        *(text for device in devices.values() for text in isolator_warnings(device)),
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
            if not meant and np.abs(mount.axes[:, number] @ rates).max(initial=0.0) > MOVES:
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
    elif gravity[2] > -0.5 * size and not turned:  # no ship heels by 60 degrees
        said.append("gravity points sideways, and z is up in a model: turn the model's axes, or gravity")
    return [f"{written}: {' and '.join(said)}. {remedy}"] if said else []


def _distant_masses(system: System) -> list[str]:
    """Return a warning for each body whose centre of mass or inertia is far beyond its mounts and its own geoms."""
    model, data = system.model, mujoco.MjData(system.model)
    mujoco.mj_kinematics(model, data)
    places = np.array([mount.position for mount in system.mounts.values()])
    apart = float(np.linalg.norm(np.ptp(places, axis=0)))
    if apart > _LARGEST:
        return [f"mounts are up to {apart:.4g} m apart: are positions and sizes of the model in mm? They are in m."]
    said = []
    for name, point in point_positions(system).items():
        if (away := float(np.linalg.norm(places - point, axis=1).min())) > 100.0 * max(apart, _LEAST):
            said.append(
                f"point {name!r} is {away:.4g} m from the nearest mount, and the mounts are {apart:.3g} m apart: is its "
                "`pos` in mm?"
            )
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


def limit_doubts(system: System, limits: Sequence[PayloadLimit]) -> list[str]:
    """Return a question about the unit of each limit that nothing can need."""
    model = system.model
    mass = sum(float(model.body_subtreemass[model.body(name).id]) for name in system.payloads)
    mounts = sum(not mount.isolator.is_stop for mount in system.mounts.values())
    weight = mass * float(np.linalg.norm(model.opt.gravity)) / max(mounts, 1)
    return [f"limit {limit.kind}/{limit.name}: {doubt}" for limit in limits if (doubt := limit.doubt(weight))]


def _misnamed_limits(model: mujoco.MjModel) -> list[str]:
    """Return a warning of each number of a model that is probably meant as a limit."""
    names = [model.numeric(number).name for number in range(model.nnumeric)]
    return [
        f"numeric {name!r} limits nothing: a limit is called limit/KIND/NAME, KIND one of {', '.join(KINDS)}."
        for name in names if name.count("/") > 1 and LIMIT not in name and get_close_matches(name.split("/")[0] + "/", [LIMIT])
    ]  # fmt: skip


def _braked_payloads(system: System) -> list[str]:
    """Return a warning for each free payload whose joint has springs or dampers, which act between it and the still world."""
    model, said = system.model, []
    for payload in payloads_of(system):
        for joint in np.flatnonzero((model.jnt_bodyid == payload.root) & (model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)):
            dofs = slice(model.jnt_dofadr[joint], model.jnt_dofadr[joint] + 6)
            stated = {"damping": model.dof_damping[dofs].any(), "stiffness": bool(model.jnt_stiffness[joint])}
            for name in (name for name, there in stated.items() if there):
                said.append(
                    f"joint {model.joint(joint).name!r}: its `{name}` acts between {payload.name!r} and the world at rest, not "
                    "the moving base, so that it drags at the payload. Leave it out; mounts have their own."
                )
    return said


def _heaviest_geom(mjcf: str, mass: float) -> str:
    """Return the end of a sentence that names the one geom of a model's text that weighs most of a mass [kg], if one does."""
    try:
        geoms = list(ElementTree.fromstring(mjcf).iter("geom"))
    except ElementTree.ParseError:  # of a model that includes what stands elsewhere
        return ""
    weights = {geom.get("name", ""): float(geom.get("mass", "0")) for geom in geoms}
    name = max(weights, key=weights.__getitem__, default="")
    if len(weights) < 3 or not _MOST * mass < weights[name] <= mass:
        return ""
    return f" {weights[name]:.6g} kg of them are its geom {name!r} alone: is that in g?"


def _misrated_loads(system: System) -> list[str]:
    """Return a warning for each payload whose weight is far from the rated loads of its mounts."""
    said, payloads, model = [], payloads_of(system), system.model
    mounts = [
        (mount.isolator.limits.static_load, model.body(mount.payload_body).id, model.body(mount.base_body).id)
        for mount in system.mounts.values()
        if not mount.isolator.is_stop and not (mount.isolator.axial is None and abs(mount.axes[2, 2]) > 0.9)  # carries nothing
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
        units = {**UNITS["mass"], **_NEWTONS}
        slips = [unit for unit, size in units.items() if size != 1.0 and _RATED[0] <= used * size <= _RATED[1]]
        said.append(
            f"body {payload.name!r}: the {mass:.6g} kg on its mounts weigh {significant(100.0 * used, 2)} % of the "
            f"{significant(total)} N that these are rated for together: "
            + (f"is its mass in {' or '.join(slips)}, or " if slips else "is its mass in kg, or ")
            + "are the isolators others, or their ratings not in N?"
            + (_heaviest_geom(system.mjcf, mass) if used > _RATED[1] else "")
        )
    return said
