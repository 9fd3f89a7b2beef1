"""Files that are written whole or not at all."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Rename what the block writes beside `path` to it, and leave nothing behind if the block fails.

    Yields:
        The file to write, in the same folder and with the same ending.
    """
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=f".part{path.suffix}")
    os.close(handle)
    beside = Path(name)
    try:
        yield beside
        beside.chmod(0o644)  # mkstemp makes files that nobody else may read
        os.replace(beside, path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise
