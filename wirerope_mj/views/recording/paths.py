"""Entity paths and texts in letters that the viewer has, recording streams, and instants in the timeline's nanoseconds."""

import re
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import rerun as rr

from wirerope_mj.foundation.arrays import ArrayLike
from wirerope_mj.mounts.isolator import AXES as AXES
from wirerope_mj.views.thin import Rows as Rows

APPLICATION = "wirerope_mj"
TIMELINE = "sim_time"
POINT = "point"  # timeline over the motions of a branch
# properties of a recording, and among them the most critical instant [s] or motion of a branch, at which it opens
PROPERTIES, WORST_INSTANT, WORST_POINT, UTILISATION = "run", "worst_s", "worst_point", "utilisation_percent"
EVENT = "event"  # timeline of a few instants: the viewer's key for the next event jumps along it
AXIAL = AXES.index("axial")


def entity(*parts: str) -> str:
    return str(rr.new_entity_path([known_letters(part) for part in parts]))


def root_of(run: str) -> str:
    """Make the path of the entity that holds one of several runs; "" for a run alone."""
    return entity("runs", run) if run else ""


def child(parent: str, *parts: str) -> str:
    """Make the path of an entity below `parent`, `parent` itself without parts."""
    return parent + entity(*parts) if parts else parent


Columns = Iterable[rr.ComponentColumn]


class Stream:
    """A recording stream that passes everything on to another stream; subclasses change it on the way."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        self._rec = rec

    def log(self, path: str, *parts: rr.AsComponents, static: bool = False) -> None:
        """Log parts of an entity, at no instant if they are `static`."""
        self._rec.log(path, *parts, static=static)

    def send_columns(self, path: str, index: list[rr.TimeColumn], columns: Columns) -> None:
        self._rec.send_columns(path, index, columns)


class Below(Stream):
    """A recording stream that puts every entity below `root`, so that one file holds several responses."""

    def __init__(self, rec: Stream, root: str) -> None:
        super().__init__(rec)
        self._root = root

    def log(self, path: str, *parts: rr.AsComponents, static: bool = False) -> None:
        self._rec.log(self._root + path, *parts, static=static)

    def send_columns(self, path: str, index: list[rr.TimeColumn], columns: Columns) -> None:
        self._rec.send_columns(self._root + path, index, columns)


class AtEvents(Stream):
    """A recording stream that also puts the values at a few instants on a timeline of their own."""

    def __init__(self, rec: Stream, instants: ArrayLike) -> None:
        super().__init__(rec)
        self._instants = nanoseconds(instants)

    def send_columns(self, path: str, index: list[rr.TimeColumn], columns: Columns) -> None:
        self._rec.send_columns(path, index, columns)
        times = index[0].as_arrow_array().cast("int64").to_numpy().view("timedelta64[ns]")
        rows = np.searchsorted(times, self._instants, side="right") - 1
        known = rows >= 0
        if known.any():
            event = [rr.TimeColumn(EVENT, duration=self._instants[known])]
            self._rec.send_columns(path, event, [_Changed(column, lambda array: array.take(rows[known])) for column in columns])


class _Changed:
    """A component's batch or column with another array, as the stream takes it."""

    def __init__(self, column: rr.ComponentColumn, change: Callable[[pa.Array], pa.Array]) -> None:
        self._column, self._change = column, change

    def component_descriptor(self) -> rr.ComponentDescriptor:
        return self._column.component_descriptor()

    def as_arrow_array(self) -> pa.Array:
        return self._change(self._column.as_arrow_array())


def nanoseconds(time: ArrayLike) -> npt.NDArray[np.timedelta64]:
    """Convert instants [s] to nanoseconds of the timeline, rounded, because rerun itself truncates floats."""
    return np.round(np.atleast_1d(np.asarray(time, dtype=np.float64)) * 1e9).astype(np.int64).astype("timedelta64[ns]")


def at(time: ArrayLike) -> list[rr.TimeColumn]:
    """Make the timeline's index of rows at the instants `time` [s]."""
    return [rr.TimeColumn(TIMELINE, duration=nanoseconds(time))]


# Letters that one of the two fonts of rerun 0.41 lacks: all but some Latin, Greek, Cyrillic and signs
_UNKNOWN = re.compile(
    "[^\n\u0020-\u007e\u00a0-\u00ac\u00ae-\u0148\u014a-\u017f\u0386\u0388-\u038a\u038c\u038e-\u03a1\u03a3-\u03ce"
    "\u0401-\u040c\u040e-\u044f\u0451-\u045c\u045e\u045f\u2010\u2013\u2014\u2018-\u2022\u2026\u2030\u2032\u2033"
    "\u2070\u2074-\u207a\u2080-\u2089\u20ac\u2116\u2122\u2190-\u2193\u2202\u2206\u2211\u2212\u221a\u221e\u2248\u2260"
    "\u2264\u2265]"
)


def known_letters(text: str) -> str:
    """Replace letters that the viewer lacks by their numbers, as "U+5B89"."""
    return _UNKNOWN.sub(lambda match: f"U+{ord(match[0]):04X}", text)


class KnownLetters(Stream):
    """A recording stream whose texts hold only letters that the viewer has."""

    def __getattr__(self, name: str) -> Any:
        return getattr(self._rec, name)

    def send_recording_name(self, name: str) -> None:
        self._rec.send_recording_name(known_letters(name))

    def log(self, path: str, *parts: rr.AsComponents, static: bool = False) -> None:
        batches = [_Changed(batch, _with_known_letters) for part in parts for batch in part.as_component_batches()]
        self._rec.log(path, batches, static=static)

    def send_columns(self, path: str, index: list[rr.TimeColumn], columns: Columns) -> None:
        self._rec.send_columns(path, index, [_Changed(column, _with_known_letters) for column in columns])


def _with_known_letters(array: pa.Array) -> pa.Array:
    """Replace letters that the viewer lacks in an array of texts, or of lists of texts."""
    if pa.types.is_string(array.type):
        texts = array.to_pylist()
        known = [text if text is None else known_letters(text) for text in texts]
        return array if known == texts else pa.array(known, type=array.type)
    if pa.types.is_list(array.type) and pa.types.is_string(array.type.value_type):
        return pa.ListArray.from_arrays(array.offsets, _with_known_letters(array.values), type=array.type)
    return array
