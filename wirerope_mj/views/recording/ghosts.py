"""Bodies drawn once more with their motion enlarged, as seen from their bases: of several runs as ghosts in one scene."""

from dataclasses import replace

import numpy as np
import rerun as rr

from wirerope_mj.engine.response.scene import Geom, SceneBody
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.camera import scene_extent, whole_scene
from wirerope_mj.views.recording.drawn_runs import Drawn, DrawnRun
from wirerope_mj.views.recording.enlarge import round_down
from wirerope_mj.views.recording.paths import Below, Stream, child, entity
from wirerope_mj.views.recording.poses import Frame, conjugate, grown, multiply, rotate
from wirerope_mj.views.recording.scene import log_pose, scene_rows
from wirerope_mj.views.recording.shapes import draw_geoms, log_bending, see_through

ROOT = "ghosts"
# Of a ghost: two of them can be told apart where they overlap, and edges are seen through both; of where one began.
_OPAQUE, _AT_REST = 0.38, 0.12
_SEEN = 0.04  # Fraction of the scene's size that the largest motion is to have in the picture


def ghost_factor(drawn: Drawn) -> float:
    """Return the round factor by which motions are enlarged; 1 where they are large enough."""
    travel, extent = 0.0, 0.0
    for run in drawn.runs:
        extent = max(extent, scene_extent(run.response.scene)[1])
        for body, frame in _riding(run):
            travel = max(travel, float(np.abs(frame.position - _start(run, body, frame)[0]).max()))
    if travel == 0.0 or _SEEN * extent <= travel:
        return 1.0
    return round_down(_SEEN * extent / travel)


def log_ghosts(rec: Stream, drawn: Drawn, factor: float) -> None:
    """Log the bodies of all runs, their names beside them; of a run alone in its own colours, over where it began."""
    rec.log(entity(ROOT), rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    bases: list[str] = []
    for number, run in enumerate(drawn.runs):
        below, time = Below(rec, entity(ROOT, *run.names)), run.response.time
        extent, rows = scene_extent(run.response.scene)[1], scene_rows(run.response, run.frames)
        base = next((body for body in run.response.scene.bodies if body.name == run.response.scene.base), None)
        if base is not None and base.name != "world" and repr(base.geoms) not in bases:
            draw_geoms(below, run.frames[base.name].path, see_through(base), extent)
            bases.append(repr(base.geoms))  # the same base would flicker through itself
        for body, frame in _riding(run):
            start, pose = _start(run, body, frame), (frame.position, frame.orientation)
            pose = pose if frame.fixed else grown(*pose, *start, factor)
            log_pose(below, frame.path, time, *pose, rows)
            draw_geoms(below, frame.path, _ghostly(body, run), extent)
            if drawn.alone and not frame.fixed:
                began = frame.path + "_at_rest"
                log_pose(below, began, time, start[0][None], start[1][None], rows)
                draw_geoms(below, began, [replace(g, rgba=g.rgba * [1.0, 1.0, 1.0, _AT_REST]) for g in body.geoms], extent)
        if drawn.alone:
            log_bending(below, run.frames, run.response, rows, factor)
        else:
            _log_name(below, run, number, extent)


def _riding(run: DrawnRun) -> list[tuple[SceneBody, Frame]]:
    """Return the bodies that move, but for the base itself."""
    scene = run.response.scene
    return [(body, run.frames[body.name]) for body in scene.bodies if body.moves and body.name != scene.base]


def _start(run: DrawnRun, body: SceneBody, frame: Frame) -> tuple[Array, Array]:
    """Return position (3,) and quaternion of a body where motion is enlarged from: among several runs, as it is modelled."""
    if not run.name:
        return frame.position[0], frame.orientation[0]
    parent = frame.path.rsplit("/", 1)[0]
    name = next((name for name, other in run.frames.items() if other.path == parent and name != "world"), None)
    if name is None:
        return body.position, body.orientation
    carrier = next(other for other in run.response.scene.bodies if other.name == name)
    back = conjugate(carrier.orientation)
    return rotate(back, body.position - carrier.position), multiply(back, body.orientation)


def _ghostly(body: SceneBody, run: DrawnRun) -> list[Geom]:
    if not run.name:
        return [replace(geom, rgba=geom.rgba * [1.0, 1.0, 1.0, 1.5 * _OPAQUE]) for geom in body.geoms]
    rgba = np.array([*run.color, 255 * _OPAQUE]) / 255.0
    return [replace(geom, rgba=rgba) for geom in body.geoms]


def _log_name(below: Below, run: DrawnRun, number: int, extent: float) -> None:
    """Log the name of a run beside the scene, as it is seen when the recording opens: the legend of the colours."""
    scene = run.response.scene
    base = scene.base
    camera = whole_scene(run.response)
    back = camera.eye - camera.target
    left = np.cross(back, [0.0, 0.0, 1.0]) / np.linalg.norm(back)
    above = camera.target + 0.5 * extent * left + np.array([0.0, 0.0, (0.1 + 0.1 * number) * extent])
    path = child(run.frames[base].path if base in run.frames else entity("world"), "name")
    below.log(
        path,
        rr.Points3D([above], labels=[run.name], colors=[run.color], radii=rr.Radius.ui_points(0.0), show_labels=True),
        static=True,
    )
