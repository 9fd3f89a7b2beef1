"""Sag and load of every mount, virgin and relaxed side by side, and whether the loads add up to the weight."""

from dataclasses import dataclass

import mujoco
import numpy as np

from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control.install import STATE
from wirerope_mj.engine.statics.find import equilibrium
from wirerope_mj.engine.statics.loading import HISTORIES, Equilibrium, History, MountLoad
from wirerope_mj.engine.statics.payloads import payloads_in
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.summary import Brief, json_values
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.travel import static_utilisation


@dataclass(frozen=True, kw_only=True)
class MountSag:
    """A mount under the weight that it carries."""

    deflection: Array  # roll, shear, axial [m], axial negative in compression, (3,)
    force: Array  # restoring force in the same axes [N], (3,)
    carries: float  # what it pushes the payload up with [N]
    # fraction of the weight of all payloads that this is; NaN without weight. Where payloads stand on payloads the lower
    # mounts carry those above as well, and the fractions add up to more than 1.
    split: float
    compression: float  # axial load [N]; 0 in tension
    static_load: float | None  # rated load in compression [N]; None = not judged
    # what bump stops in it push the payload up with [N], < 0 where they push it down; 0 for what stands on stops alone, as the
    # struck table of a shock machine does
    on_stops: float = 0.0
    stop: bool = False  # whether it is a stop, see `wirerope_mj.mounts.isolator.Isolator.is_stop`

    @property
    def utilisation(self) -> float | None:
        """Axial load over the rated static load; None = not judged: not rated, or no load in compression along the axis."""
        return static_utilisation(self.force, self.static_load)


@dataclass(frozen=True, kw_only=True)
class PayloadSag:
    """A payload in equilibrium, from the modelled geometry."""

    mass: float  # of all that stands on it [kg]
    centre: Array  # centre of mass in the modelled geometry [m], world frame, (3,)
    displacement: Array  # of the centre of mass [m], world frame, (3,)
    # of its lowest body, rotation vector [rad], world frame, (3,): tilt about x and y, and turn about z
    rotation: Array


@dataclass(frozen=True, kw_only=True, repr=False)
class Sag(Brief):
    """Equilibrium of a system after one history."""

    history: History  # "virgin" or "relaxed"
    mounts: dict[str, MountSag]  # by name
    payloads: dict[str, PayloadSag]
    weight: float  # of all payloads [N]
    on_mounts: float  # what the mounts between payload and base carry of it [N]
    on_contacts: float  # what contacts with base and surroundings carry [N]
    equilibrium: Equilibrium  # the equilibrium it was read from

    @property
    def listed(self) -> dict[str, MountSag]:
        """Mounts to be listed: all but stops that are open."""
        return {name: mount for name, mount in self.mounts.items() if not mount.stop or mount.force.any()}

    @property
    def elsewhere(self) -> float:
        """Weight carried by joints and their springs instead of mounts and contacts [N]; 0 for a free body."""
        return self.weight - self.on_mounts - self.on_contacts


@dataclass(frozen=True, kw_only=True, repr=False)
class StaticTable(Brief):
    """Sag of a system by history."""

    sags: dict[str, Sag]  # by history, those that exist
    missing: dict[str, str]  # why there is no other, by history

    @property
    def virgin(self) -> Sag | None:
        """Sag after gravity was applied slowly to the unloaded mounts; None if there is no such equilibrium."""
        return self.sags.get("virgin")

    @property
    def relaxed(self) -> Sag | None:
        """Sag after long vibration; None if there is no such equilibrium."""
        return self.sags.get("relaxed")

    def to_dict(self) -> Entries:
        """Return the table as plain values, SI."""
        plain: Entries = {
            history: {
                "weight_N": sag.weight,
                "on_mounts_N": sag.on_mounts,
                "on_contacts_N": sag.on_contacts,
                "elsewhere_N": sag.elsewhere,
                "mounts": {
                    name: {
                        "deflection_m": mount.deflection.tolist(), "force_N": mount.force.tolist(), "carries_N": mount.carries,
                        "share_of_weight": json_values(mount.split), "share_of_static_load": mount.utilisation,
                    }
                    for name, mount in sag.mounts.items()
                },
                "payloads": {
                    name: {
                        "mass_kg": payload.mass, "centre_of_mass_m": payload.centre.tolist(),
                        "displacement_m": payload.displacement.tolist(), "rotation_rad": payload.rotation.tolist(),
                    }
                    for name, payload in sag.payloads.items()
                },
            }
            for history, sag in self.sags.items()
        }  # fmt: skip
        return plain | {"missing": dict(self.missing)}


