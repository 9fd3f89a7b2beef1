"""The 3D scene: bodies as a tree of frames that rides on the base, their geoms, the mounts, the base's acceleration."""

import numpy as np
import rerun as rr

from wirerope_mj.content.selection import Selection
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.camera import reach, scene_extent
from wirerope_mj.views.recording.mounts import log_mounts, log_stops
from wirerope_mj.views.recording.paths import Rows, Stream, at, child, entity
from wirerope_mj.views.recording.shapes import Frame, conjugate, draw_geoms, log_bending, quaternion, rotate, see_through
from wirerope_mj.views.thin import rows_of_steps

_STILL = 1 / 50  # of the largest travel, by which something moves before poses are drawn anew
_MOST_POSES = 3000  # Poses of a long run at the most; those of all peaks are among them
_AXES = [(232, 110, 100), (120, 200, 110), (110, 160, 240)]  # Colours of x, y and z
ARROW = (255, 196, 60)  # Colour of the acceleration of the base of a run alone


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
    if response.scene.base in frames:
        corner, length = _corners(response, extent)[1] * [1.0, 1.0, 0.0], 0.07 * extent
        axes = rr.Arrows3D(
            vectors=length * np.eye(3), origins=[corner] * 3, colors=_AXES, labels=["x", "y", "z"], show_labels=True,
            radii=0.02 * length,
        )  # fmt: skip
        rec.log(child(frames[response.scene.base].path, "axes"), axes, static=True)
        _log_base_acceleration(rec, response, frames, extent, arrow)


def _corners(response: Response, extent: float) -> tuple[Array, Array]:
    """Find least and largest coordinates of the base's shapes about its centre of mass [m], (3,) each."""
    body = next(body for body in response.scene.bodies if body.name == response.scene.base)
    boxes = [(geom.position - reach(geom), geom.position + reach(geom)) for geom in body.geoms]
    known = [box for box in boxes if np.isfinite(box).all()] or [(np.full(3, -0.5 * extent), np.full(3, 0.5 * extent))]
    lows, highs = zip(*known, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def scene_rows(response: Response, frames: dict[str, Frame]) -> Rows:
    """Choose the rows at which what rides on the base is drawn anew."""
    moving = [frame for name, frame in frames.items() if not frame.fixed and name != response.scene.base]
    deflections = [mount.deflection for mount in response.mounts.values()]
    lengths = [frame.position for frame in moving] + deflections
    if not lengths:
        return np.array([0])
    travel = max(float(np.ptp(part, axis=0).max()) for part in lengths)
    # Turning is judged at an arm of a metre.
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
    """Log the acceleration of the base as an arrow, so that the shock is seen although the camera rides."""
    acceleration = response.base.acceleration
    largest = float(np.linalg.norm(acceleration, axis=1).max())
    base = response.scene.base
    if largest == 0.0 or base not in response.bodies:
        return
    rows = rows_of_steps(response.time, acceleration, 0.01 * largest)
    back = conjugate(response.bodies[base].orientation[rows])
    corner = _corners(response, extent)[0]
    path = child(frames[base].path, "acceleration")
    look = rr.Arrows3D.from_fields(
        origins=[[corner[0], corner[1], 0.0]], colors=[color], radii=[0.004 * extent], show_labels=True
    )
    rec.log(path, look, static=True)
    levels = in_unit(np.linalg.norm(acceleration[rows], axis=1), "g")
    vectors = rotate(back, acceleration[rows]) * (0.18 * extent / largest)
    columns = rr.Arrows3D.columns(vectors=vectors, labels=[f"base {level:.1f} g" for level in levels])
    rec.send_columns(path, at(response.time[rows]), columns)
