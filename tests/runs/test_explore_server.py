"""The server of a what-if: this machine only, a token, small requests, and the newest goes first."""

import http.client
import json
import signal
import socket
import struct
import sys
import time
from threading import Event, Thread

import pytest
from kills import interruptible

from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.runs.explore import Exploration
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.views.explore.server import ExploreServer

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def server():
    """Return a server of the shock table without viewer."""
    yield from serving(Exploration(load_scenario("shock_table").make()), viewer=False)


def serving(explored, **options):
    with ExploreServer(explored, **options) as one:
        thread = Thread(target=one.serve_forever, daemon=True)
        thread.start()
        yield one
        one.shutdown()
        thread.join()


def asked(server, path, content=None, *, token=None, host=None, headers=None):
    """Return status and text of an answer; a request with content is a POST."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=120)
    sent = {"X-Token": server.token if token is None else token, **(headers or {})}
    if host is not None:
        sent["Host"] = host
    body = content if isinstance(content, bytes | None) else json.dumps(content).encode()
    connection.request("GET" if content is None else "POST", path, body, sent)
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    return answer.status, text


def run(server, content, **options):
    status, text = asked(server, "/run", content, **options)
    return status, json.loads(text)


def test_it_listens_on_this_machine_only(server):
    assert server.server_address[0] == "127.0.0.1"
    assert server.address == f"http://127.0.0.1:{server.server_port}/?token={server.token}"
    assert len(server.token) >= 32


def test_a_slider_changes_the_verdict(server):
    start = json.loads(asked(server, "/start")[1])
    assert start["title"] == "Shock table"
    assert not start["viewer"]
    assert {slider["key"] for slider in start["sliders"]} == {"level", "mass", "stiffness/wr12_400", "damping"}
    assert start["answer"]["now"]["headline"].startswith("PASS of the mounts: most critical")
    status, answer = run(server, {"values": {"level": 2.0}})
    assert status == 200
    assert answer["now"]["headline"].startswith("FAIL")
    assert answer["before"]["headline"] == start["answer"]["now"]["headline"]


@pytest.mark.parametrize("path", ["/", "/?token=wrong", "/?token=", "/start", "/recording/1"])
def test_without_the_token_nothing_is_told(server, path):
    for token in ("", "wrong", server.token[:-1], "\u00e4"):
        status, text = asked(server, path, token=token)
        assert status == 403
        assert server.token not in text
    status, answer = run(server, {"values": {}}, token="wrong")
    assert (status, "token" in answer["error"]) == (403, True)


@pytest.mark.parametrize("host", ["wirerope.example", "127.0.0.1", "127.0.0.1:1", "[::1]:80", "", "127.0.0.1.example:80"])
def test_another_host_is_refused(server, host):
    for path in ("/start", "/explore.js", f"/?token={server.token}"):
        assert asked(server, path, host=host)[0] == 403
    assert asked(server, "/start", host=f"localhost:{server.server_port}")[0] == 200


@pytest.mark.parametrize(
    ("content", "status", "words"),
    [
        (b"no json", 400, "a table in JSON"),
        (b"[" * 3000, 400, "a table in JSON"),
        (b"\xff\xfe", 400, "a table in JSON"),
        (b"[1]", 400, "a table in JSON"),
        (b" " * 5000, 413, "at most 4096 bytes"),
        ({"values": {"level": "much"}}, 422, "must be a finite number"),
        (b'{"values": {"level": NaN}}', 422, "must be a finite number"),
        (b'{"values": {"level": 1e999}}', 422, "must be a finite number"),
        ({"values": {"volume": 1}}, 422, "there is no slider"),
        ({"values": 3}, 422, "must be a table"),
        ({}, 422, "must be a table"),
    ],
)
def test_wild_requests_are_refused(server, content, status, words):
    before = asked(server, "/start")[1]
    got, answer = run(server, content)
    assert got == status
    assert words in answer["error"]
    assert asked(server, "/start")[1] == before


def test_numbers_out_of_range_are_clamped(server):
    _, answer = run(server, {"values": {"level": 1e6, "mass": -1}})
    assert answer["now"]["values"]["level"] == 2.0
    assert answer["now"]["values"]["mass"] == 0.5


def test_only_what_belongs_to_the_page_is_there(server):
    for path in ("/server.py", "/../server.py", "/explore.html", "/re_viewer.js", "/recording/x", "/recording/-1"):
        assert asked(server, path)[0] == 404
    assert asked(server, "/somewhere", {"values": {}})[0] == 404
    assert asked(server, "/recording/999999")[0] == 409


def test_the_page_may_load_from_nowhere_else(server):
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port)
    connection.request("GET", f"/?token={server.token}")
    answer = connection.getresponse()
    page = answer.read().decode()
    connection.close()
    policy = answer.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "connect-src 'self' data: blob:" in policy
    assert answer.headers["Referrer-Policy"] == "no-referrer"
    assert server.token not in page
    assert "http" not in page
    for name in ("explore.js", "chart.js", "explore.css", "viewer.html", "viewer.css", "viewer.js"):
        status, text = asked(server, f"/{name}", token="")
        assert status == 200
        assert "https:" not in text


class Slow:
    """Takes a run at a time, as long as it is held."""

    def __init__(self):
        self.begun, self.free, self.values = Event(), Event(), []

    def run(self, values, *, passing, exact):
        self.values.append(values)
        self.begun.set()
        assert self.free.wait(120)
        if values == "fails":
            raise SimulationError("it fell over.")
        return {"values": values}


def test_a_page_that_is_closed_while_it_waits_is_no_error(capsys):
    slow = Slow()
    for server in serving(slow, viewer=False):
        connection = http.client.HTTPConnection("127.0.0.1", server.server_port)
        connection.request("POST", "/run", json.dumps({"values": 1}).encode(), {"X-Token": server.token})
        assert slow.begun.wait(120)
        assert connection.sock is not None
        # Closed with data unread it is reset, and whoever writes to it is told so.
        connection.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        connection.close()
        slow.free.set()
        assert run(server, {"values": 2}) == (200, {"values": 2})
    assert capsys.readouterr().err == ""


def test_of_the_runs_that_wait_only_the_newest_is_computed():
    slow, answers = Slow(), {}

    def ask(number):
        answers[number] = run(server, {"values": number})

    for server in serving(slow, viewer=False):
        threads = [Thread(target=ask, args=(number,)) for number in range(6)]
        threads[0].start()
        assert slow.begun.wait(120)
        for number, thread in enumerate(threads[1:], start=1):
            thread.start()
            while server.runs._newest <= number:
                time.sleep(1e-3)
        slow.free.set()
        for thread in threads:
            thread.join(120)
        assert slow.values == [0, 5]
        assert [answers[n][0] for n in range(6)] == [200, 409, 409, 409, 409, 200]
        assert answers[3][1] == {"overtaken": True}
        assert answers[5][1] == {"values": 5}
        assert run(server, {"values": "fails"}) == (422, {"error": "it fell over."})


@pytest.mark.slow
def test_the_command_prints_its_address_and_ends_on_an_interrupt(tmp_path):
    code = "import sys; from wirerope_mj.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "explore", "shock_table", "--no-browser", "--no-viewer"]
    with interruptible(command, cwd=tmp_path) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline() for _ in range(3)]
        assert lines[1].startswith("Open http://127.0.0.1:")
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
    assert (process.returncode, out.strip(), err) == (130, "Ended.", "")


def test_what_the_command_refuses(capsys, server):
    for tokens, words in (
        ([], "Move sliders"),
        (["--no-browser"], "the scenario or the model comes first"),
        (["nothing"], "no scenario and no model 'nothing'"),
        (["shock_table", "--port", "70000"], "`--port` must be from 0 to 65535"),
        (["shock_table", "--no-browser", "--port", str(server.server_port)], "cannot be had"),
    ):
        assert main(["explore", *tokens]) == 2
        printed = capsys.readouterr()
        assert words in printed.out + printed.err
        assert "Traceback" not in printed.err
