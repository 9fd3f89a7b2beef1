"""Graphs over time: series thinned to what is drawn, a marked peak of each, and rated travels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.frame import Color
from wirerope_mj.views.recording.paths import at, child
from wirerope_mj.views.recording.thin import rows_of_line

_PEAK = (255, 92, 92)
_LIMIT = (230, 70, 70)


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
class Graph:
    """A plot over time; `limits` are rated travels [m] with their entities below the graph and their names."""

    path: str
    title: str
    lines: Sequence[Lines]
    limits: Sequence[tuple[tuple[str, ...], str, float]] = ()


Graphs = dict[tuple[str, ...], Graph]
"""Graphs by what stands behind /histories in their paths."""


def thinned(time: Array, values: Array, tolerance: float, **look: Any) -> Lines:
    """Return series (n_t, k) or one (n_t,) as lines that stay within `tolerance` of every value."""
    columns = values.reshape(time.size, -1)
    rows = rows_of_line(time, columns, tolerance)
    return Lines(time=time[rows], values=np.ascontiguousarray(columns[rows]), **look)


def log_graphs(rec: Any, graphs: Graphs, ends: tuple[float, float]) -> None:
    """Log lines, peaks and rated travels of all graphs, these between the instants `ends` [s]."""
    import rerun as rr

    for graph in graphs.values():
        for lines in graph.lines:
            _log_lines(rec, child(graph.path, *lines.below), lines)
        for below, name, limit in graph.limits:
            path, level = child(graph.path, *below), in_unit(limit, "mm")
            rec.log(path, rr.SeriesLines(names=f"{name} {level:.1f} mm", colors=_LIMIT, widths=1.0), static=True)
            rec.send_columns(path, at(ends), rr.Scalars.columns(scalars=np.full(2, level)))


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
