"""Kernels as they link each other: machine code is made of what Python or C calls, and of nothing else.

Numba optimises each function with all that it calls, translates that to machine code and writes wrappers that Python and C
could call, although most of our functions are called by kernels alone. That took half of the time of compiling them.

All that reaches into Numba for that stands here, and `jit` does without it where it does not work (`proof`). Kernels have
dispatchers, a target and a generator of code of their own; functions of others keep Numba's.
"""

import hashlib
import itertools
import os
import pickle
import sys
from collections.abc import Callable
from functools import cached_property
from typing import Any

import llvmlite
import numba
from numba.core.bytecode import FunctionIdentity
from numba.core.caching import _Cache
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen, RuntimeLinker
from numba.core.compiler import CompileResult, lookup_environment
from numba.core.registry import CPUDispatcher, CPUTarget, cpu_target
from numba.core.runtime import rtsys
from numba.core.serialize import dumps

from wirerope_mj.foundation.kernel_digest import digest
from wirerope_mj.foundation.kernel_files import LOADED, SHIPPED, cache_folder, keep, level, read

_ENVIRONMENT = "_ZN08NumbaEnv"  # begins the names under which code finds what a function raises
# Names of compiled functions end in a number: processes that read each other's files count from numbers of their own, for LLVM
# takes what it has read for what it is to compile where the names are one. The kernels of a wheel, which one process compiles,
# count from 0, as no other process does, so that two builds give the same bytes (`hatch_build.py`).
FunctionIdentity._unique_ids = itertools.count(int(os.environ.get("WIREROPE_KERNEL_NUMBER", os.getpid() << 16)))


class LinkedCode(JITCodeLibrary):
    """Code of a function and of all that it calls: it is optimised and translated when the address of one is asked for."""

    _translated = False

    def _optimize_final_module(self) -> None:
        """Do nothing: code is optimised with all that it calls when an address in it is asked for (`_translate`)."""

    def _finalize_final_module(self) -> None:
        """Take machine code that was read from a file; other code is translated when an address in it is asked for."""
        self._finalized = True
        if self._object_caching_enabled and self._compiled_object:
            self._translated = True
            super()._finalize_final_module()

    def get_pointer_to_function(self, name: str) -> int:
        """Return a function's address, 0 if this code does not define it."""
        self._ensure_finalized()
        if not self._translated:
            if not any(function.name == name and not function.is_declaration for function in self._final_module.functions):
                return 0
            self._translate()
        return int(super().get_pointer_to_function(name))

    def serialize_using_object_code(self) -> tuple[Any, ...]:
        """Return the content of a file of this code: machine code if it was translated, else LLVM's bitcode."""
        return tuple(super().serialize_using_object_code() if self._translated else self.serialize_using_bitcode())

    def _translate(self) -> None:
        """Optimise this code with all that it calls, translate it to machine code, and tell it where its environments are."""
        names = [variable.name for variable in self._final_module.global_variables]
        if any(name.startswith(RuntimeLinker.PREFIX) for name in names):  # functions that call each other, one not there yet
            rtsys.library.get_pointer_to_function("nrt_unresolved_abort")  # stands for it, and may not be translated meanwhile
        self._translated = True
        super()._optimize_final_module()
        super()._finalize_final_module()
        for name in names:
            environment = lookup_environment(name) if name.startswith(_ENVIRONMENT) else None
            if environment is not None:
                self._codegen.set_env(name, environment)


class LinkedCodegen(JITCPUCodegen):
    """Generator of the code of kernels."""

    _library_class = LinkedCode

    def set_env(self, env_name: str, env: Any) -> None:
        """Tell code where its environment is; code that is not translated has no place for it yet."""
        if self._engine.is_symbol_defined(env_name):
            super().set_env(env_name, env)


class KernelTarget(CPUTarget):
    """Numba's own processor, with types and functions as Numba knows them, but for the generator of code."""

    @property
    def typing_context(self) -> Any:
        return cpu_target.typing_context

    @cached_property
    def target_context(self) -> Any:
        return cpu_target.target_context.subtarget(_internal_codegen=LinkedCodegen("wirerope.kernels"))


_target = KernelTarget("cpu")


class KernelDispatcher(CPUDispatcher):
    """A kernel, as Python and other kernels call it."""

    targetdescr = _target


class KernelCallback(CFunc):
    """A kernel, as C calls it."""

    _targetdescr = _target


class KernelFiles(_Cache):
    """Files of the compiled code of one kernel, with the methods that Numba's dispatchers call."""

    def __init__(self, function: Callable[..., Any], **options: Any):
        self._function, self._options = function, options

    @property
    def cache_path(self) -> str:
        return str(cache_folder())

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        """Return the code for the types `sig`, or None if no file holds it whole."""
        rtsys.initialize(
            cpu_target.target_context
        )  # that code allocates; all else that a compiler needs is loaded where one is
        for processor in _processors(target_context.codegen()):
            name = self._name(sig, processor)
            for path, users in ((SHIPPED / name, False), (cache_folder() / name, True)):
                payload = read(path, own=users)
                if payload is not None:
                    try:
                        code = CompileResult._rebuild(target_context, *pickle.loads(payload))
                    except Exception as error:  # whatever a foreign file leads to: it is not used, and replaced
                        print(f"wirerope: {path} is compiled again: {type(error).__name__}: {error}", file=sys.stderr)
                        continue
                    LOADED.append(path)
                    return code
        return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        """Keep compiled code if possible; otherwise a later process compiles again."""
        keep(cache_folder() / self._name(sig, data.codegen.magic_tuple()), content_of(data))

    def enable(self) -> None:
        """Do nothing: Numba can switch its own caches on and off, and empty them; this one is always used."""

    disable = flush = enable

    def _name(self, sig: Any, processor: tuple[str, ...]) -> str:
        config = numba.config
        key = (
            (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, *processor),
            (int(config.OPT), config.BOUNDSCHECK, config.DEBUGINFO_DEFAULT),
            (digest(self._function), sorted(self._options.items()), str(sig)),
        )
        return f"{self._function.__name__}-{hashlib.sha256(repr(key).encode()).hexdigest()[:24]}.kernel"


def content_of(code: CompileResult) -> bytes:
    """Translate compiled code to machine code, and return the content of its file."""
    code.library.get_pointer_to_function(code.fndesc.llvm_cfunc_wrapper_name)  # machine code of what C calls
    return bytes(dumps(code._replace(type_annotation="")._reduce()))  # which nothing reads: as a text it takes a tenth of all


def _processors(codegen: Any) -> tuple[tuple[str, ...], ...]:
    """Return the processors to compile for: the level that ships and this one, or only what the user asks for."""
    this_one, shipped = codegen.magic_tuple(), level()
    if numba.config.CPU_NAME is not None or shipped is None:
        return (this_one,)
    return ((this_one[0], shipped, ""), this_one)


def kernel(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """Return a dispatcher of a kernel, compiled with Numba's `options` on its first call unless a file holds it."""
    dispatcher = KernelDispatcher(py_func=function, targetoptions={**options, "nopython": True, "boundscheck": None})
    dispatcher._cache = KernelFiles(function, **options)
    return dispatcher


def callback(function: Callable[..., Any], signature: Any) -> Any:
    """Return a C function of a Numba signature, compiled unless a file holds it."""
    compiled: Any = KernelCallback(function, (signature.args, signature.return_type), {}, {"nopython": True})
    compiled._cache = KernelFiles(function)
    compiled.compile()
    return compiled
