"""Compiled kernels on disk: a file for each kernel and its types, found by all that its code depends on.

The name of a file holds a digest of the kernel's code and of all that it reaches (`kernel_digest`), of the types it is compiled
for, of the versions of Python, Numba and LLVM, and of the processor. So a file is right or is not found, nothing is ever
written twice with different contents, and processes need not know of each other. Files are looked for in the package, which
ships them compiled for a level of processors (`cpu_level`), then in the user's cache.
"""

import hashlib
import os
import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import llvmlite
import numba
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.cpu_level import level
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.kernel_digest import digest

SHIPPED = Path(__file__).resolve().parents[1] / "_kernels"
"""Folder of the kernels that a built package brings along."""

LOADED: list[Path] = []
"""Files whose code this process uses."""

_CHECKSUM = hashlib.sha256().digest_size


def cache_folder() -> Path:
    """Return the folder of the kernels that are compiled here: NUMBA_CACHE_DIR if that is set, else in the user's cache."""
    if numba.config.CACHE_DIR:
        return Path(numba.config.CACHE_DIR)
    if sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA", Path.home()))
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root / "wirerope_mj"


class KernelFiles(_Cache):
    """Compiled code of one kernel, as Numba's dispatchers ask for it."""

    def __init__(self, function: Callable[..., Any], **options: Any):
        """Take the kernel, and how it is compiled."""
        self._function, self._options = function, options

    @property
    def cache_path(self) -> str:
        """Folder that is written to."""
        return str(cache_folder())

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        """Return the code for the types `sig`, or None if no file holds it whole."""
        target_context.refresh()
        for processor in _processors(target_context.codegen()):
            name = self._name(sig, processor)
            for folder in (SHIPPED, cache_folder()):
                payload = _read(folder / name)
                if payload is not None:
                    try:
                        code = CompileResult._rebuild(target_context, *pickle.loads(payload))
                    except Exception:  # whatever a foreign file leads to: it is not used, and replaced
                        continue
                    LOADED.append(folder / name)
                    return code
        return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        """Keep compiled code if that is possible; a later process compiles again otherwise."""
        path = cache_folder() / self._name(sig, data.codegen.magic_tuple())
        content = dumps(data._reduce())
        with suppress(OSError, RecordError):
            path.parent.mkdir(parents=True, exist_ok=True)
            with atomic_file(path, clear=False) as temporary:
                temporary.write_bytes(hashlib.sha256(content).digest() + content)

    def enable(self) -> None:
        """Do nothing: it is always used."""

    def disable(self) -> None:
        """Do nothing: it is always used."""

    def flush(self) -> None:
        """Do nothing: no file is ever wrong."""

    def _name(self, sig: Any, processor: tuple[str, ...]) -> str:
        config = numba.config
        key = (
            (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, *processor),
            (int(config.OPT), config.BOUNDSCHECK, config.DEBUGINFO_DEFAULT),
            (digest(self._function), sorted(self._options.items()), str(sig)),
        )
        return f"{self._function.__name__}-{hashlib.sha256(repr(key).encode()).hexdigest()[:24]}.kernel"


def _processors(codegen: Any) -> tuple[tuple[str, ...], ...]:
    """Return what code may be compiled for: the level that ships, and this processor; or only what the user asks for."""
    own, shipped = codegen.magic_tuple(), level()
    if numba.config.CPU_NAME is not None or shipped is None:
        return (own,)
    return ((own[0], shipped, ""), own)


def _read(path: Path) -> bytes | None:
    """Return the content of a file, or None: it is not there, cannot be read, or is not whole."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    checksum, payload = content[:_CHECKSUM], content[_CHECKSUM:]
    return payload if hashlib.sha256(payload).digest() == checksum else None
