"""The progress bar of a long run."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from wirerope_mj.simulation.grid import TimeGrid

Update = Callable[[float, float], None]


@contextmanager
def share_bar(word: str, unit: str, *, enabled: bool, begun: float = 0.0) -> Iterator[Update]:
    """Show a value, the share that is done and the time left on standard error while the block runs.

    Args:
        word: what is going on, "simulating".
        unit: of the value that is shown.
        enabled: whether a bar is shown at all.
        begun: share that was done before.

    Yields:
        What to call with the share that is done and the value.
    """
    if not enabled:
        yield lambda share, value: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn(word),
        BarColumn(),
        TextColumn("{task.fields[now]:.4g} " + unit + ","),
        TimeElapsedColumn(),
        TextColumn("elapsed, {task.fields[left]} left"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=1.0, now=0.0, left="-:--:--")
        progress.update(task, completed=begun)
        began = perf_counter()

        def update(share: float, value: float) -> None:
            left = time_left(share, perf_counter() - began, begun=begun)
            progress.update(task, completed=share, now=value, left=left)

        yield update


def time_left(share: float, elapsed: float, *, begun: float = 0.0) -> str:
    """Return how long it takes to the end at the mean speed since the beginning, "0:12:05".

    Args:
        share: that is done.
        elapsed: time since the beginning [s].
        begun: share that was done at the beginning.
    """
    if share <= begun:
        return "-:--:--"
    seconds = math.ceil(elapsed * (1.0 - share) / (share - begun))
    return f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"


@contextmanager
def progress_bar(grid: TimeGrid, *, enabled: bool) -> Iterator[Callable[[float], None] | None]:
    """Show simulated time, rate and time left on standard error while the block runs.

    Yields:
        What to call with the simulated time [s], or None if no bar is shown.
    """
    if not enabled:
        yield None
        return
    start, stop = grid.start, grid.stop
    with share_bar("simulating", f"of {stop:.4g} s", enabled=True) as update:
        yield lambda now: update((now - start) / (stop - start), now)
