"""A model from tables as a dimensioned drawing: plan, side and end view in one scale, and a key."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from textwrap import wrap

import numpy as np

from wirerope_mj.engine.from_tables import Layout
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.views.colours import LIGHT, hexadecimal
from wirerope_mj.views.pictures import save_svg
from wirerope_mj.views.plots.scene_svg import Box, covered_area
from wirerope_mj.views.plots.svg_chart import number_text, safe_text

_MILLI = 1e3
_WIDTH, _PART = 1040.0, 0.6  # width of the drawing, and fraction of it for the plan
_LEFT, _RIGHT, _TOP, _BOTTOM = 74.0, 14.0, 26.0, 44.0  # margins of the frame of a view, without dimensions
_TALLEST = 430.0  # height of a frame
_LEVEL = 11.0  # distance of dimensions below each other
_LETTER = 0.58  # mean width of a letter over its height
_KEY = 60  # letters of a line of the key
_INK, _FRAME, _GRID, _GROUND = (hexadecimal(part) for part in (LIGHT.heading, LIGHT.frame, LIGHT.line, LIGHT.ground))
_MOUNT, _STOP, _POINT, _BODY = map(hexadecimal, (LIGHT.mount[0], LIGHT.mount[1], LIGHT.payload[1], LIGHT.payload[0]))


def save_plan(layout: Layout, path: Path) -> None:
    """Write the drawing as .svg, .png or .pdf by the path's suffix; names are escaped."""
    svg, height = plan_svg(layout)
    save_svg(svg, (_WIDTH, height), path)


def plan_svg(layout: Layout) -> tuple[str, float]:
    """Draw mounts with their directions, stops, points, masses and dimensions in mm; return the drawing and its height."""
    ends = [_MILLI * placed.position for placed in (*layout.mounts, *layout.stops)] + [_MILLI * layout.payload.centre]
    ends += [_MILLI * point.position for point in (*layout.points, *layout.forces)]
    for centre, size in [(box.centre, box.size) for box in layout.envelope] + [
        (mass.properties.centre, mass.properties.box) for mass in layout.masses
    ]:
        ends += [_MILLI * (centre - 0.5 * size), _MILLI * (centre + 0.5 * size)]
    low, high = np.min(ends, axis=0), np.max(ends, axis=0)
    room = 0.1 * max(float((high - low).max()), 100.0)
    low, high = low - room, high + room
    extent = high - low
    frames = _WIDTH * np.array([_PART, 1.0 - _PART]) - _LEFT - _RIGHT
    scale = min(frames[0] / extent[0], frames[1] / extent[1], _TALLEST / extent[1], _TALLEST / extent[2])
    views, y = [], 34.0
    for row in ((("plan", 0, 1),), (("side view", 0, 2), ("end view", 1, 2))):
        drawn = [_view(layout, title, across, up, low, high, scale) for title, across, up in row]
        views += [
            f'<g transform="translate({column * _PART * _WIDTH:.1f} {y:.1f})">{part}</g>'
            for column, (part, _) in enumerate(drawn)
        ]
        y += max(height for _, height in drawn)
    key, bottom = _key(layout)
    title = f"{layout.name}: {layout.payload.mass:.6g} kg on {len(layout.mounts)} mounts, dimensions in mm"
    height = max(y, bottom + 34.0)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {height:.1f}" width="{_WIDTH:g}" '
        f'height="{height:.1f}" font-family="Helvetica, Arial, sans-serif" font-size="10" fill="{_INK}">'
        f'<text x="{0.5 * _WIDTH:g}" y="20" text-anchor="middle" font-size="14" font-weight="bold">{safe_text(title)}</text>'
        f'{"".join(views)}<g transform="translate({_PART * _WIDTH:.1f} 34)">{key}</g></svg>',
        height,
    )


