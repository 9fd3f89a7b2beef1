"""Enlarged motions: ghosts of the bodies of one or several runs, seen from their bases, and the motions of orbits."""

from dataclasses import replace

import numpy as np
import rerun as rr

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import SceneBody
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.animation import with_values
from wirerope_mj.views.recording.camera import scene_extent, whole_scene
from wirerope_mj.views.recording.drawn_runs import Drawn, DrawnRun
from wirerope_mj.views.recording.paths import Below, Stream, child, entity
from wirerope_mj.views.recording.scene import devices_of, log_marks, log_pose, scene_rows
from wirerope_mj.views.recording.shapes import Frame, conjugate, draw_geoms, grown, log_bending, multiply, rotate, see_through

FRACTION = 0.3  # of a mount's height, up to which the largest deflection is enlarged
_ROUND = (1.0, 2.0, 5.0)  # times powers of ten: the factors of enlargement


def factor_of(response: Response, extent: float) -> float:
    """Find the factor that enlarges the deflections of the mounts to `FRACTION` of their height, at least 1."""
    room = min((device.height for device in devices_of(response, extent)), default=0.1 * extent)
    moves = [mount.deflection for mount in response.mounts.values()]
    largest = max((float(np.ptp(move, axis=0).max()) / 2.0 for move in moves), default=0.0)
    if largest <= 0.0:
        return 1.0
    return max(round_down(FRACTION * room / largest), 1.0)


def round_down(factor: float) -> float:
    """Round a factor down to 1, 2 or 5 times a power of ten."""
    decade = 10.0 ** np.floor(np.log10(factor))
    return float(decade * max(part for part in _ROUND if part * decade <= factor * (1.0 + 1e-9)))


def enlarged(response: Response, factor: float) -> Response:
    """Enlarge the motions of a response relative to the base by `factor`, about their means; forces stay as they are.

    Deflections grow alike, so that the mounts still end on the bodies: exactly where bodies only shift, to the
    first order of the angle where they rotate.
    """
    names = response.samples.names
    values = response.samples.columns(0, len(names)).copy()
    first = {name: column for column, name in enumerate(names)}
    base = response.scene.base
    carrier = response.bodies[base].position if base in response.bodies else np.zeros((1, 3))
    fixed = {body.name for body in response.scene.bodies if body.on_base} | {base}
    for name, body in response.bodies.items():
        if name not in fixed:
            at = first[f"bodies/{name}/position/x"]
            values[:, at : at + 3] = carrier + _enlarged(body.position - carrier, factor)
            at = first[f"bodies/{name}/orientation/w"]
            turn = multiply(body.orientation, conjugate(body.orientation[:1]))
            turn = turn * np.where(turn[:, :1] < 0.0, -1.0, 1.0)
            turn[:, 1:] = _enlarged(turn[:, 1:], factor)
            turn /= np.linalg.norm(turn, axis=1, keepdims=True)
            values[:, at : at + 4] = multiply(turn, body.orientation[:1])
    for name, mount in response.mounts.items():
        at = first[f"mounts/{name}/deflection/roll"]
        values[:, at : at + 3] = _enlarged(mount.deflection, factor)
    return with_values(response, values)


def _enlarged(values: Array, factor: float) -> Array:
    """Enlarge values (n_t, k) by a factor about the middles of their ranges."""
    mean = 0.5 * (values.min(axis=0) + values.max(axis=0))
    return np.asarray(mean + factor * (values - mean))


ROOT = "ghosts"
# Opacity of a ghost, so that overlapping ones can be distinguished, and of its start
_OPAQUE, _AT_REST = 0.38, 0.12
_SHOWN_MOTION = 0.04  # of the scene's size, up to which the largest motion is enlarged


