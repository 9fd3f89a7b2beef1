"""The web viewer's program, taken from the viewer that rerun-sdk brought along."""

import os
import subprocess
import urllib.request
from time import monotonic, sleep

from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.views.recording.viewer import free_port, viewer_binary

FILES = ("re_viewer.js", "re_viewer_bg.wasm")
# Time within which the viewer's server must answer [s]; it takes a tenth of one on a machine that is not busy.
_START = 15.0


def viewer_files() -> dict[str, bytes]:
    """Return the files of the web viewer by name: 43 MB, which its server is asked for once and then ended.

    The server itself is not what the page talks to: its recordings could be read by whatever page is open in the browser.
    WireRopeError if there is no viewer, or it does not hand them out.
    """
    server, page = free_port(9876), free_port(9090)
    command = [str(viewer_binary()), "--bind", "127.0.0.1", "--serve-web"]
    command += ["--port", str(server), "--web-viewer-port", str(page)]
    # It sends no usage data from where `CI` is set.
    with subprocess.Popen(
        command, env={**os.environ, "CI": "1"}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as process:
        try:
            return {name: _fetched(f"http://127.0.0.1:{page}/{name}", process) for name in FILES}
        finally:
            process.terminate()


def _fetched(address: str, process: "subprocess.Popen[bytes]") -> bytes:
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # never by way of a proxy
    end = monotonic() + _START
    while True:
        try:
            with opener.open(address, timeout=_START) as answer:
                return bytes(answer.read())
        except OSError as error:
            if process.poll() is not None or monotonic() > end:
                raise WireRopeError(f"the viewer of rerun-sdk does not hand out its page: {error}") from None
            sleep(0.05)
