"""Files of recordings: written atomically, in rerun's strict mode."""

import os
import threading
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rerun as rr
import rerun_bindings
from rerun.error_utils import strict_mode

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.interrupts import interrupts_held
from wirerope_mj.views.recording.paths import APPLICATION, KnownLetters, Stream
from wirerope_mj.views.recording.viewer import FILE

_BLOCK = 2**20  # Of a recording, written at once [bytes]
_OPEN_FILES = Path("/dev/fd")  # Folder in which Linux and macOS give an open pipe a path


def target_of(path: str | Path, *, file: str = FILE) -> Path:
    """Name the file of a recording at `path`: a folder gets one called `file`."""
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
            recording = _Recording(application, temporary)
            try:
                recording.begin()
                yield KnownLetters(recording)
            finally:
                with interrupts_held():
                    recording.end()
            if recording.errors:
                raise recording.errors[0]
            if not temporary.stat().st_size:
                raise RecordError("nothing was recorded: the environment variable RERUN switches it off. Unset it.")
    finally:
        rr.set_strict_mode(was_strict)


class _Recording(Stream):
    """A recording of rerun's that is written into a file by a thread of this process.

    Where rerun writes itself, a full disk ends its writing with a line on standard error, and whoever waits for it, as the end
    of a recording and that of the process do, waits for ever. From a pipe everything is taken, whether or not there is space.
    """

    def __init__(self, application: str, path: Path) -> None:
        super().__init__(rr.RecordingStream(application, recording_id=uuid.uuid4()))
        self._application, self._path, self.errors = application, path, list[OSError]()
        self._writer: threading.Thread | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._rec, name)

    def begin(self) -> None:
        """Have everything that is logged from now on written."""
        self._rec.set_log_time_enabled(False)
        if not _OPEN_FILES.is_dir():
            self._rec.save(self._path)
            return
        with interrupts_held():
            reading, writing = os.pipe()
            writer = threading.Thread(target=_write, args=(reading, self._path, self.errors), daemon=True)
            try:
                writer.start()
                self._writer = writer
                self._rec.save(_OPEN_FILES / str(writing))
            finally:
                os.close(writing)  # rerun has opened it once more, or there is nothing to write
                if self._writer is None:
                    os.close(reading)

    def send_blueprint(self, blueprint: rr.blueprint.Blueprint, **how: bool) -> None:
        """Send a layout; rerun itself would keep the layout's stream and its threads."""
        native = rerun_bindings.new_blueprint(self._application, make_default=False, make_thread_default=False)
        stream = rr.RecordingStream._from_native(native)
        try:
            stream.set_time("blueprint", sequence=0)
            blueprint._log_to_stream(stream)
            rerun_bindings.send_blueprint(stream.memory_recording().storage, recording=self._rec.to_native(), **how)
        finally:
            stream.disconnect()  # it holds the layout in memory, which holds it

    def end(self) -> None:
        """Write what is left, and give back rerun's threads and memory."""
        self._rec.disconnect()  # closes the pipe, whose end ends the writer
        del self._rec
        rerun_bindings.flush_and_cleanup_orphaned_recordings()
        if self._writer is not None:
            self._writer.join()


def _write(reading: int, path: Path, errors: list[OSError]) -> None:
    """Write what comes out of a pipe as a file until it ends; after an error drop the rest."""
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
