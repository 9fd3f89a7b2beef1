"""Graphs over time: series thinned to what is drawn, a marked peak of each, and rated travels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from wirerope_mj.content.selection import NAMED
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.colours import DARK
from wirerope_mj.views.recording.frame import Color
from wirerope_mj.views.recording.paths import at, child
from wirerope_mj.views.thin import envelope, is_dense, rows_of_line

_PEAK = (255, 255, 255)

_OTHERS = (104, 110, 118)
"""Darker than a text must be, so that what is named stands in front."""


@dataclass(frozen=True, kw_only=True)
class Marker:
    """A peak that is marked in a graph: instant [s], value in the graph's unit, and text."""

    time: float
    value: float
    text: str


@dataclass(frozen=True, kw_only=True)
class Lines:
    """Series (n_t, k) of one entity, thinned to what is drawn, and the peak of them.

    `below` is the entity's path below the graph.
    """

    time: Array
    values: Array
    names: Sequence[str]
    colors: Sequence[Color]
    below: tuple[str, ...] = ()
    width: float = 1.6
    marker: Marker | None = None
    marker_color: Color = _PEAK


@dataclass(frozen=True, kw_only=True)
class Limit:
    """A level that should not be exceeded, in the graph's unit; `below` is its entity's path below the graph."""

    below: tuple[str, ...]
    name: str
    value: float
    unit: str


@dataclass(frozen=True, kw_only=True)
class Graph:
    """A plot over time."""

    path: str
    title: str
    lines: Sequence[Lines]
    limits: Sequence[Limit] = ()

    def emptiest_corner(self, window: tuple[float, float]) -> str:
        """Return the corner in which a legend would hide the least that happens, as rerun calls it."""
        low = min([float(lines.values.min()) for lines in self.lines] + [limit.value for limit in self.limits])
        high = max([float(lines.values.max()) for lines in self.lines] + [limit.value for limit in self.limits])
        across, upward = np.linspace(*window, _COLUMNS), max(high - low, 1e-12)
        hidden = {}
        for corner, (right, top) in _CORNERS.items():
            instants = across[-_COLUMNS // 3 :] if right else across[: _COLUMNS // 3]
            hidden[corner] = 0.0
            for lines in self.lines:
                for column in lines.values.T:
                    values = np.interp(instants, lines.time, column)
                    covered = (values - low) / upward > 0.3 if top else (values - low) / upward < 0.7
                    hidden[corner] += float(np.abs(values - np.median(column))[covered].sum())
        return min(hidden, key=lambda corner: hidden[corner])


_COLUMNS = 90
_CORNERS = {
    "RightTop": (True, True),
    "RightBottom": (True, False),
    "LeftTop": (False, True),
    "LeftBottom": (False, False),
}

Graphs = dict[tuple[str, ...], Graph]
"""Graphs by what stands behind /histories in their paths."""


def thinned(time: Array, values: Array, tolerance: float, **look: Any) -> Lines:
    """Return series (n_t, k) or one (n_t,) as lines that stay within `tolerance` of every value."""
    columns = values.reshape(time.size, -1)
    rows = rows_of_line(time, columns, tolerance)
    return Lines(time=time[rows], values=np.ascontiguousarray(columns[rows]), **look)


def drawn(time: Array, values: Array, tolerance: float, **look: Any) -> list[Lines]:
    """Return series (n_t, k) or one (n_t,) as `thinned` does; what oscillates too often for a line as its envelope."""
    columns = values.reshape(time.size, -1)
    if not is_dense(time, columns, tolerance):
        return [thinned(time, columns, tolerance, **look)]
    at, low, high = envelope(time, columns)
    marker = look.pop("marker", None)
    below = look.pop("below", ())
    if (low >= 0.0).all():  # of sizes only the largest are of interest
        return [Lines(time=at, values=high, marker=marker, below=below, **look)]
    return [
        Lines(time=at, values=low, below=(*below, "lowest"), **look),
        Lines(time=at, values=high, marker=marker, below=(*below, "highest"), **look),
    ]


def named_lines(
    time: Array, values: Array, labels: Sequence[str], colors: Sequence[Color], tolerance: float, marker: Marker | None
) -> list[Lines]:
    """Return series (n_t, k), the most important first: some with their colours and labels before the grey others.

    The others have one name, and so one entry in the legend.
    """
    if marker is not None:
        labels = [marker.text, *labels[1:]]  # of the first line: one entry in the legend for both
    named = drawn(
        time, values[:, :NAMED], tolerance, below=("2",), names=labels[:NAMED], colors=colors[:NAMED], marker=marker
    )
    left = values.shape[1] - NAMED
    if left <= 0:
        return named
    look = {"names": [f"{left} other{'s' if left > 1 else ''}"] * left, "colors": [_OTHERS] * left, "width": 1.0}
    return [*drawn(time, values[:, NAMED:], 3.0 * tolerance, below=("1",), **look), *named]  # none is looked at closely


def log_graphs(rec: Any, graphs: Graphs, ends: tuple[float, float]) -> None:
    """Log lines, peaks and limits of all graphs, these between the instants `ends` [s]."""
    import rerun as rr

    for graph in graphs.values():
        for lines in graph.lines:
            _log_lines(rec, child(graph.path, *lines.below), lines)
        for limit in graph.limits:
            path, name = child(graph.path, *limit.below), f"{limit.name} {limit.value:.4g} {limit.unit}"
            rec.log(path, rr.SeriesLines(names=name, colors=DARK.limit, widths=1.0), static=True)
            rec.send_columns(path, at(ends), rr.Scalars.columns(scalars=np.full(2, limit.value)))


def _log_lines(rec: Any, path: str, lines: Lines) -> None:
    import rerun as rr

    # The viewer averages what falls into one pixel unless it is told to keep the extremes: a sweep would vanish.
    many = len(lines.names)
    look = rr.SeriesLines(
        names=lines.names, colors=lines.colors, widths=[lines.width] * many, aggregation_policy=["MinMax"] * many
    )
    rec.log(path, look, static=True)
    rec.send_columns(path, at(lines.time), rr.Scalars.columns(scalars=lines.values))
    if lines.marker is not None:
        spot = rr.SeriesPoints(names=lines.marker.text, markers="Diamond", marker_sizes=7.0, colors=lines.marker_color)
        rec.log(child(path, "peak"), spot, static=True)
        rec.send_columns(child(path, "peak"), at(lines.marker.time), rr.Scalars.columns(scalars=[lines.marker.value]))
