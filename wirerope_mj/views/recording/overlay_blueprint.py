"""How laid-over runs open: scenes side by side above, histories, loops and tables below, what differs beside them."""

from typing import Any

import numpy as np

from wirerope_mj.assessment.comparison import BASE, Component
from wirerope_mj.views.recording.camera import Camera, close_up, scene_extent, whole_scene
from wirerope_mj.views.recording.frame import HEIGHT
from wirerope_mj.views.recording.histories import DIRECTIONS, TOTAL, UNITS, Marker
from wirerope_mj.views.recording.mounts import BESIDE, devices_of
from wirerope_mj.views.recording.overlay_ghosts import ROOT as GHOSTS
from wirerope_mj.views.recording.overlay_ghosts import ghost_factor
from wirerope_mj.views.recording.overlay_histories import (
    difference_path,
    differing,
    mount_markers,
    overlaid_mount_path,
    part_markers,
    part_path,
    shown_parts,
)
from wirerope_mj.views.recording.overlay_loops import OverlaidLoops
from wirerope_mj.views.recording.overlay_runs import OverlaidRun, Overlay
from wirerope_mj.views.recording.overlay_text import PEAK_TEXTS, PEAKS, SUMMARY
from wirerope_mj.views.recording.paths import entity, root_of
from wirerope_mj.views.recording.views import event_view, layout, loop_view, scene_view, series_view

EVENTS = "events"

_SCENES = (1920.0, 420.0)
"""Width and height of the pane of the scenes on a full-HD screen [points]."""

_TABS = (1400.0, 500.0)
"""The same of the tabs below, without their titles."""


def loop_widths(overlay: Overlay) -> dict[str, float]:
    """Return the width of a loop's frame for every axis, so that the loops of an axis fill their row."""
    widths = {}
    for axis in overlay.shared.axes:
        wide, high = _TABS[0] / len(overlay.shared.shown(axis)) - 60.0, _TABS[1] - 62.0
        widths[axis] = HEIGHT * float(np.clip(wide / high, 0.5, 3.0))
    return widths


def overlay_blueprint(overlay: Overlay, overlaid: list[OverlaidLoops], *, tab: str, scene: str) -> Any:
    """Return the layout of the viewer with `tab` and `scene` in front.

    Raises:
        ValueError: there is no such tab or scene.
    """
    import rerun.blueprint as rrb

    beside = rrb.Vertical(
        rrb.TextDocumentView(origin=entity(SUMMARY), name="What differs"),
        event_view(entity(EVENTS)),
        row_shares=[2, 1],
    )
    tabs = [_overview(overlay), _accelerations(overlay)]
    tabs += [_mounts(overlay)] if overlay.shared.axes else []
    tabs += [_loops(axis, overlaid) for axis in overlay.shared.axes]
    texts = [rrb.TextDocumentView(origin=entity(PEAKS, name), name=title) for name, title in PEAK_TEXTS.items()]
    tabs.append(rrb.Horizontal(*texts, name="Peaks"))
    below = rrb.Horizontal(_in_front(tabs, "tab", tab), beside, column_shares=[14, 5])
    above = _in_front(_scenes(overlay), "scene", scene)
    window = overlay.shared.window
    return layout(rrb.Vertical(above, below, row_shares=[5, 7]), window)


def _in_front(entries: list[Any], what: str, name: str) -> Any:
    import rerun.blueprint as rrb

    names = [str(entry.name) for entry in entries]
    if name not in names:
        raise ValueError(f"`{what}` must be one of {', '.join(names)}, got {name!r}.")
    return rrb.Tabs(*entries, active_tab=names.index(name))


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


def _scene(run: OverlaidRun, words: str, camera: Camera, *, without: tuple[str, ...] = ()) -> Any:
    base, root = run.response.scene.base, root_of(run.name)
    origin = root + (run.frames[base].path if base in run.response.bodies else entity("world"))
    contents = ["+ " + root + entity("world") + "/**", *without]
    return scene_view(origin, contents, f"{run.name}: {run.response.scene.name}, {words}", camera)


