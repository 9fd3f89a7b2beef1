"""Whether kernels can be linked and kept with the Numba that is installed: tried once with small ones, and noted."""

import ctypes
import hashlib
import multiprocessing
import pickle
import sys
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from numba import types

from wirerope_mj.foundation.kernel_files import SHIPPED, cache_folder, keep, read

TESTED = "0.68"  # The newest Numba that all tests have seen, as in pyproject.toml
_HERE = Path(__file__).resolve().parent


@cache
def doubt() -> str:
    """Return the reason why kernels cannot be linked and kept, also on standard error; "" if they can."""
    if numba.config.DISABLE_JIT:
        return "Numba's compiler is switched off"
    reason = _doubt()
    if reason and multiprocessing.parent_process() is None:
        print(
            f"wirerope: kernels are compiled by Numba alone, which takes twice as long: of {numba.__version__} it is not known "
            f"how to link them ({reason}). Remedy: pip install 'numba=={TESTED}.*'.",
            file=sys.stderr, flush=True,
        )  # fmt: skip
    return reason


def _doubt() -> str:
    """Read the result of an earlier proof from its note, or else prove it now and write the note; "" if nothing is in doubt."""
    try:
        from wirerope_mj.foundation import linked_code
    except Exception as error:  # whatever a class that is not there any more leads to
        return f"{type(error).__name__}: {error}"
    name = proof_name()
    for path, users in ((SHIPPED / name, False), (cache_folder() / name, True)):
        note = read(path, own=users)
        if note is not None:
            return note.decode()
    try:
        _try(linked_code)
        reason = ""
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        if isinstance(error, MemoryError | OSError):  # says nothing of Numba, and may not come again
            return reason
    keep(cache_folder() / name, reason.encode())
    return reason


def proof_name() -> str:
    """Return the name of the note on the proof: a digest of the versions and of the code that is tried."""
    from wirerope_mj.foundation import linked_code
    from wirerope_mj.foundation.kernel_digest import code_texts

    used = (
        linked_code.JITCodeLibrary, linked_code.JITCPUCodegen, linked_code.RuntimeLinker, linked_code.CompileResult,
        linked_code.CPUDispatcher, linked_code.CFunc, linked_code.CPUTarget, linked_code.FunctionIdentity,
    )  # fmt: skip
    parts = [sys.implementation.cache_tag, numba.__version__, llvmlite.__version__]
    parts += [(_HERE / f"{name}.py").read_text(encoding="utf-8") for name in ("linked_code", "kernel_proof")]
    for base in dict.fromkeys(base for kind in used for base in kind.__mro__ if base.__module__.startswith("numba.")):
        for name, member in sorted(vars(base).items()):
            code = getattr(getattr(member, "__func__", member), "__code__", None)
            parts += [f"{base.__qualname__}.{name}", *(code_texts(code) if code else ())]
    return f"numba-{hashlib.sha256(chr(10).join(parts).encode()).hexdigest()[:24]}.proof"


def _root(x: float) -> float:
    if x < 0.0:
        raise ValueError("negative")
    return float(x**0.5)


def _try(linked: Any) -> None:
    """Compile two linked kernels and a C function, read one back, and call them; raise what does not work."""
    options = {"error_model": "numpy", "nogil": True}
    inner = linked.kernel(_root, {**options, "no_cpython_wrapper": True, "no_cfunc_wrapper": True})

    def outer(values):  # type: ignore[no-untyped-def]
        return inner(values[0]) + values.copy().size

    signature, values = types.float64(types.float64[::1]), np.array([4.0])
    whole = linked.KernelDispatcher(py_func=outer, targetoptions={**options, "nopython": True, "boundscheck": None})
    inner._cache = whole._cache  # none: nothing of this is kept
    whole.compile(signature.args)
    code = whole.overloads[signature.args]
    content, apart = linked.content_of(code), linked.KernelTarget("cpu")
    read_again = linked.CompileResult._rebuild(apart.target_context, *pickle.loads(content))
    called = linked.KernelCallback(_root, ((types.float64,), types.float64), {}, {"nopython": True})
    called.compile()
    results = [
        whole(values),
        read_again.entry_point(values),
        1.0 + ctypes.CFUNCTYPE(*[ctypes.c_double] * 2)(called.address)(4.0),
    ]
    if results != [3.0] * 3:
        raise RuntimeError(f"3.0 three times is right, got {results}")
    (small,) = inner.overloads.values()
    if not isinstance(small.library, linked.LinkedCode) or small.library._translated:
        raise RuntimeError("each kernel is translated by itself")
    for function in (whole, read_again.entry_point):
        try:
            function(-values)
        except ValueError:
            continue
        raise RuntimeError("an error that a kernel raises is lost")
