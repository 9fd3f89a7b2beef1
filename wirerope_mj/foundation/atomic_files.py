"""Files and folders that are written atomically: whole or not at all."""

import json
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
    is_hidden,
    is_of_place,
    locked,
    refusal,
    replaced_by_exchange,
    set_aside,
)
from wirerope_mj.foundation.interrupts import interrupts_held

# A command that removes what was left of a folder is done with it in a few milliseconds; one that writes it is not [s].
_PATIENCE = 1.0


@contextmanager
def atomic_file(path: Path, *, clear: bool = True) -> Iterator[Path]:
    """Yield a temporary file that is renamed to `path` when the block ends well, and removed when it does not.

    It lies in the same folder and has the same ending. With `clear`, what killed processes left there is removed first; without
    it for one of many thousand files, since looking through their folder for each of them would take hours.

    Raises:
        RecordError: nothing can be written in its folder.
        DiskFullError: its disk is full.
    """
    if clear:
        clear_half_written(path.parent)
    with place_named(path), hidden_file(path) as temporary:
        yield temporary
        temporary.chmod(0o644)  # mkstemp makes files that nobody else may read
        os.replace(temporary, path)


def json_text(content: object) -> str:
    """Return plain values as the text of a JSON file; ValueError for NaN and infinite numbers."""
    return json.dumps(content, indent=2, allow_nan=False) + "\n"


def write_json(path: Path, content: object) -> None:
    """Write plain values as a JSON file, whole or not at all."""
    with atomic_file(path) as temporary:
        temporary.write_text(json_text(content), encoding="utf-8")


def check_writable(path: Path, *, force: bool = True) -> None:
    """Raise RecordError if no file can be written at `path`, or one exists and must not be replaced: before long work.

    Folders are not made: one that is not there is a slip of the pen more often than a wish.
    """
    if path.is_dir():
        raise RecordError(f"{path}: this is a folder; a file is written here. Choose another place.")
    folder = path.absolute().parent
    if not folder.is_dir():
        raise RecordError(f"{path}: there is no folder {str(folder)!r}. Make it first, or choose another place.")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise RecordError(f"{path}: cannot write here (Permission denied). Choose another place.")
    if path.exists() and not force:
        raise RecordError(f"{path}: the file exists. Replace it with --force (`force=True`), or choose another name.")


def check_folder(folder: Path, *, force: bool, kind: str, marks: Sequence[str]) -> None:
    """Raise RecordError unless `folder` may be written: nothing is there, or a folder of its kind that `force` replaces.

    `kind` is what messages call it, `marks` are the files by which one is known.
    """
    if not folder.exists() and not folder.is_symlink():
        return
    if not folder.is_dir():
        raise RecordError(f"{folder}: this is a file; a {kind} is a folder. Choose another place.")
    if not any(folder.iterdir()):
        return
    if not all((folder / mark).is_file() for mark in marks):
        raise RecordError(f"{folder}: this folder exists and is not a {kind}; nothing in it was touched. Choose another one.")
    if not force:
        raise RecordError(
            f"{folder}: there is a {kind} already. Replace it with --force (`force=True`), or choose another one."
        )


@contextmanager
def atomic_folder(folder: Path, *, force: bool, kind: str, marks: Sequence[str]) -> Iterator[Path]:
    """Yield a temporary folder adjacent to `folder` that becomes it when the block ends well, and is removed when it does not.

    What killed processes left there is removed, too. The arguments are those of `check_folder`.

    Raises:
        RecordError: as `check_folder`; or another process is writing `folder`, or nothing can be written there.
        DiskFullError: the disk is full.
    """
    target = folder.resolve()
    clear_half_written(target.parent)
    check_folder(folder, force=force, kind=kind, marks=marks)
    missing = [parent for parent in target.parents if not parent.exists()]
    try:
        with place_named(folder), hidden_folder(target, patience=_PATIENCE) as temporary:
            if temporary is None:
                raise RecordError(
                    f"{folder}: another process is writing this {kind}. Nothing in it was touched; wait for that one, or "
                    "choose another folder."
                )
            check_folder(target, force=force, kind=kind, marks=marks)  # another process may just have ended
            yield temporary
            check_folder(target, force=force, kind=kind, marks=marks)
            _replace(temporary, target)
    except BaseException:
        for parent in missing:
            with suppress(OSError):  # it is not empty
                parent.rmdir()
        raise


@contextmanager
def worked_on_alone(folder: Path, *, kind: str) -> Iterator[None]:
    """Lock `folder` for the block, or raise RecordError if another process holds it; no effect where there are no locks."""
    with locked(folder) as lock:
        if lock == TAKEN:
            raise RecordError(
                f"{folder}: another process works on this {kind}. Nothing in it was touched; wait for that one, or choose "
                "another folder."
            )
        yield


@contextmanager
def place_named(path: Path) -> Iterator[None]:
    """Raise errors about hidden files that the block writes as errors about `path`, which the user knows.

    DiskFullError if there is no space left, RecordError if nothing can be written there.
    """
    try:
        yield
    except (RecordError, OSError) as error:
        reason = error.__cause__ if isinstance(error, RecordError) else error
        if not isinstance(reason, OSError) or not is_of_place(reason):
            raise
        if isinstance(error, RecordError) and not (isinstance(error, DiskFullError) or is_hidden(error)):
            raise
        raise refusal(path, reason) from reason


def _replace(temporary: Path, folder: Path) -> None:
    """Rename `temporary` to `folder`; the former folder is removed only after the new folder stands."""
    if not folder.exists():
        os.rename(temporary, folder)
        return
    with interrupts_held():
        if replaced_by_exchange(folder, temporary):
            return
        aside = set_aside(folder, folder)
        try:
            os.rename(temporary, folder)
        except BaseException:
            os.rename(aside, folder)
            raise
        shutil.rmtree(aside, ignore_errors=True)  # another process may do the same
