"""Other processes that this one starts: their number, their modules, and processes that compile or write files."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NoReturn

from wirerope_mj.foundation.interrupts import at_end, interrupts_held

# What the process beside a command runs, and whether this one may start it: commands may; a library starts none unasked.
BESIDE = [sys.executable, "-m", "wirerope_mj.runs.kernels"]
_allowed = False


def processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def environment_of_children() -> dict[str, str]:
    """Return the environment of child processes, in which they find this process's modules and no others.

    Python would look in the current folder first for what it runs with -m, which may be anybody's.
    """
    paths = [str(Path(__file__).resolve().parents[2]), *map(os.path.abspath, sys.path)]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(dict.fromkeys(paths)), "PYTHONSAFEPATH": "1"}


def allow_one_beside() -> None:
    """Let the first kernel that this process compiles start another process that compiles as well."""
    global _allowed
    _allowed = True


def compile_beside() -> None:
    """Start one process that compiles kernels in another order, if that is allowed and a processor is free.

    Each finds what the other has compiled. It is ended with this process.
    """
    global _allowed
    if _allowed and processors() > 1:
        nothing = subprocess.DEVNULL
        with suppress(OSError):  # without it the command compiles alone
            process = subprocess.Popen(BESIDE, env=environment_of_children(), stdin=nothing, stdout=nothing, stderr=nothing)
            at_end(process.terminate, early=True)
    _allowed = False


@contextmanager
def run_beside(work: Callable[[], object]) -> Iterator[None]:
    """Run `work`, which writes files, in a copy of this process during the block; after it where copies are impossible.

    Where the copy does not come to its end, `work` runs here again, and raises what is wrong.
    """
    copy, code = 0, 1
    try:
        with interrupts_held(), warnings.catch_warnings(action="ignore", category=DeprecationWarning):  # of libraries' threads
            # Of several threads a copy has one, and waits forever for what the others hold; macOS is not made for it.
            if sys.platform == "linux" and processors() > 1 and threading.active_count() == 1:
                copy = os.fork() or _end_after(work)
                _children.add(copy)
        yield
        if copy:
            os.waitid(os.P_PID, copy, os.WEXITED | os.WNOWAIT)
    finally:
        with interrupts_held():
            if copy:
                os.kill(copy, signal.SIGKILL)
                code = os.waitpid(copy, 0)[1]
                _children.discard(copy)
    if code:
        work()


@contextmanager
def process_beside(command: list[str], **how: Any) -> Iterator["subprocess.Popen[str]"]:
    """Start another process, and end it with the block or with this process."""
    process = None
    try:
        with interrupts_held():
            process = subprocess.Popen(command, text=True, **how)
            _children.add(process.pid)
        yield process
    finally:
        with interrupts_held():
            if process is not None:
                process.kill()
                process.wait()
                _children.discard(process.pid)


_children: set[int] = set()


def _end_children() -> None:
    for child in multiprocessing.active_children():
        child.kill()
    for number in _children:
        with suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)


at_end(_end_children, early=True)


def _end_after(work: Callable[[], object]) -> NoReturn:
    """Run `work` in a copy of this process, and end the copy."""
    code = 1
    try:
        work()
        code = 0
    finally:
        os._exit(code)
