"""Code of kernels as they link each other: machine code is made of what Python or C calls, and of nothing else.

Numba optimises each function with all that it calls, translates that to machine code and writes wrappers that Python and C
could call, although most of our functions are called by kernels alone. That took half of the time of compiling them.
"""

from typing import Any

from numba.core.codegen import JITCodeLibrary, JITCPUCodegen, RuntimeLinker
from numba.core.compiler import lookup_environment
from numba.core.runtime import rtsys

_ENVIRONMENT = "_ZN08NumbaEnv"  # begins the names under which code finds what a function raises
_set_env = JITCPUCodegen.set_env


class LinkedCode(JITCodeLibrary):
    """Code of a function and of all that it calls: it is optimised and translated when the address of one is asked for."""

    _translated = False

    def _optimize_final_module(self) -> None:
        """Leave that to what links this code."""

    def _finalize_final_module(self) -> None:
        """Take machine code that was read from a file; leave the rest until it is asked for."""
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
        """Return what a file holds: machine code if there is any."""
        return tuple(super().serialize_using_object_code() if self._translated else self.serialize_using_bitcode())

    def _translate(self) -> None:
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


def _set_env_if_there(self: Any, name: str, environment: Any) -> None:
    """Tell code where its environment is; code that is not translated has no place for it yet."""
    if self._engine.is_symbol_defined(name):
        _set_env(self, name, environment)


for _name, _value in (("_library_class", LinkedCode), ("set_env", _set_env_if_there)):
    setattr(JITCPUCodegen, _name, _value)
