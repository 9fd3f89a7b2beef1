"""The progress bar of a long run."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from wirerope_mj.simulation.grid import Grid


@contextmanager
def progress_bar(grid: Grid, *, enabled: bool) -> Iterator[Callable[[float], None] | None]:
    """Show simulated time, rate and time left on standard error while the block runs.

    Yields:
        What to call with the simulated time [s], or None if no bar is shown.
    """
    if not enabled or not grid.stop.size:
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    start, stop = float(grid.start[0]), float(grid.stop[-1])
    columns = (
        TextColumn("simulating"),
        BarColumn(),
        TextColumn("{task.fields[now]:.3g} of " + f"{stop:.4g} s"),
        TimeElapsedColumn(),
        TextColumn("elapsed,"),
        TimeRemainingColumn(),
        TextColumn("left"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=stop - start, now=start)
        yield lambda now: progress.update(task, completed=now - start, now=now)
