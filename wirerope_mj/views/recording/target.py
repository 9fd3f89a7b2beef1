"""Files of recordings: written atomically, in rerun's strict mode."""

import os
import threading
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import rerun as rr
from rerun.error_utils import strict_mode

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.views.recording.paths import APPLICATION, KnownLetters
from wirerope_mj.views.recording.viewer import FILE

_BLOCK = 2**20  # Of a recording, written at once [bytes]
_OPEN_FILES = Path("/dev/fd")  # Folder in which Linux and macOS give an open pipe a path


def target_of(path: str | Path, *, file: str = FILE) -> Path:
    """Return the file that a recording at `path` is: a folder gets one called `file`."""
    target = Path(path)
    return target / file if target.is_dir() or target.suffix != ".rrd" else target


@contextmanager
def atomic_recording(target: Path, *, application: str = APPLICATION) -> Iterator[rr.RecordingStream]:
    """Write what the block logs as `target`, and leave nothing behind if the block fails.

    The viewer has one layout for all recordings of an application.

    Yields:
        The rerun recording to log to.

    Raises:
        RecordError: the environment variable RERUN switches recordings off.
        DiskFullError: there is no space left.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    was_strict = strict_mode()
    rr.set_strict_mode(True)  # otherwise a wrong call loses data with no more than a warning
    try:
        with atomic_file(target) as temporary:
            with (
                _ourselves_written(temporary) as pipe,
                rr.RecordingStream(application, recording_id=uuid.uuid4()) as rec,
            ):
                rec.set_log_time_enabled(False)
                rec.save(pipe)
                yield KnownLetters(rec)
            if not temporary.stat().st_size:
                raise RecordError("nothing was recorded: the environment variable RERUN switches it off. Unset it.")
    finally:
        rr.set_strict_mode(was_strict)


@contextmanager
def _ourselves_written(path: Path) -> Iterator[Path]:
    """Lend a path to which rerun may write what becomes the file `path`: a pipe, at whose other end we write it."""
    # On a full disk rerun's own writing ends with a line on standard error, and whoever waits for it, as the end of a recording
    # and that of the process do, waits for ever. From the pipe everything is taken, whether or not there is space for it.
    if not _OPEN_FILES.is_dir():
        yield path
        return
    reading, writing = os.pipe()
    errors: list[OSError] = []
    thread = threading.Thread(target=_write, args=(reading, path, errors), daemon=True)
    thread.start()
    try:
        yield _OPEN_FILES / str(writing)
    finally:
        os.close(writing)  # rerun has opened it once more, and closed it by now
        thread.join()
    if errors:
        raise errors[0]


def _write(reading: int, path: Path, errors: list[OSError]) -> None:
    """Write what comes out of a pipe as a file until it ends; after an error take it away only."""
    with open(reading, "rb", buffering=0) as source:
        try:
            with path.open("wb", buffering=0) as file:
                while block := source.read(_BLOCK):
                    while block:
                        block = block[file.write(block) :]
        except OSError as error:
            errors.append(error)
            while source.read(_BLOCK):
                pass
