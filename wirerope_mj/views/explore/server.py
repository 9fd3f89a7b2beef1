"""The server of the page, for this machine only; requests that start a computation must carry the token."""

import hmac
import json
import re
import sys
import webbrowser
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from secrets import token_urlsafe
from threading import Lock
from typing import Any, Protocol
from urllib.parse import parse_qs, urlsplit

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.views.recording.viewer import FILES, has_display, viewer_files

LOCAL = "127.0.0.1"
_FOLDER = Path(__file__).parent
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".wasm": "application/wasm"}
_STATIC = ("explore.css", "explore.js", "chart.js", "viewer.html", "viewer.css", "viewer.js")
_LARGEST = 4096  # largest request that is read [bytes]: a dozen sliders take a tenth of it
_IDLE = 60.0  # time after which an idle connection is closed [s]
# The page loads nothing from elsewhere, whatever its scripts or the viewer's might try: no fonts, no usage data.
_POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self' data: blob:; "
    "img-src 'self' data: blob:; worker-src 'self' blob:; frame-src {ours}; frame-ancestors {ours}; base-uri 'none'; "
    "form-action 'none'"
)
_HEADERS = {
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",  # the token stands in the page's address
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}


class Explored(Protocol):
    """The what-if that the page shows and changes."""

    def start(self) -> Entries:
        """Return title, sliders and the last answer."""

    def run(self, values: object, *, passing: bool, exact: bool) -> Entries:
        """Simulate with the sliders at some values and return the answer; ValueError or WireRopeError if that fails."""

    def recording(self, number: int) -> bytes:
        """Return the recording of the last two runs; OvertakenError if run `number` is not the last any more."""


