"""The windows of a board, and the order in which what they ask for is done."""

import asyncio
import json
import math
import traceback
from collections import deque
from collections.abc import Generator, Sequence
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from time import monotonic
from typing import Any, Protocol

from starlette.websockets import WebSocket, WebSocketDisconnect

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import WireRopeError

_WATCH = 0.5  # time between two looks at what others have changed [s]
_KNOWN = 8000  # actions that are known when they come again, after a connection was lost
_END = 0.3  # time that a computation has to end with the server [s]
_BUG = "Internal error: the terminal of `wirerope board` says more. The board goes on."
_FORM = "a message is a table in JSON with `do`, the name of an action, and finite numbers."
Steps = Generator[tuple[bool, Entries | Future[Any]], None, None]
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
        former position is void. All others go on once nothing else waits; one that yields a future in place of a message goes
        on once that is done, since another process computes then. An action that says `"passing": true` is left out if its
        window asks for something else before its turn, as for the next position of what is dragged. `"open"` may be
        /files/NAME or /viewer?recording=NAME, with NAME quoted, and behind it # and the instant [s] of a recording.
        WireRopeError or ValueError, whose text is shown in the window that asked, if the action cannot be taken.
        """

    def changed_outside(self) -> Entries | None:
        """Return a message for every window if others have changed files."""

    def file(self, name: str) -> Path | None:
        """Find a report or a recording by its name; None if there is none."""

    def close(self) -> None:
        """Release what the board holds."""


@dataclass(eq=False)
class _Request:
    """An action that a window asked for."""

    window: WebSocket | None  # None: the board itself
    action: Entries
    steps: Steps | None = None  # what it yields, once it has begun
    verdict: bool = False  # that a later one makes void
    replaced: bool = False  # by what its window asked for later


class Windows:
    """All windows of a board: each is sent what changes, and the actions that they ask for are taken in one thread, in order.

    An action that has more messages to yield goes on when no other waits, the newest first. The first action is to judge, so
    that the verdict is computed while a browser starts. The process may end while this thread runs.
    """

    def __init__(self, board: Served) -> None:
        self.board = board
        self._open: list[WebSocket] = []
        self._asked = SimpleQueue[_Request | None]()  # None: the end
        self._begun = [_Request(None, {"do": "judge"})]  # that have more to tell, the newest last
        self._known = deque[str](maxlen=_KNOWN)  # ids of actions
        self._thread = Thread(target=self._conduct, daemon=True)
        self._thread.start()

    async def attend(self, window: WebSocket) -> None:
        """Show the board in a window until it is closed."""
        await window.accept()
        self._loop = asyncio.get_running_loop()
        last = _Request(window, {}, self._opening(window))
        self._asked.put(last)
        try:
            while (message := await window.receive())["type"] != "websocket.disconnect":
                action, answer = self._action(message.get("text"))
                if action is not None:
                    last.replaced = last.action.get("passing") is True
                    last = _Request(window, action)
                    self._asked.put(last)
                elif answer:
                    with suppress(WebSocketDisconnect, RuntimeError):  # it was closed
                        await window.send_text(_text(answer))
        finally:
            self._forget(window)

    def _opening(self, window: WebSocket) -> Steps:
        self._open.append(window)  # from here on it is told what changes in what it is shown first
        yield False, self.board.open()

    def _forget(self, window: WebSocket) -> None:
        with suppress(ValueError):
            self._open.remove(window)

    def _action(self, text: str | None) -> tuple[Entries | None, Entries]:
        """Read an action from a message; None, with the answer, if it is none, or came before and is sent again."""
        try:
            action = _read(text)
        except (ValueError, RecursionError):
            return None, {"said": _FORM, "tone": "bad"}
        if (number := action.get("id")) and number in self._known:
            return None, {"done": number}
        if number:
            self._known.append(number)
        return action, {}

    def _conduct(self) -> None:
        """Take the requests in order until `close`, and look every half second whether other programs changed the files."""
        look, failed = monotonic() + _WATCH, ""
        while True:
            with suppress(Empty):
                request = self._asked.get(not self._begun, max(look - monotonic(), 0.0))
                if request is None:
                    return
                if not request.replaced:
                    self._begun.append(request)
            if monotonic() >= look:
                text, before, failed = "", failed, ""
                try:
                    text = _text(message) if (message := self.board.changed_outside()) else ""
                except Exception as error:
                    failed = repr(error)
                    text = _failure(error) if failed != before else ""  # not twice a second
                self._tell(self._open.copy(), text)
                look = monotonic() + _WATCH
            if self._begun:
                self._go_on(self._begun[-1])

    def _go_on(self, request: _Request) -> None:
        """Continue an action up to its next message and send that; a "stale" one ends actions that judge earlier positions."""
        everyone, text, number = False, "", request.action.get("id") if request.steps is None else None
        try:
            request.steps = request.steps or self.board.act(request.action)
            everyone, message = next(request.steps, (False, None))
            if message is None or isinstance(message, Future):
                self._begun.remove(request)
            if isinstance(message, Future):
                message.add_done_callback(lambda _: self._asked.put(request))
            elif message is not None and message.get("stale") is True and not request.verdict:
                void = [older for older in self._begun if older.verdict]
                self._begun = [kept for kept in self._begun if not kept.verdict]
                request.verdict = True
                for older in void:
                    assert older.steps is not None
                    older.steps.close()
            text = _text(message) if isinstance(message, dict) else ""
        except Exception as error:
            self._begun.remove(request)
            everyone, text = False, _failure(error)
        self._tell(self._open.copy() if everyone else [request.window], text)
        if number:
            self._tell([request.window], _text({"done": number}))

    def _tell(self, windows: Sequence[WebSocket | None], text: str) -> None:
        for window in windows if text else ():
            if window in self._open:
                try:
                    asyncio.run_coroutine_threadsafe(window.send_text(text), self._loop).result()
                except (WebSocketDisconnect, RuntimeError, CancelledError):  # it was closed
                    self._forget(window)

    def close(self) -> None:
        self._asked.put(None)
        self._thread.join(_END)
        self.board.close()


def _read(text: str | None) -> Entries:
    """Read an action; ValueError or RecursionError if the text is none, or has letters that no file can hold."""
    action = json.loads(text or "", parse_constant=_finite, parse_float=_finite)
    json.dumps(action, ensure_ascii=False).encode()
    if not isinstance(action, dict) or not isinstance(action.get("do"), str) or not isinstance(action.get("id", ""), str):
        raise ValueError(_FORM)
    return action


def _finite(text: str) -> float:
    """Read a number of a message; ValueError unless it is finite."""
    if not math.isfinite(value := float(text)):
        raise ValueError(_FORM)
    return value


def _text(message: Entries) -> str:
    try:
        return json.dumps(message, allow_nan=False)
    except ValueError as error:  # a fault of the board, not of what was asked for
        raise TypeError(f"this message cannot be written: {message}") from error


def _failure(error: Exception) -> str:
    """Write an error as a message for a window; an unexpected one is printed on the terminal with its traceback."""
    expected = isinstance(error, WireRopeError | ValueError)
    if not expected:
        traceback.print_exception(error)
    return _text({"said": str(error) if expected else _BUG, "tone": "bad"})