@once_per_system
def static_table(system: System) -> StaticTable:
    """Return sag and load of every mount and payload under gravity, virgin and relaxed.

    Raises:
        ConvergenceError: there is neither of the two equilibria.
    """
    sags: dict[str, Sag] = {}
    missing: dict[str, str] = {}
    for history in HISTORIES:
        try:
            sags[history] = at_rest(system, history)
        except ConvergenceError as error:
            missing[history] = str(error)
    if not sags:
        raise ConvergenceError(missing["virgin"])
    return StaticTable(sags=sags, missing=missing)


def at_rest(system: System, history: History = "virgin") -> Sag:
    """Return sag and load of every mount and payload at rest, "virgin" or "relaxed"; ConvergenceError without equilibrium."""
    result = equilibrium(system, history=history)
    model = system.model.__copy__()
    unloaded, data = mujoco.MjData(model), mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, unloaded)
    mujoco.mj_setState(model, data, result.state.values, STATE)
    with installed(model, data):
        mujoco.mj_forward(model, data)
    gravity = float(np.linalg.norm(model.opt.gravity))
    up = -model.opt.gravity / gravity if gravity else np.array([0.0, 0.0, 1.0])
    payloads, sagged = payloads_in(system, data), {}
    for payload in payloads:
        turn, root, centre = np.zeros(3), payload.root, payload.centre(unloaded, model.body_subtreemass)
        mujoco.mju_subQuat(turn, data.xquat[root], unloaded.xquat[root])  # in the body's axes as modelled
        sagged[payload.name] = PayloadSag(
            mass=payload.mass, centre=centre, displacement=payload.centre(data, model.body_subtreemass) - centre,
            rotation=unloaded.xmat[root].reshape(3, 3) @ turn,
        )  # fmt: skip
    carried = {body for payload in payloads for body in payload.bodies}
    weight = gravity * sum(payload.mass for payload in payloads)
    bodies = {name: model.body(mount.payload_body).id for name, mount in system.mounts.items()}
    feet = {bodies[name] for name, mount in system.mounts.items() if not mount.isolator.is_stop}
    isolated = {body for payload in payloads if feet & {*payload.bodies} for body in payload.bodies}
    mounts, on_mounts = {}, 0.0
    for name, mount in system.mounts.items():
        load = result.mounts[name]
        upwards = -up @ data.site(mount.base_site).xmat.reshape(3, 3)  # of forces in the mount's axes
        lift = float(upwards @ load.force)
        mounts[name] = MountSag(
            deflection=load.deflection, force=load.force, carries=lift, split=lift / weight if weight else np.nan,
            compression=max(-float(load.force[2]), 0.0), static_load=mount.isolator.limits.static_load,
            on_stops=float(upwards @ _on_stops(mount.isolator, load)) if bodies[name] in isolated else 0.0,
            stop=mount.isolator.is_stop,
        )  # fmt: skip
        on_mounts += 0.0 if model.body(mount.base_body).id in carried else lift  # else it stands on another payload
    on_contacts, force = 0.0, np.zeros(6)
    for number, contact in enumerate(data.contact):  # those between what is carried and what is not
        sides = [int(model.geom_bodyid[geom]) in carried for geom in contact.geom]
        if sides[0] == sides[1]:
            continue
        mujoco.mj_contactForce(model, data, number, force)
        on_second = contact.frame.reshape(3, 3).T @ force[:3]
        on_contacts += float(up @ on_second) * (1.0 if sides[1] else -1.0)
    return Sag(
        history=result.history, mounts=mounts, payloads=sagged, weight=weight, on_mounts=on_mounts,
        on_contacts=on_contacts, equilibrium=result,
    )  # fmt: skip


def _on_stops(isolator: Isolator, load: MountLoad) -> Array:
    """Compute the force of an isolator's bump stops at rest, in its axes [N], (3,); the whole force if it is a stop."""
    if isolator.is_stop:
        return load.force
    force = np.zeros(3)
    for axis, (x, law) in enumerate(zip(load.deflection.tolist(), isolator.axes.values(), strict=True)):
        for stop in () if law is None else law.stops:
            for side, gap in stop.unloaded_gaps.items():
                way = -1.0 if side == "below" else 1.0
                force[axis] += way * stop.pressed(way * x - gap)
    return force
