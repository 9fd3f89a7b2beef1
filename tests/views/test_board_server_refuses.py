"""What the server of the drawing board answers to requests that no page of its own sends."""

import re
import socket
from contextlib import ExitStack, closing, suppress

import pytest
from test_board_server import PATIENCE, SCRIPT, Board, ask, frame, handshake, heard, served, until, window

from wirerope_mj.views.recording.program import LOCAL


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    (folder / "report.html").write_text("<p>the report</p>", encoding="utf-8")
    (folder / "run.rrd").write_bytes(b"RRF2 recording")
    (folder / "film.mp4").write_bytes(b"film")
    (folder / "secret.txt").write_text("secret", encoding="utf-8")
    with served(Board(folder)) as running:
        yield running


def exchange(server, content):
    """Send bytes and return what comes until the server closes, or says nothing more for a while."""
    answer = b""
    with socket.create_connection((LOCAL, server.port), timeout=PATIENCE) as connection, suppress(ConnectionError):
        connection.sendall(content)
        while not complete(answer) and (block := connection.recv(65536)):
            answer += block
    return answer


def complete(answer):
    """Tell whether an answer is whole: its head says how long it is."""
    head, end, body = answer.partition(b"\r\n\r\n")
    lengths = [int(line.split(b":")[1]) for line in head.lower().split(b"\r\n") if line.startswith(b"content-length")]
    return bool(end) and (head.startswith(b"HTTP/1.1 101") or bool(lengths) and len(body) >= lengths[0])


def request(target="/?token={token}", method="GET", host="127.0.0.1:{port}", version="1.1", body="", **headers):
    """Write a request; `{port}` and `{token}` are filled in later."""
    named = {"Host": host, **{name.replace("_", "-"): value for name, value in headers.items()}}
    lines = [f"{method} {target} HTTP/{version}", *(f"{name}: {value}" for name, value in named.items() if value is not None)]
    return "\r\n".join([*lines, "", body])


