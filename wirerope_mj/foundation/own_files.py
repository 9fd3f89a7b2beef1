"""Who may write a file or a folder: what is executed is taken only from where nobody but its user may put it."""

import os
import stat
from pathlib import Path

_KNOWN = hasattr(os, "geteuid")
"""Whether the system has owners and modes; on Windows a folder of the user's profile is the user's by its access list."""


def folder_doubt(folder: Path) -> str:
    """Say who else may write a folder, or put another one in its place; "" if only its user and the system may.

    The folders above it count, too, and those that links lead through; in one with the sticky bit, such as /tmp, nobody may
    rename what is somebody else's.
    """
    if not _KNOWN:
        return ""
    real, above = folder.resolve(), {*folder.absolute().parents, *folder.resolve().parents}
    doubt = file_doubt(real.stat(), str(real))
    for parent in sorted(above):
        if not doubt:
            doubt = _parent_doubt(parent.stat(), str(parent))
    return doubt


def file_doubt(state: os.stat_result, name: str) -> str:
    """Say who else may write what has this state; "" if it is the user's and nobody else may."""
    if not _KNOWN:
        return ""
    if state.st_uid != os.geteuid():
        return f"{name} belongs to another user"
    return _mode_doubt(state, name)


def _parent_doubt(state: os.stat_result, name: str) -> str:
    if state.st_uid not in (0, os.geteuid()):
        return f"{name} belongs to another user"
    return "" if state.st_mode & stat.S_ISVTX else _mode_doubt(state, name)


def _mode_doubt(state: os.stat_result, name: str) -> str:
    group = state.st_mode & stat.S_IWGRP and not _is_own_group(state.st_gid)
    return f"others may write {name} (chmod go-w)" if state.st_mode & stat.S_IWOTH or group else ""


def _is_own_group(number: int) -> bool:
    """Return whether a group is that of its user alone, as many systems make one for everybody."""
    import grp
    import pwd

    try:
        user, group = pwd.getpwuid(os.geteuid()), grp.getgrgid(number)
    except KeyError:
        return False
    return user.pw_gid == number and group.gr_name == user.pw_name and set(group.gr_mem) <= {user.pw_name}
