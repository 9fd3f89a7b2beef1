"""How the recording opens: scene and close-up beside tabs, scenario and events below, paused before the event."""

from typing import Any

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.views.recording.camera import close_up, scene_extent, whole_scene
from wirerope_mj.views.recording.events import lane_paths
from wirerope_mj.views.recording.frame import Plot
from wirerope_mj.views.recording.histories import (
    DIRECTIONS,
    TOTAL,
    UNITS,
    acceleration_path,
    acceleration_peak,
    mount_path,
    mount_peak,
)
from wirerope_mj.views.recording.loops import Loop, grid_shape, loop_path
from wirerope_mj.views.recording.mounts import BESIDE, devices_of
from wirerope_mj.views.recording.paths import child, entity
from wirerope_mj.views.recording.poses import Frame
from wirerope_mj.views.recording.selection import Selection
from wirerope_mj.views.recording.views import event_view, layout, loop_view, scene_view, series_view, time_axis


def blueprint_of(
    response: Response, selection: Selection, frames: dict[str, Frame], loops: list[Loop], *, tab: str = "Overview"
) -> Any:
    """Return the layout of the viewer for this response, with `tab` in front.

    Raises:
        ValueError: there is no such tab.
    """
    import rerun.blueprint as rrb

    top = rrb.Horizontal(
        _scenes(response, selection, frames), _tabs(response, selection, loops, tab), column_shares=[5, 6], name="run"
    )
    below = rrb.Horizontal(
        rrb.TextDocumentView(origin=entity("scenario"), name="Scenario"),
        event_view(entity("events")),
        column_shares=[5, 6],
    )
    return layout(rrb.Vertical(top, below, row_shares=[41, 9]), selection.window)


def _scenes(response: Response, selection: Selection, frames: dict[str, Frame]) -> Any:
    import rerun.blueprint as rrb

    base = response.scene.base
    origin = frames[base].path if base in response.bodies else entity("world")
    everything = "+ " + entity("world") + "/**"
    whole = scene_view(origin, [everything], f"{response.scene.name}, seen from the base", whole_scene(response))
    name = selection.governing
    if name is None:
        return whole
    _, extent = scene_extent(response.scene)
    device = next(device for device in devices_of(response, extent) if device.mount.name == name)
    camera = close_up(response, name, height=device.height, width=device.width)
    share = selection.share(name, selection.axes[0])
    used = "" if np.isnan(share) else f", {100 * share:.0f} % of its rated {selection.axes[0]} travel"
    paths = [frames[body].path for body in {mount.base_body for mount in response.scene.mounts}]
    without = [f"- {path}/{beside}" for path in paths for beside in BESIDE]
    near = scene_view(origin, [everything, *without], f"Mount {name}{used}", camera)
    return rrb.Vertical(whole, near, row_shares=[3, 2])


def _tabs(response: Response, selection: Selection, loops: list[Loop], tab: str) -> Any:
    import rerun.blueprint as rrb

    directions = [_acceleration_plot(response, selection, direction) for direction in DIRECTIONS]
    tabs = [_overview(response, selection), rrb.Vertical(*directions, name="Accelerations")]
    if selection.axes:
        for quantity in UNITS:
            plots = [_mount_plot(response, selection, quantity, axis) for axis in selection.axes]
            tabs.append(rrb.Vertical(*plots, name=f"{quantity.capitalize()}s"))
    tabs += [_loop_grid(selection, axis, loops) for axis in selection.axes]
    tabs.append(rrb.TextDocumentView(origin=entity("peaks"), name="Peaks"))
    names = [str(entry.name) for entry in tabs]
    if tab not in names:
        raise ValueError(f"`tab` must be one of {', '.join(names)}, got {tab!r}.")
    return rrb.Tabs(*tabs, active_tab=names.index(tab))


def _overview(response: Response, selection: Selection) -> Any:
    import rerun.blueprint as rrb

    views = [_acceleration_plot(response, selection, TOTAL)]
    if selection.axes:
        views += [_mount_plot(response, selection, quantity, selection.axes[0]) for quantity in UNITS]
    lanes = lane_paths(response, selection)
    views.append(
        rrb.StateTimelineView(
            origin=entity("lanes"),
            contents=lanes,
            name="Base motion and rated travel",
            time_view=time_axis(selection.window),
        )
    )
    return rrb.Vertical(*views, row_shares=[*([4.0] * (len(views) - 1)), 1.5 + 0.8 * len(lanes)], name="Overview")


def _acceleration_plot(response: Response, selection: Selection, direction: str) -> Any:
    peak = acceleration_peak(response, selection, direction)
    which = "norm" if direction == TOTAL else direction
    name = f"Acceleration {which} [g]" + (f": {peak.text}" if peak else "")
    return series_view(acceleration_path(direction), name, selection.window)


def _mount_plot(response: Response, selection: Selection, quantity: str, axis: str) -> Any:
    total, shown = len(selection.ranked[axis]), len(selection.shown(axis))
    which = f", {shown} of {total} mounts" if shown < total else ""
    peak = mount_peak(response, selection, quantity, axis)
    name = f"{axis.capitalize()} {quantity} [{UNITS[quantity][1]}]{which}: {peak.text}"
    return series_view(mount_path(quantity, axis), name, selection.window)


def _loop_grid(selection: Selection, axis: str, loops: list[Loop]) -> Any:
    import rerun.blueprint as rrb

    views = [_loop_view(selection, loop, loop.plot) for loop in loops if loop.axis == axis and loop.plot is not None]
    return rrb.Grid(*views, grid_columns=grid_shape(len(views))[0], name=f"{axis.capitalize()} loops")


def _loop_view(selection: Selection, loop: Loop, plot: Plot) -> Any:
    path = loop_path(loop.axis, loop.mount)
    share = selection.share(loop.mount, loop.axis)
    used = "" if np.isnan(share) else f", {100 * share:.0f} % of rated travel"
    trails = {child(path, "data", "trail"): loop.trail}
    return loop_view(path, f"{loop.mount}: kN over mm{used}", width=plot.width, trails=trails)
