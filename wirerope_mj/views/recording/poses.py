"""Poses of bodies as a tree of frames: everything rides on the base, and what is fixed to a body hangs on that body."""

from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.paths import child, entity

# Bodies that move less are fixed to each other [m], per metre of arm for rotations; far below a pixel
_SAME = 1e-6
_CHECKED_ROWS = 1000


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A body's frame in its parent's."""

    path: str  # entity of the body
    position: Array  # centre of mass in the parent's frame [m], (n_t, 3), or (1, 3) if it never moves there
    orientation: Array  # quaternion w first, (n_t, 4) or (1, 4)

    @property
    def fixed(self) -> bool:
        return self.position.shape[0] == 1


def frames_of(response: Response) -> dict[str, Frame]:
    """Find the frame of every body of the scene by name; the base comes first."""
    base = response.scene.base if response.scene.base in response.bodies else ""
    world = entity("world")
    frames: dict[str, Frame] = {}
    free: list[str] = []  # bodies that move in the base's frame
    if base:
        driven = response.bodies[base]
        frames[base] = Frame(path=child(world, base), position=driven.position, orientation=driven.orientation)
    for body in response.scene.bodies:
        if body.name in frames:
            continue
        if not (body.moves and body.name in response.bodies):
            path = world if body.name == "world" else child(world, body.name)
            frames[body.name] = Frame(path=path, position=body.position[None], orientation=body.orientation[None])
            continue
        parent = None  # the first in whose frame the body never moves
        some = slice(None, None, max(1, response.time.size // _CHECKED_ROWS))
        for carrier in [*([base] if base else []), *free]:
            position, orientation = relative_pose(response, body.name, carrier, some)
            aligned = orientation * np.sign(orientation @ orientation[0])[:, None]
            if max(np.ptp(position, axis=0).max(), np.ptp(aligned, axis=0).max()) < _SAME:
                parent = carrier
                break
        if parent is None:
            free.append(body.name)
        position, orientation = relative_pose(response, body.name, parent if parent is not None else base)
        few = slice(0, 1) if parent is not None else slice(None)
        path = child(frames[parent or base].path if parent or base else world, body.name)
        frames[body.name] = Frame(path=path, position=position[few], orientation=orientation[few])
    return frames


def relative_pose(response: Response, name: str, carrier: str, rows: slice = slice(None)) -> tuple[Array, Array]:
    """Find position (n_t, 3) and orientation (n_t, 4) of a body in the frame of another one; "" is the world."""
    position, orientation = response.bodies[name].position[rows], response.bodies[name].orientation[rows]
    if not carrier:
        return position, orientation
    moved = response.bodies[carrier]
    back = conjugate(moved.orientation[rows])
    return rotate(back, position - moved.position[rows]), multiply(back, orientation)


def rotate(quaternion: Array, vector: Array) -> Array:
    """Turn vectors (..., 3) by quaternions (..., 4), w first."""
    w, u = quaternion[..., :1], quaternion[..., 1:]
    return vector + 2.0 * np.cross(u, np.cross(u, vector) + w * vector)


def conjugate(quaternion: Array) -> Array:
    return quaternion * np.array([1.0, -1.0, -1.0, -1.0])


def multiply(a: Array, b: Array) -> Array:
    w, u = a[..., :1], a[..., 1:]
    real = w * b[..., :1] - np.sum(u * b[..., 1:], axis=-1, keepdims=True)
    return np.concatenate([real, w * b[..., 1:] + b[..., :1] * u + np.cross(u, b[..., 1:])], axis=-1)


def grown(position: Array, orientation: Array, about: Array, turned: Array, factor: float) -> tuple[Array, Array]:
    """Enlarge poses: positions (n_t, 3) from `about`, quaternions (n_t, 4) from `turned`."""
    turn = multiply(orientation, conjugate(turned))
    turn = turn * np.where(turn[:, :1] < 0.0, -1.0, 1.0)
    turn[:, 1:] *= factor
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return about + factor * (position - about), multiply(turn, np.broadcast_to(turned, turn.shape))


def quaternion_of(matrix: Array) -> Array:
    """Convert a rotation matrix (3, 3) to a quaternion (4,), w first."""
    quaternion: Array = scipy.spatial.transform.Rotation.from_matrix(matrix).as_quat(scalar_first=True)
    return quaternion
