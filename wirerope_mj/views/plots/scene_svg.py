"""A scene as SVG: plan and elevation of the modelled geometry with its mounts, and the scene at an instant of the response."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import compress
from operator import not_

import numpy as np

from wirerope_mj.content.blocks import SceneView, short
from wirerope_mj.content.scene_outline import (
    DrawnScene,
    Outline,
    View,
    drawn_scene,
    label_groups,
    mount_position,
    outlines,
    ring_around,
    shared_label,
)
from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.views.colours import LIGHT, hexadecimal, used_colour
from wirerope_mj.views.plots.svg_chart import number_text, safe_text

# Disc, square, diamond, triangles and cross about the origin.
_MARKERS = (
    "M-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0", "M-2.8-2.8h5.6v5.6h-5.6z", "M0-3.6L3.6 0L0 3.6L-3.6 0z", "M0-3.4L3.4 2.6H-3.4z",
    "M0 3.4L3.4-2.6H-3.4z", "M-1-3.2h2v2.2h2.2v2h-2.2v2.2h-2v-2.2h-2.2v-2h2.2z",
)  # fmt: skip
_TALLEST, _TALLEST_HALF, _LOWEST = 195.0, 150.0, 50.0  # height of one view, of one of half the width, and of any
_LEFT, _RIGHT, _TOP, _BOTTOM = 40.0, 10.0, 20.0, 32.0
_MARGIN = 0.05  # around the drawing, as a fraction of its width
_ROUNDING = 10.0  # fractions of a unit to which corners are rounded
_LETTER = 0.56  # mean width of a letter over its height
_BOLD = 5.7  # mean width of a letter of a view's name
_ROW = 15.0  # height of an entry of the key
_NAME = 7.5  # height of the letters of a mount's name
WIDTH = 600.0  # Width of a drawing over the whole page, in its units
_COLOURS, _RATED = tuple(map(hexadecimal, LIGHT.compared)), hexadecimal(LIGHT.exceeded)
_INK, _FRAME, _GRID, _PALE = (hexadecimal(colour) for colour in (LIGHT.heading, LIGHT.frame, LIGHT.line, LIGHT.faint))
_GROUND = hexadecimal(LIGHT.ground)
Place = Callable[[Array], Array]
Box = tuple[float, float, float, float]  # left, top, right, bottom
Placed = tuple[float, float, str]  # Left, top and an <svg> element


def scene_svgs(view: SceneView) -> list[str]:
    """Draw plan, elevation and key of a modelled geometry, or plan and elevation at an instant over a pale modelled one."""
    scene, moved, whole = view.scene, view.moved, view.moved is None and view.absent is None
    drawn, devices, parts = drawn_scene(scene), list(dict.fromkeys(mount.isolator for mount in scene.drawn)), []
    after = None if moved is None else drawn_scene(moved)
    width, tallest = (WIDTH, _TALLEST) if whole else (WIDTH / 2.0, _TALLEST_HALF)
    for side in drawn.views:
        place, size = _frame(drawn, side, width, tallest)
        shown = [*_axes(side, size, place, width), *_shapes(outlines(drawn, side), place, pale=after is not None)]
        if after is not None:
            shown += _moved(view, after, side, place, size[0])
        else:
            for mount in sorted(scene.drawn, key=lambda mount: devices.index(mount.isolator)):
                at = place(side.seen(mount_position(scene, mount)))
                cross = f'<path d="M{at[0] - 3:.1f} {at[1] - 3:.1f}l6 6m0-6l-6 6" stroke="{_INK}" stroke-width="1.2"/>'
                shown.append(cross if mount.name in (view.absent or ()) else _mark(devices.index(mount.isolator), at))
            shown += _labels(scene, side, place) if whole else ()
        parts.append(_drawing(drawn, side, size, width, shown))
    if moved is None and scene.mounts:  # the key
        columns, marks = 3, []
        for number, device in enumerate(devices):
            x, y = 12.0 + (WIDTH / columns) * (number % columns), 8.0 + _ROW * (number // columns)
            text = f'<text x="{x + 9:.1f}" y="{y + 3.2:.1f}">{safe_text(short(device))}</text>'
            marks.append(f"{_mark(number, np.array([x, y]))}{text}")
        height = _ROW * (1 + (len(devices) - 1) // columns)
        parts.append(f"{_svg_head(WIDTH, height, 'Marks of the isolators', 1)}{''.join(marks)}</svg>")
    return parts


def stage_svgs(drawn: DrawnScene, width: float, height: float) -> tuple[list[Placed], Callable[[SceneView], list[str]]]:
    """Draw plan and elevation in one scale: fixed parts with their places in an area, and a function that draws moving ones.

    They stand beside or below each other, whichever lets them be larger.
    """
    extents = [np.maximum(side.seen(drawn.high - drawn.low), 1e-3) for side in drawn.views]
    sizes = [extent + 2.0 * _MARGIN * extent.max() for extent in extents]
    (a, b), across, up = sizes, _LEFT + _RIGHT, _TOP + _BOTTOM
    beside = min((width - 2.0 * across) / (a[0] + b[0]), (height - up) / max(a[1], b[1]))
    below = min((width - across) / max(a[0], b[0]), (height - 2.0 * up) / (a[1] + b[1]))
    scale = float(max(beside, below))
    moves = [body.moves and not body.on_base for body, *_ in drawn.shapes]
    fixed, free = (replace(drawn, shapes=tuple(compress(drawn.shapes, kept))) for kept in (map(not_, moves), moves))
    local = [(points - body.position) @ rotation_matrices(body.orientation) for body, _, points in free.shapes]
    frames, places, left, top = [], list[Placed](), 0.0, 0.0
    for side, size in zip(drawn.views, sizes, strict=True):
        room = scale * float(size[0]) + across
        place, shown = _frame(drawn, side, room, scale * float(size[1]))
        frames.append((side, place, shown, room))
        still = [*_axes(side, shown, place, room), *_shapes(outlines(fixed, side), place)]
        still += _shapes(outlines(free, side), place, pale=True)
        places.append((left, top, _drawing(drawn, side, shown, room, still)))
        left, top = (left + room, top) if beside > below else (left, top + shown[1] + up)

    def moving(view: SceneView) -> list[str]:
        assert view.moved is not None
        now = {body.name: (body, rotation_matrices(body.orientation).T) for body in view.moved.bodies}
        shapes = [(*now[body.name], geom, points) for (body, geom, _), points in zip(free.shapes, local, strict=True)]
        placed = tuple((body, geom, points @ turn + body.position) for body, turn, geom, points in shapes)
        after = replace(drawn, scene=view.moved, shapes=placed)
        return [
            _drawing(drawn, side, shown, room, _moved(view, after, side, place, shown[0]))
            for side, place, shown, room in frames
        ]

    return places, moving


def _moved(view: SceneView, after: DrawnScene, side: View, place: Place, width: float) -> Iterator[str]:
    """Yield shapes at an instant, mounts as lines from the base's site to the payload's, and the ring."""
    yield from _shapes(outlines(after, side), place, used=view.used)
    moved = after.scene
    bodies = {body.name: body for body in moved.bodies}
    for mount in moved.drawn:
        payload = bodies[mount.payload_body]
        end = payload.position + rotation_matrices(payload.orientation) @ mount.payload_point
        (x, y), (to_x, to_y) = place(side.seen(np.stack([mount_position(moved, mount), end]))).tolist()
        colour = used_colour(view.used[mount.name]) if mount.name in view.used else _FRAME if view.used else _COLOURS[0]
        yield f'<path d="M{x:.1f} {y:.1f}L{to_x:.1f} {to_y:.1f}" stroke="{colour}" stroke-width="1.4"/>'
        yield f'<circle cx="{to_x:.1f}" cy="{to_y:.1f}" r="{2.6 if view.used else 1.6}" fill="{colour}"/>'
    if view.ring is not None:
        (x, y), colour = place(side.seen(view.ring[1])).tolist(), _RATED if view.exceeded else _INK
        modelled = ring_around(view.scene, view.ring[0]) or view.ring  # by which the name keeps its side in a film
        aside, anchor = (8.0, "start") if place(side.seen(modelled[1]))[0] < 0.5 * width else (-8.0, "end")
        circle = f'cx="{x:.1f}" cy="{y:.1f}" r="6" fill="none" stroke="{colour}" stroke-width="1.6"'
        text = f'x="{x + aside:.1f}" y="{y - 7:.1f}" text-anchor="{anchor}" fill="{colour}" font-weight="bold"'
        yield f'<circle class="{"over" if view.exceeded else "ring"}" {circle}/>'
        yield f'<text class="name" {text}>{safe_text(short(view.ring[0]))}</text>'


def _drawing(drawn: DrawnScene, side: View, size: tuple[float, float], width: float, parts: Iterable[str]) -> str:
    """Write a view as an <svg> element of a width, with its axes, of `size`, in the middle."""
    shift = _LEFT + 0.5 * (width - _LEFT - _RIGHT - size[0])
    head = _svg_head(width, size[1] + _TOP + _BOTTOM, f"{drawn.scene.name} {side.title}", int(WIDTH / width) or 1)
    return f'{head}<g transform="translate({shift:.1f} {_TOP:g})">{"".join(parts)}</g></svg>'


def _svg_head(width: float, height: float, label: str, columns: int) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="scene in{columns}" viewBox="0 0 {width:g} {height:.1f}" role="img" '
        f'aria-label="{safe_text(label)}" font-family="Helvetica, Arial, sans-serif" font-size="9" fill="{_INK}">'
    )


def _frame(drawn: DrawnScene, view: View, width: float, tallest: float) -> tuple[Place, tuple[float, float]]:
    """Find the map from points of a view [m], (.., 2), to a drawing of equal scales, and the size of its axes."""
    low, high = (view.seen(end) for end in (drawn.low, drawn.high))
    room = _MARGIN * max(float((high - low).max()), 1e-3)
    low, high = low - room, high + room
    scale = min((width - _LEFT - _RIGHT) / (high[0] - low[0]), tallest / (high[1] - low[1]))
    size = np.maximum(scale * (high - low), (0.0, _LOWEST))
    origin = low - 0.5 * (size / scale - (high - low))

    def place(points: Array) -> Array:
        at = scale * (points - origin)
        return np.stack([at[..., 0], size[1] - at[..., 1]], axis=-1)

    return place, (float(size[0]), float(size[1]))


def _axes(view: View, size: tuple[float, float], place: Place, width: float) -> Iterator[str]:
    """Yield the grid, frame, title and numbers [m] of a view of a size."""
    zero = place(np.zeros(2))
    scale = float(place(np.ones(2))[0] - zero[0])
    across = linear_ticks(-zero[0] / scale, (size[0] - zero[0]) / scale, most=min(8, max(2, int(size[0] / 28.0))))
    upward = linear_ticks((zero[1] - size[1]) / scale, zero[1] / scale, most=max(int(size[1] / 30.0), 2))
    columns, rows = zero[0] + scale * across, zero[1] - scale * upward
    lines = "".join(f"M{at:.1f} 0V{size[1]:.1f}" for at in columns) + "".join(f"M0 {at:.1f}H{size[0]:.1f}" for at in rows)
    yield f'<path class="grid" d="{lines}" fill="none" stroke="{_GRID}"/>'
    yield f'<path class="frame" d="M0 0V{size[1]:.1f}H{size[0]:.1f}" fill="none" stroke="{_FRAME}"/>'
    name = f"{view.title}: {'xyz'[view.up]} [m] over {'xyz'[view.right]} [m]"
    if _BOLD * len(name) > width - _LEFT + _RIGHT:
        name = f"{view.title.partition(',')[0]} [m]"
    yield f'<text x="{0.5 * size[0]:.1f}" y="-7" text-anchor="middle" font-weight="bold">{name}</text>'
    for at, tick in zip(columns, across, strict=True):
        yield f'<text x="{at:.1f}" y="{size[1] + 12:.1f}" text-anchor="middle">{number_text(tick)}</text>'
    for at, tick in zip(rows, upward, strict=True):
        yield f'<text x="-5" y="{at + 3.2:.1f}" text-anchor="end">{number_text(tick)}</text>'


def _shapes(
    drawn: Sequence[Outline], place: Place, *, pale: bool = False, used: Mapping[str, float] | None = None
) -> Iterator[str]:
    """Yield outlines as polygons in their order; pale ones without fill, in red those of bodies beyond a limit."""
    stroke = f'fill="none" stroke="{_PALE}" stroke-dasharray="3 2"' if pale else f'stroke="{_FRAME}"'
    yield f'<g {stroke} stroke-width="0.5">'
    for outline in drawn:
        corners = np.rint(_ROUNDING * place(outline.corners)) / _ROUNDING
        points = " ".join(f"{x:g},{y:g}" for x, y in corners.tolist())
        colour = "".join(f"{round(255 * part):02x}" for part in outline.colour[:3])
        fill = "" if pale else f' fill="#{colour}" fill-opacity="{outline.colour[3]:.3g}"'
        edge = f' stroke="{_COLOURS[3]}" stroke-width="1.6"' if outline.flexible and not pale else ""
        if (used or {}).get(outline.body, 0.0) > 1.0:
            edge = f' class="over" stroke="{_RATED}" stroke-width="1.6"'
        yield f'<polygon points="{points}"{fill}{edge}/>'
    yield "</g>"


def _mark(number: int, at: Array) -> str:
    shape, colour = _MARKERS[number % len(_MARKERS)], _COLOURS[number % len(_COLOURS)]
    moved = f"translate({at[0]:.1f} {at[1]:.1f})"
    return f'<path d="{shape}" transform="{moved}" fill="{colour}" stroke="{_GROUND}" stroke-width="0.5"/>'


def _labels(scene: Scene, view: View, place: Place) -> Iterator[str]:
    """Yield the mounts' labels, each at the corner of its mark where it overlaps earlier labels least."""
    occupied: list[Box] = []
    for at, names in label_groups(scene, view):
        text = shared_label(names)
        x, y = place(at).tolist()
        width = _LETTER * _NAME * len(text)
        corners = [(left, base) for base in (y - 4.0, y + 4.0 + _NAME) for left in (x + 4.0, x - 4.0 - width)]
        boxes = [(left, base - _NAME, left + width, base) for left, base in corners]
        best = min(boxes, key=lambda box: covered_area(box, occupied))
        occupied.append(best)
        yield f'<text class="name" x="{best[0]:.1f}" y="{best[3]:.1f}" font-size="{_NAME}">{safe_text(text)}</text>'


def covered_area(box: Box, occupied: Sequence[Box]) -> float:
    """Sum the areas that a box shares with others, in units of the drawing squared."""
    shared = (np.minimum(box[2:], other[2:]) - np.maximum(box[:2], other[:2]) for other in occupied)
    return sum(float(np.maximum(size, 0.0).prod()) for size in shared)