CHANGING = ("PUT", "DELETE", "OPTIONS", "TRACE", "PATCH", "BREW")
PAGE, FILE, JS = "/?token={token}", "/files/report.html?token={token}", "/board.js"
UPGRADE = {
    "Upgrade": "websocket",
    "Connection": "Upgrade",
    "Sec_WebSocket_Key": "dGhlIHNhbXBsZSBub25jZQ==",
    "Sec_WebSocket_Version": "13",
}
SOCKET = {"target": "/socket?token={token}", "Origin": "http://127.0.0.1:{port}", **UPGRADE}
ANSWERS = {
    # what is served
    "page": (request(), 200),
    "page by its other name": (request(host="localhost:{port}"), 200),
    "page of its own origin": (request(Origin="http://localhost:{port}"), 200),
    "head of the page": (request(method="HEAD", Connection="close"), 200),
    "script": (request(JS), 200),
    "colours": (request("/blocks.css"), 200),
    "report": (request(FILE), 200),
    "to the viewer": (request("/viewer?recording=run.rrd&token={token}"), 303),
    "recording": (request("/viewer/{token}/run.rrd/run.rrd"), 200),
    "socket": (request(**SOCKET), 101),
    "socket of its other name": (request(**{**SOCKET, "Origin": "http://localhost:{port}"}), 101),
    # hosts
    "foreign host": (request(host="evil.example"), 403),
    "foreign host with our port": (request(host="evil.example:{port}"), 403),
    "host of another port": (request(host="127.0.0.1:1"), 403),
    "host without port": (request(host="127.0.0.1"), 403),
    "host that begins like ours": (request(host="127.0.0.1:{port}.evil.example"), 403),
    "host with a user": (request(host="127.0.0.1:{port}@evil.example"), 403),
    "host of another loop": (request(host="127.0.0.2:{port}"), 403),
    "empty host": (request(host=""), 403),
    "no host": (request(host=None), 400),
    "two hosts": (request(host="127.0.0.1:{port}\r\nHost: evil.example"), 400),
    "foreign host for a script": (request(JS, host="evil.example"), 403),
    "HTTP/1.0 without host": (request(version="1.0", host=None), 403),
    "HTTP/1.0": (request(version="1.0"), 200),
    "HTTP/0.9": ("GET /\r\n\r\n", 400),
    "HTTP/9.9": (request(version="9.9"), 200),  # by the rules of the version that is known
    "forwarded host": (request(host="evil.example", X_Forwarded_Host="127.0.0.1:{port}"), 403),
    # origins
    "foreign origin": (request(Origin="http://evil.example"), 403),
    "origin null": (request(Origin="null"), 403),
    "empty origin": (request(Origin=""), 403),
    "origin of another port": (request(Origin="http://127.0.0.1:1"), 403),
    "origin with TLS": (request(Origin="https://127.0.0.1:{port}"), 403),
    "two origins": (request(Origin="http://127.0.0.1:{port}\r\nOrigin: http://evil.example"), 403),
    "foreign origin for a script": (request(JS, Origin="http://evil.example"), 403),
    "socket of a foreign origin": (request(**{**SOCKET, "Origin": "http://evil.example"}), 403),
    "socket of no origin": (request(**{**SOCKET, "Origin": None}), 403),
    "socket of origin null": (request(**{**SOCKET, "Origin": "null"}), 403),
    "socket of a foreign host": (request(host="evil.example:{port}", **SOCKET), 403),
    # tokens
    "no token": (request("/"), 403),
    "empty token": (request("/?token="), 403),
    "wrong token": (request("/?token=" + "x" * 32), 403),
    "part of the token": (request("/?token={token:.20}"), 403),
    "token and more": (request("/?token={token}x"), 403),
    "token of letters that are not ASCII": (request("/?token=%C3%A9%ED%A0%80"), 403),
    "token in a header": (request("/", X_Token="{token}", Cookie="token={token}"), 403),
    "report without token": (request("/files/report.html"), 403),
    "viewer without token": (request("/viewer?recording=run.rrd"), 403),
    "recording with a wrong token": (request("/viewer/x/run.rrd/run.rrd"), 403),
    "viewer's page with a wrong token": (request("/viewer/x/run.rrd/viewer/index.html"), 403),
    "socket without token": (request(**{**SOCKET, "target": "/socket"}), 403),
    "socket with a wrong token": (request(**{**SOCKET, "target": "/socket?token=x"}), 403),
    # paths
    "unknown path": (request("/nothing"), 404),
    "unknown socket": (request(**{**SOCKET, "target": "/other?token={token}"}), 403),
    "socket as a page": (request("/socket?token={token}"), 404),
    "file that is not known": (request("/files/secret.txt?token={token}"), 404),
    "file that is gone": (request("/files/gone.html?token={token}"), 404),
    "a report as a recording": (request("/viewer?recording=report.html&token={token}"), 404),
    "folder above": (request("/files/../secret.txt?token={token}"), 404),
    "folder above, encoded": (request("/files/%2e%2e%2fsecret.txt?token={token}"), 404),
    "folder above, encoded twice": (request("/files/%252e%252e%252fsecret.txt?token={token}"), 404),
    "folder above a known file": (request("/files/report.html/../secret.txt?token={token}"), 404),
    "folder above with backslashes": (request("/files/..%5csecret.txt?token={token}"), 404),
    "folder above, overlong": (request("/files/%c0%ae%c0%ae/secret.txt?token={token}"), 404),
    "absolute file": (request("/files//etc/passwd?token={token}"), 404),
    "file with a zero": (request("/files/report.html%00.txt?token={token}"), 404),
    "the server itself": (request("/server.py"), 404),
    "static folder above": (request("/../server.py"), 404),
    "static folder above, encoded": (request("/..%2f..%2fcolours.py"), 404),
    "address with a host": (request("http://evil.example/board.js"), 404),
    "address with our host": (request("http://127.0.0.1:{port}/board.js", host="evil.example"), 403),
    "two slashes": (request("//board.js"), 404),
    "header in a name": (request("/viewer?recording=run.rrd%0d%0aSet-Cookie:x&token={token}"), 404),
    "letters that are not ASCII": ("GET /\u00e9 HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n", 400),
    # methods and bodies
    **{f"{method} of the page": (request(method=method), 405) for method in CHANGING},
    "CONNECT": (request("evil.example:443", method="CONNECT"), 405),
    "POST": (request(method="POST", body="x=1", Content_Length="3"), 405),
    "POST of a foreign page": (request(method="POST", Origin="http://evil.example", Content_Length="0"), 403),
    "body": (request(body="x", Content_Length="1"), 400),
    "body in pieces": (request(body="1\r\nx\r\n0\r\n\r\n", Transfer_Encoding="chunked"), 400),
    "length and pieces": (request(body="0\r\n\r\n", Content_Length="5", Transfer_Encoding="chunked"), 400),
    "two lengths": (request(Content_Length="0\r\nContent-Length: 7"), 400),
    "negative length": (request(Content_Length="-1"), 400),
    "huge length": (request(Content_Length="9" * 30), 400),
    # heads
    "long path": (request("/" + "x" * 9_000), 404),
    "header folded": (request(X_A="a\r\n Host: evil.example"), 200),
    "header without name": ("GET / HTTP/1.1\r\n: x\r\n\r\n", 400),
    "not HTTP": ("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 400),
    "other upgrade": (request(Upgrade="h2c", Connection="Upgrade"), 200),
    "socket of an old version": (request(**{**SOCKET, "Sec_WebSocket_Version": "8"}), 400),
    "socket without key": (request(**{**SOCKET, "Sec_WebSocket_Key": None}), 400),
    "part of a file": (request(FILE, Range="bytes=3-5"), 206),
    "no part of a file": (request(FILE, Range="bytes=500-"), 416),
}  # fmt: skip


@pytest.mark.parametrize("name", ANSWERS)
def test_a_request_is_answered_by(server, name):
    content, status = ANSWERS[name]
    content = content.replace("{token:.20}", server.token[:20]).replace("{token}", server.token)
    answer = exchange(server, content.replace("{port}", str(server.port)).encode("latin-1"))
    assert answer.startswith(b"HTTP/1.1 %d " % status)
    assert b"secret" not in answer
    assert b"root:" not in answer
    assert b"Set-Cookie" not in answer
    assert b"Access-Control" not in answer
    if status not in (101, 303):
        assert server.token.encode() not in answer


HUGE = {
    "header": request(X_Long="x" * 2_000_000),
    "headers": request(**{f"X_{n}": "y" * 100 for n in range(20_000)}),
    "path": request("/" + "x" * 2_000_000),
    "no line": "x" * 2_000_000,
}


@pytest.mark.parametrize("name", HUGE)
def test_a_request_that_is_huge_is_not_read_to_its_end(server, name):
    answer = exchange(server, HUGE[name].replace("{port}", str(server.port)).encode())
    assert answer == b"" or answer.startswith(b"HTTP/1.1 400 ")


def test_answers_say_what_a_browser_must_not_do_with_them(server):
    ours = f"ws://127.0.0.1:{server.port} ws://localhost:{server.port}"
    for target, policies in {
        "/": ["default-src 'none'", "script-src 'self'", "style-src 'self'", f"connect-src 'self' {ours}"],
        "/nothing": ["default-src 'none'", "script-src 'self'"],
        "/files/report.html": ["default-src 'none'", "sandbox allow-scripts"],
        "/files/film.mp4": ["default-src 'none'", "media-src 'self'"],
    }.items():
        content = request(f"{target}?token={server.token}&recording=run.rrd").replace("{port}", str(server.port))
        head = exchange(server, content.encode()).partition(b"\r\n\r\n")[0].decode()
        policy = head.partition("content-security-policy: ")[2].partition("\r\n")[0].split("; ")
        assert {*policies, "base-uri 'none'", "form-action 'none'", "frame-ancestors 'none'"} <= {*policy, *map(words, policy)}
        for line in ("x-content-type-options: nosniff", "referrer-policy: no-referrer", "cache-control: no-store"):
            assert line in head
        assert "server:" not in head


def words(policy):
    return " ".join(policy.split()[:2])


def test_the_viewer_has_the_other_name_of_this_machine(server):
    for host, other in (server.hosts, server.hosts[::-1]):
        answer = exchange(server, request(f"/viewer?recording=run.rrd&token={server.token}", host=host).encode()).decode()
        assert f"location: http://{other}/viewer/{server.token}/run.rrd/viewer/index.html\r\n" in answer


def test_a_title_is_text_on_the_page(server):
    page = exchange(server, request(f"/?token={server.token}", host=server.hosts[0]).encode()).decode()
    assert "&lt;script&gt;alert(1)" in page
    assert "<script>alert" not in page
    assert "<img" not in page


def test_requests_in_one_piece_are_answered_one_by_one(server):
    pieces = [request("/board.js"), request("/", Origin="http://evil.example"), request("/blocks.css", Connection="close")]
    with socket.create_connection((LOCAL, server.port), timeout=PATIENCE) as connection:
        connection.sendall("".join(pieces).replace("{port}", str(server.port)).encode())
        answer = b""
        while block := connection.recv(65536):
            answer += block
    assert re.findall(rb"HTTP/1\.1 (\d+) ", answer) == [b"200", b"403", b"200"]


MESSAGES = {
    "no JSON": "{",
    "nothing": "",
    "a list": "[]",
    "a number": "1",
    "no action": "{}",
    "an action that is a number": '{"do": 1}',
    "an action that is a table": '{"do": {}}',
    "an id that is a list": '{"do": "cell", "id": []}',
    "an id that is a number": '{"do": "cell", "id": 1}',
    "no number": '{"do": "cell", "value": NaN}',
    "infinity": '{"do": "cell", "value": -Infinity}',
    "a number without end": '{"do": "cell", "value": 1e999}',
    "an integer without end": '{"do": "cell", "value": ' + "9" * 10_000 + "}",
    "half a letter": '{"do": "cell", "value": "\\ud800"}',
    "deep lists": '{"do": "cell", "value": ' + "[" * 30_000,
    "deep lists that end": '{"do": "cell", "value": ' + "[" * 20_000 + "]" * 20_000 + "}",
    "deep tables": '{"a":' * 10_000 + "1" + "}" * 10_000,
    "bytes": b'{"do": "cell"}',
    "bytes that are no letters": bytes(range(256)),
    "letters with zeros": "\0" * 100,
}


@pytest.mark.parametrize("name", MESSAGES)
def test_a_message_that_is_no_action_is_told_so(server, name):
    with window(server) as opened:
        opened.send(MESSAGES[name])
        assert heard(opened)["said"].startswith("a message is a table in JSON")
        ask(opened, "cell", value=1)
        assert heard(opened) == {"said": "1"}


def test_an_action_that_is_not_known_or_lacks_something_is_told_so(server, capfd):
    with window(server) as opened:
        for do in ("fly", "__class__x", "", SCRIPT):
            ask(opened, do)
            assert heard(opened) == {"said": f"there is no action {do!r}", "tone": "bad"}
        ask(opened, "cell", "lacking")
        assert until(opened, "lacking")[0]["said"].startswith("Internal error")
    assert "KeyError: 'value'" in capfd.readouterr().err


def test_what_is_typed_comes_back_as_text(server):
    with window(server) as opened:
        for text in (SCRIPT, "&lt;b&gt;", "\u2028", "\0", "\U0001f600", "a\r\nSet-Cookie: x", "{{ 7 * 7 }}", "%s" * 20):
            number = f"typed {text}"
            ask(opened, "cell", number, value=text)
            assert until(opened, number) == [{"said": text}]


@pytest.mark.parametrize("size", [65 * 1024, 10_000_000])
def test_a_message_that_is_too_large_ends_the_window(server, size):
    from websockets.exceptions import ConnectionClosed

    with window(server) as opened:
        with suppress(ConnectionClosed):
            opened.send("x" * size)
        with pytest.raises(ConnectionClosed):
            heard(opened)
    with window(server):
        pass


def test_frames_that_break_the_rules_end_the_window(server):
    for broken in (
        b"\x81\x05hello",
        b"\xf1\x80" + bytes(4),
        frame(b"\xff\xfe"),
        b"\x80\x80" + bytes(4),
        b"\x8f\x80" + bytes(4),
    ):
        with socket.create_connection((LOCAL, server.port), timeout=PATIENCE) as connection:
            connection.sendall(handshake(server))
            assert connection.recv(12) == b"HTTP/1.1 101"
            connection.sendall(broken)
            with suppress(ConnectionError):
                while connection.recv(65536):  # until the server closes
                    pass


def test_two_hundred_connections_that_ask_for_nothing_keep_no_window_out(server):
    with ExitStack() as stack:
        for number in range(200):
            slow = stack.enter_context(closing(socket.create_connection((LOCAL, server.port), timeout=PATIENCE)))
            if number % 2:
                slow.send(b"GET / HTTP/1.1\r\nX-Slow: ")
        with window(server) as opened:
            ask(opened, "cell", "beside slow ones", value=3)
            assert until(opened, "beside slow ones") == [{"said": "3"}]
            assert exchange(server, request("/board.js", host=server.hosts[0]).encode()).startswith(b"HTTP/1.1 200 ")
            assert len(server.server_state.connections) <= 33


def test_a_port_that_is_taken_is_said(server):
    from wirerope_mj.foundation.errors import WireRopeError
    from wirerope_mj.views.board import serve

    with pytest.raises(WireRopeError, match=f"port {server.port} of 127.0.0.1 cannot be had"):
        serve(Board(), browser=False, port=server.port)
