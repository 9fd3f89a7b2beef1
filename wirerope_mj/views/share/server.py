"""The viewer and one recording for a browser of this machine; pages of other origins read nothing here."""

import json
import shutil
from collections.abc import Sequence
from functools import partial
from http import HTTPStatus
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from tempfile import TemporaryDirectory

from wirerope_mj.views.recording.paths import TIMELINE
from wirerope_mj.views.recording.program import LOCAL, free_port
from wirerope_mj.views.recording.viewer import FILE, Opening, find_recording, openings_of
from wirerope_mj.views.share import VIEWER, viewer_pages

_USUAL = 9090  # port, if it is free


def show_in_browser(path_or_folder: str | Path) -> None:
    """Serve a recording to a browser of this machine until it is interrupted; the printed address opens it where it matters.

    The path is as for `wirerope_mj.views.recording.show`; of several recordings in a file the one in front is the one that the
    viewer read last. RecordError if there is no recording; WireRopeError if there is no
    viewer, or it does not hand out its files.
    """
    path = find_recording(path_or_folder)
    openings = openings_of(path)
    with TemporaryDirectory() as folder:
        shutil.copyfile(path, Path(folder) / FILE)
        (Path(folder) / VIEWER).mkdir()
        pages = viewer_pages()
        if len(openings) > 1:
            pages["show.js"] += f"globalThis.OPENINGS = {json.dumps(cursors_of(openings))};\n".encode()
        for name, content in pages.items():
            (Path(folder) / VIEWER / name).write_bytes(content)
        with ThreadingHTTPServer((LOCAL, free_port(_USUAL)), partial(_Handler, directory=folder)) as server:
            server.daemon_threads = True
            print(f"Open {address_of(server.server_port, openings)} in a browser. Ctrl-C ends it.", flush=True)
            try:
                server.serve_forever()
            except KeyboardInterrupt:
                return


def cursors_of(openings: Sequence[Opening]) -> list[tuple[str, int, str]]:
    """Write where recordings open for the page's script: timeline, instant [ns] or number, and the viewer's name of each."""
    units = {TIMELINE: 1e9}
    return [
        (entry.timeline, round(entry.at * units.get(entry.timeline, 1.0)), f"Recording:{entry.recording}") for entry in openings
    ]


def address_of(port: int, openings: Sequence[Opening]) -> str:
    """Write the address of the page, for one recording with the instant [s], or timeline and number, at which it opens."""
    where = ""
    if len(openings) == 1:
        (opening,) = openings
        where = f"#{opening.at:.9g}" if opening.timeline == TIMELINE else f"#{opening.timeline}@{opening.at:.0f}"
    return f"http://{LOCAL}:{port}/{VIEWER}/index.html{where}"


class _Handler(SimpleHTTPRequestHandler):
    """Hands out the files of its folder; a request must name this machine, to which a foreign name may have been pointed."""

    def do_GET(self) -> None:
        if self.headers.get("Host", "") == f"{LOCAL}:{self.connection.getsockname()[1]}":
            super().do_GET()
        else:
            self.send_error(HTTPStatus.FORBIDDEN, "This page is for this machine only.")

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing: the terminal has the address to show."""