class ExploreServer(ThreadingHTTPServer):
    """Serves the page of one what-if on a free port of this machine."""

    daemon_threads = True

    def __init__(self, explored: Explored, *, viewer: bool = True, port: int = 0) -> None:
        self.explored, self.viewer = explored, viewer
        self.token = token_urlsafe(24)  # that requests must carry
        self.runs, self.recordings = Turns(), Turns()  # queues of simulations, and of recordings
        self._viewer_files: dict[str, bytes] = {}
        self._fetching = Lock()
        super().__init__((LOCAL, port), _Handler)
        # Hosts that a request may name; the viewer has the other name than the page, see `explore.js`.
        self.hosts = tuple(f"{name}:{self.server_port}" for name in (LOCAL, "localhost"))
        self.policy = _POLICY.format(ours=" ".join(f"http://{host}" for host in self.hosts))

    def handle_error(self, request: Any, client_address: object) -> None:
        """Print an unexpected error; a page that was closed while it was answered is not an error."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)

    def viewer_file(self, name: str) -> bytes:
        """Return a file of the web viewer; the first call fetches all files."""
        with self._fetching:
            self._viewer_files = self._viewer_files or viewer_files()
            return self._viewer_files[name]

    @property
    def address(self) -> str:
        """Address of the page, with its token."""
        return f"http://{LOCAL}:{self.server_port}/?token={self.token}"


class _RefusedError(Exception):
    """A request that is not answered: status and reason."""


class _Handler(BaseHTTPRequestHandler):
    server: ExploreServer
    protocol_version = "HTTP/1.1"
    timeout = _IDLE

    def do_GET(self) -> None:
        self._respond(self._get)

    def do_POST(self) -> None:
        self._respond(self._post)

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing: the terminal has the address to show."""

    def _respond(self, answer: Callable[[str, Mapping[str, list[str]]], None]) -> None:
        """Answer a request, or send its error as JSON."""
        try:
            self._require_host()
            address = urlsplit(self.path)
            answer(address.path, parse_qs(address.query))
        except _RefusedError as refused:
            status, reason = refused.args
            self.close_connection = True  # the rest of the request is not read
            self._send_json({"error": reason}, status)
        except OvertakenError:
            self._send_json({"overtaken": True}, HTTPStatus.CONFLICT)
        except ConnectionError:  # the client is gone
            raise
        except (WireRopeError, ValueError, OSError) as error:
            self._send_json({"error": str(error)}, HTTPStatus.UNPROCESSABLE_ENTITY)

    def _require_host(self) -> None:
        """Refuse a request to another host name: a foreign name may have been made to point to this machine."""
        if self.headers.get("Host", "") not in self.server.hosts:
            raise _RefusedError(HTTPStatus.FORBIDDEN, "This page is for this machine only.")

    def _require_token(self, given: str) -> None:
        if not hmac.compare_digest(given.encode(), self.server.token.encode()):
            reason = "Open the address that `wirerope explore` printed: its token is missing or wrong."
            raise _RefusedError(HTTPStatus.FORBIDDEN, reason)

    def _get(self, path: str, query: Mapping[str, list[str]]) -> None:
        name = path.removeprefix("/")
        if name == "":
            self._require_token(query.get("token", [""])[0])
            self._send((_FOLDER / "explore.html").read_bytes(), _TYPES[".html"])
        elif name in _STATIC:
            self._send((_FOLDER / name).read_bytes(), _TYPES[Path(name).suffix])
        elif name in FILES and self.server.viewer:
            self._send(self.server.viewer_file(name), _TYPES[Path(name).suffix])
        elif name == "start":
            self._require_token(self.headers.get("X-Token", ""))
            self._send_json({**self.server.explored.start(), "viewer": self.server.viewer})
        elif match := re.fullmatch(r"recording/(\d{1,9})", name):
            self._require_token(self.headers.get("X-Token", ""))
            with self.server.recordings.turn():
                content = self.server.explored.recording(int(match[1]))
            self._send(content, "application/octet-stream")
        else:
            raise _RefusedError(HTTPStatus.NOT_FOUND, "There is nothing here.")

    def _post(self, path: str, query: Mapping[str, list[str]]) -> None:
        self._require_token(self.headers.get("X-Token", ""))
        if path != "/run":
            raise _RefusedError(HTTPStatus.NOT_FOUND, "There is nothing here.")
        asked = self._content()
        with self.server.runs.turn():
            answer = self.server.explored.run(
                asked.get("values"), passing=asked.get("passing") is True, exact=asked.get("exact") is True
            )
        self._send_json(answer)

    def _content(self) -> Entries:
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or len(length) > 9 or int(length) > _LARGEST:
            reason = f"A request says its length and has at most {_LARGEST} bytes."
            raise _RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, reason)
        try:
            asked = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            asked = None
        if not isinstance(asked, dict):
            raise _RefusedError(HTTPStatus.BAD_REQUEST, "A request is a table in JSON.")
        return asked

    def _send_json(self, content: Mapping[str, object], status: HTTPStatus = HTTPStatus.OK) -> None:
        self._send(json.dumps(content, allow_nan=False).encode(), "application/json", status)

    def _send(self, content: bytes, kind: str, status: HTTPStatus = HTTPStatus.OK) -> None:
        self.send_response(status)
        for name, value in {**_HEADERS, "Content-Security-Policy": self.server.policy}.items():
            self.send_header(name, value)
        self.send_header("Content-Type", f"{kind}; charset=utf-8" if kind.startswith("text") else kind)
        self.send_header("Content-Length", str(len(content)))
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)


class OvertakenError(Exception):
    """A later request has replaced the one that waited."""


class Turns:
    """Lets one thread through at a time, and of the waiting threads only the last to arrive."""

    def __init__(self) -> None:
        self._counting, self._busy = Lock(), Lock()
        self._newest = 0

    @contextmanager
    def turn(self) -> Iterator[None]:
        """Wait until no other thread is inside; OvertakenError if another thread arrived in the meantime."""
        with self._counting:
            self._newest += 1
            mine = self._newest
        with self._busy:
            if mine != self._newest:
                raise OvertakenError
            yield


def serve(explored: Explored, *, browser: bool, viewer: bool, port: int = 0) -> None:
    """Serve the page of a what-if on a port (0: a free one), print its address, and return when Ctrl-C ends it.

    The page is opened with `browser` where there is a screen, and has the viewer of recordings beside it with `viewer`.
    WireRopeError if the port is taken.
    """
    try:
        server = ExploreServer(explored, viewer=viewer, port=port)
    except OSError as error:
        raise WireRopeError(f"port {port} of {LOCAL} cannot be had ({error.strerror}). Leave --port out.") from None
    with server:
        try:
            print(f"Open {server.address}\nCtrl-C ends it.", flush=True)
            if browser and has_display():
                webbrowser.open(server.address)
            server.serve_forever()
        except KeyboardInterrupt:
            print("\nEnded.")
