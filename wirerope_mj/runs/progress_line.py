"""The line that says what is being written."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

_REFRESH = 4.0  # times a second: it shows that work goes on, and costs nothing that can be measured


@contextmanager
def progress_line(*, enabled: bool) -> Iterator[Callable[[str], None]]:
    """Show on standard error what is being written while the block runs, if that is a terminal; nothing of it stays there.

    Yields:
        What to call with the name of what comes next.
    """
    from rich.console import Console  # late: nothing of it is needed where nothing is shown
    from rich.progress import Progress, SpinnerColumn, TextColumn

    console = Console(stderr=True) if enabled else None
    if console is None or not console.is_terminal:
        yield lambda name: None
        return
    columns = SpinnerColumn(), TextColumn("writing {task.description}")
    with Progress(*columns, console=console, transient=True, refresh_per_second=_REFRESH) as progress:
        task = progress.add_task("")
        yield lambda name: progress.update(task, description=name, refresh=True)
