"""Layout of the viewer, the same for one run and for several: the answer above scenes and tabs, texts and events below."""

from collections.abc import Sequence

import numpy as np
import rerun.blueprint as rrb

from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.histories import TOTAL
from wirerope_mj.content.scene_outline import mount_positions
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.banner import banner_view
from wirerope_mj.views.recording.camera import Camera, scene_extent, whole_scene
from wirerope_mj.views.recording.drawn_runs import BANNER, BELOW, Drawn, DrawnRun
from wirerope_mj.views.recording.ghosts import ROOT as GHOSTS
from wirerope_mj.views.recording.loops import LoopPlot, grid_shape
from wirerope_mj.views.recording.now import CURSOR, PLAN, plan_bounds
from wirerope_mj.views.recording.panels import lane_paths, over_frequency_view, panel_view
from wirerope_mj.views.recording.paths import entity
from wirerope_mj.views.recording.scene import BESIDE, close_up_of
from wirerope_mj.views.recording.views import (
    GROUND,
    Pane,
    event_view,
    fitting_width,
    layout,
    loop_view,
    scene_view,
    tabs_with,
    time_axis,
)

_SCENES = (870.0, 720.0)  # Width and height of the pane of the scenes on a full-HD screen [points]
_TABS = (1040.0, 700.0)  # The same of the tabs beside them, without their titles
_LOW, _BESIDE_PLAN = 3.1, 1.85  # Width over height of the pane of the close-up alone, and beside the plan


def blueprint_of(drawn: Drawn, plots: Sequence[LoopPlot], factor: float, *, tab: str, scene: str) -> rrb.Blueprint:
    """Lay out a recording with `tab` and `scene` in front, the first scene without one; `factor` enlarges the ghosts' motion.

    ValueError if there is no such tab or scene.
    """
    scenes = _scenes(drawn, factor)
    left: rrb.Container = tabs_with(scenes, "scene", scene or str(scenes[0].name))
    if (run := drawn.alone) is not None and (governing := drawn.shared.governing) is not None:
        with_plan = bool(drawn.shared.used)
        below_scene: Pane = _close_up(run, governing, aspect=_BESIDE_PLAN if with_plan else _LOW, listed=drawn.listed)
        if with_plan:
            across, upward = plan_bounds(run.response)
            bounds = rrb.VisualBounds2D(x_range=across, y_range=upward)
            name = "Mounts from above, % used now"
            plan = rrb.Spatial2DView(origin=entity(PLAN), name=name, background=GROUND, visual_bounds=bounds)
            below_scene = rrb.Horizontal(below_scene, plan, column_shares=[3, 2])
        left = rrb.Vertical(left, below_scene, row_shares=[3, 2])
    top = rrb.Horizontal(left, tabs_with(_tabs(drawn, plots), "tab", tab), column_shares=[5, 6], name="run")
    banner = banner_view(drawn.answer[1], [_text(text.path, text.name) for text in drawn.texts if text.place == BANNER])
    texts = [_text(text.path, text.name) for text in drawn.texts if text.place == BELOW]
    texts = [*([_text((CURSOR,), "At the time cursor")] if drawn.alone else []), *texts]
    below = rrb.Horizontal(rrb.Tabs(*texts, active_tab=0), event_view(entity("events")), column_shares=[5, 6])
    return layout(rrb.Vertical(banner, top, below, row_shares=[9.5, 74.0, 16.5]), drawn.shared.window, listed=drawn.listed)


def loop_widths(drawn: Drawn) -> dict[str, float]:
    """Find the width of the frames of loops by axis, from the number of loops that share the pane."""
    shared = drawn.shared
    return {axis: fitting_width(_TABS, *grid_shape(len(shared.shown(axis)))) for axis in shared.axes}


def _text(path: tuple[str, ...], name: str) -> rrb.TextDocumentView:
    return rrb.TextDocumentView(origin=entity(*path), name=name)


