"""What is said while kernels are compiled, because they are not at hand for this machine."""

import multiprocessing
import platform
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import numba
from numba.core import event

from wirerope_mj.foundation.kernel_files import where_kept

PATIENCE, PACE = 2.0, 10.0
"""Time [s] that compiling takes before anything is said, and between two lines."""


class Watch(event.Listener):
    """Prints on standard error that kernels are being compiled, how long that takes, and how far it is."""

    def __init__(self, folder: str):
        """Take the folder where they are kept."""
        self._folder = Path(folder)
        self._depth, self._number = 0, 0
        self._began = self._last = 0.0

    def on_start(self, event: Any) -> None:
        """Note that a kernel, or one that it calls, is begun."""
        if self._depth == 0:
            self._began = perf_counter()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Note that one is done, and say so now and then."""
        self._depth -= 1
        self._number += 1
        now = perf_counter()
        if now - max(self._last + PACE, self._began + PATIENCE) < 0.0 or multiprocessing.parent_process() is not None:
            return
        if self._last == 0.0:
            versions = f"Python {platform.python_version()}, Numba {numba.__version__} and this processor"
            say(
                f"kernels are compiled for {versions}: up to two minutes, once; {where_kept(self._folder)}. "
                "`wirerope compile` compiles all."
            )
        else:
            say(f"{self._number} functions are compiled ...")
        self._last = now


def say(line: str) -> None:
    """Print a line on standard error."""
    print(f"wirerope: {line}", file=sys.stderr, flush=True)
