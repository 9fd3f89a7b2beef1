"""Scenes as pictures in files: the modelled geometry from above and from the side, drawn by matplotlib."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from wirerope_mj.content.blocks import SceneView
from wirerope_mj.content.panels import short
from wirerope_mj.content.scene_outline import DrawnScene, View, drawn_scene, mount_positions, outlines
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.views.colours import LIGHT, hexadecimal
from wirerope_mj.views.plots.plain_figure import PlainFigure

_DPI = 110  # of a picture [1/in]
_ROOM = 0.05  # around the drawing, of its width
_COLOURS = tuple(map(hexadecimal, LIGHT.series))
_RATED = hexadecimal(LIGHT.limit)
_MARKERS = "osD^vP"


def save_scenes(views: Sequence[SceneView], path: str | Path, *, title: str = "") -> None:
    """Write scenes as one PNG, whole or not at all: two beside each other, plan above elevation, empty places crossed."""
    rows, columns = (len(views) + 1) // 2, min(len(views), 2)
    figure = PlainFigure(figsize=(5.0 * columns, 4.4 * rows + 0.6), layout="constrained", dpi=_DPI)
    figure.suptitle(title, fontsize=12, fontweight="bold")
    panels = figure.subplots(2 * rows, columns, squeeze=False, height_ratios=(2, 1) * rows)
    for panel in panels.ravel():
        panel.set_visible(False)
    for place, view in enumerate(views):
        row, column = divmod(place, columns)
        for number, panel in enumerate(panels[2 * row : 2 * row + 2, column]):
            panel.set_visible(True)
            _draw_view(panel, view, number)
        panels[2 * row, column].set_title("\n".join(wrap(view.caption, 60)), fontsize=8)
        panels[2 * row + 1, column].set_title("")
    labels = {label: mark for panel in panels.ravel() for mark, label in zip(*panel.get_legend_handles_labels(), strict=True)}
    figure.legend(labels.values(), labels.keys(), loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(path, format="png")


def save_still(view: SceneView, path: str | Path, *, title: str = "") -> None:
    """Write the scene at an instant as one PNG, whole or not at all: plan and elevation beside each other."""
    figure = PlainFigure(figsize=(11.0, 6.5), layout="constrained", dpi=_DPI)
    figure.suptitle(title, fontsize=12, fontweight="bold")
    drawn = [drawn_scene(one) for one in (view.scene, view.moved) if one is not None]
    whole = replace(drawn[0], low=np.min([one.low for one in drawn], axis=0), high=np.max([one.high for one in drawn], axis=0))
    for number, panel in enumerate(figure.subplots(1, 2)):
        _draw_view(panel, view, number)
        side = drawn[0].views[number]
        bodies = view.moved.bodies if view.moved is not None else ()
        for mount in view.scene.mounts if bodies else ():
            ends = [
                side.seen(body.position + rotation_matrices(body.orientation) @ point)
                for name, point in ((mount.base_body, mount.base_point), (mount.payload_body, mount.payload_point))
                for body in bodies
                if body.name == name
            ]
            panel.plot(*np.transpose(ends), color="0.15", lw=1.5)
        _frame(panel, side, whole)
    figure.supxlabel("\n".join(wrap(view.caption, 150)), fontsize=8)
    figure.savefig(path, format="png")


def _draw_view(panel: Axes, block: SceneView, number: int) -> None:
    """Draw a scene from above (0) or the side (1): geometry, what is ringed, mounts as marks, named where none is absent."""
    scene, absent = block.scene, block.absent or ()
    drawn, positions = drawn_scene(scene), mount_positions(scene)
    view = drawn.views[number]
    for one, opacity in ((scene, 1.0),) if block.moved is None else ((scene, 0.3), (block.moved, 1.0)):
        shapes = outlines(drawn_scene(one), view)
        corners, colours = [shape.corners for shape in shapes], [shape.colour for shape in shapes]
        edges, widths = zip(*((_COLOURS[3], 1.2) if shape.flexible else ("0.55", 0.35) for shape in shapes), strict=True)
        panel.add_collection(PolyCollection(corners, facecolors=colours, edgecolors=edges, linewidths=widths, alpha=opacity))
    if block.ring is not None:
        at = block.ring[1]
        panel.plot(at[view.right], at[view.up], "o", ms=12, mfc="none", color=_RATED if block.exceeded else "0.25")
    if block.moved is None and block.absent is None:
        for name, position in positions.items():
            panel.annotate(
                short(name), (position[view.right], position[view.up]), xytext=(3, 3), textcoords="offset points", fontsize=5,
            )  # fmt: skip
    devices = list(dict.fromkeys(mount.isolator for mount in scene.mounts))
    for number, device in enumerate(devices):
        there = [mount.name for mount in scene.mounts if mount.isolator == device and mount.name not in absent]
        at = np.array([positions[name] for name in there]).reshape(-1, 3)
        style: Entries = {"marker": _MARKERS[number % len(_MARKERS)], "color": _COLOURS[number % len(_COLOURS)], "mec": "white"}
        panel.plot(at[:, view.right], at[:, view.up], ls="none", ms=5, mew=0.5, label=short(device), **style)
    empty = np.array([positions[mount.name] for mount in scene.mounts if mount.name in absent]).reshape(-1, 3)
    if len(empty):
        panel.plot(empty[:, view.right], empty[:, view.up], "x", color="0.35", ms=4, mew=0.8, label="no mount")
    _frame(panel, view, drawn)


def _frame(panel: Axes, view: View, drawn: DrawnScene) -> None:
    """Give a view equal scales, its title and its axes."""
    low, high = drawn.low, drawn.high
    room = _ROOM * max(high[view.right] - low[view.right], high[view.up] - low[view.up], 1e-3)
    panel.set_xlim(low[view.right] - room, high[view.right] + 2.0 * room)  # a label stands to the right of its mark
    panel.set_ylim(low[view.up] - room, high[view.up] + room)
    panel.set_aspect("equal")
    panel.set_title(view.title)
    panel.set_xlabel(f"{'xyz'[view.right]} [m]")
    panel.set_ylabel(f"{'xyz'[view.up]} [m]")
    panel.grid(color="0.93")
    panel.set_axisbelow(True)
