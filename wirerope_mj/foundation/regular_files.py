"""Files that are read: regular ones, for a pipe gives its content once and a device never ends, and inside their own folder."""

import errno
from os.path import isfile  # as `Path.is_file`, but a name that is too long is none
from pathlib import Path

from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import quoted


def regular(path: str | Path) -> Path:
    """Return a path unless something else than a regular file or a folder is there, links followed.

    Every reader asks this before it opens a file, and treats it as what the system says when it cannot be read.

    Raises:
        OSError: a pipe, a socket or a device is there; ENODEV, which `why_unread` explains.
    """
    path = Path(path)
    if path.exists() and not path.is_file() and not path.is_dir():
        raise OSError(errno.ENODEV, "not a regular file", str(path))
    return path


def is_inside(path: Path, folder: Path) -> bool:
    """Return whether a path leads to something in a folder, links resolved; a name that no file can have does not."""
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError):
        return False


def file_inside(folder: Path, name: object, kind: str) -> Path:
    """Return the path of the file `name` of a run or a study.

    Raises:
        RecordError: it does not lie in the folder, or is not there.
    """
    if isinstance(name, str) and is_inside(folder / name, folder) and isfile(folder / name):
        return folder / name
    raise RecordError(
        f"{folder}: the {kind} {quoted(name)} is not in this folder, and nothing outside it is read. Take the file from "
        "another copy of the folder."
    )
