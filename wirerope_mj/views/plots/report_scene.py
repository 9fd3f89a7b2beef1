"""The modelled geometry as a drawing: seen from above and from the side, with the mounts."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from wirerope_mj.engine.response.scene import Geom, Scene, SceneBody, SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.rotation import rotation_matrices
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import COLOURS, WIDTH, report_style, short

LONGEST_LABEL = 5
"""Letters of a mount's name that fit beside its mark; where one is longer, all mounts are numbered."""

_AROUND = 16  # corners of a circle that is drawn as a polygon
_PALE = 0.62  # fraction of white in a body's colour, so that the mounts stand out
_COINCIDENT = 0.02  # of the drawing's width: mounts closer than this have one label
_ROOM = 0.05  # around the drawing, of its width
_TALLEST, _LOWEST = 2.9, 0.9  # height of one view [in]
_MARKERS = "osD^vP"


@dataclass(frozen=True)
class View:
    """A direction to look in: the world axes that run right and up in the drawing, and the one that comes out of it."""

    title: str
    right: int
    up: int
    towards: int
    sign: float  # of what comes towards the eye, along `towards`


def mount_labels(scene: Scene) -> dict[str, str]:
    """Return what mounts are called in the drawing: their names if these are short, or numbers in the order of the model."""
    short = all(len(mount.name) <= LONGEST_LABEL for mount in scene.mounts)
    return {mount.name: mount.name if short else str(number + 1) for number, mount in enumerate(scene.mounts)}


def scene_figure(scene: Scene) -> Figure:
    """Return a plan and an elevation, in which the longer horizontal extent runs to the right, with the mounts labelled."""
    shapes, positions, everything = _drawn(scene)
    extent = np.ptp(everything, axis=0)
    views = _views(extent)
    heights = [float(np.clip(WIDTH * extent[v.up] / max(extent[v.right], 1e-9), _LOWEST, _TALLEST)) for v in views]
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, sum(heights) + 1.7), layout="constrained")
        panels = figure.subplots(2, 1, height_ratios=[height + 0.3 for height in heights])
        for view, panel in zip(views, panels, strict=True):
            _draw_shapes(panel, view, shapes)
            _draw_mounts(panel, view, scene, positions)
            _frame(panel, view, everything)
        handles, labels = panels[0].get_legend_handles_labels()
        if handles:
            figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    return figure


def draw_plan(panel: Any, scene: Scene, *, absent: Collection[str] = ()) -> None:
    """Draw a scene from above into a panel, its mounts as marks without names; of those that are absent the empty position.

    Args:
        panel: where it is drawn.
        scene: what is drawn.
        absent: names of mounts that are not there.
    """
    shapes, positions, everything = _drawn(scene)
    view = _views(np.ptp(everything, axis=0))[0]
    _draw_shapes(panel, view, shapes)
    devices = list(dict.fromkeys(mount.isolator for mount in scene.mounts))
    for number, device in enumerate(devices):
        there = [mount.name for mount in scene.mounts if mount.isolator == device and mount.name not in absent]
        at = np.array([positions[name] for name in there]).reshape(-1, 3)
        style = {"marker": _MARKERS[number % len(_MARKERS)], "color": COLOURS[number % len(COLOURS)], "mec": "white"}
        panel.plot(at[:, view.right], at[:, view.up], ls="none", ms=5, mew=0.5, label=short(device), **style)
    empty = np.array([positions[mount.name] for mount in scene.mounts if mount.name in absent]).reshape(-1, 3)
    if len(empty):
        panel.plot(empty[:, view.right], empty[:, view.up], "x", color="0.35", ms=4, mew=0.8, label="no mount")
    _frame(panel, view, everything)


def crowded_label(scene: Scene) -> tuple[str, int] | None:
    """Return the first label in the drawing that stands for more mounts than it names, as "m1 +2", and for how many."""
    _, positions, everything = _drawn(scene)
    for view in _views(np.ptp(everything, axis=0)):
        for _, names in _groups(scene, view, positions):
            if len(names) > 2:
                return _shared(names), len(names)
    return None


def mount_position(scene: Scene, mount: SceneMount) -> Array:
    """Return the position of a mount in the modelled geometry, world frame [m], (3,)."""
    body = next(body for body in scene.bodies if body.name == mount.base_body)
    return np.asarray(body.position + rotation_matrices(body.orientation) @ mount.base_point)


def axial_direction(scene: Scene, mount: SceneMount) -> Array:
    """Return a mount's axial direction in the world frame of the modelled geometry, (3,)."""
    body = next(body for body in scene.bodies if body.name == mount.base_body)
    return np.asarray(rotation_matrices(body.orientation) @ mount.axes[:, 2])


def _drawn(scene: Scene) -> tuple[list[tuple[SceneBody, Geom, Array]], dict[str, Array], Array]:
    """Return the shapes with their points, the positions of the mounts by name, and all of these points, (n, 3)."""
    shapes = [
        (body, geom, _points(body, geom)) for body in scene.bodies for geom in body.geoms if geom.shape != "plane"
    ]
    positions = {mount.name: mount_position(scene, mount) for mount in scene.mounts}
    everything = np.concatenate([*(points for *_, points in shapes), *(at[None] for at in positions.values())])
    return shapes, positions, everything


def _views(extent: Array) -> list[View]:
    return [View("from above", 0, 1, 2, 1.0), _elevation(extent)]