def _scenes(drawn: Drawn, factor: float) -> list[Pane]:
    """List the scenes: of a run alone enlarged and to scale; of several worst mount, side by side, ghosts."""
    larger = f", motion drawn {factor:g} times larger" if factor > 1.0 else ""
    largest = max(drawn.runs, key=lambda run: scene_extent(run.response.scene)[1])
    below = entity(GHOSTS)
    if (run := drawn.alone) is not None:
        camera = whole_scene(run.response, mount=drawn.shared.governing)
        name = "Motion enlarged" if drawn.listed else f"Motion drawn {factor:g} times larger"
        enlarged = [scene_view(below + _origin(run), [f"+ {below}/**"], name, camera)] if factor > 1.0 else []
        return [*enlarged, _scene(run, "True scale", camera)]
    columns = 1 if len(drawn.runs) <= 3 else 2
    aspect = _SCENES[0] / columns / (_SCENES[1] / -(-len(drawn.runs) // columns))
    whole = [
        _scene(run, f"{run.name}: {run.response.scene.name}", whole_scene(run.response, aspect=aspect)) for run in drawn.runs
    ]
    names = " and ".join(run.name for run in drawn.runs)
    camera = whole_scene(largest.response)
    ghosts = scene_view(below, [f"+ {below}/**"], f"{names}, seen from their bases{larger}", camera)
    scenes = [rrb.Grid(*whole, grid_columns=columns, name="Side by side"), rrb.Vertical(ghosts, name="Ghosts")]
    mount = drawn.shared.governing
    if mount is not None:
        having = drawn.having(mount)
        near = [_close_up(run, mount, aspect=aspect, like=having[0]) for run in having]
        scenes.insert(0, rrb.Grid(*near, grid_columns=columns, name="Worst mount"))
    return scenes


def _origin(run: DrawnRun) -> str:
    """Find the entity in whose frame the scene of a run is seen: its base, else the world."""
    base = run.response.scene.base
    return run.frames[base].path if base in run.response.bodies else entity("world")


def _scene(run: DrawnRun, name: str, camera: Camera, without: Sequence[str] = ()) -> rrb.Spatial3DView:
    contents = [f"+ {run.root}{entity('world')}/**", *(f"- {run.root}{path}" for path in without)]
    return scene_view(run.root + _origin(run), contents, name, camera)


def _close_up(
    run: DrawnRun, mount: str, *, aspect: float, like: DrawnRun | None = None, listed: bool = False
) -> rrb.Spatial3DView:
    """View a mount closely, as that of the run `like` is if it stands at the same place."""
    bodies = dict.fromkeys(body for m in run.response.scene.mounts for body in (m.base_body, m.payload_body))
    hidden = [f"{run.frames[body].path}/{beside}/**" for body in bodies for beside in BESIDE]
    worst = by_use(run.selection.verdicts).get(mount)
    used = f", {worst.criterion} {in_unit(worst.utilisation or 0.0, '%'):.0f} %" if worst and not listed else ""
    name = ": ".join(filter(None, (run.name, f"Mount {mount}{used}")))
    here, there = (mount_positions(shown.response.scene)[mount] for shown in (run, like or run))
    seen = like if like is not None and np.allclose(here, there, atol=1e-3) else run
    return _scene(run, name, close_up_of(seen.response, mount, aspect=aspect), hidden)


def _tabs(drawn: Drawn, plots: Sequence[LoopPlot]) -> list[Pane]:
    """List the tabs: overview, histories by quantity, loops by axis, and texts."""
    tabs: list[Pane] = [_overview(drawn)]
    for quantity in ("acceleration", "deflection", "force", "contact", "measured"):
        title = "Measured" if quantity == "measured" else f"{quantity.capitalize()}s"
        keys: dict[str, list[tuple[str, ...]]] = {}
        for key in drawn.panels:
            if key[0] == quantity and not (drawn.alone and key[1] == TOTAL):
                keys.setdefault(key[1], []).append(key)
        stacked = all(len(members) == 1 for members in keys.values())
        along: dict[str, list[Pane]] = {}
        for name, members in keys.items():
            columns = min(2, len(members))
            rows = len(keys) if stacked else -(-len(members) // columns)
            along[name] = [_view(drawn, key, (_TABS[0] / columns, _TABS[1] / rows)) for key in members]
        if stacked:
            tabs += [rrb.Vertical(*(views[0] for views in along.values()), name=title)] if along else []
        else:
            ordered = sorted(along, key=lambda direction: direction != TOTAL)
            grids = [rrb.Grid(*along[name], grid_columns=min(2, len(along[name])), name=name) for name in ordered]
            tabs.append(rrb.Tabs(*grids, active_tab=0, name=title))
    for axis in drawn.shared.axes:
        views = []
        for plot in (plot for plot in plots if plot.axis == axis):
            ratio = drawn.shared.utilisation(plot.mount, plot.axis)
            without_ratio = np.isnan(ratio) or not drawn.alone or drawn.listed
            name = f"{plot.mount}: kN over mm{'' if without_ratio else f', {100 * ratio:.0f} % of rated travel'}"
            views.append(loop_view(plot.path, name, width=plot.plot.width, trails=plot.trails))
        tabs.append(rrb.Grid(*views, grid_columns=grid_shape(len(views))[0], name=f"{axis.capitalize()} loops"))
    places = dict.fromkeys(text.place for text in drawn.texts if text.place not in (BANNER, BELOW))
    for place in places:
        texts = [_text(text.path, text.name) for text in drawn.texts if text.place == place]
        tabs.append(texts[0] if len(texts) == 1 else rrb.Tabs(*texts, active_tab=0, name=place))
    return tabs


def _overview(drawn: Drawn) -> rrb.Container:
    """Compose the first tab: of one run utilisation, spectra and lanes (states over time); of several the differences."""
    keys = drawn.overview
    if (run := drawn.alone) is None:
        columns = 1 if len(keys) <= 3 else 2
        size = _TABS[0] / columns, _TABS[1] / -(-len(keys) // columns)
        return rrb.Grid(*(_view(drawn, key, size) for key in keys), grid_columns=columns, name="Overview")
    lanes = lane_paths(run.response, run.selection)
    below = _LANES + _LANE * len(lanes)
    spectra = _SPECTRA * (_TABS[1] - below) if drawn.over_frequency is not None else 0.0
    size = _TABS[0], (_TABS[1] - below - spectra) / max(len(keys), 1)
    views: list[rrb.View] = [_view(drawn, key, size) for key in keys]
    shares = [size[1]] * len(keys)
    if drawn.over_frequency is not None:
        views.append(over_frequency_view(drawn.over_frequency, listed=drawn.listed))
        shares.append(spectra)
    name, window = "Base, stops, use of limits [%]", time_axis(drawn.shared.window, _TABS[0])
    views.append(rrb.StateTimelineView(origin=entity(), contents=lanes, name=name, time_view=window))
    return rrb.Vertical(*views, row_shares=[*shares, below], name="Overview")


_LANES, _LANE = 52.0, 37.0  # Heights of title and axis of the lanes, and of a lane [points]
_SPECTRA = 0.42  # of the height above the lanes, for the panel over frequency


def _view(drawn: Drawn, key: tuple[str, ...], size: tuple[float, float]) -> rrb.View:
    return panel_view(entity("histories", *key), drawn.panels[key], drawn.shared.window, size, listed=drawn.listed)
