"""Views of every recording: scenes, plots over time, framed plots in 2D, tabs, and the time panel."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.views.colours import DARK, Color
from wirerope_mj.views.recording.camera import Camera, whole_scene
from wirerope_mj.views.recording.paths import TIMELINE, Stream, entity, known_letters
from wirerope_mj.views.recording.shapes import Frame

Pane: TypeAlias = rrb.View | rrb.Container
SLOW_MOTION = 0.05  # Playback speed for a shock: an event of half a second takes ten


def layout(content: Pane, window: tuple[float, float], *, listed: bool = False) -> rrb.Blueprint:
    """Lay out `content`, paused at the start of `window` [s], the interval that playing repeats.

    With `listed` the panel that lists the recordings of a file is open.
    """
    start, end = (rr.TimeInt(seconds=instant) for instant in window)
    speed = SLOW_MOTION if window[1] - window[0] < 10.0 else 1.0  # longer motions are slow enough in real time
    panel = rrb.TimePanel(
        state="collapsed", timeline=TIMELINE, playback_speed=speed, play_state="paused", loop_mode="selection",
        time_selection=rrb.components.AbsoluteTimeRange(min=start, max=end),
    )  # fmt: skip
    return opening(content, panel, listed=listed)


def opening(content: Pane, panel: rrb.TimePanel, *, listed: bool = False) -> rrb.Blueprint:
    """Lay out `content` and a time panel, beside the panel that lists the recordings if there are several."""
    return rrb.Blueprint(
        content, panel, rrb.BlueprintPanel(state="expanded" if listed else "hidden"), rrb.SelectionPanel(state="hidden"),
        rrb.TopPanel(state="hidden"), auto_views=False, auto_layout=False,
    )  # fmt: skip


def scene_view(origin: str, contents: Sequence[str], name: str, camera: Camera) -> rrb.Spatial3DView:
    """View a scene in the frame of `origin`, in which `camera` is given."""
    return rrb.Spatial3DView(
        origin=origin, contents=list(contents), name=known_letters(name), background=GROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital, position=camera.eye, look_target=camera.target, eye_up=[0.0, 0.0, 1.0]
        ),
    )  # fmt: skip


def tabs_with(entries: list[Pane], argument: str, name: str) -> rrb.Tabs:
    """Put the tab called `name` in front; ValueError, which names `argument`, if there is no such tab."""
    names = [str(entry.name) for entry in entries]
    if name not in names:
        raise ValueError(f"`{argument}` must be one of {', '.join(names)}, got {name!r}.")
    return rrb.Tabs(*entries, active_tab=names.index(name))


def whole_scene_view(response: Response, frames: dict[str, Frame], name: str, *, away: float = 1.0) -> rrb.Spatial3DView:
    """View the whole scene, from `away` times the distance that the modelled geometry needs."""
    base, camera = response.scene.base, whole_scene(response)
    camera = Camera(eye=camera.target + away * (camera.eye - camera.target), target=camera.target)
    origin = frames[base].path if base in response.bodies else entity("world")
    return scene_view(origin, ["+ " + entity("world") + "/**"], name, camera)


_DECADES = tuple(10.0**power for power in range(-12, 13))
_TIMES = (*(step for step in _DECADES if step <= 10.0), 60.0, 600.0, 3600.0, 36000.0)  # steps of the viewer's time axes [s]
_BEFORE = 0.2  # fraction of an event that may be seen before it
_LATER, _EARLIER = 1.25, 0.6  # length over that of the event, from which it is cut, and down to which
_ROOM = 1.04  # for the last number of an event that is cut
_LAST = 36.0  # room for half the last number along an axis of time [points]
_APART = 22.0, 72.0  # Least distance of numbers that the viewer writes along upright axes, and along those of time [points]


def with_ticks(low: float, high: float, length: float, *, time: bool = False, from_low: bool = False) -> tuple[float, float]:
    """Extend the range of an axis of a length [points] until the viewer writes three numbers along it.

    It writes only multiples of powers of ten, of time also of minutes and hours, and none where they would stand too close.
    An axis of time, or `from_low`, is extended at its end alone.
    """
    found, best, apart = (low, high), float("inf"), _APART[time]
    for step in _TIMES if time else _DECADES:
        if (high - low) / 100.0 <= step <= 100.0 * max(high - low, 1e-12):
            first = np.arange(np.floor(low / step) - 2.0, np.ceil(high / step) + 1.0) * step
            start, end = np.minimum(low, first), np.maximum(high, first + 2.0 * step)
            size = end - start
            size[(length * step < apart * size) | ((time or from_low) & (first < low - 1e-9 * step))] = np.inf
            if size.min() < best:
                row = int(size.argmin())
                best, found = float(size[row]), (float(start[row]), float(end[row]))
    return found


def seen_window(window: tuple[float, float], width: float) -> tuple[float, float]:
    """Find the interval that a plot of a width [points] shows of `window` [s]: three numbers stand along it.

    It begins a little earlier and ends later, or, where that would be much, earlier: then a quiet end is out of sight.
    """
    span = window[1] - window[0]
    before = (step * float(np.floor(window[0] / step)) for step in _TIMES)
    starts = [window[0], *(start for start in before if start >= 0.0 and window[0] - start <= _BEFORE * span)]
    found = (with_ticks(start, window[1], width, time=True) for start in starts)
    start, end = min(found, key=lambda seen: seen[1] - seen[0])
    shorter = max((width / _APART[1] * step for step in _TIMES if width / _APART[1] * step < span), default=0.0)
    if end - start > _LATER * span and shorter > _EARLIER * span:
        return start, start + _ROOM * shorter
    return start, end + (_LAST / width * (end - start) if end > window[1] else 0.0)


def time_axis(window: tuple[float, float], width: float) -> rrb.TimeAxis:
    """Show a window [s] along a plot of a width [points]."""
    boundary = rrb.TimeRangeBoundary
    start, end = (boundary.absolute(seconds=instant) for instant in seen_window(window, width))
    return rrb.TimeAxis(view_range=rr.TimeRange(start=start, end=end))


def loop_view(origin: str, name: str, *, width: float, trails: Mapping[str, float | None]) -> rrb.Spatial2DView:
    """View the plot of a loop in a frame of a width.

    `trails` are entities, and the time that each reaches behind the cursor [s]; None for the whole past.
    """
    boundary = rrb.TimeRangeBoundary
    overrides = {}
    for path, trail in trails.items():
        start = boundary.infinite() if trail is None else boundary.cursor_relative(seconds=-trail)
        past = rrb.VisibleTimeRange(TIMELINE, start=start, end=boundary.cursor_relative())
        overrides[path] = [rrb.VisibleTimeRanges([past])]
    return rrb.Spatial2DView(
        origin=origin, name=known_letters(name), background=GROUND,
        visual_bounds=rrb.VisualBounds2D(x_range=[-16.0, width + 4.0], y_range=[-4.0, HEIGHT + 17.0]), overrides=overrides,
    )  # fmt: skip


def event_view(origin: str) -> rrb.TextLogView:
    """View the log of the events below `origin`."""
    # Instants stand in the texts: the viewer writes nanoseconds, and cuts them off.
    times = [rrb.encodings.TimelineColumn(TIMELINE, visible=False)]
    return rrb.TextLogView(
        origin=origin, name="Events", columns=rrb.TextLogColumns(timeline_columns=times, text_log_columns=["loglevel", "body"])
    )


HEIGHT = 100.0  # Height of a plot's frame, in units of its view
LARGE = 4.5  # `lift` for a view that fills half the screen's height
GROUND = DARK.ground  # behind every plot in any theme: the colours of lines are made for it
_FRAME, _GRID, _ZERO, _TICK = DARK.frame, DARK.rule, DARK.faint, DARK.others


@dataclass(frozen=True, kw_only=True)
class Plot:
    """Ranges of a plot across and upward, and the width of its frame in units of the view."""

    across: tuple[float, float]
    upward: tuple[float, float]
    width: float

    @classmethod
    def around(cls, low: Array, high: Array, width: float) -> "Plot":
        room = 0.06 * np.maximum(high - low, 1e-6)
        low, high = low - room, high + room
        return cls(across=(low[0], high[0]), upward=(low[1], high[1]), width=width)

    @property
    def scale(self) -> tuple[float, float]:
        return self.width / (self.across[1] - self.across[0]), -HEIGHT / (self.upward[1] - self.upward[0])

    def points(self, across: ArrayLike, upward: ArrayLike) -> Array:
        """Map values to positions in the view, (n, 2)."""
        x, y = np.broadcast_arrays(np.asarray(across, dtype=np.float64), np.asarray(upward, dtype=np.float64))
        sx, sy = self.scale
        return np.column_stack([(x.ravel() - self.across[0]) * sx, HEIGHT + (y.ravel() - self.upward[0]) * sy])

    def transform(self) -> rr.Transform3D:
        sx, sy = self.scale
        return rr.Transform3D(translation=[*self.points(0.0, 0.0)[0], 0.0], scale=[sx, sy, 1.0])


def fitting_width(pane: tuple[float, float], columns: int, rows: int, *, least: float = 0.8) -> float:
    """Fit the width of a plot's frame to its cell of a pane [points], up to a width over height of 3."""
    wide, high = pane[0] / columns - 60.0, pane[1] / rows - 62.0  # each view has a title, and ticks need room
    return HEIGHT * min(max(wide / high, least), 3.0)