def _view(layout: Layout, title: str, across: int, up: int, low: Array, high: Array, scale: float) -> tuple[str, float]:
    """Draw a view with its labels and dimensions; return it and its height."""
    pick = [across, up]
    corner, size = low[pick], scale * (high - low)[pick]

    def place(position: Array) -> Array:
        x, y = scale * (_MILLI * position[pick] - corner)
        return np.array([x, size[1] - y])

    parts, named = [*_axes(title, across, up, corner, size, scale)], list[tuple[Array, float, str, str]]()
    occupied: list[Box] = []
    for box in layout.envelope:
        parts.append(_rectangle(place, box.centre, box.size, 'fill="none" stroke-dasharray="5 3"'))
    for mass in layout.masses:
        uniform = mass.properties.box
        parts.append(_rectangle(place, mass.properties.centre, uniform, f'fill="{_BODY}" fill-opacity="0.12"'))
        corners = [place(mass.properties.centre + 0.5 * sign * uniform) for sign in (-1.0, 1.0)]
        named.append((np.minimum(*corners) + (1.0, 10.0), 0.0, mass.name, _BODY))
    reach = _MILLI * float(np.ptp([mount.position for mount in layout.mounts], axis=0).max()) or 100.0
    coincident: dict[tuple[int, ...], list[str]] = {}
    for mount in layout.mounts:
        x, y = at = place(mount.position)
        tip = at + 0.12 * scale * reach * mount.axes[2][pick] * (1.0, -1.0)
        parts.append(_arrow(at, tip))
        occupied.append((*np.minimum(at, tip).tolist(), *np.maximum(at, tip).tolist()))
        parts.append(f'<rect x="{x - 3:.1f}" y="{y - 3:.1f}" width="6" height="6" fill="{_MOUNT}"/>')
        occupied.append((x - 4.0, y - 4.0, x + 4.0, y + 4.0))
        coincident.setdefault(tuple(np.rint(at).astype(int).tolist()), []).append(mount.name)
    for stop in layout.stops:
        x, y = place(stop.position)
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="none" stroke="{_STOP}" stroke-width="1.4"/>')
        occupied.append((x - 4.0, y - 4.0, x + 4.0, y + 4.0))
    for point in (*layout.points, *layout.forces):
        x, y = at = place(point.position)
        parts.append(f'<path d="M{x - 4:.1f} {y:.1f}h8m-4-4v8" stroke="{_POINT}" stroke-width="1.4"/>')
        occupied.append((x - 4.0, y - 4.0, x + 4.0, y + 4.0))
        named.append((at, 5.0, point.name, _POINT))
    x, y = place(layout.payload.centre)
    parts.append(_centre_mark(x, y))
    occupied.append((x - 6.0, y - 6.0, x + 6.0, y + 6.0))
    named += [(np.array(at, dtype=np.float64), 5.0, _listed(names), _MOUNT) for at, names in coincident.items()]
    parts += _labels(named, occupied, size)
    coordinates = _MILLI * np.array([mount.position for mount in layout.mounts] + [layout.payload.centre])
    below, depth = _dimensions(coordinates[:, across], corner[0], scale, outwards=_LEVEL)
    aside, _ = _dimensions(coordinates[:, up], corner[1], scale, outwards=-_LEVEL)
    parts.append(f'<g transform="translate(0 {size[1] + 28.0:.1f})">{below}</g>')
    parts.append(f'<g transform="translate(-40 {size[1]:.1f}) rotate(-90)">{aside}</g>')
    return f'<g transform="translate({_LEFT:g} {_TOP:g})">{"".join(parts)}</g>', _TOP + size[1] + _BOTTOM + depth


