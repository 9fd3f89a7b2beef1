"""The two ways through a recording of branches: from point to point, and in time through one motion after the other."""

from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.animation import Film, Strip
from wirerope_mj.views.recording.paths import TIMELINE, nanoseconds

POINT, FREQUENCY = "point", "frequency_mHz"
"""Timelines over the branch: the number of the motion, and its frequency, whole millihertz as rerun has no other
numbers for a timeline. Where a branch folds, the point tells its motions apart."""


def at_points(film: Film, strip: Strip) -> list[Any]:
    """Return the index columns of one row for every motion of a strip: they stand beside those of the film."""
    import rerun as rr

    return [
        rr.TimeColumn(POINT, sequence=np.arange(strip.points.size)),
        rr.TimeColumn(FREQUENCY, sequence=_millihertz(strip.frequency)),
        rr.TimeColumn(TIMELINE, duration=nanoseconds(film.starts)),
    ]


class AlongBranch:
    """A recording stream whose rows in time stand on the branch too: at the motion to which their instant belongs."""

    def __init__(self, rec: Any, film: Film) -> None:
        self._rec, self._film = rec, film

    def log(self, *args: Any, **options: Any) -> None:
        """Log as the stream does."""
        self._rec.log(*args, **options)

    def send_columns(self, path: str, index: list[Any], columns: Any) -> None:
        """Send rows whose index is the timeline in time alone."""
        import rerun as rr

        time = index[0].as_arrow_array().cast("int64").to_numpy()
        starts = nanoseconds(self._film.starts).astype(np.int64)
        point = np.clip(np.searchsorted(starts, time, side="right") - 1, 0, None)
        frequency = _millihertz(self._film.strip.frequency[point])
        more = [rr.TimeColumn(POINT, sequence=point), rr.TimeColumn(FREQUENCY, sequence=frequency)]
        self._rec.send_columns(path, [*index, *more], columns)


def _millihertz(frequency: Array) -> Any:
    return np.round(1e3 * frequency).astype(np.int64)
