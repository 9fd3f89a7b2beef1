"""Files of recordings: written atomically, found in a folder, and opened in the viewer."""

import os
import subprocess
import threading
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Any, BinaryIO

import rerun as rr
import rerun_bindings
from rerun.chunk import RrdReader
from rerun.error_utils import strict_mode
from rerun.experimental import ViewerClient

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError, WireRopeError
from wirerope_mj.foundation.interrupts import interrupts_held
from wirerope_mj.foundation.processes import process_beside
from wirerope_mj.views.recording.paths import (
    APPLICATION,
    POINT,
    PROPERTIES,
    TIMELINE,
    UTILISATION,
    WORST_INSTANT,
    WORST_POINT,
    KnownLetters,
    Stream,
)
from wirerope_mj.views.recording.program import LOCAL, START, free_port, has_display, viewer_binary

FILE, JOINED = "run.rrd", "job.rrd"  # Recordings of a run and of a job in their folders
# In the folder of a study: its definition, its worst variants, and their recording
STUDY, WORST, OVERLAY = "study.toml", "worst", "worst.rrd"
_MAGIC = b"RRF"  # First bytes of every recording


def show(path_or_folder: str | Path) -> None:
    """Open a recording in a window and return when it is closed or interrupted; each opens at its most critical instant.

    The path is that of a `.rrd` file, of the folder of a run, or of a study whose worst variants were written. RecordError
    if there is no recording; WireRopeError if there is no screen, or no viewer.
    """
    path = find_recording(path_or_folder)
    if not has_display():
        raise WireRopeError(
            f"there is no screen here to open {path} on. Show it in a browser with --web, or copy the file to a "
            f"machine with a screen and open it there: rerun {path.name}"
        )
    port, ended = free_port(9876), threading.Event()
    # Of a file with several recordings the viewer opens one; from its standard input it takes all.
    command = [str(viewer_binary()), "--bind", LOCAL, "--port", str(port), "-" if path.name == JOINED else str(path)]
    moving = threading.Thread(target=_move_cursors, args=(port, openings_of(path), ended), daemon=True)
    moving.start()
    with path.open("rb") as recording:
        _run_viewer(command, recording)
    ended.set()
    moving.join()


@dataclass(frozen=True)
class Opening:
    """The cursor at which a recording opens: application and id, timeline, and an instant [s] or a number on it."""

    recording: str
    timeline: str
    at: float


def openings_of(path: Path) -> list[Opening]:
    """Read where the recordings of a file open, the most critical first; those that do not say it are left out."""
    reader, found = RrdReader(str(path)), list[tuple[float, Opening]]()
    for store in reader.recordings():
        for chunk in reader.stream(store=store):
            if str(chunk.entity_path) == f"/__properties/{PROPERTIES}":
                batch = chunk.to_record_batch()
                names = {UTILISATION, *_CURSORS}.intersection(batch.schema.names)
                known = {name: batch[name].flatten()[0].as_py() for name in names}
                for name in _CURSORS.keys() & names:
                    recording = f"{store.application_id}:{store.recording_id}"
                    found.append((known.get(UTILISATION, 0.0), Opening(recording, _CURSORS[name], known[name])))
    return [opening for _, opening in sorted(found, key=lambda entry: -entry[0])]


_CURSORS = {WORST_INSTANT: TIMELINE, WORST_POINT: POINT}


def _move_cursors(port: int, openings: Sequence[Opening], ended: threading.Event) -> None:
    """Move the cursors of a viewer that is starting, which a layout cannot, and bring the first recording to the front.

    A viewer that does not answer opens at the beginning.
    """
    # a file that is opened by its name is given another application
    names = [opening.recording.rpartition(":")[2] for opening in openings]
    until, left = monotonic() + START, dict(zip(names, openings, strict=True))
    while left and monotonic() < until and not ended.wait(0.1):
        with suppress(ConnectionError, TimeoutError, RuntimeError):  # it is not ready yet
            client = ViewerClient(f"rerun+http://{LOCAL}:{port}/proxy")
            loaded = {recording.store_id.rpartition(":")[2]: recording for recording in client.get_state().recordings}
            for name in left.keys() & loaded.keys():
                opening = left[name]
                if opening.timeline in (timeline.name for timeline in loaded[name].timelines):
                    store = loaded[name].store_id
                    if opening.timeline == TIMELINE:
                        client.set_time(TIMELINE, duration=opening.at, play_state="paused", recording=store)
                    else:
                        client.set_time(opening.timeline, sequence=round(opening.at), play_state="paused", recording=store)
                    del left[name]
            if not left and len(openings) > 1:
                client.set_location(loaded[names[0]].location)


