"""The callbacks as native functions: no interpreter and no lock between MuJoCo's passes, and threads may share them."""

import ctypes
import math
from functools import cache
from typing import Any, NamedTuple

import mujoco
import numpy as np
from mujoco.introspect import structs
from mujoco.introspect.ast_nodes import AnonymousStructDecl, AnonymousUnionDecl, ArrayType, PointerType, ValueType
from numba import carray, types
from numba.core import cgutils
from numba.extending import intrinsic

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import apply_forces, copy_rates
from wirerope_mj.engine.control.observer import absorbed_power, begin_contacts, normal_force, observe, track_contact
from wirerope_mj.foundation.jit import address, inlined, njit

MODEL_FIELDS = ("actuator_dynprm", "numeric_data")
# of mjData, what `apply_forces` and `observe` take behind the system's tables, in their order
CONTROL_FIELDS = (
    "qfrc_applied", "qfrc_bias", "qfrc_passive", "site_xpos", "site_xmat", "site_xquat", "subtree_com", "cvel", "xipos",
    "xfrc_applied", "qpos", "qvel",
)  # fmt: skip
SENSOR_FIELDS = (
    "sensordata", "site_xpos", "site_xquat", "xipos", "xquat", "subtree_com", "cvel", "cdof", "cdof_dot", "qvel", "qacc",
    "site_xmat", "qpos",
)  # fmt: skip
DATA_FIELDS = tuple(dict.fromkeys(("userdata", "act", "act_dot", *CONTROL_FIELDS, *SENSOR_FIELDS)))

_SCALARS: dict[str, Any] = {
    "mjtNum": ctypes.c_double, "double": ctypes.c_double, "float": ctypes.c_float, "int": ctypes.c_int,
    "unsigned int": ctypes.c_uint, "uint32_t": ctypes.c_uint32, "mjtSize": ctypes.c_int64, "size_t": ctypes.c_size_t,
    "uintptr_t": ctypes.c_size_t, "uint64_t": ctypes.c_uint64, "int64_t": ctypes.c_int64, "mjtBool": ctypes.c_ubyte,
    "mjtByte": ctypes.c_ubyte, "char": ctypes.c_ubyte, "unsigned char": ctypes.c_ubyte,
}  # fmt: skip

DYNPRM_SIZE, DOUBLE = int(mujoco.mjNDYN), 8  # entries for each actuator; size of a float64 [B]
ANY_SIZE = 1 << 40  # nominal length of an array behind a pointer: the kernels index by the model's own tables
ACCELERATION_STAGE = 3  # mjSTAGE_ACC: the sensor callback is called once per stage and acts in the last


@cache
def struct(name: str) -> Any:
    """Return the ctypes class with the layout of a MuJoCo struct."""
    return _c_type(structs.STRUCTS[name])


def _c_type(kind: Any) -> Any:
    """Return the ctypes type of a C type or of the declaration of a struct or union."""
    if isinstance(kind, PointerType):
        return ctypes.c_void_p
    if isinstance(kind, ArrayType):
        return _c_type(kind.inner_type) * math.prod(kind.extents)
    if isinstance(kind, ValueType):
        return struct(kind.name) if kind.name in structs.STRUCTS else _SCALARS.get(kind.name, ctypes.c_int)  # enumerations
    anonymous = AnonymousStructDecl, AnonymousUnionDecl
    parts = [(getattr(field, "name", ""), field if isinstance(field, anonymous) else field.type) for field in kind.fields]
    fields = [(name or f"part_{number}", _c_type(part)) for number, (name, part) in enumerate(parts)]
    base: Any = ctypes.Union if isinstance(kind, AnonymousUnionDecl) else ctypes.Structure
    return type("", (base,), {"_fields_": fields})


def disagreement(model: mujoco.MjModel, data: mujoco.MjData) -> str | None:
    """Return the first field of MuJoCo whose offset disagrees with the Python views of model and data, None if all agree."""
    for owner, kind, names in ((model, "mjModel", MODEL_FIELDS), (data, "mjData", DATA_FIELDS)):
        memory = struct(kind).from_address(owner._address)
        for name in (*names, *(("nu",) if owner is model else ("time", "ncon"))):
            view = getattr(owner, name)
            if getattr(memory, name) != (view.ctypes.data if isinstance(view, np.ndarray) else view) and np.size(view):
                return f"{kind}.{name}"
    return None


@intrinsic
def _as_pointer(typing_context, address):  # type: ignore[no-untyped-def]
    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return builder.inttoptr(args[0], cgutils.voidptr_t)

    return types.voidptr(types.intp), codegen


@inlined
def float64_array(address):  # type: ignore[no-untyped-def]
    return carray(_as_pointer(address), (ANY_SIZE,), types.float64)


@inlined
def int64_array(address):  # type: ignore[no-untyped-def]
    return carray(_as_pointer(address), (ANY_SIZE,), types.int64)


@inlined
def int32_array(address):  # type: ignore[no-untyped-def]
    return carray(_as_pointer(address), (ANY_SIZE,), types.int32)


@inlined
def member(struct, offset, start=0):  # type: ignore[no-untyped-def]
    """Return the float64 array that the pointer at `offset` in a struct leads to, from its entry `start`."""
    return float64_array(int64_array(struct + offset)[0] + DOUBLE * start)


class Callbacks(NamedTuple):
    """The three callbacks that a system needs, as `mujoco.set_mjcb_*` takes them."""

    control: object
    act_dyn: object
    sensor: object


