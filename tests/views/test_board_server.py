"""The server of the drawing board: what it does in which order, and what it refuses."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from concurrent.futures import Future
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from threading import Event, Thread

import pytest

from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.views.board.server import BoardServer
from wirerope_mj.views.recording.program import LOCAL

connect = pytest.importorskip("websockets.sync.client").connect

PATIENCE = 30.0
"""Time after which what is waited for is given up [s]: no measure of speed, which depends on what else the machine does."""

SCRIPT = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"


class Board:
    """A board whose actions say what they do; those that take long wait for `go`."""

    title = f"rack {SCRIPT}"

    def __init__(self, folder=None):
        self.folder, self.taken, self.go, self.outside, self.closed = folder, [], Event(), [], Event()
        self.elsewhere = Future()

    def open(self):
        return {"html": {"left": "the board"}, "said": f"{len(self.taken)} taken"}

    def act(self, action):
        if not hasattr(self, action["do"]):
            raise ValueError(f"there is no action {action['do']!r}")
        yield from getattr(self, action["do"])(action)

    def edit(self, action):
        self.taken.append(action["to"])
        yield True, {"scene": action["to"], "stale": True}
        try:
            self.go.wait(PATIENCE)
            yield True, {"said": "half of a verdict"}
            yield True, {"said": f"verdict of {action['to']}", "stale": False}
        except GeneratorExit:
            self.taken.append(f"void {action['to']}")
            raise

    def report(self, action):
        yield False, {"said": "begun"}
        self.go.wait(PATIENCE)
        yield False, {"said": "half of a report"}
        yield False, {"said": "report"}

    def hold(self, action):
        self.go.wait(PATIENCE)
        yield False, {"said": "held"}

    def film(self, action):
        yield False, {"said": "begun"}
        yield False, self.elsewhere
        yield False, {"said": self.elsewhere.result()}

    def drag(self, action):
        self.taken.append(action["by"])
        yield False, {"preview": action["by"]}

    def cell(self, action):
        self.taken.append(action["value"])
        yield False, {"said": str(action["value"])}

    def fail(self, action):
        raise WireRopeError(f"{action['to']} does not stand")

    def bug(self, action):
        yield False, {"said": "so far"}
        raise KeyError("nobody meant this")

    def nan(self, action):
        yield False, {"said": float("nan")}

    def many(self, action):
        for _ in range(2000):
            yield False, {"said": "x" * 20_000}

    def changed_outside(self):
        return self.outside.pop() if self.outside else None

    def file(self, name):
        return self.folder / name if name in ("report.html", "run.rrd", "film.mp4", "gone.html") else None

    def close(self):
        self.closed.set()


@contextmanager
def served(board):
    """Yield a server of a board, in a thread."""
    server = BoardServer(board)
    thread = Thread(target=server.run)
    thread.start()
    try:
        yield server
    finally:
        board.go.set()
        server.should_exit = True
        thread.join(PATIENCE)
        assert not thread.is_alive()
        assert board.closed.is_set()


@contextmanager
def window(server, **how):
    """Yield a window of a board, after its first message."""
    host = server.hosts[0]
    address = f"ws://{host}/socket?token={server.token}"
    with connect(address, **{"origin": f"http://{host}", "close_timeout": PATIENCE, **how}) as opened:
        assert heard(opened)["html"] == {"left": "the board"}
        yield opened


def heard(opened):
    return json.loads(opened.recv(timeout=PATIENCE))


def ask(opened, do, number=None, **more):
    opened.send(json.dumps({"do": do, **({"id": number} if number else {}), **more}))


def arrive(opened, number):
    """Wait until the server has read what a window sent: what is known is answered at once."""
    ask(opened, "cell", number)
    return until(opened, number)


def until(opened, number):
    """Return what a window is told until an action is done, without that."""
    told = []
    while (message := heard(opened)) != {"done": number}:
        told.append(message)
    return told


@pytest.fixture
def board():
    return Board()


@pytest.fixture
def server(board):
    with served(board) as running:
        yield running


def test_an_action_is_told_as_it_becomes_known_and_done_once_it_is_applied(server, board):
    with window(server) as first:
        ask(first, "edit", "1", to="a")
        assert until(first, "1") == [{"scene": "a", "stale": True}]
        board.go.set()
        assert [heard(first) for _ in range(2)] == [
            {"said": "half of a verdict"},
            {"said": "verdict of a", "stale": False},
        ]


def test_actions_are_taken_in_order(server, board):
    board.go.set()
    with window(server) as first:
        for number in range(40):
            ask(first, "cell", str(number + 1), value=number)
        until(first, "40")
    assert board.taken == list(range(40))


def test_every_window_is_told_of_an_edit_and_only_the_one_that_asked_of_an_error(server, board):
    board.go.set()
    with window(server) as first, window(server) as second:
        ask(first, "fail", "1", to="rack")
        assert until(first, "1") == [{"said": "rack does not stand", "tone": "bad"}]
        ask(first, "edit", "2", to="b")
        assert heard(second) == {"scene": "b", "stale": True}
        assert [heard(second)["said"], heard(second)["said"]] == ["half of a verdict", "verdict of b"]


def test_a_newer_edit_makes_the_verdict_of_the_older_void(server, board):
    with window(server) as first:
        ask(first, "edit", "1", to="a")
        until(first, "1")
        ask(first, "edit", "2", to="b")
        assert arrive(first, "1") == []  # it waits for the step that is being computed
        board.go.set()
        assert [message["said"] for message in until(first, "2") if "said" in message] == ["half of a verdict"]
        assert [heard(first)["said"], heard(first)["said"]] == ["half of a verdict", "verdict of b"]
    assert board.taken == ["a", "b", "void a"]


def test_what_makes_no_verdict_void_is_done_between_its_steps(server, board):
    with window(server) as first:
        ask(first, "report", "1")
        until(first, "1")
        ask(first, "cell", "2", value=5)
        assert arrive(first, "1") == []
        board.go.set()
        assert until(first, "2") == [{"said": "half of a report"}, {"said": "5"}]
        assert heard(first) == {"said": "report"}


def test_what_another_process_computes_holds_up_nothing(server, board):
    with window(server) as first:
        ask(first, "film", "1")
        assert until(first, "1") == [{"said": "begun"}]
        for number in ("2", "3"):
            ask(first, "cell", number, value=number)
            assert until(first, number) == [{"said": number}]
        board.elsewhere.set_result("made")
        assert heard(first) == {"said": "made"}


def test_of_what_passes_by_the_last_alone_is_done(server, board):
    with window(server) as first:
        ask(first, "edit", "1", to="a")
        until(first, "1")
        for by in range(5):
            ask(first, "drag", str(by + 2), by=by, passing=True)
        assert arrive(first, "1") == []
        board.go.set()
        until(first, "6")
    assert board.taken[1] == 4


def test_an_action_that_comes_again_over_a_new_connection_is_not_taken_twice(server, board):
    with window(server) as first:
        ask(first, "cell", "a.1", value=1)
        until(first, "a.1")
    with window(server) as again:
        ask(again, "cell", "a.1", value=1)
        assert until(again, "a.1") == []
        ask(again, "cell", "a.2", value=2)
        assert until(again, "a.2") == [{"said": "2"}]
    assert board.taken == [1, 2]


def test_what_others_have_changed_is_told_to_every_window(server, board):
    with window(server) as first, window(server) as second:
        board.outside.append({"said": "changed"})
        assert heard(first) == heard(second) == {"said": "changed"}
        board.changed_outside = lambda: board.missing
        assert heard(first)["said"].startswith("Internal error")
        del board.changed_outside
        board.outside.append({"said": "changed again"})
        assert heard(first) == {"said": "changed again"}


def test_a_bug_is_printed_and_the_board_goes_on(server, board, capfd):
    with window(server) as first:
        ask(first, "bug", "1")
        assert until(first, "1") == [{"said": "so far"}]
        assert heard(first)["said"].startswith("Internal error")
        ask(first, "nan", "2")
        assert until(first, "2")[0]["said"].startswith("Internal error")
        ask(first, "cell", "3", value=1)
        assert until(first, "3") == [{"said": "1"}]
    errors = capfd.readouterr().err
    assert "nobody meant this" in errors
    assert "this message cannot be written" in errors


def test_a_window_that_reads_nothing_is_given_up(server, board):
    with socket.create_connection((LOCAL, server.port)) as slow, window(server) as other:
        slow.sendall(handshake(server))
        assert slow.recv(12) == b"HTTP/1.1 101"
        slow.sendall(frame(json.dumps({"do": "many"}).encode()))
        while len(server.windows._open) < 2:
            time.sleep(0.01)
        for number in count():
            if len(server.windows._open) == 1:
                break
            ask(other, "cell", f"again {number}", value=1)
            assert heard(other) == {"said": "1"}
            heard(other)
        assert len(server.windows._open) == 1


def handshake(server, **changed):
    """Write the request of a window, with headers changed, or left out where they are None."""
    headers = {
        "Host": server.hosts[0], "Origin": f"http://{server.hosts[0]}", "Upgrade": "websocket", "Connection": "Upgrade",
        "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Version": "13", **changed,
    }  # fmt: skip
    lines = [f"GET /socket?token={server.token} HTTP/1.1", *(f"{key}: {value}" for key, value in headers.items() if value)]
    return "\r\n".join([*lines, "", ""]).encode()


def frame(content, code=1):
    """Write a masked frame of a socket: 1 for text, 2 for bytes."""
    return bytes([128 + code, 128 + 126]) + len(content).to_bytes(2, "big") + bytes(4) + content


SERVING = """
import time
from test_board_server import Board
from wirerope_mj.views.board import serve

class Long(Board):
    def hold(self, action):
        yield False, {"said": "begun"}
        time.sleep(600.0)

    def close(self):
        print("closed", flush=True)

serve(Long(), browser=False)
"""


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 0), (signal.SIGTERM, -signal.SIGTERM)])
def test_a_signal_ends_the_server_in_the_middle_of_a_computation(number, code):
    paths = os.pathsep.join(str(Path(__file__).parents[n]) for n in range(2))
    process = subprocess.Popen(
        [sys.executable, "-c", SERVING], env={**os.environ, "PYTHONPATH": paths}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    with process:
        try:
            address = process.stdout.readline().removeprefix("Open ").strip()
            origin, _, query = address.partition("/?")
            with connect(f"{origin.replace('http', 'ws')}/socket?{query}", origin=origin) as opened:
                heard(opened)
                ask(opened, "hold", "1")
                assert until(opened, "1") == [{"said": "begun"}]
                process.send_signal(number)
                output, errors = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    assert process.returncode == code
    assert "closed" in output
    assert ("Ended." in output) == (number == signal.SIGINT)
    assert errors == ""
