"""The 3D scene: bodies as a tree of frames on the base, their geoms, mounts and stops, the base's acceleration."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import rerun as rr

from wirerope_mj.assessment.criteria import EXCEEDED
from wirerope_mj.assessment.criteria.payload import body_corners
from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.selection import Selection
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arrays import AnyArray, Array, Booleans
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.colours import ARROW, DARK, RUBBER, STEEL, TOUCHING, TRIAD, colour_of
from wirerope_mj.views.recording.camera import Camera, close_up, reach, scene_extent, whole_scene
from wirerope_mj.views.recording.now import heat, mark_color, used_by
from wirerope_mj.views.recording.paths import AXIAL, Rows, Stream, at, child, entity
from wirerope_mj.views.recording.shapes import (
    Frame,
    bending_at,
    block,
    coil,
    conjugate,
    draw_geoms,
    drawn_size,
    log_bending,
    multiply,
    quaternion,
    quaternion_of,
    rotate,
    see_through,
)
from wirerope_mj.views.thin import rows_of_steps

_LEAST_HEIGHT = 0.08  # least height of a drawn rope over its modelled height: a crushed mount is not turned inside out
_MOST_LABELS = 12  # With more mounts only those whose loops are shown first get a label
# Entities of a body that would hide a mount in a close-up
BESIDE = ("labels", "forces", "acceleration", "stops", "axes", "ring", "outline")
_FIXED = 1e-6  # motion of a point in the frame of the body that carries it [m]
_RING = 48  # corners of the ring about the worst mount


@dataclass(frozen=True, kw_only=True)
class Device:
    """A mount as it is drawn: the scene's mount, the size of the device [m], and whether it is a rope or a block."""

    mount: SceneMount
    height: float
    width: float
    rope: bool


def devices_of(response: Response, extent: float) -> list[Device]:
    """Find size and kind of the drawn mounts; unknown sizes suit a scene of `extent` [m]."""
    devices = []
    for mount in response.scene.isolating:
        height, width = drawn_size(mount, extent)
        # A mount without axial force is a rubber block that acts sideways only.
        rope = bool(response.mounts[mount.name].force[:, AXIAL].any())
        devices.append(Device(mount=mount, height=height, width=width, rope=rope))
    return devices


def close_up_of(response: Response, mount: str, *, aspect: float) -> Camera:
    """Place the camera near a mount at its largest deflection, for a pane `aspect` times as wide as high."""
    devices = devices_of(response, scene_extent(response.scene)[1])
    device = next(device for device in devices if device.mount.name == mount)
    row = int(np.abs(response.mounts[mount].deflection).max(axis=1).argmax())
    return close_up(response, mount, height=device.height, width=device.width, row=row, aspect=aspect)


def log_mounts(
    rec: Stream, response: Response, selection: Selection, frames: dict[str, Frame], rows: Rows, *, extent: float
) -> None:
    """Log bars, ropes, labels and forces of all mounts at some rows, in a scene of `extent` [m]."""
    devices = devices_of(response, extent)
    _log_bars(rec, response, selection, frames, devices)
    few = len(devices) <= _MOST_LABELS or not selection.axes
    labelled = selection.mounts if few else tuple(selection.kinds)
    for base in dict.fromkeys(device.mount.base_body for device in devices):
        on_base = [device for device in devices if device.mount.base_body == base]
        path = frames[base].path
        others = [d for d in on_base if d.mount.name in labelled and d.mount.name != selection.governing]
        if others:
            spots = rr.Points3D(
                [device.mount.base_point for device in others], labels=[device.mount.name for device in others],
                colors=[colour_of(selection, device.mount.name) for device in others], radii=rr.Radius.ui_points(0.0),
                show_labels=True,
            )  # fmt: skip
            rec.log(child(path, "labels"), spots, static=True)
        # the forces of mounts on their payloads as arrows of equal scale
        vectors = np.stack([-response.mounts[d.mount.name].force[rows] @ d.mount.axes.T for d in on_base], axis=1)
        if largest := np.sqrt((vectors**2).sum(axis=-1)).max():
            feet = [d.mount.base_point + 0.5 * d.height * d.mount.axes[:, AXIAL] for d in on_base]
            colors = [colour_of(selection, device.mount.name) for device in on_base]
            drawn = rr.Arrows3D.from_fields(origins=feet, colors=colors, radii=0.0015 * extent)
            rec.log(child(path, "forces"), drawn, static=True)
            arrows = rr.Arrows3D.columns(vectors=(vectors * (0.16 * extent / largest)).reshape(-1, 3))
            rec.send_columns(child(path, "forces"), at(response.time[rows]), arrows.partition(np.full(rows.size, len(on_base))))
        for kind in dict.fromkeys((d.mount.isolator, d.height, d.width, d.rope) for d in on_base):
            same = [d for d in on_base if (d.mount.isolator, d.height, d.width, d.rope) == kind]
            _log_ropes(rec, child(path, "mounts", kind[0]), response, same, rows)


