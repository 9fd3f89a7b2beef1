"""Installing the callbacks around stepping, and only there: MuJoCo's callbacks belong to the whole process.

Where the native ones cannot be verified the same callbacks run in Python: they gather NumPy views and call the same kernels.
"""

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Literal

import mujoco
import numba
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.contacts import absorbed_power, begin_contacts, normal_force, track_contact, track_stops
from wirerope_mj.engine.control.mounts import apply_loads, apply_mounts, clear_loads, copy_rates, drive_base, remove_overshoot
from wirerope_mj.engine.control.native import ACCELERATION_STAGE, DATA_FIELDS, Callbacks, disagreement, native_callbacks
from wirerope_mj.engine.control.observer import observe
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.state import State

Kind = Literal["native", "python"]
_lock = threading.Lock()
_users = 0
_kind: Kind = "native"
_before: tuple[object, ...] = (None,) * 4
STATE = mujoco.mjtState.mjSTATE_INTEGRATION
# MuJoCo's callbacks that change what a model does: the first three are those that make mounts act
_OWN, _ACTING = ("control", "act_dyn", "sensor"), ("passive", "act_gain", "act_bias", "contactfilter")


def check_callbacks() -> None:
    """Raise SimulationError if the process has a callback of its own, which no result here would hold."""
    with _lock:  # until all are looked at: another thread may install ours meanwhile
        for name in _ACTING if _users else _OWN + _ACTING:
            if getattr(mujoco, f"get_mjcb_{name}")() is not None:
                raise SimulationError(
                    f"`mjcb_{name}` of this process is set: MuJoCo's callbacks act on every model, mounts act through them, "
                    f"and kernel, modes and statics know nothing of them. Call mujoco.set_mjcb_{name}(None) first; your law "
                    "is an `OwnLaw`, and a force on the payload part of the motion."
                )


check_callbacks()
import_module("mujoco.batch")  # it compiles a model, which no callback of the process's own survives


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
        drive_base(v.numeric, v.layout, v.d_userdata, v.userdata, data.time, v.d_qfrc_applied, v.d_qfrc_bias, v.d_qfrc_passive)
        clear_loads(v.numeric, v.layout, v.d_xfrc_applied)
        apply_mounts(
            v.numeric, v.layout, v.numeric, v.parameters, v.d_userdata, v.userdata, v.d_act, v.states,
            v.d_site_xpos, v.d_site_xmat, v.d_site_xquat, v.d_subtree_com, v.d_cvel, v.d_xipos, v.d_xfrc_applied,
            v.d_qpos, v.d_qvel, v.d_qfrc_applied,
        )  # fmt: skip
        apply_loads(
            v.numeric, v.layout, v.d_userdata, v.userdata, data.time, v.d_site_xpos, v.d_site_xmat, v.d_xipos,
            v.d_xfrc_applied, v.d_qfrc_applied,
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
                v.d_site_xpos, v.d_site_xmat, v.d_subtree_com, v.d_cvel, v.d_qvel,
            )  # fmt: skip
        observe(
            v.numeric, v.layout, v.d_userdata, v.userdata, v.d_act, v.states, data.time, v.d_sensordata,
            v.d_site_xpos, v.d_site_xquat, v.d_xipos, v.d_xquat, v.d_subtree_com, v.d_cvel, v.d_cdof, v.d_cdof_dot,
            v.d_qvel, v.d_qacc, v.d_site_xmat, v.d_qpos,
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


@contextmanager
def installed(model: mujoco.MjModel, data: mujoco.MjData, kind: Kind = "native") -> Iterator[Kind]:
    """Make the mounts of every system act for as long as the block runs; what was installed before comes back after it.

    MuJoCo's warnings are not printed meanwhile: their counters in `data.warning` are what a caller has to look at. With the
    memory of `data` the native callback is verified before it is installed; where it cannot be, "python" is yielded, with a
    RuntimeWarning.

    Raises:
        SimulationError: another thread steps with the other kind, the process has a callback of its own, or MuJoCo could not
            go on within the block.
    """
    one_of("callback", kind, ("native", "python"))
    check_callbacks()
    kind = _verified(model, data) if kind == "native" else kind
    _acquire(kind)
    try:
        yield kind
    except mujoco.FatalError as error:
        raise SimulationError(_given_up(model, " ".join(str(error).split()))) from None
    finally:
        _release()


def _given_up(model: mujoco.MjModel, reason: str) -> str:
    """Return the message about a model that MuJoCo cannot step any further, from its own reason."""
    name = model.names.split(b"\0", 1)[0].decode("utf-8", "replace")
    remedy = (
        'Its contacts and constraints need more memory: write <size memory="100M"/> into the model.'
        if "memory" in reason
        else "Step it with a smaller `timestep`, or look for bodies that overlap in the modelled geometry."
    )
    return f"model {name!r}: MuJoCo gave up: {reason.rstrip('.')}. {remedy}"


def _verified(model: mujoco.MjModel, data: mujoco.MjData) -> Kind:
    if numba.config.DISABLE_JIT:
        reason: str | None = "Numba's compiler is switched off"
    else:
        field = disagreement(model, data)
        reason = None if field is None else f"{field} of mujoco {mujoco.__version__} does not stand where it should"
    if reason is None:
        return "native"
    warnings.warn(f"{reason}; the slower Python callback is used instead.", RuntimeWarning, stacklevel=4)
    return "python"


def _acquire(kind: Kind) -> None:
    global _users, _kind, _before
    with _lock:
        if _users and kind != _kind:
            raise SimulationError(f"another thread is stepping with the {_kind} callback; wait for it, or use it here.")
        if not _users:
            callbacks = mujoco.get_mjcb_control(), mujoco.get_mjcb_act_dyn(), mujoco.get_mjcb_sensor()
            before = (*callbacks, mujoco.get_mju_user_warning())
            _set(native_callbacks() if kind == "native" else python_callbacks(), lambda message: None)
            _before, _kind = before, kind
        _users += 1


def _release() -> None:
    global _users
    with _lock:
        _users -= 1
        if not _users:
            _set(Callbacks(*_before[:3]), _before[3])


def _set(callbacks: Callbacks, warn: object) -> None:
    mujoco.set_mjcb_control(callbacks.control)
    mujoco.set_mjcb_act_dyn(callbacks.act_dyn)
    mujoco.set_mjcb_sensor(callbacks.sensor)
    mujoco.set_mju_user_warning(warn)


def state_of(model: mujoco.MjModel, data: mujoco.MjData) -> State:
    """Return the integration state of `data`."""
    values = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, values, STATE)
    return State(values=values, time=float(data.time))
