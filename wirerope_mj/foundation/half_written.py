"""Hidden files and folders in which results are written: locked while their process lives, removed after its end.

A file FOLDER/NAME.ENDING is written as FOLDER/.NAME.xxxxxxxx.wirerope.part.ENDING, a folder FOLDER/NAME as
FOLDER/.NAME.wirerope.part; what a folder replaces is called .NAME.xxxxxxxx.wirerope.old until it has been removed. Whoever
writes holds a lock, which ends with its process, however that ends: what can be locked by another one has been left behind.
"""

import ctypes
import errno
import os
import re
import secrets
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from wirerope_mj.foundation.errors import DiskFullError, RecordError
from wirerope_mj.foundation.interrupts import at_end, interrupts_held

try:
    import fcntl
except ImportError:  # Windows has no such locks: there what a killed process leaves must be removed by hand
    fcntl = None  # type: ignore[assignment]

# In every hidden name: nobody else's files have it, so that none of them is ever removed.
_MARK = "wirerope"

_FILE = re.compile(rf"\..*\.[a-z0-9_]{{8}}\.{_MARK}\.part(\.[^.]+)?")
_FOLDER = re.compile(rf"\.(?P<name>.+)\.{_MARK}\.part")
_ASIDE = re.compile(rf"\.(?P<name>.+)\.[0-9a-f]{{8}}\.{_MARK}\.old")

# Errors of the operating system that say that there is no room: on the disk, in the quota, or for so large a file.
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# Errors that say that the place of a file is out of order: its disk, or the way to it.
_BROKEN = (errno.EIO, errno.EROFS, errno.ENODEV, errno.ENXIO, errno.ESTALE, errno.ETIMEDOUT)
# AT_FDCWD and RENAME_EXCHANGE of Linux, as fcntl.h and stdio.h have them.
_HERE, _EXCHANGE = -100, 2
# Outcomes of locking: it is ours, another process has it, nothing is there to lock, or there are no locks here.
HELD, TAKEN, GONE, UNKNOWN = "held", "taken", "gone", "unknown"


@contextmanager
def locked(path: Path) -> Iterator[str]:
    """Lock a file or a folder for the block, and yield the outcome: `HELD`, `TAKEN`, `GONE` or `UNKNOWN`."""
    lock, handle = _lock(path)
    try:
        yield lock
    finally:
        if handle is not None:
            os.close(handle)


# Folders in which this process has hidden files or folders, and the handles that hold their locks.
_written: list[tuple[Path, int | None]] = []


def _let_go(folder: Path, handle: int | None) -> None:
    """Close the handle that holds a lock, and forget its folder."""
    with suppress(ValueError):
        _written.remove((folder, handle))
    if handle is not None:
        os.close(handle)


def _clear_unfinished() -> None:
    """Remove the unfinished files of this process, as the next process would."""
    unfinished = list(_written)
    for _, handle in unfinished:
        if handle is not None and fcntl is not None:
            with suppress(OSError):
                fcntl.flock(handle, fcntl.LOCK_UN)
    for folder in {folder for folder, _ in unfinished}:
        clear_half_written(folder)


at_end(_clear_unfinished)


@contextmanager
def hidden_file(path: Path) -> Iterator[Path]:
    """Yield a new locked hidden file in the folder of `path`, with its ending; removed afterwards if it still exists.

    Raises:
        RecordError: no file can be made there.
    """
    name, handle = "", None
    try:
        with interrupts_held(), _refused(path):
            while True:
                handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=f".{_MARK}.part{path.suffix}")
                if _lock_handle(handle, Path(name)) in (HELD, UNKNOWN):
                    break
                os.close(handle)  # between its making and its locking another process took it for one that was left
            if fcntl is None:
                os.close(handle)  # Windows renames no file that is open
                handle = None
            _written.append((path.parent, handle))
        yield Path(name)
    finally:
        with interrupts_held():
            if name:
                Path(name).unlink(missing_ok=True)
            _let_go(path.parent, handle)


@contextmanager
def hidden_folder(folder: Path, *, patience: float = 0.0) -> Iterator[Path | None]:
    """Yield the hidden folder in which `folder` is written, empty and locked, or None if another process writes `folder`.

    There is one for each folder, so that two processes never write the same one. Where there are no locks nobody is kept out.
    It is removed if it is still there. For `patience` [s] another process may hold it, perhaps only to remove what was left.

    Raises:
        RecordError: no folder can be made there.
    """
    hidden, lock, handle, end = folder, "", None, time.monotonic() + patience
    try:
        while not lock or (lock == TAKEN and time.monotonic() < end):
            if lock == TAKEN:
                time.sleep(0.05)
            with interrupts_held(), _refused(folder):
                hidden, lock, handle = _locked_hidden_folder(folder)
                if lock != TAKEN:
                    _written.append((folder.parent, handle))
        if lock == HELD:
            for path in hidden.iterdir():
                _remove(path)
            for path in folder.parent.iterdir():  # what an earlier process set aside for the folder
                match = _ASIDE.fullmatch(path.name)
                if match and match["name"] == folder.name:
                    if folder.exists():
                        _remove(path)
                    else:
                        os.rename(path, folder)
        yield None if lock == TAKEN else hidden
    finally:
        with interrupts_held():
            # Else it has become `folder`, and another process may hold a new one.
            if lock not in ("", TAKEN) and (handle is None or _names(hidden, handle)):
                shutil.rmtree(hidden, ignore_errors=True)
            _let_go(folder.parent, handle)


