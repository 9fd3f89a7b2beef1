"""A deck or equipment that bends: how far its points at the mounts have gone, and a net through them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import rerun as rr
import scipy

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Geom, SceneBody, SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.paths import Rows, Stream, at, child
from wirerope_mj.views.recording.poses import Frame, relative_pose, rotate

_NET = (120, 220, 200)
_FAINT = 0.2  # of a body that bends, drawn unbent: its net is seen through it


def bending_at(response: Response, mount: SceneMount, body: str, rows: Rows) -> Array:
    """Find the displacement by bending of a mount's point on a body [m], in the body's axes, (n, 3).

    It follows from the mount's other point and its deflection. 0 where the body does not bend, and where the bodies at both
    ends do, whose shares they cannot tell apart.
    """
    names = {mount.base_body, mount.payload_body}
    bending = {one.name for one in response.scene.bodies if one.bends and one.name in names}
    if bending != {body} or names - response.bodies.keys():
        return np.zeros((rows.size, 3))
    position, orientation = relative_pose(response, (names - {body}).pop(), body)
    stretched = response.mounts[mount.name].deflection[rows] @ mount.axes.T
    if body == mount.base_body:
        return np.asarray(position[rows] + rotate(orientation[rows], mount.payload_point) - stretched - mount.base_point)
    return np.asarray(position[rows] + rotate(orientation[rows], mount.base_point + stretched) - mount.payload_point)


def see_through(body: SceneBody) -> Sequence[Geom]:
    """Return the geoms of a body, faint if it bends."""
    return [replace(geom, rgba=geom.rgba * [1.0, 1.0, 1.0, _FAINT]) for geom in body.geoms] if body.bends else body.geoms


def log_bending(rec: Stream, frames: Mapping[str, Frame], response: Response, rows: Rows, factor: float) -> None:
    """Log a net through the mounts' points on each body that bends, with bending enlarged from where it begins."""
    for body in (one.name for one in response.scene.bodies if one.bends):
        points = [
            (mount, mount.base_point if mount.base_body == body else mount.payload_point)
            for mount in response.scene.mounts if body in (mount.base_body, mount.payload_body)
        ]  # fmt: skip
        if len(points) < 2:
            continue
        feet = np.array([point for _, point in points])
        bent = np.stack([bending_at(response, mount, body, rows) for mount, _ in points], axis=1)
        ends = (feet + factor * (bent - bent[0]))[:, _edges(feet)]  # (n_t, n_edges, 2, 3)
        net = child(frames[body].path, "bending")
        rec.log(net, rr.LineStrips3D.from_fields(colors=[_NET], radii=[rr.Radius.ui_points(3.0)]), static=True)
        strips = rr.LineStrips3D.columns(strips=ends.reshape(-1, 2, 3)).partition(np.full(rows.size, ends.shape[1]))
        rec.send_columns(net, at(response.time[rows]), strips)


def _edges(feet: Array) -> Array:
    """Return pairs of feet on one level to be joined, (n, 2): triangles seen from above, a row where they lie in a line."""
    try:
        corners = scipy.spatial.Delaunay(feet[:, :2]).simplices
    except (scipy.spatial.QhullError, ValueError):  # in one line, or fewer than three
        order = np.lexsort(feet.T)
        return np.stack([order[:-1], order[1:]], axis=1)
    pairs = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    apart = np.abs(feet[pairs[:, 0]] - feet[pairs[:, 1]])
    return np.unique(pairs[apart[:, 2] <= 0.5 * apart[:, :2].max(axis=1)], axis=0)
