"""Digest of what a kernel's compiled code depends on: its own code, and the kernels and constants that it reaches."""

import hashlib
from collections.abc import Callable, Iterator
from enum import Enum
from functools import cache
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core.dispatcher import Dispatcher
from numba.extending import _Intrinsic as Intrinsic

_PACKAGE = Path(__file__).resolve().parents[1]
# Files of this folder that say how every kernel is compiled, or teach Numba types and functions.
_SHARED = ("jit.py", "lane_types.py", "lane_choices.py", "lanes.py")


@cache
def digest(function: Callable[..., Any]) -> str:
    """Return the digest of `function` and all it reaches, without compiling it.

    Its code object counts, not its text: comments and lines that move change nothing. Constants count by their value, among
    them the addresses of tables, and offsets in MuJoCo's structs.

    Raises:
        TypeError: a kernel reaches something of which it is not known how it is compiled.
    """
    reached: dict[int, str] = {}
    waiting = [function]
    while waiting:
        kernel = waiting.pop()
        if id(kernel) not in reached:
            reached[id(kernel)], callees = _own_text(kernel)
            waiting += callees
    return hashlib.sha256("\n".join([_shared(), _own_text(function)[0], *sorted(reached.values())]).encode()).hexdigest()


@cache
def _own_text(kernel: FunctionType) -> tuple[str, tuple[FunctionType, ...]]:
    """Return the text of a kernel's own code, and the functions that it calls."""
    callees: list[FunctionType] = []
    parts = [f"{kernel.__module__}.{kernel.__qualname__}", repr(kernel.__defaults__), *code_texts(kernel.__code__)]
    for name, value in _dependencies(kernel):
        parts.append(f"{name} = {_text(name, value, callees)}")
    return "\n".join(parts), tuple(callees)


def code_texts(code: CodeType) -> Iterator[str]:
    """Yield a function's byte code, names and constants as text."""
    yield code.co_code.hex()
    yield repr((code.co_names, code.co_varnames, code.co_freevars, code.co_argcount))
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from code_texts(constant)
        else:
            yield repr(sorted(constant, key=repr) if isinstance(constant, frozenset) else constant)


def _names(code: CodeType) -> set[str]:
    nested = (_names(constant) for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*nested)


def _dependencies(kernel: FunctionType) -> Iterator[tuple[str, object]]:
    """Yield the globals, closure cells and module members that a kernel uses; of libraries, only numbers."""
    names = sorted(_names(kernel.__code__))
    for name in names:
        value = kernel.__globals__.get(name)
        if isinstance(value, ModuleType):
            ours = value.__name__.startswith("wirerope_mj")
            members = ((f"{name}.{member}", getattr(value, member)) for member in names if hasattr(value, member))
            yield from (pair for pair in members if ours or isinstance(pair[1], int | float))
        elif name in kernel.__globals__:
            yield name, value
    for name, cell in zip(kernel.__code__.co_freevars, kernel.__closure__ or (), strict=True):
        yield name, cell.cell_contents


def _text(name: str, value: Any, callees: list[FunctionType]) -> str:
    """Return the text that identifies a value; functions compiled with the kernel are added to `callees`."""
    if isinstance(value, Dispatcher):
        callees.append(value.py_func)
        return repr(sorted(value.targetoptions.items()))
    if isinstance(value, Intrinsic):
        callees.append(value._defn)
        return "an intrinsic"
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    if value is None or isinstance(value, bool | int | float | str | tuple | np.generic | Enum | numba.types.Type | ir.Type):
        return repr(value)
    if isinstance(value, FunctionType) and value.__module__.startswith("wirerope_mj"):
        return f"{value.__module__}.{value.__qualname__} {_file(value.__code__.co_filename)}"
    if isinstance(value, FunctionType | BuiltinFunctionType | type | np.ufunc):
        return f"{getattr(value, '__module__', '')}.{value.__name__}"
    raise TypeError(f"{name}: a kernel cannot be kept, because it is not known how {type(value).__name__} is compiled")


@cache
def _file(path: str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


@cache
def _shared() -> str:
    return " ".join(_file(str(_PACKAGE / "foundation" / name)) for name in _SHARED)
