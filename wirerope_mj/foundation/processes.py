"""Other processes that this one starts: how many, which modules they find, and those that compile or write files beside it."""

import atexit
import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

# What the process beside a command runs, and whether this one may start it: commands may; a library starts none unasked.
BESIDE = [sys.executable, "-m", "wirerope_mj.runs.kernels"]
_allowed = False


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def environment_of_children() -> dict[str, str]:
    """Return the environment of processes that compute: they find the modules that this one does, and no others.

    Python would look in the current folder first for what it runs with -m, which may be anybody's.
    """
    paths = [str(Path(__file__).resolve().parents[2]), *map(os.path.abspath, sys.path)]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(dict.fromkeys(paths)), "PYTHONSAFEPATH": "1"}


def allow_one_beside() -> None:
    """Let the first kernel that this process compiles start another process that compiles as well."""
    global _allowed
    _allowed = True


def compile_beside() -> None:
    """Start the process that compiles kernels in another order, once, if that is allowed and there is a processor for it.

    Each finds what the other has compiled. It is ended with this process.
    """
    global _allowed
    if _allowed and processors() > 1:
        nothing = subprocess.DEVNULL
        with suppress(OSError):  # without it the command compiles alone
            process = subprocess.Popen(BESIDE, env=environment_of_children(), stdin=nothing, stdout=nothing, stderr=nothing)
            atexit.register(process.terminate)
    _allowed = False


@contextmanager
def run_beside(work: Callable[[], object]) -> Iterator[None]:
    """Run `work`, which writes files, in a copy of this process while the block runs; after it where there is no copy.

    Where the copy does not come to its end, `work` runs here again, and raises what is wrong.
    """
    copy = _copy_that_runs(work)
    try:
        yield
    except BaseException:
        if copy:
            os.kill(copy, signal.SIGKILL)
            os.waitpid(copy, 0)
        raise
    if not copy or os.waitpid(copy, 0)[1] != 0:
        work()


def _copy_that_runs(work: Callable[[], object]) -> int:
    """Fork a process that runs `work`, and return its number; 0 if there is no second processor, or a copy might not live.

    Of several threads a copy has one, and waits forever for what the others hold; macOS's own libraries are not made for it.
    """
    if sys.platform != "linux" or processors() == 1 or threading.active_count() > 1:
        return 0
    with warnings.catch_warnings(action="ignore", category=DeprecationWarning):  # of threads of libraries
        copy = os.fork()
    if copy:
        return copy
    code = 1
    try:
        work()
        code = 0
    finally:
        os._exit(code)
