"""Installing the callbacks around stepping, and only there: MuJoCo's callbacks belong to the whole process.

Where the native ones cannot be verified the same callbacks run in Python: they gather NumPy views and call the same kernels.
"""

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Literal

import mujoco
import numba
import numpy as np

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import apply_forces, copy_rates
from wirerope_mj.engine.control.native import (
    ACCELERATION_STAGE,
    CONTROL_FIELDS,
    DATA_FIELDS,
    SENSOR_FIELDS,
    Callbacks,
    disagreement,
    native_callbacks,
)
from wirerope_mj.engine.control.observer import absorbed_power, begin_contacts, normal_force, observe, track_contact
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
    """Raise SimulationError if other MuJoCo callbacks are installed, whose forces would be missing from results."""
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
        self.is_system = model.nu > 0 and model.actuator_dynprm[-1, 0] == at.MAGIC
        if self.is_system:
            layout, parameters, userdata, states = map(int, model.actuator_dynprm[-1, 1:5])
            flat = {name: getattr(data, name).reshape(-1) for name in DATA_FIELDS}
            self.layout = model.numeric_data, layout
            self.user, self.rates = (flat["userdata"], userdata), (flat["act_dot"], states)
            self.tables = *self.layout, model.numeric_data, parameters, *self.user, flat["act"], states
            self.control, self.sensor = ([flat[name] for name in fields] for fields in (CONTROL_FIELDS, SENSOR_FIELDS))


def python_callbacks() -> Callbacks:
    """Return callbacks that run in the Python interpreter, as a fallback for the native callbacks and to verify these."""
    last: list[_Views] = []

    def views(model: mujoco.MjModel, data: mujoco.MjData) -> _Views:
        if not last or last[0].address != (model._address, data._address):
            last[:] = [_Views(model, data)]
        return last[0]

    def control(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        v = views(model, data)
        if v.is_system:
            apply_forces(*v.tables, data.time, *v.control)

    def act_dyn(model: mujoco.MjModel, data: mujoco.MjData, actuator: int) -> float:
        v = views(model, data)
        return copy_rates(*v.layout, *v.user, *v.rates) if v.is_system and actuator == model.nu - 1 else 0.0

    def sensor(model: mujoco.MjModel, data: mujoco.MjData, stage: int) -> None:
        """Write the system's sensor values, and update peaks and contacts, where MuJoCo has computed accelerations."""
        v = views(model, data)
        if not v.is_system or stage != ACCELERATION_STAGE:
            return
        (lay, i), (u, w) = v.layout, v.user
        if u[w + at.OBSERVING] != 0.0:
            begin_contacts(lay, i, u, w, data.ncon)
            force, rate, kinds = data.efc_force, data.efc_vel, data.efc_type
            for contact in data.contact if lay[i + at.N_CONTACTS] else ():
                address, dimension = contact.efc_address, contact.dim
                if address >= 0:  # otherwise MuJoCo left it out
                    track_contact(
                        lay, i, u, w, data.time, float(contact.geom[0]), float(contact.geom[1]), contact.dist,
                        normal_force(force, address, kinds[address], dimension),
                        absorbed_power(force, rate, address, kinds[address], dimension),
                    )  # fmt: skip
        observe(*v.tables, data.time, *v.sensor)

    return Callbacks(control=control, act_dyn=act_dyn, sensor=sensor)


@contextmanager
def installed(model: mujoco.MjModel, data: mujoco.MjData, kind: Kind = "native") -> Iterator[Kind]:
    """Install the callbacks of systems while the block runs; earlier callbacks are restored after it.

    MuJoCo's warnings are not printed meanwhile: their counters in `data.warning` are what a caller has to look at. With the
    memory of `data` the native callback is verified before it is installed; where it cannot be, "python" is yielded, with a
    RuntimeWarning.

    Raises:
        SimulationError: another thread steps with the other kind, the process has a callback of its own, or MuJoCo could not
            go on within the block.
    """
    one_of("callback", kind, ("native", "python"))
    check_callbacks()
    if kind == "native" and (reason := _native_fault(model, data)):
        warnings.warn(f"{reason}; the slower Python callback is used instead.", RuntimeWarning, stacklevel=3)
        kind = "python"
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
    try:
        yield kind
    except mujoco.FatalError as error:
        reason, name = " ".join(str(error).split()), model.names.split(b"\0", 1)[0].decode("utf-8", "replace")
        remedy = (
            'Its contacts and constraints need more memory: write <size memory="100M"/> into the model.'
            if "memory" in reason
            else "Step it with a smaller `timestep`, or look for bodies that overlap in the modelled geometry."
        )
        raise SimulationError(f"model {name!r}: MuJoCo gave up: {reason.rstrip('.')}. {remedy}") from None
    finally:
        with _lock:
            _users -= 1
            if not _users:
                _set(Callbacks(*_before[:3]), _before[3])


def _native_fault(model: mujoco.MjModel, data: mujoco.MjData) -> str:
    """Return the reason why the native callbacks cannot be used, "" if they can."""
    if numba.config.DISABLE_JIT:
        return "Numba's compiler is switched off"
    field = disagreement(model, data)
    return f"{field} of mujoco {mujoco.__version__} does not stand where it should" if field else ""


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
