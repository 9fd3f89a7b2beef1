"""What a model says that can be simulated, but is perhaps not meant: axes without a law, gravity, masses far away."""

import mujoco
import numpy as np
import scipy

from wirerope_mj.engine.statics.payloads import Payload, movers_of
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY

_MOVES = 1e-9  # rate of a deflection per unit of the payload's velocity below which it is rounding

# relative distance from standard gravity that no place on the earth reaches: the poles are 0.26 % above it
_EARTH = 0.01

# reach of a payload: so many times the distance of its mounts, or of [m] where there is one; or twice its own geoms. A mast
# three times as high as its feet are apart is within; a millimetre taken for a metre is 1000 times beyond.
_REACH, _LEAST = 5.0, 0.3


def model_warnings(system: System) -> tuple[str, ...]:
    """Return a sentence on each thing in a model that is perhaps not meant, with its element and the remedy."""
    return (*_lawless(system), *_gravity(system), *_masses(system))


def _lawless(system: System) -> list[str]:
    """Return a sentence for each isolator and axis without a law along which a payload can move."""
    motions = _possible_motions(system)
    lacking: dict[tuple[str, str], list[str]] = {}
    for mount, rates in zip(system.mounts.values(), motions, strict=True):
        device = mount.written
        for number, (axis, law) in enumerate(device.axes.items()):
            meant = law is not None or axis in device.free or device.is_stop
            if not meant and np.abs(mount.axes[:, number] @ rates).max(initial=0.0) > _MOVES:
                lacking.setdefault((mount.isolator_name, axis), []).append(mount.name)
    return [_without_law(isolator, axis, names) for (isolator, axis), names in lacking.items()]


def _without_law(isolator: str, axis: str, names: list[str]) -> str:
    one = len(names) == 1
    return (
        f"{'mount' if one else 'mounts'} {', '.join(names)} {'has' if one else 'have'} no law in {axis} "
        f"(isolator {isolator!r}): {'it does' if one else 'they do'} not resist motion in that axis, along which the payload "
        f'can move. Add the table [{axis}] to the isolator, or free = ["{axis}"] if that is meant.'
    )


def _possible_motions(system: System) -> list[Array]:
    """Return the rates of the mounts' deflections by the motions that joints and equality constraints leave, (3, n) each."""
    model, data = system.model, mujoco.MjData(system.model)
    mujoco.mj_fwdPosition(model, data)
    free = np.delete(np.arange(model.nv), system.assembly.driven_dofs)
    motions = np.eye(model.nv)[:, free]
    equal = data.efc_type[: data.nefc] == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    if equal.any() and not mujoco.mj_isSparse(model):
        constrained = data.efc_J.reshape(data.nefc, model.nv)[equal][:, free]
        motions = motions @ scipy.linalg.null_space(constrained, rcond=1e-9)
    found = []
    for sites in system.assembly.tables.sites:
        rates, unused = np.zeros((2, 3, model.nv)), np.zeros((3, model.nv))
        for site, rate in zip(sites, rates, strict=True):
            mujoco.mj_jac(model, data, rate, unused, data.site_xpos[sites[0]], int(model.site_bodyid[site]))
        found.append((rates[0] - rates[1]) @ motions)
    return found


def _gravity(system: System) -> list[str]:
    """Return a sentence on a gravity that is not the earth's, downwards along z, in m/s^2."""
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
    if gravity[2] > 0.5 * size:
        said.append("gravity points upwards, and the payload hangs on its mounts towards the sky")
    return [f"{written}: {' and '.join(said)}. {remedy}"] if said else []


def _masses(system: System) -> list[str]:
    """Return a sentence on each body whose centre of mass or inertia is far beyond its mounts and its own geoms."""
    model, data = system.model, mujoco.MjData(system.model)
    mujoco.mj_kinematics(model, data)
    places = np.array([mount.position for mount in system.mounts.values()])
    apart = float(np.linalg.norm(np.ptp(places, axis=0)))
    said = []
    for payload in movers_of(system):
        reach = max(_REACH * max(apart, _LEAST), 2.0 * _extent(model, data, payload, places.mean(axis=0)))
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


def _extent(model: mujoco.MjModel, data: mujoco.MjData, payload: Payload, centre: Array) -> float:
    """Return how far the geoms of a payload reach from the middle of the mounts [m]; 0 without geoms."""
    own = np.isin(model.geom_bodyid, payload.bodies) & (model.geom_rbound > 0.0)  # planes have no end, and a bound of 0
    if not own.any():
        return 0.0
    return float((np.linalg.norm(data.geom_xpos[own] - centre, axis=1) + model.geom_rbound[own]).max())