def _near(run: OverlaidRun, mount: str) -> Any:
    _, extent = scene_extent(run.response.scene)
    device = next(device for device in devices_of(run.response, extent) if device.mount.name == mount)
    camera = close_up(run.response, mount, height=device.height, width=device.width)
    bases = dict.fromkeys(entry.base_body for entry in run.response.scene.mounts)
    hidden = [f"- {root_of(run.name)}{run.frames[body].path}/{beside}" for body in bases for beside in BESIDE]
    return _scene(run, f"mount {mount}", camera, without=tuple(hidden))


def _overview(overlay: Overlay) -> Any:
    """Return the base, the worst part and the worst mount, and how far the runs are apart."""
    import rerun.blueprint as rrb

    parts = [part for part in shown_parts(overlay) if part == BASE][:1]
    parts += [part for part in shown_parts(overlay) if part != BASE][:1]
    views = [_acceleration_plot(overlay, part, TOTAL) for part in parts]
    if overlay.shared.governing is not None:
        axis = overlay.shared.axes[0]
        views += [_mount_plot(overlay, overlay.shared.governing, quantity, axis) for quantity in UNITS]
    views += [_difference_plot(overlay, thing) for thing in differing(overlay)]
    return rrb.Grid(*views, grid_columns=min(2, len(views)), name="Overview")


def _accelerations(overlay: Overlay) -> Any:
    import rerun.blueprint as rrb

    tabs = [
        rrb.Grid(
            *(_acceleration_plot(overlay, part, direction) for part in shown_parts(overlay)),
            grid_columns=min(2, len(shown_parts(overlay))),
            name="norm" if direction == TOTAL else direction,
        )
        for direction in (TOTAL, *DIRECTIONS)
    ]
    return rrb.Tabs(*tabs, active_tab=0, name="Accelerations")


def _mounts(overlay: Overlay) -> Any:
    import rerun.blueprint as rrb

    tabs = []
    for axis in overlay.shared.axes:
        plots = [
            _mount_plot(overlay, mount, quantity, axis)
            for mount in overlay.shared.shown(axis)
            for quantity in UNITS
        ]  # fmt: skip
        tabs.append(rrb.Grid(*plots, grid_columns=2, name=axis))
    return rrb.Tabs(*tabs, active_tab=0, name="Mounts")


def _loops(axis: str, overlaid: list[OverlaidLoops]) -> Any:
    import rerun.blueprint as rrb

    views = []
    for entry in overlaid:
        if entry.axis == axis:
            trails = {entry.trail_path(run): loop.trail for run, loop in entry.loops}
            views.append(loop_view(entry.path, f"{entry.mount}: kN over mm", width=entry.plot.width, trails=trails))
    return rrb.Horizontal(*views, name=f"{axis.capitalize()} loops")


def _acceleration_plot(overlay: Overlay, part: Component, direction: str) -> Any:
    which = "norm" if direction == TOTAL else direction
    title = (
        f"{part.label}: acceleration {which} [g]{_change(overlay.having(part), part_markers(overlay, part, direction))}"
    )
    return series_view(part_path(part, direction), title, overlay.shared.window)


def _mount_plot(overlay: Overlay, mount: str, quantity: str, axis: str) -> Any:
    change = _change(overlay.having(mount), mount_markers(overlay, mount, quantity, axis))
    title = f"{mount}: {axis} {quantity} [{UNITS[quantity][1]}]{change}"
    return series_view(overlaid_mount_path(mount, quantity, axis), title, overlay.shared.window)


def _difference_plot(overlay: Overlay, thing: Component | str) -> Any:
    first = overlay.having(thing)[0].name
    if isinstance(thing, str):
        title = f"{thing}: |deflection - that of {first}| [mm]"
    else:
        title = f"{thing.label}: |acceleration - that of {first}| [g]"
    return series_view(difference_path(thing), title, overlay.shared.window)


def _change(runs: list[OverlaidRun], markers: list[Marker]) -> str:
    """Return how the peaks change from the first run that has them to each other."""
    first = abs(markers[0].value)
    if not first:
        return ""
    changes = [abs(marker.value) / first - 1.0 for marker in markers[1:]]
    words = [f"{100.0 * change:+.1f} %" if change else "the same" for change in changes]
    return ": " + ", ".join(f"{run.name} {word}" for run, word in zip(runs[1:], words, strict=True))
