"""The progress bar of a long run."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from wirerope_mj.simulation.grid import TimeGrid

Update = Callable[[float, float], None]

PERIOD = 600.0
"""Time over which the speed is averaged [s]: a chunk of a study may take minutes."""


@contextmanager
def share_bar(word: str, unit: str, *, enabled: bool) -> Iterator[Update]:
    """Show a value, the share that is done and the time left on standard error while the block runs.

    Args:
        word: what is going on, "simulating".
        unit: of the value that is shown.
        enabled: whether a bar is shown at all.

    Yields:
        What to call with the share that is done and the value.
    """
    if not enabled:
        yield lambda share, value: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (
        TextColumn(word),
        BarColumn(),
        TextColumn("{task.fields[now]:.4g} " + unit + ","),
        TimeElapsedColumn(),
        TextColumn("elapsed,"),
        TimeRemainingColumn(),
        TextColumn("left"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True, speed_estimate_period=PERIOD) as progress:
        task = progress.add_task("", total=1.0, now=0.0)
        yield lambda share, value: progress.update(task, completed=share, now=value)


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
