"""The windows of a board, and the order in which what they ask for is done."""

import asyncio
import json
import math
import traceback
from collections import deque
from collections.abc import Callable, Generator
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any, Protocol

from starlette.websockets import WebSocket, WebSocketDisconnect

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import WireRopeError

_WATCH = 0.5  # time between two looks at what others have changed [s]
_KNOWN = 8000  # actions that are known when they come again, after a connection was lost
_END = 0.3  # time that a computation has to end with the server [s]
_BUG = "Internal error: the terminal of `wirerope board` says more. The board goes on."
_FORM = "a message is a table in JSON with `do`, the name of an action, and finite numbers."
Steps = Generator[tuple[bool, Entries], None, None]
"""What comes of an action: messages, and whether every window is to have them."""


class Served(Protocol):
    """The board that windows show and edit; all but `file` is called from one thread."""

    @property
    def title(self) -> str:
        """Return the name of what is shown."""

    def open(self) -> Entries:
        """Return the first message of a window: scene, HTML of its elements."""

    def act(self, action: Entries) -> Steps:
        """Take an action; yield messages as they become known, and whether every window is to have them.

        An action whose message says `"stale": true` closes earlier ones that said so and have more to yield: a verdict of a
        former position is void. All others go on once nothing else waits. An action that
        says `"passing": true` is left out if its window asks for something else before its turn, as for the next position of
        what is dragged. `"open"` may be /files/NAME or
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


@dataclass(eq=False)
class _Request:
    """An action that a window asked for."""

    window: WebSocket | None  # None: the board itself
    action: Entries
    steps: Steps | None = None  # what it yields, once it has begun
    verdict: bool = False  # that a later one makes void
    replaced: bool = False  # by what its window asked for later


@dataclass
class Windows:
    """All windows of a board: they are told what changes, and what they ask for is done in one thread, in order."""

    board: Served
    _worker: _Worker = field(default_factory=_Worker)
    _open: list[WebSocket] = field(default_factory=list)
    _waiting: asyncio.Queue[_Request] = field(default_factory=asyncio.Queue)
    _passing: dict[WebSocket, _Request] = field(default_factory=dict)  # the last of each window if the next may replace it
    _begun: list[_Request] = field(default_factory=list)  # that have more to tell, the newest last
    _known: deque[str] = field(default_factory=lambda: deque(maxlen=_KNOWN))  # ids of actions

    async def attend(self, window: WebSocket) -> None:
        """Show the board in a window until it is closed."""
        await window.accept()
        try:
            first = await self._worker.do(lambda: _text(self.board.open()))
        except Exception as error:
            first = _failure(error)
        self._open.append(window)  # from here on it is told what changes in what it is shown first
        try:
            await _tell(window, first)
            while (message := await window.receive())["type"] != "websocket.disconnect":
                await self._take(window, message.get("text"))
        finally:
            self._open.remove(window)
            self._passing.pop(window, None)

    async def _take(self, window: WebSocket, text: str | None) -> None:
        """Have an action wait for its turn; one that is known is not done again."""
        try:
            action = _read(text)
        except (ValueError, RecursionError):
            await _tell(window, _text({"said": _FORM, "tone": "bad"}))
            return
        number = action.get("id")
        if number and number in self._known:
            await _tell(window, _text({"done": number}))
            return
        if number:
            self._known.append(number)
        if (older := self._passing.pop(window, None)) is not None:
            older.replaced = True
        request = _Request(window, action)
        if action.get("passing") is True:
            self._passing[window] = request
        self._waiting.put_nowait(request)

    async def conduct(self) -> None:
        """Take the requests in order; those that have more to tell go on when no other waits, the newest first.

        The first asks for the verdict, which so is on its way while a browser starts.
        """
        self._begun.append(_Request(None, {"do": "judge"}))
        while True:
            if not self._begun or not self._waiting.empty():
                request = await self._waiting.get()
                if request.replaced:
                    continue
                self._begun.append(request)
            request = self._begun[-1]
            first = request.steps is None
            try:
                everyone, text = await self._worker.do(partial(self._step, request))
            except Exception as error:
                self._begun.remove(request)
                everyone, text = False, _failure(error)
            for window in self._open.copy() if everyone else filter(None, [request.window]):
                await _tell(window, text)
            if request.window and first and (number := request.action.get("id")):
                await _tell(request.window, _text({"done": number}))

    def _step(self, request: _Request) -> tuple[bool, str]:
        """Compute as far as the next message, which may make earlier verdicts void; no text if there is none."""
        if request.steps is None:
            request.steps = self.board.act(request.action)
        everyone, message = next(request.steps, (False, None))
        if message is None:
            self._begun.remove(request)
            return False, ""
        if message.get("stale") is True and not request.verdict:
            void = [older for older in self._begun if older.verdict]
            self._begun = [kept for kept in self._begun if not kept.verdict]
            request.verdict = True
            for older in void:
                assert older.steps is not None
                older.steps.close()
        return everyone, _text(message)

    async def watch(self) -> None:
        """Tell every window what others have changed."""
        failed = ""
        while True:
            await asyncio.sleep(_WATCH)
            text = ""
            try:
                message, failed = await self._worker.do(self.board.changed_outside), ""
                text = _text(message) if message else ""
            except Exception as error:
                if failed != repr(error):  # not twice a second
                    text, failed = _failure(error), repr(error)
            for window in self._open.copy():
                await _tell(window, text)

    def close(self) -> None:
        self._worker.end()
        self.board.close()


async def _tell(window: WebSocket, text: str) -> None:
    if text:
        with suppress(WebSocketDisconnect, RuntimeError):  # it was closed
            await window.send_text(text)


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


def _failure(error: Exception) -> str:
    """Word an error for a window; what nobody meant to raise is printed."""
    expected = isinstance(error, WireRopeError | ValueError)
    if not expected:
        traceback.print_exception(error)
    return _text({"said": str(error) if expected else _BUG, "tone": "bad"})
