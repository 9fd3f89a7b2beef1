"""Opens a recording, in the rerun viewer or in a browser, joins several into one file, and hands out the web viewer."""

import os
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from time import monotonic, sleep
from typing import BinaryIO
from urllib.parse import quote

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError, WireRopeError
from wirerope_mj.foundation.processes import process_beside

FILE, JOINED = "run.rrd", "job.rrd"  # Recordings of a run and of a job in their folders
# In the folder of a study: what it is known by, its worst variants, and their recording.
STUDY, WORST, OVERLAY = "study.toml", "worst", "worst.rrd"
_BEGINNING = b"RRF"  # First bytes of every recording
_LOCAL = "127.0.0.1"  # the viewer's own default is every network


def show(path_or_folder: str | Path, *, web: bool = False) -> None:
    """Open a recording and return when the viewer is closed or interrupted; with `web`, serve it to a browser of this machine.

    What is given is a `.rrd` file, or the folder of a run, or of a study whose worst variants were written. RecordError
    if there is no recording; WireRopeError if there is no screen, or no viewer.
    """
    path = find_recording(path_or_folder)
    if not web and not has_display():
        raise WireRopeError(
            f"there is no screen here to open {path} on. Show it in a browser with --web, or copy the file to a "
            f"machine with a screen and open it there: rerun {path.name}"
        )
    command = [str(viewer_binary()), "--bind", _LOCAL]
    if web:
        server, page = free_port(9876), free_port(9090)
        command += ["--serve-web", "--port", str(server), "--web-viewer-port", str(page), str(path)]
        print(f"Open {web_address(server, page)} in a browser. Ctrl-C ends it.", flush=True)
    else:
        # Of a file with several recordings the viewer opens one; from its standard input it takes all.
        command += ["--new", "-" if path.name == JOINED else str(path)]
    with path.open("rb") as recording:
        _run(command, recording)


def _run(command: list[str], recording: BinaryIO) -> None:
    # From where `CI` is set it sends no usage data.
    with process_beside(command, stdin=recording, env={**os.environ, "CI": "1"}) as process:
        try:
            code = process.wait()
        except KeyboardInterrupt:
            return
    if code != 0:
        raise WireRopeError(f"the viewer ended with code {code}. On a machine without graphics drivers --web works.")


def find_recording(path_or_folder: str | Path) -> Path:
    """Find the recording that a path names: itself, or that of a run, a job or a study."""
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
        if not file.read(len(_BEGINNING)).startswith(_BEGINNING):
            raise RecordError(f"{path}: this is not a recording of rerun; `wirerope show` takes a run's folder or its {FILE}.")
    return path


def has_display() -> bool:
    linux = sys.platform.startswith("linux")
    return not linux or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def viewer_binary() -> Path:
    """Find the viewer that rerun-sdk brought along; the `rerun` on the path may be another version."""
    package = find_spec("rerun_cli")
    folder = Path(package.origin).parent if package and package.origin else Path()
    for name in ("rerun", "rerun.exe"):
        if (folder / name).is_file():
            return folder / name
    raise WireRopeError("the viewer of rerun-sdk is missing. Install it again: pip install --force-reinstall rerun-sdk")


def web_address(server: int, page: int) -> str:
    """Write the address of the web viewer on port `page`, fed by the server on port `server`."""
    source = quote(f"rerun+http://{_LOCAL}:{server}/proxy", safe="")
    return f"http://{_LOCAL}:{page}/?url={source}"


def free_port(preferred: int) -> int:
    for port in (preferred, 0):
        with socket.socket() as listener:
            try:
                listener.bind((_LOCAL, port))
            except OSError:
                continue
            return int(listener.getsockname()[1])
    raise WireRopeError("no port of this machine is free for the viewer.")


def join_recordings(recordings: Sequence[Path], target: Path) -> None:
    """Write recordings into one file, each as it is.

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


FILES = ("re_viewer.js", "re_viewer_bg.wasm")
# within which the viewer's server must answer [s]; usually a tenth of one
_START = 15.0


def viewer_files() -> dict[str, bytes]:
    """Fetch the files of the web viewer by name: 43 MB, for which its server is asked once and then ended.

    The server itself is not what the page talks to: its recordings could be read by whatever page is open in the browser.
    WireRopeError if there is no viewer, or it does not hand them out.
    """
    server, page = free_port(9876), free_port(9090)
    command = [str(viewer_binary()), "--bind", "127.0.0.1", "--serve-web"]
    command += ["--port", str(server), "--web-viewer-port", str(page)]
    # It sends no usage data from where `CI` is set.
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # never by way of a proxy
    files: dict[str, bytes] = {}
    with process_beside(command, env={**os.environ, "CI": "1"}, **streams) as process:
        end = monotonic() + _START
        while len(files) < len(FILES):
            name = FILES[len(files)]
            try:
                with opener.open(f"http://127.0.0.1:{page}/{name}", timeout=_START) as answer:
                    files[name] = bytes(answer.read())
            except OSError as error:
                if process.poll() is not None or monotonic() > end:
                    raise WireRopeError(f"the viewer of rerun-sdk does not hand out its page: {error}") from None
                sleep(0.05)
    return files
