"""Views of every recording: scenes, plots over time, loops, tabs, and the time panel."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.engine.response import Response
from wirerope_mj.views.recording.camera import Camera, whole_scene
from wirerope_mj.views.recording.frame import GROUND, HEIGHT
from wirerope_mj.views.recording.paths import TIMELINE, entity, known_letters
from wirerope_mj.views.recording.poses import Frame

Pane: TypeAlias = rrb.View | rrb.Container
SLOW_MOTION = 0.05  # Playback speed for a shock: an event of half a second takes ten


def layout(content: Pane, window: tuple[float, float], *, cases: bool = False) -> rrb.Blueprint:
    """Return the blueprint of `content`: paused at the start of `window` [s], which is what playing repeats.

    With `cases` there are several recordings, and the panel that lists them is open.
    """
    start, end = (rr.TimeInt(seconds=instant) for instant in window)
    speed = SLOW_MOTION if window[1] - window[0] < 10.0 else 1.0  # what lasts longer is slow enough in real time
    panel = rrb.TimePanel(
        state="collapsed", timeline=TIMELINE, playback_speed=speed, play_state="paused", loop_mode="selection",
        time_selection=rrb.components.AbsoluteTimeRange(min=start, max=end),
    )  # fmt: skip
    return opening(content, panel, cases=cases)


def opening(content: Pane, panel: rrb.TimePanel, *, cases: bool = False) -> rrb.Blueprint:
    """Return the blueprint of `content` and a time panel alone, or beside the panel that lists the recordings."""
    return rrb.Blueprint(
        content, panel, rrb.BlueprintPanel(state="expanded" if cases else "hidden"), rrb.SelectionPanel(state="hidden"),
        rrb.TopPanel(state="hidden"), auto_views=False, auto_layout=False,
    )  # fmt: skip


def scene_view(origin: str, contents: Sequence[str], name: str, camera: Camera) -> rrb.Spatial3DView:
    """Return a view of a scene that rides on `origin`; `camera` is in its frame."""
    return rrb.Spatial3DView(
        origin=origin, contents=list(contents), name=known_letters(name), background=GROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital, position=camera.eye, look_target=camera.target, eye_up=[0.0, 0.0, 1.0]
        ),
    )  # fmt: skip


def tabs_with(entries: list[Pane], argument: str, name: str) -> rrb.Tabs:
    """Return tabs with that called `name` in front, which `argument` asked for; ValueError if there is none."""
    names = [str(entry.name) for entry in entries]
    if name not in names:
        raise ValueError(f"`{argument}` must be one of {', '.join(names)}, got {name!r}.")
    return rrb.Tabs(*entries, active_tab=names.index(name))


def whole_scene_view(response: Response, frames: dict[str, Frame], name: str, *, away: float = 1.0) -> rrb.Spatial3DView:
    """Return a view of everything, from `away` times as far as the modelled geometry needs."""
    base, camera = response.scene.base, whole_scene(response)
    camera = Camera(eye=camera.target + away * (camera.eye - camera.target), target=camera.target)
    origin = frames[base].path if base in response.bodies else entity("world")
    return scene_view(origin, ["+ " + entity("world") + "/**"], name, camera)


def time_axis(window: tuple[float, float]) -> rrb.TimeAxis:
    """Return the axis of a plot over `window` [s]."""
    boundary = rrb.TimeRangeBoundary
    start, end = (boundary.absolute(seconds=instant) for instant in window)
    return rrb.TimeAxis(view_range=rr.TimeRange(start=start, end=end))


def loop_view(origin: str, name: str, *, width: float, trails: Mapping[str, float | None]) -> rrb.Spatial2DView:
    """Return a view of the plot of a loop, whose frame has this width.

    `trails` are entities, and how long each reaches behind the cursor [s]; None for the whole past.
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
    """Return the log of the events below `origin`."""
    # Instants stand in the texts: the viewer writes nanoseconds, and cuts them off.
    times = [rrb.encodings.TimelineColumn(TIMELINE, visible=False)]
    return rrb.TextLogView(
        origin=origin, name="Events", columns=rrb.TextLogColumns(timeline_columns=times, text_log_columns=["loglevel", "body"])
    )
