"""The progress bar of a long run."""

import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

Update = Callable[[float, float], None]
# time [s] and fraction between two lines where no bar can move, and before the first: at most a hundred of the longest run
PATIENCE, PACE = 60.0, 0.01


@contextmanager
def share_bar(
    word: str, unit: str, *, enabled: bool, begun: float = 0.0, total: int | None = None, parts: str = ""
) -> Iterator[Update]:
    """Show a value with its unit, the completed fraction and the remaining time on standard error while the block runs.

    Where standard error is no terminal, as in a batch job, it is a line now and then instead of a bar. `begun` is the fraction
    that was done before; `total` the number of `parts` of which what is done is counted. Yields what to call with fraction and
    value.
    """
    if not enabled:
        yield lambda fraction, value: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    def text(fraction: float, value: float) -> str:
        count = f"{math.floor(fraction * total + 1e-6)} of {total} {parts}, " if total else ""  # but for rounding
        return f"{count}{value:.4g} {unit},"

    console, began = Console(stderr=True), perf_counter()
    if not (console.is_terminal or console.is_jupyter):
        last, shown = began, begun

        def print_line(fraction: float, value: float) -> None:
            nonlocal last, shown
            now = perf_counter()
            if now - last >= PATIENCE and fraction - shown >= PACE:
                last, shown = now, fraction
                seconds = time_left(fraction, now - began, begun=begun)
                print(f"{word}: {text(fraction, value)} {seconds} left", file=sys.stderr, flush=True)

        yield print_line
        return
    columns = (
        TextColumn(word), BarColumn(), TextColumn("{task.fields[now]}"), TimeElapsedColumn(),
        TextColumn("elapsed, {task.fields[left]} left"),
    )  # fmt: skip
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=1.0, now=text(begun, 0.0), left="-:--:--")
        progress.update(task, completed=begun)

        def update(fraction: float, value: float) -> None:
            seconds = time_left(fraction, perf_counter() - began, begun=begun)
            progress.update(task, completed=fraction, now=text(fraction, value), left=seconds)

        yield update


def time_left(fraction: float, elapsed: float, *, begun: float = 0.0) -> str:
    """Estimate the remaining time, "0:12:05", from the mean speed so far: `fraction` is done, `begun` was done before."""
    if fraction <= begun:
        return "-:--:--"
    seconds = math.ceil(elapsed * (1.0 - fraction) / (fraction - begun))
    return f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"
