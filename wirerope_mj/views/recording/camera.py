"""The two cameras: one sees everything, one sees the governing mount, from where nothing hides it."""

from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Geom, Scene, SceneBody
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.poses import conjugate, multiply, rotate

_LOOK_FROM = np.array([0.46, -0.80, 0.38])
_TANGENT = 0.88 * np.tan(np.radians(55.0 / 2))
"""Of half the viewer's angle of view from below to above, less a margin."""

_ASPECT = 1.75
"""Width over height of the pane of the whole scene on a full-HD screen, where a run is alone."""

_CLOSE = 1.4
"""Distance of the close-up over the diagonal of the mount."""

_AZIMUTHS = 24
_ELEVATIONS = (3.0, 10.0, 22.0, 40.0)  # [deg]
_SEE_THROUGH = 0.7
"""Geoms less opaque than this do not hide what is behind them."""

CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


@dataclass(frozen=True, kw_only=True)
class Camera:
    """Eye and target in the base's frame [m], (3,) each."""

    eye: Array
    target: Array


def whole_scene(response: Response, *, aspect: float = _ASPECT) -> Camera:
    """Return a camera that sees everything, as near as its pane, `aspect` times as wide as high, allows."""
    points = _seen_from_base(response.scene, _corners(response.scene))
    back = _LOOK_FROM / np.linalg.norm(_LOOK_FROM)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    target = 0.5 * (points.min(axis=0) + points.max(axis=0))
    distance = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    for _ in range(40):  # a fixed point, because of the perspective; half steps keep it from swinging
        seen = points - target - distance * back
        depth = np.maximum(-seen @ back, 1e-3 * distance)
        x, y = seen @ right / depth, seen @ up / depth
        target = target + 0.25 * distance * ((x.min() + x.max()) * right + (y.min() + y.max()) * up)
        distance *= max(np.ptp(x) / (2.0 * _TANGENT * aspect), np.ptp(y) / (2.0 * _TANGENT)) ** 0.5
    return Camera(eye=target + distance * back, target=target)


def close_up(response: Response, mount: str, *, height: float, width: float, row: int) -> Camera:
    """Return a camera that sees a mount of the given size [m] past the bodies around it, as they stand at a sample."""
    scene = replace(response.scene, bodies=tuple(_posed(response, body, row) for body in response.scene.bodies))
    at = next(entry for entry in scene.mounts if entry.name == mount)
    base = next(body for body in scene.bodies if body.name == at.base_body)
    middle = base.position + rotate(base.orientation, at.base_point)
    axes = rotate(base.orientation, at.axes.T)
    # Bars are about 1.9 times as long as the device is wide; what is looked at are its corners, drawn in a little.
    corners = middle + 0.35 * (CORNERS * [width, 1.9 * width, height]) @ axes
    distance = _CLOSE * float(np.linalg.norm([width, 1.9 * width, height]))
    directions = _directions()
    hidden = _hidden(scene, middle + distance * directions, corners)
    center, _ = scene_extent(scene)
    outward = (middle - center) / max(float(np.linalg.norm(middle - center)), 1e-9)
    # What is seen counts most; then a look neither along the bars nor square to them, and from outside.
    along_bars = np.abs(directions @ axes[1])
    worth = -3.0 * hidden - 0.5 * np.abs(along_bars - 0.5) + 0.3 * directions @ outward
    eye = middle + distance * directions[int(worth.argmax())]
    return Camera(eye=_seen_from_base(scene, eye), target=_seen_from_base(scene, middle))


def _posed(response: Response, body: SceneBody, row: int) -> SceneBody:
    """Return a body where it is at a sample."""
    if body.name not in response.bodies:
        return body
    moved = response.bodies[body.name]
    return replace(body, position=moved.position[row], orientation=moved.orientation[row])


def scene_extent(scene: Scene) -> tuple[Array, float]:
    """Return centre (3,) and diagonal [m] of what is drawn, in the world frame of the modelled geometry."""
    points = _corners(scene)
    low, high = points.min(axis=0), points.max(axis=0)
    return 0.5 * (low + high), float(np.linalg.norm(high - low)) or 1.0


def _corners(scene: Scene) -> Array:
    """Return the corners of the boxes around all geoms that end somewhere, world frame, (n, 3)."""
    corners = [
        body.position + rotate(body.orientation, geom.position + rotate(geom.orientation, reach(geom) * CORNERS))
        for body in scene.bodies
        for geom in body.geoms
        if np.isfinite(reach(geom)).all()
    ]
    return np.concatenate(corners) if corners else np.array([body.position for body in scene.bodies])


def reach(geom: Geom) -> Array:
    """Return the half lengths of the box around a geom, in its own axes [m], (3,); infinite for an endless plane."""
    size = geom.size
    if geom.shape == "sphere":
        return np.full(3, size[0])
    if geom.shape == "cylinder":
        return np.array([size[0], size[0], size[1]])
    if geom.shape == "capsule":
        return np.array([size[0], size[0], size[0] + size[1]])
    if geom.shape == "mesh":
        return np.abs(geom.vertices).max(axis=0) if geom.vertices.size else np.zeros(3)
    if geom.shape == "plane":
        return np.array([half if half > 0.0 else np.inf for half in size[:2]] + [0.0])
    return np.asarray(size)


def _directions() -> Array:
    azimuth = np.linspace(0.0, 2.0 * np.pi, _AZIMUTHS, endpoint=False)
    parts = []
    for elevation in np.radians(_ELEVATIONS):
        flat = np.cos(elevation) * np.column_stack([np.cos(azimuth), np.sin(azimuth)])
        parts.append(np.column_stack([flat, np.full(_AZIMUTHS, np.sin(elevation))]))
    return np.concatenate(parts)


def _hidden(scene: Scene, eyes: Array, targets: Array) -> Array:
    """Return the fraction of the targets (m, 3) that something opaque hides from each eye (n, 3), (n,)."""
    blocked = np.zeros((len(eyes), len(targets)), dtype=bool)
    for body in scene.bodies:
        for geom in body.geoms:
            if geom.rgba[3] < _SEE_THROUGH or not np.isfinite(reach(geom)).all():
                continue
            back = conjugate(multiply(body.orientation, geom.orientation))
            center = body.position + rotate(body.orientation, geom.position)
            start, stop = rotate(back, targets - center), rotate(back, eyes - center)
            blocked |= _cuts_box(start[None], stop[:, None], reach(geom))
    return blocked.mean(axis=1)


def _cuts_box(start: Array, stop: Array, half: Array) -> Array:
    """Return whether the segments from `start` to `stop` (..., 3) pass through a box about the origin."""
    ray = stop - start
    ray = np.where(np.abs(ray) < 1e-12, 1e-12, ray)
    one, other = (-half - start) / ray, (half - start) / ray
    enter = np.minimum(one, other).max(axis=-1)
    leave = np.maximum(one, other).min(axis=-1)
    crossing: Array = (enter < leave) & (leave > 0.0) & (enter < 1.0)
    return crossing


def _seen_from_base(scene: Scene, point: Array) -> Array:
    """Return a point in the frame of the base, if it has one that moves."""
    body = next((body for body in scene.bodies if body.name == scene.base and body.moves), None)
    return point if body is None else rotate(conjugate(body.orientation), point - body.position)
