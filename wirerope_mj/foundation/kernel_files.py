"""Compiled kernels on disk: a file for each kernel and its types, found by all that its code depends on.

The name of a file holds a digest of the kernel's code and of all that it reaches (`kernel_digest`), of the types it is compiled
for, of the versions of Python, Numba and LLVM, and of the processor. So a file is right or is not found, nothing is ever
written twice with different contents, and processes need not know of each other. Files are looked for in the package, which
ships them compiled for a level of processors (`cpu_level`), then in the user's cache. Reading one executes what it holds: the
cache is a folder of the user's that the environment names and no file does, and counts only while nobody else may write it.
"""

import hashlib
import os
import pickle
import stat
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
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
from wirerope_mj.foundation.own_files import file_doubt, folder_doubt

numba.core.config._config_fname = ""  # it looks for a file of settings in the current folder whenever it compiles

SHIPPED = Path(__file__).resolve().parents[1] / "_kernels"
"""Folder of the kernels that a built package brings along."""

LOADED: list[Path] = []
"""Files whose code this process uses."""

_CHECKSUM = hashlib.sha256().digest_size


def cache_folder() -> Path:
    """Return the folder of the kernels that are compiled here: NUMBA_CACHE_DIR if that is set, else in the user's cache.

    Of the environment only absolute paths count: a relative one would lead into whatever folder one stands in.
    """
    given = Path(os.environ.get("NUMBA_CACHE_DIR", ""))
    if given.is_absolute():
        return given
    root = Path(os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME", ""))
    if not root.is_absolute():
        root = Path.home() if sys.platform == "win32" else Path.home() / ".cache"
    return root / "wirerope_mj"


def where_kept(folder: Path) -> str:
    """Return the end of a sentence on compiled kernels: that they are kept in `folder`, or why they are not."""
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        doubt = _doubt(folder)
    except OSError as error:
        doubt = f"{folder} cannot be made ({error.strerror})"
    return f"they are not kept: {doubt}" if doubt else f"they are kept in {folder}"


@cache
def _doubt(folder: Path) -> str:
    """Say why a folder that is there is not used; "" if it is."""
    return folder_doubt(folder) if folder.is_absolute() else f"{folder} is a relative path"


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
            for path, own in ((SHIPPED / name, False), (cache_folder() / name, True)):
                payload = _read(path, own=own)
                if payload is not None:
                    try:
                        code = CompileResult._rebuild(target_context, *pickle.loads(payload))
                    except Exception:  # whatever a foreign file leads to: it is not used, and replaced
                        continue
                    LOADED.append(path)
                    return code
        return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        """Keep compiled code if that is possible; a later process compiles again otherwise."""
        path = cache_folder() / self._name(sig, data.codegen.magic_tuple())
        content = dumps(data._reduce())
        with suppress(OSError, RecordError):
            path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            if not _doubt(path.parent):
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


def _read(path: Path, *, own: bool) -> bytes | None:
    """Return the content of a file, or None: it is not there, cannot be read, or is not whole.

    Args:
        path: of the file.
        own: whether it and its folder must be the user's, and nobody else's to write.
    """
    try:
        with open(path, "rb", opener=_opened if own else None) as file:
            state = os.fstat(file.fileno())
            if not stat.S_ISREG(state.st_mode) or (own and (_doubt(path.parent) or file_doubt(state, str(path)))):
                return None
            content = file.read()
    except OSError:
        return None
    checksum, payload = content[:_CHECKSUM], content[_CHECKSUM:]
    return payload if hashlib.sha256(payload).digest() == checksum else None


def _opened(path: str, flags: int) -> int:
    """Open a file, but no link, and without waiting for one that would write into a pipe."""
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