def _axes(title: str, across: int, up: int, corner: Array, size: Array, scale: float) -> Iterator[str]:
    """Yield the frame of a view with its grid, numbers and title."""
    yield f'<text y="-8" font-weight="bold">{title}: {"xyz"[up]} over {"xyz"[across]} [mm]</text>'
    columns, rows = (
        linear_ticks(corner[n], corner[n] + size[n] / scale, most=max(2, int(size[n] / (48.0, 34.0)[n]))) for n in (0, 1)
    )
    for tick in columns:
        x = scale * (tick - corner[0])
        yield f'<path d="M{x:.1f} 0v{size[1]:.1f}" stroke="{_GRID}"/>'
        yield f'<text x="{x:.1f}" y="{size[1] + 12:.1f}" text-anchor="middle">{number_text(tick)}</text>'
    for tick in rows:
        y = size[1] - scale * (tick - corner[1])
        yield f'<path d="M0 {y:.1f}h{size[0]:.1f}" stroke="{_GRID}"/>'
        yield f'<text x="-5" y="{y + 3.5:.1f}" text-anchor="end">{number_text(tick)}</text>'
    yield f'<rect width="{size[0]:.1f}" height="{size[1]:.1f}" fill="none" stroke="{_FRAME}"/>'


def _rectangle(place: Callable[[Array], Array], centre: Array, size: Array, look: str) -> str:
    first, second = place(centre - 0.5 * size), place(centre + 0.5 * size)
    (x, y), (width, height) = np.minimum(first, second), np.abs(second - first)
    return f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" stroke="{_BODY}" {look}/>'


def _arrow(start: Array, end: Array) -> str:
    """Draw an arrow; "" where it is seen from its end."""
    length = float(np.hypot(*(end - start)))
    if length < 1.0:
        return ""
    along = (end - start) / length
    left, right = (end - 6.0 * along + side * 2.6 * np.array([-along[1], along[0]]) for side in (-1.0, 1.0))
    line = f"M{start[0]:.1f} {start[1]:.1f}L{end[0]:.1f} {end[1]:.1f}"
    head = f"M{left[0]:.1f} {left[1]:.1f}L{end[0]:.1f} {end[1]:.1f}L{right[0]:.1f} {right[1]:.1f}"
    return f'<path d="{line}{head}" fill="none" stroke="{_MOUNT}" stroke-width="1.2"/>'


def _centre_mark(x: float, y: float) -> str:
    """Draw the mark of a centre of mass: a circle with two quarters filled."""
    quarters = f"M{x:.1f} {y:.1f}v-5a5 5 0 0 1 5 5zM{x:.1f} {y:.1f}v5a5 5 0 0 1-5-5z"
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{_GROUND}" stroke="{_INK}"/><path d="{quarters}" fill="{_INK}"/>'


def _labels(named: Sequence[tuple[Array, float, str, str]], occupied: list[Box], size: Array) -> Iterator[str]:
    """Yield names, each beside its mark where it overlaps marks, other names and the frame least."""
    for (x, y), away, name, colour in named:
        width, height = _LETTER * 9.0 * len(name), 9.0
        left = [x + away, x - away - width] if away else [x + 2.0, x + 2.0]
        tops = [y - height - away + 2.0, y + away - 2.0, y - height - 12.0, y + 12.0, y + 22.0, y - height - 22.0]
        boxes = [(at, top, at + width, top + height) for top in tops for at in left]
        beyond = [(max(-box[0], 0.0) + max(box[2] - size[0], 0.0)) * height for box in boxes]
        covered = [covered_area(box, occupied) + out for box, out in zip(boxes, beyond, strict=True)]
        best = boxes[int(np.argmin(covered))]
        occupied.append(best)
        where = f'x="{best[0]:.1f}" y="{best[3] - 1.5:.1f}" font-size="9" fill="{colour}"'
        yield f'<text class="name" {where} paint-order="stroke" stroke="{_GROUND}" stroke-width="2">{safe_text(name)}</text>'