def _elevation(extent: Array) -> View:
    """Return the view from the side that shows the longer horizontal extent."""
    if extent[1] > extent[0]:
        return View("from the front, along -x", 1, 2, 0, 1.0)
    return View("from the side, along +y", 0, 2, 1, -1.0)


def _draw_shapes(panel: Any, view: View, shapes: Sequence[tuple[SceneBody, Geom, Array]]) -> None:
    """Draw the outlines of all geoms, what is nearer over what is behind it."""
    nearer = sorted(shapes, key=lambda entry: float((view.sign * entry[2][:, view.towards]).max()))
    outlines, colours = [], []
    for body, geom, points in nearer:
        outlines.append(_outline(points[:, [view.right, view.up]]))
        paint = np.array([0.86, 0.88, 0.90]) if body.on_base or not body.moves else geom.rgba[:3]
        colours.append((*(_PALE + (1.0 - _PALE) * paint), max(float(geom.rgba[3]), 0.15)))
    panel.add_collection(PolyCollection(outlines, facecolors=colours, edgecolors="0.55", linewidths=0.35))


def _draw_mounts(panel: Any, view: View, scene: Scene, positions: dict[str, Array]) -> None:
    """Draw a mark for every mount, another for each isolator, and what they are called."""
    devices = list(dict.fromkeys(mount.isolator for mount in scene.mounts))
    for number, device in enumerate(devices):
        at = np.array([positions[mount.name] for mount in scene.mounts if mount.isolator == device])
        marker, colour = _MARKERS[number % len(_MARKERS)], COLOURS[number % len(COLOURS)]
        panel.plot(
            at[:, view.right], at[:, view.up], marker, color=colour, ms=5, mec="white", mew=0.5, label=short(device)
        )
    halo = [withStroke(linewidth=1.8, foreground="white")]
    for (x, y), names in _groups(scene, view, positions):
        panel.annotate(
            _shared(names),
            (float(x), float(y)),
            xytext=(3.5, 3.5),
            textcoords="offset points",
            fontsize=6.5,
            color="0.1",
            path_effects=halo,
        )


def _groups(scene: Scene, view: View, positions: dict[str, Array]) -> list[tuple[Array, list[str]]]:
    """Return positions in the drawing with the labels of the mounts that stand behind each other there."""
    labels = mount_labels(scene)
    spread = float(np.ptp([position[view.right] for position in positions.values()])) if positions else 0.0
    groups: list[tuple[Array, list[str]]] = []
    for mount in scene.mounts:
        at = positions[mount.name][[view.right, view.up]]
        near = next((names for there, names in groups if np.abs(at - there).max() <= _COINCIDENT * spread), None)
        if near is None:
            groups.append((at, [labels[mount.name]]))
        else:
            near.append(labels[mount.name])
    return groups


def _shared(names: list[str]) -> str:
    """Return one label for mounts behind each other: "m1, m2", or "m1 +2" for three."""
    return ", ".join(names) if len(names) < 3 else f"{names[0]} +{len(names) - 1}"


def _frame(panel: Any, view: View, everything: Array) -> None:
    """Give a view equal scales, its title and its axes."""
    low, high = everything.min(axis=0), everything.max(axis=0)
    room = _ROOM * max(high[view.right] - low[view.right], high[view.up] - low[view.up], 1e-3)
    panel.set_xlim(low[view.right] - room, high[view.right] + 2.0 * room)  # a label stands to the right of its mark
    panel.set_ylim(low[view.up] - room, high[view.up] + room)
    panel.set_aspect("equal")
    panel.set_title(view.title)
    panel.set_xlabel(f"{'xyz'[view.right]} [m]")
    panel.set_ylabel(f"{'xyz'[view.up]} [m]")
    panel.grid(color="0.93")
    panel.set_axisbelow(True)


def _points(body: SceneBody, geom: Geom) -> Array:
    """Return points whose convex hull is the geom, world frame of the modelled geometry [m], (n, 3)."""
    local = _local_points(geom) @ rotation_matrices(geom.orientation).T + geom.position
    return np.asarray(local @ rotation_matrices(body.orientation).T + body.position)


def _local_points(geom: Geom) -> Array:
    if geom.shape == "mesh":
        return geom.vertices
    if geom.shape == "box":
        return np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * geom.size
    radius = geom.size[0]
    if geom.shape == "cylinder":
        return np.concatenate([_ring(radius, -geom.size[1]), _ring(radius, geom.size[1])])
    ball = np.concatenate([_ring(np.sin(polar), np.cos(polar)) for polar in np.linspace(0.0, np.pi, 9)])
    if geom.shape == "ellipsoid":
        return ball * geom.size
    if geom.shape == "capsule":
        return np.concatenate([radius * ball + [0.0, 0.0, end] for end in (-geom.size[1], geom.size[1])])
    return radius * ball


def _ring(radius: float, height: float) -> Array:
    angle = np.linspace(0.0, 2.0 * np.pi, _AROUND, endpoint=False)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(_AROUND, height)], axis=1)


def _outline(points: Array) -> Array:
    """Return the corners of the convex hull in the plane, in order; of what is flat, the points themselves."""
    try:
        return np.asarray(points[scipy.spatial.ConvexHull(points).vertices])
    except scipy.spatial.QhullError:
        return points
