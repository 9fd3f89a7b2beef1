"""What a long computation will take, said once that is measured, and the bar of its progress."""

import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from time import perf_counter, process_time
from typing import Protocol

from wirerope_mj.foundation.budget import bytes_text, memory_taken
from wirerope_mj.foundation.units import rough_duration_text


class Update(Protocol):
    """Takes the completed fraction, a value to show, and what takes time after the block [s]."""

    def __call__(self, fraction: float, value: float, after: float = 0.0) -> None: ...


# time [s] and fraction between two lines where no bar can move, and before the first: at most a hundred of the longest run
PATIENCE, PACE = 60.0, 0.01
SETTLED = 1.0  # time [s] over which the speed of the work tells how long all of it takes
SMALL = 0.1  # fraction of the work below which its first part does not tell the speed, but imports and starts of processes
SAID = 10.0  # time of computing [s] from which on an estimate is said


def print_line(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


class Estimate:
    """Time, memory and disk that a task takes, said once if it is long: "study: about 40 s, 1.2 GB of memory, 300 MB of disk".

    The speed is measured from the end of the first part that is done, if that is small. Within a block of `work_after`,
    the task lasts from the begin of that block to the end of the work after it.
    """

    def __init__(
        self, word: str, *, memory: float = 0.0, disk: float = 0.0, begun: float = 0.0, after: float = 0.0
    ) -> None:  # fmt: skip
        self.word, self.begun, self.said = word, begun, False
        self.after, self.processor, self.whole = after, process_time(), _whole.get()
        self.memory, self.disk = memory, disk  # beside what this process has, and of the files that come of the work [B]
        self.first: tuple[float, float] | None = None  # instant [s] and fraction from which on the speed is measured
        self.began = perf_counter()

    def update(self, fraction: float, say: Callable[[str], None] = print_line, *, after: float = 0.0) -> None:
        """Take the completed fraction; say the estimate, `after` [s] included, once the speed is known, if it is long."""
        now = perf_counter()
        if self.said or not self.begun < fraction < 1.0:
            return
        if self.first is None:
            small = fraction - self.begun < SMALL * (1.0 - self.begun)
            self.first = (now, fraction) if small else (self.began, self.begun)
        elapsed, done = now - self.first[0], fraction - self.first[1]
        if elapsed >= SETTLED and done > 0.0:
            self.say((self.whole or self).seconds(elapsed * (1.0 - fraction) / done + after), say)
            if self.whole and self.said:
                self.whole.said = True

    def seconds(self, left: float = 0.0) -> float:
        """Estimate the whole time [s]: passed, `left`, and that of the work after it, slowed down as the work so far was."""
        passed, processor = perf_counter() - self.began, process_time() - self.processor
        return passed + left + self.after * max(passed / processor if processor > 0.0 else 1.0, 1.0)

    def say(self, seconds: float, say: Callable[[str], None] = print_line) -> None:
        """Say that the task takes `seconds`, with its memory and disk, if that is long."""
        self.said = seconds >= SAID
        if self.said:
            memory = memory_taken() + self.memory + (self.whole.memory if self.whole else 0.0)
            sizes = {"memory": memory, "disk": self.disk}
            amounts = [f"{bytes_text(size)} of {name}" for name, size in sizes.items() if size]
            say(", ".join([f"{(self.whole or self).word}: about {rough_duration_text(seconds)}", *amounts]))


_whole: ContextVar[Estimate | None] = ContextVar("_whole", default=None)


@contextmanager
def work_after(word: str, seconds: float, *, memory: float, enabled: bool) -> Iterator[None]:
    """Let estimates of progress bars in the block include the work after it: `seconds` of processor time and `memory` [B].

    Where no bar of the block took long enough for an estimate, it is said at the end of the block.
    """
    if not enabled:
        yield
        return
    whole = Estimate(word, after=seconds, memory=memory)
    token = _whole.set(whole)
    try:
        yield
    finally:
        _whole.reset(token)
    if not whole.said:
        whole.say(whole.seconds())


@contextmanager
def share_bar(
    word: str, unit: str, *, enabled: bool, begun: float = 0.0, total: int | None = None, parts: str = "",
    memory: float = 0.0, disk: float = 0.0,
) -> Iterator[Update]:  # fmt: skip
    """Show a progress bar while the block runs, an estimate of its whole time, and a value with its unit.

    All on standard error: an `Estimate`, and a bar, or where standard error is no terminal, as in a batch job, a line now and
    then. `begun` is the fraction that was done before; `total` the number of `parts`, of which those done are counted; `memory`
    and `disk` are those of the estimate. Yields the function to call.
    """
    if not enabled:
        yield lambda fraction, value, after=0.0: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    def text(fraction: float, value: float) -> str:
        count = f"{math.floor(fraction * total + 1e-6)} of {total} {parts}, " if total else ""  # but for rounding
        return f"{count}{value:.4g} {unit},"

    console, began = Console(stderr=True), perf_counter()
    estimate = Estimate(word, memory=memory, disk=disk, begun=begun)
    if not (console.is_terminal or console.is_jupyter):
        last, shown = began, begun

        def update_lines(fraction: float, value: float, after: float = 0.0) -> None:
            nonlocal last, shown
            estimate.update(fraction, after=after)
            now = perf_counter()
            if now - last >= PATIENCE and fraction - shown >= PACE:
                last, shown = now, fraction
                print_line(f"{word}: {text(fraction, value)} {time_left(fraction, now - began, begun=begun)} left")

        yield update_lines
        return
    columns = (
        TextColumn(word), BarColumn(), TextColumn("{task.fields[now]}"), TimeElapsedColumn(),
        TextColumn("elapsed, {task.fields[left]} left"),
    )  # fmt: skip
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=1.0, now=text(begun, 0.0), left="-:--:--")
        progress.update(task, completed=begun)

        def update(fraction: float, value: float, after: float = 0.0) -> None:
            estimate.update(fraction, lambda line: console.print(line, highlight=False, soft_wrap=True), after=after)
            seconds = time_left(fraction, perf_counter() - began, begun=begun)
            progress.update(task, completed=fraction, now=text(fraction, value), left=seconds)

        yield update


def time_left(fraction: float, elapsed: float, *, begun: float = 0.0) -> str:
    """Estimate the remaining time, "0:12:05", from the mean speed so far: `fraction` is done, `begun` was done before."""
    if fraction <= begun:
        return "-:--:--"
    seconds = math.ceil(elapsed * (1.0 - fraction) / (fraction - begun))
    return f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"
