"""Compiling kernels: on their first call, unless `kernel_files` finds them compiled."""

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numba import types
from numba.core import event
from numba.core.ccallback import CFunc

from wirerope_mj.foundation.compiling import Watch
from wirerope_mj.foundation.kernel_files import KernelFiles, cache_folder

event.register("numba:compile", Watch(str(cache_folder())))

index = np.uint32
"""A table's entry as an index: unsigned, so that no code is compiled for indices from an array's end."""


def njit(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` compiled on its first call, which lets other threads go on; x / 0 gives inf and NaN as in NumPy."""
    return _compiled(function, forceinline=False)


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` as `njit` does, compiled into its callers: handing on arrays costs as much as a small kernel."""
    return _compiled(function, forceinline=True)


def address(function: Callable[..., Any], signature: Any) -> int:
    """Return the address of `function` compiled as a C function of `signature`, a Numba type, for the life of the process."""
    callback: Any = CFunc(function, (signature.args, signature.return_type), {}, {"nopython": True})
    callback._cache = KernelFiles(function)
    callback.compile()
    _KEPT.append(callback)
    return int(callback.address)


_KEPT: list[Any] = []
"""Compiled callbacks: their code goes with them."""


def _compiled(function: Callable[..., Any], *, forceinline: bool) -> Callable[..., Any]:
    if numba.config.DISABLE_JIT:
        return function
    options = {"error_model": "numpy", "forceinline": forceinline, "nogil": True}
    compiled: Any = numba.njit(**options)(function)
    compiled._cache = KernelFiles(function, **options)
    template = compiled.get_call_template
    # Numba would make a function of its own for each number that is written out in a call: 589 of them instead of 427.
    compiled.get_call_template = lambda args, kws: template(
        [types.unliteral(a) for a in args], {name: types.unliteral(a) for name, a in kws.items()}
    )
    return compiled
