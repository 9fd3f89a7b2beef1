"""Stops among the mounts in the 3D scene: bumpers that change colour while they are closed."""

from typing import Any

import numpy as np
import numpy.typing as npt

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Scene, SceneMount
from wirerope_mj.views.recording.paths import Rows, at, child
from wirerope_mj.views.recording.poses import Frame, quaternion_of
from wirerope_mj.views.recording.shapes import drawn_size, quaternion

OPEN, CLOSED = (150, 158, 168), (240, 96, 30)

_COVER = 1.02  # of the radius of a ball that is covered: seen, and too thin to look like another size


def closed_at(response: Response, stops: tuple[SceneMount, ...]) -> npt.NDArray[np.bool_]:
    """Return whether any of some stops presses at each sample, (n_t,)."""
    pressing = [response.mounts[stop.name].force.any(axis=1) for stop in stops]
    return np.asarray(np.any(pressing, axis=0))


def changes(state: npt.NDArray[Any]) -> Rows:
    """Return the rows at which a state is another than before, the first one in any case."""
    return np.flatnonzero(np.diff(state.astype(int), prepend=-1))


def log_stops(rec: Any, response: Response, frames: dict[str, Frame], *, extent: float) -> None:
    """Log every stop as a bumper that changes colour.

    A ball that the model draws about the stop's point on the payload is covered, so that the colour is seen where the pad is
    met. Without one the bumper is a cylinder about its point on the base; one whose device states no size suits a scene of
    `extent` [m].
    """
    import rerun as rr

    scene = response.scene
    look: dict[str, Any] = {"show_labels": False, "fill_mode": "Solid"}  # the lanes and the report name them
    for stop in scene.stops:
        radius = _ball(scene, stop)
        shape = rr.Cylinders3D if radius is None else rr.Ellipsoids3D
        if radius is None:
            height, width = drawn_size(stop, extent)
            turn = quaternion(quaternion_of(stop.axes))
            size = {"lengths": [height], "radii": [0.5 * width], "quaternions": [turn]}
        else:
            size = {"half_sizes": [[_COVER * radius] * 3]}
        body, center = (stop.base_body, stop.base_point) if radius is None else (stop.payload_body, stop.payload_point)
        path = child(frames[body].path, "stops", stop.name)
        rec.log(path, shape(centers=[center], labels=[stop.name], **size, **look), static=True)
        closed = closed_at(response, (stop,))
        rows = changes(closed)
        colors = [CLOSED if closed[row] else OPEN for row in rows]
        rec.send_columns(path, at(response.time[rows]), shape.columns(colors=colors))


def _ball(scene: Scene, stop: SceneMount) -> float | None:
    """Return the radius of the sphere that the model draws about a stop's point on the payload [m]; None without one."""
    geoms = next((body.geoms for body in scene.bodies if body.name == stop.payload_body), ())
    radii = [
        float(geom.size[0])
        for geom in geoms
        if geom.shape == "sphere" and np.allclose(geom.position, stop.payload_point, rtol=0.0, atol=1e-6)
    ]
    return max(radii, default=None)
