"""A model from tables as a dimensioned plan and side view."""

import warnings
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib import font_manager
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ft2font import FT2Font
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from wirerope_mj.engine.from_tables import Layout, Mass
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.views.plots.letters import FAMILY, brought_fonts, fonts_for

_VIEWS = (("plan", 0, 1), ("side view", 0, 2), ("end view", 1, 2))
_MOUNT, _STOP, _POINT, _BODY = "#b2182b", "#d95f0e", "#1b7837", "#33648a"
_MILLI = 1e3


def save_plan(layout: Layout, path: Path) -> None:
    """Write plan, side and end view in mm: mounts with their directions, stops, points, masses, dimensions.

    The path's ending says in which format. Every text is shown as it is, whatever is in a name.
    """
    drawn = BytesIO()  # first: on a full disk matplotlib's writers end with errors of their own
    with matplotlib.rc_context({"svg.hashsalt": "wirerope", "pdf.fonttype": 42}), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")  # `fonts_for` has said so
        _figure(layout).savefig(drawn, format=path.suffix[1:], dpi=150)
    with atomic_file(path) as temporary:
        temporary.write_bytes(drawn.getvalue())


def _figure(layout: Layout) -> Figure:
    """Return the drawing, laid out."""
    figure = Figure(figsize=(11.7, 8.3), layout="constrained")  # A4, lying
    figure.suptitle(f"{layout.name}: {layout.payload.mass:.6g} kg on {len(layout.mounts)} mounts, dimensions in mm")
    panels: dict[str, Axes] = figure.subplot_mosaic([["plan", "key"], ["side view", "end view"]], width_ratios=(1.6, 1.0))
    labels = {title: _draw(panels[title], layout, across, up) for title, across, up in _VIEWS}
    for title in labels:
        panels[title].set_title(title)
    _write_key(panels["key"], layout)
    for text in figure.findobj(Text):  # a dollar sign in a name begins no formula
        text.set_parse_math(False)
        text.set_text(plain_lines(text.get_text()))
    families = [FAMILY]
    for path in fonts_for("\n".join(text.get_text() for text in figure.findobj(Text)))[len(brought_fonts()) :]:
        font_manager.fontManager.addfont(path)
        families.append(FT2Font(path).family_name)
    for text in figure.findobj(Text):
        text.set_fontfamily(families)
    figure.draw_without_rendering()
    for title, texts in labels.items():
        _apart(panels[title], texts)
    return figure


def _draw(panel: Any, layout: Layout, across: int, up: int) -> list[Text]:
    """Draw a view; return its labels, those that stay where they are first."""
    pick = [across, up]
    labels = [_draw_mass(panel, mass, pick) for mass in layout.masses]
    for box in layout.envelope:
        (x, y), lengths = _MILLI * (box.centre - 0.5 * box.size)[pick], _MILLI * box.size[pick]
        panel.add_patch(Rectangle((x, y), *lengths, fill=False, edgecolor=_BODY, linestyle="--"))
    reach = _MILLI * np.ptp([mount.position for mount in layout.mounts], axis=0).max() or 100.0
    labelled: dict[tuple[int, ...], list[str]] = {}
    for mount in layout.mounts:
        position, axial = _MILLI * mount.position[pick], 0.12 * reach * mount.axes[2][pick]
        panel.plot(*position, "s", color=_MOUNT, markersize=5)
        panel.annotate("", position + axial, position, arrowprops={"arrowstyle": "->", "color": _MOUNT})
        aside = -11 if axial[1] >= 0.0 else 5  # points: on the side where the arrow is not
        labelled.setdefault((*np.rint(position).astype(int).tolist(), aside), []).append(mount.name)
    for stop in layout.stops:
        position = _MILLI * stop.position[pick]
        panel.plot(*position, "o", color=_STOP, markersize=5, fillstyle="none")
    for (x, y, aside), names in labelled.items():
        text, where = _listed(names), {"xytext": (4, aside), "textcoords": "offset points"}
        labels.append(panel.annotate(text, (x, y), fontsize=8, color=_MOUNT, **where))
    for point in (*layout.points, *layout.forces):
        position = _MILLI * point.position[pick]
        panel.plot(*position, "+", color=_POINT, markersize=9)
        where = {"xytext": (5, 3), "textcoords": "offset points"}
        labels.append(panel.annotate(point.name, position, fontsize=7, color=_POINT, **where))
    centre = _MILLI * layout.payload.centre[pick]
    panel.plot(*centre, marker="o", color="black", markersize=9, fillstyle="left", markerfacecoloralt="white")
    _dimension(panel, layout, across, up)
    panel.set_aspect("equal", adjustable="datalim")
    panel.margins(0.15)
    panel.set_xlabel(f"{'xyz'[across]} [mm]")
    panel.set_ylabel(f"{'xyz'[up]} [mm]")
    panel.grid(alpha=0.25)
    return labels


