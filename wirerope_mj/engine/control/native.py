"""The callbacks as native functions: no interpreter and no lock between MuJoCo's passes, and threads may share them."""

import ctypes
from functools import cache
from typing import NamedTuple

from numba import types

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.contacts import absorbed_power, begin_contacts, normal_force, track_contact
from wirerope_mj.engine.control.loads import apply_loads, clear_loads
from wirerope_mj.engine.control.mounts import apply_mounts, copy_rates, drive_base, remove_overshoot
from wirerope_mj.engine.control.observer import observe
from wirerope_mj.engine.control.pointers import float64_array, int32_array, int32_member, int64_array, member
from wirerope_mj.engine.control.stops import track_stops
from wirerope_mj.engine.control.structs import DATA_FIELDS, offsets, size_of
from wirerope_mj.foundation.jit import address, inlined, njit

ACCELERATION_STAGE = 3  # mjSTAGE_ACC: the sensor callback is called once per stage and acts in the last


class Callbacks(NamedTuple):
    """The three callbacks that a system needs, as `mujoco.set_mjcb_*` takes them."""

    control: object
    act_dyn: object
    sensor: object


@inlined
def _find_system(m, system):  # type: ignore[no-untyped-def]
    """Return whether the model at address `m` has a state actuator, which one, and what its entries lead to.

    That is: layout and parameters as arrays, the first entries in userdata and in act. Arrays begin where the system's
    entries do, so that the kernels get 0 for their addresses: a constant, which the compiler sees is not negative.
    """
    last = int64_array(m + system[0])[0] - 1
    prm = member(m, system[1], 10 * last)
    is_system = last >= 0 and prm[0] == at.MAGIC
    layout, parameters, userdata, activation = (
        (int(prm[1]), int(prm[2]), int(prm[3]), int(prm[4])) if is_system else (0, 0, 0, 0)
    )
    return is_system, last, member(m, system[2], layout), member(m, system[2], parameters), userdata, activation


@inlined
def _control(m, d, system, field, time):  # type: ignore[no-untyped-def]
    is_system, _, lay, par, userdata, activation = _find_system(m, system)
    if not is_system:
        return
    u = member(d, field[0], userdata)
    drive_base(
        lay, 0, u, 0, float64_array(d + time)[0],
        member(d, field[1]),
        member(d, field[2]),
        member(d, field[3]),
    )  # fmt: skip
    clear_loads(lay, 0, member(d, field[11]))
    apply_mounts(
        lay, 0, par, 0, u, 0, member(d, field[4], activation), 0,
        member(d, field[5]),
        member(d, field[6]),
        member(d, field[7]),
        member(d, field[8]),
        member(d, field[9]),
        member(d, field[10]),
        member(d, field[11]),
    )  # fmt: skip
    apply_loads(
        lay, 0, u, 0, float64_array(d + time)[0],
        member(d, field[5]),
        member(d, field[6]),
        member(d, field[10]),
        member(d, field[11]),
    )  # fmt: skip


@inlined
def _act_dyn(m, d, actuator, system, userdata, act_dot):  # type: ignore[no-untyped-def]
    is_system, last, lay, _, w, a = _find_system(m, system)
    if is_system and last == actuator:
        return copy_rates(lay, 0, member(d, userdata, w), 0, member(d, act_dot, a), 0)
    return 0.0


@njit
def _contacts(d, lay, u, time, in_data, in_contact):  # type: ignore[no-untyped-def]
    """Remember the contacts of this step; offsets in mjData and in mjContact, whose size is last."""
    number = int32_array(d + in_data[0])[0]
    begin_contacts(lay, 0, u, 0, number)
    if number == 0 or lay[at.N_CONTACTS] == 0.0:
        return
    contact, force, kinds = int64_array(d + in_data[1])[0], member(d, in_data[2], 0), int32_member(d, in_data[3])
    rate = member(d, in_data[4], 0)
    for _ in range(number):
        address = int32_array(contact + in_contact[3])[0]
        if address >= 0:  # otherwise MuJoCo left it out
            geoms = int32_array(contact + in_contact[1])
            kind, dimension = kinds[address], int32_array(contact + in_contact[2])[0]
            track_contact(
                lay, 0, u, 0, time, float(geoms[0]), float(geoms[1]), float64_array(contact + in_contact[0])[0],
                normal_force(force, address, kind, dimension), absorbed_power(force, rate, address, kind, dimension),
            )  # fmt: skip
        contact += in_contact[4]