def ghost_factor(drawn: Drawn) -> float:
    """Find the factor that enlarges the largest motion of all runs to `_SHOWN_MOTION` of the scene, at least 1."""
    travel, extent = 0.0, 0.0
    for run in drawn.runs:
        extent = max(extent, scene_extent(run.response.scene)[1])
        for body, frame in _moving_bodies(run):
            travel = max(travel, float(np.abs(frame.position - _start(run, body, frame)[0]).max()))
    if travel == 0.0 or _SHOWN_MOTION * extent <= travel:
        return 1.0
    return round_down(_SHOWN_MOTION * extent / travel)


def log_ghosts(rec: Stream, drawn: Drawn, factor: float) -> None:
    """Log ghosts, transparent bodies in enlarged motion, of all runs; of a run alone in its own colours, over its start."""
    rec.log(entity(ROOT), rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    bases: list[str] = []
    for number, run in enumerate(drawn.runs):
        below, time = Below(rec, entity(ROOT, *run.names)), run.response.time
        extent, rows = scene_extent(run.response.scene)[1], scene_rows(run.response, run.frames)
        base = next((body for body in run.response.scene.bodies if body.name == run.response.scene.base), None)
        if base is not None and base.name != "world" and repr(base.geoms) not in bases:
            draw_geoms(below, run.frames[base.name].path, see_through(base), extent)
            bases.append(repr(base.geoms))  # the same base would flicker through itself
        for body, frame in _moving_bodies(run):
            start, pose = _start(run, body, frame), (frame.position, frame.orientation)
            pose = pose if frame.fixed else grown(*pose, *start, factor)
            log_pose(below, frame.path, time, *pose, rows)
            faint = [1.0, 1.0, 1.0, 1.5 * _OPAQUE]
            run_color = np.array([*run.color, 255 * _OPAQUE]) / 255.0
            geoms = [replace(geom, rgba=run_color if run.name else geom.rgba * faint) for geom in body.geoms]
            draw_geoms(below, frame.path, geoms, extent)
            if drawn.alone and not frame.fixed:
                start_path = frame.path + "_at_rest"
                log_pose(below, start_path, time, start[0][None], start[1][None], rows)
                draw_geoms(below, start_path, [replace(g, rgba=g.rgba * [1.0, 1.0, 1.0, _AT_REST]) for g in body.geoms], extent)
        if drawn.alone:
            log_bending(below, run.frames, run.response, rows, factor)
            log_marks(below, run.response, run.selection, run.frames, extent)
        if not drawn.alone or drawn.listed:
            # beside the scene, as it is seen when the recording opens: the legend of the colours, or what no title says
            said = run.name or f"motion {factor:g} times larger"
            base_name, camera = run.response.scene.base, whole_scene(run.response)
            back = camera.eye - camera.target
            aside = np.cross(back, [0.0, 0.0, 1.0]) / np.linalg.norm(back)
            above = camera.target + 0.5 * extent * aside + np.array([0.0, 0.0, (0.1 + 0.1 * number) * extent])
            path = child(run.frames[base_name].path if base_name in run.frames else entity("world"), "name")
            look = {"colors": [run.color], "radii": rr.Radius.ui_points(0.0), "show_labels": True}
            below.log(path, rr.Points3D([above], labels=[said], **look), static=True)


def _moving_bodies(run: DrawnRun) -> list[tuple[SceneBody, Frame]]:
    scene = run.response.scene
    return [(body, run.frames[body.name]) for body in scene.bodies if body.moves and body.name != scene.base]


def _start(run: DrawnRun, body: SceneBody, frame: Frame) -> tuple[Array, Array]:
    """Find position (3,) and quaternion from which motion is enlarged: the first pose, among several runs the modelled one."""
    if not run.name:
        return frame.position[0], frame.orientation[0]
    parent = frame.path.rsplit("/", 1)[0]
    name = next((name for name, other in run.frames.items() if other.path == parent and name != "world"), None)
    if name is None:
        return body.position, body.orientation
    carrier = next(other for other in run.response.scene.bodies if other.name == name)
    back = conjugate(carrier.orientation)
    return rotate(back, body.position - carrier.position), multiply(back, body.orientation)