def _dimensions(values: Array, origin: float, scale: float, *, outwards: float) -> tuple[str, float]:
    """Draw the chain of dimensions between distinct coordinates [mm], 1 mm apart or more.

    A text that does not fit beside its neighbour moves a level `outwards`; the second value is the extent of all levels.
    """
    marks: list[float] = []
    for value in sorted(values):
        if not marks or value - marks[-1] >= 1.0:
            marks.append(float(value))
    if len(marks) < 2:
        return "", 0.0
    places = [scale * (mark - origin) for mark in marks]
    ticks = "".join(f"M{x - 3:.1f} 3l6-6" for x in places)
    parts = [f'<path d="M{places[0]:.1f} 0H{places[-1]:.1f}{ticks}" fill="none" stroke="{_INK}" stroke-width="0.8"/>']
    ends: list[float] = []  # of the texts on each level
    for (first, second), left, right in zip(zip(marks, marks[1:], strict=False), places, places[1:], strict=False):
        text, middle = f"{second - first:.0f}", 0.5 * (left + right)
        half = 0.5 * _LETTER * 9.0 * len(text) + 2.0
        level = next((n for n, end in enumerate(ends) if middle - half >= end), len(ends))
        ends[level : level + 1] = [middle + half]
        y = outwards * level + (_LEVEL if outwards > 0.0 else -3.0)
        parts.append(f'<text x="{middle:.1f}" y="{y:.1f}" font-size="9" text-anchor="middle">{text}</text>')
    return "".join(parts), _LEVEL * (len(ends) - 1)


def _key(layout: Layout) -> tuple[str, float]:
    """Write the key of payload figures, isolators and marks; return it and its height."""
    payload, inertia = layout.payload, layout.payload.inertia
    x, y, z = _MILLI * payload.centre
    kinds: dict[str, list[str]] = {}
    for placed in (*layout.mounts, *layout.stops):
        kinds.setdefault(placed.isolator, []).append(placed.name)
    lines = [
        f"mass {payload.mass:.6g} kg", f"centre of mass x {x:.1f}, y {y:.1f}, z {z:.1f} mm",
        f"inertia about it [kg m²]: xx {inertia[0, 0]:.5g}, yy {inertia[1, 1]:.5g}, zz {inertia[2, 2]:.5g}",
        f"and xy {inertia[0, 1]:.4g}, xz {inertia[0, 2]:.4g}, yz {inertia[1, 2]:.4g} (of the tensor)", "",
        *(line for device, names in kinds.items() for line in wrap(f"{device}: {_listed(names)}", _KEY)), "",
    ]  # fmt: skip
    parts = [f'<text x="20" y="{_TOP + 15.0 * n:.1f}">{safe_text(line)}</text>' for n, line in enumerate(lines)]
    top = _TOP + 15.0 * len(lines)
    marks = [
        (f'<rect x="25" y="-6" width="6" height="6" fill="{_MOUNT}"/>', "mount, arrow from the base to the payload"),
        (f'<circle cx="28" cy="-3" r="3.2" fill="none" stroke="{_STOP}" stroke-width="1.4"/>', "stop"),
        (f'<path d="M24-3h8m-4-4v8" stroke="{_POINT}" stroke-width="1.4"/>', "point, or where a force acts"),
        (f'<rect x="21" y="-8" width="14" height="9" fill="{_BODY}" fill-opacity="0.12" stroke="{_BODY}"/>',
         "box with a mass's moments of inertia"),
        (f'<rect x="21" y="-8" width="14" height="9" fill="none" stroke="{_BODY}" stroke-dasharray="5 3"/>', "envelope"),
        (_centre_mark(28.0, -4.0), "centre of mass of the payload"),
    ]  # fmt: skip
    present = [layout.mounts, layout.stops, (*layout.points, *layout.forces), layout.masses, layout.envelope, [payload]]
    for mark, text in (entry for entry, things in zip(marks, present, strict=True) if things):
        parts.append(f'<g transform="translate(0 {top:.1f})">{mark}<text x="42">{text}</text></g>')
        top += 16.0
    return "".join(parts), top


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 8 else f"{', '.join(names[:7])} and {len(names) - 7} more"
