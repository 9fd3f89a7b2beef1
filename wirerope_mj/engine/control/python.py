"""The same callbacks as Python functions: they gather NumPy views and call the same kernels."""

from typing import Any

import mujoco

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.contacts import absorbed_power, begin_contacts, normal_force, track_contact
from wirerope_mj.engine.control.loads import apply_loads, clear_loads
from wirerope_mj.engine.control.mounts import apply_mounts, copy_rates, drive_base, remove_overshoot
from wirerope_mj.engine.control.native import ACCELERATION_STAGE, Callbacks
from wirerope_mj.engine.control.observer import observe
from wirerope_mj.engine.control.stops import track_stops
from wirerope_mj.engine.control.structs import DATA_FIELDS


class _Views:
    """Flat views of one MjData and the addresses of its system: making them anew would cost more than the kernels."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self.address = (model._address, data._address)
        self.owner = data  # keeps the memory behind the views, and so the address, from being used again
        self.numeric = model.numeric_data
        self.is_system = model.nu > 0 and model.actuator_dynprm[-1, 0] == at.MAGIC
        if self.is_system:
            self.layout, self.parameters, self.userdata, self.states = (int(v) for v in model.actuator_dynprm[-1, 1:5])
        for name in DATA_FIELDS:
            setattr(self, f"d_{name}", getattr(data, name).reshape(-1))


def python_callbacks() -> Callbacks:
    """Return callbacks that run in the interpreter, for where the native ones cannot be verified, and as their check."""
    last: list[_Views] = []

    def views(model: mujoco.MjModel, data: mujoco.MjData) -> Any:
        if not last or last[0].address != (model._address, data._address):
            last[:] = [_Views(model, data)]
        return last[0]

    def control(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        v = views(model, data)
        if not v.is_system:
            return
        drive_base(
            v.numeric, v.layout, v.d_userdata, v.userdata, data.time, v.d_qfrc_applied, v.d_qfrc_bias, v.d_qfrc_passive
        )
        clear_loads(v.numeric, v.layout, v.d_xfrc_applied)
        apply_mounts(
            v.numeric, v.layout, v.numeric, v.parameters, v.d_userdata, v.userdata, v.d_act, v.states,
            v.d_site_xpos, v.d_site_xmat, v.d_site_xquat, v.d_subtree_com, v.d_cvel, v.d_xipos, v.d_xfrc_applied,
        )  # fmt: skip
        apply_loads(
            v.numeric, v.layout, v.d_userdata, v.userdata, data.time, v.d_site_xpos, v.d_site_xmat, v.d_xipos,
            v.d_xfrc_applied,
        )  # fmt: skip

    def act_dyn(model: mujoco.MjModel, data: mujoco.MjData, actuator: int) -> float:
        v = views(model, data)
        if v.is_system and actuator == model.nu - 1:
            return copy_rates(v.numeric, v.layout, v.d_userdata, v.userdata, v.d_act_dot, v.states)
        return 0.0

    def sensor(model: mujoco.MjModel, data: mujoco.MjData, stage: int) -> None:
        v = views(model, data)
        if not v.is_system or stage != ACCELERATION_STAGE:
            return
        remove_overshoot(v.numeric, v.layout, v.numeric, v.parameters, v.d_act, v.states)
        if v.d_userdata[v.userdata + at.OBSERVING] != 0.0:
            _track_contacts(v, data)
            track_stops(
                v.numeric, v.layout, v.numeric, v.parameters, v.d_userdata, v.userdata, v.d_act, v.states, data.time,
                v.d_site_xpos, v.d_site_xmat, v.d_subtree_com, v.d_cvel,
            )  # fmt: skip
        observe(
            v.numeric, v.layout, v.d_userdata, v.userdata, v.d_act, v.states, data.time, v.d_sensordata,
            v.d_site_xpos, v.d_site_xquat, v.d_xipos, v.d_xquat, v.d_subtree_com, v.d_cvel, v.d_cdof, v.d_cdof_dot,
            v.d_qvel, v.d_qacc,
        )  # fmt: skip

    return Callbacks(control=control, act_dyn=act_dyn, sensor=sensor)


def _track_contacts(v: Any, data: mujoco.MjData) -> None:
    """Remember the contacts of this step, as the native callback does."""
    begin_contacts(v.numeric, v.layout, v.d_userdata, v.userdata, data.ncon)
    if not data.ncon or not v.numeric[v.layout + at.N_CONTACTS]:
        return
    force, rate, kinds = data.efc_force, data.efc_vel, data.efc_type
    for contact in data.contact:
        address, dimension = contact.efc_address, contact.dim
        if address >= 0:
            track_contact(
                v.numeric, v.layout, v.d_userdata, v.userdata, data.time,
                float(contact.geom[0]), float(contact.geom[1]), contact.dist,
                normal_force(force, address, kinds[address], dimension),
                absorbed_power(force, rate, address, kinds[address], dimension),
            )  # fmt: skip
