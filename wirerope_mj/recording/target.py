"""Where a recording goes: written beside its place in rerun's strict mode, then renamed."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from wirerope_mj.errors import RecordError
from wirerope_mj.recording.paths import FILE


def target_of(path: str | Path, *, file: str = FILE) -> Path:
    """Return the file that a recording at `path` is: a folder gets one called `file`."""
    target = Path(path)
    return target / file if target.is_dir() or target.suffix != ".rrd" else target


@contextmanager
def recorded_whole(target: Path) -> Iterator[Path]:
    """Rename what the block records beside `target` to it, and leave nothing behind if the block fails.

    Yields:
        The file to record.

    Raises:
        RecordError: the environment variable RERUN switches recordings off.
    """
    import rerun as rr
    from rerun.error_utils import strict_mode

    target.parent.mkdir(parents=True, exist_ok=True)
    beside = target.with_name(target.name + ".part")
    was_strict = strict_mode()
    rr.set_strict_mode(True)  # otherwise a wrong call loses data with no more than a warning
    try:
        yield beside
        if not beside.is_file():
            raise RecordError("nothing was recorded: the environment variable RERUN switches it off. Unset it.")
        os.replace(beside, target)
    finally:
        rr.set_strict_mode(was_strict)
        beside.unlink(missing_ok=True)