def _log_ropes(rec: Stream, path: str, response: Response, devices: list[Device], rows: Rows) -> None:
    """Log equal devices as one mesh, stretched and sheared for each mount and row by an affine map."""
    first = devices[0]
    vertices, triangles, normals = coil(first.width) if first.rope else block(first.width)
    color = STEEL if first.rope else RUBBER
    mesh = rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles, vertex_normals=normals, albedo_factor=color)
    rec.log(path, mesh, static=True)
    maps = np.empty((rows.size, len(devices), 3, 3), dtype=np.float32)  # columns first, as rerun stores them
    feet = np.empty((rows.size, len(devices), 3))
    for number, device in enumerate(devices):
        mount, axes = device.mount, device.mount.axes
        foot = mount.base_point - 0.5 * device.height * axes[:, AXIAL]
        feet[:, number] = foot + bending_at(response, mount, mount.base_body, rows)
        reach = response.mounts[mount.name].deflection[rows] + np.array([0.0, 0.0, device.height])
        reach[:, AXIAL] = np.maximum(reach[:, AXIAL], _LEAST_HEIGHT * device.height)
        maps[:, number, 0], maps[:, number, 1] = axes[:, 0], axes[:, 1]
        maps[:, number, 2] = reach @ axes.T
    kind = pa.list_(pa.field("item", pa.float32(), nullable=False), 9)
    columns = pa.FixedSizeListArray.from_arrays(pa.array(maps.ravel()), type=kind)
    poses = rr.InstancePoses3D.columns(translations=feet.reshape(-1, 3), mat3x3=columns)
    rec.send_columns(path, at(response.time[rows]), poses.partition(np.full(rows.size, len(devices))))


def _log_bars(rec: Stream, response: Response, selection: Selection, frames: dict[str, Frame], devices: list[Device]) -> None:
    """Log the two bars of every mount; of a run alone in the colour of its utilisation."""
    bodies = {body.name: body for body in response.scene.bodies}
    bars: dict[str, list[tuple[Array, Array, Array, str]]] = {}
    for device in devices:
        mount, axes = device.mount, device.mount.axes
        thick = 0.05 * device.height
        half = np.array([0.17 * device.width, 0.95 * device.width, thick])
        half = half if device.rope else np.array([0.6 * device.width, 0.6 * device.width, thick])
        up = (0.5 * device.height - thick) * np.array([0.0, 0.0, 1.0])
        back = multiply(conjugate(bodies[mount.payload_body].orientation), bodies[mount.base_body].orientation)
        for body, point, turn, side in (
            (mount.base_body, mount.base_point, axes, -1.0),
            (mount.payload_body, mount.payload_point, rotate(back, axes.T).T, 1.0),
        ):
            bar = (point + side * turn @ up, quaternion_of(turn), half, mount.name)
            bars.setdefault(body, []).append(bar)
    for body, parts in bars.items():
        centers, turns, halves, names = zip(*parts, strict=True)
        quaternions = [quaternion(turn) for turn in turns]
        look = {"half_sizes": halves, "centers": centers, "quaternions": quaternions, "fill_mode": "Solid"}
        path = child(frames[body].path, "bars")
        if selection.run_color or not selection.used:
            rec.log(path, rr.Boxes3D(**look, colors=[colour_of(selection, name) for name in names]), static=True)
            continue
        rec.log(path, rr.Boxes3D(**look), static=True)
        colors = heat(used_by(selection, list(names)))
        rows = np.flatnonzero(np.append(True, (np.diff(colors.astype(int), axis=0) != 0).any(axis=(1, 2))))
        columns = rr.Boxes3D.columns(colors=colors[rows].reshape(-1, 3)).partition(np.full(rows.size, len(names)))
        rec.send_columns(path, at(response.time[rows]), columns)


