"""Interrupts, by Ctrl-C or SIGTERM: postponed for moments, and followed by the end of a command whatever it waits for."""

import _thread
import atexit
import os
import signal
import sys
import time
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import current_thread, main_thread
from types import FrameType
from typing import NoReturn

SIGNALS = (signal.SIGINT, signal.SIGTERM)
INTERRUPTED = 130  # Exit code of a command that Ctrl-C ended
MESSAGE = "interrupted; no half-written result was left behind."
# Time in which an interrupted command ends by itself [s]; then it is ended, since people and batch systems wait no longer.
_PATIENCE = 1.0

_last: list[Callable[[], object]] = []
_arrived: list[int] = []
_remedy: list[Callable[[], str]] = []


def at_end(work: Callable[[], object], *, early: bool = False) -> None:
    """Register work for the end of this process, even if it ends in the middle of a computation."""
    _last.insert(0 if early else len(_last), work)
    atexit.register(work)


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Postpone interrupts until the end of the block, which must be short; only the main thread receives interrupts."""
    handlers, arrived = {}, list[tuple[int, FrameType | None]]()
    try:
        if current_thread() is main_thread():
            for number in SIGNALS:
                if callable(handler := signal.getsignal(number)):
                    handlers[number] = handler
                    signal.signal(number, lambda *signal_arguments: arrived.append(signal_arguments))
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for signal_arguments in arrived[:1]:
            handlers[signal.Signals(signal_arguments[0])](*signal_arguments)


def end_soon_after_interrupts() -> None:
    """Raise KeyboardInterrupt on an interrupt, and end this process if it has not ended by itself in time.

    KeyboardInterrupt may be lost in a library, or meet a thread that waits for what never comes, or a computation of many
    seconds.
    """
    for number in SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:  # as in the background of a script
            signal.signal(number, _interrupt)
    sys.unraisablehook = _unraisable
    if sys.platform == "win32":  # has no such pipes for signals
        return
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    os.register_at_fork(after_in_child=lambda: signal.set_wakeup_fd(-1))
    _thread.start_new_thread(_watch, (reading,))  # not counted among the threads that forbid a copy of this process


def resumed_by(remedy: Callable[[], str]) -> None:
    """Set the function that says, if this process is interrupted, how its work is resumed; "" if there is nothing to say."""
    _remedy[:] = [remedy]


def end_at_once_after_interrupts() -> None:
    """End this process at the next interrupt without a message: it has nothing left to do."""
    for number in SIGNALS:
        if signal.getsignal(number) == _interrupt:
            signal.signal(number, lambda number, _: end(number))


def interrupted_by() -> int:
    """Return the number of the signal that interrupted this process; 0 if none has."""
    return _arrived[0] if _arrived else 0


def end(number: int) -> NoReturn:
    """End this process as if by a signal of that number, after the work registered for its end."""
    for work in (*_last, weakref.finalize._exitfunc):  # type: ignore[attr-defined]  # temporary folders
        with suppress(Exception):
            work()
    with suppress(Exception):
        sys.stdout.flush()
    os._exit(128 + number)


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, and ignore any further interrupt."""
    for each in SIGNALS:  # one is enough: a second would disturb what the first has begun
        signal.signal(each, signal.SIG_IGN)
    _arrived.append(number)
    raise KeyboardInterrupt


def _unraisable(lost: "sys.UnraisableHookArgs") -> None:
    """Print what nothing can catch, but for an interrupt that is lost in a finalizer or a callback: `_watch` ends it."""
    if not (_arrived and isinstance(lost.exc_value, KeyboardInterrupt)):
        sys.__unraisablehook__(lost)


def _watch(reading: int) -> None:
    """Wait in a thread for an interrupt, read from a pipe, and end this process if it still runs `_PATIENCE` [s] later."""
    while (number := os.read(reading, 1)[0]) not in SIGNALS:
        pass
    time.sleep(_PATIENCE)
    with suppress(OSError):
        shown = "\x1b[?25h" if os.isatty(2) else ""  # a bar of progress hides the cursor
        said = [MESSAGE, *(text for remedy in _remedy if (text := remedy()))]
        os.write(2, (shown + "".join(f"wirerope: {text}\n" for text in said)).encode())
    end(number)
