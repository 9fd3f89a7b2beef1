"""Byte offsets of MuJoCo's struct fields, from the library's own description of its structs, checked against its views."""

import ctypes
from functools import cache
from typing import Any

import mujoco
from mujoco.introspect import structs
from mujoco.introspect.ast_nodes import AnonymousStructDecl, AnonymousUnionDecl, ArrayType, PointerType, ValueType

MODEL_FIELDS = ("actuator_dynprm", "numeric_data")
DATA_FIELDS = (
    "qvel", "act", "qfrc_applied", "xfrc_applied", "qacc", "act_dot", "userdata", "sensordata", "xquat", "xipos",
    "site_xpos", "site_xmat", "site_xquat", "subtree_com", "cdof", "cvel", "cdof_dot", "qfrc_bias", "qfrc_passive",
)  # fmt: skip

_SCALARS = {
    "mjtNum": 8, "mjtSize": 8, "size_t": 8, "uintptr_t": 8, "uint64_t": 8, "int64_t": 8, "double": 8,
    "int": 4, "float": 4, "unsigned int": 4, "uint32_t": 4,
    "mjtBool": 1, "mjtByte": 1, "char": 1, "unsigned char": 1,
}  # fmt: skip


def _round_up(offset: int, alignment: int) -> int:
    return -(-offset // alignment) * alignment


def _layout_of_fields(fields: Any, union: bool = False) -> tuple[int, int, dict[str, int]]:
    """Return size, alignment and offsets by name of a struct's fields by the rules of the C ABI."""
    end, alignment, offsets = 0, 1, {}
    for field in fields:
        size, align = _size_of(field if isinstance(field, AnonymousStructDecl | AnonymousUnionDecl) else field.type)
        start = 0 if union else _round_up(end, align)
        offsets[getattr(field, "name", "")] = start
        end, alignment = max(end, start + size), max(alignment, align)
    return _round_up(end, alignment), alignment, offsets


def _size_of(kind: Any) -> tuple[int, int]:
    """Return size and alignment of a C type."""
    if isinstance(kind, PointerType):
        return 8, 8
    if isinstance(kind, ArrayType):
        size, align = _size_of(kind.inner_type)
        for extent in kind.extents:
            size *= extent
        return size, align
    if isinstance(kind, AnonymousUnionDecl):
        return _layout_of_fields(kind.fields, union=True)[:2]
    if isinstance(kind, AnonymousStructDecl):
        return _layout_of_fields(kind.fields)[:2]
    assert isinstance(kind, ValueType)
    if kind.name in _SCALARS:
        return _SCALARS[kind.name], _SCALARS[kind.name]
    if kind.name in structs.STRUCTS:
        return _layout_of_fields(structs.STRUCTS[kind.name].fields)[:2]
    return 4, 4  # enumerations


@cache
def offsets(struct: str) -> dict[str, int]:
    """Return the byte offset of every field of a MuJoCo struct."""
    return _layout_of_fields(structs.STRUCTS[struct].fields)[2]


@cache
def size_of(struct: str) -> int:
    """Return the bytes that one of MuJoCo's structs takes."""
    return _layout_of_fields(structs.STRUCTS[struct].fields)[0]


def disagreement(model: mujoco.MjModel, data: mujoco.MjData) -> str | None:
    """Return None if the offsets lead to what the Python views of this model and data show, else what does not."""
    for owner, struct, names in ((model, "mjModel", MODEL_FIELDS), (data, "mjData", DATA_FIELDS)):
        for name in names:
            view = getattr(owner, name)
            address = ctypes.c_void_p.from_address(owner._address + offsets(struct)[name]).value
            if view.size and address != view.ctypes.data:
                return f"{struct}.{name}"
    if ctypes.c_int64.from_address(model._address + offsets("mjModel")["nu"]).value != model.nu:
        return "mjModel.nu"
    if ctypes.c_double.from_address(data._address + offsets("mjData")["time"]).value != data.time:
        return "mjData.time"
    if ctypes.c_int.from_address(data._address + offsets("mjData")["ncon"]).value != data.ncon:
        return "mjData.ncon"
    return None