def log_marks(rec: Stream, response: Response, selection: Selection, frames: Mapping[str, Frame], extent: float) -> None:
    """Outline the bodies that exceed a limit, and log a ring about the governing mount with its name and what it uses."""
    exceeding = {row.subject for row in selection.verdicts if row.verdict == EXCEEDED}
    exceeding |= {carrier for name in exceeding & response.points.keys() if (carrier := carrier_of(response, name))}
    for body in response.scene.bodies:
        corners = body_corners(body)
        if body.name in exceeding and corners.size:
            low, high = corners.min(axis=0), corners.max(axis=0)
            look = {"colors": [DARK.exceeded], "radii": rr.Radius.ui_points(2.5), "labels": [body.name], "show_labels": True}
            box = rr.Boxes3D(centers=[0.5 * (low + high)], half_sizes=[0.51 * (high - low)], **look)
            rec.log(child(frames[body.name].path, "outline"), box, static=True)
    for device in devices_of(response, extent):
        if (mount := device.mount).name != selection.governing or not selection.axes:
            continue
        worst, path = by_use(selection.verdicts).get(mount.name), frames[mount.base_body].path
        used = None if worst is None else worst.utilisation
        color = mark_color(selection)
        toward = whole_scene(response, mount=mount.name).eye - mount.base_point
        across = np.cross([0.0, 0.0, 1.0], toward / np.linalg.norm(toward))
        across /= np.linalg.norm(across)
        up = np.cross(toward / np.linalg.norm(toward), across)
        angle = np.linspace(0.0, 2.0 * np.pi, _RING)[:, None]
        radius = max(1.1 * max(device.height, device.width), 0.03 * extent)
        circle = mount.base_point + radius * (np.cos(angle) * across + np.sin(angle) * up)
        ring = rr.LineStrips3D([circle], colors=color, radii=rr.Radius.ui_points(1.8))
        rec.log(child(path, "ring"), ring, static=True)
        name = mount.name if used is None else f"{mount.name} {in_unit(used, '%'):.0f} %"
        spot = {"labels": [name], "colors": color, "radii": rr.Radius.ui_points(0.0), "show_labels": True}
        rec.log(child(path, "worst"), rr.Points3D([mount.base_point + [0.0, 0.0, 0.65 * device.height]], **spot), static=True)


