"""Names of entities and timeline, and the one conversion of instants to the timeline's nanoseconds."""

from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.mounts.isolator import AXES as AXES
from wirerope_mj.views.recording.letters import known_letters
from wirerope_mj.views.thin import Rows as Rows

APPLICATION = "wirerope_mj"
TIMELINE = "sim_time"
EVENT = "event"
"""Timeline of a few instants alone: the viewer's key for the next event jumps from one to the next."""

FILE = "run.rrd"

AXIAL = AXES.index("axial")


def entity(*parts: str) -> str:
    """Return an entity path; a part may hold any character, which the viewer then writes."""
    import rerun as rr

    return str(rr.new_entity_path([known_letters(part) for part in parts]))


def root_of(run: str) -> str:
    """Return the entity below which a run stands where a recording holds several; "" for a run alone, which has no name."""
    return entity("runs", run) if run else ""


def child(parent: str, *parts: str) -> str:
    """Return the path of an entity below `parent`, which is a path already; `parent` itself without parts."""
    return parent + entity(*parts) if parts else parent


class Below:
    """A recording stream that puts every entity below `root`: several responses stand beside each other in one file."""

    def __init__(self, rec: Any, root: str) -> None:
        self._rec, self._root = rec, root

    def log(self, path: str, *args: Any, **options: Any) -> None:
        """Log as the stream does."""
        self._rec.log(self._root + path, *args, **options)

    def send_columns(self, path: str, index: list[Any], columns: Any) -> None:
        """Send rows as the stream does."""
        self._rec.send_columns(self._root + path, index, columns)


class AtEvents:
    """A recording stream that shows everything at a few instants on a timeline of their own, too."""

    def __init__(self, rec: Any, instants: npt.ArrayLike) -> None:
        self._rec, self._instants = rec, nanoseconds(instants)

    def log(self, path: str, *args: Any, **options: Any) -> None:
        """Log as the stream does."""
        self._rec.log(path, *args, **options)

    def send_columns(self, path: str, index: list[Any], columns: Any) -> None:
        """Send rows as the stream does, and those that hold at the instants."""
        import rerun as rr

        self._rec.send_columns(path, index, columns)
        times = index[0].as_arrow_array().cast("int64").to_numpy().view("timedelta64[ns]")
        rows = np.searchsorted(times, self._instants, side="right") - 1
        known = rows >= 0
        if known.any():
            some = [rr.TimeColumn(EVENT, duration=self._instants[known])]
            self._rec.send_columns(path, some, [_Rows(column, rows[known]) for column in columns])


class _Rows:
    """Some rows of a component's column, as `send_columns` takes it."""

    def __init__(self, column: Any, rows: Rows) -> None:
        self._column, self._rows = column, rows

    def component_descriptor(self) -> Any:
        return self._column.component_descriptor()

    def as_arrow_array(self) -> Any:
        return self._column.as_arrow_array().take(self._rows)


def nanoseconds(time: npt.ArrayLike) -> npt.NDArray[np.timedelta64]:
    """Return instants [s] as the timeline counts them: rounded, because rerun itself truncates floats."""
    return np.round(np.atleast_1d(np.asarray(time, dtype=np.float64)) * 1e9).astype(np.int64).astype("timedelta64[ns]")


def at(time: npt.ArrayLike) -> list[Any]:
    """Return the index columns of rows at the instants `time` [s]."""
    import rerun as rr

    return [rr.TimeColumn(TIMELINE, duration=nanoseconds(time))]
