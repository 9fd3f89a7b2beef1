"""Requests to the page of a what-if: their text, their headers, and the values of their sliders."""

import http.client
import json
from functools import cache
from threading import Thread

import numpy as np
from campaign import Case
from hostile import damaged, pick

import wirerope_mj as wr
from wirerope_mj.runs.explore import Exploration
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.views.explore.server import ExploreServer

VALUES = (
    "1", "0.5", "2", "NaN", "Infinity", "-Infinity", "1e400", "-0", "1e-308", str(10**400), "9" * 5000, '"1"', "null", "true",
    "[1]", "{}", "1.0e0", "-5", "1e308",
)  # fmt: skip
PATHS = (
    "/run",
    "/run/",
    "/start",
    "/",
    "/recording/1",
    "/recording/99999999999",
    "/recording/-1",
    "/../x",
    "/explore.js",
    "/nobody",
)


@cache
def server() -> ExploreServer:
    """Return a server of a short run, made once a process."""
    pulse = wr.HalfSine(peak=30.0, duration=0.005, direction="z")
    explored = Exploration(Scenario("does it hold?", "sdof_shaker", pulse, {"duration": 0.02, "timestep": 1e-3}))
    one = ExploreServer(explored, viewer=False)
    one.handle_error = lambda *_: None  # what it would print; the request is then left without an answer
    Thread(target=one.serve_forever, daemon=True).start()
    return one


def mutate(rng: np.random.Generator, folder) -> Case:
    """Make a request whose values, text, path, length or token is strange."""
    keys = ["level", "mass", "damping", "stiffness/sdof_36hz", "nobody", "", "direction"]
    pairs = [
        f"{json.dumps(pick(rng, keys[:3] if rng.random() < 0.8 else keys))}: {pick(rng, VALUES)}"
        for _ in range(pick(rng, (0, 1, 1, 2)))
    ]
    passing = pick(rng, ("", ', "passing": true', ', "exact": 1', ', "passing": "x"', ', "exact": true'))
    body = f'{{"values": {{{", ".join(pairs)}}}{passing}}}'.encode()
    path, method, headers = "/run", "POST", {"X-Token": server().token}
    kind = rng.random()
    if kind < 0.15:
        body = damaged(body, rng)
    elif kind < 0.2:
        body = pick(rng, (b"", b"[]", b"3", b"\xff\xfe", b"[" * 5000, b'{"values": ' * 900, b"null", b'{"values": 3}'))
    elif kind < 0.3:
        path, method = pick(rng, PATHS), pick(rng, ("GET", "POST", "PUT", "HEAD"))
    elif kind < 0.35:
        headers |= {
            pick(rng, ("X-Token", "Host", "Content-Length")): pick(rng, ("", "x", "-1", "1e9", "\u00fc", "99999999999"))
        }
    return Case(f"{method} {path} {body!r:.150}", {"path": path, "method": method, "headers": headers, "body": body})


def use(case: Case) -> str | None:
    """Send the request; every one is answered, in JSON where it is refused, and with finite numbers where it is not."""
    connection = http.client.HTTPConnection("127.0.0.1", server().server_port, timeout=10)
    try:
        headers = {name: value.encode("latin-1") for name, value in case.inputs["headers"].items()}
        connection.request(case.inputs["method"], case.inputs["path"], case.inputs["body"], headers)
        answer = connection.getresponse()
        status, text = answer.status, answer.read().decode()
    finally:
        connection.close()
    if case.inputs["path"] != "/run" or case.inputs["method"] != "POST":
        return None if status < 500 or status == 501 else f"status {status}: {text[:100]}"
    if status == 200:
        content = json.loads(text, parse_constant=lambda word: 1 / 0)
        return None if content else "nothing was answered"
    message = json.loads(text)["error"] if text.startswith("{") else ""
    if status >= 500 or not message:
        return f"status {status}: {text[:100]}"
    raise ValueError(message)