def log_frame(
    rec: Stream, path: str, plot: Plot, *, across: Array, upward: Array,
    names: tuple[Sequence[str], Sequence[str]] | None = None, marked: Sequence[tuple[float, Color]] = (),
    lift: float = 8.0,
) -> None:  # fmt: skip
    """Log a frame with lines at round numbers, `across` upright and `upward` level, and the numbers, or `names`, beside it.

    `marked` are lines across in a colour of their own. `lift` raises the numbers to stand at their lines, in units of the view:
    the viewer hangs them below their positions, by as much on the screen however large the view is.
    """
    (x0, x1), (y0, y1) = plot.across, plot.upward
    lines = [plot.points([x, x], [y0, y1]) for x in across] + [plot.points([x0, x1], [y, y]) for y in upward]
    colors = [_ZERO if value == 0.0 and names is None else _GRID for value in (*across, *upward)]
    for value, color in marked:
        lines.append(plot.points([value] * 2, [y0, y1]))
        colors.append(color)
    lines.append(plot.points([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0]))
    colors.append(_FRAME)
    frame = rr.LineStrips2D(lines, colors=colors, radii=rr.Radius.ui_points(0.6), draw_order=-10.0)
    below = plot.points(across, y0) + [0.0, 1.0]
    beside = plot.points(x0, upward) + [-7.5, -lift]
    labels = [f"{value:g}" for value in np.round((*across, *upward), 9) + 0.0] if names is None else [*names[0], *names[1]]
    numbers = rr.Points2D(
        np.concatenate([below, beside]), labels=labels, colors=_TICK, radii=rr.Radius.ui_points(0.0), show_labels=True
    )
    rec.log(path, frame, numbers, static=True)
