"""Files that are written whole or not at all."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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
