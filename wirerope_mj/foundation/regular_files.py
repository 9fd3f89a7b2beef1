"""Regular files alone are read: a pipe gives its content once and perhaps never, a device without end."""

import errno
from pathlib import Path


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
