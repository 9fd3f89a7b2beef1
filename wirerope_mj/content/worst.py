"""The scene at the worst instant of a run, or at any, as a drawing."""

import math
from dataclasses import replace

import numpy as np
import scipy

from wirerope_mj.assessment.criteria import EXCEEDED, Verdict
from wirerope_mj.assessment.criteria.summary import against_limit
from wirerope_mj.assessment.criteria.verdict import most_used
from wirerope_mj.content.blocks import SceneView
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.content.scene_outline import drawn_scene
from wirerope_mj.content.verdicts import ordered
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices

_SEEN = 0.06  # of the drawing's extent, which the largest displacement may take
_FACTORS = (100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0)
_STILL = 1e-6  # [m]: what moves less is not worth a picture


def worst_instant(run: JudgedRun) -> SceneView | None:
    """Return the scene at the worst instant of what is most critical, displacements enlarged; None where nothing moves.

    What is most critical at rest, by its static load, is shown when it uses most of its other limits.
    """
    critical = most_used(run.verdicts)
    rows = [(row, row.time) for row in ordered(run.verdicts) if row.time is not None and math.isfinite(row.value)]
    rows = [pair for pair in rows if critical is not None and pair[0].subject == critical.subject] or rows
    if not rows:
        return None
    worst, instant = rows[0]
    unlimited = f"{worst.criterion} of {worst.subject}, {with_unit(worst.value, worst.unit)}"
    title = f"The worst instant, {instant:.4f} s: {unlimited if worst.limit is None else against_limit(worst)}"
    view = scene_at(run.response, instant, title=title)
    if view is None or view.moved is None:
        return None
    return replace(view, id="worst-instant", ring=_ring(view.moved, worst), exceeded=worst.verdict == EXCEEDED)


def scene_at(response: Response, instant: float, *, title: str = "") -> SceneView | None:
    """Return the scene at the sample nearest to an instant [s], displacements enlarged; None where nothing is seen to move."""
    scene = response.scene
    if not any(body.geoms for body in scene.bodies):
        return None
    number = int(np.abs(response.time - instant).argmin())
    travels = _travels(response, number)
    largest = max((float(np.linalg.norm(travel)) for travel in travels.values()), default=0.0)
    if largest < _STILL:
        return None
    drawn = drawn_scene(scene)
    allowed = _SEEN * float((drawn.high - drawn.low).max())
    factor = next((factor for factor in _FACTORS if factor * largest <= allowed), 1.0)
    enlarged = f", displacements {factor:g} times as large" if factor > 1.0 else ""
    caption = (
        f"{title or f'At {response.time[number]:.4f} s'}. Everything as it stands from the base{enlarged}; pale or dashed: "
        "the modelled, unloaded geometry. Lines: mounts from the base's site to the payload's."
    )
    return SceneView(id="instant", scene=scene, caption=caption, moved=_moved(response, number, travels, factor))


def _travels(response: Response, number: int) -> dict[str, Array]:
    """Return the displacements of the moving bodies from the modelled geometry, relative to the base [m], (3,) each."""
    base = response.base.displacement[number]
    return {
        body.name: response.bodies[body.name].position[number] - base - body.position
        for body in response.scene.bodies
        if body.moves and not body.on_base
    }


def _moved(response: Response, number: int, travels: dict[str, Array], factor: float) -> Scene:
    """Return the scene with its moving bodies at a sample, displacements and rotations `factor` times as large."""
    bodies, rotation = [], scipy.spatial.transform.Rotation
    for body in response.scene.bodies:
        if body.name in travels:
            start, now = (
                rotation.from_quat(quaternion, scalar_first=True)
                for quaternion in (body.orientation, response.bodies[body.name].orientation[number])
            )
            turned = rotation.from_rotvec(factor * (now * start.inv()).as_rotvec()) * start
            position = body.position + factor * travels[body.name]
            bodies.append(replace(body, position=position, orientation=turned.as_quat(scalar_first=True)))
        else:
            bodies.append(body)
    return replace(response.scene, bodies=tuple(bodies))


def _ring(moved: Scene, worst: Verdict) -> tuple[str, Array] | None:
    """Return name and position of what the verdict is on; None for a pair of geoms, which has no one position."""
    bodies = {body.name: body for body in moved.bodies}
    if worst.subject in bodies:
        return worst.subject, bodies[worst.subject].position
    mount = next((mount for mount in moved.mounts if mount.name == worst.subject), None)
    if mount is None:
        return None
    body = bodies[mount.payload_body]
    return mount.name, np.asarray(body.position + rotation_matrices(body.orientation) @ mount.payload_point)