@inlined
def _find_system(m, in_model):  # type: ignore[no-untyped-def]
    """Find this package's tables in the mjModel at address `m`; `in_model`: offsets of nu, actuator_dynprm, numeric_data there.

    Returns whether there is one, its state actuator, layout and parameters as arrays, and its first entries in userdata and in
    act. Arrays begin where the system's entries do, so that the kernels get 0 for their addresses: a constant, which the
    compiler sees is not negative.
    """
    nu, dynprm, numeric_data = in_model
    last = int64_array(m + nu)[0] - 1
    prm = member(m, dynprm, DYNPRM_SIZE * last)
    is_system = last >= 0 and prm[at.PRM_MAGIC] == at.MAGIC
    layout, parameters, userdata, activation = (
        (int(prm[at.PRM_LAYOUT]), int(prm[at.PRM_PARAMETERS]), int(prm[at.PRM_USERDATA]), int(prm[at.PRM_ACTIVATION]))
        if is_system
        else (0, 0, 0, 0)
    )
    return is_system, last, member(m, numeric_data, layout), member(m, numeric_data, parameters), userdata, activation


@inlined
def _control(m, d, in_model, time, userdata, activation, f):  # type: ignore[no-untyped-def]
    is_system, _, lay, par, w, a = _find_system(m, in_model)
    if is_system:
        apply_forces(
            lay, 0, par, 0, member(d, userdata, w), 0, member(d, activation, a), 0, float64_array(d + time)[0],
            member(d, f[0]), member(d, f[1]), member(d, f[2]), member(d, f[3]), member(d, f[4]), member(d, f[5]),
            member(d, f[6]), member(d, f[7]), member(d, f[8]), member(d, f[9]), member(d, f[10]), member(d, f[11]),
        )  # fmt: skip


@inlined
def _act_dyn(m, d, actuator, in_model, userdata, act_dot):  # type: ignore[no-untyped-def]
    is_system, last, lay, _, w, a = _find_system(m, in_model)
    if is_system and last == actuator:
        return copy_rates(lay, 0, member(d, userdata, w), 0, member(d, act_dot, a), 0)
    return 0.0


@inlined
def _sensor(m, d, in_model, time, userdata, activation, f, in_data, in_contact):  # type: ignore[no-untyped-def]
    is_system, _, lay, par, w, a = _find_system(m, in_model)
    if is_system:
        u, now = member(d, userdata, w), float64_array(d + time)[0]
        if u[at.OBSERVING] != 0.0:
            _contacts(d, lay, u, now, in_data, in_contact)
        observe(
            lay, 0, par, 0, u, 0, member(d, activation, a), 0, now, member(d, f[0]), member(d, f[1]), member(d, f[2]),
            member(d, f[3]), member(d, f[4]), member(d, f[5]), member(d, f[6]), member(d, f[7]), member(d, f[8]),
            member(d, f[9]), member(d, f[10]), member(d, f[11]), member(d, f[12]),
        )  # fmt: skip


@njit
def _contacts(d, lay, u, time, in_data, in_contact):  # type: ignore[no-untyped-def]
    """Record the contacts of this step in `u`; `in_data`, `in_contact`: offsets in mjData and mjContact, its size last."""
    number = int32_array(d + in_data[0])[0]
    begin_contacts(lay, 0, u, 0, number)
    if number == 0 or lay[at.N_CONTACTS] == 0.0:
        return
    contact, force, rate = int64_array(d + in_data[1])[0], member(d, in_data[2]), member(d, in_data[4])
    kinds = int32_array(int64_array(d + in_data[3])[0])
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


_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int
_MODEL_AND_DATA = (types.intp, types.intp)  # addresses of mjModel and mjData


@cache
def native_callbacks() -> Callbacks:
    """Return the compiled callbacks; the offsets in the structs of this MuJoCo are constants of their code."""

    def offsets(kind: str, *names: str) -> tuple[int, ...]:
        return tuple(getattr(struct(kind), name).offset for name in names)

    in_model = offsets("mjModel", "nu", "actuator_dynprm", "numeric_data")
    time, userdata, activation, act_dot = offsets("mjData", "time", "userdata", "act", "act_dot")
    fields, sensed = offsets("mjData", *CONTROL_FIELDS), offsets("mjData", *SENSOR_FIELDS)
    in_data = offsets("mjData", "ncon", "contact", "efc_force", "efc_type", "efc_vel")
    in_contact = *offsets("mjContact", "dist", "geom", "dim", "efc_address"), ctypes.sizeof(struct("mjContact"))

    def control(m, d):  # type: ignore[no-untyped-def]
        _control(m, d, in_model, time, userdata, activation, fields)

    def act_dyn(m, d, actuator):  # type: ignore[no-untyped-def]
        return _act_dyn(m, d, actuator, in_model, userdata, act_dot)

    def sensor(m, d, stage):  # type: ignore[no-untyped-def]
        if stage == ACCELERATION_STAGE:
            _sensor(m, d, in_model, time, userdata, activation, sensed, in_data, in_contact)

    at_stage = types.void(*_MODEL_AND_DATA, types.int32)
    return Callbacks(
        control=ctypes.CFUNCTYPE(None, _POINTER, _POINTER)(address(control, types.void(*_MODEL_AND_DATA))),
        act_dyn=ctypes.CFUNCTYPE(ctypes.c_double, _POINTER, _POINTER, _INTEGER)(
            address(act_dyn, types.float64(*_MODEL_AND_DATA, types.int32))
        ),
        sensor=ctypes.CFUNCTYPE(None, _POINTER, _POINTER, _INTEGER)(address(sensor, at_stage)),
    )
