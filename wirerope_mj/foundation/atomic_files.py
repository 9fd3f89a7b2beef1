"""Files and folders that are written whole or not at all."""

import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from wirerope_mj.foundation.errors import DiskFullError, RecordError
from wirerope_mj.foundation.half_written import (
    TAKEN,
    clear_half_written,
    hidden_file,
    hidden_folder,
    is_full,
    locked,
    refusal,
    set_aside,
)

_PATIENCE = 1.0
"""A command that removes what was left of a folder is done with it in a few milliseconds; one that writes it is not [s]."""


@contextmanager
def atomic_file(path: Path, *, clear: bool = True) -> Iterator[Path]:
    """Rename what the block writes beside `path` to it, and leave nothing behind if the block fails.

    Args:
        path: the file.
        clear: whether what killed processes left in its folder is removed first: for one who writes there once. Looking through
            a folder of many thousand files for each of them would take hours.

    Yields:
        The file to write, in the same folder and with the same ending.

    Raises:
        RecordError: nothing can be written in its folder.
        DiskFullError: its disk is full.
    """
    if clear:
        clear_half_written(path.parent)
    with full_disk_said(path), hidden_file(path) as beside:
        yield beside
        beside.chmod(0o644)  # mkstemp makes files that nobody else may read
        os.replace(beside, path)


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
        raise RecordError(f"{path}: cannot write here (Permission denied). Choose another place.")


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
def atomic_folder(folder: Path, *, force: bool, kind: str, marks: Sequence[str]) -> Iterator[Path]:
    """Yield a new folder beside `folder` that becomes it when the block ends well, and is removed when it does not.

    What killed processes left beside it is removed, too. The arguments are those of `check_folder`.

    Raises:
        RecordError: as `check_folder`; or another process is writing `folder`, or nothing can be written there.
        DiskFullError: the disk is full.
    """
    clear_half_written(folder.resolve().parent)
    check_folder(folder, force=force, kind=kind, marks=marks)
    place, folder = folder, folder.resolve()
    missing = [parent for parent in folder.parents if not parent.exists()]
    try:
        with full_disk_said(place), hidden_folder(folder, patience=_PATIENCE) as beside:
            if beside is None:
                raise RecordError(
                    f"{place}: another process is writing this {kind}. Nothing in it was touched; wait for that one, or "
                    "choose another folder."
                )
            check_folder(folder, force=force, kind=kind, marks=marks)  # another process may just have ended
            yield beside
            check_folder(folder, force=force, kind=kind, marks=marks)
            _put(beside, folder)
    except BaseException:
        for parent in missing:
            with suppress(OSError):  # it is not empty
                parent.rmdir()
        raise


@contextmanager
def worked_on_alone(folder: Path, *, kind: str) -> Iterator[None]:
    """Hold `folder` for the block, so that no other process works on it; where there are no locks nobody is kept out.

    Raises:
        RecordError: another process holds it.
    """
    with locked(folder) as lock:
        if lock == TAKEN:
            raise RecordError(
                f"{folder}: another process works on this {kind}. Nothing in it was touched; wait for that one, or choose "
                "another folder."
            )
        yield


@contextmanager
def full_disk_said(place: Path) -> Iterator[None]:
    """Raise DiskFullError about `place`, which people know, if the block finds the disk full, wherever it does.

    Raises:
        DiskFullError: there is no space left.
    """
    try:
        yield
    except (DiskFullError, OSError) as error:
        reason = error.__cause__ if isinstance(error, DiskFullError) else error
        if not isinstance(reason, OSError) or not is_full(reason):
            raise
        raise refusal(place, reason) from reason


def _put(beside: Path, folder: Path) -> None:
    """Rename `beside` to `folder`; what was there is removed only after the new one stands."""
    if not folder.exists():
        os.rename(beside, folder)
        return
    aside = set_aside(folder)
    try:
        os.rename(beside, folder)
    except BaseException:
        os.rename(aside, folder)
        raise
    shutil.rmtree(aside, ignore_errors=True)  # another process may do the same