def carrier_of(response: Response, point: str) -> str:
    """Find the body on which a point stands, in whose frame it does not move; "" if there is none, as on one that bends."""
    some = slice(None, None, max(1, response.time.size // 100))
    place = response.points[point].position[some]
    for body in response.scene.bodies:
        if body.moves and body.name in response.bodies and body.geoms:
            moved = response.bodies[body.name]
            inside = rotate(conjugate(moved.orientation[some]), place - moved.position[some])
            if np.ptp(inside, axis=0).max() < _FIXED:
                return body.name
    return ""


OPEN, CLOSED = DARK.base, TOUCHING
_COVER = 1.02  # radius of the cover over that of the ball: visible, and hardly larger


def closed_at(response: Response, stops: tuple[SceneMount, ...]) -> Booleans:
    """Find whether any of several stops is pressed at each sample, (n_t,)."""
    pressing = [response.mounts[stop.name].force.any(axis=1) for stop in stops]
    return np.asarray(np.any(pressing, axis=0))


def changes(state: AnyArray) -> Rows:
    """Find the rows at which a state changes, with the first row."""
    return np.flatnonzero(np.diff(state.astype(int), prepend=-1))


def log_stops(rec: Stream, response: Response, frames: dict[str, Frame], *, extent: float) -> None:
    """Log every stop as a bumper that changes colour when it is pressed.

    A ball that the model draws about the stop's point on the payload is covered, so that the colour shows at the contact.
    Without one the bumper is a cylinder about its point on the base; one whose device states no size suits a scene of
    `extent` [m].
    """
    scene = response.scene
    look: dict[str, object] = {"show_labels": False, "fill_mode": "Solid"}  # the lanes and the report name them
    for stop in scene.stops:
        geoms = next((body.geoms for body in scene.bodies if body.name == stop.payload_body), ())
        near = [geom for geom in geoms if np.allclose(geom.position, stop.payload_point, rtol=0.0, atol=1e-6)]
        radius = max((float(geom.size[0]) for geom in near if geom.shape == "sphere"), default=None)
        if radius is None:
            height, width = drawn_size(stop, extent)
            size = {"lengths": [height], "radii": [0.5 * width], "quaternions": [quaternion(quaternion_of(stop.axes))]}
            shape, body, center = rr.Cylinders3D, stop.base_body, stop.base_point
        else:
            size = {"half_sizes": [[_COVER * radius] * 3]}
            shape, body, center = rr.Ellipsoids3D, stop.payload_body, stop.payload_point
        path = child(frames[body].path, "stops", stop.name)
        rec.log(path, shape(centers=[center], labels=[stop.name], **size, **look), static=True)
        closed = closed_at(response, (stop,))
        rows = changes(closed)
        colors = [CLOSED if closed[row] else OPEN for row in rows]
        rec.send_columns(path, at(response.time[rows]), shape.columns(colors=colors))


_STILL = 1 / 50  # fraction of the largest travel, the tolerance between drawn poses
_MOST_POSES = 3000  # Poses of a long run at the most; those of all peaks are among them


def log_scene(
    rec: Stream, response: Response, selection: Selection, frames: dict[str, Frame], *, arrow: tuple[int, int, int] = ARROW
) -> None:
    """Log bodies, geoms, mounts and the base's acceleration, an arrow of the given colour."""
    _, extent = scene_extent(response.scene)
    rec.log(entity("world"), rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    rows = scene_rows(response, frames)
    for body in response.scene.bodies:
        frame = frames[body.name]
        if body.name != "world":
            drawn = rows
            if body.name == response.scene.base:
                moved = response.bodies[body.name].position
                drawn = rows_of_steps(response.time, moved, _STILL * float(np.ptp(moved, axis=0).max()))
            log_pose(rec, frame.path, response.time, frame.position, frame.orientation, drawn)
        draw_geoms(rec, frame.path, see_through(body), extent)
    if response.scene.mounts:
        log_mounts(rec, response, selection, frames, rows, extent=extent)
        log_stops(rec, response, frames, extent=extent)
        log_bending(rec, frames, response, rows, 1.0)
    log_marks(rec, response, selection, frames, extent)
    if response.scene.base in frames:
        corner, length = _base_bounds(response, extent)[1] * [1.0, 1.0, 0.0], 0.07 * extent
        axes = rr.Arrows3D(
            vectors=length * np.eye(3), origins=[corner] * 3, colors=TRIAD, labels=["x", "y", "z"], show_labels=True,
            radii=0.02 * length,
        )  # fmt: skip
        rec.log(child(frames[response.scene.base].path, "axes"), axes, static=True)
        _log_base_acceleration(rec, response, frames, extent, arrow)


def _base_bounds(response: Response, extent: float) -> tuple[Array, Array]:
    """Find least and largest coordinates of the base's geoms about its centre of mass [m], (3,) each."""
    body = next(body for body in response.scene.bodies if body.name == response.scene.base)
    boxes = [(geom.position - reach(geom), geom.position + reach(geom)) for geom in body.geoms]
    known = [box for box in boxes if np.isfinite(box).all()] or [(np.full(3, -0.5 * extent), np.full(3, 0.5 * extent))]
    lows, highs = zip(*known, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def scene_rows(response: Response, frames: dict[str, Frame]) -> Rows:
    """Choose the rows of samples at which moving bodies are drawn anew, as few as a picture needs."""
    moving = [frame for name, frame in frames.items() if not frame.fixed and name != response.scene.base]
    deflections = [mount.deflection for mount in response.mounts.values()]
    lengths = [frame.position for frame in moving] + deflections
    if not lengths:
        return np.array([0])
    travel = max(float(np.ptp(part, axis=0).max()) for part in lengths)
    # Rotations count at an arm of a metre.
    values = np.concatenate([*lengths, *(frame.orientation for frame in moving)], axis=1)
    rows = rows_of_steps(response.time, values, _STILL * travel, limit=response.time.size)
    if rows.size > _MOST_POSES:
        some = rows[np.linspace(0, rows.size - 1, _MOST_POSES).astype(np.intp)]
        ends = np.concatenate(lengths, axis=1)
        rows = np.unique(np.concatenate([some, ends.argmin(axis=0), ends.argmax(axis=0)]))
    return rows


def log_pose(rec: Stream, path: str, time: Array, position: Array, orientation: Array, rows: Rows) -> None:
    """Log a pose at some rows, or once if it has one row: position (n_t, 3), quaternion (n_t, 4), w first."""
    if len(position) == 1:
        rec.log(path, rr.Transform3D(translation=position[0], quaternion=quaternion(orientation[0])), static=True)
    else:
        poses = rr.Transform3D.columns(translation=position[rows], quaternion=np.roll(orientation[rows], -1, axis=1))
        rec.send_columns(path, at(time[rows]), poses)


def _log_base_acceleration(
    rec: Stream, response: Response, frames: dict[str, Frame], extent: float, color: tuple[int, int, int]
) -> None:
    """Log the acceleration of the base as an arrow, since the camera moves with the base."""
    acceleration = response.base.acceleration
    largest = float(np.linalg.norm(acceleration, axis=1).max())
    base = response.scene.base
    if largest == 0.0 or base not in response.bodies:
        return
    rows = rows_of_steps(response.time, acceleration, 0.01 * largest)
    back = conjugate(response.bodies[base].orientation[rows])
    corner = _base_bounds(response, extent)[0]
    path = child(frames[base].path, "acceleration")
    look = rr.Arrows3D.from_fields(
        origins=[[corner[0], corner[1], 0.0]], colors=[color], radii=[0.004 * extent], show_labels=True
    )
    rec.log(path, look, static=True)
    levels = in_unit(np.linalg.norm(acceleration[rows], axis=1), "g")
    vectors = rotate(back, acceleration[rows]) * (0.18 * extent / largest)
    columns = rr.Arrows3D.columns(vectors=vectors, labels=[f"base {level:.1f} g" for level in levels])
    rec.send_columns(path, at(response.time[rows]), columns)
