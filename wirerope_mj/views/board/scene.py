"""What a board shows: boxes, mounts, stops, points and centres with their positions in mm, as JSON values, and drawn."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from wirerope_mj.content.scene_outline import drawn_scene, mount_axes, mount_position
from wirerope_mj.content.verdicts import used_tone
from wirerope_mj.engine.from_tables.layout import Layout
from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.engine.simulation.recorder import scene_of
from wirerope_mj.engine.statics.payloads import point_positions
from wirerope_mj.engine.statics.table import Sag
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.views.board.shapes import drawn

_LEAST = 4.0  # side of a box that is drawn where a mass has none [mm]
_DECK = "deck_plate"


def board_scene(
    system: System, layout: Layout | None, used: Mapping[str, float | None], sag: Sag | Absent, *,
    collide: Collection[str] = (), names: Sequence[str] = (), by: Sequence[float] = (0, 0, 0),
) -> Entries:  # fmt: skip
    """Compose the scene of a board; `used` are utilisations of mounts by name, and mounts that `collide` are marked.

    What stands in a `layout` can be moved: its names are those of rows of tables. The things called `names` are being
    dragged: their positions contain the shift `by` [mm].
    """
    scene = scene_of(system)
    mounts, stops = [], []
    for mount in scene.drawn:
        axes = mount_axes(scene, mount)
        entry: Entries = {
            "name": f"{'stop' if mount.stop else 'mount'}/{mount.name}", "label": mount.name,
            "kind": "stop" if mount.stop else "mount", "movable": True,
            "position": _mm(mount_position(scene, mount)), "axial": _rounded(axes[:, 2]), "bars": _rounded(axes[:, 1]),
        }  # fmt: skip
        if mount.stop:
            stops.append(entry)
        else:
            sizes = {name: _rounded(1e3 * size) for name, size in (("height", mount.height), ("width", mount.width))}
            share = used.get(mount.name)
            how = {"used": share, "tone": used_tone(share), "collides": mount.name in collide}
            mounts.append({**entry, **sizes, "part": mount.isolator, **how})
    points = [("point", name, at) for name, at in point_positions(system).items()]
    points += [("force", point.name, point.position) for point in (layout.forces if layout else ())]
    standing = [
        {"kind": "point", "name": f"{kind}/{name}", "movable": True, "label": name, "position": _mm(at)}
        for kind, name, at in points
    ]
    marked = zip(("stiffness", "mass"), _centres(scene, layout, sag)[::-1], strict=True)
    centres = [
        {"kind": "centre", "mark": mark, "label": f"of {mark}", "position": at, "movable": False} for mark, at in marked if at
    ]
    items = [*mounts, *_boxes(scene, layout), *stops, *standing, *centres]
    return drawn(items, movable=layout is not None, names=names, by=by)


def _centres(scene: Scene, layout: Layout | None, sag: Sag | Absent) -> tuple[list[float] | None, list[float] | None]:
    """Find the centres of mass and of the mounts' vertical stiffness at rest [mm], as far as they are known.

    The latter is the mean position of the mounts, weighted by what each carries over how far it has gone down: a payload whose
    centre of mass stands above it goes down without tilting.
    """
    if isinstance(sag, Absent) or len(sag.payloads) != 1:
        return None if layout is None else _mm(layout.payload.centre), None
    centre, stiffnesses, positions = next(iter(sag.payloads.values())).centre, list[float](), list[Array]()
    for mount in scene.isolating:
        down = -float(mount_axes(scene, mount)[2] @ sag.mounts[mount.name].deflection)
        if down > 0.0:
            stiffnesses.append(sag.mounts[mount.name].carries / down)
            positions.append(mount_position(scene, mount))
    total = sum(stiffnesses)
    return _mm(centre), _mm(np.array(stiffnesses) @ np.array(positions) / total) if total > 0.0 else None


def _boxes(scene: Scene, layout: Layout | None) -> Iterator[Entries]:
    """Yield the boxes to draw: deck, masses and envelopes of a layout, or without one those around all shapes."""
    for body, geom, points in drawn_scene(scene).shapes:
        if layout is None or geom.name == _DECK:
            low, high = points.min(axis=0), points.max(axis=0)
            kind = "deck" if body.on_base or not body.moves else "mass"
            yield _box(geom.name or body.name, body.name, kind, 0.5 * (low + high), high - low)
    for mass in layout.masses if layout is not None else ():
        label = f"{mass.name} {mass.properties.mass:.4g} kg"
        yield _box(f"mass/{mass.name}", label, "mass", mass.properties.centre, mass.properties.box)
    for box in layout.envelope if layout is not None else ():
        yield _box(f"envelope/{box.name}", box.name, "envelope", box.centre, box.size)


def _box(name: str, label: str, kind: str, centre: Array, size: Array) -> Entries:
    return {
        "name": name, "label": label, "kind": kind, "position": _mm(centre), "size": _mm(np.maximum(size, 1e-3 * _LEAST)),
        "movable": kind != "deck",
    }  # fmt: skip


def _mm(position: Array) -> list[float]:
    return [round(1e3 * float(value), 3) + 0.0 for value in position]


def _rounded(value: float | Array | None) -> float | list[float] | None:
    """Round a value or a vector for JSON; None for NaN."""
    if value is None or isinstance(value, float) and math.isnan(value):
        return None
    return round(value, 4) if isinstance(value, float) else [round(float(part), 6) for part in value]
