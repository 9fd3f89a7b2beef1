"""Files and folders that are written whole or not at all."""

import glob
import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows has no such locks: there what a killed process leaves must be removed by hand
    fcntl = None  # type: ignore[assignment]

from wirerope_mj.errors import RecordError


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Rename what the block writes beside `path` to it, and leave nothing behind if the block fails.

    Yields:
        The file to write, in the same folder and with the same ending.

    Raises:
        RecordError: nothing can be written in its folder.
    """
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=f".part{path.suffix}")
    except OSError as error:
        raise RecordError(f"{path}: cannot write here ({error.strerror}).") from None
    os.close(handle)
    beside = Path(name)
    try:
        yield beside
        beside.chmod(0o644)  # mkstemp makes files that nobody else may read
        os.replace(beside, path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise


def check_place(path: Path) -> None:
    """Raise RecordError if no file can be written at `path`: cheap, before what takes time.

    Folders are not made: one that is not there is a slip of the pen more often than a wish.
    """
    if path.is_dir():
        raise RecordError(f"{path}: this is a folder; a file is written here. Choose another place.")
    folder = path.absolute().parent
    if not folder.is_dir():
        raise RecordError(f"{path}: there is no folder {str(folder)!r}. Make it first, or choose another place.")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise RecordError(f"{path}: cannot write here (Permission denied).")


def check_folder(folder: Path, *, force: bool, kind: str, marks: Sequence[str]) -> None:
    """Raise RecordError unless `folder` may be written: nothing is there, or a folder of its kind that `force` replaces.

    Args:
        folder: where something is to be written.
        force: whether it may replace another of its kind.
        kind: what messages call it.
        marks: files by which one is known.
    """
    if not folder.exists() and not folder.is_symlink():
        return
    if not folder.is_dir():
        raise RecordError(f"{folder}: this is a file; a {kind} is a folder. Choose another place.")
    if not any(folder.iterdir()):
        return
    if not all((folder / mark).is_file() for mark in marks):
        raise RecordError(
            f"{folder}: this folder exists and is not a {kind}; nothing in it was touched. Choose another one."
        )
    if not force:
        raise RecordError(
            f"{folder}: there is a {kind} already. Replace it with --force (`force=True`), or choose another one."
        )


@contextmanager
def folder_written_whole(folder: Path, *, force: bool, kind: str, marks: Sequence[str]) -> Iterator[Path]:
    """Yield a new folder beside `folder` that becomes it when the block ends well, and is removed when it does not.

    What a process that was killed left of the same folder is removed, too. The arguments are those of `check_folder`.
    """
    clear_beside(folder)
    check_folder(folder, force=force, kind=kind, marks=marks)
    folder = folder.resolve()
    missing = [parent for parent in folder.parents if not parent.exists()]
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", suffix=".part", dir=folder.parent))
    except OSError as error:
        raise RecordError(f"{folder}: cannot write here ({error.strerror}).") from None
    try:
        beside.chmod(0o755)  # mkdtemp makes folders that nobody else may read
        with _locked(beside):
            yield beside
            check_folder(folder, force=force, kind=kind, marks=marks)
            _put(beside, folder)
    except BaseException:
        shutil.rmtree(beside, ignore_errors=True)
        for parent in missing:
            if parent.is_dir() and not any(parent.iterdir()):
                parent.rmdir()
        raise


def clear_beside(folder: Path) -> None:
    """Put right what processes left beside `folder` that were killed while they wrote it whole.

    What was to be replaced comes back if nothing stands in its place yet, and is removed if it was replaced.
    """
    folder = folder.resolve()
    ending = re.compile(rf"\.{re.escape(folder.name)}\.[a-z0-9_]{{8}}\.(part|old)")  # as mkdtemp names what is beside
    left = [path for path in folder.parent.glob(f".{glob.escape(folder.name)}.*") if ending.fullmatch(path.name)]
    for part in (path for path in left if path.suffix == ".part"):
        with _locked(part) as lock:
            if lock == _HELD:
                shutil.rmtree(part, ignore_errors=True)
    for old in (path for path in left if path.suffix == ".old" and not path.with_suffix(".part").exists()):
        if folder.exists():
            shutil.rmtree(old, ignore_errors=True)
        else:
            os.rename(old, folder)


@contextmanager
def worked_on_alone(folder: Path, *, kind: str) -> Iterator[None]:
    """Hold `folder` for the block, so that no other process works on it; where there are no locks nobody is kept out.

    Raises:
        RecordError: another process holds it.
    """
    with _locked(folder) as lock:
        if lock == _TAKEN:
            raise RecordError(
                f"{folder}: another process works on this {kind}. Nothing in it was touched; wait for that one, or choose "
                "another folder."
            )
        yield


_HELD, _TAKEN, _UNKNOWN = "held", "taken", "unknown"
"""What came of a lock: it is ours, or another process has it, or there are no locks here."""


@contextmanager
def _locked(folder: Path) -> Iterator[str]:
    """Lock a folder for the block, and say what came of it: the lock of a process ends with it, however it ends."""
    if fcntl is None:
        yield _UNKNOWN
        return
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        yield _UNKNOWN
        return
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        lock = _HELD
    except BlockingIOError:
        lock = _TAKEN
    except OSError:  # of a file system that knows none
        lock = _UNKNOWN
    try:
        yield lock
    finally:
        os.close(handle)


def _put(beside: Path, folder: Path) -> None:
    """Rename `beside` to `folder`; what was there is removed only after the new one stands."""
    if not folder.exists():
        os.rename(beside, folder)
        return
    old = beside.with_suffix(".old")
    os.rename(folder, old)
    try:
        os.rename(beside, folder)
    except BaseException:
        os.rename(old, folder)
        raise
    shutil.rmtree(old)
