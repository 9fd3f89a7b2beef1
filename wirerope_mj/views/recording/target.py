"""Files of recordings: written atomically, in rerun's strict mode."""

import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import rerun as rr
import rerun_bindings
from rerun.error_utils import strict_mode

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.views.recording.paths import APPLICATION, Columns, KnownLetters, Stream
from wirerope_mj.views.recording.viewer import FILE


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
        with atomic_file(target) as temporary, temporary.open("wb", buffering=0) as file:
            stream = _Written(application, file)
            try:
                yield KnownLetters(stream)
                stream.write(flush=True)
            finally:
                stream.close()
            if not file.tell():
                raise RecordError("nothing was recorded: the environment variable RERUN switches it off. Unset it.")
    finally:
        rr.set_strict_mode(was_strict)


class _Written(Stream):
    """A recording whose bytes this process writes: none of rerun's threads waits for a file, nor anything for them.

    Where rerun writes itself, a full disk or an interrupt ends its thread, and whoever waits for that, as the end of a
    recording and of the process do, waits for ever.
    """

    def __init__(self, application: str, file: BinaryIO) -> None:
        super().__init__(rr.RecordingStream(application, recording_id=uuid.uuid4()))
        self._file, self._bytes = file, self._rec.binary_stream()
        self._rec.set_log_time_enabled(False)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._rec, name)

    def send_columns(self, path: str, index: list[rr.TimeColumn], columns: Columns) -> None:
        """Send rows, and write what has been encoded by now: a long recording is never in memory as a whole."""
        self._rec.send_columns(path, index, columns)
        self.write(flush=False)

    def send_blueprint(self, blueprint: rr.blueprint.Blueprint, **how: bool) -> None:
        """Send a layout as rerun does, but for its stream, which rerun keeps with its threads."""
        native = rerun_bindings.new_blueprint(self._rec.get_application_id(), make_default=False, make_thread_default=False)
        stream = rr.RecordingStream._from_native(native)
        stream.set_time("blueprint", sequence=0)
        blueprint._log_to_stream(stream)
        rerun_bindings.send_blueprint(stream.memory_recording().storage, recording=self._rec.to_native(), **how)
        stream.disconnect()  # the stream holds its memory, which holds the stream

    def write(self, *, flush: bool) -> None:
        """Write the bytes that there are; all of them after a flush."""
        rest = memoryview(self._bytes.read(flush=flush) or b"")
        while rest:
            rest = rest[self._file.write(rest) :]

    def close(self) -> None:
        """Give back rerun's threads and memory."""
        self._rec.disconnect()
        del self._bytes, self._rec
        rerun_bindings.flush_and_cleanup_orphaned_recordings()
