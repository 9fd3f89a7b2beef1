"""Layout of the viewer for a run alone: scene and close-up beside tabs, scenario and events below, paused before the event."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from wirerope_mj.content.panels import Panel
from wirerope_mj.content.selection import Selection, main_direction
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.camera import whole_scene
from wirerope_mj.views.recording.cursor import PATH as CURSOR
from wirerope_mj.views.recording.documents import VERDICT
from wirerope_mj.views.recording.drawn_runs import DrawnRun
from wirerope_mj.views.recording.frame import GROUND
from wirerope_mj.views.recording.graphs import Graphs
from wirerope_mj.views.recording.histories import CONTACT, DIRECTIONS, UNITS, USED
from wirerope_mj.views.recording.lanes import lane_paths
from wirerope_mj.views.recording.large import ROOT as LARGE
from wirerope_mj.views.recording.large import large_factor
from wirerope_mj.views.recording.loops import LoopPlot, grid_shape
from wirerope_mj.views.recording.mounts import BESIDE, close_up_of
from wirerope_mj.views.recording.over_frequency import over_frequency_view
from wirerope_mj.views.recording.paths import entity
from wirerope_mj.views.recording.plan import ROOT as PLAN
from wirerope_mj.views.recording.plan import plan_bounds
from wirerope_mj.views.recording.views import (
    event_view,
    graph_view,
    layout,
    loop_view,
    scene_view,
    tabs_with,
    time_axis,
    whole_scene_view,
)


def blueprint_of(run: DrawnRun, graphs: Graphs, plots: Sequence[LoopPlot], panel: Panel | None, *, tab: str) -> Any:
    """Return the layout of the viewer for a run alone, with `tab` in front.

    Raises:
        ValueError: there is no such tab.
    """
    import rerun.blueprint as rrb

    top = rrb.Horizontal(_scenes(run), _tabs(run, graphs, plots, panel, tab), column_shares=[5, 6], name="run")
    banner = rrb.TextDocumentView(origin=entity(VERDICT), name="Verdict")
    texts = rrb.Tabs(
        rrb.TextDocumentView(origin=entity(*CURSOR), name="At the time cursor"),
        rrb.TextDocumentView(origin=entity("scenario"), name="Scenario"),
        active_tab=0,
    )
    below = rrb.Horizontal(texts, event_view(entity("events")), column_shares=[5, 6])
    return layout(rrb.Vertical(banner, top, below, row_shares=[7, 74, 19]), run.selection.window)


def _scenes(run: DrawnRun) -> Any:
    import rerun.blueprint as rrb

    response, selection, frames = run.response, run.selection, run.frames
    base = response.scene.base
    origin = frames[base].path if base in response.bodies else entity("world")
    everything = "+ " + entity("world") + "/**"
    factor, camera = large_factor(run), whole_scene(response)
    scenes = [whole_scene_view(response, frames, "True scale")]
    if factor > 1.0:
        below = entity(LARGE)
        scenes.insert(0, scene_view(below + origin, [f"+ {below}/**"], f"Motion drawn {factor:g} times larger", camera))
    if selection.used and selection.mounts:
        across, upward = plan_bounds(response)
        bounds = rrb.VisualBounds2D(x_range=across, y_range=upward)
        scenes.append(
            rrb.Spatial2DView(
                origin=entity(PLAN), name="Mounts from above, % used now", background=GROUND, visual_bounds=bounds
            )
        )
    whole = rrb.Tabs(*scenes, active_tab=0, name="Scenes")
    name = selection.governing
    if name is None:
        return whole
    camera = close_up_of(response, name)
    worst = next((one for one in selection.used if one.subject == name), None)
    used = f", {in_unit(worst.largest, '%'):.0f} % of its limit of {worst.governing.criterion}" if worst else ""
    paths = [frames[body].path for body in {mount.base_body for mount in response.scene.mounts}]
    without = [f"- {path}/{beside}" for path in paths for beside in BESIDE]
    near = scene_view(origin, [everything, *without], f"Mount {name}{used}", camera)
    return rrb.Vertical(whole, near, row_shares=[3, 2])


def _tabs(run: DrawnRun, graphs: Graphs, plots: Sequence[LoopPlot], panel: Panel | None, tab: str) -> Any:
    import rerun.blueprint as rrb

    selection = run.selection
    axes, window = selection.axes, selection.window
    directions = [graph_view(graphs["acceleration", direction], window) for direction in DIRECTIONS]
    tabs = [_overview(run, graphs), rrb.Vertical(*directions, name="Accelerations")]
    if axes:
        for quantity in UNITS:
            views = [graph_view(graphs[quantity, axis], window) for axis in axes]
            tabs.append(rrb.Vertical(*views, name=f"{quantity.capitalize()}s"))
    if contacts := [graph_view(graph, window) for key, graph in graphs.items() if key[0] == CONTACT]:
        tabs.append(rrb.Vertical(*contacts, name="Contacts"))
    for axis in axes:
        views = [_loop_view(selection, plot) for plot in plots if plot.axis == axis]
        tabs.append(rrb.Grid(*views, grid_columns=grid_shape(len(views))[0], name=f"{axis.capitalize()} loops"))
    if panel is not None:
        tabs.append(rrb.Vertical(over_frequency_view(panel), name="Over frequency"))
    tabs.append(rrb.TextDocumentView(origin=entity("peaks"), name="Peaks"))
    tabs.append(rrb.TextDocumentView(origin=entity("verdicts"), name="Verdicts"))
    return tabs_with(tabs, "tab", tab)


def _overview(run: DrawnRun, graphs: Graphs) -> Any:
    import rerun.blueprint as rrb

    selection = run.selection
    keys: list[tuple[str, ...]] = [(USED,)] if selection.used else []
    keys += [("deflection", axis) for axis in selection.axes[:1]]
    keys.append(("acceleration", main_direction(run.response)))
    views = [graph_view(graphs[key], selection.window) for key in keys]
    lanes = lane_paths(run.response, selection)
    views.append(
        rrb.StateTimelineView(
            origin=entity(), contents=lanes, name="Base, stops and limits", time_view=time_axis(selection.window)
        )
    )
    return rrb.Vertical(*views, row_shares=[*([4.0] * (len(views) - 1)), 1.2 + 1.0 * len(lanes)], name="Overview")


def _loop_view(selection: Selection, plot: LoopPlot) -> Any:
    ratio = selection.utilisation(plot.mount, plot.axis)
    used = "" if np.isnan(ratio) else f", {100 * ratio:.0f} % of rated travel"
    return loop_view(plot.path, f"{plot.mount}: kN over mm{used}", width=plot.plot.width, trails=plot.trails)