def _locked_hidden_folder(folder: Path) -> tuple[Path, str, int | None]:
    """Make the hidden folder of `folder` and lock it; returns it, the outcome of locking, and the lock's handle."""
    hidden = folder.parent / f".{folder.name}.{_MARK}.part"
    lock, handle = GONE, None
    while lock == GONE and not hidden.is_symlink():
        with suppress(FileExistsError):
            hidden.mkdir(parents=True)
        if not hidden.is_dir() and hidden.exists():  # a pipe, say: another name is taken
            break
        lock, handle = _lock(hidden)
    if lock in (HELD, TAKEN):
        return hidden, lock, handle
    with suppress(OSError):
        hidden.rmdir()
    alone = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", suffix=f".{_MARK}.part", dir=folder.parent))
    alone.chmod(0o755)  # mkdtemp makes folders that nobody else may read
    return alone, UNKNOWN, None


def replaced_by_exchange(folder: Path, hidden: Path) -> bool:
    """Swap `folder` with its hidden folder in one step and remove the old content; False where systems cannot.

    Raises:
        OSError: the operating system and the file system can, and it failed: nothing has changed.
    """
    renameat2 = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None) if sys.platform == "linux" else None
    if renameat2 is None:
        return False
    with locked(folder):  # with its hidden name nobody else may write into it
        if renameat2(_HERE, os.fsencode(hidden), _HERE, os.fsencode(folder), _EXCHANGE):
            if (number := ctypes.get_errno()) in (errno.ENOSYS, errno.EINVAL):
                return False
            raise OSError(number, os.strerror(number), str(hidden))
        aside = hidden
        with suppress(OSError):
            aside = set_aside(hidden, folder)
    shutil.rmtree(aside, ignore_errors=True)  # another process may do the same
    return True


def set_aside(path: Path, folder: Path) -> Path:
    """Rename `path`, the former `folder`, to a hidden name that says so, and return it."""
    aside = folder.parent / f".{folder.name}.{secrets.token_hex(4)}.{_MARK}.old"
    os.rename(path, aside)
    return aside


def refusal(path: Path, error: OSError) -> RecordError:
    """Return the error that explains why nothing can be written at `path`."""
    if not is_full(error):
        reason = os.strerror(error.errno) if error.errno else str(error)
        return RecordError(f"{path}: cannot write here ({reason}). Choose another place.")
    return DiskFullError(
        f"{path}: there is no space left for it ({os.strerror(error.errno or errno.ENOSPC)}); nothing half-written was left "
        "behind. Free some space, or choose another place."
    )


@contextmanager
def _refused(path: Path) -> Iterator[None]:
    """Raise errors of the operating system in the block as refusals about `path`."""
    try:
        yield
    except OSError as error:
        raise refusal(path, error) from error


def is_of_place(error: OSError) -> bool:
    """Tell whether an error of the operating system concerns the place that is written to, and no other file."""
    named = error.filename, error.filename2
    return is_full(error) or any(map(is_hidden, named)) or (named == (None, None) and error.errno in _BROKEN)


def is_hidden(text: object) -> bool:
    """Tell whether a text names one of the hidden files or folders."""
    return f".{_MARK}.part" in str(text) or f".{_MARK}.old" in str(text)


def is_full(error: OSError) -> bool:
    """Tell whether an error of the operating system says that there is no space left."""
    return error.errno in _FULL


def clear_half_written(folder: Path) -> None:
    """Remove what ended processes left half-written in `folder`, and restore what they had set aside."""
    try:
        hidden = [folder / name for name in os.listdir(folder) if name.startswith(".") and _MARK in name]
    except OSError:  # nothing is there, or nobody may look
        return
    for path in hidden:
        if _FILE.fullmatch(path.name) and path.is_file():
            with suppress(OSError), locked(path) as lock:
                if lock == HELD:
                    path.unlink(missing_ok=True)
    matches = [_FOLDER.fullmatch(path.name) or _ASIDE.fullmatch(path.name) for path in hidden if path.is_dir()]
    for name in {match["name"] for match in matches if match}:
        with suppress(OSError), hidden_folder(folder / name):
            pass  # which puts right what was left of it


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _lock(path: Path) -> tuple[str, int | None]:
    """Lock a path, and return the outcome and the open handle that holds the lock."""
    while True:
        try:
            handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))  # a pipe of that name makes nobody wait
        except FileNotFoundError:
            return GONE, None
        except OSError:
            return UNKNOWN, None
        lock = _lock_handle(handle, path)
        if lock == HELD:
            return lock, handle
        os.close(handle)
        if lock != GONE:
            return lock, None


def _lock_handle(handle: int, path: Path) -> str:
    """Lock an open file or folder; `GONE` if `path` no longer names it, having been removed or renamed."""
    if fcntl is None:
        return UNKNOWN
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return TAKEN
    except OSError:  # of a file system that knows none
        return UNKNOWN
    return HELD if _names(path, handle) else GONE


def _names(path: Path, handle: int) -> bool:
    """Tell whether a path still leads to the file or folder that a handle has open."""
    try:
        return os.path.samestat(os.fstat(handle), os.stat(path))
    except FileNotFoundError:
        return False