@inlined
def _sensor(m, d, system, field, time, in_data, in_contact):  # type: ignore[no-untyped-def]
    is_system, _, lay, par, userdata, activation = _find_system(m, system)
    if not is_system:
        return
    u, act, now = member(d, field[0], userdata), member(d, field[1], activation), float64_array(d + time)[0]
    remove_overshoot(lay, 0, par, 0, act, 0)
    if u[at.OBSERVING] != 0.0:
        _contacts(d, lay, u, now, in_data, in_contact)
        track_stops(
            lay, 0, par, 0, u, 0, act, 0, now,
            member(d, field[3]),
            member(d, field[13]),
            member(d, field[7]),
            member(d, field[8]),
        )  # fmt: skip
    observe(
        lay, 0, u, 0, act, 0, now,
        member(d, field[2]),
        member(d, field[3]),
        member(d, field[4]),
        member(d, field[5]),
        member(d, field[6]),
        member(d, field[7]),
        member(d, field[8]),
        member(d, field[9]),
        member(d, field[10]),
        member(d, field[11]),
        member(d, field[12]),
    )  # fmt: skip


CONTROL_FIELDS = (
    "userdata", "qfrc_applied", "qfrc_bias", "qfrc_passive", "act", "site_xpos", "site_xmat", "site_xquat", "subtree_com",
    "cvel", "xipos", "xfrc_applied",
)  # fmt: skip
SENSOR_FIELDS = (
    "userdata", "act", "sensordata", "site_xpos", "site_xquat", "xipos", "xquat", "subtree_com", "cvel", "cdof", "cdof_dot",
    "qvel", "qacc", "site_xmat",
)  # fmt: skip


@cache
def native_callbacks() -> Callbacks:
    """Return the compiled callbacks; the offsets in the structs of this MuJoCo are constants of their code."""
    model, data = offsets("mjModel"), offsets("mjData")
    assert set(CONTROL_FIELDS + SENSOR_FIELDS) <= set(DATA_FIELDS)
    system = (model["nu"], model["actuator_dynprm"], model["numeric_data"])
    control_fields = tuple(data[name] for name in CONTROL_FIELDS)
    sensor_fields = tuple(data[name] for name in SENSOR_FIELDS)
    time, userdata, act_dot = data["time"], data["userdata"], data["act_dot"]
    in_data = tuple(data[name] for name in ("ncon", "contact", "efc_force", "efc_type", "efc_vel"))
    contact = offsets("mjContact")
    in_contact = (*(contact[name] for name in ("dist", "geom", "dim", "efc_address")), size_of("mjContact"))

    def control(m, d):  # type: ignore[no-untyped-def]
        _control(m, d, system, control_fields, time)

    def act_dyn(m, d, actuator):  # type: ignore[no-untyped-def]
        return _act_dyn(m, d, actuator, system, userdata, act_dot)

    def sensor(m, d, stage):  # type: ignore[no-untyped-def]
        if stage == ACCELERATION_STAGE:
            _sensor(m, d, system, sensor_fields, time, in_data, in_contact)

    pointer, integer = ctypes.c_void_p, ctypes.c_int
    structs = (types.intp, types.intp)
    return Callbacks(
        control=ctypes.CFUNCTYPE(None, pointer, pointer)(address(control, types.void(*structs))),
        act_dyn=ctypes.CFUNCTYPE(ctypes.c_double, pointer, pointer, integer)(
            address(act_dyn, types.float64(*structs, types.int32))
        ),
        sensor=ctypes.CFUNCTYPE(None, pointer, pointer, integer)(address(sensor, types.void(*structs, types.int32))),
    )
