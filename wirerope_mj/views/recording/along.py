"""Timelines beside that of time: rows in time stand at the motion, of a branch or a mode, to which their instant belongs."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import rerun as rr

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.animation import Animation, Strip
from wirerope_mj.views.recording.paths import TIMELINE, nanoseconds

# Timelines over the branch: the number of the motion, and its frequency in integer millihertz, as rerun has no other numbers
# for a timeline. Where a branch folds, the point tells its motions apart.
POINT, FREQUENCY = "point", "frequency_mHz"


def at_points(animation: Animation, strip: Strip) -> list[Any]:
    """Return the index columns of one row for every motion of a strip: they stand beside those of the animation."""
    columns = [rr.TimeColumn(name, sequence=numbers) for name, numbers in _numbers(strip).items()]
    return [*columns, rr.TimeColumn(TIMELINE, duration=nanoseconds(animation.starts))]


class Along:
    """A recording stream whose rows in time stand on other timelines too.

    `starts` are the instants [s] at which the motions begin, `numbers` their numbers on these timelines.
    """

    def __init__(self, rec: Any, starts: Array, numbers: Mapping[str, Any]) -> None:
        self._rec, self._numbers = rec, numbers
        self._starts = nanoseconds(starts).astype(np.int64)

    def log(self, *args: Any, **options: Any) -> None:
        """Log as the stream does."""
        self._rec.log(*args, **options)

    def send_columns(self, path: str, index: list[Any], columns: Any) -> None:
        """Send rows whose index is the timeline in time alone."""
        time = index[0].as_arrow_array().cast("int64").to_numpy()
        motion = np.clip(np.searchsorted(self._starts, time, side="right") - 1, 0, None)
        more = [rr.TimeColumn(name, sequence=numbers[motion]) for name, numbers in self._numbers.items()]
        self._rec.send_columns(path, [*index, *more], columns)


def along_branch(rec: Any, animation: Animation) -> Along:
    """Return a stream whose rows in time stand on the branch too."""
    return Along(rec, animation.starts, _numbers(animation.strip))


def _numbers(strip: Strip) -> dict[str, Any]:
    return {POINT: np.arange(strip.points.size), FREQUENCY: np.round(1e3 * strip.frequency).astype(np.int64)}
