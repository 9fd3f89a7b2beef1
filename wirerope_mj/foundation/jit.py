"""Compiling kernels, on their first call unless `kernel_files` finds them compiled, and what is said meanwhile."""

import hashlib
import multiprocessing
import platform
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any, cast

import numba
import numpy as np
from numba import types

from wirerope_mj.foundation.kernel_files import cache_folder, where_kept, why_not_kept
from wirerope_mj.foundation.kernel_proof import doubt
from wirerope_mj.foundation.processes import compile_beside
from wirerope_mj.foundation.resources import version_of

try:
    from numba.core.event import Listener, register
except ImportError:  # of another Numba: nothing is said meanwhile
    Listener, register = object, lambda kind, listener: None

# Time [s] that compiling takes before anything is said, and between two lines.
PATIENCE, PACE = 2.0, 10.0
# A table's entry as an index: unsigned, so that no code is compiled for indices from an array's end.
index = np.uint32
# Options of a function that kernels call: Python and C have no way into it.
_UNWRAPPED = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
# Kernels before they are compiled: Numba tells of all functions, those of other programs, too.
_KERNELS: set[Callable[..., Any]] = set()
# Compiled callbacks: their code goes with them.
_KEPT: list[Any] = []


class Watch(Listener):
    """Prints on standard error that kernels are being compiled, how long that takes, and how far it is."""

    def __init__(self, folder: str):
        """Take the folder where they are kept."""
        self._folder = Path(folder)
        self._depth, self._number = 0, 0
        self._began = self._last = 0.0

    def notify(self, event: Any) -> None:
        """Leave out what others compile with Numba."""
        if event.data["dispatcher"].py_func in _KERNELS:
            super().notify(event)

    def on_start(self, event: Any) -> None:
        """Note that a kernel, or one that it calls, is begun."""
        if self._depth == 0:
            self._began = perf_counter()
            if not why_not_kept(self._folder):
                compile_beside()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Note that one is done, and say so now and then."""
        self._depth -= 1
        self._number += 1
        now = perf_counter()
        if now - max(self._last + PACE, self._began + PATIENCE) < 0.0 or multiprocessing.parent_process() is not None:
            return
        if self._last == 0.0:
            versions = f"Python {platform.python_version()}, Numba {numba.__version__} and this processor"
            say(
                f"kernels are compiled for {versions}: a minute or two, once; {where_kept(self._folder)}. "
                "`wirerope compile` compiles all."
            )
        else:
            say(f"{self._number} functions are compiled ...")
        self._last = now


def say(line: str) -> None:
    """Print a line on standard error."""
    print(f"wirerope: {line}", file=sys.stderr, flush=True)


doubt()  # before what it compiles is counted
register("numba:compile", Watch(str(cache_folder())))


def njit(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` compiled on its first call, which lets other threads go on; x / 0 gives inf and NaN as in NumPy."""
    return _compiled(function, forceinline=False)


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` as `njit` does, compiled into its callers: handing on arrays costs as much as a small kernel."""
    return _compiled(function, forceinline=True)


def address(function: Callable[..., Any], signature: Any) -> int:
    """Return the address of `function` compiled as a C function of `signature`, a Numba type, for the life of the process."""
    if doubt():
        with _numbas_cache() as kept:
            callback = numba.cfunc(signature, cache=kept)(function)
    else:
        from wirerope_mj.foundation import linked_code

        callback = linked_code.callback(function, signature)
    _KEPT.append(callback)
    return int(callback.address)


def _compiled(function: Callable[..., Any], *, forceinline: bool) -> Callable[..., Any]:
    if numba.config.DISABLE_JIT:
        return function
    _KERNELS.add(function)
    options = {"error_model": "numpy", "forceinline": forceinline, "nogil": True}
    if doubt():
        with _numbas_cache() as kept:
            return cast(
                "Callable[..., Any]",
                numba.njit(cache=kept and Path(function.__code__.co_filename).is_file(), **options)(function),
            )
    from wirerope_mj.foundation.linked_code import kernel

    # one that Python calls, and one that kernels call
    compiled, linked = kernel(function, options), kernel(function, {**options, **_UNWRAPPED})
    template = linked.get_call_template
    # Numba would make a function of its own for each number that is written out in a call: 589 of them instead of 427.
    compiled.get_call_template = lambda args, kws: template(
        [types.unliteral(a) for a in args], {name: types.unliteral(a) for name, a in kws.items()}
    )
    compiled.get_overload = linked.get_overload
    return cast("Callable[..., Any]", compiled)


@contextmanager
def _numbas_cache() -> Iterator[bool]:
    """Have Numba keep what is decorated in a folder of this state of the package, and say whether it may.

    It looks at a kernel's own file, not at those of what the kernel calls.
    """
    folder, before = cache_folder() / f"plain-{_state()}", numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(folder)
    try:
        yield not why_not_kept(folder)
    finally:
        numba.config.CACHE_DIR = before


@cache
def _state() -> str:
    """Return a digest of the package and of what its kernels are made for."""
    package = Path(__file__).resolve().parents[1]
    parts = [version_of(name).encode() for name in ("numba", "llvmlite", "numpy", "mujoco")]
    parts += [path.read_bytes() for path in sorted(package.rglob("*.py"))]
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]
