"""The server of the drawing board, for this machine only; page, files and windows must carry the token."""

import asyncio
import hmac
import socket
import traceback
import webbrowser
from functools import cache
from pathlib import Path
from secrets import token_urlsafe
from time import monotonic
from urllib.parse import quote

import uvicorn
from starlette.applications import Starlette
from starlette.datastructures import Headers, MutableHeaders, QueryParams
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.views.board.columns import fragment
from wirerope_mj.views.board.windows import Served, Windows
from wirerope_mj.views.recording.program import LOCAL, has_display
from wirerope_mj.views.report.page import block_styles
from wirerope_mj.views.share import VIEWER, viewer_pages

_FOLDER = Path(__file__).parent
_STATIC = ("blocks.css", "board.css", "board.js", "canvas.js", "drawing.js")
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".wasm": "application/wasm"}
_WITH_TOKEN = ("/files/", "/viewer", "/socket")  # what only those may ask for who have the token, besides the page
_CONNECTIONS = 32  # at once: a browser opens six beside its windows
_LARGEST = 64 * 1024  # largest message of a window, and largest head of a request [bytes]
_UNREAD = 8 * 2**20  # what a window may leave unread, beside what the system keeps [bytes]
_NONE = "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
# Pages load nothing from elsewhere, whatever their scripts or the viewer's might try: no fonts, no usage data.
_POLICY = _NONE + (
    "script-src 'self'; style-src 'self'; style-src-attr 'unsafe-inline'; connect-src 'self' {sockets}; "
    "img-src 'self' data: blob:"
)
_VIEWER_POLICY = (
    _NONE + "script-src 'self' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; connect-src 'self' data: blob:; "
    "img-src data: blob:; worker-src 'self' blob:"
)
# A page among the files, as a report, has its styles and scripts in itself, and reaches neither the board nor anything else.
_PAGE_POLICY = (
    _NONE + "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; font-src data:; "
    "sandbox allow-scripts allow-popups allow-popups-to-escape-sandbox allow-downloads allow-modals"
)
# Browsers show films, pictures and PDF in a page of theirs, which needs this.
_FILE_POLICY = _NONE + "style-src 'unsafe-inline'; img-src 'self'; media-src 'self'; object-src 'self'"
_HEADERS = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",  # the token stands in the page's address
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}


class _Guard:
    """Lets requests of this machine's own pages through, and writes into every answer what browsers must not do with it."""

    def __init__(self, app: ASGIApp, hosts: tuple[str, ...], token: str) -> None:
        self.app, self.hosts, self.token = app, hosts, token
        self.origins = [f"http://{host}" for host in hosts]
        sockets = " ".join(f"ws://{host}" for host in hosts)
        self.policy = _POLICY.format(sockets=sockets)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.update(_HEADERS)
                headers.setdefault("Content-Security-Policy", self.policy)
            await send(message)

        try:
            await (self._refusal(scope) or self.app)(scope, receive, send_guarded)
        except Exception:
            traceback.print_exc()
            raise

    def _refusal(self, scope: Scope) -> Response | None:
        """Answer a request with why it is refused: its host, origin, method, body or token; None if it is let through."""
        headers, path = Headers(scope=scope), scope["path"]
        origins = headers.getlist("origin")
        if headers.getlist("host") not in [[host] for host in self.hosts]:
            # a foreign name may have been made to point to this machine
            return PlainTextResponse("This page is for this machine only.", 403)
        if not all(origin in self.origins for origin in origins) or not (origins or scope["type"] == "http"):
            return PlainTextResponse("This page is for its own windows only.", 403)
        if scope["type"] == "http" and scope["method"] not in ("GET", "HEAD"):
            return PlainTextResponse("This page is only read.", 405, {"Allow": "GET, HEAD"})
        if headers.get("content-length", "0") != "0" or "transfer-encoding" in headers:
            return PlainTextResponse("A request has no body.", 400, {"Connection": "close"})
        given = path.split("/")[2] if path.startswith("/viewer/") else QueryParams(scope["query_string"]).get("token", "")
        if (path == "/" or path.startswith(_WITH_TOKEN)) and not hmac.compare_digest(
            given.encode(errors="replace"), self.token.encode()
        ):
            return PlainTextResponse("Open the address that `wirerope board` printed: its token is missing or wrong.", 403)
        return None


class _Connection(H11Protocol):
    """An HTTP connection; where there are more than `_CONNECTIONS`, the oldest that is no window is closed."""

    opened = 0.0

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self.opened = monotonic()
        if len(self.connections) > _CONNECTIONS:
            oldest = min((each for each in self.connections if isinstance(each, _Connection)), key=lambda each: each.opened)
            self.connections.discard(oldest)
            oldest.transport.abort()


