"""The motion of a run drawn larger than it is, about where it began, which stays as a ghost."""

from dataclasses import replace
from typing import Any

import numpy as np

from wirerope_mj.content.selection import Selection
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Geom, SceneBody
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.camera import scene_extent
from wirerope_mj.views.recording.drawn_runs import DrawnRun
from wirerope_mj.views.recording.enlarge import round_down
from wirerope_mj.views.recording.mounts import devices_of
from wirerope_mj.views.recording.paths import AXIAL, Below, at, child, entity
from wirerope_mj.views.recording.plan import heat, used_by
from wirerope_mj.views.recording.poses import Frame, grown
from wirerope_mj.views.recording.scene import log_pose, scene_rows
from wirerope_mj.views.recording.shapes import draw_geoms

ROOT = "large"

_SEEN = 0.03
"""Fraction of the scene's size that the largest motion is to have in the picture."""

_GHOST, _SEEN_THROUGH = 0.12, 0.55
"""How opaque the ghost is, and what moves."""


def large_factor(run: DrawnRun) -> float:
    """Return the round factor by which motions are drawn larger; 1 where they are large enough."""
    travel = max((float(np.abs(frame.position - frame.position[:1]).max()) for _, frame in _riding(run)), default=0.0)
    extent = scene_extent(run.response.scene)[1]
    return 1.0 if travel == 0.0 or _SEEN * extent <= travel else round_down(_SEEN * extent / travel)


def log_large(rec: Any, run: DrawnRun, factor: float) -> None:
    """Log the base, what rides on it `factor` times as far from where it began, its ghost, and the mounts as bars."""
    import rerun as rr

    response, below = run.response, Below(rec, entity(ROOT))
    rec.log(entity(ROOT), rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    extent, rows = scene_extent(response.scene)[1], scene_rows(response, run.frames)
    riding = _riding(run)
    for body in response.scene.bodies:
        if body.name == response.scene.base or not body.moves:
            draw_geoms(below, run.frames[body.name].path, body.geoms, extent)
    for body, frame in riding:
        first = frame.position[0], frame.orientation[0]
        pose = (
            (frame.position, frame.orientation)
            if frame.fixed
            else grown(frame.position, frame.orientation, *first, factor)
        )
        log_pose(below, frame.path, response.time, *pose, rows)
        draw_geoms(below, frame.path, _faint(body.geoms, _SEEN_THROUGH), extent)
        if not frame.fixed:
            ghost = child(frame.path + "_at_rest")
            log_pose(below, ghost, response.time, frame.position[:1], frame.orientation[:1], rows)
            draw_geoms(below, ghost, _faint(body.geoms, _GHOST), extent)
    _log_bars(below, response, run.selection, run.frames, factor, extent)


def _riding(run: DrawnRun) -> list[tuple[SceneBody, Frame]]:
    scene = run.response.scene
    return [(body, run.frames[body.name]) for body in scene.bodies if body.moves and body.name != scene.base]


def _faint(geoms: tuple[Geom, ...], opaque: float) -> list[Geom]:
    return [replace(geom, rgba=geom.rgba * [1.0, 1.0, 1.0, opaque]) for geom in geoms]


def _log_bars(
    below: Below, response: Response, selection: Selection, frames: dict[str, Frame], factor: float, extent: float
) -> None:
    """Log every mount as a bar from the base to the payload, coloured by what it uses of its limits."""
    import rerun as rr

    for base in dict.fromkeys(mount.base_body for mount in response.scene.isolating):
        devices = [device for device in devices_of(response, extent) if device.mount.base_body == base]
        rows = scene_rows(response, frames)
        ends: list[Array] = []
        for device in devices:
            mount, deflection = device.mount, response.mounts[device.mount.name].deflection
            moved = deflection[0] + factor * (deflection[rows] - deflection[0])
            half = 0.5 * device.height * mount.axes[:, AXIAL]
            feet = np.tile(mount.base_point - half, (rows.size, 1))
            ends.append(np.stack([feet, mount.base_point + half + moved @ mount.axes.T], axis=1))
        strips = np.stack(ends, axis=1).reshape(-1, 2, 3)
        names = [device.mount.name for device in devices]
        used = used_by(selection, names)
        colors = heat(used[rows] if used.size else np.full((rows.size, len(names)), np.nan)).reshape(-1, 3)
        path = child(frames[base].path, "mounts")
        below.log(path, rr.LineStrips3D.from_fields(radii=0.004 * extent), static=True)
        columns = rr.LineStrips3D.columns(strips=strips, colors=colors).partition(np.full(rows.size, len(devices)))
        below.send_columns(path, at(response.time[rows]), columns)