def _apart(panel: Axes, labels: list[Any]) -> None:
    """Put each label on that side of what it names on which it covers the least of labels and marks, and of the frame."""
    taken: list[Bbox] = []
    for line in panel.lines:
        half = 0.5 * line.get_markersize() * panel.figure.dpi / 72.0
        taken += [Bbox([at - half, at + half]) for at in panel.transData.transform(line.get_xydata())]
    frame = panel.get_window_extent()
    for label in labels:
        sides = [(label.get_position(), "left")]
        sides += [((x, y), "left" if x > 0 else "right") for y in (3, -10, -21, 14) for x in (5, -5)]
        covered = []
        for position, side in sides:
            label.set(position=position, horizontalalignment=side)
            box = label.get_window_extent()
            shared = (Bbox.intersection(box, other) for other in taken)
            beyond = max(frame.x0 - box.x0, 0.0) + max(box.x1 - frame.x1, 0.0)
            covered.append(sum(one.width * one.height for one in shared if one is not None) + beyond * box.height)
        position, side = sides[int(np.argmin(covered))]
        label.set(position=position, horizontalalignment=side)
        taken.append(label.get_window_extent())


def _draw_mass(panel: Axes, mass: Mass, pick: list[int]) -> Text:
    """Draw the uniform box that has a mass's moments of inertia, and its name, which is returned."""
    properties = mass.properties
    moments = np.diag(properties.inertia)
    lengths = _MILLI * np.sqrt(np.maximum(6.0 * (moments.sum() - 2.0 * moments) / properties.mass, 0.0))
    centre = _MILLI * properties.centre
    x, y = centre[pick] - 0.5 * lengths[pick]
    panel.add_patch(Rectangle((x, y), *lengths[pick], color=_BODY, alpha=0.18))
    corner = (x, y + lengths[pick][1])
    return panel.annotate(mass.name, corner, xytext=(3, -9), textcoords="offset points", fontsize=7, color=_BODY)


def _dimension(panel: Axes, layout: Layout, across: int, up: int) -> None:
    """Draw chains of dimensions between the mounts' positions along both axes, beyond the outermost of what is drawn."""
    positions = _MILLI * np.array([mount.position for mount in layout.mounts])
    centre = _MILLI * layout.payload.centre
    low = np.minimum(positions.min(axis=0), centre)
    span = max(float(np.ptp(np.vstack([positions, centre]), axis=0).max()), 100.0)
    below, left = low[up] - 0.22 * span, low[across] - 0.30 * span
    for first, second in _gaps(positions[:, across], centre[across]):
        _arrow(panel, (first, below), (second, below), second - first, 0)
    for first, second in _gaps(positions[:, up], centre[up]):
        _arrow(panel, (left, first), (left, second), second - first, 90)


def _gaps(values: Array, centre: float) -> list[tuple[float, float]]:
    """Return neighbours of the distinct coordinates of mounts and centre of mass, 1 mm apart or more."""
    marks: list[float] = []
    for value in sorted([*values, centre]):
        if not marks or value - marks[-1] >= 1.0:
            marks.append(float(value))
    return list(zip(marks, marks[1:], strict=False))


def _arrow(panel: Axes, start: tuple[float, float], end: tuple[float, float], length: float, turned: int) -> None:
    panel.annotate("", end, start, arrowprops={"arrowstyle": "<->", "linewidth": 0.7, "shrinkA": 0, "shrinkB": 0})
    panel.plot(*zip(start, end, strict=True), marker="|" if turned == 0 else "_", color="black", linewidth=0)
    middle = (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]))
    offset = (0, 3) if turned == 0 else (3, 0)  # towards the drawing: beyond the line the panel may end
    panel.annotate(
        f"{length:.0f}", middle, xytext=offset, textcoords="offset points", fontsize=7, rotation=turned,
        ha="center" if turned == 0 else "left", va="bottom" if turned == 0 else "center",
    )  # fmt: skip


def _write_key(panel: Axes, layout: Layout) -> None:
    payload = layout.payload
    i = payload.inertia
    x, y, z = _MILLI * payload.centre
    kinds: dict[str, list[str]] = {}
    for placed in (*layout.mounts, *layout.stops):
        kinds.setdefault(placed.isolator, []).append(placed.name)
    lines = [
        f"mass {payload.mass:.6g} kg", f"centre of mass x {x:.1f}, y {y:.1f}, z {z:.1f} mm",
        f"inertia about it [kg m^2]: xx {i[0, 0]:.5g}, yy {i[1, 1]:.5g}, zz {i[2, 2]:.5g}",
        f"   xy {i[0, 1]:.4g}, xz {i[0, 2]:.4g}, yz {i[1, 2]:.4g} (of the tensor)", "",
        *(f"{isolator}: {_listed(names)}" for isolator, names in kinds.items()), "",
        "red: mounts, arrow from the base to the payload; orange: stops",
        "green: points, and where forces act; blue: boxes of the masses' inertia, dashed the envelope",
        "half-filled circle: centre of mass",
    ]  # fmt: skip
    panel.text(0.0, 1.0, "\n".join(lines), va="top", fontsize=8, transform=panel.transAxes)
    panel.set_axis_off()


def _listed(names: list[str]) -> str:
    return ", ".join(names) if len(names) <= 8 else f"{', '.join(names[:7])} and {len(names) - 7} more"
