"""Serves the page until it is interrupted."""

import webbrowser

from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.views.explore.server import LOCAL, Explored, ExploreServer
from wirerope_mj.views.recording.viewer import has_display


def serve(explored: Explored, *, browser: bool, viewer: bool, port: int = 0) -> None:
    """Serve the page of a what-if on a port (0: a free one), print its address, and return when Ctrl-C ends it.

    The page is opened with `browser` where there is a screen, and has the viewer of recordings beside it with `viewer`.

    Raises:
        WireRopeError: the port is taken.
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
