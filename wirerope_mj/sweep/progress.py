"""The progress bar of a sweep."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

Update = Callable[[float, float], None]


@contextmanager
def frequency_bar(*, enabled: bool) -> Iterator[Update]:
    """Show the frequency, the share that is done and the time left on standard error while the block runs.

    Yields:
        What to call with the share that is done and the frequency [Hz].
    """
    if not enabled:
        yield lambda share, frequency: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (
        TextColumn("sweeping"),
        BarColumn(),
        TextColumn("{task.fields[now]:.4g} Hz,"),
        TimeElapsedColumn(),
        TextColumn("elapsed,"),
        TimeRemainingColumn(),
        TextColumn("left"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=1.0, now=0.0)
        yield lambda share, frequency: progress.update(task, completed=share, now=frequency)
