"""Compiled kernels on disk: a file for each kernel and its types, found by all that its code depends on.

The name of a file holds a digest of the kernel's code and of all that it reaches (`kernel_digest`), of the types it is compiled
for, of the versions of Python, Numba and LLVM, and of the processor. So a file is right or is not found, nothing is ever
written twice with different contents, and processes need not know of each other. Files are looked for in the package, which
ships them compiled for a level of processors (`level`), then in the user's cache. Reading one executes what it holds: the
cache is a folder of the user's that the environment names and no file does, and counts only while nobody else may write it.
"""

import hashlib
import os
import stat
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path

import llvmlite.binding as llvm
import numba

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError

_V2 = ("cx16", "popcnt", "sahf", "sse3", "ssse3", "sse4.1", "sse4.2")
_V3 = (*_V2, "avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave")
# Names of the levels as LLVM has them, the highest first, and the features that a processor of that level has. Source: System
# V ABI, AMD64 supplement, table 3.1.
LEVELS = {"x86-64-v3": _V3, "x86-64-v2": _V2}
# Whether the system has owners and modes; on Windows a folder of the user's profile is the user's by its access list.
_KNOWN = hasattr(os, "geteuid")
numba.core.config._config_fname = ""  # it looks for a file of settings in the current folder whenever it compiles
# Folder of the kernels that a built package brings along.
SHIPPED = Path(__file__).resolve().parents[1] / "_kernels"
# Files whose code this process uses.
LOADED: list[Path] = []
_CHECKSUM = hashlib.sha256().digest_size


@cache
def level() -> str | None:
    """Return the highest of the processor `LEVELS` that this machine supports, or None."""
    if not llvm.get_process_triple().startswith("x86_64"):
        return None
    present = {name for name, present_on_host in llvm.get_host_cpu_features().items() if present_on_host}
    return next((name for name, features in LEVELS.items() if present.issuperset(features)), None)


def file_doubt(state: os.stat_result, name: str) -> str:
    """Return who else may write a file with this status, "" if only the user may."""
    if not _KNOWN:
        return ""
    if state.st_uid != os.geteuid():
        return f"{name} belongs to another user"
    return _mode_doubt(state, name)


def _mode_doubt(state: os.stat_result, name: str) -> str:
    """Return a clause if the mode of a file or folder lets others write it, else ""."""
    group = state.st_mode & stat.S_IWGRP and not _is_own_group(state.st_gid)
    return f"others may write {name} (chmod go-w)" if state.st_mode & stat.S_IWOTH or group else ""


def _is_own_group(number: int) -> bool:
    """Tell whether a group has its user as the only member, as many systems make a group for every user."""
    import grp
    import pwd

    try:
        user, group = pwd.getpwuid(os.geteuid()), grp.getgrgid(number)
    except KeyError:
        return False
    return user.pw_gid == number and group.gr_name == user.pw_name and set(group.gr_mem) <= {user.pw_name}


def cache_folder() -> Path:
    """Return the folder of the kernels that are compiled here: NUMBA_CACHE_DIR if that is set, else in the user's cache.

    Of the environment only absolute paths count: a relative one would lead into whatever folder one stands in.
    """
    stated = Path(os.environ.get("NUMBA_CACHE_DIR", ""))
    if stated.is_absolute():
        return stated
    root = Path(os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME", ""))
    if not root.is_absolute():
        root = Path.home() if sys.platform == "win32" else Path.home() / ".cache"
    return root / "wirerope_mj"


def where_kept(folder: Path) -> str:
    """Return the clause that says where compiled kernels are kept, or why they are not."""
    doubt = why_not_kept(folder)
    return f"they are not kept: {doubt}" if doubt else f"they are kept in {folder}"


def why_not_kept(folder: Path) -> str:
    """Make a folder for compiled kernels; returns the reason why they are not kept there, "" if they are."""
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        return _folder_doubt(folder)
    except OSError as error:
        return f"{folder} cannot be made ({error.strerror})"


@cache
def _folder_doubt(folder: Path) -> str:
    """Return the reason why an existing folder is not used: who else may write or replace it; "" if it is.

    The folders above it count, too, and those that links lead through; in one with the sticky bit, such as /tmp, nobody may
    rename what is somebody else's.
    """
    if not folder.is_absolute():
        return f"{folder} is a relative path"
    if not _KNOWN:
        return ""
    real = folder.resolve()
    if doubt := file_doubt(real.stat(), str(real)):
        return doubt
    for parent in sorted({*folder.parents, *real.parents}):
        state = parent.stat()
        if state.st_uid not in (0, os.geteuid()):
            return f"{parent} belongs to another user"
        if not state.st_mode & stat.S_ISVTX and (doubt := _mode_doubt(state, str(parent))):
            return doubt
    return ""


def keep(path: Path, content: bytes) -> None:
    """Write a file with its checksum if possible; if it is not kept, a later process computes it again."""
    with suppress(OSError, RecordError):
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        if not _folder_doubt(path.parent):
            with atomic_file(path, clear=False) as temporary:
                temporary.write_bytes(hashlib.sha256(content).digest() + content)


def read(path: Path, *, own: bool) -> bytes | None:
    """Read a file; None if it is missing, unreadable or damaged, or, with `own`, if others may write it."""
    try:
        with open(path, "rb", opener=_opened if own else None) as file:
            state = os.fstat(file.fileno())
            if not stat.S_ISREG(state.st_mode) or (own and (_folder_doubt(path.parent) or file_doubt(state, str(path)))):
                return None
            content = file.read()
    except OSError:
        return None
    checksum, payload = content[:_CHECKSUM], content[_CHECKSUM:]
    return payload if hashlib.sha256(payload).digest() == checksum else None


def _opened(path: str, flags: int) -> int:
    """Open a file, but no link, without waiting for a writer if it is a pipe."""
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
