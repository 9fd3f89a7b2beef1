"""Selection of rows to draw: a picture needs fewer samples than the archive, and /state keeps them all."""

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arrays import Array

Rows = npt.NDArray[np.intp]
# rows of a drawn series: a plot is a few thousand pixels wide, and the viewer slows down above this
MOST_ROWS = 20_000
_LONGEST = 128  # longest interval of rows that is replaced by its ends
# rows that are thinned at once: it bounds the memory, and is a multiple of the longest intervals
_PART = 128 * _LONGEST


DENSE = 4000  # rows of a line above which its envelope is drawn instead
_INTERVALS = 400  # Of an envelope, each a few points of a plot wide


def is_dense(time: Array, values: Array, tolerance: Array | float) -> bool:
    """Tell whether series (n_t, k) oscillate too often to be drawn as lines within a tolerance, with `DENSE` rows at most."""
    return time.size > DENSE and rows_of_line(time, values, tolerance, limit=time.size).size > DENSE


def rows_of_line(time: Array, values: Array, tolerance: Array | float, *, limit: int = MOST_ROWS) -> Rows:
    """Find the rows of a polyline that stays within `tolerance`, (k,) or one for all, of every value, (n_t, k).

    Where more than `limit` rows are needed, the extremes of every interval are kept, and the tolerance is not.
    """
    rows = _needed_rows(time, values, tolerance, hold=False)
    return rows[rows_of_extremes(values[rows], limit)]


def rows_of_steps(time: Array, values: Array, tolerance: Array | float, *, limit: int = MOST_ROWS) -> Rows:
    """Find the rows of a staircase (each value holds until the next row) within `tolerance`."""
    rows = _needed_rows(time, values, tolerance, hold=True)
    return rows[rows_of_extremes(values[rows], limit)]


def rows_of_extremes(values: Array, limit: int) -> Rows:
    """Keep about `limit` rows: first, last, lowest and highest of each series in each interval."""
    n, k = values.shape
    if n <= limit:
        return np.arange(n)
    intervals = max(1, limit // (2 * k))
    starts = np.linspace(0, n, intervals + 1).astype(np.intp)
    rows = [np.array([0, n - 1])]
    for start, stop in zip(starts[:-1], starts[1:], strict=True):
        part = values[start:stop]
        rows += [start + part.argmin(axis=0), start + part.argmax(axis=0)]
    return np.unique(np.concatenate(rows))


def _needed_rows(time: Array, values: Array, tolerance: Array | float, *, hold: bool) -> Rows:
    """Find the rows that remain when intervals of 2, 4, 8... rows are replaced by their ends within the tolerance."""
    keep = np.ones(time.size, dtype=bool)
    for begin in range(0, time.size, _PART):
        part = slice(begin, begin + _PART + 1)  # with the first row of the next part, where the last interval ends
        kept, instants, drawn = keep[part], time[part], values[part]
        size = 2
        while size <= _LONGEST and size < instants.size:
            first = np.arange((instants.size - 1) // size) * size
            inner = first[:, None] + np.arange(1, size)
            line = drawn[first][:, None]
            if not hold:
                ends = drawn[first + size][:, None] - line
                ratio = (instants[inner] - instants[first][:, None]) / (instants[first + size] - instants[first])[:, None]
                line = line + ratio[..., None] * ends
            enough = (np.abs(drawn[inner] - line) <= tolerance).all(axis=(1, 2))
            kept[inner[enough]] = False
            size *= 2
    return np.flatnonzero(keep)


def envelope(time: Array, values: Array) -> tuple[Array, Array, Array]:
    """Find instants (m,), and lowest and highest of series (n_t, k) about each of them, (m, k).

    Each is taken over three of the intervals, so that it holds a period of what oscillates three times slower, too.
    """
    size = -(-time.size // _INTERVALS)
    starts = np.arange(0, time.size, size)
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    wide = [np.concatenate([part[:1], part, part[-1:]]) for part in (low, high)]
    low, high = (
        np.asarray(extreme([part[:-2], part[1:-1], part[2:]], axis=0))
        for extreme, part in zip((np.min, np.max), wide, strict=True)
    )
    middles = np.minimum(starts + size // 2, time.size - 1)
    return time[middles], low, high
