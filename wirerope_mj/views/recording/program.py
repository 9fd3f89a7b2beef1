"""The viewer's program and the files of its page, for which rerun itself need not be imported."""

import os
import socket
import subprocess
import sys
import urllib.request
from importlib.util import find_spec
from pathlib import Path
from time import monotonic, sleep

from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.processes import process_beside

LOCAL = "127.0.0.1"  # the viewer's own default is every network
FILES = ("re_viewer.js", "re_viewer_bg.wasm")
# time within which a viewer must answer [s]: usually a second, on a busy machine half a minute
START = 60.0


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


def free_port(preferred: int) -> int:
    for port in (preferred, 0):
        with socket.socket() as listener:
            try:
                listener.bind((LOCAL, port))
            except OSError:
                continue
            return int(listener.getsockname()[1])
    raise WireRopeError("no port of this machine is free for the viewer.")


def viewer_files() -> dict[str, bytes]:
    """Fetch the files of the web viewer by name: 43 MB, for which its server is asked once and then ended.

    The page does not use that server itself: any page that is open in the browser could read its recordings.
    WireRopeError if there is no viewer, or it does not hand them out.
    """
    server, page = free_port(0), free_port(0)  # not the usual ones, which another viewer may be about to take
    command = [str(viewer_binary()), "--bind", "127.0.0.1", "--serve-web"]
    command += ["--port", str(server), "--web-viewer-port", str(page)]
    # With `CI` set the viewer sends no usage data.
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # never by way of a proxy
    files: dict[str, bytes] = {}
    with process_beside(command, env={**os.environ, "CI": "1"}, **streams) as process:
        end = monotonic() + START
        while len(files) < len(FILES):
            name = FILES[len(files)]
            try:
                with opener.open(f"http://127.0.0.1:{page}/{name}", timeout=START) as answer:
                    files[name] = bytes(answer.read())
            except OSError as error:
                if process.poll() is not None or monotonic() > end:
                    raise WireRopeError(f"the viewer of rerun-sdk does not hand out its page: {error}") from None
                sleep(0.05)
    return files