def _run_viewer(command: list[str], recording: BinaryIO) -> None:
    # With `CI` set the viewer sends no usage data.
    with process_beside(command, stdin=recording, env={**os.environ, "CI": "1"}) as process:
        try:
            code = process.wait()
        except KeyboardInterrupt:
            return
    if code != 0:
        raise WireRopeError(f"the viewer ended with code {code}. On a machine without graphics drivers --web works.")


def find_recording(path_or_folder: str | Path) -> Path:
    """Find the recording at a path: the file itself, or that of the folder of a run, a job or a study."""
    given = Path(path_or_folder)
    if (given / STUDY).is_file():
        together, single = given / WORST / OVERLAY, sorted((given / WORST).glob(f"*/{FILE}"))
        if together.is_file() or len(single) == 1:
            return together if together.is_file() else single[0]
        if single:
            several = ", ".join(str(path.parent) for path in single)
            raise RecordError(f"{given}: several variants of this study were written one by one; open one: {several}.")
        raise RecordError(
            f"{given}: this is a study, and none of its variants was written as a run. Write the worst with the command that "
            f"computed it and --resume --out {given} --open-worst 3; only what is missing is computed."
        )
    name = JOINED if (given / JOINED).is_file() else FILE
    path = given / name if given.is_dir() else given
    if not path.is_file():
        raise RecordError(f"{path}: there is no such recording. A folder that `wirerope run` has written holds a {FILE}.")
    with path.open("rb") as file:
        if not file.read(len(_MAGIC)).startswith(_MAGIC):
            raise RecordError(f"{path}: this is not a recording of rerun; `wirerope show` takes a run's folder or its {FILE}.")
    return path


def join_recordings(recordings: Sequence[Path], target: Path) -> None:
    """Write recordings into one file, each unchanged.

    RecordError if one of them is missing or damaged; WireRopeError if rerun-sdk is incomplete.
    """
    with atomic_file(target) as temporary:
        command = [str(viewer_binary()), "rrd", "merge", "-o", str(temporary), *map(str, recordings)]
        streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        with process_beside(command, env={**os.environ, "CI": "1"}, **streams) as process:
            _, message = process.communicate()
        if process.returncode != 0 or not temporary.stat().st_size:
            message = " ".join(message.split()[-40:])
            raise RecordError(f"{target}: the recordings could not be joined: {message}")


_BLOCK = 2**20  # most bytes of a recording that are written at once
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
    """A rerun recording that a thread of this process writes into a file.

    If rerun writes the file itself, a full disk ends its writing with a line on standard error, and the end of the recording
    and of the process wait for ever. A pipe takes everything, whether or not there is space.
    """

    def __init__(self, application: str, path: Path) -> None:
        super().__init__(rr.RecordingStream(application, recording_id=uuid.uuid4()))
        self._application, self._path, self.errors = application, path, list[OSError]()
        self._writer: threading.Thread | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._rec, name)

    def begin(self) -> None:
        """Begin to write everything that is logged."""
        self._rec.set_log_time_enabled(False)
        if not _OPEN_FILES.is_dir():
            self._rec.save(self._path)
            return
        with interrupts_held():
            reading, writing = os.pipe()
            writer = threading.Thread(target=_write_pipe, args=(reading, self._path, self.errors), daemon=True)
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
        """Write the remaining data, and release rerun's threads and memory."""
        self._rec.disconnect()  # closes the pipe, whose end ends the writer
        del self._rec
        rerun_bindings.flush_and_cleanup_orphaned_recordings()
        if self._writer is not None:
            self._writer.join()


def _write_pipe(reading: int, path: Path, errors: list[OSError]) -> None:
    """Copy a pipe into a file until it ends; after an error discard the rest."""
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
