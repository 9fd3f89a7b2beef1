"""A deck that bends: how far its points below the mounts have gone, and a net through them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import rerun as rr
import scipy

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Geom, SceneBody, SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.paths import Rows, Stream, at, child
from wirerope_mj.views.recording.poses import relative_pose, rotate

_NET = (120, 220, 200)
_FAINT = 0.2  # of a body that bends, drawn unbent: its net is seen through it


def bending_below(response: Response, mount: SceneMount, rows: Rows) -> Array:
    """Return how far the base's point of a mount is from where its rigid body has it [m], in the base body's axes, (n, 3).

    The payload's point, less the mount's deflection, is where the base has bent to: what bends is taken for the base.
    """
    bends = any(body.bends for body in response.scene.bodies if body.name == mount.base_body)
    if not bends or not {mount.base_body, mount.payload_body} <= response.bodies.keys():
        return np.zeros((rows.size, 3))
    position, orientation = relative_pose(response, mount.payload_body, mount.base_body)
    top = position[rows] + rotate(orientation[rows], mount.payload_point)
    bent: Array = top - response.mounts[mount.name].deflection[rows] @ mount.axes.T - mount.base_point
    return bent


def see_through(body: SceneBody) -> Sequence[Geom]:
    """Return the geoms of a body, faint if it bends."""
    return [replace(geom, rgba=geom.rgba * [1.0, 1.0, 1.0, _FAINT]) for geom in body.geoms] if body.bends else body.geoms


def log_bending(rec: Stream, path: str, response: Response, rows: Rows, factor: float) -> None:
    """Log a net through the points below the mounts on a base that bends, with bending enlarged from where it begins."""
    scene = response.scene
    mounts = [mount for mount in scene.mounts if mount.base_body == scene.base]
    if not any(body.bends for body in scene.bodies if body.name == scene.base) or len(mounts) < 2:
        return
    feet = np.array([mount.base_point for mount in mounts])
    bent = np.stack([bending_below(response, mount, rows) for mount in mounts], axis=1)
    ends = (feet + factor * (bent - bent[0]))[:, _edges(feet)]  # (n_t, n_edges, 2, 3)
    net = child(path, "bending")
    look = rr.LineStrips3D.from_fields(colors=[_NET], radii=[rr.Radius.ui_points(3.0)])
    rec.log(net, look, static=True)
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
