"""Layout of the viewer for several runs: scenes side by side above, histories, loops and tables below beside differences."""

from collections.abc import Callable, Sequence
from typing import Any

from wirerope_mj.assessment.comparison import BASE
from wirerope_mj.views.recording.camera import Camera, scene_extent, whole_scene
from wirerope_mj.views.recording.comparison_text import PEAK_TEXTS, PEAKS, STUDY, SUMMARY
from wirerope_mj.views.recording.drawn_runs import DrawnRun, Overlay
from wirerope_mj.views.recording.frame import fitting_width
from wirerope_mj.views.recording.ghosts import ROOT as GHOSTS
from wirerope_mj.views.recording.ghosts import ghost_factor
from wirerope_mj.views.recording.graphs import Graphs
from wirerope_mj.views.recording.histories import (
    DIRECTIONS,
    TOTAL,
    UNITS,
    difference_key,
    differing,
    shown_parts,
)
from wirerope_mj.views.recording.loops import LoopPlot
from wirerope_mj.views.recording.mounts import BESIDE, close_up_of
from wirerope_mj.views.recording.paths import entity
from wirerope_mj.views.recording.views import event_view, graph_view, layout, loop_view, scene_view, tabs_with

_SCENES = (1920.0, 420.0)
"""Width and height of the pane of the scenes on a full-HD screen [points]."""

_TABS = (1400.0, 500.0)
"""The same of the tabs below, without their titles."""


Views = Callable[..., Any]
"""Returns a view of a graph by its key, a new one each time: the viewer wants no view in two tabs."""


def loop_widths(overlay: Overlay) -> dict[str, float]:
    """Return the width of a loop's frame for every axis, so that the loops of an axis fill their row."""
    shared = overlay.shared
    return {axis: fitting_width(_TABS, len(shared.shown(axis)), 1, least=0.5) for axis in shared.axes}


def overlay_blueprint(
    overlay: Overlay, graphs: Graphs, plots: Sequence[LoopPlot], *, study: bool, tab: str, scene: str
) -> Any:
    """Return the layout of the viewer with `tab` and `scene` in front.

    Raises:
        ValueError: there is no such tab or scene.
    """
    import rerun.blueprint as rrb

    beside = rrb.Vertical(
        rrb.TextDocumentView(origin=entity(SUMMARY), name="What differs"),
        event_view(entity("events")),
        row_shares=[2, 1],
    )

    def views(*key: str) -> Any:
        return graph_view(graphs[key], overlay.shared.window)

    tabs = [_overview(overlay, views), _accelerations(overlay, views)]
    tabs += [_mounts(overlay, views)] if overlay.shared.axes else []
    tabs += [_loops(axis, plots) for axis in overlay.shared.axes]
    texts = [rrb.TextDocumentView(origin=entity(PEAKS, name), name=title) for name, title in PEAK_TEXTS.items()]
    tabs.append(rrb.Horizontal(*texts, name="Peaks"))
    tabs += [rrb.TextDocumentView(origin=entity(STUDY), name="Study")] if study else []
    below = rrb.Horizontal(tabs_with(tabs, "tab", tab), beside, column_shares=[14, 5])
    above = tabs_with(_scenes(overlay), "scene", scene)
    return layout(rrb.Vertical(above, below, row_shares=[5, 7]), overlay.shared.window)


def _scenes(overlay: Overlay) -> list[Any]:
    """Return the scenes side by side, their ghosts in one, and the worst mount that they share from near."""
    import rerun.blueprint as rrb

    rows = 1 if len(overlay.runs) <= 4 else 2
    columns = -(-len(overlay.runs) // rows)
    aspect = rows * _SCENES[0] / columns / _SCENES[1]
    whole = [_scene(run, "seen from the base", whole_scene(run.response, aspect=aspect)) for run in overlay.runs]
    factor = ghost_factor(overlay)
    larger = f", motion drawn {factor:g} times larger" if factor > 1.0 else ""
    largest = max(overlay.runs, key=lambda run: scene_extent(run.response.scene)[1])
    camera = whole_scene(largest.response, aspect=_SCENES[0] / _SCENES[1])
    names = " and ".join(run.name for run in overlay.runs)
    ghosts = scene_view(
        entity(GHOSTS), ["+ " + entity(GHOSTS) + "/**"], f"{names}, seen from their bases{larger}", camera
    )
    scenes = [rrb.Grid(*whole, grid_columns=columns, name="Side by side"), rrb.Vertical(ghosts, name="Ghosts")]
    mount = overlay.shared.governing
    if mount is not None:
        near = [_near(run, mount) for run in overlay.having(mount)]
        scenes.append(rrb.Horizontal(*near, name="Worst mount"))
    return scenes


def _scene(run: DrawnRun, seen: str, camera: Camera, *, without: Sequence[str] = ()) -> Any:
    base = run.response.scene.base
    origin = run.root + (run.frames[base].path if base in run.response.bodies else entity("world"))
    contents = ["+ " + run.root + entity("world") + "/**", *without]
    return scene_view(origin, contents, f"{run.name}: {run.response.scene.name}, {seen}", camera)


def _near(run: DrawnRun, mount: str) -> Any:
    bases = dict.fromkeys(entry.base_body for entry in run.response.scene.mounts)
    hidden = [f"- {run.root}{run.frames[body].path}/{beside}" for body in bases for beside in BESIDE]
    return _scene(run, f"mount {mount}", close_up_of(run.response, mount), without=hidden)


def _overview(overlay: Overlay, views: Views) -> Any:
    """Return the base, the worst part and the worst mount, and the differences between the runs."""
    import rerun.blueprint as rrb

    parts, mount = shown_parts(overlay), overlay.shared.governing
    first = [part for part in parts if part == BASE][:1] + [part for part in parts if part != BASE][:1]
    keys = [("acceleration", TOTAL, part.kind, part.name) for part in first]
    some = [] if mount is None else [views(quantity, overlay.shared.axes[0], mount) for quantity in UNITS]
    apart = [views(*difference_key(subject)) for subject in differing(overlay)]
    shown = [*(views(*key) for key in keys), *some, *apart]
    return rrb.Grid(*shown, grid_columns=min(2, len(shown)), name="Overview")


def _accelerations(overlay: Overlay, views: Views) -> Any:
    import rerun.blueprint as rrb

    parts, tabs = shown_parts(overlay), []
    for direction in (TOTAL, *DIRECTIONS):
        shown = [views("acceleration", direction, part.kind, part.name) for part in parts]
        name = "norm" if direction == TOTAL else direction
        tabs.append(rrb.Grid(*shown, grid_columns=min(2, len(parts)), name=name))
    return rrb.Tabs(*tabs, active_tab=0, name="Accelerations")


def _mounts(overlay: Overlay, views: Views) -> Any:
    import rerun.blueprint as rrb

    tabs = []
    for axis in overlay.shared.axes:
        shown = [views(quantity, axis, mount) for mount in overlay.shared.shown(axis) for quantity in UNITS]
        tabs.append(rrb.Grid(*shown, grid_columns=2, name=axis))
    return rrb.Tabs(*tabs, active_tab=0, name="Mounts")


def _loops(axis: str, plots: Sequence[LoopPlot]) -> Any:
    import rerun.blueprint as rrb

    views = [
        loop_view(plot.path, f"{plot.mount}: kN over mm", width=plot.plot.width, trails=plot.trails)
        for plot in plots
        if plot.axis == axis
    ]
    return rrb.Horizontal(*views, name=f"{axis.capitalize()} loops")