class _Socket(WebSocketsSansIOProtocol):
    """The WebSocket of a window; it is closed if the browser does not read, and may connect again."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        self.transport.set_write_buffer_limits(_UNREAD)

    def pause_writing(self) -> None:
        self.transport.abort()


class BoardServer(uvicorn.Server):
    """Serves one board on a port of this machine (0: a free one); `run` returns once `should_exit` is set.

    OSError if the port is taken.
    """

    def __init__(self, board: Served, *, port: int = 0) -> None:
        self.token = token_urlsafe(24)
        self.listener = socket.create_server((LOCAL, port))
        self.windows = Windows(board)
        self.port = self.listener.getsockname()[1]
        self.hosts = tuple(f"{name}:{self.port}" for name in (LOCAL, "localhost"))
        self.address = f"http://{self.hosts[0]}/?token={self.token}"
        self._viewer_pages = cache(viewer_pages)
        pages = Starlette(
            routes=[
                Route("/", self._page),
                Route("/files/{name:path}", self._file),
                Route("/viewer", self._view),
                Route("/viewer/{token}/{name:path}/run.rrd", self._recording),
                Route(f"/viewer/{{token}}/{{name:path}}/{VIEWER}/{{page}}", self._viewer_page),
                Route("/{name}", self._static),
                WebSocketRoute("/socket", self.windows.attend),
            ]
        )
        pages.router.redirect_slashes = False
        super().__init__(
            uvicorn.Config(
                _Guard(pages, self.hosts, self.token), http=_Connection, ws=_Socket, loop="asyncio", lifespan="off",
                ws_max_size=_LARGEST, h11_max_incomplete_event_size=_LARGEST, ws_per_message_deflate=False,
                log_config=None, log_level="critical", access_log=False, proxy_headers=False, server_header=False,
                timeout_graceful_shutdown=1,
            )
        )  # fmt: skip

    def run(self, sockets: list[socket.socket] | None = None) -> None:
        """Answer until the server is ended."""
        super().run([self.listener])

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        await super().shutdown(sockets)
        self.windows.close()

    def _path(self, name: str, suffix: str = "") -> Path:
        path = self.windows.board.file(name)
        if path is None or not path.is_file() or not path.name.endswith(suffix):
            raise HTTPException(404)
        return path

    async def _page(self, request: Request) -> Response:
        return HTMLResponse(fragment("board.html", title=self.windows.board.title))

    async def _static(self, request: Request) -> Response:
        name = request.path_params["name"]
        if name == "favicon.ico":  # browsers ask for it where a file has none, as a film
            return Response(status_code=204)
        if name not in _STATIC:
            raise HTTPException(404)
        content = block_styles() if name == "blocks.css" else (_FOLDER / name).read_bytes()
        return Response(content, media_type=_TYPES[Path(name).suffix])

    async def _file(self, request: Request) -> Response:
        path = self._path(request.path_params["name"])
        policy = _PAGE_POLICY if path.suffix in (".html", ".htm") else _FILE_POLICY
        return FileResponse(path, headers={"Content-Security-Policy": policy})

    async def _view(self, request: Request) -> Response:
        """Redirect to the page of rerun's viewer, which requests its files and the recording by relative addresses.

        It is called by this machine's other name, so that browsers run it in a process of its own: it cannot hold up the board.
        """
        name = request.query_params.get("recording", "")
        self._path(name, ".rrd")
        other = self.hosts[request.headers["host"] == self.hosts[0]]
        return RedirectResponse(f"http://{other}/viewer/{self.token}/{quote(name, safe='')}/{VIEWER}/index.html", 303)

    async def _recording(self, request: Request) -> Response:
        return FileResponse(self._path(request.path_params["name"], ".rrd"), media_type="application/octet-stream")

    def _viewer_page(self, request: Request) -> Response:
        """Return a file of the viewer: in a thread, since reading them takes long at first."""
        page = request.path_params["page"]
        if (content := self._viewer_pages().get(page)) is None:
            raise HTTPException(404)
        return Response(content, headers={"Content-Security-Policy": _VIEWER_POLICY}, media_type=_TYPES[Path(page).suffix])


def serve(board: Served, *, browser: bool, port: int = 0) -> None:
    """Serve a board on a port (0: a free one), print its address, and return when Ctrl-C ends it; the board is closed then.

    The page is opened with `browser` where there is a screen. WireRopeError if the port is taken.
    """
    try:
        server = BoardServer(board, port=port)
    except OSError as error:
        raise WireRopeError(f"port {port} of {LOCAL} cannot be had ({error.strerror}). Leave --port out.") from None
    try:
        print(f"Open {server.address}\nCtrl-C ends it.", flush=True)
        if browser and has_display():
            webbrowser.open(server.address)
        server.run()
    except KeyboardInterrupt:
        print("\nEnded.")
    finally:
        if not server.started:
            server.windows.close()
