"""Interleaved timing: machines are noisy, so every contender runs once per round and medians are compared."""

import time
from collections.abc import Callable, Mapping

import numpy as np


def interleaved(
    contenders: Mapping[str, Callable[[], object]], *, rounds: int, of: Callable[[list[float]], float] = np.median
) -> dict[str, float]:
    """Return the median wall-clock time [s] of every contender over `rounds` rounds, after one round that is not counted.

    `of` another statistic than the median: the least time is what is left where other work disturbs most rounds.
    """
    times: dict[str, list[float]] = {name: [] for name in contenders}
    for number in range(rounds + 1):
        for name, work in contenders.items():
            begin = time.perf_counter()
            work()
            if number:
                times[name].append(time.perf_counter() - begin)
    return {name: float(of(values)) for name, values in times.items()}
