"""The windows of a board, and the order in which what they ask for is done."""

import asyncio
import json
import math
import traceback
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any, Protocol
from urllib.parse import urlsplit

from starlette.websockets import WebSocket, WebSocketDisconnect

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import WireRopeError

_OPEN = 8  # windows at once
_WATCH = 0.5  # time between two looks at what others have changed [s]
_WAITING = 64  # actions of a window that wait; more are not read from its socket
_KNOWN = 1000 * _OPEN  # actions that are known when they come again, after a connection was lost
_END = 0.3  # time that a computation has to end with the server [s]
_BUG = "Internal error: the terminal of `wirerope board` says more. The board goes on."
_FORM = "a message is a table in JSON with `do`, the name of an action, and finite numbers."
_MANY = f"this board is open in {_OPEN} windows, which is the most. Close one of them."


class Served(Protocol):
    """The board that windows show and edit; all but `file` is called from one thread."""

    @property
    def title(self) -> str:
        """Return the name of what is shown."""

    def open(self) -> Entries:
        """Return the first message of a window: scene, HTML of its elements."""

    def act(self, action: Entries) -> Iterable[tuple[bool, Entries]]:
        """Take an action; yield messages as they become known, and whether every window is to have them.

        An action whose message says `"stale": true` closes earlier ones that said so and have more to yield: a verdict of a
        former position is void. All others go on once nothing else waits. `"open"` may be /files/NAME or
        /viewer?recording=NAME, with NAME quoted, and behind it # and the instant [s] of a recording. WireRopeError or
        ValueError, whose text is shown in the window that asked, if the action cannot be taken.
        """

    def changed_outside(self) -> Entries | None:
        """Return a message for every window if others have changed files."""

    def file(self, name: str) -> Path | None:
        """Find a report or a recording by its name; None if there is none."""

    def close(self) -> None:
        """Release what the board holds."""


class _Worker:
    """One thread for all computations, beside which the event loop stays free; it keeps no process from ending."""

    def __init__(self) -> None:
        self._jobs = SimpleQueue[tuple["Future[Any]", Callable[[], Any]] | None]()
        self._thread = Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while job := self._jobs.get():
            future, work = job
            if future.set_running_or_notify_cancel():
                try:
                    future.set_result(work())
                except BaseException as error:
                    future.set_exception(error)

    async def do(self, work: Callable[[], Any]) -> Any:
        future = Future[Any]()
        self._jobs.put((future, work))
        return await asyncio.wrap_future(future)

    def end(self) -> None:
        self._jobs.put(None)
        self._thread.join(_END)


class _Window:
    """A window and its socket."""

    def __init__(self, connection: WebSocket) -> None:
        self.connection = connection
        self.shown = False  # whether it has the board's first message, to which others refer
        self.waiting = asyncio.Semaphore(_WAITING)

    async def tell(self, message: Entries | str) -> None:
        text = message if isinstance(message, str) else _text(message)
        with suppress(WebSocketDisconnect, RuntimeError):  # it was closed
            await self.connection.send_text(text)


@dataclass(eq=False)
class _Request:
    """An action that a window asked for."""

    window: _Window
    action: Entries
    steps: Iterator[tuple[bool, Entries]] | None = None  # what it yields, once it has begun
    verdict: bool = False  # that a later one makes void

    @property
    def kind(self) -> Entries | None:
        """What it has in common with the newer one that overtakes it; None if it must be taken."""
        if self.action["do"] != "drag" and self.action.get("passing") is not True:
            return None
        return {key: value for key, value in self.action.items() if key not in ("id", "by", "value")}

    def step(self, board: Served, token: str) -> tuple[bool, Entries, str] | None:
        """Compute as far as the next message; addresses of the server in it get the token."""
        if self.steps is None:
            self.steps = iter(board.act(self.action))
        step = next(self.steps, None)
        if step is None:
            return None
        everyone, message = step
        if "open" in message:
            address = urlsplit(message["open"])
            query = "&".join(filter(None, (address.query, f"token={token}")))
            message = {**message, "open": address._replace(query=query).geturl()}
        return everyone, message, _text(message)


