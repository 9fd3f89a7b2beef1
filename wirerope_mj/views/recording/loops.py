"""Force-deflection loops: a frame with ticks, the whole loop dimly, the trail up to the time cursor, and the cursor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import rerun as rr

from wirerope_mj.content.selection import Selection, travel_limits
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.histories import MountResponse
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.colours import CURSOR, DARK, Color, colour_of
from wirerope_mj.views.recording.drawn_runs import DrawnRun
from wirerope_mj.views.recording.paths import AXES, Rows, Stream, at, child, entity
from wirerope_mj.views.recording.views import HEIGHT, LARGE, Plot, log_frame
from wirerope_mj.views.thin import rows_of_line, rows_of_steps

# rows of a trail at once: the viewer draws a segment for each in every frame
MOST_TRAIL_ROWS = 1000
# segments of a long run that are drawn beside that of the largest deflection, and rows of each
_SEGMENTS, _SEGMENT = 5, 120
_SHORT_TRAIL = 80  # rows of the trail of a long run: the last few cycles
_FINE = 1 / 300  # tolerance of a loop's line, as a fraction of its range: a pixel of a small multiple
_COARSE = 1 / 100  # The same for the cursor, which is a spot of several pixels


@dataclass(frozen=True, kw_only=True)
class DrawnLoop:
    """A force-deflection loop."""

    axis: str
    mount: str
    outlines: tuple[Array, ...]  # the whole loop [mm, kN], (n, 2); of a long run some of its cycles
    plot: Plot | None = None  # its plot; None, with no rows in the fields below, if it has no view of its own
    time: Array = field(default_factory=lambda: np.zeros(0))  # instants of trail and cursor [s], (m,)
    # deflection and force at these instants [mm, kN], (m, 2)
    points: Array = field(default_factory=lambda: np.zeros((0, 2)))
    # whether the path from each of these instants to the next is drawn, (m - 1,)
    joined: Booleans = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))

    @property
    def trail(self) -> float | None:
        """Time that the trail behind the cursor may last [s]; None for the whole past."""
        if self.time.size <= MOST_TRAIL_ROWS:
            return None
        return float((self.time[_SHORT_TRAIL:] - self.time[:-_SHORT_TRAIL]).min())


@dataclass(frozen=True, kw_only=True)
class LoopPlot:
    """Loops of a mount in an axis: one plot, and the loop of every run that has the mount."""

    axis: str
    mount: str
    plot: Plot
    loops: tuple[tuple[DrawnRun, DrawnLoop], ...]

    @property
    def path(self) -> str:
        return entity("loops", self.axis, self.mount)

    def path_of(self, run: DrawnRun) -> str:
        return child(self.path, "data", *run.names)

    @property
    def trails(self) -> dict[str, float | None]:
        """Entities of the trails, and the time that each reaches behind the cursor [s]."""
        return {child(self.path_of(run), "trail"): loop.trail for run, loop in self.loops}


def grid_shape(plots: int) -> tuple[int, int]:
    """Find columns and rows of a grid of plots."""
    columns = 1 if plots == 1 else 2 if plots <= 4 else 3
    return columns, -(-plots // columns)


def loops_of(response: Response, selection: Selection) -> list[DrawnLoop]:
    """Compute the loop of every mount along every axis with a force, the mount nearest to its rated travel first."""
    mounts = {mount.name: mount for mount in response.scene.mounts}
    loops = []
    for number, axis in enumerate(AXES):
        shown = selection.shown(axis)
        for name in selection.ranked[axis]:
            mount = response.mounts[name]
            values = loop_points(mount, number)
            line = rows_of_line(response.time, values, _tolerance(values, _FINE), limit=response.time.size)
            parts = [line]
            if line.size > MOST_TRAIL_ROWS:
                # of a long run some segments, about the largest deflection and evenly: full cycles tell more than corners
                spread = np.linspace(0, line.size, _SEGMENTS + 2).astype(int)[1:-1].tolist()
                middles = sorted({int(np.abs(values[line, 0]).argmax()), *spread})
                parts = [line[max(0, middle - _SEGMENT // 2) : middle + _SEGMENT // 2] for middle in middles]
            loop = DrawnLoop(axis=axis, mount=name, outlines=tuple(values[part] for part in parts))
            if name in shown:
                rows, joined = _trail_rows(response.time, values, parts)
                low, high = values.min(axis=0), values.max(axis=0)
                for limit in (in_unit(limit, "mm") for limit in travel_limits(mounts[name], axis)):
                    if np.isfinite(limit) and (low[0] if limit < 0.0 else high[0]) / limit > 0.5:  # it comes near its rating
                        low[0], high[0] = min(low[0], limit), max(high[0], limit)
                plot = Plot.around(np.minimum(low, 0.0), np.maximum(high, 0.0), HEIGHT)
                loop = replace(loop, plot=plot, time=response.time[rows], points=values[rows], joined=joined)
            loops.append(loop)
    return loops


def drawn_loops(runs: Sequence[DrawnRun], shared: Selection) -> list[tuple[DrawnRun, DrawnLoop]]:
    return [(run, loop) for run in runs for loop in loops_of(run.response, shared.among(run.selection.mounts))]


def loop_plots(drawn: Sequence[tuple[DrawnRun, DrawnLoop]], shared: Selection, widths: Mapping[str, float]) -> list[LoopPlot]:
    """Compose a plot for every mount and axis that is shown; `widths` are those of the frames by axis."""
    plots = []
    for axis in shared.axes:
        for mount in shared.shown(axis):
            loops = [(run, loop) for run, loop in drawn if loop.plot and (loop.axis, loop.mount) == (axis, mount)]
            if loops:
                across, upward = (
                    (min(low for low, _ in ranges), max(high for _, high in ranges))
                    for ranges in zip(*((loop.plot.across, loop.plot.upward) for _, loop in loops if loop.plot), strict=True)
                )
                plot = Plot(across=across, upward=upward, width=widths[axis])
                plots.append(LoopPlot(axis=axis, mount=mount, plot=plot, loops=tuple(loops)))
    return plots


def log_loops(rec: Stream, drawn: Sequence[tuple[DrawnRun, DrawnLoop]], plots: Sequence[LoopPlot]) -> None:
    """Log all loops; those that have a view of their own with frame, cursor and the trail (path) behind it."""
    for axis in AXES:
        others = [(run, loop) for run, loop in drawn if loop.axis == axis and loop.plot is None]
        if others:
            loops = [loop for _, loop in others]
            colors = [colour_of(run.selection, loop.mount) for run, loop in others]
            rec.log(entity("loops", axis, "others"), _outlines(loops, colors, [o.mount for o in loops]), static=True)
    for entry in plots:
        scenes = [run.response.scene for run, _ in entry.loops]
        mounts = [mount for scene in scenes for mount in scene.mounts if mount.name == entry.mount]
        alone = not entry.loops[0][0].name
        low, high = entry.plot.across
        limits = dict.fromkeys(in_unit(limit, "mm") for mount in mounts for limit in travel_limits(mount, entry.axis))
        deflections = np.concatenate([part[:, 0] for _, loop in entry.loops for part in loop.outlines])
        log_frame(
            rec, entry.path, entry.plot, across=linear_ticks(low, high, most=max(2, round(entry.plot.width / 26))),
            upward=linear_ticks(*entry.plot.upward, most=5), lift=8.0 if alone else LARGE,
            marked=[
                (limit, DARK.exceeded if (deflections / limit > 1.0).any() else DARK.limit)
                for limit in limits if np.isfinite(limit) and low < limit < high
            ],
        )  # fmt: skip
        rec.log(child(entry.path, "data"), entry.plot.transform(), static=True)
        for order, (run, loop) in enumerate(entry.loops):
            path, color = entry.path_of(run), colour_of(run.selection, loop.mount)
            rec.log(path, _outlines([loop], [color], [run.name or loop.mount]), static=True)
            # the cursor [mm, kN], and the trail as one segment a row, so that it reaches the cursor; of coinciding trails the
            # one of the highest `order`, 0 to 9, is visible
            width = rr.Radius.ui_points(1.5)
            # Above the whole loop, which would hide the trail at the same draw order.
            look = rr.LineStrips2D.from_fields(colors=color, radii=width, draw_order=40.0 + order)
            rec.log(child(path, "trail"), look, static=True)
            segments = np.stack([loop.points[:-1], loop.points[1:]], axis=1)
            columns = rr.LineStrips2D.columns(strips=segments[loop.joined])
            rec.send_columns(child(path, "trail"), at(loop.time[1:][loop.joined]), columns)
            spot = rr.Points2D.from_fields(
                colors=(CURSOR if alone else color), radii=rr.Radius.ui_points(4.5), draw_order=50.0 + order
            )
            rec.log(child(path, "cursor"), spot, static=True)
            rec.send_columns(child(path, "cursor"), at(loop.time), rr.Points2D.columns(positions=loop.points))


def loop_points(mount: MountResponse, axis: int) -> Array:
    """Pair deflection and force of a mount along an axis [mm, kN], (n_t, 2)."""
    return np.column_stack([in_unit(mount.deflection[:, axis], "mm"), in_unit(mount.force[:, axis], "kN")])


def _trail_rows(time: Array, values: Array, parts: Sequence[Rows]) -> tuple[Rows, Booleans]:
    """Find the rows of trail and cursor, and whether the path from each to the next is drawn: of a long run only segments."""
    if len(parts) == 1:
        steps = rows_of_steps(time, values, _tolerance(values, _COARSE), limit=time.size)
        rows = np.union1d(parts[0], steps)
        if rows.size > MOST_TRAIL_ROWS:
            rows = parts[0]
        return rows, np.ones(rows.size - 1, dtype=np.bool_)
    between = np.linspace(0, time.size - 1, MOST_TRAIL_ROWS).astype(np.intp)
    rows = np.union1d(np.concatenate(parts), between)
    drawn = np.zeros(rows.size - 1, dtype=np.bool_)
    for part in parts:
        first, last = np.searchsorted(rows, part[[0, -1]])
        drawn[first:last] = True
    return rows, drawn


def _tolerance(loop: Array, ratio: float) -> Array:
    return np.asarray(np.maximum(ratio * np.ptp(loop, axis=0), 1e-12))


def _outlines(loops: Sequence[DrawnLoop], colors: Sequence[Color], labels: Sequence[str]) -> rr.LineStrips2D:
    return rr.LineStrips2D(
        [outline for loop in loops for outline in loop.outlines],
        colors=[[*color, 105] for loop, color in zip(loops, colors, strict=True) for _ in loop.outlines],
        labels=[label for loop, label in zip(loops, labels, strict=True) for _ in loop.outlines],
        show_labels=False,
        radii=rr.Radius.ui_points(0.75),
    )