@dataclass
class Windows:
    """All windows of a board: they are told what changes, and what they ask for is done in one thread, in order."""

    board: Served
    token: str
    _worker: _Worker = field(default_factory=_Worker)
    _open: list[_Window] = field(default_factory=list)
    _waiting: list[_Request] = field(default_factory=list)
    _begun: list[_Request] = field(default_factory=list)  # that have more to tell, the newest last
    _known: dict[str, None] = field(default_factory=dict)  # ids of actions, the last at the end
    _arrived: asyncio.Event = field(default_factory=asyncio.Event)

    async def attend(self, connection: WebSocket) -> None:
        """Show the board in a window until it is closed."""
        await connection.accept()
        if len(self._open) >= _OPEN:
            await connection.send_json({"said": _MANY, "tone": "bad"})
            await connection.close(1013)
            return
        window = _Window(connection)
        self._open.append(window)
        try:
            await self._listen(window)
        finally:
            self._open.remove(window)

    async def _listen(self, window: _Window) -> None:
        try:
            await window.tell(await self._worker.do(self.board.open))
        except Exception as error:
            await window.tell(_failure(error))
        window.shown = True
        while True:
            await window.waiting.acquire()
            message = await window.connection.receive()
            if message["type"] == "websocket.disconnect":
                return
            try:
                action = _read(message.get("text"))
            except (ValueError, RecursionError):
                window.waiting.release()
                await window.tell({"said": _FORM, "tone": "bad"})
                continue
            await self._take(_Request(window, action))

    async def _take(self, request: _Request) -> None:
        """Have a request wait for its turn; an older one of its kind is not done, one that is known not again."""
        if number := request.action.get("id"):
            if number in self._known:
                await self._end(request)
                return
            self._known[number] = None
            if len(self._known) > _KNOWN:
                del self._known[next(iter(self._known))]
        for older in self._waiting.copy():
            if older.window is request.window and older.kind is not None and older.kind == request.kind:
                self._waiting.remove(older)
                await self._end(older)
        self._waiting.append(request)
        self._arrived.set()

    async def _end(self, request: _Request) -> None:
        """Say that a request is taken."""
        request.window.waiting.release()
        if number := request.action.get("id"):
            await request.window.tell({"done": number})

    async def conduct(self) -> None:
        """Take the requests in order; those that have more to tell go on when no other waits, the newest first."""
        while True:
            if self._waiting:
                self._begun.append(self._waiting.pop(0))
            if self._begun:
                await self._proceed(self._begun[-1])
            else:
                self._arrived.clear()
                await self._arrived.wait()

    async def _proceed(self, request: _Request) -> None:
        first, told = request.steps is None, None
        try:
            told = await self._worker.do(lambda: request.step(self.board, self.token))
        except Exception as error:
            await request.window.tell(_failure(error))
        if told is None:
            self._begun.remove(request)
        else:
            everyone, message, text = told
            if message.get("stale") is True and not request.verdict:
                await self._void([older for older in self._begun if older.verdict])
                request.verdict = True
            await self._tell_all(text) if everyone else await request.window.tell(text)
        if first:
            await self._end(request)

    async def _void(self, requests: list[_Request]) -> None:
        for request in requests:
            self._begun.remove(request)
            if isinstance(request.steps, Generator):
                try:
                    await self._worker.do(request.steps.close)
                except Exception as error:
                    await request.window.tell(_failure(error))

    async def watch(self) -> None:
        """Tell every window what others have changed."""
        failed = ""
        while True:
            await asyncio.sleep(_WATCH)
            try:
                message, failed = await self._worker.do(self.board.changed_outside), ""
            except Exception as error:
                if failed == repr(error):  # not twice a second
                    continue
                message, failed = _failure(error), repr(error)
            if message:
                await self._tell_all(message)

    async def _tell_all(self, message: Entries | str) -> None:
        for window in self._open.copy():
            if window.shown:
                await window.tell(message)

    def close(self) -> None:
        self._worker.end()
        self.board.close()


def _read(text: str | None) -> Entries:
    """Read an action; ValueError or RecursionError if the text is none, or has letters that no file can hold."""
    action = json.loads(text or "", parse_constant=_finite, parse_float=_finite)
    json.dumps(action, ensure_ascii=False).encode()
    if not isinstance(action, dict) or not isinstance(action.get("do"), str) or not isinstance(action.get("id", ""), str):
        raise ValueError(_FORM)
    return action


def _finite(text: str) -> float:
    if not math.isfinite(value := float(text)):
        raise ValueError(_FORM)
    return value


def _text(message: Entries) -> str:
    try:
        return json.dumps(message, allow_nan=False)
    except ValueError as error:  # a fault of the board, not of what was asked for
        raise TypeError(f"this message cannot be written: {message}") from error


def _failure(error: Exception) -> Entries:
    """Word an error for a window; what nobody meant to raise is printed."""
    if isinstance(error, WireRopeError | ValueError):
        return {"said": str(error), "tone": "bad"}
    traceback.print_exception(error)
    return {"said": _BUG, "tone": "bad"}
